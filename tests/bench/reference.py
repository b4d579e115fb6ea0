"""One evaluation the straightforward way, with numpy and scipy: what the kernels are held against.

A k-d tree finds the nearest feature point of every element, binary dilations make the walls,
`np.bincount` sums the moments, scipy triangulates.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import binary_dilation, generate_binary_structure
from scipy.spatial import Delaunay, cKDTree

from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid

CROSS = generate_binary_structure(2, 1)


class Reference:
    """An evaluator for one grid; arrays that only depend on the grid are made once."""

    def __init__(self, grid: PolarGrid, wall_elements: int = 4) -> None:
        self.grid, self.steps = grid, wall_elements // 2
        self.places = grid.centroids.reshape(2, -1).T.copy()
        angular = np.diff(grid.angular_integrals, axis=0)
        radial = grid.radial_integrals[[0, 1, 1, 2, 2, 2]]
        self.weights = np.einsum("mi,jm->mij", radial, angular).reshape(6, -1)

    def labels(self, points: FeaturePoints) -> np.ndarray:
        _, nearest = cKDTree(np.column_stack([points.x, points.y])).query(self.places)
        labels = points.type[nearest].reshape(self.grid.shape)
        pad = ((0, 0), (self.steps, self.steps))
        around = np.pad(labels, pad, mode="wrap" if self.grid.is_full_ring else "constant")
        spread = np.stack(
            [binary_dilation(around == k, CROSS, iterations=self.steps) for k in (1, 2, 3)]
        )
        spread = spread[:, :, self.steps : around.shape[1] - self.steps]
        return np.where(spread.sum(axis=0) > 1, 0, labels).astype(np.uint8)

    def raw_moments(self, labels: np.ndarray) -> np.ndarray:
        flat = labels.ravel()
        return np.stack([np.bincount(flat, w, minlength=4) for w in self.weights], axis=1)

    def ratio(self, points: FeaturePoints) -> float:
        triangles = Delaunay(np.column_stack([points.x, points.y])).simplices
        edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        ends = points.type[np.unique(edges, axis=0)]
        different = int((ends[:, 0] != ends[:, 1]).sum())
        return different / max(len(ends) - different, 1)

    def tips(self, raw: np.ndarray, pressures: np.ndarray) -> np.ndarray:
        area, cx, cy = raw[0, 0], *(raw[0, 1:3] / raw[0, 0])
        i11, i22 = raw[0, 4] - area * cy**2, raw[0, 3] - area * cx**2
        i12 = -(raw[0, 5] - area * cx * cy)
        levers = raw[1:, 1:3] - raw[1:, :1] * (cx, cy)
        moments = pressures @ np.column_stack([levers[:, 1], -levers[:, 0]])
        kappa = np.linalg.solve(300.0 * np.array([[i11, i12], [i12, i22]]), moments.T).T
        stretch = 1 + pressures @ raw[1:, 0] / (300.0 * area)
        theta = np.maximum(np.linalg.norm(kappa, axis=1) * 100.0, 1e-9)
        out = 1e4 * (1 - np.cos(theta)) / theta**2 * stretch
        return np.column_stack(
            [out * kappa[:, 1], -out * kappa[:, 0], 100 * stretch * np.sin(theta) / theta]
        )
