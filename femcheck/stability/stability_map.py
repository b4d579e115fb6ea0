"""Making the map: every cell and path on any number of processes, then tables and figure."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from pathlib import Path
from typing import Any

from beamopt.base.errors import InputError
from beamopt.base.processes import processes
from beamopt.base.provenance import provenance, thread_settings
from beamopt.plot.style import save_figure
from beamopt.storage.campaign import Campaign, Pool, claimed_journal
from beamopt.storage.input_file import read_json
from beamopt.storage.line_journal import LineJournal
from beamopt.storage.result_folder import FolderKind
from beamopt.storage.writing import json_text, write_atomic
from femcheck.solved.folder import PACKAGES
from femcheck.stability.axis import Axis
from femcheck.stability.figure import map_figure
from femcheck.stability.found import AxisFound, found_of
from femcheck.stability.journal import ASKED, SUBJECT, line_of, results_in
from femcheck.stability.reading import reading
from femcheck.stability.tables import tables_of, timing_csv
from femcheck.stability.work import Key, MapWork, Result

__all__ = ["JOURNAL", "caption_of", "redraw_map", "run_map"]

JOURNAL = "journal.jsonl"
WRITTEN = "written_with"  # what tables and figure were made with, which may be later
FILES = (
    *("cases.csv", "limits.csv", "validity.csv", "reading.md", "timing.csv", "provenance.json"),
    *("stability.svg", "stability.png"),
)
KIND = FolderKind("a stability map", JOURNAL, ('{"schema":"femcheck-stability/',), files=FILES)

Progress = Callable[[Key, Result, int, int], None]


def run_map(
    out: Path,
    axes: Mapping[str, Axis],
    *,
    wanted: Collection[str] | None = None,
    workers: int = 1,
    resume: bool = False,
    progress: Progress | None = None,
    pool: Pool = processes,
    figures: bool = True,
) -> list[AxisFound]:
    """Solve what is not solved yet, and write everything to `out`.

    Parameters
    ----------
    axes : all panels by name.
    wanted : names of those to be solved now, None for all; what `out` has of others is drawn too.
    workers : tasks at once; no answer depends on it.
    resume : go on with what is in `out`.
    progress : called with each task, its result, how many are done and how many there are.
    pool : makes an executor of that many workers.

    Raises
    ------
    InputError : `out` holds something else, or the map of other specimens.
    """
    with claimed_journal(out, KIND, ASKED, SUBJECT, resume=resume) as journal:
        results = results_in(journal, axes)
        made = _solve(journal, results, axes, wanted, Campaign(workers, pool), progress)
        return _write(out, axes, results, made, figures)


def _solve(
    journal: LineJournal,
    results: dict[Key, Result],
    axes: Mapping[str, Axis],
    wanted: Collection[str] | None,
    campaign: Campaign,
    progress: Progress | None,
) -> dict[str, Any]:
    """Solve what is not among `results` yet; returns what the map is computed with."""
    known = {key: one for key, one in results.items() if not one.ending.is_interrupted}
    chosen = {name: axis for name, axis in axes.items() if wanted is None or name in wanted}
    work = MapWork(chosen, {key: one for key, one in known.items() if key[0] in chosen})
    before, total = len(work.results), len(work.keys)

    def keep(key: Key, result: Result) -> None:
        results[key] = result
        journal.add(line_of(axes[key[0]], key, result))
        if progress is not None:
            progress(key, result, len(work.results), total)

    campaign.solve(work, keep)
    threads = "1" if campaign.pool is processes else thread_settings()["MKL_NUM_THREADS"]
    made = {"workers": campaign.workers, "threads_of_a_worker": threads, **provenance(PACKAGES)}
    if len(work.results) == before:  # nothing was solved now
        made = _computed_before(journal.path.parent) or made
    return made


def redraw_map(out: Path, axes: Mapping[str, Axis], *, figures: bool = True) -> list[AxisFound]:
    """Write tables and figure again from the journal in `out`, and solve nothing.

    Raises
    ------
    InputError : there is no map in `out`, or it is that of other specimens.
    """
    path = out / JOURNAL
    if not path.exists():
        raise InputError(path, "", None, "no such file: there is no map to draw again")
    if path.is_file() and path.stat().st_size == 0:  # a journal would begin in it
        raise InputError(path, "", None, "is empty: there is no map to draw again")
    with claimed_journal(out, KIND, ASKED, SUBJECT, resume=True) as journal:
        results = results_in(journal, axes)
        if not results:
            raise InputError(path, "", None, f"holds nothing of {', '.join(axes)}")
        computed = _computed_before(out) or provenance(PACKAGES)
        return _write(out, axes, results, computed, figures)


def _computed_before(out: Path) -> dict[str, Any]:
    """What the map was computed with, as it was said then; empty if it was not."""
    try:
        said = read_json(out / "provenance.json")
        return {key: value for key, value in said.items() if key != WRITTEN}
    except InputError:
        return {}


def _write(
    out: Path,
    axes: Mapping[str, Axis],
    results: Mapping[Key, Result],
    computed: dict[str, Any],
    figures: bool,
) -> list[AxisFound]:
    """Everything but the journal; each file whole or not at all."""
    found = found_of(axes, results)
    for name, text in tables_of(found).items():
        write_atomic(out / name, text)
    write_atomic(out / "reading.md", reading(found))
    write_atomic(out / "timing.csv", timing_csv(axes, results))
    if figures:
        count = sum(1 for one in found for row in one.rows for _ in row.solved)
        title = f"Pressure in one supply: {count} cases, solved each by itself from rest"
        figure = map_figure(found, title, caption_of(computed))
        save_figure(figure, out / "stability.svg", out / "stability.png")
    made = {**computed, WRITTEN: provenance(PACKAGES)}
    write_atomic(out / "provenance.json", json_text(made))
    return found


def caption_of(computed: Mapping[str, Any]) -> str:
    """Threads, processor and versions, on one line."""
    versions, machine = computed.get("versions", {}), computed.get("machine", {})
    names = ("python", "beamopt", "numpy", "scipy", "scikit-fem", "gmsh", "pypardiso")
    said = ", ".join(f"{name} {versions[name]}" for name in names if name in versions)
    workers, threads = (computed.get(key, "?") for key in ("workers", "threads_of_a_worker"))
    processor = machine.get("processor", "?")
    return f"{workers} at once, threads of each: {threads}; {processor}; {said}"
