"""What is held of the solid: its volumes at rest, tips of several laws, one energy, a limit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.outline.outline import Outline
from beamopt.rod.arc import arc_tips
from beamopt.rod.response import linear_response
from beamopt.section.moments import Moments
from femcheck.accuracy.knowledge import MATERIAL, ORDERS, RIGID
from femcheck.check.options import CheckOptions
from femcheck.continuation.ended import Ended
from femcheck.material.rigid_section import RigidSection
from femcheck.mesh.extrusion import stations
from femcheck.mesh.geo import SectionSizes
from femcheck.mesh.gmsh_section import Mesher, MeshFailure
from femcheck.models.question import LawChoice, Question
from femcheck.models.reply import Reply
from femcheck.models.solid import SolidModel
from femcheck.prediction.options import PredictionOptions
from femcheck.regression.held import Held, Row, at, columns, is_late, of_reply, rounding
from femcheck.regression.held_design import HeldDesign
from femcheck.regression.kept_mesh import KeptMesher, read_kept
from femcheck.regression.rods import SAFETY
from femcheck.regression.sections import held_moments
from femcheck.solid.elements import DEFAULT_ELEMENT
from femcheck.solid.winding import Wound
from femcheck.solved.case import Case, CaseResult, Solid, solve_case, workshop

__all__ = ["LAWS", "held_limit", "held_meshes", "held_solid"]

LAYERS, FEWER = 3, 2
NO_NUMBERS = "statuses are the same or not"
NEWTON = 1e-7  # of the length: what its last step, 2e-4 mm, leaves, and 1/c² of an extrapolation
PENALTY = 2500.0  # c of the equilibrium whose energy is held


@dataclass(frozen=True)
class HeldLaw:
    """A law that a solid is held at.

    rung : its name. options : the law. shares : (n, 3) of the design's highest pressure level.
    """

    rung: str
    options: LawChoice
    shares: tuple[tuple[float, float, float], ...]


LAWS = (
    HeldLaw("solid, rigid-section", CheckOptions(), ((0.2, 0, 0), (0, 0.15, 0.3))),
    HeldLaw(
        "solid, compressible",
        PredictionOptions(poisson_ratio=0.4),
        ((0.05, 0, 0), (0, 0.04, 0.08)),
    ),
    HeldLaw("solid, incompressible", PredictionOptions(), ((0.05, 0, 0), (0, 0.04, 0.08))),
    HeldLaw(
        "solid, wound",
        PredictionOptions(wound=Wound.CHAMBERS),
        ((0, 0.1, 0.2),),
    ),
)


def held_meshes(held: HeldDesign) -> Iterator[Held]:
    """Rungs "kept mesh", "gmsh" and "solid at rest"."""
    radius = held.design.grid.outer_radius
    section = read_kept(held.mesh)
    yield from held_moments("kept mesh", "", section.moments, radius)
    total = float(section.areas.sum())
    rows: dict[str, Row] = {"material": (total,)}
    yield Held("kept mesh", "", "triangles' area", "mm²", rows, *rounding(np.pi * radius**2))
    yield from _beam(held, section.moments)
    yield from _fresh(held.design.outline, radius)
    solid = _solid(held, LAYERS)
    problem = workshop(solid).problem
    length = held.design.actuator.length
    limit = rounding(np.pi * radius**2 * length)
    volumes = problem.volumes(problem.rest())
    names = [f"supply {supply}" for supply in (1, 2, 3)]
    said = f"{LAYERS} layers"
    yield Held("solid at rest", said, "chamber volumes", "mm³", columns(names, volumes), *limit)
    rows = {"material": (float(problem.body.weights.sum()),)}
    yield Held("solid at rest", said, "volume", "mm³", rows, *limit)


def _beam(held: HeldDesign, moments: Moments) -> Iterator[Held]:
    """Tips of the beam on the mesh: what the solid of the beam's own law has to come to."""
    actuator, law = held.design.actuator, LAWS[0]
    pressures = np.array(law.shares) * held.design.pressures[2]
    response = linear_response(moments, actuator.youngs_modulus)
    tips = arc_tips(response.strains(pressures), actuator.length)
    rows = columns(map(at, pressures), tips)
    yield Held("beam on kept mesh", "", "tips", "mm", rows, *rounding(actuator.length))


def _fresh(outline: Outline, radius: float) -> Iterator[Held]:
    """What gmsh makes of the outline today: its vertices are kept, and so are all integrals."""
    section = Mesher().mesh(outline, SectionSizes())
    if isinstance(section, MeshFailure):
        rows: dict[str, Row] = {"material": Ended.of_mesh(section)}
        yield Held("gmsh", "", "areas", "mm²", rows, 0.0, NO_NUMBERS)
        return
    yield from held_moments("gmsh", "", section.moments, radius)


