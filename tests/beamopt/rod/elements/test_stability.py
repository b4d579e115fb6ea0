"""Where rods of elements stop being stable, and how else they fail."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from beamopt.rod.elements.method import Elements
from beamopt.rod.law import SectionLaw
from beamopt.rod.rod import STRAIGHT, Base, LineLoad, PointLoad, Rod, Segment, Tip
from beamopt.rod.status import RodStatus
from tests.beamopt.rod.elements.rods import (
    BENDS,
    METHOD,
    RIGID,
    cantilever,
    solved,
    tip,
)


def column(load: float) -> Rod:
    """Length 1, EI = 1, pressed down at its tip."""
    return Rod((Segment(1.0, BENDS, end=PointLoad(force=np.array([0, 0, -load]))),))


def test_euler_buckling() -> None:
    """At π² EI/(4 L²); 16 elements find it 0.05 % too high, to a step of 0.02 %."""
    critical = np.pi**2 / 4
    assert solved(column(0.99 * critical), 16).status == (RodStatus.CONVERGED,)
    above = solved(column(2 * critical), 16)
    assert above.status == (RodStatus.BUCKLED,)
    assert np.isnan(above.tips).all()
    assert above.factor[0] == pytest.approx(0.5, rel=2e-3)


def test_buckling_under_its_own_weight() -> None:
    """Q L³/EI = 7.837 (Greenhill 1881)."""
    rod = Rod((Segment(1.0, BENDS, line=LineLoad(force=np.array([0, 0, -10.0]))),))
    found = solved(rod, 16)
    assert found.status == (RodStatus.BUCKLED,)
    assert found.factor[0] == pytest.approx(0.7837, rel=3e-3)


def test_a_leaning_column_bends_over() -> None:
    """Where there is a stable way beyond the critical load, it is found."""
    rest = STRAIGHT + np.array([0, 0.1, 0, 0, 0, 0])
    rod = Rod((Segment(1.0, BENDS, rest, end=PointLoad(force=np.array([0, 0, -6.0]))),))
    assert tip(rod, 16)[2] < 0.2


def arch(rise: float, compliance: float) -> Rod:
    """Two straight halves of length 1, hinged at the feet, EI = 1, pressed down at the crown."""
    law = SectionLaw(np.eye(3), np.diag([0, 0, compliance]), RIGID, (1,))
    base = Rotation.from_rotvec([0, np.pi / 2 - rise, 0]).as_matrix()
    kink = Rotation.from_rotvec([0, 2 * rise, 0]).as_matrix()
    load = PointLoad(force=np.array([0, 0, -10.0]))
    return Rod(
        (Segment(1.0, law, end=load), Segment(1.0, law, kink=kink)),
        Base(rotation=base, hinges=np.array([[0, 1.0, 0]])),
        Tip(position=np.array([2 * np.cos(rise), 0, 0])),
    )


def test_a_steep_arch_buckles_sideways() -> None:
    """Each half like a column on hinges, at 2 π² EI/L² · sin(rise), before it can snap."""
    found = solved(arch(0.3, 1e-4), 16)
    assert found.status == (RodStatus.BUCKLED,)
    assert 10 * found.factor[0] == pytest.approx(2 * np.pi**2 * np.sin(0.3), rel=0.02)


@pytest.mark.parametrize(("rise", "compliance"), [(0.3, 1e-2), (0.1, 1e-3)])
def test_a_soft_arch_snaps_at_a_limit_point(rise: float, compliance: float) -> None:
    """The halves shorten as it flattens, to a maximum of the load that no buckling precedes."""
    found = solved(arch(rise, compliance), 16)
    assert found.status == (RodStatus.LIMIT_POINT,)
    assert 0 < found.factor[0] < 1


def test_crushed() -> None:
    law = SectionLaw(1e3 * np.eye(3), np.diag([0, 0, 0.5]), RIGID)
    rod = Rod((Segment(1.0, law, end=PointLoad(force=np.array([0, 0, -3.0]))),))
    found = solved(rod, 4)
    assert found.status == (RodStatus.CRUSHED,)
    assert found.factor[0] == pytest.approx(2 / 3, abs=1e-3)


def test_a_failing_case_spoils_no_other() -> None:
    rod = cantilever(1.0)
    rest = np.tile(rod.rest, (4, 1, 1))
    rest[1, 0, 0], rest[2, 0, 5] = np.nan, -0.5
    found = METHOD.solve(rod, rest, 8)
    names = [one.name for one in found.status]
    assert names == ["CONVERGED", "DIVERGED", "CRUSHED", "CONVERGED"]
    np.testing.assert_allclose(found.tips[3], found.tips[0], rtol=0, atol=1e-9)
    assert np.isnan(found.tips[1:3]).all()
    assert METHOD.solve(rod, rest[:0], 8).tips.shape == (0, 3)


def test_work_limit() -> None:
    """Counted, and no more than a step's iterations beyond it."""
    rod = cantilever(10.0)
    needed = int(solved(rod, 8, Elements()).iterations[0])
    assert solved(rod, 8, Elements(most_iterations=needed)).status == (RodStatus.CONVERGED,)
    found = solved(rod, 8, Elements(most_iterations=1))
    assert found.status == (RodStatus.WORK_LIMIT,)
    assert 1 <= found.iterations[0] < needed
    assert np.isnan(found.tips).all()


def test_too_slow() -> None:
    found = solved(cantilever(10.0), 8, Elements(seconds=0.0))
    assert found.status == (RodStatus.TOO_SLOW,)
    assert np.isnan(found.tips).all()
