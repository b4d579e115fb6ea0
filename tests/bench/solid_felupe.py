"""Forces and tangents of FElupe at an equilibrium of ours: same hexahedra, law and pressure.

The hand-made three-chamber section in 27-node hexahedra, compressible neo-Hookean law in
displacements alone, one supply under pressure. Internal forces are compared at all nodes, internal
tangents between the nodes that no face holds.

Pressure is compared at those free nodes, too. Ours is the derivative of the enclosed volume,
⅓ ∫ x · n da on the walls and what the caps add; FElupe's is ∫ p n da on the walls. Integrated by
parts, the two differ by an integral along the rim of the walls, which lies in base and tip face: at
nodes of the rim the forces differ, there the caps' part is in ours; at all other nodes they are one
and the same function of x, and so are all rows of the tangent. FElupe's tangent of the pressure
is asymmetric in rows of the rim alone; between free nodes it is symmetric as it is, like ours, and
nothing has to be made symmetric before it is compared.

What is left is rounding, most of it in ours: F is summed from positions, whose hundred millimetres
leave two digits less than FElupe's displacements do.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from femcheck.continuation.direct import direct_solver
from femcheck.continuation.newton import Newton
from femcheck.solid.body import Body
from femcheck.solid.equilibrium import Equilibrium, actuator
from femcheck.solid.state import State
from tests.bench import felupe_bodies
from tests.bench.measured import Measured
from tests.bench.solid_bodies import body_of, compressible, free_part

LOAD = np.array([5.0, 0.0, 0.0])
"""[kPa]"""
TIGHT = Newton(tolerance=1e-10)
AGREED = 1e-8


def felupe_agreement(dofs: int) -> Iterator[Measured]:
    """Largest difference over the largest entry, of each; about `dofs` = 3 × nodes.

    Nothing where FElupe is not installed.
    """
    if not felupe_bodies.installed():
        return
    problem = actuator(body_of("hex27", dofs), compressible())
    found = TIGHT.solve(problem, problem.rest(), LOAD, direct_solver())
    if found.state is None:
        raise RuntimeError(found.status.value)
    yield Measured("felupe: degrees of freedom", 3 * len(problem.body.nodes), "")
    differences = _differences(problem, found.state)
    for name, value in differences.items():
        yield Measured(f"felupe: {name}", value, "of largest")
    agrees = all(value <= AGREED for value in differences.values())
    yield Measured("felupe: agrees to 1e-8", float(agrees), "")


def _differences(problem: Equilibrium, state: State) -> dict[str, float]:
    body: Body = problem.body
    free, supply = problem.support.free, 1
    solid, field = felupe_bodies.solid(body, state.x, problem.law)
    walls = body.walls[body.wall_supply == supply]
    pressed, on_wall = felupe_bodies.wall_pressure(body, state.x, walls, LOAD[supply - 1])
    internal = solid.assemble.vector(field).toarray().reshape(-1, 3)
    pressure = pressed.assemble.vector(on_wall).toarray().reshape(-1, 3)
    stiffness = free_part(body, solid.assemble.matrix(field))
    softening = free_part(body, pressed.assemble.matrix(on_wall))

    nothing = np.zeros(3)
    forces, loaded = problem.forces(state, nothing), problem.forces(state, LOAD)
    plain = problem.tangent(state, nothing, forces).whole()[:-6, :-6]
    whole = problem.tangent(state, LOAD, loaded).whole()[:-6, :-6]
    # FElupe's pressure is what the outside does: it is taken off the internal forces
    return {
        "internal force differs by": _apart(internal, forces.nodal),
        "tangent differs by": _apart(stiffness, plain),
        "follower pressure force differs by": _apart(
            -pressure[free], (loaded.nodal - forces.nodal)[free]
        ),
        "follower pressure tangent differs by": _apart(-softening, whole - plain),
        "follower pressure tangent is asymmetric by": _apart(softening, softening.T),
        "forces out of balance at our equilibrium": float(
            np.abs((internal - pressure)[free]).max() / np.abs(internal).max()
        ),
    }


def _apart(theirs: object, ours: object) -> float:
    return float(abs(theirs - ours).max() / abs(ours).max())
