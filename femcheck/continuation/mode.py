"""The motion by which an equilibrium is lost: where it is, and how local."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray
from femcheck.continuation.direct import DirectSolver, SingularMatrixError
from femcheck.solid.equilibrium import Equilibrium
from femcheck.solid.state import State

__all__ = ["LOCAL", "Mode", "unstable_mode"]

LOCAL = 0.05  # share of the nodes: below it a crease, above it a motion of the whole


@dataclass(frozen=True, eq=False)
class Mode:
    """Where an unstable motion is.

    place : (3,) undeformed place of the node that moves most [mm].
    share : of the nodes that take part, (Σ|v|²)² / (n Σ|v|⁴): one over their number for a motion of
        one node, 1 for a motion of all alike.
    """

    place: FloatArray
    share: float


def unstable_mode(
    problem: Equilibrium, state: State, pressures: FloatArray, solver: DirectSolver
) -> Mode | None:
    """The motion whose stiffness has just become negative; None if none is found.

    Lanczos on the compliance (the inverse of the tangent, seen from the unknowns that move nodes),
    whose negative eigenvalues are the unstable motions whatever else the tangent has; the most
    negative one is the softest of them.
    """
    from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

    try:
        solver.factor(problem.tangent(state, pressures, problem.forces(state, pressures)))
        count, size = problem.support.unknowns, problem.unknowns

        def compliance(force: FloatArray) -> FloatArray:
            right = np.zeros(size)
            right[:count] = force.ravel()
            return solver.solve(right)[:count]

        operator: Any = LinearOperator((count, count), matvec=compliance, dtype=np.float64)
        start = np.random.default_rng(0).normal(size=count)
        values, vectors = eigsh(operator, k=1, which="SA", v0=start, tol=1e-3, maxiter=60)
    except (SingularMatrixError, ArpackError):
        return None
    if not values[0] < 0:
        return None
    step = np.zeros(size)
    step[:count] = vectors[:, 0]
    small = 1e-4 / max(problem.support.extent(step)[0], 1e-300)
    square = ((problem.moved(state, small * step).x - state.x) ** 2).sum(axis=1)
    share = float(square.sum() ** 2 / (square.size * (square**2).sum()))
    return Mode(problem.body.nodes[int(np.argmax(square))].copy(), share)
