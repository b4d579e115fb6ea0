"""A check as tables: every tip, one line a pressure combination, and the verdict."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from beamopt.storage.writing import csv_text, json_text
from femcheck.check.checked import Checked
from femcheck.check.comparison import Comparison
from femcheck.continuation.ended import Ended
from femcheck.continuation.outcome import Status

__all__ = [
    "COMPARE",
    "both",
    "cells",
    "compare_csv",
    "plain",
    "summary",
    "table_csv",
    "tables_of",
    "verdict",
]

DIGITS = 6  # of a millimetre or a share: coarser than rounding, finer than any mesh

COMPARE = (
    "law,c,nu,mesh,p1,p2,p3,beam_x,beam_y,beam_z,solid_x,solid_y,solid_z,difference_mm,"
    "difference_of_length,difference_of_displacement,"
    "volume_ratio_1,volume_ratio_2,volume_ratio_3,status,ended"
)
TABLE = (
    "p1,p2,p3,beam_x,beam_y,beam_z,solid_x,solid_y,solid_z,difference_mm,difference_of_length,"
    "difference_of_displacement,discretisation_mm,assumptions_mm,penalty_mm,"
    "volume_ratio_1,volume_ratio_2,volume_ratio_3,status,ended,iterations"
)


def tables_of(checked: Checked) -> dict[str, str | None]:
    """All files that are text; None where there is nothing to say."""
    compared = checked.comparison
    return {
        "compare.csv": None if compared is None else compare_csv(checked),
        "table.csv": None if compared is None else table_csv(compared),
        "summary.json": json_text(summary(checked)),
        "timing.csv": csv_text("what,value,unit", _timing(checked)),
    }


def compare_csv(checked: Checked) -> str:
    """27 rows for every solid, computed (c finite) and extrapolated (c infinite)."""
    compared = checked.comparison
    rows = () if compared is None else _compare_rows(compared, checked.options.law)
    return csv_text(COMPARE, rows)


def _compare_rows(compared: Comparison, law: str) -> Iterator[tuple[object, ...]]:
    subject = compared.subject
    length = subject.design.actuator.length
    beam, displacement = subject.beam_tips, compared.displacement
    for solid in compared.solids:
        difference = np.linalg.norm(solid.tips - beam, axis=1)
        for row, pressures in enumerate(subject.pressures.tolist()):
            moved = displacement[row]
            yield (
                law,
                plain(solid.penalty),
                0.0,  # the law has no Poisson coupling
                solid.mesh,
                *map(plain, pressures),
                *cells(beam[row]),
                *cells(solid.tips[row]),
                *cells([difference[row], difference[row] / length]),
                *cells([difference[row] / moved if moved > 0 else math.nan]),
                *cells(solid.volume_ratios[row]),
                *both(solid.statuses[row]),
            )


def table_csv(compared: Comparison) -> str:
    """27 rows: beam, solid, difference and what it is made of."""
    subject = compared.subject
    length = subject.design.actuator.length
    columns = np.column_stack(
        [
            subject.beam_tips,
            compared.final.tips,
            compared.difference,
            compared.difference / length,
            np.where(compared.displacement > 0, compared.share, np.nan),
            compared.discretisation,
            compared.assumptions,
            compared.penalty_error,
            compared.final.volume_ratios,
        ]
    )
    pressures = subject.pressures.tolist()
    final = compared.final
    rows = zip(pressures, columns, final.statuses, final.iterations.tolist(), strict=True)
    return csv_text(
        TABLE,
        [(*map(plain, at), *cells(row), *both(status), spent) for at, row, status, spent in rows],
    )


def both(status: Status) -> tuple[str, str]:
    """Cells of the columns "status" and "ended": the text for people, the key for programs."""
    return status.value, Ended(status).key


def plain(value: float) -> object:
    """Whole numbers without a point, infinity as inf."""
    return int(value) if float(value).is_integer() else value


def cells(values: Any) -> list[object]:
    """Rounded, so that the last bits of a solver do not show; empty where there is no answer."""
    rounded = [round(float(value), DIGITS) + 0.0 for value in values]
    return [None if math.isnan(value) else value for value in rounded]


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
    outline = subject.outline
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
        "section": {
            "areas_mm2": [round(value, DIGITS) for value in outline.moments.raw[:, 0].tolist()],
            "chambers": [len(outline.chambers_of(supply)) for supply in (1, 2, 3)],
            "islands": len(outline.islands),
            "faults": [str(fault) for fault in checked.subject.design.findings],
        },
    }
    if subject.sealing_moved is not None:
        data["sealing_moved_mm"] = {
            "worst": round(float(subject.sealing_moved.max()), DIGITS),
            "median": round(float(np.median(subject.sealing_moved)), DIGITS),
        }
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

    def most(values: Any) -> float | None:
        answered = values[loaded & ~np.isnan(values)]
        return round(float(answered.max()), DIGITS) if answered.size else None

    return {
        "cases": int(loaded.sum()),
        "without_answer": compared.unanswered,
        "worst_mm": most(compared.difference),
        "worst_of_displacement": _number(compared.worst),
        "median_of_displacement": _number(compared.median),
        "worst_discretisation_mm": most(compared.discretisation),
        "worst_assumptions_mm": most(compared.assumptions),
        "worst_penalty_mm": most(compared.penalty_error),
        "worst_left_of_displacement": _number(compared.left),
    }


def _number(value: float) -> float | None:
    return None if math.isnan(value) else round(value, DIGITS)


def _solid(checked: Checked, index: int) -> dict[str, Any]:
    stage = checked.stages[index]
    results = [result for key, result in checked.results.items() if key[0] == stage.name]
    section, layers = stage.solid.section, stage.solid.heights.size - 1
    stable = [result.outcome.negative_eigenvalues for result in results]
    return {
        "mesh": stage.mesh,
        "c": stage.penalty,
        "element": stage.solid.element,
        "triangles": len(section.triangles),
        "layers": layers,
        "unknowns": _unknowns(stage.solid),
        "iterations": sum(result.outcome.statistics.iterations for result in results),
        "most_iterations": max(result.outcome.statistics.iterations for result in results),
        "converged": sum(result.status is Status.CONVERGED for result in results),
        "stability": _stability(stable),
    }


def _unknowns(solid: Any) -> int:
    return int(solid.body().unknowns)


def _stability(negative: list[int | None]) -> str:
    if any(count is None for count in negative):
        return "not checked"
    unstable = sum(count > 0 for count in negative if count is not None)
    return "no negative eigenvalue in any case" if unstable == 0 else f"{unstable} cases unstable"


def _timing(checked: Checked) -> Iterator[tuple[str, float, str]]:
    """Processor time of the cases, summed over processes."""
    for stage in checked.stages:
        spent = [r.outcome.statistics for key, r in checked.results.items() if key[0] == stage.name]
        for what in ("seconds", "assembly_seconds", "factor_seconds", "solve_seconds"):
            name = what.removesuffix("_seconds").replace("seconds", "all")
            yield f"{stage.name} {name}", sum(getattr(one, what) for one in spent), "s"
