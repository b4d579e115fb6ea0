"""Traced rays on disk, one file each, so that a killed prediction goes on where it was."""

from __future__ import annotations

from dataclasses import fields
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from femcheck.continuation.outcome import Statistics, Status
from femcheck.prediction.answer import Answer
from femcheck.prediction.ray_trace import RayResult
from femcheck.solved.store import read_arrays, write_arrays

__all__ = ["ray_file", "read_ray", "write_ray"]


def ray_file(folder: Path, mesh: str, ray: str) -> Path:
    """The file of a ray."""
    return folder / f"{mesh}-{ray}.npz"


def write_ray(path: Path, result: RayResult, digest: str) -> None:
    """Keep a result of the question that `digest` tells from others."""
    spent = result.statistics
    arrays: dict[str, Any] = {
        "digest": np.array(digest),
        "status": np.array(result.status.name),
        "critical": np.array(result.critical),
        "track": result.track,
        "growth": np.array(result.growth),
        "snaps": np.array(result.snaps),
        "mode_at": result.mode_at,
        "mode_share": np.array(result.mode_share),
        "counts": np.array([spent.steps, spent.iterations]),
        "seconds": np.array(
            [spent.seconds, spent.assembly_seconds, spent.factor_seconds, spent.solve_seconds]
        ),
        "there": np.array([one is not None for one in (*result.answers, result.last)]),
    }
    for number, answer in enumerate((*result.answers, result.last)):
        if answer is not None:
            for one in fields(Answer):
                arrays[f"{number}_{one.name}"] = np.asarray(getattr(answer, one.name))
    write_arrays(path, arrays)


def read_ray(path: Path, digest: str) -> RayResult | None:
    """A kept result; None where there is none to the same question that can be read."""
    return read_arrays(path, partial(_ray, digest))


def _ray(digest: str, kept: Any) -> RayResult | None:
    if str(kept["digest"]) != digest:
        return None
    steps, iterations = kept["counts"].tolist()
    there = kept["there"].tolist()
    *answers, last = (_answer(kept, number) for number in range(len(there)))
    if [one is not None for one in (*answers, last)] != there:
        return None
    return RayResult(
        Status[str(kept["status"])],
        float(kept["critical"]),
        tuple(answers),
        last,
        kept["track"],
        float(kept["growth"]),
        tuple(kept["snaps"].tolist()),
        kept["mode_at"],
        float(kept["mode_share"]),
        Statistics(steps, iterations, *kept["seconds"].tolist()),
    )


def _answer(kept: Any, number: int) -> Answer | None:
    if f"{number}_load" not in kept:
        return None
    values = {one.name: kept[f"{number}_{one.name}"] for one in fields(Answer)}
    plain = {name: float(value) for name, value in values.items() if value.ndim == 0}
    return Answer(**(values | plain))
