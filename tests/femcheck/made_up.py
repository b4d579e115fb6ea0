"""Solids that are formulas: tips that are off by what the test says, at no cost."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from unittest.mock import patch

import numpy as np

from beamopt.base.arrays import FloatArray
from femcheck.check.options import CheckOptions
from femcheck.continuation.ended import FOUND, Ended
from femcheck.continuation.outcome import Status
from femcheck.models.question import LawChoice, Question
from femcheck.models.reply import Reply
from femcheck.models.solid import PENALTIES, SolidModel
from femcheck.prediction.options import PredictionOptions
from femcheck.solid.elements import ELEMENTS
from tests.femcheck.check.small import design_of, three_circles

AT = np.array([[20.0, 0.0, 0.0], [40.0, 20.0, 0.0], [0.0, 40.0, 40.0]])
NEO = PredictionOptions()
RIGID = CheckOptions()
LIMIT = Ended(Status.LIMIT_POINT, 3.0)
DESIGN = design_of(three_circles())

Off = Callable[[SolidModel], float]


def question_of(law: LawChoice = RIGID, pressures: FloatArray | None = AT) -> Question:
    return Question.of("made-up", DESIGN, law, pressures)


def powers(constant: float, order: float) -> Off:
    """C layers⁻ᵖ."""
    return lambda model: constant * model.layers**-order


@dataclass
class MadeUp:
    """Solids whose tips are the beam's, which are taken for the truth, but for `off` [mm].

    off : how far a model is off. shares : (n, 3) along which directions; along x if left out.
    missing : rows without a tip, by model. ended : why. asked : models that were asked.
    seconds : what a model takes of a clock that `clock` reads.
    """

    off: Off
    shares: FloatArray | None = None
    missing: Callable[[SolidModel], Sequence[int]] = lambda model: ()
    ended: Ended = LIMIT
    seconds: Callable[[SolidModel], float] = lambda model: float(model.layers)
    asked: list[SolidModel] = field(default_factory=list)
    spent: float = 0.0

    def reply(self, model: SolidModel, question: Question, workers: int = 0) -> Reply:
        self.asked.append(model)
        self.spent += self.seconds(model)
        n = len(question.pressures)
        shares = np.tile([1.0, 0.0, 0.0], (n, 1)) if self.shares is None else self.shares
        tips = question.design.tips(question.pressures) + self.off(model) * shares
        gone = list(self.missing(model))
        tips[gone] = np.nan
        endings = tuple(self.ended if row in gone else FOUND for row in range(n))
        return Reply(tips, endings, 1000 * model.layers, f"{model.layers} made-up layers")

    def clock(self) -> float:
        return self.spent

    @contextmanager
    def instead(self) -> Iterator["MadeUp"]:
        """Solids are these, and processor time is theirs."""
        with (
            patch.object(SolidModel, "reply", lambda *asked: self.reply(*asked)),
            patch("femcheck.accuracy.within.cpu_seconds", self.clock),
            patch("femcheck.chart.measure.cpu_seconds", self.clock),
            patch("femcheck.chart.measure._WARM", set(ELEMENTS)),
        ):
            yield self


def of_penalty(constant: float) -> Off:
    """What an extrapolation from two penalties leaves: in the square of the higher one."""
    return lambda model: constant * (PENALTIES[1] / model.penalties[1]) ** 2
