"""Solved cases on disk, one file each, so that a killed check goes on where it was."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from femcheck.check.schedule import Key
from femcheck.continuation.outcome import SolidOutcome, Statistics, Status
from femcheck.continuation.shape import Shapes
from femcheck.solid.state import State
from femcheck.solved.case import CaseResult
from femcheck.solved.store import read_arrays, write_arrays

__all__ = ["case_file", "read_case", "write_case"]


def case_file(folder: Path, key: Key) -> Path:
    """The file of a case."""
    stage, node = key
    return folder / f"{stage}-{''.join(map(str, node))}.npz"


def write_case(folder: Path, key: Key, result: CaseResult, digest: str) -> None:
    """Keep a result of the solid that `digest` tells from others."""
    outcome = result.outcome
    spent = outcome.statistics
    arrays = {
        "digest": np.array(digest),
        "status": np.array(outcome.status.name),
        "reached": np.array(outcome.reached),
        "residual": np.array(outcome.residual),
        "negative": np.array(
            -1 if outcome.negative_eigenvalues is None else outcome.negative_eigenvalues
        ),
        "counts": np.array([spent.steps, spent.iterations]),
        "seconds": np.array(
            [spent.seconds, spent.assembly_seconds, spent.factor_seconds, spent.solve_seconds]
        ),
    }
    if outcome.state is not None and result.volumes is not None:
        arrays |= {
            "x": outcome.state.x,
            "tip": outcome.state.tip,
            "turn": outcome.state.turn,
            "volumes": result.volumes,
            "strain_energy": np.array(result.strain_energy),
        }
    write_arrays(case_file(folder, key), arrays)


def read_case(folder: Path, key: Key, shapes: Shapes, digest: str) -> CaseResult | None:
    """A kept result; None where there is none, none that can be read, or one of another solid."""
    return read_arrays(case_file(folder, key), partial(_case, shapes, digest))


def _case(shapes: Shapes, digest: str, kept: Any) -> CaseResult | None:
    if str(kept["digest"]) != digest:
        return None
    steps, iterations = kept["counts"].tolist()
    statistics = Statistics(steps, iterations, *kept["seconds"].tolist())
    status = Status[str(kept["status"])]
    negative = int(kept["negative"])
    state = State(kept["x"], kept["tip"], kept["turn"]) if "x" in kept else None
    outcome = SolidOutcome(
        status,
        state,
        float(kept["reached"]),
        float(kept["residual"]),
        None if negative < 0 else negative,
        statistics,
    )
    if state is None:
        return None if status is Status.CONVERGED else CaseResult(outcome)
    energy = float(kept["strain_energy"])
    return CaseResult(outcome, shapes.of(state), kept["volumes"], energy)
