"""A check as tables: every tip, one line a pressure combination, and the verdict."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from beamopt.storage.writing import csv_text, json_text
from femcheck.check.checked import Checked, compare_csv
from femcheck.check.comparison import Comparison, table_csv
from femcheck.continuation.outcome import Status
from femcheck.solved.cells import DIGITS
from femcheck.solved.summaries import (
    largest,
    rounded,
    section_summary,
    size_summary,
    timing_rows,
    work_summary,
)

__all__ = ["summary", "tables_of", "verdict"]


def tables_of(checked: Checked) -> dict[str, str | None]:
    """All files that are text; None where there is nothing to say."""
    compared = checked.comparison
    return {
        "compare.csv": None if compared is None else compare_csv(checked),
        "table.csv": None if compared is None else table_csv(compared),
        "summary.json": json_text(summary(checked)),
        "timing.csv": csv_text("what,value,unit", _timing(checked)),
    }


def verdict(checked: Checked) -> str:
    """One sentence on whether the solid converges to the beam."""
    if checked.failure is not None:
        return f"no answer: {checked.failure}"
    compared = checked.comparison
    assert compared is not None
    agree = f"{100 * checked.options.agree:g} %"
    if compared.unanswered:
        first = next(
            status
            for status, loaded in zip(compared.final.statuses, compared.is_loaded, strict=True)
            if loaded and status is not Status.CONVERGED
        )
        return f"no answer in {compared.unanswered} of {_loaded(compared)} cases: {first.value}"
    worst, median = (f"{100 * value:.3g} %" for value in (compared.worst, compared.median))
    if not compared.moves:
        return "nothing to compare: no tip moves at any pressure"
    known = not math.isnan(compared.left)
    left = f"; mesh and penalty leave up to {100 * compared.left:.3g} %" if known else ""
    said = f"worst {worst}, median {median} of displacement (asked {agree}{left})"
    why = "what they leave could turn it over" if known else "the coarse mesh lacks an answer"
    sure = "" if checked.certain else f"; uncertain, as {why}"
    return f"{'agrees' if checked.holds else 'differs'}: {said}{sure}"


def _loaded(compared: Comparison) -> int:
    return int(compared.is_loaded.sum())


def summary(checked: Checked) -> dict[str, Any]:
    """The check without times."""
    subject, options = checked.subject, checked.options
    data: dict[str, Any] = {
        "design": subject.name,
        "verdict": {
            "kind": "implementation",
            "law": options.law,
            "holds": checked.holds,
            "certain": checked.certain,
            "text": verdict(checked),
            "agree": options.agree,
        },
    } | section_summary(subject)
    compared, steps, quality = checked.comparison, checked.geometry, checked.quality
    if quality is not None:
        data["mesh"] = {
            "thinnest_wall_mm": round(quality.thinnest, DIGITS),
            "thinnest_wall_at_mm": [round(value, 3) for value in quality.thin_at],
            "worst_triangle": round(quality.shape, DIGITS),
            "worst_triangle_at_mm": [round(value, 3) for value in quality.poor_at],
            "notes": quality.notes,
        }
    if compared is not None and steps is not None:
        data["geometry_steps_mm"] = {
            "raster_to_smooth": round(steps.raster_to_smooth, DIGITS),
            "smooth_to_outline": round(steps.smooth_to_outline, DIGITS),
            "outline_to_mesh": round(steps.outline_to_mesh, DIGITS),
        }
        data["difference"] = _differences(compared)
        data["solids"] = [_solid(checked, index) for index in range(len(checked.stages))]
    return data


def _differences(compared: Comparison) -> dict[str, Any]:
    loaded = compared.is_loaded

    return {
        "cases": int(loaded.sum()),
        "without_answer": compared.unanswered,
        "worst_mm": largest(compared.difference[loaded]),
        "worst_of_displacement": rounded(compared.worst),
        "median_of_displacement": rounded(compared.median),
        "worst_discretisation_mm": largest(compared.discretisation[loaded]),
        "worst_assumptions_mm": largest(compared.assumptions[loaded]),
        "worst_penalty_mm": largest(compared.penalty_error[loaded]),
        "worst_left_of_displacement": rounded(compared.left),
    }


def _solid(checked: Checked, index: int) -> dict[str, Any]:
    stage = checked.stages[index]
    results = [result for key, result in checked.results.items() if key[0] == stage.name]
    stable = [result.outcome.negative_eigenvalues for result in results]
    return {
        "mesh": stage.mesh,
        "c": stage.penalty,
        "element": stage.solid.element,
        **size_summary(stage.solid),
        **work_summary([result.outcome.statistics for result in results]),
        "converged": sum(result.status is Status.CONVERGED for result in results),
        "stability": _stability(stable),
    }


def _stability(negative: list[int | None]) -> str:
    if any(count is None for count in negative):
        return "not checked"
    unstable = sum(count > 0 for count in negative if count is not None)
    return "no negative eigenvalue in any case" if unstable == 0 else f"{unstable} cases unstable"


def _timing(checked: Checked) -> Iterator[tuple[str, float, str]]:
    """Processor time of the cases, summed over processes."""
    for stage in checked.stages:
        spent = [r.outcome.statistics for key, r in checked.results.items() if key[0] == stage.name]
        yield from timing_rows(stage.name, spent)
