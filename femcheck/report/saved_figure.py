"""Figures that a folder holds as SVG files."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path

from beamopt.base.errors import InputError
from beamopt.storage.input_file import read_text

__all__ = ["SavedFigure", "read_figures", "shape_of"]

SIZE = re.compile(r"\s*([0-9]{1,9}(?:\.[0-9]*)?|\.[0-9]+)[a-z%]*\s*")
USUAL = 1.5  # width over height of a figure that does not say its size as a number


@dataclass(frozen=True, slots=True)
class SavedFigure:
    """A figure as it is shown.

    name : of its file, without ending. svg : the file. ratio : width over height.
    """

    name: str
    svg: str
    ratio: float


def read_figures(folder: Path) -> tuple[SavedFigure, ...]:
    """Every SVG file of a folder, by name.

    Raises
    ------
    InputError : one that is damaged.
    """
    found = []
    for file in sorted(folder.glob("*.svg")):
        svg = read_text(file)
        found.append(SavedFigure(file.stem, svg, shape_of(svg, file)))
    return tuple(found)


def shape_of(svg: str, file: object) -> float:
    """Width over height of a figure.

    Raises
    ------
    InputError : no SVG, or not a whole one.
    """
    try:
        root = ElementTree.fromstring(svg)
    except (ElementTree.ParseError, ValueError) as error:
        raise InputError(file, "", None, f"no whole SVG file: {error}") from None
    if not root.tag.endswith("svg"):
        raise InputError(file, "", root.tag, "must be an SVG figure")
    sizes = [SIZE.fullmatch(root.get(key, "")) for key in ("width", "height")]
    width, height = (float(size[1]) if size else 0.0 for size in sizes)
    return width / height if width > 0 and height > 0 else USUAL
