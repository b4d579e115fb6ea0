"""Degrees of freedom a second that are assembled: our kernels, FElupe, a plain scikit-fem form.

All on the hand-made three-chamber section, on meshes of about as many unknowns, in a bent and
stretched state, in turn. FElupe and scikit-fem work on the very hexahedra of `hex27` and in the
law that ours is timed in there as well, neo-Hooke; what they assemble is held against ours. A
degree of freedom is a component of a node; each time is that of forces and tangent together, of the
plain form the tangent's alone. Ours fill the upper triangle, include the chambers' walls and reduce
the tip to a plate; the others fill the whole matrix and have neither.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from beamopt.arrays import FloatArray
from femcheck.material.rigid_section import RigidSection
from femcheck.mesh.extrusion import extrude, stations
from femcheck.solid.body import Body, discretise
from femcheck.solid.elements import ELEMENTS
from femcheck.solid.equilibrium import Equilibrium, actuator
from femcheck.solid.state import State, placed
from tests.bench.measured import Measured
from tests.bench.neo_hooke import NeoHooke
from tests.femcheck.ring_section import ring_section

LENGTH = 100.0
PARTS = {"wedge18": 2, "tet10": 2, "hex27": 1}
"""How finely the section's cells are cut: hexahedra have six times the nodes a triangle."""


@dataclass(frozen=True, eq=False)
class Assembly:
    """Something that assembles, and for how many degrees of freedom.

    action : assembles once.
    matrix : the tangent by free nodes, without pressure, from what the action returned.
    """

    name: str
    dofs: int
    action: Callable[[], Any]
    matrix: Callable[[Any], Any]


def assembly(dofs: int, repeats: int) -> Iterator[Measured]:
    """About `dofs` degrees of freedom each, the best of `repeats` rounds."""
    law = NeoHooke()
    bodies = {name: body_of(name, dofs) for name in PARTS}
    rigid = RigidSection(300.0, 2500.0)
    ours = [_ours(f"{name}, rigid-section", body, rigid) for name, body in bodies.items()]
    hexes = bodies["hex27"]
    same = _ours("hex27, neo-Hooke", hexes, law)
    felupe = _felupe(hexes, law)
    plain = _plain(hexes, law)
    timed = [*ours, same, *([felupe] if felupe else [])]
    for one in timed:  # compiles, fills caches
        one.action()
    rounds = [[_seconds(one.action) for one in timed] for _ in range(repeats)]
    speeds = {}
    for one, best in zip(timed, np.min(rounds, axis=0), strict=True):
        yield from _rows(one, best)
        speeds[one.name] = one.dofs / best
    began = time.perf_counter()
    assembled = plain.action()  # once: it takes longer than all the others together
    slow = time.perf_counter() - began
    yield from _rows(plain, slow, "tangent alone")
    speeds[plain.name] = plain.dofs / slow
    yield Measured("felupe installed", float(felupe is not None), "")
    reference = same.matrix(None)
    others = [(plain, assembled)]
    if felupe is not None:
        others.append((felupe, felupe.action()))
    for other, result in others:
        said = other.name.split(",")[0]
        for name in (same.name, "hex27, rigid-section", "wedge18, rigid-section"):
            ratio = speeds[name] / speeds[other.name]
            yield Measured(f"assembly: {name}, against {said}", ratio, "times faster")
        apart = abs(other.matrix(result) - reference).max() / abs(reference).max()
        yield Measured(f"assembly: tangent of {said} differs from ours by", apart, "of largest")


def body_of(element: str, dofs: int) -> Body:
    """The body with as many layers as bring it nearest to `dofs` = 3 × nodes."""
    section = ring_section(PARTS[element])
    one, two = (len(_body(section, element, layers).nodes) for layers in (1, 2))
    return _body(section, element, max(round((dofs / 3 - one) / (two - one)), 0) + 1)


def _body(section: Any, element: str, layers: int) -> Body:
    return discretise(extrude(section, stations(LENGTH, layers)), element)


def bent(body: Body) -> State:
    """A state like that of an inflated actuator: bent by 0.6 rad, stretched, a little creased."""
    from femcheck.solid.plate import rotation

    angle, stretch = 0.6, 1.05
    s = body.nodes[:, 2] / LENGTH
    theta, radius = angle * s, stretch * LENGTH / angle
    x, y = body.nodes[:, 0] - body.tip_centre[0], body.nodes[:, 1]
    arm = radius - x
    at = np.stack([radius - arm * np.cos(theta), y, arm * np.sin(theta)], axis=1)
    at[:, 0] += body.tip_centre[0]
    at += 0.02 * np.sin(3 * body.nodes[:, [1, 2, 0]])
    tip = np.array([radius * (1 - np.cos(angle)), 0, radius * np.sin(angle)]) + body.tip_centre
    tip[2] -= LENGTH
    return placed(body, at, tip, rotation(np.array([0, angle, 0])))


