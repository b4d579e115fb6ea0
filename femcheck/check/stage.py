"""The solids that a check solves, and which of them follows which."""

from __future__ import annotations

from dataclasses import dataclass

from femcheck.solved.case import Solid

__all__ = ["Stage"]


@dataclass(frozen=True, eq=False)
class Stage:
    """A solid at all pressure combinations.

    mesh : "standard" or "coarse". penalty : c of the law.
    follows : name of the stage whose results at the same pressures are a first guess; or None.
    """

    solid: Solid
    mesh: str
    penalty: float
    follows: str | None = None

    @property
    def name(self) -> str:
        """Its solid's name."""
        return self.solid.name
