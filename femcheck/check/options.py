"""What is asked of a check."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field

from beamopt.errors import InputError
from femcheck.mesh.geo import SectionSizes
from femcheck.mesh.gmsh_section import Mesher
from femcheck.solid.elements import DEFAULT_ELEMENT, ELEMENTS

__all__ = ["LAWS", "CheckOptions"]

LAWS = ("rigid-section",)


@dataclass(frozen=True, slots=True)
class CheckOptions:
    """How a design is checked.

    Parameters
    ----------
    law : "rigid-section": is the beam implemented right?
    agree : largest difference between beam and solid, as a share of the tip's displacement, with
        which the verdict holds.
    penalties : c of the law, two of them; the tips are extrapolated in 1/c.
    element : name of the element.
    layers : of the standard mesh; None takes as many as the beam's turn needs.
    grading : thickness of the middle layers over that of the end ones.
    sizes : of the standard section mesh.
    seconds : time limit of a case [s].
    solver : "auto", "pardiso" or "superlu".
    mesher : how gmsh is called.

    Raises
    ------
    InputError : a value that can not be used, with what is allowed.
    """

    law: str = "rigid-section"
    agree: float = 0.05
    penalties: tuple[float, float] = (2500.0, 10000.0)
    element: str = DEFAULT_ELEMENT
    layers: int | None = None
    grading: float = 1.5
    sizes: SectionSizes = field(default_factory=SectionSizes)
    seconds: float = 600.0
    solver: str = "auto"
    mesher: Mesher = field(default_factory=Mesher)

    def __post_init__(self) -> None:
        if self.law not in LAWS:
            raise InputError("", "law", self.law, f"one of {', '.join(LAWS)}")
        if self.element not in ELEMENTS:
            raise InputError("", "element", self.element, f"one of {', '.join(ELEMENTS)}")
        if not 0 < self.agree <= 1:
            raise InputError("", "agree", self.agree, "above 0 and at most 1 (100 %)")
        low, high = self.penalties
        if not 0 < low < high:
            said = "two positive numbers, ascending"
            raise InputError("", "penalties", self.penalties, said)
        if self.layers is not None and not 2 <= self.layers <= 64:
            raise InputError("", "layers", self.layers, "2…64")
        if not 0.1 <= self.sizes.factor <= 10:
            raise InputError("", "size", self.sizes.factor, "0.1…10")

    @property
    def question(self) -> dict[str, object]:
        """What must be the same for kept cases to be gone on with."""
        return {
            "law": self.law,
            "penalties": list(self.penalties),
            "element": self.element,
            "layers": self.layers,
            "grading": self.grading,
            "sizes": asdict(self.sizes),
        }
