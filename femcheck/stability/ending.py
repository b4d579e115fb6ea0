"""How a cell of the map ended: with an equilibrium, with the reason why not, or without a solid."""

from __future__ import annotations

from enum import Enum

from femcheck.continuation.outcome import Status

__all__ = ["MapEnding", "ending_of"]


class MapEnding(Enum):
    """How a cell ended; the value is the text shown to people."""

    STABLE = "stable equilibrium"
    UNCHECKED = "equilibrium, stability not checked"
    UNSTABLE = "equilibrium that is unstable"
    LIMIT_POINT = Status.LIMIT_POINT.value
    BUCKLED = Status.BUCKLED.value
    BEYOND_LAW = Status.BEYOND_LAW.value
    INVERTED = Status.INVERTED.value
    STEP_TOO_SMALL = Status.STEP_TOO_SMALL.value
    LINEAR_SOLVER = Status.LINEAR_SOLVER.value
    WORK_LIMIT = Status.WORK_LIMIT.value
    TIME_OUT = Status.TIME_OUT.value
    STOPPED = Status.STOPPED.value
    NO_MESH = "no mesh"
    NO_PAIR = "element without a stable pair for this law"

    @property
    def has_equilibrium(self) -> bool:
        """Whether there is a stable equilibrium, as far as is known."""
        return self in (MapEnding.STABLE, MapEnding.UNCHECKED)

    @property
    def is_interrupted(self) -> bool:
        """True if a map that goes on tries it once more, as of the `Status` of its name."""
        return self.name in Status.__members__ and Status[self.name].is_interrupted

    @property
    def says_none(self) -> bool:
        """Whether the solver found out that the stable path ends below this pressure."""
        return self in (MapEnding.LIMIT_POINT, MapEnding.BUCKLED)


def ending_of(status: Status, unstable: int | None) -> MapEnding:
    """The ending of a case.

    unstable : directions in which an equilibrium that was found is unstable; None: not known.
    """
    if status is not Status.CONVERGED:
        return MapEnding[status.name]
    if unstable is None:
        return MapEnding.UNCHECKED
    return MapEnding.UNSTABLE if unstable > 0 else MapEnding.STABLE
