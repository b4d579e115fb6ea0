"""How solving a rod ended."""

from __future__ import annotations

from enum import Enum

__all__ = ["RodStatus"]


class RodStatus(Enum):
    """The value is the text shown to people. Only a rod that converged has a tip."""

    CONVERGED = "stable equilibrium"
    LIMIT_POINT = "limit point: no equilibrium near this one at a higher load"
    BUCKLED = "buckled: the straight way on is unstable"
    CRUSHED = "compressed to nothing"
    UNRESOLVED = "the finest resolution does not resolve the shape"
    DIVERGED = "the iteration diverged"
    STEPS_TOO_SMALL = "the steps of the load became too small"
    WORK_LIMIT = "work limit reached"
    TOO_SLOW = "took too long"
    SKIPPED = "not looked for, because another one failed"
    NOT_REPRESENTABLE = "the method can not represent this rod"

    @property
    def is_interrupted(self) -> bool:
        """True if a clock ended it: tried again it may end otherwise."""
        return self is RodStatus.TOO_SLOW

    @property
    def is_physical(self) -> bool:
        """True if the rod has no stable equilibrium; other endings say nothing of it."""
        return self in (RodStatus.LIMIT_POINT, RodStatus.BUCKLED, RodStatus.CRUSHED)

    @property
    def is_settled(self) -> bool:
        """True if the rod ends there: no finer resolution and no more work changes it."""
        return self.is_physical
