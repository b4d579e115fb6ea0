"""A drawing as SVG in mm: printed at 100 % it is 1:1."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from xml.sax.saxutils import escape

from beamopt.export.drawing import SCALE_BAR, Drawing, Label
from beamopt.export.faces import Contour, Face
from beamopt.plot.style import OUTLINE_COLOUR, TYPE_COLOURS

__all__ = ["svg_text"]

MARGIN = 12.0  # mm around the section
STEP = 4.6  # mm between lines of text
LINE = 0.15  # mm, width of outlines
TEXT = 2.8  # mm, size of letters
LETTER = 0.62  # of a letter's size: no sans serif is wider on average
ARROW = 8.0  # mm, length of the axes
SMALLEST_HOLE = 8.0  # mm; narrower ones have no room for their diameter
ADVICE = f"printed at 100 % the bar is {SCALE_BAR:g} mm long"


def svg_text(drawing: Drawing) -> str:
    """The drawing, its user unit one mm; coordinates within the section are the design's own.

    Faces are filled paths, holes left out; whole circles are arcs of a circle. The supplies'
    numbers stand in their chambers, so that it can be read without colour.
    """
    x0, y0, x1, y1 = drawing.bounds
    lines = (*drawing.lines, ADVICE)
    longest = max(1.2 * len(drawing.title), *map(len, lines))
    width = max(x1 - x0, LETTER * TEXT * longest) + 2 * MARGIN
    left, top = width / 2 - (x0 + x1) / 2, MARGIN + y1  # where the axis is on the sheet
    under = MARGIN + y1 - y0
    low = under + 12.0 + ARROW  # where the axes and the bar stand
    height = low + STEP * (len(lines) + 2) + MARGIN / 2
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_n(width)}mm" height="{_n(height)}mm"'
        f' viewBox="0 0 {_n(width)} {_n(height)}">',
        f"<title>{escape(drawing.title)}</title>",
        f'<g font-family="sans-serif" font-size="{TEXT}" stroke-width="{LINE}"'
        f' stroke="{OUTLINE_COLOUR}" stroke-linejoin="round">',
        f'<g transform="translate({_n(left)} {_n(top)}) scale(1 -1)" fill-rule="evenodd">',
        *map(_path, (*drawing.faces.pieces, *drawing.faces.chambers)),
        "</g>",
        *(_number(label, left, top) for label in drawing.labels),
        *_diameters(drawing, left, top, under),
        *_axes(low),
        *_scale_bar(width, low),
        *_text((drawing.title, *lines), low + 1.6 * STEP),
        "</g>",
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _path(face: Face) -> str:
    lines = " ".join(map(_line, face.contours))
    colour = TYPE_COLOURS[face.supply]
    return f'<path id="{face.name}" class="supply-{face.supply}" fill="{colour}" d="{lines}"/>'


def _line(contour: Contour) -> str:
    """A loop of straight edges, or a circle in two halves, run through the same way."""
    if contour.radius is not None:
        r, sweep = _n(contour.radius), int(contour.area > 0)
        half = f"A{r} {r} 0 0 {sweep}"
        return f"M{r} 0{half} -{r} 0{half} {r} 0Z"
    return "M" + "L".join(f"{_n(x)} {_n(y)}" for x, y in contour.points.tolist()) + "Z"


def _number(label: Label, left: float, top: float) -> str:
    h = label.height
    return (
        f'<text x="{_n(left + label.x)}" y="{_n(top - label.y + 0.36 * h)}" font-size="{_n(h)}"'
        f' text-anchor="middle" fill="black" stroke="white" stroke-width="{_n(0.2 * h)}"'
        f' paint-order="stroke">{label.supply}</text>'
    )


def _diameters(drawing: Drawing, left: float, top: float, under: float) -> Iterator[str]:
    """The outer one below the section, the inner one across the hole."""
    outer, inner = drawing.outer_diameter, drawing.inner_diameter
    if outer is not None:
        y = under + 6.0
        for x in (left - outer / 2, left + outer / 2):
            yield f'<path fill="none" d="M{_n(x)} {_n(under + 1.5)}V{_n(y + 1.5)}"/>'
        yield from _dimension(left, y, outer)
    if inner is not None and inner >= SMALLEST_HOLE:
        yield from _dimension(left, top, inner)


def _dimension(middle: float, y: float, diameter: float) -> Iterator[str]:
    first, last = middle - diameter / 2, middle + diameter / 2
    yield from _arrow(first, y, last, y)
    yield from _arrow(last, y, first, y)
    yield _said(middle, y - 0.9, f"⌀ {diameter:g}", "middle")


def _axes(y: float) -> Iterator[str]:
    """Arrows along x and y, at the left."""
    x = MARGIN
    yield from _arrow(x, y, x + ARROW, y)
    yield from _arrow(x, y, x, y - ARROW)
    yield _said(x + ARROW + 1.0, y + 1.0, "x")
    yield _said(x - 0.8, y - ARROW - 1.0, "y")


def _arrow(x: float, y: float, to_x: float, to_y: float) -> Iterator[str]:
    """A straight line along an axis of the sheet, with its head at the end."""
    size = max(abs(to_x - x), abs(to_y - y))
    u, v = (to_x - x) / size, (to_y - y) / size
    long, wide = min(2.0, size / 2), min(0.5, size / 8)
    bx, by = to_x - long * u, to_y - long * v
    corners = [(to_x, to_y), (bx - wide * v, by + wide * u), (bx + wide * v, by - wide * u)]
    head = "L".join(f"{_n(a)} {_n(b)}" for a, b in corners)
    yield f'<path fill="none" d="M{_n(x)} {_n(y)}L{_n(to_x)} {_n(to_y)}"/>'
    yield f'<path fill="{OUTLINE_COLOUR}" stroke="none" d="M{head}Z"/>'


def _scale_bar(width: float, y: float) -> Iterator[str]:
    """10 mm in ten parts, every second one filled, at the right."""
    start = width - MARGIN - SCALE_BAR
    for k in range(int(SCALE_BAR)):
        colour = OUTLINE_COLOUR if k % 2 == 0 else "white"
        yield (
            f'<rect x="{_n(start + k)}" y="{_n(y - 1.5)}" width="1" height="1.5" fill="{colour}"/>'
        )
    yield _said(start + SCALE_BAR / 2, y - 2.5, f"{SCALE_BAR:g} mm", "middle")


def _text(lines: Sequence[str], y: float) -> Iterator[str]:
    """The title, and what there is to say below it."""
    for k, line in enumerate(lines):
        yield _said(MARGIN, y + STEP * k, line, size=TEXT if k else 1.2 * TEXT)


def _said(x: float, y: float, text: str, anchor: str = "start", size: float = TEXT) -> str:
    return (
        f'<text x="{_n(x)}" y="{_n(y)}" font-size="{_n(size)}" text-anchor="{anchor}"'
        f' fill="black" stroke="none">{escape(text)}</text>'
    )


def _n(value: float) -> str:
    """A number of mm to a nanometre, without needless digits."""
    return f"{value:.6f}".rstrip("0").rstrip(".").replace("-0.000000", "0") or "0"
