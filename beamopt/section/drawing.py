"""Sections drawn by hand: chambers as pieces of a ring with rounded corners, and circles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray, LabelArray
from beamopt.section.feature_points import SUPPLIES
from beamopt.section.grid import PolarGrid, angle_between

__all__ = ["Circle", "RingPiece", "Shape", "rasterise"]

ON_THE_EDGE = 1e-9
"""Points this near to a shape's edge [mm; rad] are inside: centroids often lie right on a side."""

FIT = 1e-9  # of the outer radius; by so much corners may be too large to fit


@dataclass(frozen=True, slots=True)
class RingPiece:
    """A chamber between two radii and two angles, its four corners rounded.

    Parameters
    ----------
    supply : 1, 2 or 3.
    r : inner and outer radius [mm].
    phi : first and last angle, counter-clockwise [degree].
    corner : radius of the corners [mm]; 0 for sharp ones.

    Raises
    ------
    ValueError : another supply, radii or angles out of order, or corners that do not fit.
    """

    supply: int
    r: tuple[float, float]
    phi: tuple[float, float]
    corner: float = 0.0

    def __post_init__(self) -> None:
        (inner, outer), (first, last), c = self.r, self.phi, self.corner
        _check_supply(self.supply)
        if not 0 <= inner < outer < np.inf:
            raise ValueError(f"r = [{inner:g}, {outer:g}]: two radii in mm, the smaller one first")
        between = angle_between(first, last)
        if not 0 < between <= 360:
            raise ValueError(
                f"phi = [{first:g}, {last:g}]: two angles in degrees, the second up to 360 above"
            )
        half = np.radians(between) / 2
        room = (inner + c) * np.sin(min(half, np.pi / 2))
        if between == 360 or c == 0:
            room = np.inf  # no corners, or sharp ones
        if not 0 <= c <= min((outer - inner) / 2, room) + FIT * outer:
            most = (outer - inner) / 2
            if half < np.pi / 2 and np.sin(half) < 1:
                most = min(most, inner * np.sin(half) / (1 - np.sin(half)))
            raise ValueError(f"corner = {c:g}: must be 0…{most:.4g} mm to fit this piece")

    def covers(self, x: FloatArray, y: FloatArray) -> NDArray[np.bool_]:
        """Whether points [mm] lie inside."""
        (inner, outer), (first, last), c = self.r, self.phi, self.corner
        radius = np.hypot(x, y)
        inside = (radius >= inner - ON_THE_EDGE) & (radius <= outer + ON_THE_EDGE)
        between = angle_between(first, last)
        if between == 360:
            return np.asarray(inside)
        span = np.radians(between)
        turned = np.arctan2(y, x) - np.radians(first) + ON_THE_EDGE
        after = np.mod(turned, 2 * np.pi) - ON_THE_EDGE
        inside &= after <= span + ON_THE_EDGE
        for angle in (after, span - after):  # from the first side, from the last one
            for middle, is_outer in ((outer - c, True), (inner + c, False)):
                inside &= ~_cut(radius, angle, middle, c, is_outer)
        return np.asarray(inside)


def _cut(
    radius: FloatArray, angle: FloatArray, middle: float, corner: float, is_outer: bool
) -> NDArray[np.bool_]:
    """Points that rounding one corner cuts off.

    The corner's circle touches the side, at the distance `touch` from the axis, and the arc; its
    centre is `middle` from the axis and `corner` from the side. `angle` is measured from the side.
    """
    if corner == 0:
        return np.zeros(radius.shape, dtype=np.bool_)
    touch = np.sqrt(max(middle**2 - corner**2, 0.0))
    along, across = radius * np.cos(angle), radius * np.sin(angle)
    beyond = along > touch if is_outer else along < touch
    within = (angle < np.arctan2(corner, touch)) & beyond
    outside_circle = np.hypot(along - touch, across - corner) > corner + ON_THE_EDGE
    return np.asarray(within & outside_circle)


@dataclass(frozen=True, slots=True)
class Circle:
    """A round chamber: supply 1…3, centre and radius [mm].

    Raises
    ------
    ValueError : another supply, a radius that is not positive, a centre that is not finite.
    """

    supply: int
    center: tuple[float, float]
    radius: float

    def __post_init__(self) -> None:
        _check_supply(self.supply)
        if not (0 < self.radius < np.inf and np.isfinite(self.center).all()):
            raise ValueError(f"radius = {self.radius:g}: must be above 0 mm, center finite")

    def covers(self, x: FloatArray, y: FloatArray) -> NDArray[np.bool_]:
        """Whether points [mm] lie inside."""
        cx, cy = self.center
        return np.asarray(np.hypot(x - cx, y - cy) <= self.radius + ON_THE_EDGE)


def _check_supply(supply: int) -> None:
    if supply not in SUPPLIES:
        raise ValueError(f"supply = {supply}: must be 1, 2 or 3")


Shape = RingPiece | Circle


def rasterise(grid: PolarGrid, shapes: Sequence[Shape]) -> LabelArray:
    """(radial, angular) types of the elements, by centroid; a later shape covers an earlier."""
    labels = np.zeros(grid.shape, dtype=np.uint8)
    x, y = grid.centroids
    for shape in shapes:
        labels[shape.covers(x, y)] = shape.supply
    return labels
