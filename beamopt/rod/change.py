"""What one unknown of a rod changes: rotations, forces, positions (kernels)."""

from __future__ import annotations

from typing import NamedTuple

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import inlined
from beamopt.rod.packed import RodArrays, Stations
from beamopt.rod.rotation import cross3, crossed, local, spatial
from beamopt.rod.shape import Shape

__all__ = ["Change", "bend", "move_forces", "move_positions"]


class Change(NamedTuple):
    """What one unknown changes, per unit of it; vectors in space, M points and S segment ends."""

    bent: FloatArray  # (M, 3) curvature, in section axes
    turn: FloatArray  # (M, 3) rotation δφ
    end_turn: FloatArray  # (S, 3)
    pull: FloatArray  # (6,) the reaction
    end_force: FloatArray  # (S, 3) follower forces
    line: FloatArray  # (M, 3)
    beyond: FloatArray  # (M, 3) line force beyond the point
    local_force: FloatArray  # (M, 3) Rᵀn, in section axes
    tangent: FloatArray  # (M, 3) h'
    position: FloatArray  # (M, 3)
    end_position: FloatArray  # (S, 3)
    density: FloatArray  # (M, 3) moment of the line loads about the origin
    end_moment: FloatArray  # (S, 3)
    moment: FloatArray  # (M + 1, 3), the base's last


@inlined
def bend(at: Stations, shape: Shape, mode: int, a: int, change: Change) -> None:
    """A mode of the curvature a, and the rotations δφ(s) = ∫ R δu that it makes."""
    points, segments = at.at.shape[0], change.end_turn.shape[0]
    for j in range(points):
        value = at.basis[j, mode]
        change.bent[j, a] = value
        if value == 0.0:
            continue
        x = value * shape.rotation[j, 0, a]
        y = value * shape.rotation[j, 1, a]
        z = value * shape.rotation[j, 2, a]
        for i in range(points):
            share = at.before[i, j]
            change.turn[i, 0] += share * x
            change.turn[i, 1] += share * y
            change.turn[i, 2] += share * z
        for k in range(segments):
            share = at.to_end[k, j]
            change.end_turn[k, 0] += share * x
            change.end_turn[k, 1] += share * y
            change.end_turn[k, 2] += share * z


@inlined
def move_forces(
    rod: RodArrays, at: Stations, shape: Shape, factor: float, follows: bool, change: Change
) -> None:
    """Follower forces turn with their sections; the others stay."""
    points, segments = at.at.shape[0], rod.kinks.shape[0]
    turn, end_turn = change.turn, change.end_turn
    for k in range(segments):
        F, dead = shape.end_force, rod.end_force
        given = (
            F[k, 0] - factor * dead[k, 0],
            F[k, 1] - factor * dead[k, 1],
            F[k, 2] - factor * dead[k, 2],
        )
        d = cross3((end_turn[k, 0], end_turn[k, 1], end_turn[k, 2]), given)
        for a in range(3):
            change.end_force[k, a] = d[a]
    if follows:
        for i in range(points):
            k, f, dead = at.segment[i], shape.line, rod.line_force
            given = (
                f[i, 0] - factor * dead[k, 0],
                f[i, 1] - factor * dead[k, 1],
                f[i, 2] - factor * dead[k, 2],
            )
            d = cross3((turn[i, 0], turn[i, 1], turn[i, 2]), given)
            for a in range(3):
                change.line[i, a] = d[a]
        for i in range(points):
            for a in range(3):
                total = 0.0
                for j in range(points):
                    total += (at.weight[j] - at.before[i, j]) * change.line[j, a]
                change.beyond[i, a] = total
    for i in range(points):
        about = crossed(turn, i, shape.force, i)
        x, y, z = change.pull[0] - about[0], change.pull[1] - about[1], change.pull[2] - about[2]
        x, y, z = x + change.beyond[i, 0], y + change.beyond[i, 1], z + change.beyond[i, 2]
        for k in range(at.segment[i], segments):
            x += change.end_force[k, 0]
            y += change.end_force[k, 1]
            z += change.end_force[k, 2]
        d = local(shape.rotation, i, x, y, z)
        for a in range(3):
            change.local_force[i, a] = d[a]


@inlined
def move_positions(rod: RodArrays, at: Stations, shape: Shape, change: Change) -> None:
    """δh' = δφ × h' + R δv."""
    points, segments = at.at.shape[0], rod.kinks.shape[0]
    C, X = rod.compliance, rod.coupling
    for i in range(points):
        k = at.segment[i]
        x, y, z = change.local_force[i, 0], change.local_force[i, 1], change.local_force[i, 2]
        p, q, r = change.bent[i, 0], change.bent[i, 1], change.bent[i, 2]
        v0 = C[k, 0, 0] * x + C[k, 0, 1] * y + C[k, 0, 2] * z
        v1 = C[k, 1, 0] * x + C[k, 1, 1] * y + C[k, 1, 2] * z
        v2 = C[k, 2, 0] * x + C[k, 2, 1] * y + C[k, 2, 2] * z
        v0 -= X[k, 0, 0] * p + X[k, 1, 0] * q + X[k, 2, 0] * r
        v1 -= X[k, 0, 1] * p + X[k, 1, 1] * q + X[k, 2, 1] * r
        v2 -= X[k, 0, 2] * p + X[k, 1, 2] * q + X[k, 2, 2] * r
        about = crossed(change.turn, i, shape.tangent, i)
        d = spatial(shape.rotation, i, v0, v1, v2)
        for a in range(3):
            change.tangent[i, a] = about[a] + d[a]
    for a in range(3):
        for i in range(points):
            total = 0.0
            for j in range(points):
                total += at.before[i, j] * change.tangent[j, a]
            change.position[i, a] = total
        for k in range(segments):
            total = 0.0
            for j in range(points):
                total += at.to_end[k, j] * change.tangent[j, a]
            change.end_position[k, a] = total
