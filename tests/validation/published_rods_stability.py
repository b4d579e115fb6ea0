"""Loads that a rod gives way under: columns and Lee's frame; and a measured strip."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipeinc, ellipkinc

from beamopt.rod.equilibrium import solve_rod
from beamopt.rod.law import SectionLaw
from beamopt.rod.path import LoadPath, follow_path
from beamopt.rod.rod import Base, LineLoad, PointLoad, Rod, Segment, Tip
from beamopt.rod.status import RodStatus
from tests.validation.check import Row
from tests.validation.published_inflation import yes
from tests.validation.published_rods import (
    ALONG_X,
    PLANE,
    SPACE,
    along,
    cantilever,
    elastic,
    solved,
)
from tests.validation.published_rods_shooting import lee_limit

GREENHILL = 7.837347
"""q L³/EI at which a clamped column buckles under its own weight (Greenhill 1881)."""

LEE, LEE_AT = 18556.7, (48.733, 26.881)
"""First limit of the dead load, and the load's way down and across there."""
LEE_FOLLOWER = 35419.5
"""That of a load which turns with the frame; shooting and paths agree on 35438.0, 0.05 % more."""

STRIP = {  # F [N]: drop [m] as computed by the authors, and as measured
    0.0: (0.0898, 0.089),
    0.098: (0.1516, 0.149),
    0.196: (0.1960, 0.195),
    0.294: (0.2270, 0.227),
    0.392: (0.2495, 0.251),
}


def limit(rod: Rod, asked: float, tolerance: float) -> tuple[RodStatus, float]:
    """How the rod ends and the load it bears, with loads that add to `asked`."""
    found = solve_rod(rod, rod.rest[None], tolerance)
    return found.status[0], asked * float(found.factor[0])


def give_way_rows(
    name: str, source: str, rod: Rod, asked: float, expected: float, status: RodStatus
) -> Iterator[Row]:
    """How, and under which load: to 0.5 %; the load's smallest steps are 2e-4 of `asked`."""
    found, load = limit(rod, asked, 1e-6 * rod.length)
    yield yes(f"{name}: {status.name.lower()}, found {found.name.lower()}", source, found is status)
    yield Row(f"{name}: load", source, expected, load, 5e-3 * expected)


def column(law: SectionLaw, length: float, force: float, curvature: float = 0.0) -> Rod:
    """Clamped at the origin, along x, pressed at its tip."""
    return cantilever(law, length, PointLoad(force=along(x=-force)), curvature)


def column_rows() -> Iterator[Row]:
    """Buckling at the critical load; 0.1 % below it the column stands straight."""
    length, EI = 20.0, 300.0
    euler = np.pi**2 * EI / (4 * length**2)
    for space, free in (("plane", PLANE), ("space", SPACE)):
        name, source = f"column, {space}", "Euler: P = π² EI/(4 L²)"
        law = elastic(EI, EI, free=free)
        rod = column(law, length, 1.5 * euler)
        yield from give_way_rows(name, source, rod, 1.5 * euler, euler, RodStatus.BUCKLED)
        below = solved(column(law, length, 0.999 * euler))
        yield yes(f"{name}: stands at 0.999 of it", source, bool(below.converged[0]))
        name, source = f"column under its weight, {space}", "Greenhill 1881: q L³/EI = 7.837"
        critical = GREENHILL * EI / length**3
        straight = column(law, length, 0.0)
        rod = _heavy(straight, 1.5 * critical)
        asked = 1.5 * critical
        yield from give_way_rows(name, source, rod, asked, critical, RodStatus.BUCKLED)
        below = solved(_heavy(straight, 0.999 * critical))
        yield yes(f"{name}: stands at 0.999 of it", source, bool(below.converged[0]))
    yield from soft_column_rows()
    yield from curved_column_rows()


def soft_column_rows() -> Iterator[Row]:
    """A column that shears and shortens: P (1 + P/GA − P/EA) = π² EI/(4 L²) (Reissner 1972)."""
    length, EI, GA, EA = 20.0, 300.0, 12.0, 30.0
    euler = np.pi**2 * EI / (4 * length**2)
    slope = 1 / GA - 1 / EA
    critical = (np.sqrt(1 + 4 * slope * euler) - 1) / (2 * slope)
    law = replace(elastic(EI), compliance=np.diag([1 / GA, 1 / GA, 1 / EA]))
    rod = column(law, length, 1.5 * critical)
    name, source = "column that shears and shortens", "P (1 + P/GA − P/EA) = π² EI/(4 L²)"
    yield from give_way_rows(name, source, rod, 1.5 * critical, critical, RodStatus.BUCKLED)


def _heavy(rod: Rod, weight: float) -> Rod:
    line = LineLoad(force=along(x=-weight))
    return replace(rod, segments=tuple(replace(one, line=line) for one in rod.segments))


def curved_column(load: float, curvature: float) -> tuple[float, float]:
    """Tip x/L, y/L of a column under P L²/EI = `load` with a curvature of κ* L = `curvature`.

    sin(θ/2) = k sin φ with F(φ, k) = √load at the tip, where θ' = 2 k √load cos φ is κ* L.
    """
    root = np.sqrt(load)

    def missing(phi: float) -> float:
        k = curvature / (2 * root * np.cos(phi))
        return float(ellipkinc(phi, k * k) - root)

    largest = np.arccos(curvature / (2 * root)) - 1e-15  # k = 1
    phi = float(brentq(missing, 0.5, largest, xtol=1e-15, rtol=1e-15))
    k = curvature / (2 * root * np.cos(phi))
    x = 2 * float(ellipeinc(phi, k * k)) / root - 1
    return x, float(2 * k * (1 - np.cos(phi)) / root)


