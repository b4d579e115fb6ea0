"""The potential of the pressurised solid, its forces and its symmetric tangent.

Π(x) = ∫ W(C) dV − Σ P_i V_i(x). V_i is what supply i's walls and the two caps that close its
chambers enclose; the cap on the clamped face adds nothing (it lies in the plane z = 0), the one at
the tip is plane because the tip face is a rigid plate. Its first derivative is the follower
pressure on the walls and the thrust on the caps; its second is symmetric because the cavities are
closed.

In the mixed form of nearly or wholly incompressible laws the hydrostatic pressure p is unknown too:
Π(x, p) = ∫ W(C) + p ln J − p²/(2Λ) dV − Σ P_i V_i(x), with p linear on each element and continuous
(Taylor and Hood's pair). It is stationary, no minimum: its tangent at a stable equilibrium has as
many negative eigenvalues as there are hydrostatic pressures.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from femcheck.assembly.elements import add_element_forces, add_element_stiffness, deformation
from femcheck.assembly.pattern import Pattern, make_pattern, places_in
from femcheck.assembly.reduction import UpperMatrix
from femcheck.assembly.saddle import Saddle
from femcheck.assembly.walls import add_wall_forces, add_wall_stiffness, wall_volumes
from femcheck.material.law import Law
from femcheck.material.volumetric import add_pressure, add_pressure_stiffness, volume_ratio_log
from femcheck.solid.body import Body
from femcheck.solid.continuum import Continuum
from femcheck.solid.mixed import Mixed
from femcheck.solid.state import State
from femcheck.solid.tip_plate import TipPlate
from femcheck.solid.winding import Winding

__all__ = ["Equilibrium", "Forces", "Support", "actuator"]


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


@dataclass(frozen=True, eq=False)
class Forces:
    """The derivative of the potential at a state, and what it was made of.

    nodal : (n, 3) ∂Π/∂x of every node as if it were free, walls included, caps not [mN].
    reduced : (unknowns,) ∂Π by the unknowns that move nodes [mN; mN mm], then by the hydrostatic
        pressures [mm³].
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
    """A body of one law on its support, ready to be asked for energy, forces and tangent.

    Parameters
    ----------
    body : what is discretised.
    law : its material; in the mixed form where the law says so.
    support : what relates nodes and unknowns.
    winding : fibres on its surfaces.

    Raises
    ------
    ValueError : a law in mixed form on an element without a stable pair.
    """

    def __init__(
        self, body: Continuum, law: Law, support: Support, winding: Winding | None = None
    ) -> None:
        self.body = body
        self.support = support
        self.winding = winding
        self._pattern = make_pattern(body.connectivity, support.blocks)
        self._element_blocks = support.blocks[body.connectivity]
        self._element_places = places_in(self._pattern, body.connectivity)
        self._wall_blocks = support.blocks[body.walls]
        self._wall_places = places_in(self._pattern, body.walls)
        support.prepare(self._pattern)
        facet = body.facet
        self._facet = (facet.values, facet.along, facet.across, facet.weights)
        self._take(law)

    def _take(self, law: Law) -> None:
        self.law = law
        compliance = law.volumetric_compliance
        self.mixed = None
        if compliance is not None:
            self.mixed = Mixed(self.body, self.support.blocks, compliance)
            self._saddle = Saddle()

    def with_law(self, law: Law) -> Equilibrium:
        """The same body of another law; they share the pattern of the tangent."""
        if law == self.law:
            return self
        other = copy(self)
        other._take(law)
        return other

    def largest_stretch(self, state: State) -> tuple[float, FloatArray]:
        """Largest principal stretch at a quadrature point, and its undeformed place (3,) [mm]."""
        _, C, _ = self.deformation(state)
        flat = C.reshape(-1, 6)
        whole = flat[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)
        largest = np.linalg.eigvalsh(whole)[:, 2]
        place = int(np.argmax(largest))
        return float(np.sqrt(largest[place])), self.body.places.reshape(-1, 3)[place]

    @property
    def hydrostatic_unknowns(self) -> int:
        """Number of hydrostatic pressures: negative eigenvalues of a stable tangent."""
        return 0 if self.mixed is None else self.body.corner_nodes.size

    @property
    def unknowns(self) -> int:
        """Number of unknowns."""
        return self.support.unknowns + self.hydrostatic_unknowns

    def rest(self) -> State:
        """The undeformed body, no hydrostatic pressure."""
        return replace(self.support.rest(), hydrostatic=np.zeros(self.hydrostatic_unknowns))

    def moved(self, state: State, step: FloatArray) -> State:
        """The state after a step (unknowns,)."""
        return self.support.moved(state, step)

    def volumes(self, state: State) -> FloatArray:
        """(3,) volume that each supply's chambers enclose, caps included [mm³]."""
        body, volumes = self.body, np.zeros(3)
        wall_volumes(state.x, body.walls, body.wall_supply, *self._facet, volumes)
        return volumes + self.support.cap_volumes(state)

    def strain_energy(self, state: State) -> float:
        """∫ W dV and what windings store [mN mm]; infinite where an element is inverted.

        In the mixed form with p ln J − p²/(2Λ), which is Λ/2 (ln J)² where the form is met.
        """
        _, C, least = self.deformation(state)
        if least <= 0:
            return float("inf")
        flat = C.reshape(-1, 6)
        density = self.law.energy(flat).reshape(self.body.weights.shape)
        if self.mixed is not None:
            log_J = volume_ratio_log(flat).reshape(density.shape)
            density = density + self.mixed.density(state.hydrostatic, log_J)
        wound = 0.0 if self.winding is None else self.winding.energy(state.x)
        return float((density * self.body.weights).sum()) + wound

    def potential(self, state: State, pressures: FloatArray) -> float:
        """Π [mN mm] at pressures (3,) [kPa]."""
        return self.strain_energy(state) - float(pressures @ self.volumes(state))

    def forces(self, state: State, pressures: FloatArray) -> Forces:
        """The derivative of the potential."""
        body = self.body
        F, C, least = self.deformation(state)
        nodal = np.zeros_like(state.x)
        if not least > 0:
            return Forces(nodal, np.full(self.unknowns, np.nan), F, C, C, least)
        S = self.law.stress(C.reshape(-1, 6))
        if self.mixed is not None:
            add_pressure(C.reshape(-1, 6), self.mixed.at_points(state.hydrostatic).ravel(), S)
        S = S.reshape(C.shape)
        add_element_forces(body.connectivity, body.gradients, body.weights, F, S, nodal)
        if self.winding is not None:
            self.winding.add_forces(state.x, nodal)
        scale = -pressures[body.wall_supply - 1]
        add_wall_forces(state.x, body.walls, scale, *self._facet, nodal)
        reduced = self.support.forces(state, pressures, nodal)
        if self.mixed is not None:
            log_J = volume_ratio_log(C.reshape(-1, 6)).reshape(body.weights.shape)
            reduced = np.concatenate([reduced, self.mixed.forces(state.hydrostatic, log_J)])
        return Forces(nodal, reduced, F, S, C, least)

    def volume_gradient(self, state: State, direction: FloatArray) -> FloatArray:
        """(unknowns,) derivative of Σ direction_i V_i by the unknowns [mm²; mm³; 0]."""
        body = self.body
        nodal = np.zeros_like(state.x)
        add_wall_forces(state.x, body.walls, direction[body.wall_supply - 1], *self._facet, nodal)
        gradient = self.support.forces(state, -direction, nodal)
        return np.concatenate([gradient, np.zeros(self.hydrostatic_unknowns)])

    def tangent(self, state: State, pressures: FloatArray, forces: Forces) -> UpperMatrix:
        """The second derivative of the potential: the upper triangle by the unknowns."""
        body, pattern = self.body, self._pattern
        data = np.zeros(pattern.indices.size)
        C = forces.C.reshape(-1, 6)
        D = self.law.stiffness(C)
        if self.mixed is not None:
            add_pressure_stiffness(C, self.mixed.at_points(state.hydrostatic).ravel(), D)
        add_element_stiffness(
            body.gradients,
            body.weights,
            forces.F,
            forces.S,
            D.reshape(*forces.C.shape, 6),
            self._element_blocks,
            self._element_places,
            pattern.starts,
            data,
        )
        if self.winding is not None:
            self.winding.add_stiffness(state.x, pattern, data)
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
        stiffness = self.support.stiffness(state, pressures, forces.nodal, data)
        if self.mixed is None:
            return stiffness
        columns = self.support.columns(state, self.mixed.columns(forces.F))
        return self._saddle(stiffness, columns, self.mixed.compliance)

    def deformation(self, state: State) -> tuple[FloatArray, FloatArray, float]:
        """F (e, q, 3, 3) and C (e, q, 6) at the quadrature points, and the least det F."""
        body = self.body
        F = np.empty((*body.weights.shape, 3, 3))
        C = np.empty((*body.weights.shape, 6))
        least = deformation(state.x, body.connectivity, body.gradients, F, C)
        return F, C, float(least)


def actuator(body: Body, law: Law, winding: Winding | None = None) -> Equilibrium:
    """An actuator: its base clamped, its tip face on a rigid plate, its chambers capped."""
    return Equilibrium(body, law, TipPlate(body), winding)
