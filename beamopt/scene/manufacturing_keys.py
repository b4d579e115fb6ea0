"""What can be made: rules for separate chambers, symmetry and mass, as scenes write them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from beamopt.section.grid import PolarGrid
from beamopt.section.manufacturing import MakingRules
from beamopt.section.symmetry import Symmetry, mirror_symmetry, threefold_symmetry
from beamopt.storage.checked_keys import CheckedKeys, Number, quantity

__all__ = ["Making"]

KILOGRAMS_PER_M3 = 1e-6  # g/mm³

MostChambers = Annotated[int, Field(strict=True, ge=0, le=1000)]


class Making(CheckedKeys):
    """What makes a section easy to make; weighted rules add to the loss that the search looks at.

    A rejected candidate is never selected: with many feature points hardly any random section has
    few chambers, so that weights lead there and a rejection does not.

    Examples
    --------
    >>> import beamopt
    >>> beamopt.Making(chambers=(1, 1, 1)).rules_set
    True
    """

    chambers: tuple[MostChambers, MostChambers, MostChambers] | None = quantity(
        None, "most separate chambers of each supply, as [1, 1, 1]; left out: any number"
    )
    chambers_rule: Literal["reject", "weighted"] = quantity(
        "weighted", "what becomes of a section with more"
    )
    chambers_weight: Number = quantity(
        100.0, "of each chamber too many, if weighted", unit="mm²", low=0, high=1e9
    )
    symmetry: Literal["none", "mirror", "three-fold"] = quantity(
        "none", "about the x axis with supplies 2 and 3 changing places, or by 120° with 1 → 2 → 3"
    )
    symmetry_rule: Literal["repair", "weighted"] = quantity(
        "repair", "every candidate is made symmetric, or what differs is weighed"
    )
    symmetry_weight: Number = quantity(
        1000.0, "of the whole section differing, if weighted", unit="mm²", low=0, high=1e9
    )
    density: Number = quantity(
        1070.0, "of the material, for its mass", unit="kg/m³", low=0, high=30_000
    )
    mass_weight: Number = quantity(
        0.0, "of each gram of the actuator", unit="mm²/g", low=0, high=1e9
    )

    @property
    def rules_set(self) -> bool:
        """Whether there is any rule."""
        return self.chambers is not None or self.symmetry != "none" or self.mass_weight > 0

    def check_fits(self, grid: PolarGrid) -> None:
        """Refuse a symmetry that the grid does not have.

        Raises
        ------
        ValueError : the key, and what it needs.
        """
        if self.symmetry == "none":
            return
        said = f'making.symmetry = "{self.symmetry}": needs'
        if not grid.is_full_ring:
            raise ValueError(f"{said} a full ring, grid.stop 360 degrees above grid.start")
        if self.symmetry == "three-fold" and grid.angular % 3:
            raise ValueError(f"{said} grid.angular = {grid.angular} to be a multiple of 3")
        turns = 2 * grid.start * grid.angular / grid.span
        if self.symmetry == "mirror" and abs(turns - round(turns)) > 1e-6:
            raise ValueError(f"{said} grid.start at the edge or in the middle of a column")

    def images(self, grid: PolarGrid) -> Symmetry | None:
        """The symmetry asked for."""
        if self.symmetry == "none":
            return None
        return mirror_symmetry() if self.symmetry == "mirror" else threefold_symmetry(grid)

    def repair(self, grid: PolarGrid) -> Symmetry | None:
        """The symmetry that every candidate is to be given; None where it has not to have any."""
        return self.images(grid) if self.symmetry_rule == "repair" else None

    def rules(self, grid: PolarGrid, length: float) -> MakingRules:
        """The rules for sections on `grid` of an actuator of this length [mm]."""
        weighs = self.symmetry_rule == "weighted"
        return MakingRules(
            chambers=self.chambers,
            rejects=self.chambers_rule == "reject",
            chamber_weight=self.chambers_weight,
            symmetry=self.images(grid) if weighs else None,
            symmetry_weight=self.symmetry_weight,
            grams=self.density * KILOGRAMS_PER_M3 * length,
            mass_weight=self.mass_weight,
        )
