"""What can be wrong with an outline, where, and how much it matters."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum

__all__ = ["Fault", "FaultKind", "Severity"]


class Severity(Enum):
    """How much a fault matters."""

    NOTICE = "worth knowing"
    VIOLATION = "breaks a rule, but a solid can be made of it"
    FATAL = "no solid can be made of it"


class FaultKind(Enum):
    """What is wrong; the values are meant for people."""

    SKIN = "skin too thin"
    WALL = "wall between two supplies too thin"
    NECK = "material between two parts of a supply too thin"
    ISLAND = "material that hangs on to nothing"
    NO_CHAMBER = "a supply has no chamber"
    PIECES = "material in several pieces"
    NO_MATERIAL = "no material"
    UNSEALED = "a chamber is open"
    INVALID = "a polygon touches itself or another one"

    @property
    def severity(self) -> Severity:
        """Notice, violation or fatal."""
        if self in (FaultKind.ISLAND, FaultKind.NO_CHAMBER):
            return Severity.NOTICE
        if self in (FaultKind.SKIN, FaultKind.WALL, FaultKind.NECK):
            return Severity.VIOLATION
        return Severity.FATAL


@dataclass(frozen=True, slots=True)
class Fault:
    """One thing that is wrong with an outline; `str` of it is one sentence.

    Parameters
    ----------
    status : what is wrong.
    value : thickness [mm] of a skin, wall or neck and of what is unsealed or invalid; area [mm²]
        of an island; pieces of material; 0 for what is missing.
    place : where [mm], or None for the section as a whole.
    supplies : the supplies that it concerns, ascending.
    asked : the thickness that the rules ask for [mm], or None.
    """

    status: FaultKind
    value: float = 0.0
    place: tuple[float, float] | None = None
    supplies: tuple[int, ...] = ()
    asked: float | None = None

    @property
    def severity(self) -> Severity:
        """Notice, violation or fatal."""
        return self.status.severity

    def scaled(self, by: float) -> Fault:
        """The same in a section that is `by` times as large."""
        power = {FaultKind.ISLAND: 2, FaultKind.PIECES: 0}.get(self.status, 1)
        return replace(
            self,
            value=by**power * self.value,
            place=self.place and (by * self.place[0], by * self.place[1]),
            asked=None if self.asked is None else by * self.asked,
        )

    def __str__(self) -> str:
        where = ""
        if self.place:
            x, y = (round(value, 1) + 0.0 for value in self.place)  # no "−0.0"
            where = f" at ({x:.1f}, {y:.1f}) mm"
        asked = f", asked {self.asked:g}" if self.asked is not None else ""
        return f"{self._subject()}{where.replace('-', '−')}{asked}"

    def _subject(self) -> str:
        numbers = " and ".join(str(supply) for supply in self.supplies)
        many = "supplies" if len(self.supplies) > 1 else "supply"
        thickness = f"{self.value:.3f} mm"
        match self.status:
            case FaultKind.SKIN:
                return f"skin over {many} {numbers} is {thickness}"
            case FaultKind.WALL:
                return f"wall between {many} {numbers} is {thickness}"
            case FaultKind.NECK:
                return f"material between two parts of {many} {numbers} is {thickness}"
            case FaultKind.ISLAND:
                return f"an island of {self.value:.2f} mm² hangs in a chamber of {many} {numbers}"
            case FaultKind.NO_CHAMBER:
                return f"{many} {numbers} has no chamber"
            case FaultKind.PIECES:
                return f"material in {self.value:.0f} separate pieces, one of them"
            case FaultKind.NO_MATERIAL:
                return "no material"
            case FaultKind.UNSEALED if len(self.supplies) > 1:
                return f"chambers of {many} {numbers} open into each other"
            case FaultKind.UNSEALED:
                return f"a chamber of {many} {numbers} opens to a surface"
            case FaultKind.INVALID:
                return f"polygons of {many} {numbers} touch" if numbers else "polygons touch"
