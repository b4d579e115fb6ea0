"""Following a rod of elements from no loads to all of them, and saying why where that ends."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from beamopt.rod.elements.blocks import substitute
from beamopt.rod.elements.energy import Blocks, ElementState, Mesh, potential
from beamopt.rod.elements.newton import HeldTip, equilibrate, tangent
from beamopt.rod.status import RodStatus

__all__ = ["Lead", "Reached", "attempt", "copied", "fault", "follow", "is_far"]

Lead = Callable[[float], HeldTip]
"""Where the tip is held at a share of the loads."""

SMALLEST_STEP = 2.0**-12  # of the loads; what a critical load is located to
LARGEST_TURN = 0.5
"""[rad] of any node from one equilibrium to the next; more is taken for a jump to another branch.

A rod held at both ends snaps with smaller ones (twice an arch's rise over its half span).
"""
LARGEST_TURN_HELD = 0.1
CRITICAL = 0.2  # of the unloaded rod's smallest eigenvalue
ALIGNED = 0.5  # cos² between the critical mode and the way the path goes on
SWEEPS = 40  # of inverse iteration


class Reached(NamedTuple):
    """How far a path came: the last stable equilibrium, and its share of the loads."""

    status: RodStatus
    state: ElementState
    factor: float
    iterations: int


class Trial(NamedTuple):
    """An attempt at an equilibrium: CONVERGED, BUCKLED, a `fault`, or DIVERGED for all else."""

    status: RodStatus
    state: ElementState
    iterations: int


def copied(state: ElementState) -> ElementState:
    """Arrays of its own."""
    return ElementState(*(part.copy() for part in state))


def attempt(
    mesh: Mesh, start: ElementState, factor: float, target: HeldTip, blocks: Blocks
) -> Trial:
    """One run of Newton's method, judged: a stable equilibrium below `start`, near it, or none.

    Without a potential only divergence is seen, where the tangent's determinant changes its sign:
    neither flutter nor two modes that diverge together.
    """
    state = copied(start)
    converged, iterations, negative = equilibrate(mesh, state, factor, target, blocks)
    status = RodStatus.CONVERGED
    if not converged or is_far(mesh, start, state) or _rises(mesh, start, state, factor):
        status = RodStatus.DIVERGED
    elif fault(state) is not None:
        status = fault(state) or status
    elif negative % 2 == 1 or (mesh.symmetric and negative > 0):
        status = RodStatus.BUCKLED
    return Trial(status, state, iterations)


def follow(
    mesh: Mesh,
    start: ElementState,
    lead: Lead,
    blocks: Blocks,
    most_iterations: float = np.inf,
    deadline: float = np.inf,
) -> Reached:
    """From `start`, in equilibrium without loads, to all loads, in steps as long as they succeed.

    No step begins after so many iterations, or after the deadline of `time.thread_time` [s].
    """
    state, factor, step, successes, iterations = start, 0.0, 1.0, 0, 0
    wrong = fault(start)
    if wrong is not None:
        return Reached(wrong, start, 0.0, 0)
    while factor < 1:
        if iterations >= most_iterations:
            return Reached(RodStatus.WORK_LIMIT, state, factor, iterations)
        if time.thread_time() > deadline:
            return Reached(RodStatus.TOO_SLOW, state, factor, iterations)
        goal = min(factor + step, 1.0)
        trial = attempt(mesh, state, goal, lead(goal), blocks)
        iterations += trial.iterations
        if trial.status is RodStatus.CONVERGED:
            state, factor, successes = trial.state, goal, successes + 1
            step *= 2 if successes > 1 else 1
            continue
        step, successes = step / 2, 0
        if step < SMALLEST_STEP:
            status = _reason(mesh, start, state, factor, trial.status, lead, blocks)
            return Reached(status, state, factor, iterations)
    return Reached(RodStatus.CONVERGED, state, 1.0, iterations)


def fault(state: ElementState) -> RodStatus | None:
    """What is wrong with a shape: no numbers, an element with v3 ≤ 0 or more than a full turn."""
    if not np.all(np.isfinite(state.phi)):
        return RodStatus.DIVERGED
    if np.any(state.phi[:, 5] <= 0):
        return RodStatus.CRUSHED
    if np.any(np.linalg.norm(state.phi[:, :3], axis=1) >= 2 * np.pi):
        return RodStatus.UNRESOLVED
    return None


def is_far(mesh: Mesh, a: ElementState, b: ElementState) -> bool:
    """Whether a node turns too much from one shape to the other for one step between them."""
    largest = LARGEST_TURN_HELD if mesh.held[1].any() else LARGEST_TURN
    cosine = (np.einsum("nij,nij->n", a.R, b.R).min() - 1) / 2
    return not cosine > np.cos(largest)


def _rises(mesh: Mesh, start: ElementState, state: ElementState, factor: float) -> bool:
    """Whether dead forces' potential is higher than where the iteration began.

    A minimum in whose basin `start` lies is lower. Moments, and a tip that is led, do work besides.
    """
    if mesh.moment.any() or mesh.follower.any() or mesh.held[1].any():
        return False
    softest = mesh.stiffness.diagonal(axis1=1, axis2=2)[:, :3].min()
    rounding = 1e-12 * float(softest) / mesh.length
    return potential(mesh, state, factor) > potential(mesh, start, factor) + rounding


def _reason(
    mesh: Mesh,
    start: ElementState,
    state: ElementState,
    factor: float,
    last: RodStatus,
    lead: Lead,
    blocks: Blocks,
) -> RodStatus:
    """Why no step leads on from an equilibrium.

    At a limit point the critical mode is the direction in which the path goes on; at a bifurcation
    the loads do no work with it, and the two are at right angles.
    """
    if last in (RodStatus.CRUSHED, RodStatus.UNRESOLVED):
        return last
    unloaded, _ = _critical(mesh, start, 0.0, lead, blocks)
    eigenvalue, aligned = _critical(mesh, state, factor, lead, blocks)
    if last is RodStatus.BUCKLED or abs(eigenvalue) < CRITICAL * abs(unloaded):
        return RodStatus.LIMIT_POINT if aligned > ALIGNED else RodStatus.BUCKLED
    return RodStatus.DIVERGED if factor == 0 else RodStatus.STEPS_TOO_SMALL


def _critical(
    mesh: Mesh, state: ElementState, factor: float, lead: Lead, blocks: Blocks
) -> tuple[float, float]:
    """The tangent's smallest eigenvalue [mN·mm]; cos² between its mode and the path's direction.

    In the metric Σ |rotation|² + |translation|²/length² of the nodes' increments.
    """
    ahead, here = lead(factor + SMALLEST_STEP), lead(factor)
    values = np.zeros((2, 6))
    values[1, 3:] = state.R[-1].T @ (ahead.h - here.h) / SMALLEST_STEP
    skew = here.R.T @ (ahead.R - here.R) / SMALLEST_STEP
    values[1, :3] = skew[2, 1], skew[0, 2], skew[1, 0]
    onwards = tangent(mesh, state, factor, values, blocks)
    metric = np.repeat([1.0, mesh.length**-2], 3)
    mode = np.random.default_rng(0).normal(size=onwards.shape)
    eigenvalue = np.float64(np.inf)
    with np.errstate(all="ignore"):
        for _ in range(SWEEPS):
            mode = metric * mode / np.sqrt(np.sum(metric * mode**2))
            mode[0, mesh.held[0]] = 0.0
            mode[-1, mesh.held[1]] = 0.0
            weighted = mode.copy()
            substitute(blocks, mode)
            eigenvalue = 1 / np.sum(weighted * mode)
        product = np.sum(metric * mode * onwards) ** 2
        sizes = np.sum(metric * mode**2) * np.sum(metric * onwards**2)
        return float(eigenvalue), float(product / sizes) if sizes > 0 else 0.0
