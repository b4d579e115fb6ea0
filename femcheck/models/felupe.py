"""FElupe's elements in our equilibrium, where it is installed: a comparator, never an answer.

FElupe's are the shape functions, the quadrature, the material with its first and second derivative,
and the assembly of forces and stiffness from them: of the elements (SolidBody) and of follower
pressure on the chambers' walls (SolidBodyPressure). The rigid-section law is given to it as an
energy, which it differentiates by itself.

Ours are the mesh, the clamp and the rigid tip plate, the steps in pressure and Newton's method with
its direct solver; and the potential and det F, by which a step is shortened: they change the way to
an equilibrium, not the equilibrium.

Pressure is formulated in another way than ours, where caps and walls are one closed surface of
which the enclosed volume is derived. FElupe's walls have the force of the pressure, ∫ p n da, and
so the caps at the tip have all of theirs. Walls and caps together give the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from importlib.util import find_spec
from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from femcheck.assembly.pattern import Pattern
from femcheck.assembly.reduction import UpperMatrix
from femcheck.material.law import Law
from femcheck.material.neo_hookean import NeoHookean
from femcheck.material.rigid_section import RigidSection
from femcheck.models.question import Question
from femcheck.models.reply import Reply
from femcheck.models.solid import SolidModel
from femcheck.prediction.options import PredictionOptions
from femcheck.solid.body import Body
from femcheck.solid.equilibrium import Equilibrium, Forces
from femcheck.solid.plate import cross_matrix
from femcheck.solid.state import State
from femcheck.solid.tip_plate import TipPlate
from femcheck.solved.case import Solid

__all__ = ["FelupeEquilibrium", "FelupeModel"]

ELEMENT = "hex27"
NOTHING = np.zeros(3)


@dataclass(frozen=True, slots=True)
class FelupeModel:
    """27-node hexahedra assembled by FElupe.

    layers : along the actuator. size : of the triangles that the hexahedra are cut from.
    """

    layers: int
    size: float

    @property
    def family(self) -> str:
        """Its name."""
        return "felupe"

    @property
    def resolution(self) -> str:
        """Layers and size."""
        return self._ours.resolution

    @property
    def _ours(self) -> SolidModel:
        """What asks the same of our elements."""
        return SolidModel(ELEMENT, self.layers, self.size)

    def refuses(self, question: Question) -> str | None:
        """Why it can not be asked."""
        missing = self._ours.refuses(question) or _unlike(question)
        if missing is None and find_spec("felupe") is None:
            return "FElupe is not installed"
        return missing

    def reply(self, question: Question, workers: int = 0) -> Reply:
        """On the same way as `SolidModel`, from the same starting points."""
        return self._ours.reply(question, workers, FelupeSolid)


def _unlike(question: Question) -> str | None:
    """Why FElupe's solid would be another one than ours, or needs more than is asked of it."""
    options = question.law
    if not isinstance(options, PredictionOptions):
        return None
    if options.wound is not None:
        return "FElupe is asked for solids without thread"
    law = options.law_for(question.design.actuator)
    if not isinstance(law, NeoHookean):
        return f"FElupe is asked for the laws neo-hookean and rigid-section, not for {law.name}"
    if law.volumetric_compliance is not None:
        return "FElupe is asked for displacements alone: its mixed elements are not ours"
    return None


class FelupeSolid(Solid):
    """A solid that FElupe assembles."""

    @cached_property
    def digest(self) -> str:
        """Not that of ours on the same mesh."""
        return f"felupe {super().digest}"

    def problem(self, body: Body) -> Equilibrium:
        """The equilibrium of its body."""
        return FelupeEquilibrium(body, self.law)


