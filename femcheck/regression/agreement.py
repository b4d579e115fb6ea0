"""Independent rungs of one design held against each other: no baseline is wrong in itself."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from femcheck.regression.held import Held, is_late

__all__ = ["contradictions"]

PAIRS = (
    ("rod under load", "rod, modes"),
    ("rod, modes", "rod, elements"),
    ("outline", "gmsh"),
    ("beam on kept mesh", "solid, rigid-section"),
)
"""Rungs that say the same in two ways, within what both leave open."""


def contradictions(held: Sequence[Held], length: float) -> list[str]:
    """Where rungs contradict each other or the clock ended them, a sentence each.

    length : of the actuator [mm].
    """
    found = [
        f"{one.rung}: {one.quantity} at {row}: {value}"
        for one in held
        for row, value in one.rows.items()
        if is_late(value)
    ]
    for first, second in PAIRS:
        for one in _of(held, first):
            for other in _of(held, second):
                if one.quantity == other.quantity and one.unit == other.unit:
                    found += _apart(one, other)
    return found + list(_prisms(held, length))


def _of(held: Sequence[Held], rung: str) -> list[Held]:
    return [one for one in held if one.rung == rung]


def _apart(one: Held, other: Held) -> Iterator[str]:
    allowed = one.tolerance + other.tolerance
    for row, value in one.rows.items():
        if row not in other.rows:
            continue
        seen = other.rows[row]
        names = f"{one.rung} and {other.rung}: {one.quantity} at {row}"
        if isinstance(value, tuple) and isinstance(seen, tuple):
            distance = math.dist(value, seen)
            if not distance <= allowed:
                yield f"{names}: {distance:.3g} {one.unit} apart (allowed {allowed:.2g})"
        else:
            yield f"{names}: no numbers"


def _prisms(held: Sequence[Held], length: float) -> Iterator[str]:
    """Volumes of the solid at rest are areas times length, where both are wanted."""
    volumes = {row: value for one in _of(held, "solid at rest") for row, value in one.rows.items()}
    for one in _of(held, "kept mesh"):
        if one.quantity not in ("areas", "triangles' area") or not volumes:
            continue
        allowed = 2 * length * one.tolerance
        for row, area in one.rows.items():
            volume = volumes.get(row)
            if not (isinstance(area, tuple) and isinstance(volume, tuple)):
                yield f"kept mesh and solid at rest: {row}: no numbers"
            elif not abs(volume[0] - area[0] * length) <= allowed:
                apart = f"{volume[0]:.6g} mm³ are not {area[0]:.6g} mm² × {length:g} mm"
                yield f"kept mesh and solid at rest: {row}: {apart}"
