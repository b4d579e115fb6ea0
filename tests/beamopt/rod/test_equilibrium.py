"""As many modes as a tolerance takes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from beamopt.rod import equilibrium
from beamopt.rod.equilibrium import MODES, solve_rod
from beamopt.rod.rod import STRAIGHT, PointLoad, Rod, Segment
from beamopt.rod.solution import RodSolution
from beamopt.rod.status import RodStatus
from tests.beamopt.rod.samples import PLANE, plain_law, random_rod, solved

EULER = np.pi**2 / 4


def pulled(force: float) -> Rod:
    """Its bending gathers at the clamp, over a length of 1/√force."""
    end = PointLoad(force=np.array([force, 0.0, 0.0]))
    return Rod((Segment(1.0, plain_law(free=PLANE), end=end),))


@given(st.integers(0, 2**32), st.sampled_from([1e-2, 1e-4, 1e-6]))
@settings(max_examples=30)
def test_it_is_as_good_as_it_is_asked_to_be(seed: int, tolerance: float) -> None:
    """Within ten times the tolerance: the estimate is no bound (see `test_modes`)."""
    rod = random_rod(np.random.default_rng(seed))
    found, exact = solve_rod(rod, rod.rest[None], tolerance), solved(rod, 24)
    assume(found.converged[0] and exact.converged[0])
    assert found.error[0] <= tolerance
    assert np.linalg.norm(found.tips - exact.tips) < 10 * tolerance


def test_cases_get_the_modes_that_they_need() -> None:
    """An easy and a hard one: each as if it were alone, up to the tolerance."""
    rod = pulled(20.0)
    rests = np.tile(rod.rest, (3, 1, 1))
    rests[0, 0, 1], rests[2, 0, 1] = 2.0, -3.0
    together = solve_rod(rod, rests, 1e-6)
    assert together.converged.all()
    for case in range(3):
        alone = solve_rod(rod, rests[case : case + 1], 1e-6)
        np.testing.assert_allclose(together.tips[case], alone.tips[0], rtol=0, atol=3e-6)
    assert together.centrelines.shape == (3, len(together.stations), 3)


def test_what_the_finest_does_not_resolve_is_said() -> None:
    rod = pulled(1e3)
    found = solve_rod(rod, rod.rest[None], 1e-12)
    assert found.status == (RodStatus.UNRESOLVED,)
    assert np.isnan(found.tips).all()
    assert np.isnan(found.centrelines).all()


def test_a_failure_is_believed_when_two_resolutions_say_so() -> None:
    """A column's load to 0.5 %, at whatever share of the load that is asked for it comes."""
    for share in (1.01, 1.5, 10.0):
        end = PointLoad(force=np.array([0.0, 0.0, -share * EULER]))
        rod = Rod((Segment(1.0, plain_law(), end=end),))
        found = solve_rod(rod, rod.rest[None], 1e-3)
        assert found.status == (RodStatus.BUCKLED,)
        assert found.factor[0] * share == pytest.approx(1.0, abs=5e-3)


def test_a_coarse_failure_alone_is_not() -> None:
    """Two modes a segment let a column of two segments stand too long or fall too early."""
    end = PointLoad(force=np.array([0.0, 0.0, -0.9995 * EULER]))
    law = plain_law(free=PLANE)
    rod = Rod((Segment(0.5, law), Segment(0.5, law, end=end)))
    assert solve_rod(rod, rod.rest[None], 1e-6).converged[0]


def test_segments_may_be_cut() -> None:
    """The same rod in one, two and three pieces."""
    rest = STRAIGHT + np.array([0.3, 0.5, 0.1, 0.0, 0.0, 0.0])
    end, law = PointLoad(force=np.array([1.0, 2.0, -1.0])), plain_law(1.0, 0.5)
    tips = []
    for lengths in ((1.0,), (0.3, 0.7), (0.2, 0.5, 0.3)):
        parts = [Segment(length, law, rest) for length in lengths]
        parts[-1] = replace(parts[-1], end=end)
        rod = Rod(tuple(parts))
        tips.append(solve_rod(rod, rod.rest[None], 1e-9).tips[0])
    np.testing.assert_allclose(tips[1], tips[0], rtol=0, atol=1e-8)
    np.testing.assert_allclose(tips[2], tips[0], rtol=0, atol=1e-8)


def test_more_modes_only_where_needed() -> None:
    """A rod bent by a moment is exact with the fewest."""
    end = PointLoad(follower_moment=np.array([0.0, 1.0, 0.0]))
    rod = Rod((Segment(1.0, plain_law(free=PLANE), end=end),))
    found = solve_rod(rod, rod.rest[None], 1e-12)
    assert len(found.stations) == MODES[0] + 3


def test_cases_that_were_skipped_are_no_failures() -> None:
    """Two resolutions that skip the same case have not agreed on anything."""
    one = _outcome(RodStatus.LIMIT_POINT, 0.5, RodStatus.SKIPPED)
    two = _outcome(RodStatus.BUCKLED, 0.8, RodStatus.SKIPPED)
    good = replace(_outcome(RodStatus.CONVERGED, 1.0, RodStatus.CONVERGED), error=np.zeros(2))
    levels = [lambda rest: one, lambda rest: two, lambda rest: good]
    found, open_ = equilibrium._refined(levels, np.zeros((2, 1, 6)), 1e-3, True)
    assert found.converged.all()
    assert not open_.size


def _outcome(first: RodStatus, factor: float, second: RodStatus) -> RodSolution:
    return RodSolution(
        (first, second),
        np.zeros((2, 3)),
        np.zeros((2, 3, 3)),
        np.array([factor, 1.0]),
        np.full(2, np.nan),
        np.ones(2, dtype=np.int64),
        np.zeros(1),
        np.zeros((2, 1, 3)),
    )
