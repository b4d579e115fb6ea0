"""What a design file says a section is: feature points, or drawn chambers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Annotated

from pydantic import Field, model_validator

from beamopt.base.errors import InputError
from beamopt.outline.faults import Fault, FaultKind
from beamopt.section.cross_section import CrossSection
from beamopt.section.drawing import Circle, RingPiece, Shape
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.storage.checked_keys import CheckedKeys, Count, Number, quantity

__all__ = ["DrawnChamber", "Points", "check_drawing", "lost_in_raster"]

Position = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-1e6, le=1e6)]


class Points(CheckedKeys):
    """Voronoi feature points [mm]; type 0 is material, 1…3 a supply.

    Examples
    --------
    >>> import beamopt
    >>> beamopt.Points(x=(15.0, -15.0), y=(0.0, 0.0), type=(1, 0)).build()
    <FeaturePoints: 2, of material and supplies 1, 2, 3: 1, 1, 0, 0>
    """

    x: tuple[Position, ...]
    y: tuple[Position, ...]
    type: tuple[Annotated[int, Field(strict=True, ge=0, le=3)], ...]

    def __repr__(self) -> str:
        return f"<Points: {len(self.x)} feature points>"

    def build(self) -> FeaturePoints:
        """The feature points that sections are made of, and that a judge takes."""
        return FeaturePoints(self.x, self.y, self.type)

    @model_validator(mode="after")
    def _same_length(self) -> Points:
        if not len(self.x) == len(self.y) == len(self.type):
            counts = f"{len(self.x)}, {len(self.y)}, {len(self.type)}"
            raise ValueError(f"x, y, type have {counts} entries; all must have the same")
        return self


class DrawnChamber(CheckedKeys):
    """Either a piece of a ring (r, phi, corner) or a circle (center, radius).

    Examples
    --------
    >>> import beamopt
    >>> beamopt.DrawnChamber(supply=1, center=(17.5, 0.0), radius=4.5).build().supply
    1
    """

    supply: Count = quantity(..., "pressure supply of the chamber", low=1, high=3)
    r: tuple[Position, Position] | None = quantity(None, "inner and outer radius", unit="mm")
    phi: tuple[Position, Position] | None = quantity(None, "first and last angle", unit="degrees")
    corner: Number | None = quantity(
        None, "radius of the rounded corners", unit="mm", low=0, high=1000
    )
    center: tuple[Position, Position] | None = quantity(None, "centre of a circle", unit="mm")
    radius: Number | None = quantity(None, "radius of a circle", unit="mm", low=0, high=1000)

    @model_validator(mode="after")
    def _is_one_shape(self) -> DrawnChamber:
        self.build()
        return self

    def build(self) -> Shape:
        """The shape that the section floor rasterises."""
        given = self.model_fields_set - {"supply"}
        if self.r and self.phi and given <= {"r", "phi", "corner"}:
            return RingPiece(self.supply, self.r, self.phi, self.corner or 0.0)
        if self.center and self.radius and given <= {"center", "radius"}:
            return Circle(self.supply, self.center, self.radius)
        raise ValueError("a chamber has either r and phi (and corner), or center and radius")


def check_drawing(drawing: Sequence[DrawnChamber], grid: PolarGrid) -> None:
    """Refuse chambers that are too thin, or lie outside the ring.

    Raises
    ------
    InputError : the chamber by its number, and what is allowed.
    """
    from beamopt.outline.drawn import least_width, outside, too_thin

    shapes = [chamber.build() for chamber in drawing]
    width = f"at least {least_width(grid):g} mm wide"
    for number in too_thin(shapes, grid):
        raise InputError("", f"drawing[{number}]", None, f"is too thin: must be {width}")
    for number in outside(shapes, grid):
        within = f"within radii {grid.inner_radius:g} and {grid.outer_radius:g} mm"
        sector = "" if grid.is_full_ring else f", {grid.start:g}…{grid.stop:g}°"
        allowed = f"lies outside the section: must have an area {within}{sector}, {width}"
        raise InputError("", f"drawing[{number}]", None, allowed)


def lost_in_raster(
    drawing: Sequence[DrawnChamber], section: CrossSection, faults: Sequence[Fault]
) -> Iterator[Fault]:
    """Drawn chambers too small for the elements that an unsealed section is made of.

    faults : of the section's outline; a chamber that is hidden or lost there is left out.
    """
    nowhere = (FaultKind.HIDDEN, FaultKind.LOST)
    found = {fault.drawn for fault in faults if fault.status in nowhere}
    labels, (x, y) = section.labels, section.grid.centroids
    for number, shape in enumerate(chamber.build() for chamber in drawing):
        if number not in found and not (labels[shape.covers(x, y)] == shape.supply).any():
            yield Fault(FaultKind.LOST, supplies=(shape.supply,), drawn=number)
