"""How nodes are held and moved: from forces and stiffness of all nodes to those of the unknowns."""

from __future__ import annotations

from typing import Any, Protocol

from beamopt.base.arrays import FloatArray, IndexArray
from femcheck.assembly.pattern import Pattern
from femcheck.assembly.reduction import UpperMatrix
from femcheck.solid.state import State

__all__ = ["Support"]


class Support(Protocol):
    """What relates the nodes to the unknowns of an equilibrium; ∂x = T ∂q."""

    @property
    def blocks(self) -> IndexArray:
        """(n,) row of each node among those that move; −1 for a node that is held."""
        ...

    @property
    def unknowns(self) -> int:
        """Number of unknowns q that move nodes."""
        ...

    def prepare(self, pattern: Pattern) -> None:
        """Learn the pattern of the stiffness of all moving nodes."""
        ...

    def rest(self) -> State:
        """The undeformed body."""
        ...

    def moved(self, state: State, step: FloatArray) -> State:
        """The state after a step of the unknowns; what is behind them is hydrostatic pressure."""
        ...

    def cap_volumes(self, state: State) -> FloatArray:
        """(3,) volumes that belong to no facet [mm³]."""
        ...

    def forces(self, state: State, pressures: FloatArray, nodal: FloatArray) -> FloatArray:
        """(unknowns,) Tᵀ nodal, and what caps add; nodal (n, 3) [mN]."""
        ...

    def stiffness(
        self, state: State, pressures: FloatArray, nodal: FloatArray, data: FloatArray
    ) -> UpperMatrix:
        """Tᵀ K T + ∂Tᵀ nodal from the pattern's data."""
        ...

    def columns(self, state: State, columns: Any) -> Any:
        """Tᵀ B, compressed rows, for B (3 moving nodes, m)."""
        ...

    def extent(self, step: FloatArray) -> tuple[float, float]:
        """Largest displacement [mm] and largest turn [rad] in a step."""
        ...
