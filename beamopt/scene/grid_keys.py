"""Keys that designs and scenes share: the grid, walls in elements, pressure levels."""

from __future__ import annotations

from functools import lru_cache
from typing import Annotated, Any

from pydantic import AfterValidator, Field, model_validator

from beamopt.section.grid import PolarGrid
from beamopt.storage.checked_keys import CheckedKeys, Count, Number, quantity

__all__ = ["Grid", "Levels", "WallElements"]

MOST_ELEMENTS = 4_000_000

Pressure = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0, le=2000)]


class Grid(CheckedKeys):
    """The polar grid of equal-area elements.

    Examples
    --------
    >>> import beamopt
    >>> beamopt.Grid(radial=64).build().shape
    (64, 360)
    """

    inner_radius: Number = quantity(10.0, "inner radius of the ring", unit="mm", low=0, high=1000)
    outer_radius: Number = quantity(25.0, "outer radius of the ring", unit="mm", low=0.5, high=1000)
    radial: Count = quantity(128, "elements along the radius", low=4, high=4096)
    angular: Count = quantity(360, "elements around", low=8, high=16384)
    start: Number = quantity(
        0.0, "angle at which a sector starts", unit="degrees", low=-360, high=360
    )
    stop: Number = quantity(
        360.0, "angle at which it ends; 360 more is a ring", unit="degrees", low=-360, high=720
    )

    @model_validator(mode="after")
    def _is_a_ring(self) -> Grid:
        if self.radial * self.angular > MOST_ELEMENTS:
            raise ValueError(f"radial × angular may be at most {MOST_ELEMENTS:,} elements")
        self.build()
        return self

    def build(self) -> PolarGrid:
        """The grid that the section floor works on."""
        return _polar_grid(**self.model_dump())


@lru_cache(maxsize=16)
def _polar_grid(**values: Any) -> PolarGrid:
    """One grid for equal values: its centroids and integrals are computed once."""
    return PolarGrid(**values)


def _ascending(levels: tuple[float, float, float]) -> tuple[float, float, float]:
    if not levels[0] < levels[1] < levels[2]:
        raise ValueError("three pressures in kPa, ascending")
    return levels


Levels = Annotated[tuple[Pressure, Pressure, Pressure], AfterValidator(_ascending)]
"""The three levels [kPa] that each supply takes in the workspace's 27 combinations."""


def _even(count: int) -> int:
    if count % 2:
        raise ValueError("an even number: half of a wall lies on each side of a boundary")
    return count


WallElements = Annotated[int, Field(strict=True), AfterValidator(_even)]
"""Elements of a wall between chambers of different supplies."""
