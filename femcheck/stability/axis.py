"""One panel of the map: a row of specimens at the same pressures."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

from femcheck.stability.specimen import Specimen

__all__ = ["Axis", "Column"]


@dataclass(frozen=True, slots=True)
class Column:
    """One specimen of a panel.

    label : on the panel's axis. exact : its limit pressure in closed form [kPa]; None without.
    compare : whether its path is also followed on a finer mesh.
    """

    label: str
    specimen: Specimen
    exact: float | None = None
    compare: bool = False


@dataclass(frozen=True, slots=True)
class Axis:
    """A panel.

    name : in files and on the command line. title, label : in figures; what the columns differ in.
    told : what the specimens are, in a sentence.
    pressures : ascending [kPa].
    ordered : whether lines from one column to the next mean something.
    """

    name: str
    title: str
    label: str
    told: str
    columns: tuple[Column, ...]
    pressures: tuple[float, ...]
    ordered: bool = True

    @property
    def count(self) -> int:
        """How many cells it has."""
        return len(self.columns) * len(self.pressures)

    def digest(self, column: int) -> str:
        """Tells the question of a column from another one's: specimen and pressures."""
        said = f"{self.columns[column].specimen!r} {self.pressures!r}"
        return hashlib.blake2b(said.encode(), digest_size=8).hexdigest()
