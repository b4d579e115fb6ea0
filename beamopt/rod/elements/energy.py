"""Potential energy of a rod of two-node elements, its gradient and its Hessian.

An element between the frames g_i (turned by the kink between segments) and g_{i+1} has the
constant strain ξ = φ/L_e, φ = log(g_i⁻¹ g_{i+1}), and the energy L_e/2 (ξ − ξ*)·D(ξ − ξ*). The
gradient is by increments x_i = (rotation, translation) of the frames in their own axes,
g_i ← g_i exp(x_i); the symmetric part of its derivative along them is the exact Hessian.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled
from beamopt.rod.elements.group import (
    inverse_tangent,
    logarithm,
    multiply,
    multiply_back,
    skew,
    tangent_slope,
)

__all__ = [
    "Blocks",
    "ElementState",
    "Mesh",
    "add_loads",
    "assemble",
    "measure",
    "potential",
    "pushes",
]


class Mesh(NamedTuple):
    """n elements and n + 1 nodes; node 0 is the base, the last one the tip.

    lengths : (n,) L_e [mm]. stiffness : (n, 6, 6) D. rest : (n, 6) ξ*, all in the order (u, v).
    kinks : (n, 3, 3) rotation from the frame of the node before to the element's own there.
    force : (n + 1, 3) dead, on the axis [mN]. moment : (n + 1, 3) dead [mN·mm].
    offset : (n + 1, 3, 3) Σ F aᵀ of dead forces F that act at a, in the node's axes [mN·mm].
    follower : (n + 1, 6) moment and force in the node's axes [mN·mm, mN].
    held : (2, 6) increments of the base and of the tip that are prescribed.
    length : of the rod [mm].
    symmetric : whether all loads have a potential, so that the Hessian is taken.
    """

    lengths: FloatArray
    stiffness: FloatArray
    rest: FloatArray
    kinks: FloatArray
    force: FloatArray
    moment: FloatArray
    offset: FloatArray
    follower: FloatArray
    held: NDArray[np.bool_]
    length: float
    symmetric: bool


class ElementState(NamedTuple):
    """Frames R (n + 1, 3, 3), h (n + 1, 3); φ and the wrenches (m, n) of the elements, (n, 6) both.

    The wrenches are unknowns of their own on the way; at an equilibrium they are D(ξ − ξ*).
    """

    R: FloatArray
    h: FloatArray
    phi: FloatArray
    wrench: FloatArray


class Blocks(NamedTuple):
    """Block-tridiagonal: (n + 1, 6, 6) diagonal, (n, 6, 6) below it, and above it, transposed."""

    diagonal: FloatArray
    below: FloatArray
    above: FloatArray


@compiled
def measure(mesh: Mesh, state: ElementState) -> None:
    """Bring φ up to date with the frames, on the branch of the logarithm nearest to the old φ."""
    start, R, h, d = np.empty((3, 3)), np.empty((3, 3)), np.empty(3), np.empty(3)
    for e in range(mesh.lengths.size):
        multiply(state.R[e], mesh.kinks[e], start)
        multiply_back(start, state.R[e + 1], R)
        for i in range(3):
            d[i] = state.h[e + 1, i] - state.h[e, i]
        for i in range(3):
            h[i] = start[0, i] * d[0] + start[1, i] * d[1] + start[2, i] * d[2]
        logarithm(R, h, state.phi[e])


@compiled
def pushes(mesh: Mesh, e: int, phi: FloatArray, out: FloatArray) -> None:
    """Write the wrench D(φ/L − ξ*) of an element into `out` (6,)."""
    for i in range(6):
        out[i] = 0.0
        for j in range(6):
            strain = phi[j] / mesh.lengths[e] - mesh.rest[e, j]
            out[i] += mesh.stiffness[e, i, j] * strain


@compiled
def potential(mesh: Mesh, state: ElementState, factor: float) -> float:
    """Elastic energy less `factor` times the work of the dead forces [mN·mm]; φ up to date."""
    wrench = np.empty(6)
    energy = 0.0
    for e in range(mesh.lengths.size):
        pushes(mesh, e, state.phi[e], wrench)
        for i in range(6):
            strain = state.phi[e, i] / mesh.lengths[e] - mesh.rest[e, i]
            energy += mesh.lengths[e] / 2 * strain * wrench[i]
    for k in range(state.h.shape[0]):
        for i in range(3):
            energy -= factor * mesh.force[k, i] * state.h[k, i]
            for j in range(3):
                energy -= factor * mesh.offset[k, i, j] * state.R[k, i, j]
    return energy


@compiled
def tangents(mesh: Mesh, e: int, phi: FloatArray, slope: FloatArray) -> None:
    """∂φ/∂(x_e, x_{e+1}) (6, 12) of an element into `slope`."""
    forth, back = np.empty((6, 6)), np.empty((6, 6))
    inverse_tangent(phi, forth, back)
    for i in range(6):
        for j in range(3):
            left, right = 0.0, 0.0
            for k in range(3):  # Ad of the kink's inverse
                left += back[i, k] * mesh.kinks[e, j, k]
                right += back[i, 3 + k] * mesh.kinks[e, j, k]
            slope[i, j], slope[i, 3 + j] = -left, -right
        for j in range(6):
            slope[i, 6 + j] = forth[i, j]


@compiled
def geometric(mesh: Mesh, e: int, phi: FloatArray, wrench: FloatArray, out: FloatArray) -> None:
    """∂/∂φ of (∂φ/∂x)ᵀ · wrench (12, 6), for a fixed wrench, into `out`."""
    forth, back = np.empty((6, 6)), np.empty((6, 6))
    tangent_slope(phi, wrench, forth, back)
    for j in range(6):
        for i in range(3):
            left, right = 0.0, 0.0
            for k in range(3):
                left += mesh.kinks[e, i, k] * back[k, j]
                right += mesh.kinks[e, i, k] * back[3 + k, j]
            out[i, j], out[3 + i, j] = left, right
        for i in range(6):
            out[6 + i, j] = forth[i, j]


@compiled
def assemble(
    mesh: Mesh, state: ElementState, factor: float, gradient: FloatArray, blocks: Blocks
) -> None:
    """Gradient (n + 1, 6) and its derivative, with the state's wrenches in the geometric part.

    The state's φ has to be up to date. Where loads have a potential, the derivative's symmetric
    part is taken, which is the Hessian.
    """
    slope, stress, wrench = np.empty((6, 12)), np.empty((12, 6)), np.empty(6)
    scaled, whole = np.empty((6, 6)), np.empty((12, 12))
    for node in range(state.h.shape[0]):
        for i in range(6):
            gradient[node, i] = 0.0
            for j in range(6):
                blocks.diagonal[node, i, j] = 0.0
    for e in range(mesh.lengths.size):
        tangents(mesh, e, state.phi[e], slope)
        pushes(mesh, e, state.phi[e], wrench)
        for j in range(6):
            for i in range(6):
                gradient[e, j] += slope[i, j] * wrench[i]
                gradient[e + 1, j] += slope[i, 6 + j] * wrench[i]
        geometric(mesh, e, state.phi[e], state.wrench[e], stress)
        for i in range(6):
            for j in range(6):
                scaled[i, j] = mesh.stiffness[e, i, j] / mesh.lengths[e]
        for i in range(12):
            for j in range(6):
                for k in range(6):
                    stress[i, j] += slope[k, i] * scaled[k, j]
        multiply(stress, slope, whole)
        place(whole, mesh.symmetric, e, blocks)
    add_loads(mesh, state, factor, gradient, blocks)


@compiled
def place(whole: FloatArray, symmetric: bool, e: int, blocks: Blocks) -> None:
    """Add an element's (12, 12) matrix, or its symmetric part, to the blocks."""
    for i in range(12):
        for j in range(12):
            value = (whole[i, j] + whole[j, i]) / 2 if symmetric else whole[i, j]
            if i < 6 and j < 6:
                blocks.diagonal[e, i, j] += value
            elif i < 6:
                blocks.above[e, j - 6, i] = value
            elif j < 6:
                blocks.below[e, i - 6, j] = value
            else:
                blocks.diagonal[e + 1, i - 6, j - 6] += value