class FelupeEquilibrium(Equilibrium):
    """An actuator of a compressible neo-Hookean or of the rigid-section law."""

    def __init__(self, body: Body, law: Law) -> None:
        import felupe

        mesh = _mesh(body)
        region = felupe.RegionTriQuadraticHexahedron(mesh)
        self._field = felupe.FieldContainer([felupe.Field(region, dim=3)])
        self._walls = _walls(body, mesh)
        self._places: dict[int, tuple[IndexArray, FloatArray]] = {}
        super().__init__(body, law, _WholeCaps(body))

    def _take(self, law: Law) -> None:
        import felupe

        super()._take(law)
        self._solid = felupe.SolidBody(_material(law), self._field)

    def forces(self, state: State, pressures: FloatArray) -> Forces:
        """The derivative of the potential; stresses stay in FElupe."""
        F, C, least = self.deformation(state)
        unknown = np.broadcast_to(np.nan, C.shape)
        if not least > 0:
            failed = np.full(self.unknowns, np.nan)
            return Forces(np.zeros_like(state.x), failed, F, unknown, C, least)
        nodal = self._vector(self._solid, self._field, state) + self._pressed(state, pressures)
        return Forces(nodal, self.support.forces(state, pressures, nodal), F, unknown, C, least)

    def volume_gradient(self, state: State, direction: FloatArray) -> FloatArray:
        """(unknowns,) derivative of Σ direction_i V_i by the unknowns [mm²; mm³]."""
        return -self.support.forces(state, direction, self._pressed(state, direction))

    def tangent(self, state: State, pressures: FloatArray, forces: Forces) -> UpperMatrix:
        """The second derivative of the potential: the upper triangle by the unknowns."""
        data = np.zeros(self._pattern.indices.size)
        self._add(0, self._solid, self._field, state, 1.0, data)
        for supply, (walls, field) in self._walls.items():
            if pressures[supply - 1]:
                self._add(supply, walls, field, state, pressures[supply - 1], data)
        return self.support.stiffness(state, pressures, forces.nodal, data)

    def _pressed(self, state: State, pressures: FloatArray) -> FloatArray:
        """(n, 3) of the walls, as their part in ∂Π/∂x: what the outside does, negative."""
        nodal = np.zeros_like(state.x)
        for supply, (walls, field) in self._walls.items():
            if pressures[supply - 1]:
                nodal -= pressures[supply - 1] * self._vector(walls, field, state)
        return nodal

    def _moved(self, field: Any, state: State) -> Any:
        field[0].values[:] = state.x - self.body.nodes
        return field

    def _vector(self, item: Any, field: Any, state: State) -> FloatArray:
        force = item.assemble.vector(self._moved(field, state))
        return np.asarray(force.toarray()).reshape(-1, 3)

    def _add(
        self, name: int, item: Any, field: Any, state: State, scale: float, data: FloatArray
    ) -> None:
        """Add the symmetric part of a stiffness of all nodes to the pattern's data.

        What is left out belongs to the walls' rims. It has its counterpart in the caps.
        """
        sign = -1.0 if name else 1.0
        matrix = item.assemble.matrix(self._moved(field, state)).tocsr()
        if name not in self._places:
            self._places[name] = _places(self._pattern, matrix)
        places, shares = self._places[name]
        data += np.bincount(places, sign * scale * shares * matrix.data, data.size + 1)[:-1]


