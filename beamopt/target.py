"""Targets: the workspace that a section is searched for."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from beamopt.arrays import FloatArray
from beamopt.errors import InputError
from beamopt.files import csv_text
from beamopt.model import read_text
from beamopt.section.cross_section import CrossSection
from beamopt.workspace import NODES, Workspace, node_index, pressure_grid

__all__ = ["BaseFrame", "Target", "oddities", "read_target", "tips_csv"]

COLUMNS = ("p1", "p2", "p3", "x", "y", "z")
SAME_PRESSURE = 1e-6  # kPa
FARTHEST = 1e6  # mm, kPa; beyond any actuator


@dataclass(frozen=True, eq=False)
class Target:
    """A target workspace, the section it was made from if there is one, and what is odd about it.

    warnings : sentences for people.
    """

    workspace: Workspace
    section: CrossSection | None = None
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class BaseFrame:
    """Where the actuator's base stands in the frame of a target file.

    origin : the base's material centroid [mm].
    x, z : directions of the section's x axis and of the undeformed actuator; made unit vectors.

    Raises
    ------
    ValueError : a zero vector, or x and z not perpendicular.
    """

    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    x: tuple[float, float, float] = (1.0, 0.0, 0.0)
    z: tuple[float, float, float] = (0.0, 0.0, 1.0)

    def __post_init__(self) -> None:
        lengths = np.linalg.norm([self.x, self.z], axis=1)
        if not (lengths > 0).all():
            raise ValueError("base_x and base_z must not be zero vectors")
        if abs(np.dot(self.x, self.z)) > 1e-6 * lengths.prod():
            raise ValueError("base_x and base_z must be perpendicular")

    def to_local(self, points: FloatArray) -> FloatArray:
        """Points (n, 3) of the file's frame in the actuator's own."""
        if self == BaseFrame():
            return points
        x = np.asarray(self.x) / np.linalg.norm(self.x)
        z = np.asarray(self.z) / np.linalg.norm(self.z)
        axes = np.stack([x, np.cross(z, x), z], axis=1)
        return np.asarray((points - np.asarray(self.origin)) @ axes)


def read_target(
    path: Path,
    levels: tuple[float, float, float],
    length: float,
    base: BaseFrame | None = None,
    straight: bool = True,
) -> Target:
    """Read a target from a CSV file with the columns p1,p2,p3,x,y,z [kPa, mm].

    straight : whether the actuator is, without pressure; else no tip is expected at (0, 0, length).

    Rows are matched by pressure, never by their order; lines that start with # are comments. Rows
    at pressures outside the 27 combinations are left out, with a warning.

    Raises
    ------
    InputError : a column, row or combination is missing, doubled, not a number, or the positions
        can not be mm.
    """
    rows = _rows(path)
    tips = np.full((NODES, 3), np.nan)
    found: dict[int, int] = {}
    extra = 0
    for line, values in rows:
        node = _node(values[:3], levels)
        if node is None:
            extra += 1
        elif node in found:
            raise InputError(
                path, f"line {line}", _combination(values), f"stands on line {found[node]} already"
            )
        else:
            found[node] = line
            tips[node] = values[3:]
    if len(found) < NODES:
        absent = pressure_grid(levels)[next(k for k in range(NODES) if k not in found)]
        raise InputError(
            path,
            f"{len(found)} of {NODES} pressure combinations",
            None,
            f"{_combination(absent)} has none; every combination of {_listed(levels)} kPa needs a "
            f"row, and the table's pressures are {_found_levels(rows)} (are they kPa?)",
        )
    tips = (base or BaseFrame()).to_local(tips)
    _check_scale(path, tips, length)
    warnings = oddities(tips, levels, length if straight else None)
    if extra:
        warnings += (f"{extra} rows at other pressures than {_listed(levels)} kPa were left out",)
    return Target(Workspace(levels, tips), None, warnings)


def _rows(path: Path) -> list[tuple[int, list[float]]]:
    lines = [
        (number, line)
        for number, line in enumerate(read_text(path).splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not lines:
        raise InputError(path, "", "an empty file", f"a table with the columns {','.join(COLUMNS)}")
    header = [name.strip() for name in _cells(path, *lines[0])]
    for name in COLUMNS:
        if header.count(name) != 1:
            raise InputError(
                path, "header", ",".join(header), f"must name {','.join(COLUMNS)} once each"
            )
    places = [header.index(name) for name in COLUMNS]
    return [
        (number, _numbers(path, number, line, places, len(header))) for number, line in lines[1:]
    ]


def _numbers(path: Path, number: int, line: str, places: list[int], columns: int) -> list[float]:
    cells = _cells(path, number, line)
    if len(cells) > columns:
        raise InputError(path, f"line {number}", line, f"has more cells than the {columns} columns")
    values = []
    for name, place in zip(COLUMNS, places, strict=True):
        text = cells[place].strip() if place < len(cells) else ""
        try:
            value = float(text)
        except ValueError:
            value = np.nan
        if not abs(value) <= FARTHEST:
            unit = "kPa" if name.startswith("p") else "mm"
            raise InputError(path, f"line {number}, {name}", text, f"a finite number of {unit}")
        values.append(value)
    return values


def _cells(path: Path, number: int, line: str) -> list[str]:
    try:
        return next(csv.reader([line]))
    except csv.Error as error:
        raise InputError(path, f"line {number}", None, f"no row of a table: {error}") from None


def _node(pressures: list[float], levels: tuple[float, float, float]) -> int | None:
    near = np.abs(np.subtract.outer(pressures, levels)) < SAME_PRESSURE
    if not near.any(axis=1).all():
        return None
    i, j, k = near.argmax(axis=1)
    return node_index(int(i), int(j), int(k))


def _check_scale(path: Path, tips: FloatArray, length: float) -> None:
    farthest = float(np.linalg.norm(tips, axis=1).max())
    if not length / 20 <= farthest <= 50 * length:
        raise InputError(
            path,
            "x, y, z",
            f"up to {farthest:.4g} mm from the base",
            f"{length / 20:g} … {50 * length:g} mm for an actuator of {length:g} mm (are they mm?)",
        )


def oddities(
    tips: FloatArray, levels: tuple[float, float, float], length: float | None
) -> tuple[str, ...]:
    """What a person should be warned about in a target [mm] for an actuator of `length` [mm].

    length : None for an actuator that is not straight without pressure.
    """
    if (
        length is not None
        and levels[0] == 0
        and not np.allclose(tips[0], (0, 0, length), atol=1e-6 * length)
    ):
        place = ", ".join(f"{value:g}" for value in tips[0])
        return (
            f"the target's tip without pressure is ({place}) mm, "
            f"which no section can move from (0, 0, {length:g})",
        )
    return ()


def _combination(values: list[float] | FloatArray) -> str:
    return "(" + ", ".join(f"{value:g}" for value in values[:3]) + ") kPa"


def _found_levels(rows: list[tuple[int, list[float]]]) -> str:
    found = sorted({value for _, values in rows for value in values[:3]})
    return ", ".join(f"{value:g}" for value in found[:6]) + (", …" if len(found) > 6 else "")


def _listed(levels: tuple[float, float, float]) -> str:
    return ", ".join(f"{level:g}" for level in levels)


def tips_csv(pressures: FloatArray, tips: FloatArray) -> str:
    """The table `p1,p2,p3,x,y,z` [kPa, mm] that targets are read from."""
    return csv_text(",".join(COLUMNS), np.hstack([pressures, tips]).tolist())