@compiled
def add_loads(
    mesh: Mesh, state: ElementState, factor: float, gradient: FloatArray, blocks: Blocks
) -> None:
    """Subtract `factor` times the loads' wrenches and their derivatives.

    Dead forces F at h + R a: wrench (a × n, n), n = Rᵀ F, and ∂n/∂(rotation) = [n]×; with
    N = Rᵀ Σ F aᵀ, Σ [a]× [n]× = N − tr N. Dead moments: m = Rᵀ M. Followers are constant here.
    """
    N, part = np.empty((3, 3)), np.empty((6, 6))
    for node in range(state.h.shape[0]):
        multiply_back(state.R[node], mesh.offset[node], N)
        n, m = np.zeros(3), np.zeros(3)
        for i in range(3):
            for j in range(3):
                n[i] += state.R[node, j, i] * mesh.force[node, j]
                m[i] += state.R[node, j, i] * mesh.moment[node, j]
        couple = (N[2, 1] - N[1, 2], N[0, 2] - N[2, 0], N[1, 0] - N[0, 1])
        for i in range(3):
            gradient[node, i] -= factor * (couple[i] + m[i] + mesh.follower[node, i])
            gradient[node, 3 + i] -= factor * (n[i] + mesh.follower[node, 3 + i])
        for i in range(6):
            for j in range(6):
                part[i, j] = N[i, j] if i < 3 and j < 3 else 0.0
        for i in range(3):
            part[i, i] -= N[0, 0] + N[1, 1] + N[2, 2]
        skew(m, 1.0, part, 0, 0)
        skew(n, 1.0, part, 3, 0)
        for i in range(6):
            for j in range(6):
                value = (part[i, j] + part[j, i]) / 2 if mesh.symmetric else part[i, j]
                blocks.diagonal[node, i, j] -= factor * value
