"""Geometrically exact two-node finite elements on SE(3), as a method for loaded rods."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.rod.elements.energy import ElementState, Mesh
from beamopt.rod.elements.group import exponential, logarithm
from beamopt.rod.elements.mesh import at_rest, meshed
from beamopt.rod.elements.newton import HeldTip, workspace
from beamopt.rod.elements.path import Lead, Reached, attempt, fault, follow, is_far
from beamopt.rod.rod import Rod
from beamopt.rod.solution import RodSolution
from beamopt.rod.status import RodStatus

__all__ = ["Elements"]


@dataclass(frozen=True)
class Elements:
    """Elements of constant strain between frames, at a minimum of the potential energy.

    Nodes carry frames, an element's strain is the logarithm of the motion between its two over its
    length (Sonneville, Cardona & Brüls 2014), so that arcs and helices are exact. What a section
    does not allow (curvatures that are not free, a zero compliance) is a stiff spring: the method's
    error besides that of the elements, of the relative size 1/penalty in strains. Loads along a
    segment are lumped at nodes. The tips' error is of second order in the elements' length.

    An equilibrium counts if the tangent has no negative eigenvalue; without a potential, if its
    determinant is positive (divergence is seen, flutter is not). It is led there from the unloaded
    rod, which therefore has to be in stable equilibrium itself: no pendulum that first swings down.

    Parameters
    ----------
    penalty : times the natural stiffness, the largest EI for curvatures and EI/length² for v.
    most_iterations : of a case, after which no step begins; infinite by default.
    seconds : of processor time that a case may take; infinite by default.
    estimates : whether the error is estimated with half the elements, for half the time more.
    resolutions : numbers of elements in all, from coarse to fine.
    """

    penalty: float = 1e8
    most_iterations: float = np.inf
    seconds: float = np.inf
    estimates: bool = False
    resolutions: Sequence[int] = (4, 8, 16, 32, 64, 128, 256)

    @property
    def name(self) -> str:
        """One word for tables and figures."""
        return "elements"

    def solve(self, rod: Rod, rest: FloatArray, resolution: int) -> RodSolution:
        """Solve for the rest strains (n, segments, 6) of n cases.

        One after the other, each from the equilibrium of the one before if that is not far, or
        from the unloaded rod. resolution : elements in all, at least one a segment.
        """
        if not all(np.isfinite(one.law.bending).all() for one in rod.segments):
            return RodSolution.unsolved(len(rest), RodStatus.NOT_REPRESENTABLE, rod.length)
        mesh = meshed(rod, resolution, self.penalty)
        reached = self._cases(rod, mesh, rest)
        solution = _solution(mesh, reached)
        if not self.estimates or resolution < 2 * len(rod.segments):
            return solution
        half = meshed(rod, resolution // 2, self.penalty)
        coarse = _solution(half, self._cases(rod, half, rest))
        ratio = mesh.lengths.size / half.lengths.size
        error = np.linalg.norm(solution.tips - coarse.tips, axis=-1) / (ratio**2 - 1)
        return replace(solution, error=error)

    def _cases(self, rod: Rod, mesh: Mesh, rest: FloatArray) -> list[Reached]:
        """The cases, one after the other."""
        owner = _owners(rod, mesh)
        blocks = workspace(mesh.lengths.size + 1)
        reached: list[Reached] = []
        before: ElementState | None = None
        for strains in rest:
            deadline = time.thread_time() + self.seconds
            case = mesh._replace(rest=np.ascontiguousarray(strains[owner], dtype=np.float64))
            start = at_rest(rod, case)
            if not rod.is_loaded:
                reached.append(_unloaded(start))
                continue
            lead = _lead(rod, start)
            iterations = 0
            near = before is not None and not is_far(case, before, start)
            before = start
            if near and reached[-1].status is RodStatus.CONVERGED:
                trial = attempt(case, reached[-1].state, 1.0, lead(1.0), blocks)
                iterations = trial.iterations
                if trial.status is RodStatus.CONVERGED:
                    reached.append(Reached(trial.status, trial.state, 1.0, iterations))
                    continue
            found = follow(case, start, lead, blocks, self.most_iterations, deadline)
            reached.append(found._replace(iterations=found.iterations + iterations))
        return reached


def _owners(rod: Rod, mesh: Mesh) -> IndexArray:
    """(elements,) number of the segment each belongs to."""
    middles = np.cumsum(mesh.lengths) - mesh.lengths / 2
    ends = np.cumsum([one.length for one in rod.segments])
    return np.asarray(np.searchsorted(ends, middles), dtype=np.int64)


def _unloaded(start: ElementState) -> Reached:
    status = fault(start)
    if status is None or status is RodStatus.UNRESOLVED:  # an arc is exact however far it turns
        status = RodStatus.CONVERGED
    return Reached(status, start, float(status is RodStatus.CONVERGED), 0)


def _lead(rod: Rod, start: ElementState) -> Lead:
    """The tip's way from where it is without loads to where it is held, even and straight."""
    position, rotation = rod.tip.position, rod.tip.rotation
    R, h = start.R[-1], start.h[-1]
    way = np.zeros(3) if position is None else position - h
    turn = np.zeros(6)
    if rotation is not None:
        logarithm(np.ascontiguousarray(R.T @ rotation), np.zeros(3), turn)

    def lead(factor: float) -> HeldTip:
        turned = np.empty((3, 3))
        exponential(factor * turn, turned, np.empty(3))
        return HeldTip(R @ turned, h + factor * way)

    return lead


def _solution(mesh: Mesh, reached: Sequence[Reached]) -> RodSolution:
    n, nodes = len(reached), mesh.lengths.size + 1
    R, h = np.full((n, nodes, 3, 3), np.nan), np.full((n, nodes, 3), np.nan)
    for k, one in enumerate(reached):
        if one.status is RodStatus.CONVERGED:
            R[k], h[k] = one.state.R, one.state.h
    return RodSolution(
        status=tuple(one.status for one in reached),
        tips=h[:, -1],
        rotations=R[:, -1],
        factor=np.array([one.factor for one in reached]),
        error=np.full(n, np.nan),
        iterations=np.array([one.iterations for one in reached], dtype=np.int64),
        stations=np.concatenate([[0.0], np.cumsum(mesh.lengths)]),
        centrelines=h,
    )
