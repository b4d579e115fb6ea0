"""Searches at equal budgets: loss against sections judged, and against processor time."""

from __future__ import annotations

import hashlib
import statistics
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import astuple, dataclass

from beamopt.bound.certificate import quick_certificate
from beamopt.judge.judge import Judge
from beamopt.scene.scene import Scene, load_scene
from beamopt.storage.line_journal import LineJournal
from beamopt.storage.writing import csv_text, write_atomic
from tests.bench.measured import QUICK, REPORTS, ROOT, Measured, save_growth
from tests.bench.search_figure import search_figure
from tests.bench.search_methods import METHODS, PAPER, Method, with_search
from tests.bench.search_tape import BudgetSpentError, Mark, Tape, TapedJudge, counted_flips

__all__ = ["Curves", "curve", "measure", "table"]

PAPERS = 60 if QUICK else 1820  # sections that the paper's search judges
SECOND = 1.0  # s of processor time at which the methods are compared
SEEDS = range(2 if QUICK else 5)
MOST = 4  # times the paper's budget
TIMES = {"random-section": MOST, "hand-drawn-workspace": MOST, "sealed-section": 1}
"""The budget in searches of the paper's; a sealed section takes many times as long to judge."""

TIMES_OF = {"refine": MOST, "GA, then refine": MOST, "memetic GA": 1}
"""Two that end by themselves, long before; one that takes as long for it as others for four."""

Curves = Mapping[str, Sequence[Sequence[Mark]]]
"""Of each method, the marks of each seed."""


@dataclass(frozen=True)
class Compared:
    """A scene's searches; bound : below what L can not be [mm²]."""

    scene: str
    bound: float
    curves: Curves


def measure() -> Iterator[Measured]:
    """Every method on every scene; what is there already is kept where a run was stopped."""
    journal = _journal()
    compared = [_compared(name, journal) for name in TIMES]
    REPORTS.mkdir(parents=True, exist_ok=True)
    write_atomic(REPORTS / "search_curves.csv", _curves_csv(compared))
    panels = [(each.scene, each.bound, each.curves) for each in compared]
    save_growth(search_figure(panels, PAPERS, SECOND), "search")
    for each in compared:
        yield from table(each)
    journal.path.unlink()


def curve(method: Method, scene: Scene, seed: int, budget: int) -> tuple[Mark, ...]:
    """The marks of one search, on any processor time, with at most `budget` sections judged."""
    judge = Judge.of_scene(scene, scene.load_target())
    tape = Tape(budget, (PAPERS,))
    with suppress(BudgetSpentError), counted_flips(tape):
        method(with_search(scene, {"seed": seed}), TapedJudge.of(judge, tape))
    return tape.finished()


def _compared(name: str, journal: LineJournal) -> Compared:
    scene = load_scene(name)
    curves: dict[str, list[tuple[Mark, ...]]] = {method: [] for method in METHODS}
    kept = {(entry["scene"], entry["method"], entry["seed"]): entry for entry in journal.entries}
    quick = with_search(scene, {"generations": 1})
    if any((name, what, seed) not in kept for what in METHODS for seed in SEEDS):
        for method in METHODS.values():
            curve(method, quick, 0, 60)  # compiles
    for seed in SEEDS:
        for what, method in METHODS.items():  # in turn, so that a slow moment hits all
            entry = kept.get((name, what, seed))
            if entry is None:
                budget = PAPERS * TIMES_OF.get(what, TIMES[name])
                marks = [astuple(mark) for mark in curve(method, scene, seed, budget)]
                entry = {"scene": name, "method": what, "seed": seed, "marks": marks}
                journal.add(entry)
            curves[what].append(tuple(Mark(*mark) for mark in entry["marks"]))
    response = quick_certificate(scene, scene.load_target()).response
    assert response is not None
    return Compared(name, response.loss, curves)


