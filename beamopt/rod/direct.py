"""All cases of a rod, each from its neighbours straight to full load (kernels)."""

from __future__ import annotations

import numpy as np

from beamopt.arrays import FloatArray, IndexArray
from beamopt.compiled import compiled
from beamopt.rod.balance import reaction_of
from beamopt.rod.newton import DIVERGED, FOUND, newton, solved
from beamopt.rod.packed import RodArrays, Stations
from beamopt.rod.rotation import local
from beamopt.rod.shape import Shape, curvatures_into, shape_into

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

    The error is how far the axis moves anywhere when the curvature is taken from the moments, point
    by point: at an exact solution not at all. To that comes what the points may miss of a shape
    that coils between them. The shape is that of the sweep afterwards.
    """
    missed = _missed_turn(rod, at, rest, shape)
    last = rod.kinks.shape[0] - 1
    for a in range(3):
        values[a] = shape.end_position[last, a]
        for b in range(3):
            values[3 + 3 * a + b] = shape.end_rotation[last, a, b]
    values[12] = np.min(shape.stretch)
    centreline[:] = shape.position
    free, points = rod.free, at.at.shape[0]
    size = free.shape[0]
    bent, right, block = np.zeros((points, 3)), np.empty(size), np.empty((size, size))
    for i in range(points):
        part = at.segment[i]
        force = local(shape.rotation, i, shape.force[i, 0], shape.force[i, 1], shape.force[i, 2])
        m = local(shape.rotation, i, shape.moment[i, 0], shape.moment[i, 1], shape.moment[i, 2])
        for a in range(size):
            right[a] = m[free[a]]
            for b in range(3):
                right[a] -= rod.coupling[part, free[a], b] * force[b]
            for b in range(size):
                block[a, b] = rod.bending[part, free[a], free[b]]
        answer = solved(block, right)
        for a in range(size):
            bent[i, free[a]] = answer[a]
    modes = at.basis.shape[1] * size
    hinge = unknowns[modes] if rod.hinge.shape[0] == 1 else 0.0
    curvatures_into(at, rest, bent, shape)
    shape_into(rod, at, rest, 1.0, hinge, reaction_of(rod, at, unknowns), shape)
    x = shape.end_position[last, 0] - values[0]
    y = shape.end_position[last, 1] - values[1]
    z = shape.end_position[last, 2] - values[2]
    farthest = x * x + y * y + z * z
    for i in range(points):
        x = shape.position[i, 0] - centreline[i, 0]
        y = shape.position[i, 1] - centreline[i, 1]
        z = shape.position[i, 2] - centreline[i, 2]
        farthest = max(farthest, x * x + y * y + z * z)
    values[13] = np.sqrt(farthest) + missed


@compiled
def _missed_turn(rod: RodArrays, at: Stations, rest: FloatArray, shape: Shape) -> float:
    """What the Gauss points may miss of ∫ R v ds [mm]: as much as they miss of ∫ R [u]× ds.

    The latter is known, the change of R along a segment; v is about 1, so it is divided by the
    curvature.
    """
    segments = rod.kinks.shape[0]
    count = at.at.shape[0] // segments
    total = 0.0
    begin = rod.base_rotation.copy()
    for part in range(segments):
        begin = begin @ rod.kinks[part]
        missing = shape.end_rotation[part] - begin
        length, largest = 0.0, 0.0
        for i in range(part * count, (part + 1) * count):
            u0 = rest[part, 0] + shape.bent[i, 0]
            u1 = rest[part, 1] + shape.bent[i, 1]
            u2 = rest[part, 2] + shape.bent[i, 2]
            largest = max(largest, np.sqrt(u0 * u0 + u1 * u1 + u2 * u2))
            length += at.weight[i]
            for a in range(3):
                x, y, z = shape.rotation[i, a, 0], shape.rotation[i, a, 1], shape.rotation[i, a, 2]
                missing[a, 0] -= at.weight[i] * (y * u2 - z * u1)
                missing[a, 1] -= at.weight[i] * (z * u0 - x * u2)
                missing[a, 2] -= at.weight[i] * (x * u1 - y * u0)
        total += np.sqrt(np.sum(missing * missing)) / max(largest, 1.0 / length)
        begin[:] = shape.end_rotation[part]
    return total
