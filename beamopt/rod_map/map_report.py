"""What a stability map leaves to read: every answer, rates, maps, and what they say."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from beamopt.base.provenance import provenance
from beamopt.plot.stability_map import Cell, Panel, map_figure
from beamopt.plot.style import save_figure
from beamopt.rod_map.cases import SLENDERNESSES, CaseKind, sizes_of
from beamopt.rod_map.reading import reading
from beamopt.rod_map.sampling import LIMIT, MethodSample, Sample
from beamopt.rod_map.summary import commonest, rates_of
from beamopt.rod_map.verdict import MethodVerdict
from beamopt.storage.writing import csv_text, json_text, write_atomic

__all__ = ["NAMES", "write_map"]

ANSWERS = (
    "kind,size,slenderness,seed,method,resolution,verdict,judged,status,ended,distance,seconds"
)
TRUTHS = "seed,kind,size,slenderness,witness,truth,gap,known_by,ended"
NAMES = (
    *("stability.csv", "truth.csv", "success.csv", "reading.md", "provenance.json"),
    *(f"{figure}.{ending}" for figure in ("stability", "slenderness") for ending in ("svg", "png")),
)
"""Every file that `write_map` writes."""


def write_map(folder: Path, samples: Sequence[Sample], seed: int, *, figures: bool) -> None:
    """Write everything; each file whole or not at all."""
    write_atomic(folder / "stability.csv", _answers_csv(samples))
    write_atomic(folder / "truth.csv", _truths_csv(samples))
    write_atomic(folder / "success.csv", _success_csv(samples))
    write_atomic(folder / "reading.md", reading(samples))
    if figures:
        _draw(folder, samples)
    made = {"seed": seed, "samples": len(samples), "seconds_a_case": LIMIT}
    write_atomic(folder / "provenance.json", json_text(made | provenance()))


def _answers_csv(samples: Sequence[Sample]) -> str:
    rows = [
        (
            *(row.case.kind.value, row.case.size, row.case.slenderness, row.case.index),
            *(row.method, row.resolution, row.verdict.value, row.verdict.name),
            *(row.status.value, row.status.name, _rounded(row.distance), _rounded(row.seconds)),
        )
        for sample in samples
        for row in sample.rows
    ]
    return csv_text(ANSWERS, rows)


def _truths_csv(samples: Sequence[Sample]) -> str:
    rows = []
    for one in samples:
        case, truth = one.case, (one.witness.value, one.truth.value, _rounded(one.gap))
        names = one.witness.name, one.truth.name
        rows.append((case.index, case.kind.value, case.size, case.slenderness, *truth, *names))
    return csv_text(TRUTHS, rows)


def _rounded(value: float) -> float | None:
    return None if np.isnan(value) else float(f"{value:.3g}")


def _success_csv(samples: Sequence[Sample]) -> str:
    """A row a method and kind of load, and one a method for all of them."""
    names = [verdict.name.lower() for verdict in MethodVerdict]
    lines = []
    for method in _methods(samples):
        for kind in (*CaseKind, None):
            rows = _rows(samples, lambda row, m=method, k=kind: _is(row, m, k))  # type: ignore[misc]
            if not rows:
                continue
            rates = rates_of(rows)
            counts = [rates.verdicts[verdict] for verdict in MethodVerdict]
            shares = (_rounded(rates.success), _rounded(rates.wrong_tips), _rounded(rates.seconds))
            lines.append((method, kind.value if kind else "all", rates.cases, *counts, *shares))
    header = f"method,kind,cases,{','.join(names)},success,wrong_tips,median_seconds"
    return csv_text(header, lines)


def _is(row: MethodSample, method: str, kind: CaseKind | None) -> bool:
    return row.method == method and kind in (None, row.case.kind)


def _rows(samples: Sequence[Sample], wanted: Callable[[MethodSample], bool]) -> list[MethodSample]:
    return [row for sample in samples for row in sample.rows if wanted(row)]


def _methods(samples: Sequence[Sample]) -> list[str]:
    return list(dict.fromkeys(row.method for sample in samples for row in sample.rows))


def _draw(folder: Path, samples: Sequence[Sample]) -> None:
    count = f"{len(samples):,} random sections under load"
    of_kinds = {kind: [one for one in samples if one.case.kind is kind] for kind in CaseKind}
    by_size = [
        _panel(
            kind.text,
            found,
            [(f"{size:g}", size) for size in sizes_of(kind)],
            lambda row: row.case.size,
        )
        for kind, found in of_kinds.items()
        if found  # few samples have not all kinds
    ]
    texts = {verdict.name: verdict.value for verdict in MethodVerdict}
    title = f"{count}: commonest verdict and median time"
    figure = map_figure(by_size, title, texts=texts)
    save_figure(figure, folder / "stability.svg", folder / "stability.png")
    columns = [(f"{value:g}", value) for value in SLENDERNESSES]
    panel = _panel(
        "length over diameter, all loads",
        samples,
        columns,
        lambda row: row.case.slenderness,
        with_share=True,
    )
    title = f"{count}: commonest verdict, success, time"
    figure = map_figure([panel], title, across=1, texts=texts)
    save_figure(figure, folder / "slenderness.svg", folder / "slenderness.png")


def _panel(
    title: str,
    samples: Sequence[Sample],
    columns: Sequence[tuple[str, float]],
    value_of: Callable[[MethodSample], float],
    *,
    with_share: bool = False,
) -> Panel:
    """A map of some samples, whose column is the value that `value_of` finds.

    with_share : of successes, in each cell; of many loads together the commonest says little.
    """
    methods = _methods(samples)
    found: dict[tuple[str, float], list[MethodSample]] = {}
    for sample in samples:
        for row in sample.rows:
            found.setdefault((row.method, value_of(row)), []).append(row)
    cells = [
        [_cell(found.get((method, value), []), with_share) for _, value in columns]
        for method in methods
    ]
    return Panel(title, methods, [text for text, _ in columns], cells)


def _cell(rows: Sequence[MethodSample], with_share: bool) -> Cell | None:
    if not rows:
        return None
    usual = commonest(rows)
    flagged = any(row.verdict.is_wrong_tip for row in rows) and not usual.is_wrong_tip
    rates = rates_of(rows)
    share = rates.success if with_share and rates.decided else None
    return Cell(usual.name, rates.seconds, flagged, share)