def table(compared: Compared) -> Iterator[Measured]:
    """Medians over the seeds at the paper's budget, at a second, and in the end."""
    name = compared.scene
    yield Measured(f"{name}: bound of L", compared.bound, "mm²")
    for method, runs in compared.curves.items():
        start = f"{name}, {method}"
        papers = [at_evaluations(marks, PAPERS) for marks in runs]
        budget = f"at {PAPERS:,} sections judged"
        yield Measured(f"{start}: L {budget}", _median([m.L for m in papers]), "mm²")
        yield Measured(f"{start}: L {budget}, best seed", min(m.L for m in papers), "mm²")
        yield Measured(f"{start}: L {budget}, worst seed", max(m.L for m in papers), "mm²")
        yield Measured(f"{start}: its ratio r {budget}", _median([m.ratio for m in papers]), "1")
        yield Measured(f"{start}: lowest T {budget}", _median([m.T for m in papers]), "mm²")
        second = [at_seconds(marks, SECOND) for marks in runs]
        of_time = f"at {SECOND:g} s of processor time"
        yield Measured(f"{start}: L {of_time}", _median([m.L for m in second]), "mm²")
        last = [marks[-1] for marks in runs]
        yield Measured(f"{start}: L in the end", _median([m.L for m in last]), "mm²")
        yield Measured(f"{start}: its ratio r in the end", _median([m.ratio for m in last]), "1")
        judged = _median([m.evaluations for m in last])
        yield Measured(f"{start}: in all", judged, "sections judged")
        yield Measured(f"{start}: in all", _median([m.seconds for m in last]), "s of CPU")
        if any(m.flips for m in last):
            flips = _median([m.flips for m in last])
            yield Measured(f"{start}: in all", flips, "flips proposed to the model")
    yield from _overtaking(compared)


def _overtaking(compared: Compared) -> Iterator[Measured]:
    """When the refinement is below the best of the paper's four at its budget, in the median."""
    papers = min(
        _median([at_evaluations(marks, PAPERS).L for marks in compared.curves[f"paper {name}"]])
        for name in PAPER
    )
    runs = compared.curves["refine"]
    below = [next((m for m in marks if papers >= m.L), None) for marks in runs]
    if all(below):
        start = f"{compared.scene}, refine: until it is below the best of the paper's four"
        found = [mark for mark in below if mark is not None]
        yield Measured(start, _median([m.evaluations for m in found]), "sections judged")
        yield Measured(start, _median([m.seconds for m in found]), "s of CPU")


def at_evaluations(marks: Sequence[Mark], count: int) -> Mark:
    """The last mark with no more than `count` sections judged."""
    return [mark for mark in marks if mark.evaluations <= count][-1]


def at_seconds(marks: Sequence[Mark], seconds: float) -> Mark:
    """The last mark within `seconds`; the first one where there is none."""
    return ([mark for mark in marks if mark.seconds <= seconds] or [marks[0]])[-1]


def _median(values: Sequence[float]) -> float:
    return float(statistics.median(values))


def _curves_csv(compared: Sequence[Compared]) -> str:
    rows = [
        (each.scene, method, seed, *_cells(mark))
        for each in compared
        for method, runs in each.curves.items()
        for seed, marks in zip(SEEDS, runs, strict=True)
        for mark in marks
    ]
    return csv_text("scene,method,seed,evaluations,seconds,L,ratio,lowest_T,flips", rows)


def _cells(mark: Mark) -> tuple[object, ...]:
    losses = f"{mark.L:.6g}", f"{mark.ratio:.4g}", f"{mark.T:.6g}"
    return mark.evaluations, f"{mark.seconds:.4g}", *losses, mark.flips


def _journal() -> LineJournal:
    """Of what is measured already with the code that is there now."""
    folder = ROOT / "runs" / "bench-partial"
    folder.mkdir(parents=True, exist_ok=True)
    state = hashlib.blake2b(digest_size=6)
    here = [ROOT / "tests" / "bench" / f"search_{part}.py" for part in ("methods", "tape")]
    for path in (*sorted((ROOT / "beamopt").rglob("*.py")), *here):
        state.update(path.read_bytes())
    asked = {"papers": PAPERS, "times": TIMES, "of": TIMES_OF, "seeds": len(SEEDS)}
    return LineJournal(folder / f"search-{PAPERS}-{state.hexdigest()}.jsonl", asked, "benchmark")
