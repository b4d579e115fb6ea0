"""The question that all models are asked: the tips of one design under a stated material law."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.brief import Brief
from beamopt.scene.design import Design
from beamopt.target.workspace import pressure_grid
from femcheck.check.options import CheckOptions
from femcheck.prediction.options import PredictionOptions
from femcheck.solved.subject import LoadedDesignError, Subject, check_unloaded

__all__ = ["LawChoice", "Question"]

LawChoice = CheckOptions | PredictionOptions
"""Of which law the solid is; of the options that go with a law, mesh and element are the models'.

`CheckOptions` means the beam's own law, rigid-section in the limit of an infinite penalty.
"""


@dataclass(frozen=True, eq=False)
class Question:
    """Where the tip of a design is.

    name : of the design. law : see `LawChoice`.
    pressures : (n, 3) combinations [kPa]; the design's 27 if left out.

    Examples
    --------
    >>> import femcheck
    >>> import beamopt
    >>> drawn = beamopt.load_design(str(beamopt.load_scene("gravity").target.file))
    >>> subject = femcheck.sealed_copy("round", drawn, 1.0)
    >>> femcheck.Question.of("round", subject.design, femcheck.PredictionOptions(law="gent"))
    <Question 'round': 27 tips, gent, ν = 0.5, unreinforced>
    """

    name: str
    design: Design
    law: LawChoice
    pressures: FloatArray

    def __repr__(self) -> str:
        count = len(self.pressures)
        return f"<Question {Brief(self.name)}: {count} tips, {self.law_text}>"

    @classmethod
    def of(
        cls, name: str, design: Design, law: LawChoice, pressures: FloatArray | None = None
    ) -> Question:
        """The question at these pressures, or at the design's 27.

        Raises
        ------
        ValueError : pressures of another shape, or not finite.
        """
        at = pressure_grid(design.pressures) if pressures is None else np.asarray(pressures, float)
        if at.ndim != 2 or at.shape[1] != 3 or not len(at) or not np.isfinite(at).all():
            raise ValueError(f"pressures: finite and (n, 3), not {at.shape}")
        return cls(name, design, law, at)

    def at(self, pressures: FloatArray) -> Question:
        """The same at other pressures (n, 3) [kPa]."""
        return replace(self, pressures=pressures)

    @property
    def is_of_the_beam(self) -> bool:
        """Whether the law is the beam's own, so that a rod answers it without a model error."""
        return isinstance(self.law, CheckOptions)

    @property
    def law_text(self) -> str:
        """The law in a few words."""
        if isinstance(self.law, PredictionOptions):
            return self.law.title
        return "rigid-section, c → ∞"

    @cached_property
    def is_on_grid(self) -> bool:
        """Whether the pressures are the design's 27 combinations in their order."""
        return np.array_equal(self.pressures, pressure_grid(self.design.pressures))

    @cached_property
    def subject(self) -> Subject:
        """What a solid is made of.

        Raises
        ------
        LoadedDesignError : the design has loads, which no solid here has.
        """
        return Subject(self.name, self.design)

    @property
    def no_solid(self) -> str | None:
        """Why no solid can answer; None where one can."""
        try:
            check_unloaded(self.name, self.design)
        except LoadedDesignError as error:
            return str(error)
        if not self.design.seal.rules.sealed:
            return f"{self.name} is not sealed: it is a raster, and a solid is of an outline"
        fatal = self.subject.fatal
        return None if fatal is None else str(fatal)
