"""Targets: the workspace that a section is searched for."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError
from beamopt.section.cross_section import CrossSection
from beamopt.storage.number_table import Table, read_table
from beamopt.target.aim import Aim, aim_of_workspace
from beamopt.target.workspace import COLUMNS, NODES, Workspace, node_index, pressure_grid

__all__ = ["BaseFrame", "Target", "check_scale", "oddities", "read_target"]

ONLY_OF_POINTS = ("weight", "tx", "ty", "tz", "direction_weight")
SAME_PRESSURE = 1e-6  # kPa


@dataclass(frozen=True, eq=False)
class Target:
    """What a section is searched for, the section it was made from if any, and what is odd.

    workspace : where the aim's rows are its 27 nodes; else None.
    paths : (k, 3) samples of each trajectory [mm], corners included; joined in `aim.paths`.
    warnings : sentences for people.

    Examples
    --------
    >>> import beamopt
    >>> target: beamopt.Target = beamopt.load_scene("hand-drawn-workspace").load_target()
    >>> target
    <Target: <Workspace: 27 tips at 0, 50, 100 kPa, up to 35 mm off the axis>, 0 trajectories>
    """

    aim: Aim
    workspace: Workspace | None = None
    section: CrossSection | None = None
    warnings: tuple[str, ...] = ()
    paths: tuple[FloatArray, ...] = ()

    def __repr__(self) -> str:
        if self.workspace is not None:
            return f"<Target: {self.workspace!r}, {len(self.paths)} trajectories>"
        return f"<Target: {len(self.aim)} tips, {len(self.paths)} trajectories>"

    @classmethod
    def of_workspace(
        cls,
        workspace: Workspace,
        section: CrossSection | None = None,
        warnings: tuple[str, ...] = (),
    ) -> Target:
        """The paper's: 27 tips that count alike."""
        return cls(aim_of_workspace(workspace), workspace, section, warnings)

    def with_paths(self, paths: tuple[FloatArray, ...], weight: float) -> Target:
        """The same with trajectories, each (k, 3) points [mm] of that weight."""
        aim = replace(self.aim, paths=np.concatenate(paths), path_weight=weight)
        return replace(self, aim=aim, paths=paths)


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
        return points if self == BaseFrame() else self.turned(points - np.asarray(self.origin))

    def turned(self, directions: FloatArray) -> FloatArray:
        """Directions (n, 3) of the file's frame in the actuator's own axes."""
        x = np.asarray(self.x) / np.linalg.norm(self.x)
        z = np.asarray(self.z) / np.linalg.norm(self.z)
        return np.asarray(directions @ np.stack([x, np.cross(z, x), z], axis=1))


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
    table = read_table(path, COLUMNS)
    tips = np.full((NODES, 3), np.nan)
    found: dict[int, int] = {}
    extra = 0
    for line, values in zip(table.lines, table.stacked(list(COLUMNS)), strict=True):
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
            f"row, and the table's pressures are {_found_levels(table)} (are they kPa?)",
        )
    tips = (base or BaseFrame()).to_local(tips)
    check_scale(path, tips, length)
    warnings = oddities(tips, levels, length if straight else None)
    return Target.of_workspace(
        Workspace(levels, tips), None, warnings + _left_out(table, extra, levels)
    )


def _left_out(table: Table, extra: int, levels: tuple[float, float, float]) -> tuple[str, ...]:
    """What a table holds that 27 tips that count alike do not."""
    said = []
    if extra:
        said.append(
            f"{extra} rows at other pressures than {_listed(levels)} kPa were left out; "
            'kind = "points" takes rows at any'
        )
    columns = [name for name in ONLY_OF_POINTS if name in table.header]
    if columns:
        said.append(f'the columns {", ".join(columns)} were left out; kind = "points" takes them')
    return tuple(said)


def _node(pressures: FloatArray, levels: tuple[float, float, float]) -> int | None:
    near = np.abs(np.subtract.outer(pressures, levels)) < SAME_PRESSURE
    if not near.any(axis=1).all():
        return None
    i, j, k = near.argmax(axis=1)
    return node_index(int(i), int(j), int(k))


def check_scale(path: Path, tips: FloatArray, length: float) -> None:
    """Refuse tips (n, 3) that can not be mm, for an actuator of `length` [mm]."""
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


def _combination(values: FloatArray) -> str:
    return "(" + ", ".join(f"{value:g}" for value in values[:3]) + ") kPa"


def _found_levels(table: Table) -> str:
    found = sorted(set(table.stacked(["p1", "p2", "p3"]).ravel().tolist()))
    return ", ".join(f"{value:g}" for value in found[:6]) + (", …" if len(found) > 6 else "")


def _listed(levels: tuple[float, float, float]) -> str:
    return ", ".join(f"{level:g}" for level in levels)
