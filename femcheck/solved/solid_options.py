"""What both verdicts ask of the solid: its mesh, its element, and how it is solved."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field

from beamopt.base.brief import changed_fields
from beamopt.base.errors import InputError
from femcheck.continuation.limits import Limits
from femcheck.mesh.geo import SectionSizes
from femcheck.mesh.gmsh_section import Mesher
from femcheck.solid.elements import DEFAULT_ELEMENT, ELEMENTS

__all__ = ["SolidOptions"]


@dataclass(frozen=True, slots=True)
class SolidOptions:
    """How a solid is made and solved.

    Parameters
    ----------
    agree : largest difference between beam and solid, as a share of the tip's displacement, with
        which the verdict holds.
    element : name of the element.
    layers : of the standard mesh; None takes as many as the beam's turn needs.
    grading : thickness of the middle layers over that of the end ones.
    sizes : of the standard section mesh.
    iterations, seconds : limits of a case or a ray, see `Limits`.
    solver : "auto", "pardiso" or "superlu".
    mesher : how gmsh is called.

    Raises
    ------
    InputError : a value that can not be used, with what is allowed.
    """

    agree: float = 0.05
    element: str = DEFAULT_ELEMENT
    layers: int | None = None
    grading: float = 1.5
    sizes: SectionSizes = field(default_factory=SectionSizes)
    iterations: int = Limits().iterations
    seconds: float = math.inf
    solver: str = "auto"
    mesher: Mesher = field(default_factory=Mesher)

    __repr__ = changed_fields

    def __post_init__(self) -> None:
        if self.element not in ELEMENTS:
            raise InputError("", "element", self.element, f"one of {', '.join(ELEMENTS)}")
        if not 0 < self.agree <= 1:
            raise InputError("", "agree", self.agree, "above 0 and at most 1 (100 %)")
        if self.layers is not None and not 2 <= self.layers <= 64:
            raise InputError("", "layers", self.layers, "2…64")
        if self.iterations < 1:
            raise InputError("", "iterations", self.iterations, "at least 1")
        if not self.seconds > 0:
            raise InputError("", "seconds", self.seconds, "above 0 s")
        if not 0.1 <= self.sizes.factor <= 10:
            raise InputError("", "size", self.sizes.factor, "0.1…10")

    @property
    def limits(self) -> Limits:
        """Limits of a case or a ray; no part of the question."""
        return Limits(self.iterations, self.seconds)

    @property
    def solid_question(self) -> dict[str, object]:
        """What of the solid must be the same for kept results to be gone on with."""
        return {
            "element": self.element,
            "layers": self.layers,
            "grading": self.grading,
            "sizes": asdict(self.sizes),
        }
