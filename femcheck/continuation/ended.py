"""How a tip was found, or why there is none: a status, the pressure, and what else is known."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from beamopt.rod.status import RodStatus
from femcheck.continuation.outcome import Status
from femcheck.mesh.gmsh_section import MeshFailure, MeshProblem

__all__ = ["FOUND", "Ended", "NoReply", "ReplyStatus"]


class NoReply(Enum):
    """Reason for no reply, whatever the pressures; the value is the text shown to people."""

    NOT_STIFF = "the raster has too little material to bend"
    TOO_DEAR = "left out: expected to take too long"
    UNKNOWN_COST = "left out: a coarser one has no answer"
    NOT_FINITE = "not a number"
    BROKEN = "no answer"

    @property
    def is_interrupted(self) -> bool:
        """True if it may be otherwise another time: with more time allowed."""
        return self in (NoReply.TOO_DEAR, NoReply.UNKNOWN_COST)

    @property
    def is_settled(self) -> bool:
        """False: it says nothing of the actuator."""
        return False


ReplyStatus = Status | RodStatus | MeshProblem | NoReply
"""Each has `is_interrupted` and `is_settled`."""

GROUPS: dict[str, type[ReplyStatus]] = {
    "solid": Status,
    "rod": RodStatus,
    "mesh": MeshProblem,
    "model": NoReply,
}
"""What a status is of, as its key in files has it: statuses of two groups share names."""


@dataclass(frozen=True, slots=True)
class Ended:
    """Ending of the search for a tip; `str` of it is the text for people.

    load : P at which it ended [kPa]; None where there is none, or it is not known.
    detail : what else there is to say.
    """

    status: ReplyStatus
    load: float | None = None
    detail: str = ""

    @property
    def is_found(self) -> bool:
        """True if there is a tip."""
        return self.status in (Status.CONVERGED, RodStatus.CONVERGED)

    @property
    def key(self) -> str:
        """The status as files have it, "solid.LIMIT_POINT": names stay when texts change."""
        group = next(name for name, kind in GROUPS.items() if isinstance(self.status, kind))
        return f"{group}.{self.status.name}"

    @classmethod
    def of_key(cls, key: str, load: float | None = None, detail: str = "") -> Ended:
        """The ending that a key names.

        Raises
        ------
        ValueError : there is no such key.
        """
        group, _, name = key.partition(".")
        try:
            return cls(GROUPS[group][name], load, detail)
        except KeyError:
            raise ValueError(f"no status is called {key}") from None

    @classmethod
    def of_mesh(cls, failure: MeshFailure) -> Ended:
        """The ending where there is no mesh."""
        return cls(failure.problem, detail=failure.detail)

    def __str__(self) -> str:
        if self.is_found:
            return str(Status.CONVERGED.value)
        load = "" if self.load is None else f" at P = {self.load:.4g} kPa"
        return f"{self.status.value}{load}" + (f": {self.detail}" if self.detail else "")


FOUND = Ended(Status.CONVERGED)
