"""What real materials do, against theorems and independent programs.

The interior is read off between neighbouring planes of nodes whose distance from both ends is more
than a quarter of the length: the mean of their strains. At H/D = 10 that is two and a half
diameters from clamp and cap.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.scene.design import Design
from beamopt.scene.drawn_chambers import DrawnChamber
from femcheck.continuation.outcome import Status
from femcheck.material.fibre import Thread
from femcheck.material.law import Law
from femcheck.material.neo_hookean import NeoHookean
from femcheck.mesh.extrusion import stations
from femcheck.mesh.geo import SectionSizes
from femcheck.mesh.gmsh_section import Mesher, MeshFailure
from femcheck.prediction.ray_trace import RayResult, RayTask, trace_ray
from femcheck.prediction.rays import Ray
from femcheck.solid.winding import Wound
from femcheck.solved.case import Solid, rest_slopes, workshop
from femcheck.solved.subject import Subject, slender_copy
from tests.validation.check import Check, Row
from tests.validation.solid import drawn, three_chambers

BETTI = "(1 − 2ν) × the beam, any section (Betti, with the field of Saint-Venant)"
INDEPENDENT = "an unpublished independent program"
ALONE = (1.0, 0.0, 0.0)


def checks(full: bool) -> list[Check]:
    if not full:
        return [
            Check("linear response, coarse", partial(linear_rows, (0.3, 0.5), 6.0, 8, 0.02)),
            Check("three chambers balloon, coarse", partial(limit_rows, 3)),
        ]
    return [
        Check("linear response", partial(linear_rows, (0.0, 0.3, 0.45, 0.5), 10.0, 20, 0.002)),
        Check("three wound round chambers", wound_rows),
        Check("three chambers balloon", partial(limit_rows, 6)),
        Check("three chambers balloon, another element", element_rows),
        Check("three chambers balloon, long", long_rows),
    ]


def round_chambers() -> Design:
    """Three round chambers, r 4.5 mm at 17.5 mm, in the ring of 10…25 mm."""
    angles = 2 * np.pi * np.arange(3) / 3
    chambers = [
        DrawnChamber(supply=k + 1, center=(17.5 * np.cos(a), 17.5 * np.sin(a)), radius=4.5)
        for k, a in enumerate(angles.tolist())
    ]
    return drawn(chambers)


def solid_of(
    subject: Subject,
    law: Law,
    layers: int,
    element: str = "wedge18",
    wound: tuple[Wound, Thread] | None = None,
) -> Solid:
    section = Mesher().mesh(subject.outline, SectionSizes())
    assert not isinstance(section, MeshFailure), section
    length = subject.design.actuator.length
    heights = stations(length, layers, 1.5)
    return Solid("validated", section, heights, element, law, wound=wound)


def interior(axis: FloatArray, length: float) -> FloatArray:
    """(3,) mean ε, κ1, κ2 between the quarters."""
    inside = np.abs(axis[:, 0] - length / 2) < length / 4
    return np.asarray(axis[inside, 1:].mean(axis=0))


def linear_rows(
    ratios: tuple[float, ...], slenderness: float, layers: int, within: float
) -> Iterator[Row]:
    """d(ε, κ)/dP at rest over the beam's, one supply: stretch, and curvature the beam's way."""
    subject = slender_copy(Subject("three", three_chambers()), slenderness)
    length = subject.design.actuator.length
    beam = subject.response.matrix[:, 0]
    for nu in ratios:
        solid = solid_of(subject, NeoHookean(300.0, nu), layers)
        slopes = rest_slopes(solid)
        assert slopes is not None
        shop = workshop(solid)
        small = 1e-6
        rest = shop.shapes.of(shop.problem.rest())
        near = shop.shapes.state(rest + small * slopes[0])
        found = interior(shop.shapes.axis(near), length) / small
        said = f"ν = {nu:g}, H/D = {slenderness:g}: interior"
        for name, value in (
            ("stretch", found[0] / beam[0]),
            ("curvature", float(found[1:] @ beam[1:] / (beam[1:] @ beam[1:]))),
        ):
            yield Row(f"{said} {name} over the beam's", BETTI, 1 - 2 * nu, value, within)


def wound_rows() -> Iterator[Row]:
    """At 25 kPa, one supply alone: the interior at H/D = 4 and 8, and the tips as they are."""
    for slenderness, layers in ((2.0, 4), (4.0, 6), (8.0, 12)):
        subject = slender_copy(Subject("round", round_chambers()), slenderness)
        solid = solid_of(
            subject, NeoHookean(300.0, 0.5), layers, wound=(Wound.CHAMBERS, Thread(1e5))
        )
        result = traced(solid, (25.0,))
        answer = result.answers[0]
        name = f"wound, 25 kPa, H/D = {slenderness:g}"
        yield Row(f"{name}: answered", INDEPENDENT, 1.0, float(answer is not None), 0.0)
        if answer is None:
            continue
        pressures = np.array([[25.0, 0.0, 0.0]])
        beam = subject.response.strains(pressures)[0]
        found = interior(answer.axis, subject.design.actuator.length)
        stretch = found[0] / beam[0]
        bend = float(found[1:] @ beam[1:] / (beam[1:] @ beam[1:]))
        yield Row(f"{name}: interior stretch over the beam's", INDEPENDENT, 1.0, stretch, 0.05)
        yield Row(f"{name}: interior curvature over the beam's", INDEPENDENT, 1.0, bend, 0.05)
        yield Row(
            f"{name}: tip's difference over its way",
            "reported",
            0.0,
            off(subject, solid, answer.tip),
            0.1,
        )


def off(subject: Subject, solid: Solid, tip: FloatArray) -> float:
    """Difference of the tips over the beam's displacement at 25 kPa in supply 1."""
    from beamopt.rod.arc import arc_tips

    length = subject.design.actuator.length
    beam = arc_tips(subject.response.strains(np.array([[25.0, 0.0, 0.0]])), length)[0]
    found = tip - np.append(solid.section.moments.centroid, 0.0)
    moved = np.linalg.norm(beam - [0, 0, length])
    return float(np.linalg.norm(found - beam) / moved)


