"""An actuator's support: base clamped, tip face on a rigid plate, caps that close the chambers."""

from __future__ import annotations

from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from femcheck.assembly.pattern import Pattern
from femcheck.assembly.reduction import Reduction, UpperMatrix
from femcheck.solid.body import Body
from femcheck.solid.plate import cross_matrix, symmetric_turn
from femcheck.solid.state import State, moved, rest_state

__all__ = ["TipPlate"]


class TipPlate:
    """Unknowns: free nodes (3 each), then the plate's position and its turn (finite rotation)."""

    def __init__(self, body: Body) -> None:
        self.body = body
        held = np.zeros(len(body.nodes), dtype=np.bool_)
        held[body.base] = True
        on_plate = np.zeros_like(held)
        on_plate[body.tip] = True
        self.free = np.flatnonzero(~held & ~on_plate)
        self.blocks: IndexArray = np.full(len(body.nodes), -1)
        self.blocks[self.free] = np.arange(self.free.size)
        self.blocks[body.tip] = self.free.size + np.arange(body.tip.size)
        self.unknowns = body.unknowns
        self._coupled: IndexArray | None = None

    def prepare(self, pattern: Pattern) -> None:
        """Learn the pattern of the stiffness of all moving nodes."""
        self._reduction = Reduction(pattern, self.free.size)

    def rest(self) -> State:
        """The undeformed body."""
        return rest_state(self.body)

    def moved(self, state: State, step: FloatArray) -> State:
        """The state after a step of the unknowns."""
        return moved(self.body, state, self.free, step)

    def cap_volumes(self, state: State) -> FloatArray:
        """(3,) a third of cap area times height over the origin along its normal [mm³]."""
        return np.asarray(self.body.cap_areas * (state.tip @ state.turn[:, 2]) / 3)

    def forces(self, state: State, pressures: FloatArray, nodal: FloatArray) -> FloatArray:
        """(unknowns,) of the free nodes, then force and moment on the plate, caps included."""
        tip = self.body.tip
        thrust, normal = self._thrust(pressures), state.turn[:, 2]
        position = nodal[tip].sum(axis=0) - thrust * normal
        arms = state.x[tip] - state.tip
        turn = np.cross(arms, nodal[tip]).sum(axis=0) - thrust * np.cross(normal, state.tip)
        return np.concatenate([nodal[self.free].ravel(), position, turn])

    def stiffness(
        self, state: State, pressures: FloatArray, nodal: FloatArray, data: FloatArray
    ) -> UpperMatrix:
        """The upper triangle by the unknowns, from the pattern's data."""
        arms = state.x[self.body.tip] - state.tip
        plate = self._plate_stiffness(state, pressures, nodal[self.body.tip], arms)
        return self._reduction(data, _plate_modes(arms), plate)

    def columns(self, state: State, columns: Any) -> Any:
        """Rows of the free nodes as they are, those of the tip's nodes as six of the plate."""
        from scipy.sparse import csr_array

        free = 3 * self.free.size
        ends, of_tip = columns.indptr[: free + 1], columns[free:]
        if self._coupled is None:
            self._coupled = np.unique(of_tip.indices)
        coupled = self._coupled
        modes = _plate_modes(state.x[self.body.tip] - state.tip)
        plate = modes.T @ of_tip[:, coupled].toarray()
        data = np.concatenate([columns.data[: ends[-1]], plate.ravel()])
        indices = np.concatenate([columns.indices[: ends[-1]], np.tile(coupled, 6)])
        starts = np.concatenate([ends, ends[-1] + coupled.size * np.arange(1, 7)])
        return csr_array((data, indices, starts), shape=(free + 6, columns.shape[1]))

    def extent(self, step: FloatArray) -> tuple[float, float]:
        """Largest displacement [mm] and largest turn [rad] in a step."""
        plate = 3 * self.free.size
        far = float(np.abs(step[: plate + 3]).max())
        return far, float(np.abs(step[plate + 3 : plate + 6]).max())

    def _thrust(self, pressures: FloatArray) -> float:
        """Factor of −tip · n in the potential: a third of what presses on the tip's caps [mN]."""
        return float(pressures @ self.body.cap_areas) / 3

    def _plate_stiffness(
        self, state: State, pressures: FloatArray, forces: FloatArray, arms: FloatArray
    ) -> FloatArray:
        """(6, 6) what the plate's own motion adds: turning arms and turning caps."""
        thrust, normal = self._thrust(pressures), state.turn[:, 2]
        H = np.zeros((6, 6))
        H[:3, 3:] = thrust * cross_matrix(normal)
        H[3:, :3] = H[:3, 3:].T
        H[3:, 3:] = symmetric_turn(forces, arms) - thrust * symmetric_turn(state.tip, normal)
        return H


def _plate_modes(arms: FloatArray) -> FloatArray:
    """(3 m, 6) motion of the plate's nodes by its position and its turn: δx = δh + δθ × arm."""
    modes = np.zeros((len(arms), 3, 6))
    modes[:, :, :3] = np.eye(3)
    modes[:, :, 3:] = -cross_matrix(arms)
    return modes.reshape(-1, 6)
