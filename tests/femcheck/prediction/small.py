"""Predictions that take seconds: the disc of the check, so soft that it balloons at 25…32 kPa."""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from beamopt.rod.arc import arc_tips
from femcheck.continuation.outcome import Status
from femcheck.mesh.geo import SectionSizes
from femcheck.prediction.answer import Answer
from femcheck.prediction.options import PredictionOptions
from femcheck.prediction.predict_design import predict_design
from femcheck.prediction.prediction import Prediction
from femcheck.prediction.ray_trace import RayResult
from femcheck.prediction.rays import Ray, rays_of
from femcheck.solved.case import Solid
from femcheck.solved.subject import Subject
from tests.femcheck.check.small import Coarse, design_of, here, three_circles

SIZES = SectionSizes(factor=9.0)  # as `--size 9` asks
SOFT = 100.0  # kPa
LEVELS = [0, 20, 40]
"""One level below every limit, one above."""


def options_of(**changes: Any) -> PredictionOptions:
    return PredictionOptions(**({"layers": 2, "sizes": SIZES} | changes))


def soft_subject(name: str = "soft", levels: Sequence[float] = LEVELS) -> Subject:
    moduli = {"youngs_modulus": SOFT, "shear_modulus": SOFT / 3}
    return Coarse(name, design_of(three_circles(), pressures=list(levels), actuator=moduli))


Pool = Callable[[int], AbstractContextManager[Executor]]


def predict(
    folder: Path,
    subject: Subject | None = None,
    workers: int = 1,
    resume: bool = False,
    pool: Pool = here,
    **changes: Any,
) -> Prediction:
    subject = subject or soft_subject()
    options = options_of(**changes)
    return predict_design(subject, folder, options, workers=workers, resume=resume, pool=pool)


def an_answer(load: float, tip: Sequence[float], length: float = 100.0) -> Answer:
    """An equilibrium that nobody computed."""
    x = np.zeros((1, 3))
    volumes = np.array([1.5, 2.0, 2.5]) * length
    axis = np.zeros((2, 4))
    return Answer(load, x, np.array(tip), volumes, 1.0, 1.25, np.array([1.0, 2.0, 3.0]), axis)


def faked(
    endings: dict[tuple[float, float, float], tuple[Status, float]],
    levels: Sequence[float] = LEVELS,
    share: float = 0.0,
    mode: tuple[float, Sequence[float]] | None = None,
    coarse: dict[tuple[float, float, float], tuple[Status, float]] | None = None,
    coarse_share: float | None = None,
    tracks: dict[tuple[float, float, float], Sequence[Sequence[float]]] | None = None,
    **changes: Any,
) -> Prediction:
    """A prediction of which each ray's ending is told; other rays have all their answers.

    share : by which the solid's tips move less than the beam's.
    coarse : endings on the coarse mesh where they are others; every ray is followed there too.
    coarse_share : share there, where it is another one.
    tracks : load and the three volumes along rays, on both meshes.
    """
    subject, options = soft_subject(levels=levels), options_of(**changes)
    rays, places = rays_of(subject.pressures)
    assert set(endings) <= {ray.direction for ray in rays}
    section = Middle()
    law = options.law_for(subject.design.actuator)
    solid = Solid("standard", section, np.array([0.0, 100.0]), "wedge18", law)  # type: ignore[arg-type]
    results = {}
    other_share = share if coarse_share is None else coarse_share
    cases = [
        (mesh, number, ray, told, moved)
        for mesh, told, moved in (
            ("standard", endings, share),
            ("coarse", endings | (coarse or {}), other_share),
        )
        for number, ray in enumerate(rays)
    ]
    for mesh, number, ray, told, moved in cases:
        status, critical = told.get(ray.direction, (Status.CONVERGED, np.nan))
        stops = [load for load in ray.stops if not load >= critical]
        answers = [_near_the_beam(subject, ray, load, moved) for load in stops]
        missing = [None] * (len(ray.stops) - len(answers))
        track = np.zeros((1, 8))
        if tracks is not None and ray.direction in tracks:
            rows = np.array(tracks[ray.direction], dtype=float)
            track = np.hstack([rows, np.zeros((len(rows), 4))])
        of_mode = {} if mode is None or status is not Status.BUCKLED else _mode(mode)
        last = answers[-1] if answers else None
        every = (*answers, *missing)
        results[mesh, number] = RayResult(status, critical, every, last, track, **of_mode)
    solids = {"standard": solid, "coarse": replace(solid, name="coarse")}
    return Prediction(
        subject, options, law, None, None, solids, tuple(rays), tuple(places), results
    )


class Middle:
    """A section whose material centroid is the origin."""

    class moments:  # noqa: N801
        centroid = np.zeros(2)
        chamber_areas = np.ones(3)


def _mode(mode: tuple[float, Sequence[float]]) -> dict[str, Any]:
    return {"mode_share": mode[0], "mode_at": np.array(mode[1])}


def _near_the_beam(subject: Subject, ray: Ray, load: float, share: float) -> Answer:
    length = subject.design.actuator.length
    pressures = load * np.array([ray.direction])
    tip = arc_tips(subject.response.strains(pressures), length)[0]
    return an_answer(load, tip + share * ([0, 0, length] - tip))
