"""A support for any body: symmetry planes, ties, closing caps and dead loads, all linear.

The nodes follow the unknowns by a constant matrix, x = X + T q. That is all that bodies with a
published answer need: planes that nodes slide on, nodes that share an unknown, and nodes that no
element has, on caps that close a cavity.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from femcheck.assembly.pattern import Pattern, make_pattern, places_in
from femcheck.assembly.reduction import UpperMatrix
from femcheck.assembly.walls import add_wall_forces, add_wall_stiffness, wall_volumes
from femcheck.solid.facets import FacetShape
from femcheck.solid.state import State

__all__ = ["Caps", "FlatPredictor", "LinearSupport", "sliding"]


@dataclass(frozen=True, eq=False)
class Caps:
    """Facets (f, b) that close supply 1's cavity; like those of a wall their normal is into it."""

    facets: IndexArray
    shape: FacetShape


class LinearSupport:
    """x = X + T q.

    Parameters
    ----------
    nodes : (n, 3) undeformed positions X [mm].
    motion : T, sparse (3 n, unknowns).
    caps : what closes the cavity of supply 1, besides the body's walls. Nodes that only caps have
        come last, and have no block row: a pattern has none without an element.
    extra : number of them.
    load : (n, 3) dead nodal forces by unit of supply 1's pressure [mm²]. Then that "pressure" is a
        load factor and its volume Σ load · x, so that potential, forces and arc control agree.
    """

    def __init__(
        self,
        nodes: FloatArray,
        motion: Any,
        caps: Caps | None = None,
        load: FloatArray | None = None,
        extra: int = 0,
    ) -> None:
        self.nodes, self.motion = nodes, motion.tocsr()
        self.blocks: IndexArray = np.arange(len(nodes))
        self.blocks[len(nodes) - extra :] = -1
        self.unknowns = int(motion.shape[1])
        self._caps = caps
        self._load = np.zeros_like(nodes) if load is None else load
        self._columns_map: Any = None

    def prepare(self, pattern: Pattern) -> None:
        """Learn the pattern of the stiffness; caps have one of their own."""
        rows, columns = _entries(pattern)
        if self._caps is not None:
            self._cap_nodes, facets = np.unique(self._caps.facets, return_inverse=True)
            self._cap_blocks = facets.reshape(self._caps.facets.shape)
            self._cap_pattern = make_pattern(self._cap_blocks, np.arange(self._cap_nodes.size))
            self._cap_places = places_in(self._cap_pattern, self._cap_blocks)
            own = (3 * self._cap_nodes[:, None] + np.arange(3)).ravel()
            cap_rows, cap_columns = _entries(self._cap_pattern)
            rows = np.concatenate([rows, own[cap_rows]])
            columns = np.concatenate([columns, own[cap_columns]])
        self._lay_out(rows, columns)

    def rest(self) -> State:
        """The undeformed body; there is no tip plate."""
        return State(self.nodes.copy(), np.zeros(3), np.eye(3))

    def moved(self, state: State, step: FloatArray) -> State:
        """The state after a step of the unknowns and of the hydrostatic pressures behind them."""
        x = state.x + (self.motion @ step[: self.unknowns]).reshape(-1, 3)
        return replace(state, x=x, hydrostatic=state.hydrostatic + step[self.unknowns :])

    def cap_volumes(self, state: State) -> FloatArray:
        """(3,) what the caps enclose with the origin, and what the dead load works on [mm³]."""
        volumes = np.zeros(3)
        if self._caps is not None:
            supply = np.ones(len(self._caps.facets), dtype=np.int64)
            wall_volumes(state.x, self._caps.facets, supply, *self._facet, volumes)
        volumes[0] += float((self._load * state.x).sum())
        return volumes

    def forces(self, state: State, pressures: FloatArray, nodal: FloatArray) -> FloatArray:
        """(unknowns,) Tᵀ of the nodal forces with those of caps and dead load."""
        whole = nodal - pressures[0] * self._load
        if self._caps is not None:
            scale = np.full(len(self._caps.facets), -pressures[0])
            add_wall_forces(state.x, self._caps.facets, scale, *self._facet, whole)
        return np.asarray(self.motion.T @ whole.ravel())

    def stiffness(
        self, state: State, pressures: FloatArray, nodal: FloatArray, data: FloatArray
    ) -> UpperMatrix:
        """The upper triangle of Tᵀ K T; T does not change with the state."""
        if self._caps is not None:
            of_caps = np.zeros(self._cap_pattern.indices.size)
            add_wall_stiffness(
                state.x,
                self._caps.facets,
                np.full(len(self._caps.facets), -pressures[0]),
                *self._facet,
                self._cap_blocks,
                self._cap_places,
                self._cap_pattern.starts,
                of_caps,
            )
            data = np.concatenate([data, of_caps])
        return UpperMatrix(self._starts, self._indices, self._stiffness_map @ data)

    def columns(self, state: State, columns: Any) -> Any:
        """Tᵀ B in a pattern that stays, whatever entries vanish."""
        from scipy.sparse import csr_array

        if self._columns_map is None:
            rows = np.repeat(np.arange(columns.shape[0]), np.diff(columns.indptr))
            entry, at, factor = _expanded(self.motion, rows)
            keys, self._columns_map = _summed(
                at * columns.shape[1] + columns.indices[entry], entry, factor, rows.size
            )
            self._columns_at = _compressed(keys, self.unknowns, columns.shape[1])
        starts, indices = self._columns_at
        shape = (self.unknowns, columns.shape[1])
        return csr_array((self._columns_map @ columns.data, indices, starts), shape=shape)

    def extent(self, step: FloatArray) -> tuple[float, float]:
        """Largest displacement of a component [mm]; nothing turns."""
        return float(np.abs(self.motion @ step[: self.unknowns]).max()), 0.0

    @property
    def _facet(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        assert self._caps is not None
        shape = self._caps.shape
        return shape.values, shape.along, shape.across, shape.weights

    def _lay_out(self, rows: IndexArray, columns: IndexArray) -> None:
        """The map from the entries (rows, columns) of upper triangles to that of Tᵀ K T."""
        entry, a, by_row = _expanded(self.motion, rows)
        pair, b, by_column = _expanded(self.motion, columns[entry])
        entry, a, factor = entry[pair], a[pair], by_row[pair] * by_column
        mirrored = rows[entry] != columns[entry]  # K_JI stands for itself in the lower triangle
        upper, lower = a <= b, mirrored & (b <= a)
        size = self.unknowns
        keys, self._stiffness_map = _summed(
            np.concatenate([(a * size + b)[upper], (b * size + a)[lower]]),
            np.concatenate([entry[upper], entry[lower]]),
            np.concatenate([factor[upper], factor[lower]]),
            rows.size,
        )
        self._starts, self._indices = _compressed(keys, size, size)
        diagonal = self._indices[self._starts[:-1]]
        assert (diagonal == np.arange(size)).all(), "an unknown moves no element's node"


class FlatPredictor:
    """States as vectors: positions and hydrostatic pressures, straight on."""

    def __init__(self, support: LinearSupport) -> None:
        self._rest = support.rest()

    def of(self, state: State) -> FloatArray:
        """The vector of a state."""
        return np.concatenate([state.x.ravel(), state.hydrostatic])

    def state(self, shape: FloatArray) -> State:
        """The state of a vector."""
        x, hydrostatic = np.split(shape, [self._rest.x.size])
        return replace(self._rest, x=x.reshape(-1, 3), hydrostatic=hydrostatic)


def sliding(
    nodes: FloatArray,
    planes: Sequence[tuple[float, FloatArray]],
    near: float,
    held: Sequence[int] | IndexArray = (),
) -> Any:
    """T (3 n, unknowns) of nodes that slide on the planes they lie on, within `near` [mm].

    planes : distance from the origin and unit normal. On two planes a node moves along the line
        where they meet, on three not at all.
    held : nodes that do not move.
    """
    from scipy.sparse import coo_array

    code = np.zeros(len(nodes), dtype=np.int64)
    for k, (distance, normal) in enumerate(planes):
        code |= (np.abs(nodes @ normal - distance) < near).astype(np.int64) << k
    code[np.asarray(held, dtype=np.int64)] = -1
    rows, columns, values, count = [], [], [], 0
    for kind in np.unique(code[code >= 0]):
        normals = np.array([n for k, (_, n) in enumerate(planes) if kind >> k & 1]).reshape(-1, 3)
        _, sizes, axes = np.linalg.svd(np.vstack([normals, np.zeros((3, 3))]))
        free = axes[sizes < 1e-9]
        here = np.flatnonzero(code == kind)
        k = len(free)
        row = 3 * here[:, None, None] + np.arange(3)
        column = count + k * np.arange(here.size)[:, None, None] + np.arange(k)[:, None]
        shape = (here.size, k, 3)
        rows.append(np.broadcast_to(row, shape).ravel())
        columns.append(np.broadcast_to(column, shape).ravel())
        values.append(np.broadcast_to(free, shape).ravel())
        count += k * here.size
    entries, at = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    motion = coo_array((entries, at), shape=(3 * len(nodes), count)).tocsr()
    motion.eliminate_zeros()
    return motion


def _entries(pattern: Pattern) -> tuple[IndexArray, IndexArray]:
    """Row and column of each entry of a pattern."""
    return np.repeat(np.arange(pattern.size), np.diff(pattern.starts)), pattern.indices


def _expanded(motion: Any, rows: IndexArray) -> tuple[IndexArray, IndexArray, FloatArray]:
    """For every entry of T in the rows asked for: which of these, its column, its value."""
    counts = np.diff(motion.indptr)[rows]
    entry = np.repeat(np.arange(rows.size), counts)
    within = np.arange(entry.size) - np.repeat(np.cumsum(counts) - counts, counts)
    at = motion.indptr[rows[entry]] + within
    return entry, motion.indices[at].astype(np.int64), motion.data[at]


def _summed(
    keys: IndexArray, entry: IndexArray, factor: FloatArray, entries: int
) -> tuple[IndexArray, Any]:
    """The keys that occur, ascending, and the matrix that sums factor · data[entry] by key."""
    from scipy.sparse import coo_array

    known, place = np.unique(keys, return_inverse=True)
    return known, coo_array((factor, (place, entry)), shape=(known.size, entries)).tocsr()


def _compressed(keys: IndexArray, rows: int, width: int) -> tuple[IndexArray, IndexArray]:
    """Starts and column indices of sorted keys row · width + column."""
    lengths = np.bincount(keys // width, minlength=rows)
    return np.concatenate([[0], np.cumsum(lengths)]), keys % width
