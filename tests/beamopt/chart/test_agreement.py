"""All methods find the same equilibria on scenes that all of them solve."""

from __future__ import annotations

import numpy as np
import pytest

from beamopt.comparators.collocation import Collocation
from beamopt.comparators.multiple_shooting import MultipleShooting
from beamopt.comparators.shooting import Shooting
from beamopt.comparators.sweep import StepRule
from beamopt.comparators.workload import workload_of
from beamopt.rod.elements.method import Elements
from beamopt.rod.equilibrium import solve_rod
from beamopt.rod.modes import StrainModes
from beamopt.rod.solution import Method
from beamopt.scene.scene import load_scene

CASES = [0, 13, 26]
HIGH_ORDER: list[tuple[Method, int]] = [
    (Shooting(), 512),
    (Shooting(StepRule.MUNTHE_KAAS), 512),
    (MultipleShooting(), 512),
    (MultipleShooting(StepRule.MUNTHE_KAAS), 512),
    (Collocation(), 8),
]


@pytest.mark.parametrize("name", ["gravity", "tool-at-the-tip", "pre-curved", "two-segments"])
def test_methods_agree(name: str) -> None:
    """High-order ones to 1e-8 of the length, elements to second order, modes to a tolerance."""
    load = workload_of(load_scene(name))
    rod, rest = load.rod, np.ascontiguousarray(load.rest[CASES])
    length = rod.length
    known = StrainModes().solve(rod, rest, 20)
    assert known.converged.all()
    for method, resolution in HIGH_ORDER:
        found = method.solve(rod, rest, resolution)
        assert found.converged.all()
        np.testing.assert_allclose(found.tips, known.tips, rtol=0, atol=1e-8 * length)
        np.testing.assert_allclose(found.rotations, known.rotations, rtol=0, atol=1e-7)
    coarse, fine = (Elements().solve(rod, rest, count) for count in (64, 128))
    better = fine.tips + (fine.tips - coarse.tips) / 3
    np.testing.assert_allclose(better, known.tips, rtol=0, atol=1e-6 * length)
    rough = solve_rod(rod, rest, 1e-3 * length)
    np.testing.assert_allclose(rough.tips, known.tips, rtol=0, atol=1e-3 * length)
