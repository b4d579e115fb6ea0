"""Newton's method for the equilibrium of elements at one share of the loads.

The elements' wrenches go along as unknowns of their own, condensed out of every linear system:
only the geometric part of the tangent sees them (the mixed iteration of Magisano, Leonetti & Garcea
2017). So a step that turns a stiff rod does not fight against the stretch which the step itself
makes, and the number of iterations does not depend on how stiff the rod is against stretch, shear
or a penalty. Where it ends it is the plain Newton method.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled
from beamopt.rod.elements.blocks import constrain, eliminate, substitute
from beamopt.rod.elements.energy import (
    Blocks,
    ElementState,
    Mesh,
    assemble,
    measure,
    pushes,
    tangents,
)
from beamopt.rod.elements.group import exponential, logarithm, multiply, multiply_back

__all__ = ["HeldTip", "equilibrate", "tangent", "workspace"]

MOST_ITERATIONS = 30
LARGEST_TURN = 1.0  # rad of a node in one iteration; longer steps are shortened
SMALLEST_STEP = 1e-8  # rad and lengths of the rod: the next step would be about its square
NOISE = 1e-6  # a step below it that is no smaller than the one before is rounding


class HeldTip(NamedTuple):
    """Where the tip is held: R (3, 3), h (3,) [mm]; read only as far as the mesh holds it."""

    R: FloatArray
    h: FloatArray


@compiled
def workspace(nodes: int) -> Blocks:
    """Blocks for a number of nodes."""
    return Blocks(np.zeros((nodes, 6, 6)), np.zeros((nodes - 1, 6, 6)), np.zeros((nodes - 1, 6, 6)))


@compiled
def missing(mesh: Mesh, state: ElementState, target: HeldTip) -> FloatArray:
    """Increments (2, 6) of the base and of the tip that lack to where they are held."""
    values = np.zeros((2, 6))
    last = state.h.shape[0] - 1
    if not (mesh.held[1, 0] or mesh.held[1, 3]):
        return values
    R, h = np.empty((3, 3)), np.zeros(3)
    multiply_back(state.R[last], target.R, R)
    for i in range(3):
        for j in range(3):
            h[i] += state.R[last, j, i] * (target.h[j] - state.h[last, j])
    logarithm(R, h, values[1])
    if not mesh.held[1, 0]:
        for i in range(3):
            values[1, 3 + i] = h[i]
    return values


@compiled
def move(mesh: Mesh, state: ElementState, x: FloatArray, target: HeldTip, whole: bool) -> None:
    """Frames g_i ← g_i exp(x_i); after a whole step what is held is exactly where it should be."""
    R, h, turned = np.empty((3, 3)), np.empty(3), np.empty((3, 3))
    last = state.h.shape[0] - 1
    for node in range(last + 1):
        exponential(x[node], R, h)
        for i in range(3):
            for j in range(3):
                state.h[node, i] += state.R[node, i, j] * h[j]
        multiply(state.R[node], R, turned)
        for i in range(3):
            for j in range(3):
                state.R[node, i, j] = turned[i, j]
    for i in range(3):
        if whole and mesh.held[1, 3 + i]:
            state.h[last, i] = target.h[i]
        for j in range(3):
            if whole and mesh.held[1, i]:
                state.R[last, i, j] = target.R[i, j]


@compiled
def predict_wrenches(mesh: Mesh, state: ElementState, x: FloatArray) -> None:
    """Set wrenches to what the strains' linear change along x would make them."""
    slope, phi = np.empty((6, 12)), np.empty(6)
    for e in range(mesh.lengths.size):
        tangents(mesh, e, state.phi[e], slope)
        for i in range(6):
            phi[i] = state.phi[e, i]
            for j in range(6):
                phi[i] += slope[i, j] * x[e, j] + slope[i, 6 + j] * x[e + 1, j]
        pushes(mesh, e, phi, state.wrench[e])


@compiled
def equilibrate(
    mesh: Mesh, state: ElementState, factor: float, target: HeldTip, blocks: Blocks
) -> tuple[bool, int, int]:
    """Move `state` to an equilibrium at `factor` times the loads.

    Returns
    -------
    Whether it converged, the number of iterations, and of negative pivots of the last tangent.
    """
    x = np.empty((state.h.shape[0], 6))
    negative = 0
    before = np.inf
    for iteration in range(MOST_ITERATIONS):
        measure(mesh, state)
        assemble(mesh, state, factor, x, blocks)
        for node in range(x.shape[0]):
            for i in range(6):
                x[node, i] = -x[node, i]
        constrain(mesh, blocks, x, missing(mesh, state, target))
        negative = eliminate(blocks)
        substitute(blocks, x)
        angle, way = 0.0, 0.0
        for node in range(x.shape[0]):
            for i in range(3):
                angle = max(angle, abs(x[node, i]))
                way = max(way, abs(x[node, 3 + i]))
                if not np.isfinite(x[node, i] + x[node, 3 + i]):
                    return False, iteration + 1, negative
        step = max(angle, way / mesh.length)
        if angle > LARGEST_TURN:
            for node in range(x.shape[0]):
                for i in range(6):
                    x[node, i] *= LARGEST_TURN / angle
        predict_wrenches(mesh, state, x)
        move(mesh, state, x, target, angle <= LARGEST_TURN)
        if step < SMALLEST_STEP or (step < NOISE and step >= before / 4):
            measure(mesh, state)
            for e in range(mesh.lengths.size):
                pushes(mesh, e, state.phi[e], state.wrench[e])
            return True, iteration + 1, negative
        before = step
    return False, MOST_ITERATIONS, negative


@compiled
def tangent(
    mesh: Mesh, state: ElementState, factor: float, values: FloatArray, blocks: Blocks
) -> FloatArray:
    """Increments (n + 1, 6) by the loads' share at an equilibrium, with its tangent's factors.

    values : (2, 6) what is held moves by, per share. blocks : hold the factors afterwards.
    """
    full, none = np.empty((state.h.shape[0], 6)), np.empty((state.h.shape[0], 6))
    assemble(mesh, state, factor + 1, full, blocks)
    assemble(mesh, state, factor, none, blocks)
    for node in range(none.shape[0]):
        for i in range(6):
            none[node, i] -= full[node, i]  # loads are linear in their share
    constrain(mesh, blocks, none, values)
    eliminate(blocks)
    substitute(blocks, none)
    return none
