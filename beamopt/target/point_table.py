"""Targets of any pressures and tips, with weights and directions."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError
from beamopt.storage.number_table import Table, read_table
from beamopt.storage.writing import csv_text
from beamopt.target.aim import Aim
from beamopt.target.target import BaseFrame, Target, check_scale
from beamopt.target.workspace import COLUMNS, tips_csv

__all__ = ["aim_csv", "direction_weight_of", "read_pairs"]

DIRECTION = ("tx", "ty", "tz")
OPTIONAL = {"weight": "", "tx": "", "ty": "", "tz": "", "direction_weight": "mm²"}
HIGHEST = 2000.0  # kPa, as of a scene's levels
MOST_ROWS = 20_000  # each is judged for every section
STRAIGHT = 1e-6  # of the length


def direction_weight_of(length: float) -> float:
    """(length/10)² [mm²]: what one unit of squared difference of tangents counts if not said.

    A tip that points wrongly by 0.1 rad then counts like one that is off by a hundredth of the
    length: 1 mm of 100 mm.
    """
    return (length / 10) ** 2


def read_pairs(
    path: Path,
    length: float,
    base: BaseFrame | None = None,
    straight: bool = True,
    direction_weight: float | None = None,
) -> Target:
    """Read pairs of pressures and tips from a CSV file: p1,p2,p3,x,y,z [kPa, mm], a row or more.

    Optional columns: weight (1 where blank), tx,ty,tz (the wanted direction of the tip's axis, of
    any length; blank for none), direction_weight [mm²]. The same pressures may stand more than
    once, as in repeated measurements: each row counts. Rows are put in the order of their values,
    so that theirs in the file makes no difference.

    Parameters
    ----------
    length : of the actuator [mm].
    base : where it stands in the file's frame.
    straight : whether it is, without pressure; else no tip is expected at (0, 0, length).
    direction_weight : where its column is blank [mm²]; `direction_weight_of(length)` if None.

    Raises
    ------
    InputError : a column is missing, a cell not a number or out of range, there is no row, or
        the positions can not be mm.
    """
    table = read_table(path, COLUMNS, OPTIONAL)
    if not len(table):
        raise InputError(path, "no rows", None, "one pair of pressures and tip, or more")
    if len(table) > MOST_ROWS:
        raise InputError(path, "rows", len(table), f"at most {MOST_ROWS} (take every n-th)")
    pressures = table.stacked(["p1", "p2", "p3"])
    for k, j in np.argwhere((pressures < 0) | (pressures > HIGHEST)).tolist():
        raise table.fault(k, f"p{j + 1}", f"0 … {HIGHEST:g} kPa (are they kPa?)")
    frame = base or BaseFrame()
    tips = frame.to_local(table.stacked(["x", "y", "z"]))
    check_scale(path, tips, length)
    weights = _weights(table, "weight", 1.0)
    usual = direction_weight_of(length) if direction_weight is None else direction_weight
    directions, direction_weights = _directions(table, frame, usual)
    if not (weights.any() or direction_weights.any()):
        raise InputError(path, "weight", 0, "at least one row must count: a weight above 0")
    values = np.column_stack([pressures, tips, weights, directions, direction_weights])
    order = np.lexsort(values.T[::-1])
    aim = Aim(
        pressures[order],
        tips[order],
        weights[order],
        directions[order],
        direction_weights[order],
    )
    return Target(aim, warnings=_oddities(aim, length if straight else None))


def _weights(table: Table, name: str, usual: float) -> FloatArray:
    values = table.columns[name]
    for k in np.flatnonzero(values < 0).tolist():
        raise table.fault(k, name, "at least 0")
    return np.where(np.isnan(values), usual, values)


def _directions(table: Table, frame: BaseFrame, usual: float) -> tuple[FloatArray, FloatArray]:
    """Unit vectors (n, 3), zero where there is none, and their weights (n,) [mm²]."""
    asked = table.stacked(DIRECTION)
    blank = np.isnan(asked)
    for k in np.flatnonzero(blank.any(axis=1) & ~blank.all(axis=1)).tolist():
        raise table.fault(k, DIRECTION[int(blank[k].argmax())], "tx, ty, tz: all three or none")
    there = ~blank.all(axis=1)
    lengths = np.linalg.norm(np.where(blank, 0.0, asked), axis=1)
    for k in np.flatnonzero(there & (lengths == 0)).tolist():
        raise table.fault(k, "tx", "tx, ty, tz must not be a zero vector; blank for no direction")
    weights = _weights(table, "direction_weight", usual)
    given = table.columns["direction_weight"]
    for k in np.flatnonzero(~there & (given > 0)).tolist():
        raise table.fault(k, "direction_weight", "goes with tx, ty, tz")
    directions = np.zeros((len(table), 3))
    directions[there] = frame.turned(asked[there] / lengths[there, None])
    return directions, np.where(there, weights, 0.0)


def _oddities(aim: Aim, length: float | None) -> tuple[str, ...]:
    """What a person should be warned about."""
    at_rest = aim.tips[~aim.pressures.any(axis=1)]
    if length is not None and len(at_rest):
        away = np.abs(at_rest - (0, 0, length)).max(axis=1)
        if away.max() > STRAIGHT * length:
            place = ", ".join(f"{value:g}" for value in at_rest[int(away.argmax())])
            return (
                f"the target's tip without pressure is ({place}) mm, "
                f"which no section can move from (0, 0, {length:g})",
            )
    return ()


def aim_csv(aim: Aim) -> str:
    """The rows of an aim as a table that `read_pairs` reads; weights and directions if they count.

    Where all tips count alike and point anywhere: `tips_csv`.
    """
    if not aim.turns and (aim.weights == 1).all():
        return tips_csv(aim.pressures, aim.tips)
    header, columns = [*COLUMNS, "weight"], [aim.pressures, aim.tips, aim.weights[:, None]]
    rows = np.hstack(columns).tolist()
    if aim.turns:
        header += [*DIRECTION, "direction_weight"]
        for row, way, weight in zip(rows, aim.directions, aim.direction_weights, strict=True):
            row += [*way.tolist(), float(weight)] if weight else [None] * 4
    return csv_text(",".join(header), rows)
