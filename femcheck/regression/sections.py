"""What is held of a section, before any rod: integrals, faults, response, loads, torsion."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.scene.design import Design
from beamopt.section.moments import Moments
from femcheck.models.beam import on_grid
from femcheck.regression.held import Held, Row, columns, rounding
from femcheck.regression.held_design import HeldDesign

__all__ = ["GRIDS", "held_moments", "held_sections"]

GRIDS = ((128, 360), (64, 180))
"""Rasters, radial × angular."""

SUPPLIES = ("supply 1", "supply 2", "supply 3")
OF_TRIANGLES = 1e-3, "other triangles of the same outline: 1e-03 of the value"
OF_STRANDS = 1e-7, "the linear system of the warping, solved to rounding: 1e-07 of the value"


def held_sections(held: HeldDesign) -> Iterator[Held]:
    """Rungs "section", "outline", "response", "loads" and "torsion", as far as it has them."""
    design = held.design
    radius = design.grid.outer_radius
    for radial, angular in GRIDS:
        moments = on_grid(design, radial, angular).section.moments
        yield from held_moments("section", f"{radial}×{angular}", moments, radius)
    if design.seal.rules.sealed:
        yield from held_moments("outline", "", design.outline.moments, radius)
    if not design.loaded_rod.loads.any:
        counts = Counter(fault.status.name for fault in design.outline.faults)
        rows: dict[str, Row] = {kind: (count,) for kind, count in sorted(counts.items())}
        yield Held("outline", "", "faults", "", rows or {"all": (0,)}, 0.0, "counts are exact")
    yield from _response(design)
    if design.loaded_rod.loads.any:
        yield from _loads(design)
        yield from _torsion(design)


def held_moments(rung: str, resolution: str, moments: Moments, radius: float) -> Iterator[Held]:
    """Areas and moments of a section within a radius [mm]."""
    area = np.pi * radius**2

    def one(
        quantity: str, unit: str, names: tuple[str, ...], values: FloatArray, size: float
    ) -> Held:
        return Held(rung, resolution, quantity, unit, columns(names, values), *rounding(size))

    areas = np.append(moments.area, moments.chamber_areas)
    second = moments.second_moments
    yield one("areas", "mm²", ("material", *SUPPLIES), areas, area)
    yield one("centroid", "mm", ("material",), moments.centroid[None], radius)
    yield one("first moments", "mm³", SUPPLIES, moments.chamber_first_moments, area * radius)
    values = np.array([second[0, 0], second[1, 1], second[0, 1]])
    names = ("I11 = ∫ y² dA", "I22 = ∫ x² dA", "I12 = −∫ xy dA")
    yield one("second moments", "mm⁴", names, values, area * radius**2)


def _response(design: Design) -> Iterator[Held]:
    """The matrix B, a number a supply."""
    matrix = design.response.matrix
    parts = (
        ("stretch", "1/kPa", ("ε",), matrix[:1]),
        ("bending", "1/(mm·kPa)", ("κ1", "κ2"), matrix[1:]),
    )
    for quantity, unit, names, values in parts:
        limit = rounding(float(np.abs(values).max()))
        yield Held("response", "", quantity, unit, columns(names, values), *limit)


def _loads(design: Design) -> Iterator[Held]:
    """Loads in the frame of the base."""
    loads = design.loaded_rod.loads
    tip, line = loads.tip, loads.line
    parts: tuple[tuple[str, str, dict[str, FloatArray]], ...] = (
        ("weight", "mN/mm³", {"dead": loads.weight}),
        ("along the rod", "mN/mm", {"dead": line.force, "follower": line.follower_force}),
        ("forces at the tip", "mN", {"dead": tip.force, "follower": tip.follower_force}),
        ("moments at the tip", "mN·mm", {"dead": tip.moment, "follower": tip.follower_moment}),
        ("where they act", "mm", {"from the tip": tip.at}),
    )
    for quantity, unit, rows in parts:
        values = np.array(list(rows.values()))
        size = float(np.abs(values).max())
        if size > 0:
            yield Held("loads", "", quantity, unit, columns(rows, values), *rounding(size))


def _torsion(design: Design) -> Iterator[Held]:
    known = design.values.saint_venant
    if known is None:
        return
    share, source = OF_TRIANGLES if design.seal.rules.sealed else OF_STRANDS
    parts: tuple[tuple[str, str, FloatArray, tuple[str, ...]], ...] = (
        ("torsion constant", "mm⁴", np.array([known.torsion_constant]), ("I_T",)),
        ("shear centre", "mm", known.shear_centre[None], ("from the centroid",)),
        ("shear area", "mm²", known.shear_area, ("x", "y")),
    )
    for quantity, unit, values, names in parts:
        limit = share * float(np.abs(values).max())
        yield Held("torsion", "", quantity, unit, columns(names, values), limit, source)
