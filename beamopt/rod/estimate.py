"""How far from the exact one a shape in modes may be (kernels)."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled
from beamopt.rod.balance import reaction_of, residual_into
from beamopt.rod.newton import solved
from beamopt.rod.packed import RodArrays, Stations
from beamopt.rod.rotation import local
from beamopt.rod.shape import Shape, curvatures_into, shape_into
from beamopt.rod.tangent import tangent_into

__all__ = ["estimated_error"]


@compiled
def estimated_error(
    rod: RodArrays, at: Stations, rest: FloatArray, unknowns: FloatArray, shape: Shape
) -> float:
    """Estimated distance [mm] of the axis, anywhere, from the exact equilibrium under full load.

    The curvature is taken from the moments, point by point, which brings in what the modes lack;
    one Newton step in the modes then lets the rod give way to that, near buckling much more than
    the sweep alone. How far the axis goes with both is the error. To that comes what the points may
    miss of a shape that coils between them. The shape is that of the step afterwards.
    """
    points, last = at.at.shape[0], rod.kinks.shape[0] - 1
    size, modes = rod.free.shape[0], at.basis.shape[1]
    missed = _missed_turn(rod, at, rest, shape)
    before, tip = shape.position.copy(), shape.end_position[last].copy()
    tangent = np.empty((unknowns.shape[0], unknowns.shape[0]))
    residual = np.empty(unknowns.shape[0])
    tangent_into(rod, at, shape, 1.0, reaction_of(rod, at, unknowns), tangent)
    bent = _swept(rod, at, shape)
    goal, turn = np.zeros(3), np.eye(3)
    if rod.held_position.shape[0] == 1:
        goal[:] = rod.held_position[0]
    if rod.held_rotation.shape[0] == 1:
        turn[:] = rod.held_rotation[0]
    now = unknowns.copy()
    for again in range(2):
        hinge = now[modes * size] if rod.hinge.shape[0] == 1 else 0.0
        reaction = reaction_of(rod, at, now)
        curvatures_into(at, rest, bent, shape)
        shape_into(rod, at, rest, 1.0, hinge, reaction, shape)
        if again == 0:
            residual_into(rod, at, shape, goal, turn, reaction, residual)
            step = solved(tangent, residual)
            now -= step
            for i in range(points):
                for b in range(modes):
                    for a in range(size):
                        bent[i, rod.free[a]] -= at.basis[i, b] * step[b * size + a]
    farthest = 0.0
    for a in range(3):
        farthest += (shape.end_position[last, a] - tip[a]) ** 2
    for i in range(points):
        away = 0.0
        for a in range(3):
            away += (shape.position[i, a] - before[i, a]) ** 2
        farthest = max(farthest, away)
    return float(np.sqrt(farthest) + missed)


@compiled
def _swept(rod: RodArrays, at: Stations, shape: Shape) -> FloatArray:
    """(M, 3) u − u* that the moments ask for at every point."""
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
    return bent


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