def curved_column_rows() -> Iterator[Row]:
    """Slightly curved at rest, κ* L = 0.01, it goes on past Euler's load without buckling."""
    length, EI = 20.0, 300.0
    for share in (0.9, 1.1, 2.0):
        load = share * np.pi**2 / 4
        rod = column(elastic(EI), length, load * EI / length**2, 0.01 / length)
        x, y, _ = solved(rod, 20).tips[0] / length
        exact = curved_column(load, 0.01)
        for axis, expected, measured in zip("xy", exact, (x, y), strict=True):
            name = f"column, κ* L = 0.01, at {share:g} of Euler's load: tip {axis}/L"
            yield Row(name, "elliptic integrals", expected, float(measured), 1e-8)


def lee_frame(force: float, *, follower: bool = False) -> Rod:
    """Hinged at the origin, 120 up along x, then 120 across along y to a hinge that is held.

    A = 6, I = 2, E = 7.2e6, no shear; the load acts downwards at 24 from the corner.
    """
    E, A, second = 7.2e6, 6.0, 2.0
    bending, compliance = np.diag([1.0, E * second, 1.0]), np.diag([0.0, 0.0, 1 / (E * A)])
    law = SectionLaw(bending, compliance, np.zeros((3, 3)), PLANE)
    corner = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    down = PointLoad(force=along(x=-force))
    turning = PointLoad(follower_force=along(x=force))
    return Rod(
        (
            Segment(120.0, law),
            Segment(24.0, law, kink=corner, end=turning if follower else down),
            Segment(96.0, law),
        ),
        Base(rotation=ALONG_X, hinges=np.array([[0.0, 0.0, 1.0]])),
        Tip(position=np.array([120.0, 120.0, 0.0])),
    )


def lee_rows() -> Iterator[Row]:
    """Dead load and follower load have different limits."""
    name, source = "Lee's frame", "first limit load, no shear"
    rod = lee_frame(2e4)
    yield from give_way_rows(name, source, rod, 2e4, LEE, RodStatus.LIMIT_POINT)
    below = solved(lee_frame(0.999 * LEE))
    yield yes(f"{name}: bears 0.999 of it", source, bool(below.converged[0]))
    name, source = "Lee's frame, follower load", "first limit load, no shear"
    rod = lee_frame(4e4, follower=True)
    yield from give_way_rows(name, source, rod, 4e4, LEE_FOLLOWER, RodStatus.LIMIT_POINT)


def lee_path_rows() -> Iterator[Row]:
    """Paths through the limits, and the same limits by shooting.

    The load is flat there, so that the way is known less well than the load: by 0.005.
    """
    name, asked = "Lee's frame", 2e4
    shot = lee_limit(56.0, follower=False)
    path = follow_path(lee_frame(asked), modes=8, step=0.02, steps=400)
    found = _first_limit(path, asked)
    for source, load, way in (
        ("first limit load, no shear", LEE, LEE_AT),
        ("shooting", shot.load, (shot.down, shot.across)),
    ):
        yield Row(f"{name}: load of the path's limit", source, load, found[0], 1e-5 * load)
        yield Row(f"{name}: the load's way down", source, way[0], found[1], 0.005)
        yield Row(f"{name}: the load's way across", source, way[1], found[2], 0.005)
    past = bool(path.factors[-1] < 0.95 * path.limits[0] and not path.stable[-1])
    yield yes(f"{name}: followed beyond, where it is unstable", "limit point", past)
    name, asked = "Lee's frame, follower load", 4e4
    shot = lee_limit(80.0, follower=True)
    found = _first_limit(follow_path(lee_frame(asked, follower=True), modes=8, step=0.2), asked)
    source = "first limit load, no shear"
    yield Row(f"{name}: load of the path's limit", source, LEE_FOLLOWER, found[0], 40.0)
    yield Row(f"{name}: load of the path's limit", "shooting", shot.load, found[0], 1.0)
    yield Row(f"{name}: the load's way down", "shooting", shot.down, found[1], 0.02)
    yield Row(f"{name}: the load's way across", "shooting", shot.across, found[2], 0.02)


def _first_limit(path: LoadPath, asked: float) -> tuple[float, float, float]:
    """Load, and the loaded point's way down and across; NaN, which holds nowhere, without one."""
    if not path.limits.size:
        return (float("nan"),) * 3
    x, y, _ = path.limit_ends[0, 1]
    return asked * float(path.limits[0]), 120.0 - float(x), float(y) - 24.0


def strip_rows() -> Iterator[Row]:
    """0.4 m of steel, 25 × 0.4 mm, E = 194.3 GPa, its weight 0.3032 N, F at its end [N, m].

    The authors' four digits, and what they measured to 2 %.
    """
    source, length = "Belendez 2003, steel strip", 0.4
    EI = 194.3e9 * 0.025 * 0.0004**3 / 12
    for force, (computed, measured) in STRIP.items():
        end = PointLoad(force=along(y=-force))
        rod = _across(cantilever(elastic(EI), length, end), 0.3032 / length)
        drop = -float(solved(rod, 20).tips[0, 1])
        name = f"strip, F = {force:g} N: drop [m]"
        yield Row(f"{name} as computed", source, computed, drop, 3e-4)
        yield Row(f"{name} as measured", source, measured, drop, 0.02 * measured)


def _across(rod: Rod, weight: float) -> Rod:
    line = LineLoad(force=along(y=-weight))
    return replace(rod, segments=tuple(replace(one, line=line) for one in rod.segments))
