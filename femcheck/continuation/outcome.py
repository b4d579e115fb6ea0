"""How finding an equilibrium ended."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from femcheck.solid.state import State

__all__ = ["SolidOutcome", "Statistics", "Status"]


class Status(Enum):
    """How a case ended; the value is the text shown to people.

    Examples
    --------
    >>> import femcheck
    >>> femcheck.Status.LIMIT_POINT.is_physical
    True
    """

    CONVERGED = "converged"
    LIMIT_POINT = "limit point"
    BUCKLED = "buckled"
    BEYOND_LAW = "stretched beyond what the law describes"
    INVERTED = "an element turned inside out"
    STEP_TOO_SMALL = "load steps became too small"
    LINEAR_SOLVER = "the linear solver found no solution"
    WORK_LIMIT = "work limit reached"
    TIME_OUT = "time limit reached"
    STOPPED = "its process ended before it was solved"

    @property
    def is_interrupted(self) -> bool:
        """True if a clock or the death of its process ended it: tried again it may end otherwise.

        All other endings are the same whatever else the machine does.
        """
        return self in (Status.TIME_OUT, Status.STOPPED)

    @property
    def is_physical(self) -> bool:
        """True if the actuator has no stable equilibrium there; other endings say nothing of it."""
        return self in (Status.LIMIT_POINT, Status.BUCKLED)

    @property
    def is_limit(self) -> bool:
        """True if a limit on work or on time ended it, and nothing that it computed."""
        return self in (Status.WORK_LIMIT, Status.TIME_OUT)

    @property
    def is_settled(self) -> bool:
        """True if the actuator or its law ends there: no finer mesh and no more work changes it."""
        return self.is_physical or self is Status.BEYOND_LAW


@dataclass
class Statistics:
    """Cost of an equilibrium: sums over all its load steps. Seconds are of processor time."""

    steps: int = 0
    iterations: int = 0
    seconds: float = 0.0
    assembly_seconds: float = 0.0
    factor_seconds: float = 0.0
    solve_seconds: float = 0.0

    def add(self, part: Statistics) -> None:
        """Add what a part of it cost; the whole time is measured by itself."""
        self.steps += part.steps
        self.iterations += part.iterations
        self.assembly_seconds += part.assembly_seconds
        self.factor_seconds += part.factor_seconds
        self.solve_seconds += part.solve_seconds


@dataclass(frozen=True)
class SolidOutcome:
    """An equilibrium, or why there is none.

    state : the equilibrium; None unless converged.
    reached : share of the load at which the last equilibrium was found.
    residual : largest out-of-balance force at it [mN].
    negative_eigenvalues : of the tangent there; 0 for a stable equilibrium, None where the solver
        can not count them: stability was not checked then. In the mixed form those beyond the
        ones of the hydrostatic pressures.
    negative_at_start : the same at the state that the search began with, converged or not.
    """

    status: Status
    state: State | None
    reached: float = 0.0
    residual: float = float("nan")
    negative_eigenvalues: int | None = None
    statistics: Statistics = field(default_factory=Statistics)
    negative_at_start: int | None = None
