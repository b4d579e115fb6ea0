"""Traced rays on disk, one file each, so that a killed prediction goes on where it was."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import Any

from femcheck.continuation.outcome import Statistics, Status
from femcheck.prediction.answer import Answer
from femcheck.prediction.ray_trace import RayResult
from femcheck.solved.store import read_solved, write_solved

__all__ = ["ray_file", "read_ray", "write_ray"]


def ray_file(folder: Path, mesh: str, ray: str) -> Path:
    """The file of a ray."""
    return folder / f"{mesh}-{ray}.npz"


def write_ray(path: Path, result: RayResult, digest: str) -> None:
    """Keep a result of the question that `digest` tells from others."""
    names = ("critical", "track", "growth", "snaps", "mode_at", "mode_share")
    values = {name: getattr(result, name) for name in names}
    answers = (*result.answers, result.last)
    states: dict[str, Any] = {"there": [one is not None for one in answers]}
    for number, answer in enumerate(answers):
        if answer is not None:
            for one in fields(Answer):
                states[f"{number}_{one.name}"] = getattr(answer, one.name)
    write_solved(path, digest, result.status, values, result.statistics, states)


def read_ray(path: Path, digest: str) -> RayResult | None:
    """A kept result; None where there is none to the same question that can be read."""
    return read_solved(path, digest, _ray)


def _ray(status: Status, spent: Statistics, kept: Any) -> RayResult | None:
    there = kept["there"].tolist()
    *answers, last = (_answer(kept, number) for number in range(len(there)))
    if [one is not None for one in (*answers, last)] != there:
        return None
    return RayResult(
        status,
        float(kept["critical"]),
        tuple(answers),
        last,
        kept["track"],
        float(kept["growth"]),
        tuple(kept["snaps"].tolist()),
        kept["mode_at"],
        float(kept["mode_share"]),
        spent,
    )


def _answer(kept: Any, number: int) -> Answer | None:
    if f"{number}_load" not in kept:
        return None
    values = {one.name: kept[f"{number}_{one.name}"] for one in fields(Answer)}
    plain = {name: float(value) for name, value in values.items() if value.ndim == 0}
    return Answer(**(values | plain))
