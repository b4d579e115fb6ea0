"""The figure: lines stand at their pressures, every ending has a look, gaps are drawn as gaps."""

import json
from dataclasses import replace
from math import isnan
from pathlib import Path

import pytest

from femcheck.stability.axis import Axis
from femcheck.stability.ending import MapEnding
from femcheck.stability.figure import LOOKS, height_of, map_figure, validity_lines
from femcheck.stability.found import AxisFound
from femcheck.stability.stability_map import caption_of
from femcheck.stability.validity import Interval
from tests.femcheck.stability.small import an_axis, make


@pytest.mark.parametrize(
    ("pressure", "height"),
    [(0.0, 0.0), (2.0, 0.25), (4.0, 0.5), (6.0, 1.0), (12.0, 2.5), (14.0, 3.0)],
)
def test_heights(pressure: float, height: float) -> None:
    """Rows at 4, 8 and 12 kPa have their middles at 0.5, 1.5 and 2.5."""
    assert height_of(an_axis(), pressure) == pytest.approx(height)


@pytest.mark.parametrize("pressure", [None, 14.1, float("nan"), float("inf")])
def test_what_has_no_room(pressure: float | None) -> None:
    assert isnan(height_of(an_axis(), pressure))


def test_every_ending_has_its_own_look() -> None:
    assert set(LOOKS) == set(MapEnding)
    assert len({letter for letter, _, _ in LOOKS.values()}) == len(MapEnding)


def test_lines_go_on_between_columns_of_as_many_intervals() -> None:
    both, low = Interval(5.0, 9.0, True), Interval(6.0, 12.0, False)
    from_rest = Interval(0.0, 3.0, True)
    lines = validity_lines([[both], [low], [], [both], [from_rest, both]])
    assert lines == [[(0, 5.0), (1, 6.0)], [(0, 9.0)], [(3, 5.0)], [(3, 9.0)], *_of_two()]


def _of_two() -> list[list[tuple[int, float]]]:
    return [[(4, 3.0)], [(4, 5.0)], [(4, 9.0)]]


def test_drawn_with_gaps_and_alone(told: None, tmp_path: Path) -> None:
    """The whole map, one panel of it with cells missing, and a panel of no order."""
    found = make(tmp_path / "map", figures=True)
    assert (tmp_path / "map" / "stability.png").stat().st_size > 10_000
    row = found[0].rows[0]
    less = replace(row, cells=(None, *row.cells[1:]), trace=None)
    unordered: Axis = replace(found[0].axis, ordered=False)
    one = AxisFound(unordered, (less, *found[0].rows[1:]))
    figure = map_figure([one], "title", "caption")
    said = [text.get_text() for text in figure.axes[0].texts]
    assert said.count("s") == 2 + 3
    assert said.count("L") == 2 + 1
    assert "beam within 5%: to the end of the path in 2 of 2" in said


def test_the_same_results_give_the_same_drawing(told: None, tmp_path: Path) -> None:
    make(tmp_path / "a", figures=True)
    make(tmp_path / "b", figures=True)
    for name in ("stability.svg", "stability.png"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def test_the_figure_says_what_it_was_made_with(told: None, tmp_path: Path) -> None:
    """Whatever machine draws it: what counts is what it was computed with."""
    found = make(tmp_path / "map", figures=False)
    computed = json.loads((tmp_path / "map" / "provenance.json").read_text())
    said = caption_of(computed | {"workers": 7})
    for part in ("7 at once", "threads of each: ", "numpy", computed["machine"]["processor"]):
        assert part in said
    assert map_figure(found, "title", said).texts[-1].get_text() == said
