"""The polar grid of equal-area elements that a section is made of (paper, Discretization)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray

__all__ = ["Domain", "PolarGrid", "angle_between"]

THINNEST = 1e-6  # of the outer radius; thinner rings lose their rows to rounding


def angle_between(start: float, stop: float) -> float:
    """`stop` − `start` [degree]; exactly 360 where only the rounding of decimals is missing."""
    between = stop - start
    return 360.0 if abs(between - 360.0) < 1e-9 else between


class Domain(NamedTuple):
    """A ring, or a sector of one, as kernels need it [mm, rad]."""

    inner: float
    outer: float
    start: float
    span: float


@dataclass(frozen=True)
class PolarGrid:
    """A ring, or a sector of one, cut into elements of equal area.

    Row i spans the radii `edges[i]`…`edges[i + 1]`, column j the angles
    `start + [j, j + 1]·(stop − start)/angular`. Arrays over elements have the shape
    (radial, angular).

    Parameters
    ----------
    inner_radius, outer_radius : radii of the ring [mm].
    radial, angular : counts of elements.
    start, stop : angles of the sector's ends [degree]; a full ring when they are 360 apart.

    Raises
    ------
    ValueError : radii or angles out of order, or counts that are no whole numbers from 1 on.

    Examples
    --------
    >>> import beamopt
    >>> round(beamopt.PolarGrid(inner_radius=10.0, outer_radius=25.0).area, 1)
    1649.3
    """

    inner_radius: float = 10.0
    outer_radius: float = 25.0
    radial: int = 128
    angular: int = 360
    start: float = 0.0
    stop: float = 360.0

    def __post_init__(self) -> None:
        thinnest = THINNEST * self.outer_radius
        if not 0 <= self.inner_radius <= self.outer_radius - thinnest < np.inf:
            raise ValueError(
                f"inner_radius = {self.inner_radius}: must be at least 0 and below "
                f"outer_radius = {self.outer_radius} by a millionth of it or more"
            )
        counts = (self.radial, self.angular)
        if not all(count == int(count) and count >= 1 for count in counts):
            raise ValueError(f"radial, angular = {counts}: whole numbers from 1 on")
        if not 0 < self.span <= 360:
            raise ValueError(f"stop = {self.stop}: must be 0…360 degrees above {self.start}")

    @property
    def span(self) -> float:
        """Angle from start to stop [degree]; 360 exactly where only rounding is missing."""
        return angle_between(self.start, self.stop)

    @property
    def is_full_ring(self) -> bool:
        """Whether the last column is the first one's neighbour."""
        return self.span == 360

    @property
    def shape(self) -> tuple[int, int]:
        """Rows (radial) and columns (angular)."""
        return self.radial, self.angular

    @cached_property
    def domain(self) -> Domain:
        """Radii [mm] and angles [rad] between which elements are."""
        start, span = float(np.radians(self.start)), float(np.radians(self.span))
        return Domain(float(self.inner_radius), float(self.outer_radius), start, span)

    @cached_property
    def area(self) -> float:
        """Area of the whole ring or sector [mm²]."""
        return float(np.radians(self.span) * (self.outer_radius**2 - self.inner_radius**2) / 2)

    @property
    def element_area(self) -> float:
        """Area ΔA of one element [mm²]."""
        return self.area / (self.radial * self.angular)

    @cached_property
    def edges(self) -> FloatArray:
        """(radial + 1,) radii between the rows [mm], so spaced that rows have equal areas."""
        share = np.arange(self.radial + 1) / self.radial
        squares = self.inner_radius**2 + share * (self.outer_radius**2 - self.inner_radius**2)
        return np.asarray(np.sqrt(squares))

    @cached_property
    def angles(self) -> FloatArray:
        """(angular + 1,) angles between the columns [rad]."""
        columns = np.arange(self.angular + 1)
        return np.asarray(np.radians(self.start + columns * self.span / self.angular))

    @cached_property
    def radial_integrals(self) -> FloatArray:
        """(3, radial): ∫ rⁿ⁺¹ dr over each row for n = 0, 1, 2."""
        a, b = self.edges[:-1], self.edges[1:]
        # b² − a² is the same for every row: without the cancellation of taking differences
        inner, outer = self.inner_radius, self.outer_radius
        squares = (outer - inner) * (outer + inner) / self.radial
        area = np.full(self.radial, squares / 2)
        first = squares / (a + b) * (a * a + a * b + b * b) / 3
        second = squares * (a * a + b * b) / 4
        return np.stack([area, first, second])

    @cached_property
    def angular_integrals(self) -> FloatArray:
        """(angular + 1, 6): ∫ {1, cos, sin, cos², sin², sin·cos} dφ from `start` to each edge."""
        a = self.angles
        double = np.sin(2 * a) / 4
        primitive = np.stack(
            [a, np.sin(a), -np.cos(a), a / 2 + double, a / 2 - double, np.sin(a) ** 2 / 2], axis=1
        )
        return np.asarray(primitive - primitive[0])

    @cached_property
    def centroid_radii(self) -> FloatArray:
        """(radial,) distance of each row's element centroids from the axis [mm]."""
        half = np.radians(self.span) / self.angular / 2
        ratio = self.radial_integrals[1] / self.radial_integrals[0]
        return np.asarray(ratio * np.sinc(half / np.pi))

    @cached_property
    def centroid_directions(self) -> FloatArray:
        """(2, angular): cosine and sine of each column's middle angle."""
        middle = (self.angles[:-1] + self.angles[1:]) / 2
        return np.stack([np.cos(middle), np.sin(middle)])

    @cached_property
    def centroids(self) -> FloatArray:
        """(2, radial, angular): x and y of the element centroids [mm]."""
        return self.centroid_directions[:, None, :] * self.centroid_radii[None, :, None]

    def elements_at(
        self, x: FloatArray, y: FloatArray
    ) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.bool_]]:
        """Row and column of the element under each point [mm], and whether there is one."""
        turned = np.mod(np.degrees(np.arctan2(y, x)) - self.start, 360.0)
        row = np.searchsorted(self.edges, np.hypot(x, y), side="right") - 1
        column = np.floor(turned * self.angular / self.span).astype(np.int64)
        inside = (row >= 0) & (row < self.radial) & (column < self.angular)
        return row, column, inside