def held_solid(held: HeldDesign, law: HeldLaw, *, estimate: bool) -> Iterator[Held]:
    """Tips of a law; of the rigid section also energy and volumes at the last pressures.

    estimate : whether tolerances are wanted, which fewer layers have to be solved for.
    """
    question = _question(held, law.options, np.array(law.shares))
    fine = SolidModel(layers=LAYERS).reply(question)
    coarse = SolidModel(layers=FEWER).reply(question) if estimate else None
    order = ORDERS[RIGID if question.is_of_the_beam else MATERIAL]
    tolerance, source = _tolerance(fine.tips, None if coarse is None else coarse.tips, order)
    least = NEWTON * held.design.actuator.length
    limit = max(tolerance, least), f"{source}; at least what Newton leaves, {least:.1g} mm"
    rows = of_reply(question.pressures, fine)
    yield Held(law.rung, f"{LAYERS} layers", "tips", "mm", rows, *limit, law=question.law_text)
    if question.is_of_the_beam:
        yield from _energy(held, law.rung, question.pressures[-1], estimate)


def held_limit(held: HeldDesign, *, estimate: bool) -> Iterator[Held]:
    """The pressure of each supply alone beyond which there is no stable equilibrium."""
    question = _question(held, PredictionOptions(), np.eye(3)[:1])
    replies = [SolidModel(layers=LAYERS).reply(question)]
    if estimate:
        replies.append(SolidModel(layers=FEWER).reply(question))
    loads = [_limits(reply) for reply in replies]
    least = NEWTON * float(np.nanmax(loads[0], initial=0.0))
    tolerance, source = _tolerance(loads[0], loads[1] if estimate else None, ORDERS[MATERIAL])
    said = f"{source}; at least what Newton leaves"
    rung, layers, law = "solid, limit", f"{LAYERS} layers", question.law_text
    # the ending also where it is a tip: numbers of a solution are not the same to the last digit
    endings: dict[str, Row] = dict(
        zip(map(at, question.pressures), replies[0].endings, strict=True)
    )
    yield Held(rung, layers, "endings", "", endings, 0.0, NO_NUMBERS, law)
    late = {row: one for row, one in endings.items() if is_late(one)}
    rows = columns(endings, loads[0]) | late
    yield Held(rung, layers, "limit pressures", "kPa", rows, max(tolerance, least), said, law)


def _limits(reply: Reply) -> FloatArray:
    """(n, 1) [kPa], NaN where there is none."""
    return np.array([[np.nan if one.load is None else one.load] for one in reply.endings])


def _energy(held: HeldDesign, rung: str, pressures: FloatArray, estimate: bool) -> Iterator[Held]:
    """Strain energy and chamber volumes of one equilibrium."""
    fine = _case(held, LAYERS, pressures)
    coarse = _case(held, FEWER, pressures) if estimate else None
    law, layers = f"rigid-section, c = {PENALTY:g}", f"{LAYERS} layers"
    for quantity, unit, part in (
        ("strain energy", "mN·mm", _energy_of),
        ("chamber volumes", "mm³", _volumes_of),
    ):
        value = part(fine)
        limit = _tolerance(value, None if coarse is None else part(coarse), ORDERS[RIGID])
        rows = columns([at(pressures)], value)
        if fine.status.is_interrupted:
            rows = dict.fromkeys(rows, Ended(fine.status))
        yield Held(rung, layers, quantity, unit, rows, *limit, law)


def _energy_of(result: CaseResult) -> FloatArray:
    return np.array([[result.strain_energy]])


def _volumes_of(result: CaseResult) -> FloatArray:
    return np.full((1, 3), np.nan) if result.volumes is None else result.volumes[None]


def _case(held: HeldDesign, layers: int, pressures: FloatArray) -> CaseResult:
    return solve_case(Case(_solid(held, layers), pressures, None, None))


def _solid(held: HeldDesign, layers: int) -> Solid:
    actuator = held.design.actuator
    heights = stations(actuator.length, layers, CheckOptions().grading)
    law = RigidSection(actuator.youngs_modulus, PENALTY)
    return Solid(held.name, read_kept(held.mesh), heights, DEFAULT_ELEMENT, law)


def _question(held: HeldDesign, law: LawChoice, shares: FloatArray) -> Question:
    chosen = replace(law, mesher=KeptMesher(section=read_kept(held.mesh)))
    return Question.of(held.name, held.design, chosen, shares * held.design.pressures[2])


def _tolerance(fine: FloatArray, coarse: FloatArray | None, order: float) -> tuple[float, str]:
    """From what is left of the change from fewer layers (Richardson); NaN where not asked for.

    order : in which errors fall with the layers.
    """
    if coarse is None:
        return np.nan, ""
    left = 1 / ((LAYERS / FEWER) ** order - 1)
    change = np.linalg.norm(fine - coarse, axis=1)
    worst = float(np.nanmax(change, initial=0.0))
    source = (
        f"{SAFETY:g} times Richardson's estimate from {FEWER} and {LAYERS} layers, order {order:g}"
    )
    return SAFETY * left * worst, source
