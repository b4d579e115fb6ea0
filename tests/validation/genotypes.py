"""A hundred thousand genotypes, ordinary and hostile: an answer or a status for each."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from beamopt.judge.judge import Judge, JudgeStatus
from beamopt.scene.scene import load_scene
from beamopt.section.feature_points import FeaturePoints
from tests.validation.check import Check, Row

Maker = Callable[[np.random.Generator], FeaturePoints]


def _types(rng: np.random.Generator, count: int) -> np.ndarray:
    return rng.choice(4, count, p=[1 / 2, 1 / 6, 1 / 6, 1 / 6])


def _count(rng: np.random.Generator) -> int:
    return int(rng.choice([0, 1, 2, 3, 4, 7, 30, 100, 101, 250]))


def _ring(rng: np.random.Generator, count: int) -> np.ndarray:
    radius, angle = rng.uniform(10, 25, count), rng.uniform(0, 2 * np.pi, count)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)])


def ordinary(rng: np.random.Generator) -> FeaturePoints:
    scene = load_scene("random-section")
    return FeaturePoints.random(scene.grid.build(), 100, rng)


def any_count(rng: np.random.Generator) -> FeaturePoints:
    n = _count(rng)
    return FeaturePoints(*_ring(rng, n), _types(rng, n))


def coincident(rng: np.random.Generator) -> FeaturePoints:
    n = max(_count(rng), 1)
    places = _ring(rng, int(rng.integers(1, 4)))
    return FeaturePoints(*places[:, rng.integers(places.shape[1], size=n)], _types(rng, n))


def on_a_line(rng: np.random.Generator) -> FeaturePoints:
    n, angle = _count(rng), rng.uniform(0, 2 * np.pi)
    along = rng.uniform(-25, 25, n)
    return FeaturePoints(along * np.cos(angle), along * np.sin(angle), _types(rng, n))


def on_a_circle(rng: np.random.Generator) -> FeaturePoints:
    n = _count(rng)
    angle = np.radians(rng.integers(0, 360, n))
    return FeaturePoints(17 * np.cos(angle), 17 * np.sin(angle), _types(rng, n))


def on_a_lattice(rng: np.random.Generator) -> FeaturePoints:
    n = _count(rng)
    return FeaturePoints(*rng.integers(-5, 6, (2, n)) * 5.0, _types(rng, n))


def one_type(rng: np.random.Generator) -> FeaturePoints:
    n = _count(rng)
    return FeaturePoints(*_ring(rng, n), np.full(n, rng.integers(4)))


def no_material(rng: np.random.Generator) -> FeaturePoints:
    n = _count(rng)
    return FeaturePoints(*_ring(rng, n), rng.integers(1, 4, n))


def far_away(rng: np.random.Generator) -> FeaturePoints:
    n = _count(rng)
    scale = 10.0 ** rng.uniform(-12, 6)
    return FeaturePoints(*rng.normal(size=(2, n)) * scale, _types(rng, n))


def crowded(rng: np.random.Generator) -> FeaturePoints:
    n = _count(rng)
    centre = _ring(rng, 1)
    spread = 10.0 ** rng.uniform(-9, 0)
    return FeaturePoints(*(centre + rng.normal(size=(2, n)) * spread), _types(rng, n))


KINDS: tuple[Maker, ...] = (
    ordinary,
    any_count,
    coincident,
    on_a_line,
    on_a_circle,
    on_a_lattice,
    one_type,
    no_material,
    far_away,
    crowded,
)


def _judge() -> Judge:
    scene = load_scene("hand-drawn-workspace")
    return Judge.of_scene(scene, scene.load_target())


def _without_answer(judge: Judge, batch: list[FeaturePoints]) -> int:
    """Candidates that have neither finite tips and losses nor a status."""
    tips = judge.tips(batch)
    silent = 0
    for tip, verdict in zip(tips, judge(batch), strict=True):
        finite = np.isfinite(tip).all() and np.isfinite([verdict.L, verdict.K, verdict.T]).all()
        silent += verdict.status is JudgeStatus.JUDGED and not finite
    return silent


def checks(full: bool) -> list[Check]:
    each = 10_000 if full else 100

    def of_kind(kind: Maker, index: int) -> Callable[[], Iterator[Row]]:
        def rows() -> Iterator[Row]:
            judge = _judge()
            silent = exceptions = answered = 0
            for first in range(0, each, 100):
                batch = [kind(np.random.default_rng([index, first + k])) for k in range(100)]
                try:
                    silent += _without_answer(judge, batch)
                except Exception:
                    exceptions += 1
                else:
                    answered += len(batch)
            name = kind.__name__.replace("_", " ")
            source = "every genotype has an answer or a status"
            yield Row(f"{name}: batches that ended in an exception", source, 0, exceptions, 0)
            yield Row(f"{name}: not a number and no status", source, 0, silent, 0)
            yield Row(f"{name}: genotypes through section and tips", source, each, answered, 0)

        return rows

    return [Check(kind.__name__, of_kind(kind, k)) for k, kind in enumerate(KINDS)]
