"""Methods against each other, in other frames, with held tips, and where there is no way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from beamopt.comparators.collocation import Collocation
from beamopt.comparators.multiple_shooting import MultipleShooting
from beamopt.comparators.shooting import Shooting
from beamopt.rod.law import SectionLaw
from beamopt.rod.rod import Base, PointLoad, Rod, Tip
from beamopt.rod.solution import Method
from beamopt.rod.status import RodStatus
from tests.beamopt.comparators.loaded_rods import (
    MAGNUS,
    METHODS,
    NAMES,
    RUNGE_KUTTA,
    X,
    Z,
    cantilever,
    rigid_in_stretch,
    solve,
    tangle,
    turned,
)

every_method = pytest.mark.parametrize(("method", "resolution"), METHODS, ids=NAMES)
FINE: list[tuple[Method, int]] = [
    (Shooting(RUNGE_KUTTA), 500),
    (MultipleShooting(RUNGE_KUTTA), 500),
    (MultipleShooting(MAGNUS), 300),
    (Collocation(), 9),
]


def test_all_methods_agree_on_a_tangled_rod() -> None:
    reference = solve(Shooting(MAGNUS), tangle(), 300)
    assert reference.converged.all()
    for method, resolution in FINE:
        found = solve(method, tangle(), resolution)
        assert found.converged.all()
        assert found.tips == pytest.approx(reference.tips, abs=1e-8 * tangle().length)
        assert found.rotations == pytest.approx(reference.rotations, abs=1e-8)


@every_method
def test_another_frame(method: Method, resolution: int) -> None:
    Q, shift = Rotation.from_rotvec([1.0, -2.0, 0.7]).as_matrix(), np.array([5.0, 1.0, -3.0])
    here = solve(method, tangle(), resolution)
    there = solve(method, turned(tangle(), Q, shift), resolution)
    assert there.tips == pytest.approx(here.tips @ Q.T + shift, abs=2e-6)
    assert there.rotations == pytest.approx(Q @ here.rotations, abs=1e-7)


@every_method
def test_a_tip_held_where_a_force_had_brought_it(method: Method, resolution: int) -> None:
    free = tangle()
    found = solve(method, free, resolution)
    end = free.segments[-1].end
    no_force = replace(free.segments[-1], end=replace(end, force=np.zeros(3), at=np.zeros(3)))
    free = replace(
        free, segments=(free.segments[0], replace(no_force, end=replace(no_force.end, force=X)))
    )
    found = solve(method, free, resolution)
    held = Rod((free.segments[0], no_force), free.base, Tip(position=found.tips[0]))
    again = solve(method, held, resolution)
    assert again.converged.all()
    assert again.tips == pytest.approx(found.tips, abs=1e-6)
    assert again.rotations == pytest.approx(found.rotations, abs=1e-6)
    clamped = replace(held, tip=Tip(found.tips[0], found.rotations[0]))
    once_more = solve(method, clamped, resolution)
    assert once_more.converged.all()
    assert once_more.centrelines == pytest.approx(found.centrelines, abs=1e-5)


@every_method
def test_compressed_to_nothing(method: Method, resolution: int) -> None:
    """A dead axial force of −2 EA: v3 = 1 − factor · 2 reaches zero at half of it."""
    law = SectionLaw(1e4 * np.eye(3), 1e-2 * np.eye(3), np.zeros((3, 3)), (0, 1, 2))
    rod = cantilever(100.0, law, PointLoad(force=-200 * Z))
    found = solve(method, rod, min(resolution, 50))
    assert found.status == (RodStatus.CRUSHED,)
    assert found.factor[0] == pytest.approx(0.5, abs=2e-3)
    assert np.isnan(found.tips).all()
    assert np.isnan(found.rotations).all()
    assert np.isnan(found.centrelines).all()


@every_method
def test_a_tip_held_out_of_reach(method: Method, resolution: int) -> None:
    """An inextensible rod can not be 1.2 times as long as it is; the next case is solved."""
    rod = replace(
        cantilever(100.0, rigid_in_stretch(1e4)), tip=Tip(position=np.array([10.0, 0.0, 120.0]))
    )
    rest = np.stack([rod.rest, rod.rest])
    rest[0, 0, 0] = rest[1, 0, 0] = 0.01
    rest[1, 0, 5] = 1.5
    if isinstance(method, Collocation):
        method, resolution = replace(method, most_nodes=400), 4
    found = method.solve(rod, rest, min(resolution, 20))
    assert found.status[0] in (
        RodStatus.STEPS_TOO_SMALL,
        RodStatus.DIVERGED,
        RodStatus.UNRESOLVED,
        RodStatus.TOO_SLOW,
    )
    assert 0 <= found.factor[0] < 1
    assert found.status[1] is RodStatus.CONVERGED
    assert found.tips[1] == pytest.approx(rod.tip.position, abs=1e-6)


@every_method
def test_too_slow_and_not_representable(method: Method, resolution: int) -> None:
    rod = cantilever(100.0, rigid_in_stretch(1e4), PointLoad(force=X))
    assert isinstance(method, Shooting | MultipleShooting | Collocation)
    assert solve(replace(method, seconds=0.0), rod, resolution).status == (RodStatus.TOO_SLOW,)
    hinged = replace(rod, base=Base(hinges=X[None]))
    found = solve(method, hinged, resolution)
    assert found.status == (RodStatus.NOT_REPRESENTABLE,)
    assert np.isnan(found.tips).all()


@every_method
def test_not_a_number_is_a_status(method: Method, resolution: int) -> None:
    rod = cantilever(100.0, rigid_in_stretch(1e4), PointLoad(force=X))
    found = method.solve(rod, np.full((1, 1, 6), np.nan), resolution)
    assert found.status == (RodStatus.DIVERGED,)


def test_cases_follow_each_other() -> None:
    """From the case before it takes fewer iterations than from rest, and ends at the same."""
    rod = cantilever(100.0, rigid_in_stretch(1e4), PointLoad(force=8 * X))
    rest = np.repeat(rod.rest[None], 3, axis=0)
    rest[:, 0, 0] = [0.0, 0.001, 0.002]
    together = Shooting().solve(rod, rest, 50)
    alone = Shooting().solve(rod, rest[2:], 50)
    assert together.converged.all()
    assert together.iterations[2] < alone.iterations[0]
    assert together.tips[2] == pytest.approx(alone.tips[0], abs=1e-7)


def test_a_warm_collocation_ends_at_the_same() -> None:
    rod = tangle()
    rest = np.repeat(rod.rest[None], 3, axis=0)
    rest[:, :, 0] += np.array([0.0, 0.002, 0.004])[:, None]
    cold, warm = (Collocation(warm=one).solve(rod, rest, 7) for one in (False, True))
    assert warm.converged.all()
    assert warm.tips == pytest.approx(cold.tips, abs=1e-7 * rod.length)
