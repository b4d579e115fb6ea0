"""Answering to an accuracy: rung and resolution chosen, the error estimated, finer if need be."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Literal, Protocol

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError
from femcheck.accuracy.ending import Ending, Source, Tried, Within
from femcheck.accuracy.knowledge import MATERIAL, ORDERS, RIGID, Level, levels_for, scale_of
from femcheck.chart.lineup import STIFFER
from femcheck.chart.measure import Measured
from femcheck.models.beam import TIGHTEST, RodOnOutline
from femcheck.models.question import Question
from femcheck.models.reply import Model, Reply, cpu_seconds
from femcheck.models.solid import SolidModel

__all__ = ["Kept", "RungChoice", "answer_within", "check_asked"]

RungChoice = Literal["auto", "beam", "solid"]

COMFORT = 0.5  # of the accuracy: the error that a chart has to promise for a level to be begun with
SAFETY = 2.0  # on estimates from changes, of the order of theory; covers 2.74 for 4, 1.2 for 2
FINER_ROD = 100.0  # how many times tighter the rod is solved that the first one is held against
STIFF = 1.5  # times what stiffer penalties change is left of the usual ones' error: 16/15 in theory
FINER_TRIANGLES = 4.0  # how many times smaller those are that the usual ones are held against
TRIANGLES = 1.5  # times what finer ones change is left of their error: 4/3 at first order
REMAINDER = 8.0  # of the usual penalties' own error over the stiffer ones': 16 in theory
DEARER = 1.6  # power of the layers with which a solid's cost grows


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

    Examples
    --------
    >>> import femcheck
    >>> import beamopt
    >>> drawn = beamopt.load_design(str(beamopt.load_scene("gravity").target.file))
    >>> subject = femcheck.sealed_copy("round", drawn, 1.0)
    >>> question = femcheck.Question.of("round", subject.design, femcheck.CheckOptions())
    >>> within = femcheck.answer_within(question, 0.1)
    >>> within.reply is not None and within.reply.is_whole
    True
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
        self.path: list[tuple[int, Reply]] = []  # layers and replies of refined solids

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
            exact = np.where(reply.found, 0.0, np.nan)
            reason = "the law is the beam's own and nothing but pressure acts: a closed form"
            within = self._ended(reply, exact, reason, Source.CLOSED_FORM)
            return replace(within, estimate=np.full_like(exact, np.nan))
        reason = "the law is the beam's own; loads make it a boundary-value problem"
        tightest = TIGHTEST * self.question.design.actuator.length
        tolerance = max(self.accuracy, FINER_ROD * tightest)
        coarse = self.ask(RodOnOutline(tolerance), 2)
        while True:
            tolerance = max(tolerance / FINER_ROD, tightest)
            reply = self.ask(RodOnOutline(tolerance), 1)
            estimate = coarse.away(reply.tips) + tolerance
            within = self._ended(reply, estimate, reason, Source.TIGHTER)
            if within.ending is not Ending.NOT_REACHED or tolerance == tightest:
                return within
            coarse = reply

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
        place, pairs = self._first(levels, scale), 1 if question.is_of_the_beam else 2
        said = f"charts promise {levels[place].error * scale:.2g} mm of {_named(levels[place])}"
        reason = f"{reason}; {said}"
        begin = max(place - pairs, 0)
        penalties = self._begun(levels[begin].model)
        within = self._ended(self.path[0][1], np.full_like(self.of_penalty, np.nan), reason)
        for level in levels[begin + 1 :]:
            finer = replace(level.model, penalties=penalties)
            growth = (level.model.layers / self.path[-1][0]) ** DEARER
            if self.tried[-1].seconds * growth > most_seconds and not self._is_known(finer):
                unsure = within.ending is Ending.NOT_REACHED
                return replace(within, ending=Ending.TOO_DEAR) if unsure else within
            fine = self._refined(finer)
            if len(self.path) <= pairs:
                continue
            within = self._ended(fine, self._estimate(), reason, Source.COARSER)
            if within.ending is Ending.REACHED or level is levels[-1]:
                return within
        raise AssertionError("the last level ends it")

    def _is_known(self, model: Model) -> bool:
        return self.kept is not None and self.kept.find(model) is not None

    def _first(self, levels: Sequence[Level], scale: float) -> int:
        """The first level that charts promise the accuracy of."""
        near = [k for k, one in enumerate(levels) if one.error * scale <= COMFORT * self.accuracy]
        least = 1 if self.question.is_of_the_beam else 2
        return max(min(near, default=len(levels) - 1), least)

    def _begun(self, model: SolidModel) -> tuple[float, float]:
        """Ask the coarsest level, and what finer triangles make of it.

        Of the beam's own law also what stiffer penalties do.
        """
        reply = self._refined(model, foreseen=4)
        finer = self.ask(replace(model, size=model.size / FINER_TRIANGLES), 3)
        self.of_size = finer.away(reply.tips) * TRIANGLES
        self.of_penalty: FloatArray = np.zeros(len(self.question.pressures))
        if not self.question.is_of_the_beam:
            return model.penalties
        stiffer = replace(model, penalties=STIFFER)
        checked = self.ask(stiffer, 2)
        self.of_penalty = checked.away(reply.tips)
        known = self.of_penalty[np.isfinite(self.of_penalty)]
        if known.size and known.max() > self.accuracy / 4:
            self.of_penalty = self.of_penalty / REMAINDER
            self.path = [(model.layers, checked)]
            return STIFFER
        self.of_penalty = self.of_penalty * STIFF
        return model.penalties

    def _refined(self, model: SolidModel, foreseen: int = 1) -> Reply:
        """Ask a level and remember its place on the way."""
        reply = self.ask(model, foreseen)
        self.path.append((model.layers, reply))
        return reply

    def _estimate(self) -> FloatArray:
        """Errors (n,) of the last level: C layers⁻ᵖ with the larger C of the last two changes.

        One change alone may be small by chance. What penalties and triangles leave is added.
        """
        order = ORDERS[RIGID if self.question.is_of_the_beam else MATERIAL]
        constants = [
            fine.away(coarse.tips) / (few**-order - many**-order)
            for (few, coarse), (many, fine) in pairwise(self.path[-3:])
        ]
        left = SAFETY * np.max(constants, axis=0) * self.path[-1][0] ** -order
        return np.asarray(left + self.of_penalty + self.of_size)

    def _ended(
        self, reply: Reply, estimate: FloatArray, reason: str, source: Source = Source.NOTHING
    ) -> Within:
        """Reached where every tip that any model has is there, and near enough."""
        some = np.any([one.reply.found for one in self.tried], axis=0)
        lost = [not one.is_found and not one.status.is_settled for one in reply.endings]
        unsure = (some & ~(estimate <= self.accuracy)) | np.array(lost)
        if not some.any() and not any(lost):
            return self._nothing(Ending.NO_TIP, f"{reason}; {reply.ended}")
        ending = Ending.NOT_REACHED if unsure.any() else Ending.REACHED
        tried = tuple(self.tried)
        return Within(self.question, self.accuracy, ending, reply, estimate, tried, reason, source)

    def _nothing(self, ending: Ending, reason: str) -> Within:
        estimate = np.full(len(self.question.pressures), np.nan)
        last = self.tried[-1].reply if self.tried else None
        return Within(
            self.question, self.accuracy, ending, last, estimate, tuple(self.tried), reason
        )


def _named(level: Level) -> str:
    return f"{level.model.family} {level.model.resolution}"
