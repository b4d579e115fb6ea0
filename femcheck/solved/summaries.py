"""Parts of `summary.json` and `timing.csv` that checks and predictions write alike."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray
from femcheck.continuation.outcome import Statistics
from femcheck.solved.case import Solid
from femcheck.solved.cells import DIGITS
from femcheck.solved.subject import Subject

__all__ = ["largest", "rounded", "section_summary", "size_summary", "timing_rows", "work_summary"]


def rounded(value: float) -> float | None:
    """A number of a summary; None where it is not finite."""
    return round(value, DIGITS) if math.isfinite(value) else None


def largest(values: FloatArray) -> float | None:
    """Largest of the finite values, rounded; None without any."""
    return rounded(float(np.max(values[np.isfinite(values)], initial=-np.inf)))


def section_summary(subject: Subject) -> dict[str, Any]:
    """The section of a subject, and distances by which sealing moved the beam's tips [mm]."""
    outline, moved = subject.outline, subject.sealing_moved
    data: dict[str, Any] = {
        "section": {
            "areas_mm2": [round(value, DIGITS) for value in outline.moments.raw[:, 0].tolist()],
            "chambers": [len(outline.chambers_of(supply)) for supply in (1, 2, 3)],
            "islands": len(outline.islands),
            "faults": [str(fault) for fault in subject.design.findings],
        }
    }
    if moved is not None:
        median = rounded(float(np.median(moved)))
        data["sealing_moved_mm"] = {"worst": largest(moved), "median": median}
    return data


def size_summary(solid: Solid) -> dict[str, int]:
    """Triangles, layers and unknowns of a solid."""
    layers, unknowns = solid.heights.size - 1, int(solid.body().unknowns)
    return {"triangles": len(solid.section.triangles), "layers": layers, "unknowns": unknowns}


def work_summary(spent: Sequence[Statistics]) -> dict[str, int]:
    """Iterations of all cases or rays, and of the one that took most."""
    counts = [one.iterations for one in spent]
    return {"iterations": sum(counts), "most_iterations": max(counts)}


def timing_rows(name: str, spent: Sequence[Statistics]) -> Iterator[tuple[str, float, str]]:
    """Processor time of a solid's cases or rays, summed over processes."""
    for what in ("seconds", "assembly_seconds", "factor_seconds", "solve_seconds"):
        part = what.removesuffix("_seconds").replace("seconds", "all")
        yield f"{name} {part}", sum(getattr(one, what) for one in spent), "s"
