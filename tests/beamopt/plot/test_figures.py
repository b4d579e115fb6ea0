from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.colors import to_rgb

from beamopt.plot.figures import convergence_figure, design_figure
from beamopt.plot.section import OUTSIDE, section_pixels
from beamopt.plot.style import TYPE_COLOURS, pressure_colours, save_figure
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.design import load_design

DRAWN = bundled_scenes()["hand-drawn-section"].with_name("hand_drawn_section.json")


def test_pixels_show_the_areas_and_sides() -> None:
    section = load_design(DRAWN).section
    pixels = section_pixels(section, 500)
    mm2 = (2 * section.grid.outer_radius / 500) ** 2
    for supply in (1, 2, 3):
        area = section.moments.chamber_areas[supply - 1]
        assert (pixels == supply).sum() * mm2 == pytest.approx(area, rel=0.01)
    assert pixels[250, 250] == OUTSIDE
    assert pixels[250, 250 + 175] == 1  # at (17.5, 0): to the right
    assert pixels[60, 250 - 60] == 2  # above: rows run downwards


@pytest.mark.parametrize("ending", ["svg", "png", "pdf"])
def test_the_same_figure_gives_the_same_bytes(ending: str, tmp_path: Path) -> None:
    design = load_design(DRAWN)
    files = [tmp_path / f"{k}.{ending}" for k in range(2)]
    for file in files:
        save_figure(design_figure(design, design.workspace), file)
    assert files[0].read_bytes() == files[1].read_bytes()


def test_drawing_leaves_the_callers_settings_alone() -> None:
    before = dict(mpl.rcParams)
    convergence_figure([3.0, 2.0], np.array([4.0, 3.0]), [3.0, 2.0])
    assert dict(mpl.rcParams) == before


def test_types_differ_in_lightness_too() -> None:
    """Printed in grey, and for the colour-blind: yellow, grey, red and blue stay apart."""
    weights = np.array([0.2126, 0.7152, 0.0722])
    lightness = sorted(float(weights @ np.array(to_rgb(c)) ** 2.2) for c in TYPE_COLOURS)
    assert min(np.diff(lightness)) > 0.1


def test_backbones_are_coloured_by_pressure() -> None:
    colours = pressure_colours(np.array([[0.0, 0, 0], [100, 0, 50]]))
    np.testing.assert_array_equal(colours, [[0, 0, 0], [1, 0, 0.5]])


def test_a_persons_own_settings_change_no_byte(tmp_path: Path) -> None:
    design = load_design(DRAWN)
    save_figure(design_figure(design), tmp_path / "plain.png")
    with mpl.rc_context({"savefig.dpi": 40, "figure.facecolor": "black", "lines.linewidth": 5}):
        save_figure(design_figure(design), tmp_path / "set.png")
    assert (tmp_path / "plain.png").read_bytes() == (tmp_path / "set.png").read_bytes()
