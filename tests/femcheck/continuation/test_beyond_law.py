"""Paths that stretch a solid beyond what its law describes: where they end, and with what."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from femcheck.continuation.outcome import Status
from femcheck.continuation.path import Path
from femcheck.continuation.trace import PathSteps
from femcheck.material.mooney_rivlin import MooneyRivlin
from femcheck.material.yeoh import Yeoh
from femcheck.mesh.extrusion import stations
from femcheck.solved.case import Case, Solid, solve_case
from tests.femcheck.solid.tubes import tube_section
from tests.validation.published_bodies import DIRECTION, Published, sphere

RATIO, MU, E = 2.0, 100.0, 300.0
SHORT = Yeoh(3 * MU, C2_ratio=-0.1, C3_ratio=0.0)
"""Rises up to a stretch below that of a thick sphere's limit point."""

FAR = 3 * MU


def followed(body: Published, law_end: float = FAR) -> Path:
    steps = PathSteps()
    return steps.trace(
        body.problem, body.predictor, DIRECTION, [law_end / 50, law_end], body.solver
    )


def sphere_pressure(law: Yeoh, inner: float) -> float:
    """P [kPa] of a thick sphere at the stretch of its cavity: ∫ W′/(λ³ − 1) dλ through the wall."""
    outer = (1 + (inner**3 - 1) / RATIO**3) ** (1 / 3)
    C1, C2, C3 = law.moduli.C1, law.C2_ratio * law.moduli.C1, law.C3_ratio * law.moduli.C1

    def slope(stretch: float) -> float:
        x = 2 * stretch**2 + stretch**-4 - 3
        bend = C1 + 2 * C2 * x + 3 * C3 * x**2
        return bend * (4 * stretch - 4 * stretch**-5) / (stretch**3 - 1)

    return float(quad(slope, outer, inner)[0])


def test_a_thick_sphere_ends_where_its_law_does() -> None:
    """In closed form: where the most stretched quadrature point passes the range.

    Strains at a point of facets are 1 % off those of a sphere; pressure against volume is not.
    """
    body = sphere(RATIO, SHORT, 2, 2)
    path = followed(body)
    assert path.status is Status.BEYOND_LAW
    assert path.stops[0] is not None
    assert path.stops[1] is None
    assert path.last is not None
    stretch, place = body.problem.largest_stretch(path.last.state)
    most = SHORT.most_stretch
    assert 0.98 * most < stretch <= most
    radius = float(np.linalg.norm(place)) / 10.0  # over that of the cavity
    inner = (1 + (most**3 - 1) * radius**3) ** (1 / 3)
    assert path.growth == pytest.approx(inner**3, rel=0.05)
    assert path.critical == pytest.approx(sphere_pressure(SHORT, np.cbrt(path.growth)), rel=5e-4)
    assert all(body.problem.largest_stretch(one.state)[0] <= most for one in path.points)


def test_a_limit_point_before_that_stays_one() -> None:
    """The range is left on the way behind it: the path ends there, with what ended it first."""
    law = Yeoh(3 * MU, C2_ratio=-0.005, C3_ratio=0.0)
    body = sphere(RATIO, law, 2, 2)
    path = PathSteps().trace(
        body.problem, body.predictor, DIRECTION, [FAR], body.solver, beyond=1e3
    )
    assert path.status is Status.LIMIT_POINT
    stretches = [body.problem.largest_stretch(point.state)[0] for point in path.points]
    assert max(stretches) <= law.most_stretch
    assert max(stretches) > 1.5


def test_a_law_without_an_end_is_not_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    law = Yeoh(3 * MU, C2_ratio=0.0, C3_ratio=0.0)
    assert math.isinf(law.most_stretch)
    body = sphere(RATIO, law, 1, 1)
    monkeypatch.setattr(type(body.problem), "largest_stretch", None)
    assert followed(body, 50.0).status is Status.CONVERGED


def test_no_negative_constant_is_unstable_at_rest() -> None:
    """Its energy falls where the volume changes: a mean volume that is kept does not hold that."""
    for law in (Yeoh(E, C2_ratio=-1.0, C3_ratio=0.0), MooneyRivlin(E, C2_share=-2.0)):
        path = followed(sphere(RATIO, law, 1, 1))
        assert path.points[0].unstable in (None, 0)
        assert path.status is Status.BEYOND_LAW
        assert path.critical > 0


def test_a_pressure_by_itself_ends_alike() -> None:
    """Load steps may find what no law describes; the path from rest says what ends it."""
    law = Yeoh(E, C2_ratio=-1.0, C3_ratio=0.0)
    solid = Solid("tube", tube_section(4.0, 5.0, 8), stations(20.0, 2), "wedge18", law)
    low, high = (solve_case(Case(solid, P * DIRECTION, None, None)) for P in (0.5, 16.0))
    assert low.status is Status.CONVERGED
    assert high.status is Status.BEYOND_LAW
    assert high.shape is None
    assert 0 < high.outcome.reached < 1
