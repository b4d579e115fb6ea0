"""How the balance of moments changes with the modes: the tangent, exact in the loads (kernels)."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled, inlined
from beamopt.rod.change import Change, bend, move_forces, move_positions
from beamopt.rod.packed import RodArrays, Stations
from beamopt.rod.rotation import Vector, cross3, crossed, local
from beamopt.rod.shape import Shape

__all__ = ["tangent_into"]


@compiled
def tangent_into(
    rod: RodArrays, at: Stations, shape: Shape, factor: float, reaction: FloatArray, out: FloatArray
) -> None:
    """Derivative (n, n) of the residual by the unknowns; symmetric where loads have a potential."""
    points, segments = at.at.shape[0], rod.kinks.shape[0]
    many, few = (points, 3), (segments, 3)
    change = Change(
        np.zeros(many), np.zeros(many), np.zeros(few), np.zeros(6), np.zeros(few),
        np.zeros(many), np.zeros(many), np.zeros(many), np.zeros(many), np.zeros(many),
        np.zeros(few), np.zeros(many), np.zeros(few), np.zeros((points + 1, 3)),
    )  # fmt: skip
    follows = False
    for k in range(segments):
        for a in range(3):
            follows = follows or rod.line_follower[k, a] != 0.0
    count, modes = rod.free.shape[0], at.basis.shape[1]
    for column in range(out.shape[0]):
        change.bent[:] = 0.0
        change.turn[:] = 0.0
        change.end_turn[:] = 0.0
        change.pull[:] = 0.0
        if column < modes * count:
            mode = column // count
            bend(at, shape, mode, rod.free[column - mode * count], change)
        elif column < modes * count + rod.hinge.shape[0]:
            for a in range(3):
                change.turn[:, a] = rod.hinge[0, a]
                change.end_turn[:, a] = rod.hinge[0, a]
        else:
            place = column - modes * count - rod.hinge.shape[0]
            # only the rotation may be held: its three moments come first then
            change.pull[place + (0 if rod.held_position.shape[0] == 1 else 3)] = 1.0
        move_forces(rod, at, shape, factor, follows, change)
        move_positions(rod, at, shape, change)
        _moments(rod, at, shape, factor, reaction, change)
        _project(rod, at, shape, change, out, column)


@inlined
def _moments(
    rod: RodArrays,
    at: Stations,
    shape: Shape,
    factor: float,
    reaction: FloatArray,
    change: Change,
) -> None:
    """Changes of the moments at the points and at the base."""
    points, segments = at.at.shape[0], rod.kinks.shape[0]
    whole = np.zeros(3)
    total, moved = np.zeros((1, 3)), np.zeros((1, 3))  # line force, and its change
    for i in range(points):
        arm = crossed(change.turn, i, shape.line_arm, i)
        p, f, df = shape.position, shape.line, change.line
        x = cross3(
            (
                change.position[i, 0] + arm[0],
                change.position[i, 1] + arm[1],
                change.position[i, 2] + arm[2],
            ),
            (f[i, 0], f[i, 1], f[i, 2]),
        )
        lever = (
            p[i, 0] + shape.line_arm[i, 0],
            p[i, 1] + shape.line_arm[i, 1],
            p[i, 2] + shape.line_arm[i, 2],
        )
        y = cross3(lever, (df[i, 0], df[i, 1], df[i, 2]))
        for a in range(3):
            change.density[i, a] = x[a] + y[a]
            whole[a] += at.weight[i] * change.density[i, a]
            total[0, a] += at.weight[i] * f[i, a]
            moved[0, a] += at.weight[i] * df[i, a]
    for k in range(segments):
        _end_moment(rod, shape, factor, change, k)
    for i in range(points):
        for a in range(3):
            value = whole[a] + change.pull[3 + a]
            for j in range(points):
                value -= at.before[i, j] * change.density[j, a]
            change.moment[i, a] = value
        x = crossed(change.position, i, shape.beyond, i)
        y = crossed(shape.position, i, change.beyond, i)
        for a in range(3):
            change.moment[i, a] -= x[a] + y[a]
        here = (shape.position[i, 0], shape.position[i, 1], shape.position[i, 2])
        goes = (change.position[i, 0], change.position[i, 1], change.position[i, 2])
        _add_ends(shape, reaction, at.segment[i], here, goes, change, i)
    here = (rod.base_position[0], rod.base_position[1], rod.base_position[2])
    x = cross3(here, (moved[0, 0], moved[0, 1], moved[0, 2]))
    for a in range(3):
        change.moment[points, a] = whole[a] + change.pull[3 + a] - x[a]
    _add_ends(shape, reaction, 0, here, (0.0, 0.0, 0.0), change, points)


@inlined
def _end_moment(rod: RodArrays, shape: Shape, factor: float, change: Change, k: int) -> None:
    """Change of the moment at a segment's end: follower moment, and the force on its arm."""
    arm = crossed(shape.end_arm, k, shape.end_force, k)
    M, dead = shape.end_moment, rod.end_moment
    follower = (
        M[k, 0] - arm[0] - factor * dead[k, 0],
        M[k, 1] - arm[1] - factor * dead[k, 1],
        M[k, 2] - arm[2] - factor * dead[k, 2],
    )
    turn = (change.end_turn[k, 0], change.end_turn[k, 1], change.end_turn[k, 2])
    x = cross3(turn, follower)
    lever = crossed(change.end_turn, k, shape.end_arm, k)
    y = cross3(lever, (shape.end_force[k, 0], shape.end_force[k, 1], shape.end_force[k, 2]))
    z = crossed(shape.end_arm, k, change.end_force, k)
    for a in range(3):
        change.end_moment[k, a] = x[a] + y[a] + z[a]


