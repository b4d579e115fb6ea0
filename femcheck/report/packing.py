"""Shapes as text that a page carries: whole numbers of 16 and 8 bits in base64."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray
from femcheck.report.shapes import RunShapes
from femcheck.report.surface import PARTS

__all__ = ["Scale", "pack", "stretch_range", "unpack_positions"]

STEPS = 65535  # of an unsigned number of 16 bits
LINE_DIGITS = 2  # of a millimetre: a hundredth is less than a screen shows


@dataclass(frozen=True, slots=True)
class Scale:
    """Positions as whole numbers q: offset + step · q [mm], the same step along all axes."""

    offset: tuple[float, float, float]
    step: float

    @classmethod
    def around(cls, points: FloatArray) -> Scale:
        """The finest one that holds all points (…, 3) [mm]."""
        flat = points.reshape(-1, 3)
        low, high = flat.min(axis=0), flat.max(axis=0)
        extent = float((high - low).max())
        return cls(tuple(low.tolist()), extent / STEPS if extent > 0 else 1.0)

    def pack(self, points: FloatArray) -> str:
        """Positions (n, 3) [mm] as base64 of little-endian numbers of 16 bits."""
        steps = np.rint((points - np.array(self.offset)) / self.step)
        return _base64(np.clip(steps, 0, STEPS).astype("<u2"))


def unpack_positions(text: str, scale: Scale) -> FloatArray:
    """(n, 3) positions [mm], as the page gets them back."""
    steps = np.frombuffer(base64.b64decode(text), dtype="<u2").reshape(-1, 3)
    return np.asarray(np.array(scale.offset) + scale.step * steps)


def stretch_range(shapes: RunShapes) -> tuple[float, float]:
    """Smallest and largest stretch of all shapes: the ends of the colour scale."""
    low = min(float(shape.stretch.min()) for shape in shapes.shapes)
    high = max(float(shape.stretch.max()) for shape in shapes.shapes)
    return (low, high) if high - low > 1e-6 else (low, low + 0.01)


def pack(shapes: RunShapes) -> dict[str, Any]:
    """What the viewer needs, as JSON holds it.

    Triangles stand part by part, `parts` says how many each has.
    """
    surface = shapes.surface
    scale = Scale.around(np.stack([shape.at for shape in shapes.shapes]))
    low, high = stretch_range(shapes)
    wide = "<u2" if len(surface.rest) <= STEPS else "<u4"
    return {
        "offset": list(scale.offset),
        "step": scale.step,
        "triangles": _base64(surface.triangles.astype(wide)),
        "wide": wide == "<u4",
        "parts": np.bincount(surface.part, minlength=len(PARTS)).tolist(),
        "stretch": [round(low, 4), round(high, 4)],
        "shapes": [
            {
                "at": scale.pack(shape.at),
                "stretch": _base64(
                    np.rint(255 * (shape.stretch - low) / (high - low)).astype(np.uint8)
                ),
                "line": np.round(shape.line, LINE_DIGITS).ravel().tolist(),
            }
            for shape in shapes.shapes
        ],
        "of": list(shapes.of),
    }


def _base64(array: Any) -> str:
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode("ascii")
