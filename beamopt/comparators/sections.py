"""Sections at the ends of intervals: what multiple shooting seeks."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled
from beamopt.comparators.elimination import assign
from beamopt.comparators.loaded import Loaded
from beamopt.comparators.se3 import rotation
from beamopt.comparators.sweep import WORK, advance

__all__ = ["Sections", "draw", "largest_wrench", "move", "take"]


class Sections(NamedTuple):
    """Sections at interval ends, the base first and the tip, behind its load, last.

    marks : (i + 1,) steps before each. frames : (i + 1, 3, 3). values : (i + 1, 9) h, n, m.
    """

    marks: NDArray[np.int64]
    frames: FloatArray
    values: FloatArray

    def copy(self) -> Sections:
        """Another one, to be changed."""
        return Sections(self.marks, self.frames.copy(), self.values.copy())


@compiled
def draw(
    stepper: int, rod: Loaded, segments: NDArray[np.int64], shape: Sections, write: bool
) -> FloatArray:
    """(steps + 1, 3) the axis; with `write`, sections follow from the first, or else stay."""
    line = np.empty((len(segments) + 1, 3))
    state, work, frame = np.zeros((12, 1)), np.empty((WORK, 1)), np.empty((3, 3))
    for i in range(len(shape.marks)):
        if i == 0 or not write:
            take(shape, i, frame, state)
        else:
            assign(shape.frames[i], frame)
            for r in range(9):
                shape.values[i, r] = state[r if r < 3 else r + 3, 0]
        for r in range(3):
            line[shape.marks[i], r] = state[r, 0]
        if i + 1 < len(shape.marks):
            for step in range(shape.marks[i], shape.marks[i + 1]):
                advance(stepper, rod, segments, step, frame, state, work)
                for r in range(3):
                    line[step + 1, r] = state[r, 0]
    return line


@compiled
def take(shape: Sections, i: int, frame: FloatArray, state: FloatArray) -> None:
    """Section i into `frame` and `state` (12, 1 + p), whose columns are by its own φ, n, m."""
    assign(frame, shape.frames[i])
    for r in range(12):
        for j in range(state.shape[1]):
            state[r, j] = 1.0 if j > 0 and r == 2 + j else 0.0
    for r in range(9):
        state[r if r < 3 else r + 3, 0] = shape.values[i, r]


@compiled
def largest_wrench(shape: Sections) -> float:
    """The largest component of the forces and moments."""
    result = 0.0
    for i in range(shape.values.shape[0]):
        for r in range(3, 9):
            result = max(result, abs(shape.values[i, r]))
    return result


@compiled
def move(shape: Sections, ahead: FloatArray, share: float, moved: Sections) -> None:
    """`shape` with a share of the increments (i + 1, 12) of h, φ, n, m, into `moved`."""
    for i in range(len(shape.marks)):
        step = ahead[i]
        turn = rotation(share * step[3], share * step[4], share * step[5])
        for r in range(3):
            for c in range(3):
                moved.frames[i, r, c] = (
                    turn[r, 0] * shape.frames[i, 0, c]
                    + turn[r, 1] * shape.frames[i, 1, c]
                    + turn[r, 2] * shape.frames[i, 2, c]
                )
        for r in range(9):
            moved.values[i, r] = shape.values[i, r] + share * step[r if r < 3 else r + 3]
