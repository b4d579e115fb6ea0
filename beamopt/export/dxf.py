"""A drawing as DXF in mm, for laser cutters and CAD programs."""

from __future__ import annotations

import io
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from beamopt.export.drawing import SCALE_BAR, Drawing
from beamopt.export.faces import Contour
from beamopt.export.step import require
from beamopt.plot.style import TYPE_COLOURS
from beamopt.section.feature_points import SUPPLIES

if TYPE_CHECKING:
    from ezdxf.document import Drawing as Document
    from ezdxf.layouts import Modelspace

__all__ = ["LAYERS", "dxf_bytes"]

LAYERS = ("MATERIAL", *(f"SUPPLY_{supply}" for supply in SUPPLIES))
"""By type: loops of material, and of each supply's chambers. Text stands on TEXT."""

MILLIMETRES = 4  # as $INSUNITS has it
TEXT = 3.0  # mm, height of letters
BELOW = 6.0  # mm from the section to the text

_settings = threading.Lock()  # ezdxf's are the whole process's


def dxf_bytes(drawing: Drawing) -> bytes:
    """The drawing as DXF R2010, the same bytes for the same drawing.

    Loops are closed LWPOLYLINEs, counter-clockwise around a face and clockwise around its holes;
    whole circles are CIRCLEs. A chamber's wall stands on two layers, as a hole of MATERIAL and as a
    loop of its supply; whoever cuts takes one.

    Raises
    ------
    InputError : ezdxf is not installed.
    """
    require("dxf")
    import ezdxf

    with _without_clock():
        document = ezdxf.new("R2010")
        document.header["$INSUNITS"] = MILLIMETRES
        document.header["$MEASUREMENT"] = 1  # metric patterns and line types
        for layer, colour in zip(LAYERS, TYPE_COLOURS, strict=True):
            document.layers.add(layer, true_color=int(colour[1:], 16))
        document.layers.add("TEXT")
        space = document.modelspace()
        for face in (*drawing.faces.pieces, *drawing.faces.chambers):
            for contour in face.contours:
                _add(space, contour, LAYERS[face.supply])
        _write(space, drawing)
        return _encoded(document)


def _add(space: Modelspace, contour: Contour, layer: str) -> None:
    on = {"layer": layer}
    if contour.radius is not None:
        space.add_circle((0.0, 0.0), contour.radius, dxfattribs=on)
    else:
        space.add_lwpolyline(contour.points.tolist(), close=True, dxfattribs=on)


def _write(space: Modelspace, drawing: Drawing) -> None:
    """Numbers in the chambers; below the section a bar of 10 mm and what there is to say."""
    from ezdxf.enums import TextEntityAlignment

    on = {"layer": "TEXT"}
    for label in drawing.labels:
        text = space.add_text(str(label.supply), height=0.7 * label.height, dxfattribs=on)
        text.set_placement((label.x, label.y), align=TextEntityAlignment.MIDDLE_CENTER)
    x, y = drawing.bounds[0], drawing.bounds[1] - BELOW
    bar = [(x, y + 1), (x, y), (x + SCALE_BAR, y), (x + SCALE_BAR, y + 1)]
    space.add_lwpolyline(bar, dxfattribs=on)
    for k, line in enumerate((f"{SCALE_BAR:g} mm", drawing.title, *drawing.lines)):
        at = (x, y - 1.6 * TEXT * (k + 1))
        space.add_text(line, height=TEXT, dxfattribs=on).set_placement(at)


@contextmanager
def _without_clock() -> Iterator[None]:
    """Let ezdxf write fixed dates and identifiers, and set it back."""
    import ezdxf

    with _settings:
        before = ezdxf.options.write_fixed_meta_data_for_testing
        ezdxf.options.write_fixed_meta_data_for_testing = True
        try:
            yield
        finally:
            ezdxf.options.write_fixed_meta_data_for_testing = before


def _encoded(document: Document) -> bytes:
    # ezdxf lists classes of objects in the order of a set, another one in every process
    document.classes.add_required_classes(document.dxfversion)
    document.classes.classes = dict(sorted(document.classes.classes.items()))
    stream = io.StringIO()
    document.write(stream)
    return document.encode(stream.getvalue())