def traced(solid: Solid, stops: tuple[float, ...]) -> RayResult:
    return trace_ray(RayTask(solid, Ray(ALONE, stops)))


def limit_rows(layers: int) -> Iterator[Row]:
    """Unreinforced, one supply, clamped and capped at H/D = 2: a limit point, and where."""
    subject = Subject("three", three_chambers())
    result = traced(solid_of(subject, NeoHookean(300.0, 0.5), layers), (50.0, 100.0))
    yield limit_row("three chambers, H/D = 2", result, 24.5, 0.1)
    yield Row(
        "three chambers: answers beyond the limit",
        "no equilibrium exists",
        0.0,
        float(sum(answer is not None for answer in result.answers)),
        0.0,
    )


def limit_row(name: str, result: RayResult, expected: float, share: float) -> Row:
    critical = result.critical if result.status is Status.LIMIT_POINT else float("nan")
    return Row(f"{name}: limit pressure [kPa]", INDEPENDENT, expected, critical, share * expected)


def element_rows() -> Iterator[Row]:
    """Another family of elements finds the same limit; ours with twice the layers the reference."""
    subject = Subject("three", three_chambers())
    law = NeoHookean(300.0, 0.5)
    fine = traced(solid_of(subject, law, 8), (50.0,)).critical
    for element in ("wedge18", "tet10"):
        found = traced(solid_of(subject, law, 4, element), (50.0,)).critical
        name = f"{element}, 4 layers: limit pressure over wedge18's with 8"
        yield Row(name, "another mesh", 1.0, found / fine, 0.01)


def long_rows() -> Iterator[Row]:
    """Towards the infinitely long actuator, where clamp and cap are far."""
    subject = slender_copy(Subject("three", three_chambers()), 8.0)
    result = traced(solid_of(subject, NeoHookean(300.0, 0.5), 12), (50.0,))
    yield limit_row("three chambers, H/D = 8", result, 21.9, 0.03)
