"""An outline as a gmsh script: its vertices kept, sizes that follow walls and short edges."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.outline.outline import Loop, Outline
from beamopt.outline.ring import USUAL_RADIUS
from femcheck.mesh.wall_thickness import thickness_behind

__all__ = ["SectionSizes", "geo_script", "least_triangles"]


@dataclass(frozen=True, slots=True)
class SectionSizes:
    """How fine a section is meshed.

    factor : multiplies all sizes; below 1 is finer.
    largest : triangles away from walls, in a section of 25 mm outer radius [mm].
    per_wall : edge length over the thickness of the wall behind it.
    growth : of the size with the distance from an edge.

    Examples
    --------
    >>> import femcheck
    >>> femcheck.SectionSizes(factor=2.0).largest
    5.0
    """

    factor: float = 1.0
    largest: float = 5.0
    per_wall: float = 2.5
    growth: float = 1.5


def geo_script(outline: Outline, sizes: SectionSizes) -> str:
    """The script; physical groups: the material is 10, the free edges 1, supply i's edges i + 1."""
    loops = [loop for piece in outline.pieces for loop in piece.loops]
    a, lengths, parts = _edges(loops, outline.outer_radius, sizes)
    largest = sizes.largest * outline.outer_radius / USUAL_RADIUS
    lines = [
        *_settings(sizes.factor * largest),
        *(f"Point({k}) = {{{x!r}, {y!r}, 0}};" for k, (x, y) in enumerate(a.tolist(), 1)),
        *_curves(loops, parts),
        *_surfaces(outline),
        *_size_fields(lengths / parts, sizes),
    ]
    return "\n".join(lines) + "\n"


def _edges(
    loops: list[Loop], outer_radius: float, sizes: SectionSizes
) -> tuple[FloatArray, FloatArray, IndexArray]:
    """Starts (n, 2), lengths (n,) of all edges, and parts (n,) that each is cut into."""
    a = np.concatenate([loop.points for loop in loops])
    b = np.concatenate([np.roll(loop.points, -1, axis=0) for loop in loops])
    lengths = np.hypot(*(b - a).T)
    walls = thickness_behind(a, b)
    largest = sizes.largest * outer_radius / USUAL_RADIUS
    longest = sizes.factor * np.minimum(sizes.per_wall * walls, largest)
    parts = np.maximum(np.ceil(lengths / longest - 0.01), 1)
    return a, lengths, parts.astype(np.int64)


def least_triangles(outline: Outline, sizes: SectionSizes) -> int:
    """Triangles that a mesh has at least: one at each part of an edge, the largest elsewhere."""
    loops = [loop for piece in outline.pieces for loop in piece.loops]
    _, _, parts = _edges(loops, outline.outer_radius, sizes)
    side = sizes.factor * sizes.largest * outline.outer_radius / USUAL_RADIUS
    equilateral = np.sqrt(3) / 4 * side**2
    return int(max(parts.sum(), outline.moments.area / equilateral))


def _settings(largest: float) -> Iterator[str]:
    yield "General.NumThreads = 1;"
    yield "Mesh.Algorithm = 5;"  # Delaunay: the one that size fields suit best
    yield "Mesh.MeshSizeExtendFromBoundary = 0;"
    yield "Mesh.MeshSizeFromPoints = 0;"
    yield f"Mesh.MeshSizeMax = {largest!r};"
    yield "Mesh.SaveAll = 0;"


def _curves(loops: list[Loop], parts: IndexArray) -> Iterator[str]:
    """Every edge a line of its own, cut into equal parts; loops and physical groups of lines."""
    first, groups = 1, dict[int, list[str]]()
    for number, loop in enumerate(loops, 1):
        n = len(loop.points)
        names = [str(first + k) for k in range(n)]
        for k in range(n):
            yield f"Line({first + k}) = {{{first + k}, {first + (k + 1) % n}}};"
            yield f"Transfinite Curve {{{first + k}}} = {parts[first + k - 1] + 1};"
        yield f"Curve Loop({number}) = {{{', '.join(names)}}};"
        groups.setdefault(loop.supply, []).extend(names)
        first += n
    for supply, names in sorted(groups.items()):
        yield f"Physical Curve({supply + 1}) = {{{', '.join(names)}}};"


def _surfaces(outline: Outline) -> Iterator[str]:
    loop = 1
    for number, piece in enumerate(outline.pieces, 1):
        names = range(loop, loop + len(piece.loops))
        yield f"Plane Surface({number}) = {{{', '.join(map(str, names))}}};"
        loop += len(piece.loops)
    yield f"Physical Surface(10) = {{{', '.join(map(str, range(1, len(outline.pieces) + 1)))}}};"


def _size_fields(lengths: FloatArray, sizes: SectionSizes) -> Iterator[str]:
    """Sizes grow from each edge; edges of similar length share a field."""
    octave = np.floor(np.log2(lengths)).astype(np.int64)
    fields = []
    for number, value in enumerate(np.unique(octave).tolist()):
        near, size = 2 * number + 1, 2 * number + 2
        chosen = np.flatnonzero(octave == value) + 1
        typical = float(np.median(lengths[octave == value]))
        yield f"Field[{near}] = Distance;"
        yield f"Field[{near}].CurvesList = {{{', '.join(map(str, chosen.tolist()))}}};"
        yield f"Field[{near}].Sampling = 3;"
        yield f"Field[{size}] = MathEval;"
        yield f'Field[{size}].F = "{typical!r} + {sizes.growth!r} * F{near}";'
        fields.append(str(size))
    last = 2 * len(fields) + 1
    yield f"Field[{last}] = Min;"
    yield f"Field[{last}].FieldsList = {{{', '.join(fields)}}};"
    yield f"Background Field = {last};"
