"""The rules of a section that can be built: skins, least walls, rounded corners."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["UNSEALED", "SealRules"]


@dataclass(frozen=True, slots=True)
class SealRules:
    """What a section must keep to hold air and to be cast.

    Parameters
    ----------
    skin : least material between a chamber and the ring's surfaces (and a sector's ends) [mm];
        0 is the paper's mode: an unsealed section, in which chambers may touch the surfaces.
    wall : least material between two chambers, of different supplies or of one [mm].
    rounding : radius that the chambers' corners are rounded with [mm].
    smallest_chamber : area below which a chamber is filled [mm²].
    remove_islands : whether material that hangs on to nothing becomes part of its chamber.

    Raises
    ------
    ValueError : a length or area that is negative or not finite.

    Examples
    --------
    >>> import beamopt
    >>> beamopt.SealRules(skin=1.0).sealed
    True
    """

    skin: float = 0.0
    wall: float = 0.0
    rounding: float = 0.0
    smallest_chamber: float = 0.0
    remove_islands: bool = False

    def __post_init__(self) -> None:
        for name in ("skin", "wall", "rounding", "smallest_chamber"):
            value = getattr(self, name)
            if not 0 <= value < float("inf"):
                raise ValueError(f"{name} = {value}: must be at least 0")

    @property
    def sealed(self) -> bool:
        """Whether chambers are kept from the surfaces."""
        return self.skin > 0


UNSEALED = SealRules()
