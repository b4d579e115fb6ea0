"""A rod as a mesh of two-node elements: lengths, stiffness with penalties, loads on nodes."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.rod.elements.energy import ElementState, Mesh
from beamopt.rod.elements.group import exponential
from beamopt.rod.law import SectionLaw, cross
from beamopt.rod.rod import Rod

__all__ = ["at_rest", "elements_by_segment", "meshed", "stiffness"]


def elements_by_segment(rod: Rod, elements: int) -> IndexArray:
    """(segments,) numbers of elements, at least one each, shared by length: the longest first."""
    lengths = np.array([segment.length for segment in rod.segments])
    numbers = np.ones(lengths.size, dtype=np.int64)
    for _ in range(elements - lengths.size):
        numbers[np.argmax(lengths / numbers)] += 1
    return numbers


def stiffness(law: SectionLaw, penalty: float, bending: float, length: float) -> FloatArray:
    """D (6, 6) = [[J, S], [Sᵀ, K]] of a law, with springs where it is rigid.

    K = compliance⁻¹, S = coupling K, J = bending + S K⁻¹ Sᵀ. Rigid curvatures get the stiffness
    penalty · `bending` [mN·mm²], rigid directions of v penalty · bending/length² [mN].
    """
    free = list(law.free)
    J = penalty * bending * np.eye(3)
    J[np.ix_(free, free)] = law.bending[np.ix_(free, free)]
    values, axes = np.linalg.eigh(law.compliance)
    rigid = values <= 1e-14 * max(values[-1], 0.0)
    springs = np.where(rigid, penalty * bending / length**2, 1 / np.where(rigid, 1.0, values))
    K = (axes * springs) @ axes.T
    coupling = np.zeros((3, 3))
    coupling[free] = law.coupling[free]
    S = coupling @ K
    D = np.block([[J + S @ coupling.T, S], [S.T, K]])
    return np.asarray((D + D.T) / 2)


def meshed(rod: Rod, elements: int, penalty: float) -> Mesh:
    """The mesh of a rod; its rest strains are the rod's own until replaced.

    Loads along a segment are lumped at nodes, half of an element's at each of its ends.
    """
    numbers = elements_by_segment(rod, elements)
    n = int(numbers.sum())
    owner = np.repeat(np.arange(numbers.size), numbers)
    first = np.concatenate([[0], np.cumsum(numbers)])
    lengths = np.array([rod.segments[k].length / numbers[k] for k in owner])
    bending = _natural_bending(rod)
    D = np.array([stiffness(one.law, penalty, bending, rod.length) for one in rod.segments])
    kinks = np.tile(np.eye(3), (n, 1, 1))
    kinks[first[:-1]] = [segment.kink for segment in rod.segments]
    kinks[0] = _base_frame(rod).T @ rod.base.rotation @ kinks[0]
    loads = _Loads(n + 1)
    for segment, (start, stop) in zip(rod.segments, pairwise(first), strict=True):
        line, end = segment.line, segment.end
        for e in range(start, stop):
            half = lengths[e] / 2
            loads.add(e, half * line.force, half * line.follower_force, line.at, kinks[e])
            loads.add(e + 1, half * line.force, half * line.follower_force, line.at, np.eye(3))
        loads.add(stop, end.force, end.follower_force, end.at, np.eye(3))
        loads.moment[stop] += end.moment
        loads.follower[stop, :3] += end.follower_moment
    return Mesh(
        *(lengths, D[owner], rod.rest[owner], kinks),
        *(loads.force, loads.moment, loads.offset, loads.follower),
        held=_held(rod),
        length=rod.length,
        symmetric=rod.is_conservative,
    )


def at_rest(rod: Rod, mesh: Mesh) -> ElementState:
    """The rod without loads: all elements at their rest strains."""
    n = mesh.lengths.size
    R, h = np.empty((n + 1, 3, 3)), np.empty((n + 1, 3))
    R[0], h[0] = _base_frame(rod), rod.base.position
    phi = mesh.lengths[:, None] * mesh.rest
    turned, moved = np.empty((3, 3)), np.empty(3)
    for e in range(n):
        exponential(phi[e], turned, moved)
        start = R[e] @ mesh.kinks[e]
        R[e + 1], h[e + 1] = start @ turned, h[e] + start @ moved
    return ElementState(R, h, phi, np.zeros((n, 6)))


def _natural_bending(rod: Rod) -> float:
    """The largest bending stiffness [mN·mm²], the measure of penalties."""
    values = [
        float(segment.law.bending[k, k]) for segment in rod.segments for k in segment.law.free
    ]
    return max(values, default=1.0)


def _base_frame(rod: Rod) -> FloatArray:
    """Frame (3, 3) of node 0: the base's, unless a hinge asks for its axis in the first place."""
    if not len(rod.base.hinges):
        return rod.base.rotation
    frame, _ = np.linalg.qr(np.column_stack([rod.base.hinges[0], np.eye(3)]))
    return np.asarray(frame * np.linalg.det(frame))


def _held(rod: Rod) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """(2, 6) increments of the base and the tip that are not free, in their frames' axes."""
    held = np.zeros((2, 6), dtype=np.bool_)
    held[0] = True
    held[0, : len(rod.base.hinges)] = False
    held[1, :3] = rod.tip.rotation is not None
    held[1, 3:] = rod.tip.position is not None
    return held


class _Loads:
    """Loads gathered on nodes, in the mesh's form."""

    def __init__(self, nodes: int) -> None:
        self.force = np.zeros((nodes, 3))
        self.moment = np.zeros((nodes, 3))
        self.offset = np.zeros((nodes, 3, 3))
        self.follower = np.zeros((nodes, 6))

    def add(
        self,
        node: int,
        force: FloatArray,
        follower: FloatArray,
        at: FloatArray,
        kink: FloatArray,
    ) -> None:
        """A dead and a follower force at `at`, in axes that `kink` turns the node's to."""
        arm = kink @ at
        self.force[node] += force
        self.offset[node] += np.outer(force, arm)
        self.follower[node, :3] += cross(arm) @ kink @ follower
        self.follower[node, 3:] += kink @ follower
