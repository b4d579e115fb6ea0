"""The workspace: tips at 27 pressure combinations, the quadratic hexahedron over them, the loss."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray
from beamopt.storage.writing import csv_text

if TYPE_CHECKING:
    from pandas import DataFrame

__all__ = [
    "COLUMNS",
    "HEXAHEDRON_EDGES",
    "HEXAHEDRON_NODES",
    "NODES",
    "Workspace",
    "loss",
    "node_index",
    "pressure_grid",
    "rms_distance",
    "tips_csv",
]


COLUMNS = {"p1": "kPa", "p2": "kPa", "p3": "kPa", "x": "mm", "y": "mm", "z": "mm"}
"""Columns of a table of tips, and their units."""

NODES = 27
"""Pressure combinations of a workspace: three levels of three supplies."""


def node_index(i: int, j: int, k: int) -> int:
    """Place in `pressure_grid`'s order of the levels i, j, k (0…2) of supplies 1, 2, 3."""
    return 9 * i + 3 * j + k


def pressure_grid(levels: Sequence[float]) -> FloatArray:
    """(n³, 3) all combinations of pressure levels [kPa], p3 running fastest, p1 slowest."""
    axes = np.meshgrid(levels, levels, levels, indexing="ij")
    return np.stack(axes, axis=-1).reshape(-1, 3).astype(np.float64)


def loss(tips: FloatArray, target: FloatArray) -> FloatArray:
    """L = Σ |h_j − w_j|² over the nodes, (…, n, 3) → (…) [mm²] (paper, First Objective)."""
    return np.asarray(((tips - target) ** 2).sum(axis=(-2, -1)))


def rms_distance(loss: float, nodes: int) -> float:
    """Root mean square distance of the nodes [mm] that belongs to a loss [mm²]."""
    return float(np.sqrt(loss / nodes))


def _vtk_order() -> list[tuple[int, int, int]]:
    """Level indices (of p1, p2, p3) of the nodes of VTK's triquadratic hexahedron, in its order.

    Eight corners, twelve edge middles, six face middles (p1 low, high, p2 low, high, p3 low,
    high), the centre.
    """
    corners = [(0, 0), (2, 0), (2, 2), (0, 2)]
    middles = [(1, 0), (2, 1), (1, 2), (0, 1)]
    ends = [(*c, k) for k in (0, 2) for c in corners]
    edges = [(*m, k) for k in (0, 2) for m in middles] + [(*c, 1) for c in corners]
    faces = [(0, 1, 1), (2, 1, 1), (1, 0, 1), (1, 2, 1), (1, 1, 0), (1, 1, 2)]
    return [*ends, *edges, *faces, (1, 1, 1)]


HEXAHEDRON_NODES: NDArray[np.int64] = np.array([node_index(*at) for at in _vtk_order()])
"""(27,) index in `pressure_grid`'s order of each node in VTK's (cell type 29)."""

HEXAHEDRON_EDGES: NDArray[np.int64] = np.array(
    [
        [node_index(*at) for at in edge]
        for a in (0, 2)
        for b in (0, 2)
        for edge in (
            [(0, a, b), (1, a, b), (2, a, b)],
            [(a, 0, b), (a, 1, b), (a, 2, b)],
            [(a, b, 0), (a, b, 1), (a, b, 2)],
        )
    ]
)
"""(12, 3) the hexahedron's curved edges (end, middle, end) in `pressure_grid`'s order."""


@dataclass(frozen=True, eq=False)
class Workspace:
    """Where the tip goes.

    levels : three pressure levels [kPa], ascending.
    tips : (27, 3) tip positions [mm] in the order of `pressure_grid(levels)`.

    Raises
    ------
    ValueError : levels that do not ascend, or tips of another shape.

    Examples
    --------
    >>> import beamopt
    >>> design = beamopt.load_design(str(beamopt.load_scene("sealed-section").target.file))
    >>> workspace: beamopt.Workspace = design.workspace
    >>> workspace.tips[0].round(6).tolist()
    [0.0, 0.0, 100.0]
    """

    levels: tuple[float, float, float]
    tips: FloatArray

    def __repr__(self) -> str:
        low, middle, high = self.levels
        farthest = float(np.linalg.norm(self.tips[:, :2], axis=1).max())
        return (
            f"<Workspace: {NODES} tips at {low:g}, {middle:g}, {high:g} kPa, "
            f"up to {farthest:.4g} mm off the axis>"
        )

    def __post_init__(self) -> None:
        if self.tips.shape != (NODES, 3):
            raise ValueError(f"tips have shape {self.tips.shape}: expected (27, 3)")
        low, middle, high = self.levels
        if not low < middle < high:
            raise ValueError(f"levels = {self.levels}: must ascend")

    @property
    def pressures(self) -> FloatArray:
        """(27, 3) [kPa], matching `tips`."""
        return pressure_grid(self.levels)

    def to_frame(self) -> DataFrame:
        """Columns p1, p2, p3 [kPa], x, y, z [mm], as a data frame (needs pandas)."""
        from beamopt.storage.frames import frame_of

        return frame_of(tips_csv(self.pressures, self.tips))

    @property
    def hexahedron(self) -> FloatArray:
        """(27, 3) nodes of VTK's triquadratic hexahedron (cell type 29) in VTK's order [mm]."""
        return np.asarray(self.tips[HEXAHEDRON_NODES])

    def position(self, pressures: FloatArray) -> FloatArray:
        """Tips (n, 3) [mm] interpolated at pressures (n, 3) [kPa] by the triquadratic hexahedron.

        The shape functions are the Lagrange polynomials through the three levels.
        """
        weights = [_lagrange(np.asarray(self.levels), pressures[:, axis]) for axis in range(3)]
        return np.asarray(
            np.einsum("na,nb,nc,abcx->nx", *weights, self.tips.reshape(3, 3, 3, 3), optimize=True)
        )

    def edge_curves(self, points: int = 13) -> FloatArray:
        """(12, points, 3) the hexahedron's edges as polylines [mm]."""
        weights = _lagrange(np.array([0.0, 0.5, 1.0]), np.linspace(0, 1, points))
        return np.asarray(np.einsum("pa,eax->epx", weights, self.tips[HEXAHEDRON_EDGES]))


def tips_csv(pressures: FloatArray, tips: FloatArray) -> str:
    """The table `p1,p2,p3,x,y,z` [kPa, mm] that targets are read from."""
    return csv_text(",".join(COLUMNS), np.hstack([pressures, tips]).tolist())


def _lagrange(nodes: FloatArray, at: FloatArray) -> FloatArray:
    """(n, 3) the three Lagrange polynomials through `nodes` at the values `at`."""
    columns = []
    for k in range(3):
        a, b = np.delete(nodes, k)
        columns.append((at - a) * (at - b) / ((nodes[k] - a) * (nodes[k] - b)))
    return np.stack(columns, axis=-1)
