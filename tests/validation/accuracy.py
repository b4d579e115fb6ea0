"""`--accuracy` keeps its promise on 20 designs that no chart has seen.

Rods under loads against 24 modes; solids of the beam's own law against the
closed form; solids of materials against one with 16 layers, three times finer
triangles, and thinner layers at the clamp. All of them reach it; one that did not would say so, and
fail here, since it is to be looked at.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from beamopt.scene.actuator import Actuator
from beamopt.scene.design import Design, Grid
from beamopt.scene.drawn_chambers import DrawnChamber
from beamopt.scene.scene import load_scene
from beamopt.scene.seal_keys import Seal
from beamopt.target.workspace import pressure_grid
from femcheck.accuracy.ending import Ending
from femcheck.accuracy.within import answer_within
from femcheck.check.options import CheckOptions
from femcheck.models.beam import RodByMethod, RodOnOutline
from femcheck.models.question import LawChoice, Question
from femcheck.models.reply import Model
from femcheck.models.solid import SolidModel
from femcheck.prediction.options import PredictionOptions
from femcheck.solid.winding import Wound
from tests.validation.check import Check, Row

MUCH_FINER = SolidModel(layers=16, size=0.7, grading=32.0)
FEW = [2, 13, 18]  # of the 27: one supply alone, all alike, another alone


def checks(full: bool) -> list[Check]:
    chosen = list(_questions()) if full else [next(_questions())]
    return [Check(name, partial(_rows, name, *rest)) for name, *rest in chosen]


def _questions() -> Iterator[tuple[str, Question, float, Model]]:
    """Name, question, accuracy [mm] and what the answer is held against."""
    for scene, seed, accuracy in (
        ("gravity", 31, 1.0), ("gravity", 32, 0.1), ("tool-at-the-tip", 33, 0.01),
        ("two-segments", 34, 0.1), ("pre-curved", 35, 0.01),
    ):  # fmt: skip
        design = _of_scene(scene, seed)
        question = Question.of(f"{scene} {seed}", design, CheckOptions())
        finest = RodByMethod("modes", 24)
        yield f"{scene} {seed}, {accuracy:g} mm", question, accuracy, finest
    for seed, accuracy in ((41, 1.0), (42, 0.1), (43, 0.1), (44, 0.1), (45, 0.02)):
        question = Question.of(f"circles {seed}", _circles(seed), CheckOptions())
        yield f"rigid circles {seed}, {accuracy:g} mm", question, accuracy, RodOnOutline()
    for seed, accuracy in ((51, 1.0), (52, 0.1), (53, 0.1)):
        design = _of_scene("sealed-section", seed)
        question = Question.of(f"Voronoi {seed}", design, CheckOptions())
        few = question.at(pressure_grid(design.pressures)[FEW])
        yield f"rigid Voronoi {seed}, {accuracy:g} mm", few, accuracy, RodOnOutline()
    for seed, accuracy, law in (
        (61, 0.5, PredictionOptions()),
        (62, 0.1, PredictionOptions()),
        (63, 0.1, PredictionOptions(poisson_ratio=0.4)),
        (64, 0.1, PredictionOptions(law="gent")),
        (65, 0.1, PredictionOptions(wound=Wound.CHAMBERS)),
        (66, 0.05, PredictionOptions()),
        (67, 0.1, PredictionOptions(law="yeoh", poisson_ratio=0.45)),
    ):
        name = f"{law.law} circles {seed}, {accuracy:g} mm"
        yield name, _soft(seed, law), accuracy, MUCH_FINER


def _of_scene(scene: str, seed: int) -> Design:
    """A random section under a scene's rules and loads."""
    plain = load_scene(scene)
    for k in range(100):
        design = plain.design_of(plain.random_points(np.random.default_rng([seed, k])))
        outline = design.outline if plain.seal.rules.sealed else None
        whole = outline is None or (outline.buildable and not outline.islands)
        if design.moments.is_stiff and whole:
            return design
    raise ValueError(f"{scene} {seed}: no section that can be cast")


def _circles(
    seed: int,
    ring: tuple[float, float] = (10.0, 25.0),
    at: tuple[float, float] = (16.5, 18.5),
    radius: tuple[float, float] = (3.0, 5.0),
    levels: tuple[float, float, float] = (0.0, 50.0, 100.0),
) -> Design:
    """Three round chambers of random size and place, sealed by what is round them [mm, kPa]."""
    rng = np.random.default_rng(seed)
    angles = np.radians([0.0, 120.0, 240.0]) + rng.uniform(-0.3, 0.3, 3)
    radii, places = rng.uniform(*radius, 3), rng.uniform(*at, 3)
    chambers = [
        DrawnChamber(supply=k + 1, center=(r * np.cos(a), r * np.sin(a)), radius=size)
        for k, (a, r, size) in enumerate(zip(angles, places, radii, strict=True))
    ]
    return Design(
        schema="beamopt-design/1",
        grid=Grid(inner_radius=ring[0], outer_radius=ring[1]),
        drawing=chambers,
        wall_elements=0,
        seal=Seal(skin=1.0, wall=0.9),
        actuator=Actuator(),
        pressures=levels,
    )


def _soft(seed: int, law: LawChoice) -> Question:
    """A slender disc at pressures that round chambers of silicone stand; three combinations."""
    design = _circles(seed, (0.0, 15.0), (6.6, 7.4), (2.4, 3.4), (0.0, 12.0, 24.0))
    return Question.of(f"circles {seed}", design, law).at(pressure_grid(design.pressures)[FEW])


def _rows(name: str, question: Question, accuracy: float, finer: Model) -> Iterator[Row]:
    rung = "solid" if question.no_solid is None else "auto"
    found = answer_within(question, accuracy, rung=rung, workers=1)
    source = f"{found.chosen}; estimate {found.worst:.2g} mm; {found.seconds:.3g} s"
    if found.ending is not Ending.REACHED or found.reply is None:
        yield Row(f"{name}: {found.ending.value}", source, 1.0, 0.0, 0.0)
        return
    truth = finer.reply(question, 1)
    both = int((truth.found & found.reply.found).sum())
    yield Row(f"{name}: tips that both have", source, int(truth.found.sum()), both, 0)
    error = float(np.nanmax(found.reply.away(truth.tips)))
    yield Row(f"{name}: error [mm]", source, 0.0, error, accuracy)
