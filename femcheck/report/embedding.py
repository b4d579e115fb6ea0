"""Files inside the page: figures as images, tables as downloads, data for the viewer."""

from __future__ import annotations

import base64
import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from beamopt.plot.style import figure_bytes
from femcheck.report.content import ReportTable
from femcheck.report.saved_figure import SavedFigure, shape_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Download", "Picture", "download", "drawn", "json_block", "picture"]

WIDE = 1.6  # width over height from which on a figure takes the page's whole width


@dataclass(frozen=True, slots=True)
class Picture:
    """A figure on the page.

    Figures are images, not elements of the page: scripts in them never run, nothing is loaded.

    name : for saving it. caption : below it, and for those who do not see it. link : the image.
    """

    name: str
    caption: str
    link: str
    is_wide: bool


@dataclass(frozen=True, slots=True)
class Download:
    """A file that the page carries. size : for people."""

    name: str
    size: str
    link: str


def drawn(name: str, figure: Figure, caption: str) -> Picture:
    """A figure drawn now."""
    svg = figure_bytes(figure, "svg")[0].decode("utf-8")
    return picture(SavedFigure(name, svg, shape_of(svg, name)), name, caption)


def picture(figure: SavedFigure, name: str, caption: str) -> Picture:
    """A figure that stood in a folder."""
    return Picture(name, caption, _link("image/svg+xml", figure.svg), figure.ratio > WIDE)


def download(table: ReportTable, name: str) -> Download:
    """A table as it stood in its folder."""
    size = len(table.text.encode("utf-8"))
    said = f"{size / 1000:.0f} kB" if size >= 1000 else f"{size} bytes"
    return Download(name, said, _link("text/csv;charset=utf-8", table.text))


def json_block(value: Any) -> Markup:
    """JSON that can not end the element it stands in, whatever texts it holds."""
    text = json.dumps(value, ensure_ascii=True, separators=(",", ":"), allow_nan=False)
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return Markup(text)


def _link(kind: str, text: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(text.encode('utf-8')).decode('ascii')}"
