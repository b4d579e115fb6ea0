"""Charts of methods: the same bytes for the same numbers, and nothing that is not known drawn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from beamopt.plot.error_chart import LOOKS, Line, error_figure
from beamopt.plot.stability_map import Cell, Panel, map_figure
from beamopt.plot.style import save_figure

NAN = float("nan")
NONE = "tip without equilibrium"


def lines() -> list[Line]:
    whole, part = np.array([True, True, True]), np.array([True, False, True])
    return [
        Line("arc", [None], np.array([1e-5]), np.array([3.0]), np.array([True])),
        Line("modes", [1, 2, 3], np.array([1e-3, 2e-3, 4e-3]), np.array([1.0, 1e-3, 0.0]), whole),
        Line("elements", [4, 8, 16], np.array([1e-2, 2e-2, NAN]), np.array([0.1, 0.02, NAN]), part),
        Line("another one", [1], np.array([1.0]), np.array([1e-9]), np.array([True])),
    ]


def panel(columns: int = 3) -> Panel:
    cells: list[list[Cell | None]] = [
        [Cell("RIGHT", 0.002, False), Cell("RIGHT", 0.2, True), Cell("UNDECIDED", NAN, False)],
        [
            Cell("WRONG_BRANCH", 12.0, False, 0.25),
            None,
            Cell("NO_SUCH_TIP", 1e-5, False),
        ],
    ]
    return Panel("loads", ["modes", "shooting"], ["0.01", "1", "100"][:columns], cells)


@pytest.mark.parametrize("name", ["errors.svg", "map.png"])
def test_the_same_numbers_give_the_same_bytes(name: str, tmp_path: Path) -> None:
    files = [tmp_path / f"{k}-{name}" for k in range(2)]
    for file in files:
        is_map = name.startswith("map")
        drawn = map_figure([panel()], across=1) if is_map else error_figure(lines(), 0.1, 1e-8)
        save_figure(drawn, file)
    assert files[0].read_bytes() == files[1].read_bytes()


def test_errors_that_are_nothing_are_not_drawn() -> None:
    axes = error_figure(lines(), 0.1, 1e-8).axes[0]
    drawn = {line.get_label(): len(line.get_xdata()) for line in axes.lines}
    assert drawn["modes"] == 2
    assert drawn["elements"] == 1  # the other one is a cross: not all cases have a tip
    assert drawn["another one"] == 1
    assert "scene's tolerance" in drawn
    assert axes.get_ylim()[0] < 1e-8


def test_methods_differ_in_more_than_colour() -> None:
    looks = {(str(one["marker"]), str(one["ls"]), one.get("mfc")) for one in LOOKS.values()}
    assert len(looks) == len(LOOKS)


def test_the_legend_takes_an_empty_place_or_stands_below() -> None:
    three, one = map_figure([panel()] * 3), map_figure([panel()], across=1)
    assert three.axes[3].get_legend() is not None
    assert not three.legends
    assert len(one.legends) == 1


def test_cells_are_lettered_and_timed() -> None:
    axes = map_figure([panel()], across=1).axes[0]
    texts = [text.get_text() for text in axes.texts]
    assert texts == ["R", "2 ms", "R", "0.20 s", "?", "", "W 25%", "12.00 s", "N", "0.01 ms"]
    assert len(axes.patches) == 5 + 1  # cells, and one corner
