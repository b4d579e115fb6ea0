"""What the search needs to know of many sections at once: moments and neighbour counts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray, IndexArray, LabelArray
from beamopt.base.compiled import compiled
from beamopt.section.cell_owners import cell_owners
from beamopt.section.counting import Counts, counts_for, take_counts
from beamopt.section.delaunay import delaunay_edges
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import Domain, PolarGrid
from beamopt.section.moments import Moments, sum_and_find_runs
from beamopt.section.neighbours import count_edges, neighbour_ratio
from beamopt.section.raster import Tiling, nearest_types, tiling
from beamopt.section.runs import Runs, room_for_runs
from beamopt.section.saint_venant import SaintVenant
from beamopt.section.seal import UNSEALED, SealRules
from beamopt.section.seal_table import SealArrays, SealTable, seal_table, work
from beamopt.section.sealing import sealed_cells
from beamopt.section.symmetry import Symmetry
from beamopt.section.walls import add_walls, wall_steps

__all__ = ["Phenotypes", "phenotypes"]


@dataclass(frozen=True, eq=False)
class Phenotypes:
    """Measures of n sections.

    moments : Moments with one leading axis (n,).
    neighbour_ratio : (n,) edges between different types over edges between equal ones.
    labels : (n, radial, angular) types of elements, where they were asked for; else (1, …).
    chambers : (n, 3) separate chambers of each supply, where they were asked for; else (0, 3).
    asymmetry : (n,) share of the area that is not symmetric, where asked for; else (0,).
    saint_venant : torsion and shear of each, where they are not to be the raster's; else none.
    """

    moments: Moments
    neighbour_ratio: FloatArray
    labels: LabelArray
    chambers: IndexArray = field(default_factory=lambda: np.zeros((0, 3), dtype=np.int64))
    asymmetry: FloatArray = field(default_factory=lambda: np.zeros(0))
    saint_venant: tuple[SaintVenant, ...] = ()


def phenotypes(
    grid: PolarGrid,
    candidates: Sequence[FeaturePoints],
    wall_elements: int,
    rules: SealRules = UNSEALED,
    keep_labels: bool = False,
    count_chambers: bool = False,
    symmetry: Symmetry | None = None,
) -> Phenotypes:
    """Rasterise, wall, seal and measure every candidate; the same numbers as one by one.

    keep_labels, count_chambers, symmetry : ask for labels, chambers and asymmetry.
    """
    ends = np.cumsum([0] + [len(points) for points in candidates])
    raw = np.zeros((len(candidates), 4, 6))
    edges = np.zeros((len(candidates), 2))
    kept = np.zeros((len(candidates) if keep_labels else 1, *grid.shape), dtype=np.uint8)
    counts = counts_for(grid, len(candidates), count_chambers, symmetry)
    if candidates:
        x, y, types = (
            np.concatenate([getattr(points, name) for points in candidates])
            for name in ("x", "y", "type")
        )
        steps, tiles = wall_steps(wall_elements, rules), tiling(grid)
        integrals, runs = (grid.radial_integrals, grid.angular_integrals), room_for_runs(grid)
        if rules == UNSEALED:
            about = grid.domain, tiles, steps, grid.is_full_ring, *integrals
            _measure(x, y, types, ends, *about, raw, edges, kept, runs, counts)
        else:
            table = seal_table(grid, rules)
            space = work(grid, table)
            about_seal = grid.domain, tiles, steps, table, space, *integrals
            _measure_sealed(x, y, types, ends, *about_seal, raw, edges, kept, runs, counts)
    ratios = neighbour_ratio(edges[:, 0], edges[:, 1])
    return Phenotypes(Moments(raw), ratios, kept, counts.chambers, counts.asymmetry)


@compiled
def _with_cells(
    x: FloatArray, y: FloatArray, types: LabelArray, begin: int, end: int, domain: Domain
) -> tuple[FloatArray, FloatArray, LabelArray]:
    """Places and types of one candidate's feature points that have a cell."""
    px, py, kinds = x[begin:end], y[begin:end], types[begin:end]
    own = cell_owners(px, py, domain)
    if own.size == px.size:
        return px, py, kinds
    return px[own], py[own], kinds[own]


@compiled
def _measure(
    x: FloatArray,
    y: FloatArray,
    types: LabelArray,
    ends: NDArray[np.int64],
    domain: Domain,
    tiles: Tiling,
    wall_steps: int,
    periodic: bool,
    radial: FloatArray,
    angular: FloatArray,
    raw: FloatArray,
    edges: FloatArray,
    kept: LabelArray,
    runs: Runs,
    counts: Counts,
) -> None:
    for k in range(raw.shape[0]):
        px, py, kinds = _with_cells(x, y, types, ends[k], ends[k + 1], domain)
        labels = kept[k if kept.shape[0] > 1 else 0]
        labels[:] = 0
        nearest_types(px, py, kinds, tiles, labels)
        add_walls(labels, wall_steps, periodic)
        sum_and_find_runs(labels, runs, radial, angular, raw[k])
        take_counts(labels, runs, periodic, k, counts)
        edges[k] = count_edges(delaunay_edges(px, py), kinds)


@compiled
def _measure_sealed(
    x: FloatArray,
    y: FloatArray,
    types: LabelArray,
    ends: NDArray[np.int64],
    domain: Domain,
    tiles: Tiling,
    wall_steps: int,
    table: SealTable,
    space: SealArrays,
    radial: FloatArray,
    angular: FloatArray,
    raw: FloatArray,
    edges: FloatArray,
    kept: LabelArray,
    runs: Runs,
    counts: Counts,
) -> None:
    for k in range(raw.shape[0]):
        px, py, kinds = _with_cells(x, y, types, ends[k], ends[k + 1], domain)
        labels = kept[k if kept.shape[0] > 1 else 0]
        sealed_cells(px, py, kinds, tiles, wall_steps, table, space, labels)
        sum_and_find_runs(labels, runs, radial, angular, raw[k])
        take_counts(labels, runs, table.periodic, k, counts)
        edges[k] = count_edges(delaunay_edges(px, py), kinds)
