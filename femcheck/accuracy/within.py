"""Answering to an accuracy: rung and resolution chosen, the error estimated, finer if need be."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from typing import Literal, Protocol

import numpy as np

from beamopt.arrays import FloatArray
from beamopt.errors import InputError
from femcheck.accuracy.knowledge import Level, levels_for, scale_of
from femcheck.chart.lineup import STIFFER
from femcheck.chart.measure import Measured
from femcheck.models.beam import RodOnOutline
from femcheck.models.question import Question
from femcheck.models.reply import Model, Reply, cpu_seconds
from femcheck.models.solid import SolidModel

__all__ = ["Ending", "Kept", "RungChoice", "Tried", "Within", "answer_within", "check_asked"]

RungChoice = Literal["auto", "beam", "solid"]

COMFORT = 0.5  # of the accuracy: the error that a chart has to promise for a level to be begun with
SAFETY = 2.0  # on an estimate from two levels, whose order is that of theory
FINER_ROD = 100.0  # how many times tighter the rod is solved that the first one is held against
REMAINDER = 8.0  # of the usual penalties' own error over the stiffer ones': 16 in theory
LEAST = 1  # index of the first level that may be the answer: the one below it is there to compare


class Ending(Enum):
    """How it ended; the value is the text shown to people."""

    REACHED = "accuracy reached"
    NOT_REACHED = "accuracy not reached: the finest solid's estimate is larger"
    TOO_DEAR = "accuracy not reached: a finer solid is expected to take too long"
    NO_TIP = "no combination has a tip"
    NO_MODEL = "no model of this law can be made of the design"


@dataclass(frozen=True, eq=False)
class Tried:
    """A model that was asked, and what it took of the processor [s]."""

    model: Model
    reply: Reply
    seconds: float


@dataclass(frozen=True, eq=False)
class Within:
    """Tips to an accuracy.

    accuracy : asked for [mm]. ending : whether it was reached.
    reply : of the finest model; empty of tips without one.
    estimate : (n,) error of each tip [mm]; NaN where that is not known, or there is no tip.
    tried : all models that were asked, the last one's reply is the answer.
    reason : why this rung, in a sentence.
    """

    question: Question
    accuracy: float
    ending: Ending
    reply: Reply | None
    estimate: FloatArray
    tried: tuple[Tried, ...]
    reason: str

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
        model = next(one.model for one in self.tried if one.reply is self.reply)
        return f"{model.family} {model.resolution}".strip()


Progress = Callable[[int, int, str], None]


class Kept(Protocol):
    """Replies that are kept, by model."""

    def find(self, model: Model) -> Measured | None:
        """The one of a model; None where there is none."""
        ...

    def keep(self, measured: Measured) -> None:
        """Keep one."""
        ...


def answer_within(
    question: Question,
    accuracy: float,
    *,
    rung: RungChoice = "auto",
    most_seconds: float = np.inf,
    workers: int = 0,
    progress: Progress | None = None,
    kept: Kept | None = None,
) -> Within:
    """Tips of the question's law to `accuracy` [mm], by the cheapest model that charts know of.

    "Accuracy" is numerical: against a much finer solution of the same law.

    Parameters
    ----------
    rung : "beam" or "solid" instead of the cheaper one that answers the law.
    most_seconds : processor time that a model may be expected to take.
    workers : processes; 0 stays in this one.
    progress : called with how many models were asked, how many are foreseen, and the one asked.
    kept : where replies are found again, and kept as they come.

    Raises
    ------
    InputError : an accuracy that is not positive; a rung that does not answer the law.
    """
    check_asked(question, accuracy, rung)
    ask = _Asking(question, accuracy, workers, progress, kept)
    if question.is_of_the_beam and rung != "solid":
        return ask.the_beam()
    return ask.solids(most_seconds)


def check_asked(question: Question, accuracy: float, rung: RungChoice) -> None:
    """Refuse what `answer_within` can not be asked.

    Raises
    ------
    InputError : an accuracy that is not positive; a rung that does not answer the law.
    """
    if not 0 < accuracy < np.inf:
        raise InputError("", "accuracy", accuracy, "above 0 mm")
    if rung == "beam" and not question.is_of_the_beam:
        said = f"a beam has no {question.law_text}: how far it is off only a solid can tell"
        raise InputError("", "rung", rung, said)


class _Asking:
    """What was asked so far."""

    def __init__(
        self,
        question: Question,
        accuracy: float,
        workers: int,
        progress: Progress | None,
        kept: Kept | None,
    ) -> None:
        self.question = question
        self.accuracy = accuracy
        self.workers = workers
        self.progress = progress
        self.kept = kept
        self.tried: list[Tried] = []

    def ask(self, model: Model, foreseen: int) -> Reply:
        if self.progress is not None:
            said = f"{model.family} {model.resolution}".strip()
            self.progress(len(self.tried), len(self.tried) + foreseen, said)
        known = None if self.kept is None else self.kept.find(model)
        if known is None:
            before = cpu_seconds()
            reply = model.reply(self.question, self.workers)
            seconds = cpu_seconds() - before
            known = Measured(model.family, model.resolution, reply, seconds)
            if self.kept is not None:
                self.kept.keep(known)
        self.tried.append(Tried(model, known.reply, known.seconds))
        return known.reply

    def the_beam(self) -> Within:
        """The closed form; under loads the rod, held against itself solved more tightly."""
        loaded = self.question.design.loaded_rod.loads.any
        if not loaded:
            reply = self.ask(RodOnOutline(), 1)
            estimate = np.where(reply.found, 0.0, np.nan)
            reason = "the law is the beam's own and nothing but pressure acts: a closed form"
            return self._ended(reply, estimate, reason)
        coarse = self.ask(RodOnOutline(self.accuracy), 2)
        reply = self.ask(RodOnOutline(self.accuracy / FINER_ROD), 1)
        reason = "the law is the beam's own; loads make it a boundary-value problem"
        return self._ended(reply, coarse.away(reply.tips), reason)

    def solids(self, most_seconds: float) -> Within:
        """Two levels from the one that charts promise it of, then finer ones."""
        question = self.question
        reason = f"only a solid answers {question.law_text}"
        if question.is_of_the_beam:
            reason = "a solid was asked for"
        missing = question.no_solid or levels_for(question)[0].model.refuses(question)
        if missing is not None:
            return self._nothing(Ending.NO_MODEL, f"{reason}: {missing}")
        levels, scale = levels_for(question), scale_of(question)
        place = self._first(levels, scale)
        said = f"charts promise {levels[place].error * scale:.2g} mm of {_named(levels[place])}"
        reason = f"{reason}; {said}"
        coarse, model = self._coarse(levels[place - 1])
        while True:
            fine = self.ask(self._like(levels[place].model, model), 1)
            if not fine.found.any() and not coarse.found.any():
                return self._nothing(Ending.NO_TIP, f"{reason}; {fine.reason}")
            estimate = self._estimate(levels[place - 1], levels[place], coarse, fine)
            within = self._ended(fine, estimate, reason)
            if within.ending is Ending.REACHED:
                return within
            if place + 1 == len(levels):
                return within
            growth = levels[place + 1].seconds / levels[place].seconds
            if self.tried[-1].seconds * growth > most_seconds:
                return replace(within, ending=Ending.TOO_DEAR)
            coarse, place = fine, place + 1

    def _first(self, levels: Sequence[Level], scale: float) -> int:
        near = [k for k, one in enumerate(levels) if one.error * scale <= COMFORT * self.accuracy]
        return max(min(near, default=len(levels) - 1), LEAST)

    def _coarse(self, level: Level) -> tuple[Reply, SolidModel]:
        """The first level; of the beam's own law also what stiffer penalties make of it."""
        model = level.model
        coarse = self.ask(model, 3)
        self.of_penalty: FloatArray = np.zeros(len(self.question.pressures))
        if not self.question.is_of_the_beam:
            return coarse, model
        stiffer = replace(model, penalties=STIFFER)
        checked = self.ask(stiffer, 2)
        self.of_penalty = checked.away(coarse.tips)
        known = self.of_penalty[np.isfinite(self.of_penalty)]
        if known.size and known.max() > self.accuracy / 4:
            self.of_penalty = self.of_penalty / REMAINDER
            return checked, stiffer
        return coarse, model

    def _like(self, level: SolidModel, first: SolidModel) -> SolidModel:
        return replace(level, penalties=first.penalties)

    def _estimate(self, before: Level, level: Level, coarse: Reply, fine: Reply) -> FloatArray:
        """What two levels and two pairs of penalties tell (n,) [mm]."""
        order = 4.0 if self.question.is_of_the_beam else 2.0
        left = SAFETY / ((level.model.layers / before.model.layers) ** order - 1)
        return np.asarray(fine.away(coarse.tips) * left + self.of_penalty)

    def _ended(self, reply: Reply, estimate: FloatArray, reason: str) -> Within:
        """Reached where every tip that any model has is there, and near enough."""
        some = np.any([one.reply.found for one in self.tried], axis=0)
        unsure = some & ~(estimate <= self.accuracy)
        if not some.any():
            return self._nothing(Ending.NO_TIP, f"{reason}; {reply.reason}")
        ending = Ending.NOT_REACHED if unsure.any() else Ending.REACHED
        return Within(
            self.question, self.accuracy, ending, reply, estimate, tuple(self.tried), reason
        )

    def _nothing(self, ending: Ending, reason: str) -> Within:
        estimate = np.full(len(self.question.pressures), np.nan)
        last = self.tried[-1].reply if self.tried else None
        return Within(
            self.question, self.accuracy, ending, last, estimate, tuple(self.tried), reason
        )


def _named(level: Level) -> str:
    return f"{level.model.family} {level.model.resolution}"
