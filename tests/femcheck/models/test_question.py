"""Questions: their pressures, their law, and why no solid can answer."""

import numpy as np
import pytest

from beamopt.scene.named import named_design
from beamopt.target.workspace import pressure_grid
from femcheck.check.options import CheckOptions
from femcheck.models.question import Question
from femcheck.prediction.options import PredictionOptions
from femcheck.solid.winding import Wound
from femcheck.solved.subject import LoadedDesignError
from tests.femcheck.check.small import LEVELS, design_of, three_circles

OPEN = {"skin": 0, "wall": 0, "rounding": 0, "smallest_chamber": 0}


def test_the_27_unless_others_are_named() -> None:
    design = design_of(three_circles())
    question = Question.of("small", design, CheckOptions())
    np.testing.assert_array_equal(question.pressures, pressure_grid(LEVELS))
    assert question.is_on_grid
    assert not question.at(question.pressures[::-1]).is_on_grid
    assert not question.at(question.pressures[:26]).is_on_grid
    assert question.at(question.pressures.copy()).is_on_grid


@pytest.mark.parametrize(
    "pressures",
    [
        np.zeros((0, 3)),
        np.zeros(3),
        np.zeros((2, 2)),
        np.array([[0, np.nan, 0]]),
        np.array([[0, np.inf, 0]]),
    ],
)
def test_other_pressures_are_refused(pressures: np.ndarray) -> None:
    with pytest.raises(ValueError, match=r"finite and \(n, 3\)"):
        Question.of("small", design_of(three_circles()), CheckOptions(), pressures)


def test_laws_in_words() -> None:
    design = design_of(three_circles())
    rigid = Question.of("small", design, CheckOptions())
    wound = Question.of("small", design, PredictionOptions(law="yeoh", wound=Wound.OUTER))
    assert rigid.is_of_the_beam
    assert rigid.law_text == "rigid-section, c → ∞"
    assert not wound.is_of_the_beam
    assert wound.law_text == "yeoh, ν = 0.5, wound outside"


def test_why_no_solid_can_answer() -> None:
    """Loads, an open section, a fault of the outline; a sealed section has none."""
    touching = [{"supply": 1, "center": [12, 0], "radius": 4}, *three_circles()[1:]]
    opened = Question.of("open", design_of(touching, seal=OPEN), CheckOptions())
    assert opened.no_solid == "open is not sealed: it is a raster, and a solid is of an outline"
    loaded = Question.of(*named_design("gravity"), CheckOptions())
    assert str(loaded.no_solid).startswith("gravity has loads: ")
    with pytest.raises(LoadedDesignError):
        _ = loaded.subject
    segments = Question.of(*named_design("two-segments"), CheckOptions())
    assert "rod.segments" in str(segments.no_solid)
    assert Question.of("small", design_of(three_circles()), CheckOptions()).no_solid is None


def test_a_supply_without_a_chamber_is_no_reason() -> None:
    assert Question.of("two", design_of(three_circles()[:2]), CheckOptions()).no_solid is None
