"""What keeps a section sealed, as scenes and designs write it."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import model_validator

from beamopt.section.grid import PolarGrid
from beamopt.section.seal import SealRules
from beamopt.storage.checked_keys import CheckedKeys, Number, quantity

__all__ = ["Seal"]

WITH_SKIN = ("wall", "rounding", "smallest_chamber")
ALWAYS_WRITTEN = ("skin", "wall", "islands")


class Seal(CheckedKeys):
    """What makes a section one that can be cast and holds air; with all 0 it is the paper's.

    A wall is kept between chambers of different supplies; gaps in one supply's chambers that are
    narrower become part of them.

    Examples
    --------
    >>> import beamopt
    >>> beamopt.Seal(skin=1.0, wall=0.8).rules.sealed
    True
    """

    skin: Number = quantity(
        0.0, "least material on the ring's surfaces; 0: unsealed", unit="mm", low=0, high=100
    )
    wall: Number = quantity(
        0.0, "least material between chambers; needs skin", unit="mm", low=0, high=100
    )
    rounding: Number = quantity(
        0.0, "radius of the chambers' corners; needs skin", unit="mm", low=0, high=100
    )
    smallest_chamber: Number = quantity(
        0.0, "smaller chambers are filled; needs skin", unit="mm²", low=0, high=1e6
    )
    islands: Literal["keep", "remove"] = quantity("keep", "islands of material inside a chamber")

    @model_validator(mode="after")
    def _walls_need_a_skin(self) -> Seal:
        for key in WITH_SKIN:
            value = getattr(self, key)
            if value > 0 and self.skin == 0:
                raise ValueError(f"{key} = {value:g}: goes with a skin above 0; else it must be 0")
        return self

    def written(self) -> dict[str, Any]:
        """The keys of a design file: those that it always has, and the others where they matter."""
        data = self.model_dump()
        return {key: value for key, value in data.items() if value or key in ALWAYS_WRITTEN}

    @property
    def rules(self) -> SealRules:
        """The rules that the section floor seals by."""
        return SealRules(
            self.skin, self.wall, self.rounding, self.smallest_chamber, self.islands == "remove"
        )

    def sealed_by(self, skin: float) -> Seal:
        """These rules with a skin [mm], and what goes with it where nothing is asked for yet.

        Walls of 0.9 and corners of 0.5 of the skin; chambers below 3 mm² are filled, islands of
        material removed.
        """
        return Seal(
            skin=skin,
            wall=self.wall or 0.9 * skin,
            rounding=self.rounding or 0.5 * skin,
            smallest_chamber=self.smallest_chamber or 3.0,
            islands="remove",
        )

    def check_fits(self, grid: PolarGrid) -> None:
        """Refuse a skin that leaves nothing of the ring.

        Raises
        ------
        ValueError : the skin, and how thick it may be.
        """
        sides = 2 if grid.inner_radius > 0 else 1
        most = (grid.outer_radius - grid.inner_radius) / sides
        if self.skin >= most:
            raise ValueError(
                f"seal.skin = {self.skin:g}: must be below {most:g} mm to leave room for chambers"
            )
