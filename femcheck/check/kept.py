"""Solved cases on disk, one file each, so that a killed check goes on where it was."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

from femcheck.check.schedule import Key
from femcheck.continuation.outcome import SolidOutcome, Statistics, Status
from femcheck.continuation.shape import Shapes
from femcheck.solid.state import State
from femcheck.solved.case import CaseResult
from femcheck.solved.store import read_solved, write_solved

__all__ = ["case_file", "read_case", "write_case"]


def case_file(folder: Path, key: Key) -> Path:
    """The file of a case."""
    stage, node = key
    return folder / f"{stage}-{''.join(map(str, node))}.npz"


def write_case(folder: Path, key: Key, result: CaseResult, digest: str) -> None:
    """Keep a result of the solid that `digest` tells from others."""
    outcome = result.outcome
    negative = outcome.negative_eigenvalues
    values = {
        "reached": outcome.reached,
        "residual": outcome.residual,
        "negative": -1 if negative is None else negative,
    }
    states: dict[str, Any] = {}
    if outcome.state is not None and result.volumes is not None:
        states = {
            "x": outcome.state.x,
            "tip": outcome.state.tip,
            "turn": outcome.state.turn,
            "volumes": result.volumes,
            "strain_energy": result.strain_energy,
        }
    file = case_file(folder, key)
    write_solved(file, digest, outcome.status, values, outcome.statistics, states)


def read_case(folder: Path, key: Key, shapes: Shapes, digest: str) -> CaseResult | None:
    """A kept result; None where there is none, none that can be read, or one of another solid."""
    return read_solved(case_file(folder, key), digest, partial(_case, shapes))


def _case(shapes: Shapes, status: Status, spent: Statistics, kept: Any) -> CaseResult | None:
    negative = int(kept["negative"])
    state = State(kept["x"], kept["tip"], kept["turn"]) if "x" in kept else None
    outcome = SolidOutcome(
        status,
        state,
        float(kept["reached"]),
        float(kept["residual"]),
        None if negative < 0 else negative,
        spent,
    )
    if state is None:
        return None if status is Status.CONVERGED else CaseResult(outcome)
    energy = float(kept["strain_energy"])
    return CaseResult(outcome, shapes.of(state), kept["volumes"], energy)
