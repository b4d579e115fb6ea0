"""The potential of the pressurised solid, its forces and its symmetric tangent.

Π(x) = ∫ W(C) dV − Σ P_i V_i(x). V_i is what supply i's walls and the two caps that close its
chambers enclose; the cap on the clamped face adds nothing (it lies in the plane z = 0), the one at
the tip is plane because the tip face is a rigid plate. Its first derivative is the follower
pressure on the walls and the thrust on the caps; its second is symmetric because the cavities are
closed.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass

import numpy as np

from beamopt.arrays import FloatArray
from femcheck.assembly.elements import add_element_forces, add_element_stiffness, deformation
from femcheck.assembly.pattern import make_pattern, places_in
from femcheck.assembly.reduction import Reduction, UpperMatrix
from femcheck.assembly.walls import add_wall_forces, add_wall_stiffness, wall_volumes
from femcheck.material.law import Law
from femcheck.solid.body import Body
from femcheck.solid.plate import cross_matrix, symmetric_turn
from femcheck.solid.state import State

__all__ = ["Equilibrium", "Forces"]


@dataclass(frozen=True, eq=False)
class Forces:
    """The derivative of the potential at a state, and what it was made of.

    nodal : (n, 3) ∂Π/∂x of every node as if it were free, walls included, caps not [mN].
    reduced : (unknowns,) ∂Π by the free nodes, the plate's position [mN] and its turn [mN mm].
    F, C, S : deformation and stress at the quadrature points.
    least_volume_ratio : smallest det F at a quadrature point; inverted where it is not positive.
    """

    nodal: FloatArray
    reduced: FloatArray
    F: FloatArray
    S: FloatArray
    C: FloatArray
    least_volume_ratio: float


class Equilibrium:
    """A body of one law, ready to be asked for energy, forces and tangent."""

    def __init__(self, body: Body, law: Law) -> None:
        self.body = body
        self.law = law
        held = np.zeros(len(body.nodes), dtype=np.bool_)
        held[body.base] = True
        on_plate = np.zeros_like(held)
        on_plate[body.tip] = True
        self.free = np.flatnonzero(~held & ~on_plate)
        blocks = np.full(len(body.nodes), -1)
        blocks[self.free] = np.arange(self.free.size)
        blocks[body.tip] = self.free.size + np.arange(body.tip.size)
        self._pattern = make_pattern(body.connectivity, blocks)
        self._element_blocks = blocks[body.connectivity]
        self._element_places = places_in(self._pattern, body.connectivity)
        self._wall_blocks = blocks[body.walls]
        self._wall_places = places_in(self._pattern, body.walls)
        self._reduction = Reduction(self._pattern, self.free.size)
        facet = body.facet
        self._facet = (facet.values, facet.along, facet.across, facet.weights)

    def with_law(self, law: Law) -> Equilibrium:
        """The same body of another law; they share the pattern of the tangent."""
        other = copy(self)
        other.law = law
        return other

    def volumes(self, state: State) -> FloatArray:
        """(3,) volume that each supply's chambers enclose, caps included [mm³]."""
        body, volumes = self.body, np.zeros(3)
        wall_volumes(state.x, body.walls, body.wall_supply, *self._facet, volumes)
        return volumes + body.cap_areas * (state.tip @ state.turn[:, 2]) / 3

    def strain_energy(self, state: State) -> float:
        """∫ W dV [mN mm]; infinite where an element is inverted."""
        _, C, least = self._deformation(state)
        if least <= 0:
            return float("inf")
        density = self.law.energy(C.reshape(-1, 6)).reshape(self.body.weights.shape)
        return float((density * self.body.weights).sum())

    def potential(self, state: State, pressures: FloatArray) -> float:
        """Π [mN mm] at pressures (3,) [kPa]."""
        return self.strain_energy(state) - float(pressures @ self.volumes(state))

    def forces(self, state: State, pressures: FloatArray) -> Forces:
        """The derivative of the potential."""
        body = self.body
        F, C, least = self._deformation(state)
        nodal = np.zeros_like(state.x)
        if least <= 0:
            nothing = np.full(body.unknowns, np.nan)
            return Forces(nodal, nothing, F, C, C, least)
        S = self.law.stress(C.reshape(-1, 6)).reshape(C.shape)
        add_element_forces(body.connectivity, body.gradients, body.weights, F, S, nodal)
        scale = -pressures[body.wall_supply - 1]
        add_wall_forces(state.x, body.walls, scale, *self._facet, nodal)
        return Forces(nodal, self._reduced(state, pressures, nodal), F, S, C, least)

    def volume_gradient(self, state: State, supply: int) -> FloatArray:
        """(unknowns,) derivative of a supply's volume by the unknowns [mm²; mm³]."""
        body = self.body
        nodal = np.zeros_like(state.x)
        scale = (body.wall_supply == supply).astype(np.float64)
        add_wall_forces(state.x, body.walls, scale, *self._facet, nodal)
        pressures = np.zeros(3)
        pressures[supply - 1] = -1.0
        return self._reduced(state, pressures, nodal)

    def tangent(self, state: State, pressures: FloatArray, forces: Forces) -> UpperMatrix:
        """The second derivative of the potential: the upper triangle by the unknowns."""
        body, pattern = self.body, self._pattern
        data = np.zeros(pattern.indices.size)
        C = forces.C
        D = self.law.stiffness(C.reshape(-1, 6)).reshape(*C.shape, 6)
        add_element_stiffness(
            body.gradients,
            body.weights,
            forces.F,
            forces.S,
            D,
            self._element_blocks,
            self._element_places,
            pattern.starts,
            data,
        )
        scale = -pressures[body.wall_supply - 1]
        add_wall_stiffness(
            state.x,
            body.walls,
            scale,
            *self._facet,
            self._wall_blocks,
            self._wall_places,
            pattern.starts,
            data,
        )
        arms = state.x[body.tip] - state.tip
        plate = self._plate_stiffness(state, pressures, forces.nodal[body.tip], arms)
        return self._reduction(data, _plate_modes(arms), plate)

    def _deformation(self, state: State) -> tuple[FloatArray, FloatArray, float]:
        body = self.body
        F = np.empty((*body.weights.shape, 3, 3))
        C = np.empty((*body.weights.shape, 6))
        least = deformation(state.x, body.connectivity, body.gradients, F, C)
        return F, C, float(least)

    def _thrust(self, pressures: FloatArray) -> float:
        """Factor of −tip · n in the potential: a third of what presses on the tip's caps [mN]."""
        return float(pressures @ self.body.cap_areas) / 3

    def _reduced(self, state: State, pressures: FloatArray, nodal: FloatArray) -> FloatArray:
        tip = self.body.tip
        thrust, normal = self._thrust(pressures), state.turn[:, 2]
        position = nodal[tip].sum(axis=0) - thrust * normal
        arms = state.x[tip] - state.tip
        turn = np.cross(arms, nodal[tip]).sum(axis=0) - thrust * np.cross(normal, state.tip)
        return np.concatenate([nodal[self.free].ravel(), position, turn])

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
