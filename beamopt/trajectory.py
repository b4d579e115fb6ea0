"""Trajectories: poly-lines that the tip should be able to follow."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from beamopt.arrays import FloatArray, IndexArray
from beamopt.errors import InputError
from beamopt.table import read_table
from beamopt.target import BaseFrame, check_scale

__all__ = ["MOST_SAMPLES", "read_path", "sampled"]

MOST_SAMPLES = 10_000
TOO_MANY = 10**12  # pieces of a side: their sum is a number still, however small the step


def read_path(path: Path, length: float, step: float, base: BaseFrame | None = None) -> FloatArray:
    """(k, 3) points [mm] of a poly-line from a CSV file with the columns x,y,z [mm].

    Parameters
    ----------
    length : of the actuator [mm].
    step : largest distance between neighbouring points [mm]; see `sampled`.
    base : where the actuator stands in the file's frame.

    Raises
    ------
    InputError : a column is missing, a cell not a number, there is one corner only, the positions
        can not be mm, or there are too many points.
    """
    corners = read_table(path, dict.fromkeys("xyz", "mm")).stacked("xyz")
    if len(corners) < 2 or not np.any(corners != corners[0]):
        rows = f"{len(corners)} row{'' if len(corners) == 1 else 's'}"
        said = rows if len(corners) < 2 else "the same point throughout"
        raise InputError(path, said, None, "a trajectory has two different points or more")
    corners = (base or BaseFrame()).to_local(corners)
    check_scale(path, corners, length)
    count = int(_pieces(corners, step).sum()) + 1
    if count > MOST_SAMPLES:
        said = f"at most {MOST_SAMPLES:,} (are they mm? or a larger path_step)"
        raise InputError(path, f"{count:,} samples at path_step = {step:g} mm", None, said)
    return sampled(corners, step)


def sampled(corners: FloatArray, step: float) -> FloatArray:
    """(k, 3) points of the poly-line through `corners` (c, 3), its ends and corners among them.

    Each side is cut into equal pieces of at most `step` [mm]; sides without length are left out.
    """
    found = [corners[:1]]
    for start, end, pieces in zip(
        corners[:-1], corners[1:], _pieces(corners, step).tolist(), strict=True
    ):
        share = np.arange(1, pieces + 1)[:, None] / max(pieces, 1)
        found.append(start + share * (end - start))
        found[-1][pieces - 1 : pieces] = end  # exactly
    return np.concatenate(found)


def _pieces(corners: FloatArray, step: float) -> IndexArray:
    """(c − 1,) of each side; rounding makes no piece more of a whole number of steps."""
    lengths = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    with np.errstate(over="ignore"):
        pieces = np.ceil(lengths / step * (1 - 1e-12))
    return np.asarray(np.minimum(pieces, TOO_MANY), dtype=np.int64)
