"""Figures that show themselves in a notebook, without pyplot."""

import struct

import beamopt
from tests.femcheck.check.small import design_of, three_circles


def test_a_figure_shows_itself() -> None:
    """As IPython's formatter asks it to."""
    figure = beamopt.design_figure(design_of(three_circles()))
    try:
        from IPython.core.formatters import DisplayFormatter
    except ImportError:
        shown = figure._repr_png_()
    else:
        shown = DisplayFormatter().format(figure)[0]["image/png"]
    assert shown.startswith(b"\x89PNG")
    width, height = struct.unpack(">II", shown[16:24])
    assert (width, height) == (1300, 560)
