"""All cases of a rod, each from its neighbours straight to full load (kernels)."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.base.compiled import compiled
from beamopt.rod.estimate import estimated_error
from beamopt.rod.newton import DIVERGED, FOUND, newton
from beamopt.rod.packed import RodArrays, Stations
from beamopt.rod.shape import Shape

__all__ = ["read_case", "solve_directly"]


@compiled
def solve_directly(
    rod: RodArrays,
    at: Stations,
    rests: FloatArray,
    starts: FloatArray,
    turns: FloatArray,
    parents: IndexArray,
    conservative: bool,
    close: float,
    unknowns: FloatArray,
    ended: IndexArray,
    iterations: IndexArray,
    values: FloatArray,
    centrelines: FloatArray,
    shape: Shape,
) -> None:
    """Iterate at full load for every case's rest strains (n, S, 6), parents before their children.

    starts, turns : (n, 3) see `newton.evaluate`; zero where the tip is free.
    parents : (n, 3) cases a, b, c whose a + b − c begins a case (−1: from rest).
    close : see `newton.newton`.
    unknowns : (n, k) what was found.
    ended, iterations : (n,) see `newton.newton`; the way out of a well counts as not found.
    values, centrelines : (n, 14), (n, M, 3) see `read_case`.
    """
    for case in range(rests.shape[0]):
        a, b, c = parents[case, 0], parents[case, 1], parents[case, 2]
        ended[case] = DIVERGED
        if a >= 0 and ended[a] != FOUND:
            continue  # from rest it would not go better than its parent
        y = unknowns[case]
        y[:] = 0.0
        if a >= 0:
            y[:] = unknowns[a]
            if b >= 0 and c >= 0 and ended[b] == FOUND and ended[c] == FOUND:
                y += unknowns[b] - unknowns[c]
        rest, start, turn = rests[case], starts[case], turns[case]
        ended[case], iterations[case] = newton(
            rod, at, rest, start, turn, conservative, True, close, 1.0, y, shape
        )
        if ended[case] == FOUND:
            read_case(rod, at, rest, y, shape, values[case], centrelines[case])


@compiled
def read_case(
    rod: RodArrays,
    at: Stations,
    rest: FloatArray,
    unknowns: FloatArray,
    shape: Shape,
    values: FloatArray,
    centreline: FloatArray,
) -> None:
    """Read a shape: tip (3), its rotation (9), lowest v3, estimated error of the tip [mm].

    The shape is another one afterwards; see `estimate.estimated_error`.
    """
    last = rod.kinks.shape[0] - 1
    for a in range(3):
        values[a] = shape.end_position[last, a]
        for b in range(3):
            values[3 + 3 * a + b] = shape.end_rotation[last, a, b]
    values[12] = np.min(shape.stretch)
    centreline[:] = shape.position
    values[13] = estimated_error(rod, at, rest, unknowns, shape)