class _WholeCaps(TipPlate):
    """The same plate; the caps have the whole force of the pressure, where each has its centre."""

    def forces(self, state: State, pressures: FloatArray, nodal: FloatArray) -> FloatArray:
        reduced = super().forces(state, NOTHING, nodal)
        force, moment = self._of_caps(state, pressures)
        reduced[-6:] -= np.concatenate([force, moment])
        return reduced

    def _of_caps(self, state: State, pressures: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(3,) force [mN] and moment about the plate's position [mN mm]."""
        normal = state.turn[:, 2]
        arm = state.turn[:, :2] @ (pressures @ self._first_moments)
        return float(pressures @ self.body.cap_areas) * normal, np.cross(arm, normal)

    @cached_property
    def _first_moments(self) -> FloatArray:
        return self.body.extrusion.section.moments.chamber_first_moments

    def _plate_stiffness(
        self, state: State, pressures: FloatArray, forces: FloatArray, arms: FloatArray
    ) -> FloatArray:
        """The symmetric part; a moment that turns with the plate has none."""
        H = super()._plate_stiffness(state, NOTHING, forces, arms)
        half = cross_matrix(self._of_caps(state, pressures)[0]) / 2
        H[:3, 3:] += half
        H[3:, :3] += half.T
        return H


def _mesh(body: Body) -> Any:
    """The same nodes; those of an element in FElupe's order, found by their places."""
    import felupe
    from skfem import ElementHex2

    theirs = felupe.element.TriQuadraticHexahedron().points
    ours = 2 * ElementHex2().doflocs - 1
    order = [int(np.abs(ours - place).sum(axis=1).argmin()) for place in theirs]
    return felupe.Mesh(body.nodes, body.connectivity[:, order], "hexahedron27")


def _walls(body: Body, mesh: Any) -> dict[int, tuple[Any, Any]]:
    """Unit pressure on the walls of each supply that has any, and the field on them."""
    import felupe

    pressed = {}
    for supply in np.unique(body.wall_supply).tolist():
        facets = body.walls[body.wall_supply == supply]
        on_wall = np.zeros(len(body.nodes), dtype=np.bool_)
        on_wall[facets] = True
        region = felupe.RegionTriQuadraticHexahedronBoundary(mesh, mask=on_wall)
        if len(region.mesh.cells) != len(facets):
            raise ValueError(f"{len(region.mesh.cells)} faces for {len(facets)} facets")
        field = felupe.FieldContainer([felupe.Field(region, dim=3)])
        pressed[supply] = felupe.SolidBodyPressure(field, 1.0), field
    return pressed


def _material(law: Law) -> Any:
    import felupe

    if isinstance(law, RigidSection):
        E = law.youngs_modulus
        return felupe.Hyperelastic(_rigid_section, E=E, cE=law.penalty * E, G=law.rigidity)
    assert isinstance(law, NeoHookean)
    return felupe.NeoHookeCompressible(law.shear_modulus, law.volumetric_modulus)


def _rigid_section(C: Any, E: float, cE: float, G: float) -> Any:
    """The energy of `RigidSection`; C is a tensor that FElupe differentiates by."""
    from tensortrax.math import sqrt

    plane = (C[0, 0] - 1) ** 2 + (C[1, 1] - 1) ** 2 + 2 * C[0, 1] ** 2
    shear = C[0, 2] ** 2 + C[1, 2] ** 2
    return E / 2 * (sqrt(C[2, 2]) - 1) ** 2 + G / 2 * shear + cE / 8 * plane


def _places(pattern: Pattern, matrix: Any) -> tuple[IndexArray, FloatArray]:
    """(k,) place in the pattern of each entry of a matrix of all nodes, and its share in it.

    Entries of held nodes go to one place behind the last. Both triangles have half a share.

    Raises
    ------
    ValueError : an entry that the pattern has no place for.
    """
    rows = np.repeat(np.arange(pattern.size), np.diff(pattern.starts))
    keys = rows * pattern.size + pattern.indices
    unknown = np.where(pattern.blocks < 0, -3, 3 * pattern.blocks)[:, None] + np.arange(3)
    first = np.repeat(unknown.ravel(), np.diff(matrix.indptr))
    second = unknown.ravel()[matrix.indices]
    kept = (first >= 0) & (second >= 0)
    wanted = np.minimum(first, second) * pattern.size + np.maximum(first, second)
    places = np.full(first.size, keys.size)
    places[kept] = np.minimum(np.searchsorted(keys, wanted[kept]), keys.size - 1)
    if not (keys[places[kept]] == wanted[kept]).all():
        raise ValueError("matrix: an entry outside the pattern")
    return places, np.where(first == second, 1.0, 0.5)
