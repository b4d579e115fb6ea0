"""Hexahedra: same body, same potential, same tips as wedges."""

import numpy as np
import pytest

from femcheck.continuation.direct import direct_solver
from femcheck.continuation.newton import Newton
from femcheck.continuation.outcome import Status
from femcheck.material.rigid_section import RigidSection
from femcheck.mesh.extrusion import Extrusion, extrude, stations
from femcheck.mesh.subdivision import subdivide
from femcheck.solid.body import discretise, nodes_at
from femcheck.solid.equilibrium import actuator
from femcheck.solid.state import rest_state
from tests.femcheck.ring_section import ring_section

LENGTH = 100.0


def extruded(layers: int) -> Extrusion:
    return extrude(ring_section(), stations(LENGTH, layers, 1.5))


def test_hexahedra_fill_the_body_and_walls_enclose_the_chambers() -> None:
    extrusion = extruded(3)
    body = discretise(extrusion, "hex27")
    moments = extrusion.section.moments
    assert body.connectivity.shape == (3 * len(extrusion.wedges), 27)
    assert body.weights.min() > 0
    np.testing.assert_allclose(body.weights.sum(), LENGTH * moments.area, rtol=1e-12)
    enclosed = actuator(body, RigidSection(300.0, 1000.0)).volumes(rest_state(body))
    np.testing.assert_allclose(enclosed, LENGTH * moments.chamber_areas, rtol=1e-12)
    # every node where its shape function says: the gradient of the undeformed positions is one
    F = np.einsum("eqja,eai->eqij", body.gradients, body.nodes[body.connectivity])
    np.testing.assert_allclose(F, np.broadcast_to(np.eye(3), F.shape), atol=1e-11)


def test_walls_are_halves_with_the_supply_of_the_whole() -> None:
    extrusion = extruded(2)
    cut = subdivide(extrusion)
    whole = extrusion.points[extrusion.walls].mean(axis=1)
    halves = cut.points[cut.walls].mean(axis=1)
    together = np.zeros_like(whole)
    np.add.at(together, cut.quadrangle, halves / 2)
    np.testing.assert_allclose(together, whole, atol=1e-12)


def test_forces_and_tangent_are_derivatives() -> None:
    extrusion = extrude(ring_section(), stations(30.0, 1))
    body = discretise(extrusion, "hex27")
    problem = actuator(body, RigidSection(300.0, 20.0))
    pressures = np.array([40.0, 10.0, 80.0])
    rng = np.random.default_rng(5)
    at = problem.moved(rest_state(body), 0.05 * rng.normal(size=body.unknowns))
    way = rng.normal(size=body.unknowns)

    def near(share: float):
        return problem.moved(at, share * way)

    forces = problem.forces(at, pressures)
    assert forces.least_volume_ratio > 0
    h = 1e-6
    up, down = near(h), near(-h)
    slope = (problem.potential(up, pressures) - problem.potential(down, pressures)) / (2 * h)
    assert forces.reduced @ way == pytest.approx(slope, rel=1e-6)
    change = problem.forces(up, pressures).reduced - problem.forces(down, pressures).reduced
    tangent = problem.tangent(at, pressures, forces).whole() @ way
    # but for the plate's three moments, whose derivative is not symmetric: those about axes that
    # turn with the plate; the second derivative of the potential along the way has them all
    error = np.abs(tangent - change / (2 * h))
    assert error[:-3].max() < 1e-6 * np.abs(tangent).max()
    slopes = [problem.forces(state, pressures).reduced @ way for state in (up, down)]
    curvature = (slopes[0] - slopes[1]) / (2 * h)
    assert way @ tangent == pytest.approx(curvature, rel=1e-6)


def test_same_tip_as_wedges() -> None:
    tips = {}
    for element in ("wedge18", "hex27"):
        body = discretise(extruded(2), element)
        problem = actuator(body, RigidSection(300.0, 1000.0))
        start = rest_state(body)
        outcome = Newton().solve(problem, start, np.array([20.0, 5.0, 0.0]), direct_solver())
        assert outcome.status is Status.CONVERGED
        tips[element] = outcome.state.tip - start.tip
    moved_by = np.linalg.norm(tips["wedge18"])
    assert moved_by > 2.0
    # equal along the axis; in the plane hexahedra are finer, which matters less as c grows: the
    # difference is 0.34 % at c = 100 and 0.04 % here
    assert np.linalg.norm(tips["hex27"] - tips["wedge18"]) < 6e-4 * moved_by


def test_corners_of_the_wedges_are_nodes() -> None:
    extrusion = extruded(2)
    body = discretise(extrusion, "hex27")
    found = nodes_at(body, extrusion.points)
    np.testing.assert_allclose(body.nodes[found], extrusion.points, atol=1e-9)
