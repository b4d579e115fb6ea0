"""Pressure combinations along rays from rest: one path of equilibria answers all on its ray."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray

__all__ = ["Ray", "rays_of"]

DIGITS = 9  # of a direction: combinations on one ray differ by rounding only


@dataclass(frozen=True, slots=True)
class Ray:
    """Pressures P · direction.

    direction : largest component 1 (or −1 for suction).
    stops : ascending loads P at which an equilibrium is wanted [kPa].
    """

    direction: tuple[float, float, float]
    stops: tuple[float, ...]

    @property
    def name(self) -> str:
        """For files: the direction in per cent."""
        return "_".join(f"{100 * part:.10g}" for part in self.direction)

    @property
    def supplies(self) -> tuple[int, ...]:
        """Supplies (1…3) that have pressure along it."""
        return tuple(k for k, part in enumerate(self.direction, 1) if part)

    @property
    def is_principal(self) -> bool:
        """Whether it is one supply alone, or all alike."""
        return len(set(self.direction) - {0.0}) == 1 and len(self.supplies) in (1, 3)

    @property
    def text(self) -> str:
        """For people: which supplies, at which share of the largest."""
        loaded = {part for part in self.direction if part}
        if len(loaded) > 1:
            return "pressures as " + " : ".join(f"{part:.3g}" for part in self.direction)
        names = " and ".join(map(str, self.supplies))
        return {1: f"supply {names} alone", 2: f"supplies {names}"}.get(
            len(self.supplies), "all supplies alike"
        )


def rays_of(pressures: FloatArray) -> tuple[list[Ray], list[tuple[int, float] | None]]:
    """Rays through combinations (n, 3) [kPa], and each one's place: its ray and load.

    Each supply alone and all alike are always among the rays, up to the largest pressure. A
    combination without pressure has no ray.
    """
    largest = float(np.abs(pressures).max())
    loads: dict[tuple[float, float, float], set[float]] = {}
    for direction in (*np.eye(3).tolist(), [1.0, 1.0, 1.0]):
        loads[_key(np.array(direction))] = {largest}
    places: list[tuple[tuple[float, float, float], float] | None] = []
    for combination in pressures:
        load = float(np.abs(combination).max())
        if load == 0:
            places.append(None)
            continue
        key = _key(combination / load)
        loads.setdefault(key, set()).add(load)
        places.append((key, load))
    rays = [Ray(key, tuple(sorted(found))) for key, found in loads.items() if largest > 0]
    index = {ray.direction: number for number, ray in enumerate(rays)}
    return rays, [None if place is None else (index[place[0]], place[1]) for place in places]


def _key(direction: FloatArray) -> tuple[float, float, float]:
    a, b, c = (round(float(part), DIGITS) + 0.0 for part in direction)
    return a, b, c
