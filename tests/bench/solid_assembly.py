"""Degrees of freedom a second that are assembled: our kernels, FElupe, a plain scikit-fem form.

All on the hand-made three-chamber section, on meshes of about as many unknowns, in a bent and
stretched state, in turn. FElupe and scikit-fem work on the very hexahedra of `hex27` and in the
law that ours is timed in there as well, neo-Hooke; what they assemble is held against ours. The
mixed form of an incompressible law stands beside both nearly incompressible forms of FElupe, which
are other energies: they are only timed.

A degree of freedom is a component of a node, hydrostatic pressures and volume ratios not counted;
each time is that of forces and tangent together, of the plain form the tangent's alone. Ours fill
the upper triangle, include the chambers' walls and reduce the tip to a plate; the others fill the
whole matrix and have neither.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray
from femcheck.material.law import Law
from femcheck.material.neo_hookean import NeoHookean
from femcheck.material.rigid_section import RigidSection
from femcheck.solid.body import Body
from femcheck.solid.elements import ELEMENTS
from femcheck.solid.equilibrium import Equilibrium, actuator
from femcheck.solid.state import State
from tests.bench import felupe_bodies
from tests.bench.measured import Measured
from tests.bench.solid_bodies import PARTS, bent, body_of, compressible, free_part

SAME, WEDGE = "hex27, neo-Hooke", "wedge18, rigid-section"
MIXED = "hex27, neo-Hooke mixed"


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
    law, incompressible = compressible(), NeoHookean(300.0, 0.5)
    bodies = {name: body_of(name, dofs) for name in PARTS}
    rigid = RigidSection(300.0, 2500.0)
    ours = [_ours(f"{name}, rigid-section", body, rigid) for name, body in bodies.items()]
    hexes = bodies["hex27"]
    same = _ours(SAME, hexes, law)
    mixed = [
        _ours(MIXED, hexes, incompressible),
        _ours("wedge18, neo-Hooke mixed", bodies["wedge18"], incompressible),
    ]
    felupe, nearly = [], []
    if felupe_bodies.installed():
        felupe, nearly = [_felupe(hexes, law)], _felupe_nearly_incompressible(hexes, law)
    plain = _plain(hexes, law)
    timed = [*ours, same, *mixed, *felupe, *nearly]
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
    reference = same.matrix(None)
    others = [(plain, assembled), *((other, other.action()) for other in felupe)]
    for other, result in others:
        yield from _ratios(speeds, (SAME, "hex27, rigid-section", WEDGE), other.name)
        apart = abs(other.matrix(result) - reference).max() / abs(reference).max()
        said = other.name.split(",")[0]
        yield Measured(f"assembly: tangent of {said} differs from ours by", apart, "of largest")
    for other in nearly:
        yield from _ratios(speeds, (MIXED,), other.name)
    yield from _ratios(speeds, (SAME,), MIXED)


def _ratios(speeds: dict[str, float], ours: Sequence[str], other: str) -> Iterator[Measured]:
    for name in ours:
        ratio = speeds[name] / speeds[other]
        yield Measured(f"assembly: {name}, against {other}", ratio, "times faster")


def _ours(name: str, body: Body, law: Law) -> Assembly:
    problem = actuator(body, law)
    state = replace(bent(body), hydrostatic=np.zeros(problem.hydrostatic_unknowns))
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


def _felupe(body: Body, law: NeoHookean) -> Assembly:
    """FElupe's SolidBody on the same hexahedra."""
    return _theirs("neo-Hooke", body, *felupe_bodies.solid(body, bent(body).x, law))


def _felupe_nearly_incompressible(body: Body, law: NeoHookean) -> list[Assembly]:
    """With three fields as FElupe chooses them for these hexahedra, and with cell-wise ones."""
    x, mu = bent(body).x, law.shear_modulus
    return [
        _theirs("FieldsMixed (u, p, J)", body, *felupe_bodies.three_fields(body, x, mu)),
        _theirs("SolidBodyNearlyIncompressible", body, *felupe_bodies.condensed(body, x, mu)),
    ]


def _theirs(what: str, body: Body, solid: Any, field: Any) -> Assembly:
    def action() -> Any:
        solid.assemble.vector(field)
        return solid.assemble.matrix(field)

    name = f"FElupe {felupe_bodies.version()} hex27, {what}"
    return Assembly(name, 3 * len(body.nodes), action, partial(free_part, body))


def _plain(body: Body, law: NeoHookean) -> Assembly:
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
        return free_part(body, coo_array(entries, shape=whole.shape).tocsr())

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


def _rows(one: Assembly, seconds: float, timed: str = "forces and tangent") -> Iterator[Measured]:
    yield Measured(f"assembly: {one.name}, degrees of freedom", one.dofs, "")
    yield Measured(f"assembly: {one.name}, {timed}", seconds, "s")
    yield Measured(f"assembly: {one.name}, speed", one.dofs / seconds, "dof/s")


def _seconds(action: Callable[[], object]) -> float:
    began = time.perf_counter()
    action()
    return time.perf_counter() - began