def _ours(name: str, body: Body, law: Any) -> Assembly:
    problem, state = actuator(body, law), bent(body)
    pressures = np.array([100.0, 50.0, 0.0])
    if problem.forces(state, pressures).least_volume_ratio <= 0:
        raise ValueError(f"{name}: the state to assemble in has inverted elements")

    def action() -> None:
        problem.tangent(state, pressures, problem.forces(state, pressures))

    def matrix(_: Any) -> Any:
        nothing = np.zeros(3)
        tangent = problem.tangent(state, nothing, problem.forces(state, nothing))
        return tangent.whole()[:-6, :-6]

    return Assembly(name, 3 * len(body.nodes), action, matrix)


def _felupe(body: Body, law: NeoHooke) -> Assembly | None:
    """FElupe's SolidBody on the same hexahedra; None where it is not installed."""
    try:
        import felupe
    except ImportError:
        return None
    from skfem import ElementHex2

    theirs = felupe.element.TriQuadraticHexahedron().points
    ours = 2 * ElementHex2().doflocs - 1
    order = [int(np.abs(ours - place).sum(axis=1).argmin()) for place in theirs]
    mesh = felupe.Mesh(body.nodes, body.connectivity[:, order], "hexahedron27")
    field = felupe.Field(felupe.RegionTriQuadraticHexahedron(mesh), dim=3)
    field.values[:] = bent(body).x - body.nodes
    whole = felupe.FieldContainer([field])
    solid = felupe.SolidBody(felupe.NeoHookeCompressible(law.mu, law.lmbda), whole)

    def action() -> Any:
        solid.assemble.vector(whole)
        return solid.assemble.matrix(whole)

    name = f"FElupe {felupe.__version__} hex27, neo-Hooke"
    return Assembly(name, 3 * len(body.nodes), action, partial(_free, body))


def _plain(body: Body, law: NeoHooke) -> Assembly:
    """`asm` of a form with the material's and the geometric tangent, as scikit-fem's examples do.

    The tangent A = ∂P/∂F is computed once at the quadrature points and not timed; forces neither.
    """
    from skfem import Basis, BilinearForm, ElementHex2, ElementVector, asm

    scalar = ELEMENTS["hex27"].basis(body.extrusion)
    basis = Basis(scalar.mesh, ElementVector(ElementHex2()), intorder=5)
    A = _moduli(actuator(body, law), bent(body))

    @BilinearForm
    def form(u: Any, v: Any, w: Any) -> Any:
        return np.einsum("iJkLeq,iJeq,kLeq->eq", A, v.grad, u.grad, optimize=True)

    at = np.empty(basis.N, dtype=np.int64)  # our number of each of scikit-fem's unknowns
    for component in range(3):
        theirs = basis.element_dofs[component::3]
        at[theirs] = 3 * body.connectivity.T + component

    def matrix(assembled: Any) -> Any:
        from scipy.sparse import coo_array

        whole = assembled.tocoo()
        entries = (whole.data, (at[whole.row], at[whole.col]))
        return _free(body, coo_array(entries, shape=whole.shape).tocsr())

    dofs = 3 * len(body.nodes)
    return Assembly("scikit-fem form hex27, neo-Hooke", dofs, lambda: asm(form, basis), matrix)


def _moduli(problem: Equilibrium, state: State) -> FloatArray:
    """(3, 3, 3, 3, e, q) ∂P/∂F: F D F and the initial stress."""
    forces = problem.forces(state, np.zeros(3))
    shape = forces.C.shape[:2]
    D = problem.law.stiffness(forces.C.reshape(-1, 6)).reshape(*shape, 6, 6)
    place = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
    A = np.einsum(
        "eqiI,eqIJKL,eqkK->iJkLeq",
        forces.F,
        D[:, :, place][..., place],
        forces.F,
        optimize=True,
    )
    S = forces.S[:, :, place].transpose(2, 3, 0, 1)
    for i in range(3):
        A[i, :, i] += S
    return np.ascontiguousarray(A)


def _free(body: Body, matrix: Any) -> Any:
    """Rows and columns of the nodes between both faces."""
    held = np.union1d(body.base, body.tip)
    free = np.setdiff1d(np.arange(len(body.nodes)), held)
    kept = (3 * free[:, None] + np.arange(3)).ravel()
    return matrix.tocsr()[kept][:, kept]


def _rows(one: Assembly, seconds: float, timed: str = "forces and tangent") -> Iterator[Measured]:
    yield Measured(f"assembly: {one.name}, degrees of freedom", one.dofs, "")
    yield Measured(f"assembly: {one.name}, {timed}", seconds, "s")
    yield Measured(f"assembly: {one.name}, speed", one.dofs / seconds, "dof/s")


def _seconds(action: Callable[[], object]) -> float:
    began = time.perf_counter()
    action()
    return time.perf_counter() - began
