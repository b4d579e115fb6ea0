"""What the chambers of a ring section can have: areas, first and second moments, all together."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.section.grid import PolarGrid
from beamopt.section.moments import Moments

__all__ = ["NUMBERS", "RingMoments", "ring_response"]

NUMBERS = 12
"""Numbers of a partition that its response depends on; see `RingMoments`."""

RADIAL, ANGULAR = 64, 180
"""Elements that are enough: bounds were up to 0.05 % above those on 128 × 360, in a third of the
time. (Fewer elements make M smaller.)"""


@dataclass(frozen=True, eq=False)
class RingMoments:
    """The convex set M of what four types can share out of a ring's area.

    A point of M has `NUMBERS` entries, in units of the outer radius: area and first moments
    ∫ {1, x, y} dA of supply 1's chambers, then of 2's and of 3's, and last ∫ {x², y², xy} dA of all
    chambers together. What is not chamber is material. Over all measurable partitions this set is
    convex and closed (Lyapunov; Dvoretzky, Wald and Wolfowitz), and it is known by its support
    function: to go as far as possible along a direction d, every place takes the type with the
    highest score there,

        h(d) = max_(m ∈ M) d · m = ∫ max(0, max_i [d_i · (1, x, y) + d_q · (x², y², xy)]) dA

    The integral is summed over the elements of a grid: exact for partitions of its elements.

    whole : (6,) integrals of {1, x, y, x², y², xy} over all of the ring [1, over radius powers].
    elements : (n, 6) the same of every element that may be chamber.
    radius : the unit of length [mm].
    shape : radial rows and sectors of those elements; of a finer grid M is a little too small.
    """

    whole: FloatArray
    elements: FloatArray
    radius: float
    shape: tuple[int, int]

    @classmethod
    def of(
        cls, grid: PolarGrid, skin: float = 0.0, radial: int = RADIAL, angular: int = ANGULAR
    ) -> RingMoments:
        """The set of a grid, on at most `radial` × `angular` elements.

        skin : material only, at both surfaces [mm]; rows that lie partly in it may be chamber, so
            that it takes nothing from what a section of this grid can have. (A sector's ends may be
            chamber, too.)
        """
        free = (grid.edges[1:] > grid.inner_radius + skin) & (
            grid.edges[:-1] < grid.outer_radius - skin
        )
        rows = np.flatnonzero(free)
        inner, outer = float(grid.edges[rows[0]]), float(grid.edges[rows[-1] + 1])
        counts = min(len(rows), radial), min(grid.angular, angular)
        inside = PolarGrid(inner, outer, *counts, grid.start, grid.stop)
        unit = grid.outer_radius ** -np.array([2.0, 3.0, 3.0, 4.0, 4.0, 4.0])
        whole = _element_moments(grid).sum(axis=0) * unit
        return cls(whole, _element_moments(inside) * unit, grid.outer_radius, counts)

    def farthest(self, direction: FloatArray) -> tuple[float, FloatArray]:
        """h(d) and the point (12,) of M where it is attained, for a direction (12,)."""
        types = self.best_types(direction)
        point = self.point(types)
        return float(direction @ point), point

    def best_types(self, direction: FloatArray) -> IndexArray:
        """(n,) the type of each element, 0 material, 1…3 supply, in the farthest partition."""
        scores = np.zeros((len(self.elements), 4))
        firsts = direction[:9].reshape(3, 3).T
        scores[:, 1:] = self.elements[:, :3] @ firsts
        scores[:, 1:] += (self.elements[:, 3:] @ direction[9:])[:, None]
        return np.asarray(scores.argmax(axis=1))

    def point(self, types: IndexArray) -> FloatArray:
        """(12,) numbers of the partition with these types (n,) of the elements."""
        sums = (types == np.arange(1, 4)[:, None]).astype(np.float64) @ self.elements
        return np.concatenate([sums[:, :3].ravel(), sums[:, 3:].sum(axis=0)])

    def point_of(self, moments: Moments) -> FloatArray:
        """(12,) numbers of a section's moments."""
        unit = self.radius ** -np.array([2.0, 3.0, 3.0, 4.0, 4.0, 4.0])
        chambers = moments.raw[1:] * unit
        return np.concatenate([chambers[:, :3].ravel(), chambers[:, 3:].sum(axis=0)])

    @cached_property
    def reach(self) -> FloatArray:
        """(12,) width of M along each of its numbers."""
        axes = np.eye(NUMBERS)
        return np.array([self.farthest(axis)[0] + self.farthest(-axis)[0] for axis in axes])


