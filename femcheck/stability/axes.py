"""The panels of the map.

All stand beside one specimen, the hand-made section of three chambers at H/D = 2: ring r 10…25 mm,
chambers of 80° at r 13…22 mm, corners rounded by 1 mm, E = 300 kPa, neo-Hookean, ν = ½. The beam is
no model of unreinforced silicone; the panels with wound round chambers are there because of those
it is one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from beamopt.section.drawing import Circle, RingPiece, Shape
from femcheck.material.fibre import Thread
from femcheck.material.neo_hookean import NeoHookean
from femcheck.stability.axis import Axis, Column
from femcheck.stability.closed_tube import closed_tube_limit
from femcheck.stability.specimen import Specimen

__all__ = ["AXES"]

E = 300.0  # kPa
INNER, OUTER, MIDDLE = 10.0, 25.0, 17.5  # mm
DIAMETER = 2 * OUTER
WALL = 3.0  # mm
SILICONE = NeoHookean(E, 0.5)
THREAD = Thread(1e5)


def _ring_pieces(wall: float, count: int = 3) -> tuple[Shape, ...]:
    """Chambers of 80°, a wall [mm] from either surface of the ring."""
    r = (INNER + wall, OUTER - wall)
    return tuple(RingPiece(k + 1, r, (120 * k - 40, 120 * k + 40), 1.0) for k in range(count))


def _round(wall: float) -> tuple[Shape, ...]:
    """Three round chambers in the middle of the ring, a wall [mm] from either surface."""
    turns = [math.radians(120 * k) for k in range(3)]
    at = [(MIDDLE * math.cos(turn), MIDDLE * math.sin(turn)) for turn in turns]
    radius = MIDDLE - INNER - wall
    return tuple(Circle(k, centre, radius) for k, centre in enumerate(at, 1))


BASE = Specimen(_ring_pieces(WALL), OUTER, INNER, 2 * DIAMETER, SILICONE)
WOUND = replace(BASE, shapes=_round(WALL), thread=THREAD)


def _of_length(specimen: Specimen, slenderness: float) -> Specimen:
    """Another length; layers follow it, thinner at the ends of a long one."""
    layers = next(
        n for n, most in ((3, 2), (4, 4), (5, 8), (6, 12), (8, 99)) if slenderness <= most
    )
    grading = 1.5 if slenderness <= 2 else 2.5
    length = slenderness * DIAMETER
    return replace(specimen, length=length, layers=layers, grading=grading)


def _wall() -> Axis:
    columns = tuple(
        Column(
            f"{wall:g}",
            replace(BASE, shapes=_ring_pieces(wall)),
            compare=wall in (0.8, WALL),
        )
        for wall in (0.8, 1.2, 1.6, 2.0, 2.5, WALL, 3.75, 4.5)
    )
    said = "The hand-made section; only the walls to both surfaces of the ring change."
    pressures = (2.0, 4.0, 6.0, 8.0, 12.0, 16.0, 20.0, 24.0, 28.0, 36.0)
    return Axis("wall", "wall thickness", "wall [mm]", said, columns, pressures)


def _nu() -> Axis:
    columns = tuple(
        Column(f"{nu:g}", replace(BASE, law=NeoHookean(E, nu)), compare=nu == 0.3)
        for nu in (0.0, 0.2, 0.3, 0.4, 0.45, 0.48, 0.495, 0.5)
    )
    said = "The hand-made section of materials with the same E; in the mixed form above ν = 0.45."
    pressures = (0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 22.5, 25.0)
    return Axis("nu", "Poisson's ratio", "ν", said, columns, pressures)


def _slenderness() -> Axis:
    columns = tuple(
        Column(f"{ratio:g}", _of_length(BASE, ratio))
        for ratio in (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0)
    )
    said = "The hand-made section; clamp and cap disturb about a diameter each."
    pressures = (2.0, 5.0, 8.0, 12.0, 16.0, 20.0, 22.0, 26.0)
    return Axis("slenderness", "slenderness", "H/D", said, columns, pressures)


def _element() -> Axis:
    nearly = NeoHookean(E, 0.49, mixed=False)
    mixed = [("wedge18", 2), ("wedge18", 3), ("wedge18", 4), ("hex27", 2), ("tet10", 3)]
    columns = [
        Column(f"{name}\n{layers} layers", replace(BASE, element=name, layers=layers))
        for name, layers in (*mixed, ("tet4", 3))
    ]
    paired = replace(BASE, law=NeoHookean(E, 0.49))
    columns.append(Column("wedge18\nν 0.49\nmixed", paired))
    columns += [
        Column(f"{name}\nν 0.49\nunmixed", replace(BASE, element=name, law=nearly))
        for name in ("wedge18", "tet10", "tet4")
    ]
    said = (
        "The hand-made section, on the same triangles: first ν = ½, where the hydrostatic pressure "
        "is an unknown of its own; then ν = 0.49, with that pressure and with displacements alone."
    )
    pressures = (5.0, 10.0, 15.0, 20.0, 22.0, 25.0)
    return Axis("element", "element", "", said, tuple(columns), pressures, ordered=False)


def _section() -> Axis:
    alone, three = replace(BASE, shapes=_ring_pieces(WALL, 1)), replace(BASE, shapes=_round(WALL))
    columns = (
        Column("three of 80°", BASE),
        Column("one of 80°", alone),
        Column("three round", three, compare=True),
        Column("three round,\nwound", WOUND),
    )
    said = "Sections with walls of 3 mm at H/D = 2; the last one wound round every chamber."
    pressures = (2.0, 5.0, 10.0, 15.0, 20.0, 22.5, 30.0, 57.0, 65.0)
    return Axis("section", "chambers", "", said, columns, pressures, ordered=False)


def _tube() -> Axis:
    B, mu = 20.0, E / 3
    columns = []
    for wall in (3.0, 4.0, 5.0, 6.0, 7.0, 8.0):
        disc: tuple[Shape, ...] = (Circle(1, (0.0, 0.0), B - wall),)
        tube = Specimen(disc, B, 0.0, 10 * B, SILICONE, layers=4, grading=2.0, sagitta=0.05)
        columns.append(Column(f"{wall:g}", tube, closed_tube_limit(B - wall, B, mu)))
    said = "A tube of outer radius 20 mm, one chamber on its axis, H/D = 5: it balloons."
    pressures = (5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 36.0)
    return Axis("tube", "closed tube", "wall [mm]", said, tuple(columns), pressures)


def _wound_slenderness() -> Axis:
    columns = tuple(
        Column(f"{ratio:g}", _of_length(WOUND, ratio), compare=ratio == 4)
        for ratio in (1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0)
    )
    said = "Three round chambers r 4.5 mm at 17.5 mm, each wound with thread of 10⁵ N/m."
    pressures = (5.0, 10.0, 20.0, 30.0, 40.0, 60.0, 80.0, 100.0)
    title = "slenderness, chambers wound"
    return Axis("wound-slenderness", title, "H/D", said, columns, pressures)


def _wound_wall() -> Axis:
    columns = tuple(
        Column(f"{wall:g}", _of_length(replace(WOUND, shapes=_round(wall)), 4.0))
        for wall in (1.5, 2.0, 2.5, 3.0, 4.0, 5.0)
    )
    said = "Three round chambers in the middle of the ring, each wound, at H/D = 4."
    pressures = (5.0, 10.0, 20.0, 30.0, 40.0, 60.0, 80.0, 100.0)
    return Axis("wound-wall", "wall, chambers wound", "wall [mm]", said, columns, pressures)


AXES: Mapping[str, Axis] = {
    axis.name: axis
    for axis in (
        _wall(),
        _nu(),
        _slenderness(),
        _element(),
        _section(),
        _tube(),
        _wound_slenderness(),
        _wound_wall(),
    )
}
"""All panels by name, in the order of the figure."""
