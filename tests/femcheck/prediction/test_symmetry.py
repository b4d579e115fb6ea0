"""What three equal chambers, or a turned section, must show."""

from typing import Any

import numpy as np
import pytest

from beamopt.base.arrays import FloatArray
from femcheck.continuation.outcome import Status
from femcheck.mesh.gmsh_section import MeshFailure
from femcheck.prediction.ray_trace import RayResult, RayTask, trace_ray
from femcheck.prediction.rays import Ray
from femcheck.solid.plate import rotation
from femcheck.solved.case import Solid
from femcheck.solved.meshes import heights_of, section_meshes
from tests.femcheck.check.small import Coarse, design_of, three_circles
from tests.femcheck.prediction.small import SOFT, options_of

THIRD = rotation(np.array([0.0, 0.0, 2 * np.pi / 3]))


def circles(radii: tuple[float, float, float], turned: float = 0.0) -> list[dict[str, Any]]:
    """The disc's chambers, of other radii and turned [rad]."""
    drawing = []
    for shape, radius in zip(three_circles(), radii, strict=True):
        x, y = shape["center"]
        c, s = np.cos(turned), np.sin(turned)
        drawing.append(shape | {"center": [c * x - s * y, s * x + c * y], "radius": radius})
    return drawing


def traced(drawing: list[dict[str, Any]], rays: list[Ray]) -> list[tuple[RayResult, FloatArray]]:
    """Results, and tips at the first stop from where they were at rest."""
    moduli = {"youngs_modulus": SOFT, "shear_modulus": SOFT / 3}
    subject, options = Coarse("disc", design_of(drawing, actuator=moduli)), options_of()
    sections = section_meshes(subject, options)
    assert not isinstance(sections, MeshFailure)
    law = options.law_for(subject.design.actuator)
    heights = heights_of(subject, options)["standard"]
    solid = Solid("standard", sections[0], heights, "wedge18", law)
    rest = np.append(solid.section.moments.centroid, 100.0)
    found = []
    for ray in rays:
        result = trace_ray(RayTask(solid, ray))
        first = result.answers[0]
        assert first is not None
        found.append((result, first.tip - rest))
    return found


def alone(*stops: float) -> list[Ray]:
    a, b, c = ((float(k == 0), float(k == 1), float(k == 2)) for k in range(3))
    return [Ray(a, stops), Ray(b, stops), Ray(c, stops)]


@pytest.fixture(scope="module")
def equal() -> list[tuple[RayResult, FloatArray]]:
    return traced(circles((3.0, 3.0, 3.0)), alone(15.0, 60.0))


def test_three_equal_chambers_balloon_at_one_pressure(
    equal: list[tuple[RayResult, FloatArray]],
) -> None:
    """To 1 %: outline and mesh are not symmetric, the drawing is."""
    assert [result.status for result, _ in equal] == [Status.LIMIT_POINT] * 3
    critical = [result.critical for result, _ in equal]
    assert max(critical) < 1.01 * min(critical)
    assert 20 < min(critical) < 35


def test_three_equal_chambers_bend_three_ways(equal: list[tuple[RayResult, FloatArray]]) -> None:
    """Tips a third of a turn apart, each away from its chamber; 3 % of how far they move."""
    moved = [tip for _, tip in equal]
    far = float(np.linalg.norm(moved[0]))
    for k in (1, 2):
        np.testing.assert_allclose(moved[k], THIRD @ moved[k - 1], atol=0.03 * far)
    # chamber 1 is on the x axis
    assert moved[0][0] < -0.5 * far


def test_a_turned_design_permutes_tips() -> None:
    """Chamber 1 where chamber 2 was, and so on: tips turn, limits stay; 3 % by the mesh."""
    radii = (2.8, 3.1, 3.4)
    ray = [Ray((1.0, 0.5, 0.0), (15.0, 60.0))]
    ((before, there),) = traced(circles(radii), ray)
    ((after, turned),) = traced(circles(radii, 2 * np.pi / 3), ray)
    far = float(np.linalg.norm(there))
    np.testing.assert_allclose(turned, THIRD @ there, atol=0.03 * far)
    assert np.linalg.norm(turned - there) > 0.5 * far
    assert after.critical == pytest.approx(before.critical, rel=0.01)
