"""A clamped right-angle frame under a load in its plane that buckles sideways.

Two legs of 240 mm, a strip of 30 × 0.6 mm upright in the frame's plane, E = 71,240 MPa, ν = 0.31,
the load at the free end along the first leg: the frame of Argyris and of Simo and Vu-Quoc (1986).
What it buckles at is computed here by the smallest eigenvalue of the plane shape's tangent.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

from beamopt.rod.law import SectionLaw
from beamopt.rod.modes import StrainModes
from beamopt.rod.path import CriticalKind, LoadPath, PathStatus, Stretch, follow_path
from beamopt.rod.path_system import PathSystem
from beamopt.rod.rod import Base, PointLoad, Rod, Segment
from beamopt.rod.status import RodStatus

LENGTH, WIDTH, THICKNESS, E, NU = 240.0, 30.0, 0.6, 71240.0, 0.31
ALONG_X = np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]])
ALONG_Y = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
PULL, PUSH = 1.0875, -0.6804


def frame(force: float, sideways: float = 0.0) -> Rod:
    """Sections with e1 out of the frame's plane; forces in N at the free end, along x and z."""
    bending = E * WIDTH * THICKNESS / 12 * np.array([WIDTH**2, THICKNESS**2])
    torsion = E / (2 * (1 + NU)) * WIDTH * THICKNESS**3 / 3
    law = SectionLaw(np.diag([*bending, torsion]), np.zeros((3, 3)), np.zeros((3, 3)), (0, 1, 2))
    end = PointLoad(force=np.array([force, 0.0, sideways]))
    legs = Segment(LENGTH, law), Segment(LENGTH, law, kink=ALONG_X.T @ ALONG_Y, end=end)
    return Rod(legs, Base(rotation=ALONG_X))


def path(force: float, sideways: float = 0.0) -> LoadPath:
    return follow_path(frame(force, sideways), modes=8, steps=200)


@pytest.mark.parametrize(("asked", "critical"), [(2.0, PULL), (-2.0, PUSH)])
def test_the_plane_path_bifurcates_where_the_smallest_eigenvalue_vanishes(
    asked: float, critical: float
) -> None:
    """The linearised analysis: the tangent of the plane shape, followed without the path."""
    system = PathSystem(frame(asked), 8)

    def softest(factor: float) -> float:
        shape = system.settle(np.zeros(system.size), factor)
        system.residual(shape, factor)
        return float(np.linalg.eigvalsh(system.tangent(shape, factor))[0])

    expected = brentq(softest, 0.8 * critical / asked, 1.2 * critical / asked, xtol=1e-10)
    found = path(asked)
    assert found.status is PathStatus.FULL_LOAD
    (only,) = found.critical
    assert only.kind is CriticalKind.BIFURCATION
    assert only.directions == 1
    assert only.factor == pytest.approx(expected, rel=1e-6)
    assert asked * only.factor == pytest.approx(critical, rel=1e-4)
    assert found.bifurcations.tolist() == [only.factor]
    assert not found.limits.size
    last = len(found.factors) - 1
    assert found.stretches == (Stretch(0, only.after, 0, 0), Stretch(only.after + 1, last, 1, 1))
    np.testing.assert_allclose(found.tips[:, 2], 0, atol=1e-9)


@pytest.mark.parametrize("sideways", [1e-2, 1e-3, 1e-4, 1e-6])
@pytest.mark.parametrize("asked", [2.0, -2.0])
def test_the_least_push_leads_to_its_own_side(asked: float, sideways: float) -> None:
    """From rest to full load through stable shapes, mirror images for mirrored pushes."""
    this, other = path(asked, sideways), path(asked, -sideways)
    for found in (this, other):
        assert found.status is PathStatus.FULL_LOAD
        assert found.stable.all()
        assert not found.critical
        assert len(found.stretches) == 1
    assert (this.tips[1:, 2] > 0).all()
    np.testing.assert_allclose(this.tips[-1], other.tips[-1] * [1, 1, -1], atol=1e-6)
    assert this.tips[-1, 2] > 50


@pytest.mark.parametrize(("asked", "critical"), [(2.0, PULL), (-2.0, PUSH)])
def test_the_load_of_the_knee_tends_to_the_bifurcation(asked: float, critical: float) -> None:
    """Where the frame has moved sideways by 1 % of a leg; the share beyond falls with the push."""
    loads = []
    for sideways in (1e-3, 1e-4, 1e-5):
        found = path(asked, sideways)
        at = int(np.argmax(found.tips[:, 2] > 0.01 * LENGTH))
        share = np.interp(0.01 * LENGTH, found.tips[at - 1 : at + 1, 2], [0.0, 1.0])
        loads.append(asked * (found.factors[at - 1] + share * np.diff(found.factors)[at - 1]))
    away = np.abs(np.array(loads) / critical - 1)
    assert away[-1] < 3e-3
    assert away[0] > away[1]


@pytest.mark.parametrize("sideways", [1e-3, 1e-4])
@pytest.mark.parametrize("force", [1.1, 1.2, 2.0, -1.0])
def test_a_solve_ends_on_the_side_of_its_push(force: float, sideways: float) -> None:
    """Not at the stable mirror image, which no path from rest leads to."""
    for sign in (1.0, -1.0):
        rod = frame(force, sign * sideways)
        found = StrainModes().solve(rod, rod.rest[None], 8)
        if found.status[0] is RodStatus.CONVERGED:
            assert sign * found.tips[0, 2] > 5


def test_a_frame_that_is_not_pushed_sideways_buckles() -> None:
    rod = frame(1.2)
    found = StrainModes().solve(rod, rod.rest[None], 8)
    assert found.status == (RodStatus.BUCKLED,)
    assert 1.2 * found.factor[0] == pytest.approx(PULL, abs=1e-3)
