"""How answering to an accuracy ended, and what was found."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import NoEquilibriumError
from beamopt.storage.writing import csv_text
from femcheck.models.question import Question
from femcheck.models.reply import Model, Reply

if TYPE_CHECKING:
    from pandas import DataFrame

__all__ = ["Ending", "Source", "Tried", "Within", "beam_difference", "tips_csv"]

TIPS = "p1,p2,p3,x,y,z,estimate_mm,beam_x,beam_y,beam_z,difference_mm,status,ended"
DIGITS = 6  # of a millimetre


class Ending(Enum):
    """How it ended; the value is the text shown to people.

    Examples
    --------
    >>> import femcheck
    >>> femcheck.Ending.REACHED.value
    'accuracy reached'
    """

    REACHED = "accuracy reached"
    NOT_REACHED = "accuracy not reached: the finest model's estimate is larger, or a tip was lost"
    TOO_DEAR = "accuracy not reached: a finer solid is expected to take too long"
    NO_TIP = "no combination has a tip"
    NO_MODEL = "no model of this law can be made of the design"


class Source(Enum):
    """Source of an estimate of the error; the value is the text shown to people."""

    CLOSED_FORM = (
        "exact up to rounding: the beam is the law's own closed form; nothing was compared"
    )
    TIGHTER = "the change from rods solved less tightly, and the last tolerance"
    COARSER = "the changes from solids with fewer layers, other triangles and penalties"
    NOTHING = "no estimate: nothing was compared"


@dataclass(frozen=True, eq=False)
class Tried:
    """A model that was asked, and what it took of the processor [s]."""

    model: Model
    reply: Reply
    seconds: float

    @property
    def name(self) -> str:
        """Of the model."""
        return f"{self.model.family} {self.model.resolution}".strip()


@dataclass(frozen=True, eq=False)
class Within:
    """Tips to an accuracy.

    accuracy : asked for [mm]. ending : whether it was reached.
    reply : of the finest model; empty of tips without one.
    estimate : (n,) error of each tip [mm]; NaN where nothing was compared, or there is no tip.
    tried : all models that were asked, the last one's reply is the answer.
    reason : why this rung, in a sentence.
    source : where the estimate is from.

    Examples
    --------
    >>> import femcheck
    >>> import beamopt
    >>> drawn = beamopt.load_design(str(beamopt.load_scene("gravity").target.file))
    >>> subject = femcheck.sealed_copy("round", drawn, 1.0)
    >>> question = femcheck.Question.of("round", subject.design, femcheck.CheckOptions())
    >>> within: femcheck.Within = femcheck.answer_within(question, 0.1)
    >>> within.ending.name, within.chosen
    ('REACHED', 'beam')
    """

    question: Question
    accuracy: float
    ending: Ending
    reply: Reply | None
    estimate: FloatArray
    tried: tuple[Tried, ...]
    reason: str
    source: Source = Source.NOTHING

    def __repr__(self) -> str:
        return (
            f"<Within {self.accuracy:g} mm: {self.ending.name}, {self.chosen}, "
            f"error up to {self.worst:.2g} mm, {len(self.tried)} models tried>"
        )

    def to_frame(self) -> DataFrame:
        """Tips with their estimated errors, beside the beam's, as a data frame (needs pandas)."""
        from beamopt.storage.frames import frame_of

        return frame_of(tips_csv(self))

    @property
    def seconds(self) -> float:
        """Processor time of all of it [s]."""
        return sum(one.seconds for one in self.tried)

    @property
    def worst(self) -> float:
        """Largest estimate [mm]; NaN without any."""
        known = self.estimate[np.isfinite(self.estimate)]
        return float(known.max()) if known.size else np.nan

    @property
    def chosen(self) -> str:
        """The model whose tips these are."""
        if self.reply is None:
            return "none"
        return next(one.name for one in self.tried if one.reply is self.reply)

    @property
    def compared_with(self) -> tuple[str, ...]:
        """Models that the estimate compares the chosen one with; none without an estimate."""
        if self.source in (Source.CLOSED_FORM, Source.NOTHING):
            return ()
        return tuple(one.name for one in self.tried if one.reply is not self.reply)

    @property
    def is_beam(self) -> bool:
        """True if these are the tips of a beam: a difference to the beam says nothing then."""
        return self.source in (Source.CLOSED_FORM, Source.TIGHTER)


def beam_difference(found: Within) -> tuple[FloatArray, FloatArray]:
    """The design's own tips (n, 3) and their distances (n,) from what was found [mm].

    Distances are NaN where what was found is the beam itself.
    """
    question = found.question
    try:
        beam = question.design.tips(question.pressures)
    except NoEquilibriumError:
        beam = np.full((len(question.pressures), 3), np.nan)
    if found.reply is None or found.is_beam:
        return beam, np.full(len(beam), np.nan)
    return beam, found.reply.away(beam)


def tips_csv(found: Within) -> str:
    """Tips with their estimated errors, beside the beam's."""
    return csv_text(TIPS, _tips(found))


def _tips(found: Within) -> Iterator[tuple[object, ...]]:
    beam, difference = beam_difference(found)
    if found.reply is None:
        return
    rows = zip(
        found.question.pressures.tolist(),
        found.reply.tips,
        found.estimate,
        beam,
        difference,
        found.reply.endings,
        strict=True,
    )
    for pressures, tip, estimate, own, away, ended in rows:
        numbers = [*tip, estimate, *own, away]
        rounded = [None if np.isnan(x) else round(float(x), DIGITS) + 0.0 for x in numbers]
        yield (*pressures, *rounded, str(ended), ended.key)
