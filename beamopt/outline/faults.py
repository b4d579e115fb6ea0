"""What can be wrong with an outline, where, and how much it matters."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import Enum

__all__ = ["Fault", "FaultKind", "Severity", "summaries", "worst_first"]


class Severity(Enum):
    """How much a fault matters.

    Examples
    --------
    >>> import beamopt
    >>> [severity.name for severity in beamopt.Severity]
    ['NOTICE', 'VIOLATION', 'FATAL']
    """

    NOTICE = "worth knowing"
    VIOLATION = "breaks a rule, but a solid can be made of it"
    FATAL = "no solid can be made of it"


class FaultKind(Enum):
    """What is wrong; the values are meant for people.

    Examples
    --------
    >>> import beamopt
    >>> beamopt.FaultKind.ISLAND.severity.name
    'NOTICE'
    """

    SKIN = "skin too thin"
    WALL = "wall between two supplies too thin"
    NECK = "material between two parts of a supply too thin"
    ISLAND = "material that hangs on to nothing"
    NO_CHAMBER = "a supply has no chamber"
    PIECES = "material in several pieces"
    NO_MATERIAL = "no material"
    UNSEALED = "a chamber is open"
    INVALID = "a polygon touches itself or another one"
    CUT = "a drawn chamber is cut by a surface"
    HIDDEN = "a drawn chamber is hidden under later ones"
    LOST = "a drawn chamber is no part of the section"
    WALL_ELEMENTS = "walls of elements have no effect"

    @property
    def severity(self) -> Severity:
        """Notice, violation or fatal."""
        if self in NOTICES:
            return Severity.NOTICE
        if self in (FaultKind.SKIN, FaultKind.WALL, FaultKind.NECK):
            return Severity.VIOLATION
        return Severity.FATAL


NOTICES = {
    FaultKind.ISLAND,
    FaultKind.NO_CHAMBER,
    FaultKind.CUT,
    FaultKind.HIDDEN,
    FaultKind.LOST,
    FaultKind.WALL_ELEMENTS,
}


@dataclass(frozen=True, slots=True)
class Fault:
    """One thing that is wrong with a section; `str` of it is one sentence.

    Parameters
    ----------
    status : what is wrong.
    value : thickness [mm] of a skin, wall or neck and of what is unsealed or invalid; area [mm²]
        of an island, of a drawn chamber, or of what of it lies outside; pieces of material;
        elements of a wall; 0 for what is missing.
    place : where [mm], or None for the section as a whole.
    supplies : the supplies that it concerns, ascending.
    asked : the thickness that the rules ask for [mm], or None.
    drawn : number of the drawn chamber in the design's `drawing`, or None.

    Examples
    --------
    >>> import beamopt
    >>> print(beamopt.Fault(beamopt.FaultKind.SKIN, 0.4, (12.0, 0.0), (1,), asked=1.0))
    skin over supply 1 is 0.400 mm at (12.0, 0.0) mm, asked 1
    """

    status: FaultKind
    value: float = 0.0
    place: tuple[float, float] | None = None
    supplies: tuple[int, ...] = ()
    asked: float | None = None
    drawn: int | None = None

    @property
    def severity(self) -> Severity:
        """Notice, violation or fatal."""
        return self.status.severity

    def scaled(self, by: float) -> Fault:
        """The same in a section that is `by` times as large."""
        areas = (FaultKind.ISLAND, FaultKind.CUT, FaultKind.HIDDEN, FaultKind.LOST)
        counts = (FaultKind.PIECES, FaultKind.WALL_ELEMENTS)
        power = 2 if self.status in areas else 0 if self.status in counts else 1
        return replace(
            self,
            value=by**power * self.value,
            place=self.place and (by * self.place[0], by * self.place[1]),
            asked=None if self.asked is None else by * self.asked,
        )

    def __repr__(self) -> str:
        return f"<Fault {self.status.name}: {self}>"

    def __str__(self) -> str:
        where = ""
        if self.place:
            far = max(map(abs, self.place))
            digits = max(1, 1 - math.floor(math.log10(far))) if far > 0 else 1
            x, y = (round(value, digits) + 0.0 for value in self.place)  # no "−0.0"
            where = f" at ({x:.{digits}f}, {y:.{digits}f}) mm"
        asked = f", asked {self.asked:g}" if self.asked is not None else ""
        return f"{self._subject()}{where.replace('-', '−')}{asked}"

    def _subject(self) -> str:
        numbers = " and ".join(str(supply) for supply in self.supplies)
        many = "supplies" if len(self.supplies) > 1 else "supply"
        thickness = _millimetres(self.value)
        chamber = "a drawn chamber" if self.drawn is None else f"drawing[{self.drawn}]"
        drawn = f"{chamber} ({many} {numbers})"
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
            case FaultKind.CUT:
                outside = f"{self.value:.3g} mm² of it lie outside, cut"
                return f"{drawn} is cut by a surface: {outside}"
            case FaultKind.HIDDEN:
                return f"{drawn} is hidden under later chambers"
            case FaultKind.LOST:
                return f"{drawn} is no part of the section"
            case FaultKind.WALL_ELEMENTS:
                said = "has no effect: a sealed section has its walls in mm (seal.wall)"
                return f"wall_elements = {self.value:.0f} {said}"


def _millimetres(length: float) -> str:
    return f"{length:.3f} mm" if length >= 0.01 else f"{length:.3g} mm"


def worst_first(faults: Iterable[Fault]) -> tuple[Fault, ...]:
    """Fatal ones, then violations, then notices; otherwise as found."""
    rank = {severity: k for k, severity in enumerate(reversed(Severity))}
    return tuple(sorted(faults, key=lambda fault: rank[fault.severity]))


def summaries(faults: Iterable[Fault]) -> tuple[str, ...]:
    """One line for each drawn chamber; of other kinds the only fault, or the first and how many."""
    kinds: dict[tuple[FaultKind, int | None], list[Fault]] = {}
    for fault in faults:
        kinds.setdefault((fault.status, fault.drawn), []).append(fault)
    return tuple(
        f"{kind.value} ({len(found)} places, first: {found[0]})"
        if len(found) > 1
        else str(found[0])
        for (kind, _), found in kinds.items()
    )