def _element_moments(grid: PolarGrid) -> FloatArray:
    """(n, 6) integrals of {1, x, y, x², y², xy} over every element, rows first."""
    radial = grid.radial_integrals[[0, 1, 1, 2, 2, 2]]
    angular = np.diff(grid.angular_integrals, axis=0)
    return np.asarray(np.einsum("ki,jk->ijk", radial, angular).reshape(-1, 6))


def ring_response(
    ring: RingMoments, point: FloatArray, youngs_modulus: float
) -> tuple[FloatArray, FloatArray]:
    """The response matrix of a point of M, and its derivatives by the point's numbers.

    ε_i = A_i/(E A) and κ_i = (E I)⁻¹ A_i (r_i × e3), as `linear_response` has them, with
    A, c, I of what is left as material: A = A_ring − Σ A_k, A c = S = S_ring − Σ S_k,
    I = I_ring − Q − S Sᵀ/A, and A_i r_i = S_i − A_i S/A.

    Returns
    -------
    B (3, 3) [1/kPa; 1/(mm·kPa)] and ∂B/∂m (12, 3, 3).
    """
    moves = np.eye(NUMBERS)
    areas, firsts = point[:9].reshape(3, 3)[:, 0], point[:9].reshape(3, 3)[:, 1:]
    d_areas, d_firsts = (
        moves[:, :9].reshape(-1, 3, 3)[..., 0],
        moves[:, :9].reshape(-1, 3, 3)[..., 1:],
    )
    area, d_area = ring.whole[0] - areas.sum(), -d_areas.sum(axis=1)
    first, d_first = ring.whole[1:3] - firsts.sum(axis=0), -d_firsts.sum(axis=1)
    second = _tensor(ring.whole[3:] - point[9:]) - np.outer(first, first) / area
    d_second = -_tensor(moves[:, 9:]) - _twice(d_first, first) / area
    d_second += np.outer(first, first) * (d_area / area**2)[:, None, None]
    arms = firsts - np.outer(areas, first) / area
    d_arms = d_firsts - d_areas[..., None] * first / area
    d_arms -= areas[:, None] * (d_first / area - (d_area / area**2)[:, None] * first)[:, None, :]
    stiffness, d_stiffness = _stiffness(second), _stiffness(d_second)
    bend = np.linalg.solve(stiffness, _turned(arms).T)
    d_bend = np.linalg.solve(stiffness, _turned(d_arms).swapaxes(1, 2) - d_stiffness @ bend)
    stretch, d_stretch = areas / area, d_areas / area - areas * (d_area / area**2)[:, None]
    unit = np.array([1.0, 1 / ring.radius, 1 / ring.radius])[:, None] / youngs_modulus
    return (
        np.vstack([stretch, bend]) * unit,
        np.concatenate([d_stretch[:, None, :], d_bend], axis=1) * unit,
    )


def _tensor(sums: FloatArray) -> FloatArray:
    """∫ (x, y)(x, y)ᵀ dA (…, 2, 2) of ∫ {x², y², xy} dA (…, 3)."""
    xx, yy, xy = np.moveaxis(sums, -1, 0)
    return np.stack([np.stack([xx, xy], -1), np.stack([xy, yy], -1)], -2)


def _stiffness(tensor: FloatArray) -> FloatArray:
    """From ∫ (x, y)(x, y)ᵀ dA to what takes curvatures about x and y to moments."""
    rotation = np.array([[0.0, 1.0], [-1.0, 0.0]])
    return np.asarray(rotation @ tensor @ rotation.T)


def _turned(arms: FloatArray) -> FloatArray:
    """(x, y) × e3 = (y, −x) of vectors (…, 2)."""
    return np.stack([arms[..., 1], -arms[..., 0]], axis=-1)


def _twice(moves: FloatArray, first: FloatArray) -> FloatArray:
    """dS Sᵀ + S dSᵀ of dS (n, 2) and S (2,)."""
    one = moves[:, :, None] * first
    return np.asarray(one + one.swapaxes(1, 2))
