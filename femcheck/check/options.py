"""What is asked of a check of the implementation."""

from __future__ import annotations

from dataclasses import dataclass

from beamopt.base.brief import changed_fields
from beamopt.base.errors import InputError
from femcheck.solved.solid_options import SolidOptions

__all__ = ["CheckOptions"]


@dataclass(frozen=True, slots=True)
class CheckOptions(SolidOptions):
    """How the beam's implementation is checked, against a solid of the rigid-section law.

    Parameters
    ----------
    penalties : c of the law, two of them; the tips are extrapolated in 1/c.

    Raises
    ------
    InputError : a value that can not be used, with what is allowed.

    Examples
    --------
    >>> import femcheck
    >>> femcheck.CheckOptions(agree=0.01, layers=8)
    CheckOptions(agree=0.01, layers=8)
    """

    penalties: tuple[float, float] = (2500.0, 10000.0)

    __repr__ = changed_fields

    def __post_init__(self) -> None:
        SolidOptions.__post_init__(self)
        low, high = self.penalties
        if not 0 < low < high:
            said = "two positive numbers, ascending"
            raise InputError("", "penalties", self.penalties, said)

    @property
    def law(self) -> str:
        """The law that has the beam's own assumptions."""
        return "rigid-section"

    @property
    def question(self) -> dict[str, object]:
        """What must be the same for kept cases to be gone on with."""
        return {"law": self.law, "penalties": list(self.penalties), **self.solid_question}
