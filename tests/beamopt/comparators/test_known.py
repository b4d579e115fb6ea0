"""Published and closed solutions."""

from __future__ import annotations

import numpy as np
import pytest

from beamopt.rod.arc import arc_tips
from beamopt.rod.law import SectionLaw
from beamopt.rod.rod import Base, PointLoad, Rod, Segment
from beamopt.rod.solution import Method
from tests.beamopt.comparators.loaded_rods import (
    METHODS,
    NAMES,
    X,
    Y,
    Z,
    cantilever,
    rigid_in_stretch,
    solve,
)

every_method = pytest.mark.parametrize(("method", "resolution"), METHODS, ids=NAMES)


@every_method
@pytest.mark.parametrize(
    ("load", "deflection", "shortening", "angle"),
    [(1.0, 0.30172, 0.05643, 0.46135), (10.0, 0.81061, 0.55500, 1.43029)],
)
def test_cantilever_with_a_dead_force(
    method: Method, resolution: int, load: float, deflection: float, shortening: float, angle: float
) -> None:
    """Mattiasson, Int. J. Num. Meth. Eng. 17 (1981), elliptic integrals: P L²/EI = 1 and 10."""
    EI, L = 2e4, 80.0
    rod = cantilever(L, rigid_in_stretch(EI), PointLoad(load * EI / L**2 * X))
    found = solve(method, rod, resolution)
    assert found.converged.all()
    assert found.tips[0] / L == pytest.approx([deflection, 0, 1 - shortening], abs=6e-6)
    tangent = found.rotations[0] @ Z
    assert np.arctan2(tangent[0], tangent[2]) == pytest.approx(angle, abs=6e-6)


@every_method
def test_a_moment_rolls_it_up_to_a_circle(method: Method, resolution: int) -> None:
    """M = 2π EI/L: the tip is back at the base, and its section turned by a whole turn."""
    EI, L = 2e4, 80.0
    rod = cantilever(L, rigid_in_stretch(EI), PointLoad(moment=2 * np.pi * EI / L * Y))
    found = solve(method, rod, resolution)
    assert found.converged.all()
    assert found.tips[0] == pytest.approx(np.zeros(3), abs=1e-6 * L)
    assert found.rotations[0] == pytest.approx(np.eye(3), abs=1e-6)
    middle = found.centrelines[0][np.argmin(abs(found.stations - L / 2))]
    assert middle == pytest.approx([L / np.pi, 0, 0], abs=1e-6 * L)


@every_method
@pytest.mark.parametrize(
    ("force", "tip"),
    [(300, (58.778897, 22.244679, 40.192392)), (600, (47.150096, 15.684689, 53.475478))],
)
def test_bend_of_45_degrees(
    method: Method, resolution: int, force: float, tip: tuple[float, float, float]
) -> None:
    """Bathe & Bolourchi 1979: an arc in the plane x, y from along x, force along z."""
    E, G = 1e7, 5e6
    law = SectionLaw(
        bending=np.diag([E / 12, E / 12, G / 6]),
        compliance=np.diag([1 / (G * 5 / 6), 1 / (G * 5 / 6), 1 / E]),
        coupling=np.zeros((3, 3)),
        free=(0, 1, 2),
    )
    rest = np.array([0, 1 / 100, 0, 0, 0, 1])
    segment = Segment(100 * np.pi / 4, law, rest, end=PointLoad(force=force * Z))
    rod = Rod((segment,), Base(rotation=np.column_stack([Y, Z, X])))
    found = solve(method, rod, resolution)
    assert found.converged.all()
    assert found.tips[0] == pytest.approx(tip, abs=2e-6)


@every_method
def test_follower_force_at_the_tip(method: Method, resolution: int) -> None:
    """Argyris & Symeonidis 1981: a cantilever's tip under a transverse force that turns with it."""
    law = SectionLaw(
        bending=np.diag([3.5e7, 3.5e7, 0]),
        compliance=np.diag([1 / 1.61538e8, 1 / 1.61538e8, 1 / 3.23077e8]),
        coupling=np.zeros((3, 3)),
    )
    rod = cantilever(100.0, law, PointLoad(follower_force=1e4 * X))
    found = solve(method, rod, resolution)
    assert found.converged.all()
    assert found.tips[0] - 100 * Z == pytest.approx([71.1093, 0, -41.6929], abs=6e-5)


@every_method
def test_without_loads_it_is_an_arc(method: Method, resolution: int) -> None:
    rng = np.random.default_rng(1)
    strains = rng.normal(size=(5, 3)) * [0.1, 0.02, 0.02]
    rest = np.zeros((5, 1, 6))
    rest[:, 0, :2] = strains[:, 1:]
    rest[:, 0, 5] = 1 + strains[:, 0]
    found = method.solve(cantilever(100.0, rigid_in_stretch(1e4)), rest, resolution)
    assert found.converged.all()
    assert found.tips == pytest.approx(arc_tips(strains, 100.0), abs=2e-5)
    assert found.centrelines[:, -1] == pytest.approx(found.tips)
    assert np.all(found.factor == 1)
