"""Solved cases on disk, one file each, so that a killed check goes on where it was."""

from __future__ import annotations

import io
import struct
import zipfile
import zlib
from pathlib import Path

import numpy as np

from beamopt.files import write_atomic
from femcheck.check.case import CaseResult
from femcheck.check.schedule import Key
from femcheck.continuation.outcome import Outcome, Statistics, Status
from femcheck.continuation.shape import Shapes
from femcheck.solid.state import State

__all__ = ["case_file", "read_case", "write_case"]


def case_file(folder: Path, key: Key) -> Path:
    """The file of a case."""
    stage, node = key
    return folder / f"{stage}-{''.join(map(str, node))}.npz"


def write_case(folder: Path, key: Key, result: CaseResult, digest: str) -> None:
    """Keep a result of the solid that `digest` tells from others."""
    outcome, stream = result.outcome, io.BytesIO()
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
    np.savez(stream, allow_pickle=False, **arrays)
    write_atomic(case_file(folder, key), stream.getvalue())


def read_case(folder: Path, key: Key, shapes: Shapes, digest: str) -> CaseResult | None:
    """A kept result; None where there is none, none that can be read, or one of another solid."""
    try:
        data = io.BytesIO(case_file(folder, key).read_bytes())
        with np.load(data, allow_pickle=False) as kept:
            if str(kept["digest"]) != digest:
                return None
            steps, iterations = kept["counts"].tolist()
            statistics = Statistics(steps, iterations, *kept["seconds"].tolist())
            status = Status[str(kept["status"])]
            negative = int(kept["negative"])
            state = State(kept["x"], kept["tip"], kept["turn"]) if "x" in kept else None
            outcome = Outcome(
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
    except (OSError, ValueError, KeyError, zipfile.BadZipFile, EOFError):
        return None
    except (RuntimeError, SyntaxError, zlib.error, struct.error):
        return None  # headers with a bit turned over: encrypted, compressed, of no size
