"""From curvatures to the shape and the forces that its loads make (kernels)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled, inlined
from beamopt.rod.packed import RodArrays, Stations
from beamopt.rod.rotation import (
    cross3,
    crossed,
    local,
    magnus_step,
    multiply_rotation,
    spatial,
)

__all__ = ["Shape", "curvatures_into", "empty_shape", "modes_into", "shape_into"]


class Shape(NamedTuple):
    """A shape, and the internal force and moment that the loads beyond each point make.

    M points, S segment ends; vectors in space.
    """

    bent: FloatArray  # (M, 3) u − u*, in section axes [1/mm]
    curvature: FloatArray  # (S (N + 1), 3, 3) u at the Gauss points of the rotation's steps
    rotation: FloatArray  # (M, 3, 3)
    end_rotation: FloatArray  # (S, 3, 3)
    tangent: FloatArray  # (M, 3) h' = R v
    position: FloatArray  # (M, 3) h [mm]
    end_position: FloatArray  # (S, 3)
    stretch: FloatArray  # (M,) v3
    line: FloatArray  # (M, 3) force per length
    line_arm: FloatArray  # (M, 3) from the axis to where it acts
    end_force: FloatArray  # (S, 3)
    end_arm: FloatArray  # (S, 3)
    end_moment: FloatArray  # (S, 3) with that of the arm
    beyond: FloatArray  # (M, 3) line force beyond the point
    force: FloatArray  # (M, 3) n [mN]
    moment: FloatArray  # (M, 3) m [mN·mm]
    base_moment: FloatArray  # (1, 3)


@compiled
def empty_shape(points: int, segments: int, steps: int) -> Shape:
    """Room for a shape."""
    return Shape(
        np.zeros((points, 3)),
        np.zeros((steps, 3, 3)),
        np.zeros((points, 3, 3)),
        np.zeros((segments, 3, 3)),
        np.zeros((points, 3)),
        np.zeros((points, 3)),
        np.zeros((segments, 3)),
        np.zeros(points),
        np.zeros((points, 3)),
        np.zeros((points, 3)),
        np.zeros((segments, 3)),
        np.zeros((segments, 3)),
        np.zeros((segments, 3)),
        np.zeros((points, 3)),
        np.zeros((points, 3)),
        np.zeros((points, 3)),
        np.zeros((1, 3)),
    )


@inlined
def modes_into(
    rod: RodArrays, at: Stations, rest: FloatArray, unknowns: FloatArray, out: Shape
) -> None:
    """Curvatures of a shape from the amplitudes of its modes, (mode, free curvature) in a row."""
    free = rod.free
    out.bent[:] = 0.0
    for i in range(at.at.shape[0]):
        for b in range(at.basis.shape[1]):
            value = at.basis[i, b]
            if value != 0.0:
                for a in range(free.shape[0]):
                    out.bent[i, free[a]] += value * unknowns[b * free.shape[0] + a]
    per_segment = at.step.shape[0] // rod.kinks.shape[0]
    for k in range(at.step.shape[0]):
        for g in range(3):
            for a in range(3):
                out.curvature[k, g, a] = rest[k // per_segment, a]
            for b in range(at.basis.shape[1]):
                value = at.step_basis[k, g, b]
                if value != 0.0:
                    for a in range(free.shape[0]):
                        out.curvature[k, g, free[a]] += value * unknowns[b * free.shape[0] + a]


@inlined
def curvatures_into(at: Stations, rest: FloatArray, bent: FloatArray, out: Shape) -> None:
    """Curvatures of a shape from u − u* (M, 3) at its points."""
    segments = rest.shape[0]
    count = at.at.shape[0] // segments
    out.bent[:] = bent
    for k in range(at.step.shape[0]):
        part = k // (count + 1)
        inside = k - part * (count + 1)
        for g in range(3):
            for a in range(3):
                total = rest[part, a]
                for i in range(count):
                    total += at.step_between[inside, g, i] * bent[part * count + i, a]
                out.curvature[k, g, a] = total


@inlined
def shape_into(
    rod: RodArrays,
    at: Stations,
    rest: FloatArray,
    factor: float,
    hinge: float,
    reaction: FloatArray,
    out: Shape,
) -> None:
    """The shape that `out.bent` and `out.curvature` make, and the loads on it times `factor`.

    hinge : angle [rad] about the base's free axis. reaction : (6,) force and moment in space that
    hold a prescribed tip.
    """
    _rotations(rod, at, hinge, out)
    _forces(rod, at, factor, reaction, out)
    _positions(rod, at, rest, out)
    _moments(rod, at, factor, reaction, out)


@inlined
def _rotations(rod: RodArrays, at: Stations, hinge: float, out: Shape) -> None:
    segments = rod.kinks.shape[0]
    count = at.at.shape[0] // segments
    now = rod.base_rotation.copy()
    if rod.hinge.shape[0] == 1:  # exp(axis · angle) R0 = R0 exp(R0ᵀ axis · angle)
        x, y, z = hinge * rod.hinge[0, 0], hinge * rod.hinge[0, 1], hinge * rod.hinge[0, 2]
        R = rod.base_rotation
        multiply_rotation(
            now,
            (
                R[0, 0] * x + R[1, 0] * y + R[2, 0] * z,
                R[0, 1] * x + R[1, 1] * y + R[2, 1] * z,
                R[0, 2] * x + R[1, 2] * y + R[2, 2] * z,
            ),
        )
    for part in range(segments):
        now = now @ rod.kinks[part]
        for inside in range(count + 1):
            step = part * (count + 1) + inside
            multiply_rotation(now, magnus_step(out.curvature, step, at.step[step]))
            if inside < count:
                out.rotation[part * count + inside] = now
            else:
                out.end_rotation[part] = now


@inlined
def _forces(rod: RodArrays, at: Stations, factor: float, reaction: FloatArray, out: Shape) -> None:
    points, segments = at.at.shape[0], rod.kinks.shape[0]
    for k in range(segments):
        load, arm = rod.end_follower, rod.end_at
        given = spatial(out.end_rotation, k, load[k, 0], load[k, 1], load[k, 2])
        lever = spatial(out.end_rotation, k, arm[k, 0], arm[k, 1], arm[k, 2])
        for a in range(3):
            out.end_force[k, a] = factor * (rod.end_force[k, a] + given[a])
            out.end_arm[k, a] = lever[a]
    for i in range(points):
        part = at.segment[i]
        load, arm = rod.line_follower, rod.line_at
        given = spatial(out.rotation, i, load[part, 0], load[part, 1], load[part, 2])
        lever = spatial(out.rotation, i, arm[part, 0], arm[part, 1], arm[part, 2])
        for a in range(3):
            out.line[i, a] = factor * (rod.line_force[part, a] + given[a])
            out.line_arm[i, a] = lever[a]
    for i in range(points):
        for a in range(3):
            beyond, total = 0.0, reaction[a]
            for j in range(points):
                beyond += (at.weight[j] - at.before[i, j]) * out.line[j, a]
            for k in range(at.segment[i], segments):
                total += out.end_force[k, a]
            out.beyond[i, a] = beyond
            out.force[i, a] = total + beyond


@inlined
def _positions(rod: RodArrays, at: Stations, rest: FloatArray, out: Shape) -> None:
    """v = v* + compliance · n − couplingᵀ · Δu, h' = R v."""
    points, segments = at.at.shape[0], rod.kinks.shape[0]
    for i in range(points):
        k = at.segment[i]
        C, X = rod.compliance, rod.coupling
        x, y, z = local(out.rotation, i, out.force[i, 0], out.force[i, 1], out.force[i, 2])
        p, q, r = out.bent[i, 0], out.bent[i, 1], out.bent[i, 2]
        v0 = C[k, 0, 0] * x + C[k, 0, 1] * y + C[k, 0, 2] * z
        v1 = C[k, 1, 0] * x + C[k, 1, 1] * y + C[k, 1, 2] * z
        v2 = C[k, 2, 0] * x + C[k, 2, 1] * y + C[k, 2, 2] * z
        v0 += rest[k, 3] - (X[k, 0, 0] * p + X[k, 1, 0] * q + X[k, 2, 0] * r)
        v1 += rest[k, 4] - (X[k, 0, 1] * p + X[k, 1, 1] * q + X[k, 2, 1] * r)
        v2 += rest[k, 5] - (X[k, 0, 2] * p + X[k, 1, 2] * q + X[k, 2, 2] * r)
        out.stretch[i] = v2
        tangent = spatial(out.rotation, i, v0, v1, v2)
        for a in range(3):
            out.tangent[i, a] = tangent[a]
    for a in range(3):
        for i in range(points):
            total = rod.base_position[a]
            for j in range(points):
                total += at.before[i, j] * out.tangent[j, a]
            out.position[i, a] = total
        for k in range(segments):
            total = rod.base_position[a]
            for j in range(points):
                total += at.to_end[k, j] * out.tangent[j, a]
            out.end_position[k, a] = total


