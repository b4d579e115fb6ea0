"""Something held: what one rung of the ladder says of one design, and how exactly."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from beamopt.base.arrays import FloatArray
from femcheck.continuation.ended import Ended, NoReply
from femcheck.models.reply import Reply

__all__ = ["LADDER", "Held", "Row", "at", "columns", "is_late", "of_reply", "rounding"]

Row = tuple[float, ...] | Ended
"""Numbers, or why there are none."""

LADDER = (
    "section",
    "outline",
    "response",
    "loads",
    "torsion",
    "raster",
    "beam",
    "chain of segments",
    "rod under load",
    "rod, modes",
    "rod, elements",
    "kept mesh",
    "beam on kept mesh",
    "gmsh",
    "solid at rest",
    "solid, rigid-section",
    "solid, compressible",
    "solid, incompressible",
    "solid, wound",
    "solid, limit",
)
"""The rungs from the lowest one; each builds on some before it."""

ROUNDING = 1e-9  # of the size of a closed form: a thousand operations and another library's sine
SPARE = 2  # digits written below a tolerance


@dataclass(frozen=True, eq=False)
class Held:
    """What one rung says.

    rung : one of `LADDER`. resolution : how fine, for people. law : of the material; "" where the
    rung has none.
    quantity : what the rows are: "tips", "areas", …
    unit : of the numbers.
    rows : by pressures or by name.
    tolerance : in the unit: how far a row may move, as the length of the vector of its change.
    source : where the tolerance comes from.
    """

    rung: str
    resolution: str
    quantity: str
    unit: str
    rows: Mapping[str, Row]
    tolerance: float
    source: str
    law: str = ""

    @property
    def key(self) -> tuple[str, str, str]:
        """What makes two of them the same thing at different times."""
        return self.rung, self.resolution, self.quantity

    @property
    def decimals(self) -> int | None:
        """Decimals that its tolerance leaves a meaning to, and two more; None for all of them."""
        if not 0 < self.tolerance < math.inf:
            return None
        return max(0, math.ceil(-math.log10(self.tolerance)) + SPARE)

    def written(self) -> Held:
        """The same with no more digits than that: rounding alone never moves a row."""
        rows = {
            name: row if isinstance(row, Ended) else tuple(_round(v, self.decimals) for v in row)
            for name, row in self.rows.items()
        }
        tolerance = float(f"{self.tolerance:.1e}")
        return replace(self, rows=rows, tolerance=tolerance)


def _round(value: float, decimals: int | None) -> float:
    rounded = float(value) if decimals is None else round(float(value), decimals)
    return rounded + 0.0  # no "−0.0"


def is_late(row: Row | None) -> bool:
    """True if a clock or a kill ended the case of a row: nothing is known of it."""
    return isinstance(row, Ended) and row.status.is_interrupted


def at(pressures: FloatArray) -> str:
    """A pressure combination (3,) as a row's name."""
    return ", ".join(f"{value:.6g}" for value in pressures) + " kPa"


def of_reply(pressures: FloatArray, reply: Reply) -> dict[str, Row]:
    """Rows of a model's reply at the pressures (n, 3) [kPa]."""
    return {
        at(one): tuple(tip.tolist()) if ended.is_found else ended
        for one, tip, ended in zip(pressures, reply.tips, reply.endings, strict=True)
    }


def columns(names: Iterable[str], values: FloatArray) -> dict[str, Row]:
    """Rows by name; values (n,) or (n, k), with an ending in place of what is not finite."""
    rows: dict[str, Row] = {}
    for name, row in zip(names, np.asarray(values, dtype=np.float64), strict=True):
        numbers = np.atleast_1d(row)
        finite = bool(np.isfinite(numbers).all())
        rows[name] = tuple(numbers.tolist()) if finite else Ended(NoReply.NOT_FINITE)
    return rows


def rounding(size: float) -> tuple[float, str]:
    """Tolerance of a closed form whose numbers are of a size, and its source."""
    return ROUNDING * size, f"rounding of a closed form: {ROUNDING:g} of {size:.3g}"
