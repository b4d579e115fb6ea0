"""Refining never makes a design worse, on the section that everybody else computes.

Every design is written, read, refined and written again. Both files are judged by what stands in
them alone: tips against the target, and the weighted rules by their definition. Designs have
feature points in one place, nearly in one place, outside the ring and behind others.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from beamopt.judge.judge import Judge
from beamopt.refine.refine import RefineStatus
from beamopt.refine.refine_design import refine_design
from beamopt.scene.design import Design, load_design
from beamopt.scene.scene import Scene, load_scene
from beamopt.search.recombination import fixed
from beamopt.section.cell_owners import NEAR
from beamopt.section.feature_points import FeaturePoints
from tests.validation.check import Check, Row

__all__ = ["checks"]

CHEAP = (
    "grid.radial=32",
    "grid.angular=90",
    "refine.flips=300",
    "refine.walks=4",
    "refine.steps=12",
    "refine.outline_steps=4",
    "refine.rounds=1",
)
IDLE = ("refine.flips=0", "refine.steps=0", "refine.outline_steps=0")
"""Of a third of the designs, which are then to come back as they were."""

SCENES = ("random-section", "sealed-section")
RULES = {
    "mass": ("making.mass_weight=20.0",),
    "chambers": ("making.chambers=[2, 2, 2]", "making.chambers_weight=50.0"),
    "symmetry": ('making.symmetry="mirror"', 'making.symmetry_rule="weighted"'),
    "repaired": ('making.symmetry="mirror"',),
}
ROUNDING = 1e-9  # of the loss before
LEAST = 1.0  # mm²; below it, of this: a target is the workspace of one of the sections
SOURCE = "refining never returns a higher L + R"

Maker = Callable[[Scene, np.random.Generator], FeaturePoints]


def as_searched(scene: Scene, rng: np.random.Generator) -> FeaturePoints:
    """On element centroids."""
    return scene.random_points(rng)


def recombined(scene: Scene, rng: np.random.Generator) -> FeaturePoints:
    """Offspring of relatives: places of both parents, with different types."""
    grid, parent = scene.grid.build(), scene.random_points(rng)
    other = parent.with_types(rng.permutation(parent.type))
    for _ in range(3):
        parent, other = fixed(parent, other, grid, 0.5, rng)
    return parent


def doubled(scene: Scene, rng: np.random.Generator) -> FeaturePoints:
    """A third of the points doubled, exactly or nearly, by any type."""
    points = scene.random_points(rng)
    at = rng.integers(len(points), size=len(points) // 3)
    off = NEAR * rng.choice([0.0, 1e-9, 1e-4, 0.5, 2.0, 30.0], (2, at.size))
    types = rng.integers(4, size=at.size)
    x, y = points.x[at] + off[0], points.y[at] + off[1]
    order = rng.permutation(len(points) + at.size)
    together = ((points.x, x), (points.y, y), (points.type, types))
    return FeaturePoints(*(np.append(a, b)[order] for a, b in together))


def scattered(scene: Scene, rng: np.random.Generator) -> FeaturePoints:
    """Around the ring as well, some far away, in any number."""
    count = int(rng.integers(3, 50))
    x, y = rng.uniform(-30, 30, (2, count)) * np.where(rng.random(count) < 0.1, 100, 1)
    return FeaturePoints(x, y, rng.choice(4, count, p=[0.5, 0.2, 0.15, 0.15]))


KINDS: tuple[Maker, ...] = (as_searched, recombined, doubled, scattered)


@dataclass(frozen=True)
class Case:
    """A scene, and how its designs are made."""

    scene: str
    kind: Maker
    rule: str = ""

    @property
    def name(self) -> str:
        """For the table."""
        said = f"{self.scene}, {self.kind.__name__.replace('_', ' ')}"
        return f"{said}, {self.rule}" if self.rule else said


def checks(full: bool) -> list[Check]:
    """Five hundred designs; without `full` two of each kind, one of them idle."""
    cases = [Case(scene, kind) for scene in SCENES for kind in KINDS]
    ruled = [Case(scene, doubled, rule) for scene in SCENES for rule in RULES]
    return [
        *(Check(one.name, partial(rows_of, one, 50 if full else 2)) for one in cases),
        *(Check(one.name, partial(rows_of, one, 13 if full else 2)) for one in ruled),
    ]


def rows_of(case: Case, count: int) -> Iterator[Row]:
    """How many of a kind became worse, and by how much the worst."""
    keys = [*CHEAP, "section.feature_points=30", *RULES.get(case.rule, ())]
    scene, idle = load_scene(case.scene, keys), load_scene(case.scene, [*keys, *IDLE])
    target, rises, wrong, refined = scene.load_target(), [0.0], 0, 0
    busy = [seed for seed in range(count) if seed % 3 > 0]
    assert target.workspace is not None
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(count):
            start = written(scene, case, seed, Path(folder))
            found = refine_design(start, scene if seed in busy else idle, target)
            ended = load_design(found.design.save(Path(folder) / "after.json"))
            before, after = (loss(scene, each, target.workspace.tips) for each in (start, ended))
            rises.append((after - before) / max(before, LEAST))
            status = found.refined.status
            refined += seed in busy and status is RefineStatus.REFINED
            wrong += status is RefineStatus.UNCHANGED and ended.source.digest != start.source.digest
    yield Row(f"{case.name}: largest rise of L + R, share of it", SOURCE, 0.0, max(rises), ROUNDING)
    yield Row(f"{case.name}: said to be as it was, and is not", SOURCE, 0, wrong, 0)
    name = f"{case.name}: refined, of those with rounds or flips"
    yield Row(name, "half of them at least", len(busy), refined, len(busy) / 2)


def written(scene: Scene, case: Case, seed: int, folder: Path) -> Design:
    """The first design of this kind and seed that can be judged, as read from its file."""
    judge = Judge.of_scene(scene, scene.load_target())
    for attempt in range(100):
        rng = np.random.default_rng([seed, attempt])
        points = case.kind(scene, rng)
        symmetry = scene.making.repair(scene.grid.build())
        if symmetry is not None:
            points = symmetry.symmetrised(points)
        design = scene.design_of(points)
        if np.isfinite(judge([points])[0].L) and design.moments.is_stiff:
            return load_design(design.save(folder / "before.json"))
    raise AssertionError(f"{case.name}, seed {seed}: no design can be judged")


def loss(scene: Scene, design: Design, tips: np.ndarray) -> float:
    """L + R of a design, by its tips and by the definitions of the rules [mm²]."""
    making = scene.making
    total = float(((design.workspace.tips - tips) ** 2).sum())
    volume = design.moments.area * design.actuator.length  # mm³
    total += making.mass_weight * volume * making.density * 1e-6
    if making.chambers is not None:
        many = np.array(chambers(design)) - making.chambers
        total += making.chambers_weight * float(np.maximum(many, 0).sum())
    if making.symmetry == "mirror" and making.symmetry_rule == "weighted":
        labels = design.section.labels
        image = np.array([0, 1, 3, 2])[labels[:, ::-1]]
        total += making.symmetry_weight * float((labels != image).mean())
    return total


def chambers(design: Design) -> tuple[int, ...]:
    """Separate chambers of each supply: of the outline where it is sealed."""
    if design.seal.rules.sealed:
        return tuple(len(design.outline.chambers_of(supply)) for supply in (1, 2, 3))
    return design.section.pieces.chambers