@inlined
def _add_ends(
    shape: Shape,
    reaction: FloatArray,
    first: int,
    here: Vector,
    goes: Vector,
    change: Change,
    i: int,
) -> None:
    """Add changes of the moments, about a point that moves, of what acts at the segments' ends."""
    segments = shape.end_force.shape[0]
    x, dx, F, dF = shape.end_position, change.end_position, shape.end_force, change.end_force
    for k in range(first, segments):
        lever = (x[k, 0] - here[0], x[k, 1] - here[1], x[k, 2] - here[2])
        moved = (dx[k, 0] - goes[0], dx[k, 1] - goes[1], dx[k, 2] - goes[2])
        p = cross3(moved, (F[k, 0], F[k, 1], F[k, 2]))
        q = cross3(lever, (dF[k, 0], dF[k, 1], dF[k, 2]))
        for a in range(3):
            change.moment[i, a] += change.end_moment[k, a] + p[a] + q[a]
    k = segments - 1
    lever = (x[k, 0] - here[0], x[k, 1] - here[1], x[k, 2] - here[2])
    moved = (dx[k, 0] - goes[0], dx[k, 1] - goes[1], dx[k, 2] - goes[2])
    p = cross3(moved, (reaction[0], reaction[1], reaction[2]))
    q = cross3(lever, (change.pull[0], change.pull[1], change.pull[2]))
    for a in range(3):
        change.moment[i, a] += p[a] + q[a]


@inlined
def _project(
    rod: RodArrays, at: Stations, shape: Shape, change: Change, out: FloatArray, column: int
) -> None:
    """The column: ∫ φ (bending δu + coupling δ(Rᵀn) − δ(Rᵀm)) ds for every mode, then the ends."""
    count, modes, points = rod.free.shape[0], at.basis.shape[1], at.at.shape[0]
    out[:, column] = 0.0
    for i in range(points):
        k = at.segment[i]
        about = crossed(change.turn, i, shape.moment, i)
        d = local(
            shape.rotation,
            i,
            change.moment[i, 0] - about[0],
            change.moment[i, 1] - about[1],
            change.moment[i, 2] - about[2],
        )
        for a in range(count):
            row = rod.free[a]
            value = -d[row]
            for b in range(3):
                value += rod.bending[k, row, b] * change.bent[i, b]
                value += rod.coupling[k, row, b] * change.local_force[i, b]
            value *= at.weight[i]
            for b in range(modes):
                out[b * count + a, column] += at.basis[i, b] * value
    place, last = modes * count, rod.kinks.shape[0] - 1
    for k in range(rod.hinge.shape[0]):
        for a in range(3):
            out[place, column] -= rod.hinge[k, a] * change.moment[points, a]
        place += 1
    for _ in range(rod.held_position.shape[0]):
        for a in range(3):
            value = change.end_position[last, a] + rod.give[0] * change.pull[a]
            out[place + a, column] = -value
        place += 3
    for _ in range(rod.held_rotation.shape[0]):
        for a in range(3):
            value = change.end_turn[last, a] + rod.give[1] * change.pull[3 + a]
            out[place + a, column] = -value
