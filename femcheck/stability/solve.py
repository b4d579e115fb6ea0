"""What processes share: one pressure of one specimen, or its path from rest.

A cell is solved by itself, by load control from rest as a case of a check is; where that finds
nothing the path is followed, which tells a branch from a failure. So what a cell says comes from no
line of the map. Near a limit point every halving of the load step costs Newton's iterations that
fail, so halving stops at a sixteenth of the load, not at a 256th: of the hand-made section at 24,
28 and 36 kPa, above its limit, that takes 12 s in place of 21 on average, and says the same.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray
from femcheck.continuation.path import PathPoint
from femcheck.prediction.answer import read_off
from femcheck.prediction.ray_trace import RayTask, trace_ray
from femcheck.prediction.rays import Ray
from femcheck.solved.case import Case, CaseResult, Solid, solve_case, workshop
from femcheck.stability.ending import MapEnding, ending_of
from femcheck.stability.specimen import Absent, Specimen, beam_tips, solid_of

__all__ = ["TRACK", "CellResult", "TraceResult", "apart_of", "solve_cell", "trace_row"]

ALONE = (1.0, 0.0, 0.0)
SMALLEST_STEP = 1 / 16
STILL = 1e-6  # mm that a beam's tip moves, below which a share says nothing

TRACK = ("load", "x", "y", "z", "apart_x", "apart_y", "apart_z", "unstable")
"""Columns of a track: P [kPa], tip of the solid [mm], its distance from the beam's tip over the
beam's displacement (NaN at rest), unstable directions (−1: not known)."""


@dataclass(frozen=True, slots=True)
class CellResult:
    """How one pressure of one specimen ended.

    reached : largest pressure known to have a stable equilibrium [kPa].
    tip : of the solid, from the base's material centroid [mm]; None without an equilibrium.
    beam : the beam's [mm]; None without a mesh.
    stretch : largest principal stretch at a quadrature point; None without an equilibrium.
    unstable : directions in which the equilibrium is unstable; None: not known, or no equilibrium.
    reason : why there is no solid, else "".
    """

    ending: MapEnding
    reached: float = 0.0
    tip: tuple[float, float, float] | None = None
    beam: tuple[float, float, float] | None = None
    stretch: float | None = None
    unstable: int | None = None
    iterations: int = 0
    unknowns: int = 0
    seconds: float = 0.0
    reason: str = ""


@dataclass(frozen=True, slots=True)
class TraceResult:
    """The equilibria of a specimen from rest.

    ending : STABLE where every pressure of the row has a stable equilibrium, else what ended them.
    critical : pressure at which they end [kPa]; None where they do not, or nothing is known.
    growth : volume of the chamber over that at rest where they end; None where they do not.
    snaps : pressures at which the solid jumps to another stable shape [kPa].
    track : points, see `TRACK`, in the order of the path.
    triangles, layers, unknowns : of the mesh.
    """

    ending: MapEnding
    critical: float | None = None
    growth: float | None = None
    snaps: tuple[float, ...] = ()
    track: tuple[tuple[float, ...], ...] = ()
    triangles: int = 0
    layers: int = 0
    iterations: int = 0
    unknowns: int = 0
    seconds: float = 0.0
    reason: str = ""


def solve_cell(specimen: Specimen, pressure: float) -> CellResult:
    """Look for the equilibrium at a pressure [kPa] of supply 1; whatever happens, a result."""
    began = time.perf_counter()
    solid = solid_of(specimen)
    if isinstance(solid, Absent):
        return CellResult(solid.ending, reason=solid.reason)
    pressures = pressure * np.array(ALONE)
    found = solve_case(Case(solid, pressures, None, None, smallest=SMALLEST_STEP))
    outcome = found.outcome
    unstable = None if outcome.state is None else outcome.negative_eigenvalues
    tip, stretch = _shown(solid, found, pressure)
    return CellResult(
        ending=ending_of(outcome.status, unstable),
        reached=pressure * outcome.reached,
        tip=tip,
        beam=_triple(beam_tips(specimen, solid, np.array([pressure]))[0]),
        stretch=stretch,
        unstable=unstable,
        iterations=outcome.statistics.iterations,
        unknowns=workshop(solid).problem.unknowns,
        seconds=time.perf_counter() - began,
    )


def _shown(
    solid: Solid, found: CaseResult, pressure: float
) -> tuple[tuple[float, float, float] | None, float | None]:
    """Tip from the base's material centroid [mm], and the largest stretch."""
    state = found.outcome.state
    if state is None:
        return None, None
    shop = workshop(solid)
    answer = read_off(shop.problem, shop.shapes, PathPoint(state, pressure, 0.0, 0.0, None))
    return _triple(state.tip - np.append(solid.section.moments.centroid, 0.0)), answer.stretch


def trace_row(specimen: Specimen, pressures: tuple[float, ...]) -> TraceResult:
    """Follow the equilibria from rest through all pressures [kPa], or to where they end."""
    began = time.perf_counter()
    solid = solid_of(specimen)
    if isinstance(solid, Absent):
        return TraceResult(solid.ending, reason=solid.reason)
    found = trace_ray(RayTask(solid, Ray(ALONE, pressures)))
    unstable = None if (found.track[:, 7] < 0).any() else 0
    has_end = bool(np.isfinite(found.critical))
    return TraceResult(
        ending=ending_of(found.status, unstable),
        critical=found.critical if has_end else None,
        growth=found.growth if has_end else None,
        snaps=tuple(found.snaps),
        track=_track(specimen, solid, found.track),
        triangles=len(solid.section.triangles),
        layers=specimen.layers,
        iterations=found.statistics.iterations,
        unknowns=workshop(solid).problem.unknowns,
        seconds=time.perf_counter() - began,
    )


def _track(specimen: Specimen, solid: Solid, track: FloatArray) -> tuple[tuple[float, ...], ...]:
    loads, tips, unstable = track[:, 0], track[:, 4:7], track[:, 7]
    apart = apart_of(tips, beam_tips(specimen, solid, loads), specimen.length)
    rows = np.column_stack([loads, tips, apart, unstable])
    return tuple(tuple(row) for row in rows.tolist())


def apart_of(tips: FloatArray, beam: FloatArray, length: float) -> FloatArray:
    """(n, 3) way from the beam's tips to the solid's (n, 3) over the beam's displacement.

    NaN where the beam's tip does not move.
    """
    moved = np.linalg.norm(beam - np.array([0.0, 0.0, length]), axis=1)[:, None]
    apart = (tips - beam) / np.maximum(moved, STILL)
    return np.asarray(np.where(moved > STILL, apart, np.nan))


def _triple(values: FloatArray) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in values)
    return x, y, z