@inlined
def _moments(rod: RodArrays, at: Stations, factor: float, reaction: FloatArray, out: Shape) -> None:
    """m(s) = Σ beyond of [moment + (x − h) × force], the reaction's at the tip included."""
    points, segments = at.at.shape[0], rod.kinks.shape[0]
    density = np.empty((points, 3))
    whole, line = np.zeros(3), np.zeros(3)
    for k in range(segments):
        load = rod.end_follower_moment
        given = spatial(out.end_rotation, k, load[k, 0], load[k, 1], load[k, 2])
        lever = crossed(out.end_arm, k, out.end_force, k)
        for a in range(3):
            out.end_moment[k, a] = factor * (rod.end_moment[k, a] + given[a]) + lever[a]
    for i in range(points):
        about = crossed(out.position, i, out.line, i)
        lever = crossed(out.line_arm, i, out.line, i)
        for a in range(3):
            density[i, a] = about[a] + lever[a]
            whole[a] += at.weight[i] * density[i, a]
            line[a] += at.weight[i] * out.line[i, a]
    for i in range(points):
        for a in range(3):
            total = whole[a] + reaction[3 + a]
            for j in range(points):
                total -= at.before[i, j] * density[j, a]
            out.moment[i, a] = total
        about = crossed(out.position, i, out.beyond, i)
        for a in range(3):
            out.moment[i, a] -= about[a]
        here = (out.position[i, 0], out.position[i, 1], out.position[i, 2])
        _add_ends(out, at.segment[i], here, reaction, out.moment, i)
    for a in range(3):
        out.base_moment[0, a] = whole[a] + reaction[3 + a]
    here = (rod.base_position[0], rod.base_position[1], rod.base_position[2])
    about = cross3(here, (line[0], line[1], line[2]))
    for a in range(3):
        out.base_moment[0, a] -= about[a]
    _add_ends(out, 0, here, reaction, out.base_moment, 0)


@inlined
def _add_ends(
    shape: Shape,
    first: int,
    here: tuple[float, float, float],
    reaction: FloatArray,
    out: FloatArray,
    i: int,
) -> None:
    """Add to out[i] the moments about `here` of what acts at segments' ends from `first` on."""
    segments = shape.end_force.shape[0]
    x, F = shape.end_position, shape.end_force
    for k in range(first, segments):
        lever = (x[k, 0] - here[0], x[k, 1] - here[1], x[k, 2] - here[2])
        about = cross3(lever, (F[k, 0], F[k, 1], F[k, 2]))
        for a in range(3):
            out[i, a] += shape.end_moment[k, a] + about[a]
    last = segments - 1
    lever = (x[last, 0] - here[0], x[last, 1] - here[1], x[last, 2] - here[2])
    about = cross3(lever, (reaction[0], reaction[1], reaction[2]))
    for a in range(3):
        out[i, a] += about[a]
