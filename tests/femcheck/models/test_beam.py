"""The beam's rungs as models: rasters, the outline, and rods by other methods."""

import numpy as np
import pytest

from beamopt.scene.design import Design
from beamopt.scene.named import named_design
from femcheck.check.options import CheckOptions
from femcheck.continuation.ended import Ended, NoReply
from femcheck.models.beam import TIGHTEST, ArcOnGrid, RodByMethod, RodOnOutline, on_grid
from femcheck.models.question import Question
from tests.femcheck.check.small import design_of, three_circles

FINEST = {
    "adaptive": 9,
    "modes": 12,
    "elements": 256,
    "shooting": 256,
    "multiple-shooting": 256,
    "collocation": 8,
}


def asked(design: Design, name: str = "small") -> Question:
    return Question.of(name, design, CheckOptions())


def test_rasters_converge_to_the_smooth_outline() -> None:
    """Eight times as fine, a tenth of the error; the polygons stay a chord's error away."""
    question = asked(design_of(three_circles()))
    subject = question.subject
    _, smooth, outline = subject.outline.views(question.design.section.moments)
    errors = [
        ArcOnGrid(*grid).reply(question).away(subject.tips_of(smooth)).max()
        for grid in ((16, 60), (32, 120), (128, 480))
    ]
    assert errors[0] > 2 * errors[1] > 4 * errors[2]
    assert errors[2] < min(errors[0] / 10, 0.03)
    polygons = RodOnOutline().reply(question)
    assert polygons.away(subject.tips_of(outline)).max() < 1e-9
    assert polygons.away(subject.tips_of(smooth)).max() < 0.1
    other = asked(on_grid(question.design, 64, 240))
    assert polygons.away(RodOnOutline().reply(other).tips).max() < 1e-9


@pytest.mark.parametrize(
    ("walls", "radial", "scaled"),
    [(0, 64, 0), (2, 32, 2), (2, 64, 4), (2, 128, 8), (4, 16, 2), (2, 16, 2)],
)
def test_walls_of_elements_keep_their_thickness(walls: int, radial: int, scaled: int) -> None:
    """To an even number, and never none where there are some."""
    seal = {"skin": 0, "wall": 0, "rounding": 0, "smallest_chamber": 0, "islands": "keep"}
    design = design_of(three_circles(), seal=seal, wall_elements=walls)
    assert on_grid(design, radial, 90).wall_elements == scaled


def test_another_raster_is_another_section() -> None:
    """Even where the design knows its own already."""
    design = design_of(three_circles())
    before = design.section.moments
    other = on_grid(design, 16, 60)
    assert (other.grid.radial, other.grid.angular) == (16, 60)
    assert other.section is not design.section
    assert abs(float(other.section.moments.area / before.area) - 1) > 1e-4
    assert (design.grid.radial, design.grid.angular) == (32, 120)


def test_a_raster_without_material_is_a_reason() -> None:
    whole = [{"supply": 1, "center": [0, 0], "radius": 30}]
    seal = {"skin": 0, "wall": 0, "rounding": 0, "smallest_chamber": 0, "islands": "keep"}
    reply = ArcOnGrid(16, 60).reply(asked(design_of(whole, seal=seal)))
    assert reply.ended == Ended(NoReply.NOT_STIFF)
    assert np.isnan(reply.tips).all()
    assert not reply.found.any()


@pytest.mark.parametrize("scene", ["uniform", "gravity", "two-segments"])
def test_every_method_is_the_rod(scene: str) -> None:
    """Also where it is sent through a straight uniform rod that needs none of it."""
    design = design_of(three_circles()) if scene == "uniform" else named_design(scene)[1]
    question = asked(design, scene)
    rod = RodOnOutline(1e-8 * design.actuator.length).reply(question)
    assert rod.is_whole
    for method, count in FINEST.items():
        found = RodByMethod(method, count).reply(question)
        assert found.is_whole, method
        assert found.away(rod.tips).max() < 2e-5, method


def test_a_rod_between_grid_points_is_that_of_the_grid() -> None:
    """Parents among the 27 help to find the equilibrium, and do not change it."""
    name, design = named_design("gravity")
    question = asked(design, name)
    rows = [26, 4, 13]
    alone = RodOnOutline(1e-5).reply(question.at(question.pressures[rows]))
    assert alone.away(RodOnOutline(1e-5).reply(question).tips[rows]).max() < 2e-5


@pytest.mark.parametrize("tolerance", [1e-30, 1e-12, 3e3])
def test_any_tolerance_can_be_asked(tolerance: float) -> None:
    """Beyond what a rod is solved to, it is the tightest; beyond a tenth, that."""
    name, design = named_design("gravity")
    question = asked(design, name).at(np.array([[100.0, 0.0, 0.0]]))
    length = design.actuator.length
    same = float(np.clip(tolerance, TIGHTEST * length, 0.1 * length))
    found = RodOnOutline(tolerance).reply(question)
    assert found.away(RodOnOutline(same).reply(question).tips).max() == 0
    assert RodOnOutline(tolerance).resolution == f"{tolerance:g} mm"


def test_a_supply_without_a_chamber_moves_nothing() -> None:
    question = asked(design_of(three_circles()[:2])).at(np.array([[0.0, 0.0, 40.0]]))
    for model in (ArcOnGrid(32, 120), RodOnOutline(), RodByMethod("modes", 8)):
        tip = model.reply(question).tips[0]
        np.testing.assert_allclose(tip, [0, 0, question.design.actuator.length], atol=1e-9)
