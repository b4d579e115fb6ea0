"""Balance of moments of a rod in its modes (kernels)."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled, inlined
from beamopt.rod.packed import RodArrays, Stations
from beamopt.rod.rotation import local, rotation_vector
from beamopt.rod.shape import Shape

__all__ = ["reaction_of", "residual_into", "unknown_count"]


@compiled
def unknown_count(rod: RodArrays, at: Stations) -> int:
    """Amplitudes, the hinge's angle, the reaction's parts."""
    held: int = 3 * rod.held_position.shape[0] + 3 * rod.held_rotation.shape[0]
    modes: int = at.basis.shape[1] * rod.free.shape[0]
    hinges: int = rod.hinge.shape[0]
    return modes + hinges + held


@compiled
def reaction_of(rod: RodArrays, at: Stations, unknowns: FloatArray) -> FloatArray:
    """(6,) force and moment in space that hold the tip; 0 where it is free."""
    reaction = np.zeros(6)
    place = at.basis.shape[1] * rod.free.shape[0] + rod.hinge.shape[0]
    first = 0 if rod.held_position.shape[0] == 1 else 3
    for k in range(unknowns.shape[0] - place):
        reaction[first + k] = unknowns[place + k]
    return reaction


@inlined
def residual_into(
    rod: RodArrays,
    at: Stations,
    shape: Shape,
    goal: FloatArray,
    turn: FloatArray,
    reaction: FloatArray,
    out: FloatArray,
) -> None:
    """The derivative of the potential by the unknowns, where there is one.

    For a mode φ of the curvature a: ∫ φ (bending Δu + coupling Rᵀn − Rᵀm)_a ds; for the hinge
    −axis·m(0); for the reactions what is missing to the position `goal` (3,) and to the rotation
    `turn` (3, 3), with a minus.
    """
    points, free = at.at.shape[0], rod.free
    count = free.shape[0]
    modes = at.basis.shape[1]
    out[:] = 0.0
    for i in range(points):
        part = at.segment[i]
        force = local(shape.rotation, i, shape.force[i, 0], shape.force[i, 1], shape.force[i, 2])
        m = local(shape.rotation, i, shape.moment[i, 0], shape.moment[i, 1], shape.moment[i, 2])
        for a in range(count):
            row = free[a]
            value = -m[row]
            for b in range(3):
                value += rod.bending[part, row, b] * shape.bent[i, b]
                value += rod.coupling[part, row, b] * force[b]
            value *= at.weight[i]
            for b in range(modes):
                out[b * count + a] += at.basis[i, b] * value
    place = modes * count
    for k in range(rod.hinge.shape[0]):
        for a in range(3):
            out[place] -= rod.hinge[k, a] * shape.base_moment[0, a]
        place += 1
    last = rod.kinks.shape[0] - 1
    if rod.held_position.shape[0] == 1:
        for a in range(3):
            out[place + a] = goal[a] - shape.end_position[last, a] - rod.give[0] * reaction[a]
        place += 3
    if rod.held_rotation.shape[0] == 1:
        missing = rotation_vector(shape.end_rotation[last] @ np.ascontiguousarray(turn.T))
        for a in range(3):
            out[place + a] = -missing[a] - rod.give[1] * reaction[3 + a]
