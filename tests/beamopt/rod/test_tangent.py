"""The tangent against differences of the residual, and its symmetry."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.linalg import null_space

from beamopt.rod.newton import FOUND
from tests.beamopt.rod.samples import BEND, SPACE, random_rod
from tests.beamopt.rod.system import System


@pytest.mark.parametrize("free", [BEND, SPACE])
@pytest.mark.parametrize(("hinge", "held"), [(False, False), (True, False), (True, True)])
@pytest.mark.parametrize("follows", [False, True])
def test_it_is_the_derivative(
    free: tuple[int, ...], hinge: bool, held: bool, follows: bool
) -> None:
    """All kinds of loads, at no equilibrium.

    Differences are good to 1e-6² + 1e-16/1e-6. The kernel turns the frames by an integral of δu,
    the residual by Magnus' steps: as good as nine points resolve that, 1e-8 here. Rows of a held
    rotation are the derivative only where the tip has arrived, and are left out.
    """
    rng = np.random.default_rng(1)
    rod = random_rod(rng, free=free, follows=follows, hinge=hinge, held=held)
    system = System(rod, factor=0.8)
    unknowns = system.somewhere(rng)
    exact, found = system.differences(unknowns, 1e-6), system.tangent(unknowns)
    rows = slice(0, system.size - 3 * held)
    size = np.abs(exact).max()
    np.testing.assert_allclose(found[rows], exact[rows], rtol=0, atol=1e-7 * size)


@pytest.mark.parametrize("free", [BEND, SPACE])
@pytest.mark.parametrize("hinge", [False, True])
@pytest.mark.parametrize("held", [False, True])
def test_it_is_symmetric_with_dead_forces(free: tuple[int, ...], hinge: bool, held: bool) -> None:
    """As a second derivative of the potential, at any shape.

    The moment that holds a rotation has a potential only where the tip does not turn: with a held
    tip, among the changes that leave it where it is. Rounding and the kernel's integral of δu leave
    3e-8.
    """
    rng = np.random.default_rng(2)
    rod = random_rod(rng, free=free, follows=False, moments=False, hinge=hinge, held=held)
    system = System(rod)
    found = system.tangent(system.somewhere(rng))
    if held:
        still = null_space(found[-6:, :-6])
        found = still.T @ found[:-6, :-6] @ still
    assert np.abs(found - found.T).max() < 1e-7 * np.abs(found).max()


def test_it_is_not_symmetric_with_follower_loads() -> None:
    rng = np.random.default_rng(2)
    system = System(random_rod(rng))
    found = system.tangent(system.somewhere(rng))
    assert np.abs(found - found.T).max() > 1e-2 * np.abs(found).max()


@pytest.mark.parametrize("follows", [False, True])
def test_the_iteration_converges_quadratically(follows: bool) -> None:
    """So the tangent is the residual's, the rows of a held rotation as well."""
    rng = np.random.default_rng(3)
    rod = random_rod(rng, load=0.3, follows=follows)
    system = System(rod)
    unknowns, sizes = np.zeros(system.size), []
    for _ in range(5):
        step = np.linalg.solve(system.tangent(unknowns), system.residual(unknowns))
        unknowns = unknowns - step
        sizes.append(float(np.abs(step).max()))
    quadratic = [b / a**2 for a, b in pairwise(sizes) if b > 1e-13]
    assert len(quadratic) >= 2
    assert max(quadratic) < 10 * quadratic[0]
    ended, again = system.iterated()
    assert ended == FOUND
    np.testing.assert_allclose(again, unknowns, rtol=0, atol=1e-10)
