"""The stability map: many random sections under many loads, on any number of processes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from beamopt.base.errors import InputError
from beamopt.base.tasks import Tasks
from beamopt.rod_map.journal import SampleJournal
from beamopt.rod_map.map_report import NAMES, write_map
from beamopt.rod_map.sampling import METHODS, Sample, solve_sample
from beamopt.storage.campaign import Campaign
from beamopt.storage.result_folder import FolderKind, claimed

__all__ = ["run_stability"]

JOURNAL = "journal.jsonl"
KIND = FolderKind(
    "a stability map of rods", JOURNAL, ('{"schema":"beamopt-stability/',), files=NAMES
)


def run_stability(
    out: Path,
    samples: int = 1000,
    *,
    workers: int = 1,
    seed: int = 0,
    methods: Sequence[str] = METHODS,
    resume: bool = False,
    callback: Callable[[Sample, int], None] | None = None,
    figures: bool = True,
) -> list[Sample]:
    """Solve all samples with all methods and write tables, maps and their reading to `out`.

    Parameters
    ----------
    workers : processes; no answer depends on it, only times do.
    methods : names, of `sampling.METHODS`.
    resume : go on with a map that was cut short.
    callback : called with each sample as it comes, and how many are done.

    Raises
    ------
    InputError : `out` holds something else, or more samples, or can not be written.
    NotComputedError : the processes of some samples died; all others are done.
    """
    with claimed(out, KIND, resume=resume):
        journal = SampleJournal(out / JOURNAL, {"seed": seed, "methods": list(methods)})
        more = max(journal.samples, default=-1) + 1
        if more > samples:
            said = f"at least {more}, as the map there has; or name another folder"
            raise InputError("--samples", "", samples, said)
        _solve(journal, range(samples), seed, workers, methods, callback)
        ordered = [journal.samples[index] for index in range(samples)]
        write_map(out, ordered, seed, figures=figures)
        journal.path.unlink()  # all of it stands in the tables
    return ordered


def _solve(
    journal: SampleJournal,
    samples: Sequence[int],
    seed: int,
    workers: int,
    methods: Sequence[str],
    callback: Callable[[Sample, int], None] | None,
) -> None:
    """Solve the samples that the journal does not have."""
    missing = [index for index in samples if index not in journal.samples]
    work = Tasks(solve_sample, {index: (seed, index, methods) for index in missing})

    def store(_: int, sample: Sample) -> None:
        journal.add(sample)
        if callback is not None:
            callback(sample, len(journal.samples))

    Campaign(workers).solve_every(work, store, "--resume solves samples again")
