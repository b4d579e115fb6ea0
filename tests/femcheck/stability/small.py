"""Maps that take no time: two panels whose answers are told, not computed."""

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from beamopt.base.processes import in_process
from beamopt.section.drawing import Circle
from femcheck.material.neo_hookean import NeoHookean
from femcheck.stability.axis import Axis, Column
from femcheck.stability.ending import MapEnding
from femcheck.stability.found import AxisFound
from femcheck.stability.solve import CellResult, TraceResult
from femcheck.stability.specimen import Specimen
from femcheck.stability.stability_map import run_map

PRESSURES = (4.0, 8.0, 12.0)
DISC = Specimen(
    shapes=tuple(
        Circle(k + 1, (7 * np.cos(turn), 7 * np.sin(turn)), 3.0)
        for k, turn in enumerate(np.radians([0, 120, 240]).tolist())
    ),
    outer_radius=15.0,
    inner_radius=0.0,
    length=60.0,
    law=NeoHookean(100.0, 0.5),
    layers=2,
    sagitta=0.4,
    size=4.0,
)
"""So soft that it balloons at 30 kPa."""

NOT_A_MESH, DEADLY = 13.0, 66.0  # lengths of specimens that come to nothing


def an_axis(name: str = "length", lengths: Sequence[float] = (60.0, 90.0, 130.0)) -> Axis:
    """Columns that a made-up formula gives a limit of a tenth of their length."""
    columns = tuple(
        Column(
            f"{length:g}",
            replace(DISC, length=length),
            length / 9 if length == 90 else None,
            compare=length == 60,
        )
        for length in lengths
    )
    return Axis(name, name, "H [mm]", "Discs of three lengths.", columns, PRESSURES)


def axes_of(*axes: Axis) -> dict[str, Axis]:
    return {axis.name: axis for axis in axes or (an_axis(), an_axis("other", (NOT_A_MESH, 70.0)))}


def point(load: float, apart: float, unstable: int = 0, length: float = 60.0) -> tuple[float, ...]:
    """Of a track: how far apart the tips are, along x."""
    return (load, 0.1 * load, 0.0, length, apart, 0.0, 0.0, float(unstable))


def told_cell(specimen: Specimen, pressure: float) -> CellResult:
    if specimen.length == NOT_A_MESH:
        return CellResult(MapEnding.NO_MESH, reason="a wall is too thin")
    if specimen.length == DEADLY:
        os._exit(1)
    limit = specimen.length / 10
    beam = (0.3 * pressure, 0.0, specimen.length)
    if pressure > limit:
        return CellResult(MapEnding.LIMIT_POINT, limit, None, beam, None, None, 99, 1000, 1.5)
    tip = (0.1 * pressure, 0.0, specimen.length)
    return CellResult(MapEnding.STABLE, pressure, tip, beam, 1.1, 0, 7, 1000, 0.5)


def told_row(specimen: Specimen, pressures: tuple[float, ...]) -> TraceResult:
    if specimen.length == NOT_A_MESH:
        return TraceResult(MapEnding.NO_MESH, reason="a wall is too thin")
    limit = specimen.length / 10
    loads = [load for load in np.arange(2, 13, 2.0).tolist() if load <= limit]
    track = [(0.0, 0.0, 0.0, 60.0, np.nan, np.nan, np.nan, 0.0)]
    track += [point(load, 0.2 - 0.02 * load, length=specimen.length) for load in loads]
    if limit > pressures[-1]:
        return TraceResult(MapEnding.STABLE, track=tuple(track), triangles=5, layers=2, unknowns=9)
    track.append(point(0.9 * limit, 0.0, unstable=1))
    ends = {"critical": limit, "growth": 3.0, "snaps": (1.5,)}
    return TraceResult(MapEnding.LIMIT_POINT, **ends, track=tuple(track), triangles=5, layers=2)  # type: ignore[arg-type]


def make(folder: Path, **changes: Any) -> list[AxisFound]:
    """A map without figures, in this process, unless told otherwise."""
    asked: dict[str, Any] = {"pool": in_process, "figures": False, "axes": axes_of()} | changes
    return run_map(folder, asked.pop("axes"), **asked)


def kept_files(folder: Path) -> dict[str, bytes]:
    """What must not depend on machine, time or order."""
    left_out = {"timing.csv", "provenance.json", "journal.jsonl"}
    return {f.name: f.read_bytes() for f in sorted(folder.iterdir()) if f.name not in left_out}
