"""The folder of one search: scene, target, journal, and in the end designs, tables and figures."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from beamopt.base.errors import InputError
from beamopt.base.provenance import provenance
from beamopt.judge.answer_tables import paths_csv, tips_table_csv
from beamopt.judge.judge import JudgeStatus
from beamopt.refine.folder import (
    REFINEMENT_FILES,
    EarlierRefinement,
    becomes,
    refinement_numbers,
    set_aside,
    write_refinement,
)
from beamopt.scene.scene import Scene, load_scene
from beamopt.scene.toml_text import scene_text
from beamopt.search.history import GenerationNumbers
from beamopt.search.kept_scene import PATHS, SOURCES, scene_to_keep
from beamopt.search.result import Optimisation
from beamopt.search.run_summary import summary
from beamopt.storage.input_file import read_bytes, read_json
from beamopt.storage.result_folder import FolderKind, check_same, claimed
from beamopt.storage.timing import read_times, write_times
from beamopt.storage.writing import csv_text, json_text, still_complete, write_atomic, write_changed
from beamopt.target.point_table import aim_csv
from beamopt.target.target import Target

__all__ = ["RunFolder"]

GOES_ON = {"search.generations", "stop", "refine"}  # keys that may change when a run goes on

FIGURES = ("best.svg", "best.png", "convergence.svg", "convergence.png")
FILES = (
    "target.csv",
    *SOURCES.values(),
    *PATHS,
    "scene.toml",
    "history.csv",
    "tips.csv",
    "paths.csv",
    "best.json",
    "final.json",
    "summary.json",
    *FIGURES,
    *REFINEMENT_FILES,
    "timing.csv",
    "provenance.json",
)
KIND = FolderKind("a search", "journal.jsonl", ('{"schema":"beamopt-journal/',), files=FILES)


@dataclass(frozen=True, slots=True)
class RunFolder:
    """The files of a run."""

    path: Path

    @classmethod
    @contextmanager
    def open(cls, path: Path, *, resume: bool) -> Iterator[RunFolder]:
        """Make a run folder, or with `resume` take the one there; hold it meanwhile.

        Raises
        ------
        InputError : see `claimed`.
        """
        with claimed(path, KIND, resume=resume):
            yield cls(path)

    @property
    def journal(self) -> Path:
        """The append-only journal, which also tells that the folder is a run's."""
        return self.path / "journal.jsonl"

    @property
    def has_result(self) -> bool:
        """True if a search has ended here, or was interrupted and said so."""
        return (self.path / "provenance.json").exists()

    def check(self, scene: Scene) -> None:
        """Check that what is asked for is what the run there, if any, was asked for.

        Raises
        ------
        InputError : the run to go on with has another scene or target.
        """
        if (self.path / "scene.toml").exists():
            self._check_same(*scene_to_keep(scene))

    def begin(self, scene: Scene, target: Target) -> None:
        """Keep what is asked for; how the run there refined is changed with what it refined."""
        _, sources = scene_to_keep(scene)
        for name, content in sources.items():
            write_changed(self.path / name, content)
        if len(target.aim):
            write_changed(self.path / "target.csv", aim_csv(target.aim))
        text = self._scene_text(scene, refined_as_before=True)
        write_changed(self.path / "scene.toml", text)

    def _scene_text(self, scene: Scene, *, refined_as_before: bool) -> str:
        there = self.path / "scene.toml"
        if refined_as_before and there.exists():
            scene = scene.model_copy(update={"refine": load_scene(there).refine})
        kept, _ = scene_to_keep(scene)
        return scene_text(kept)

    def _check_same(self, scene: Scene, sources: dict[str, bytes]) -> None:
        """Refuse to go on with another scene's run, naming the first key that differs."""
        there = self.path / "scene.toml"
        old = load_scene(there).model_dump(by_alias=True)
        new = scene.model_dump(by_alias=True)
        if old["target"]["file"] is not None:
            old["target"]["file"] = Path(old["target"]["file"]).name
        old["target"]["paths"] = tuple(Path(path).name for path in old["target"]["paths"])
        check_same(there, old, new, "search", GOES_ON)
        for name, content in sources.items():
            kept = self.path / name
            if kept.exists() and read_bytes(kept) != content:
                raise InputError(kept, "", None, "differs from the file that the scene names now")

    def write_result(self, result: Optimisation, *, figures: bool = True) -> EarlierRefinement:
        """Write designs, tables and figures; each whole or not at all.

        What is there already stays as it is, the times too where nothing else changes. Where no
        candidate, or none of the last population, could be judged, there is no design to write as
        the best, or as the final one.

        Returns
        -------
        EarlierRefinement : what became of a refinement that was there.
        """
        found, judged = result.refinement, result.verdict.status is JudgeStatus.JUDGED
        best = result.best.json() if judged else None
        there = becomes(self.path, best, found)
        if there is EarlierRefinement.SET_ASIDE:
            set_aside(self.path)
        stays = there in (EarlierRefinement.STAYS, EarlierRefinement.BETTER)
        numbers, times = self._of_refinement(result, stays)
        texts = {
            "scene.toml": self._scene_text(result.scene, refined_as_before=stays),
            **_search_texts(result),
        }
        at_last = {"summary.json": json_text(summary(result) | numbers)}
        complete = still_complete(self.path, texts | at_last)
        self._write(texts)
        drawn = complete and all((self.path / name).exists() for name in FIGURES)
        if figures and _has_tables(result) and not drawn:
            self._draw(result)
        if found is not None and not stays:
            write_refinement(self.path, result.scene, result.target, found, figures=figures)
        self._write(at_last)
        if not complete:
            write_times(self.path / "timing.csv", result.timing, times)
            made = {"seed": result.scene.search.seed, **provenance()}
            write_atomic(self.path / "provenance.json", json_text(made))
        return there

    def _write(self, texts: Mapping[str, str]) -> None:
        for name, text in texts.items():
            write_changed(self.path / name, text)

    def _of_refinement(
        self, result: Optimisation, stays: bool
    ) -> tuple[dict[str, Any], dict[str, float]]:
        """What the summary says of the refinement in the folder, and its time; empty without."""
        found = result.refinement
        if stays:
            numbers, times = (self.path / name for name in ("summary.json", "timing.csv"))
            said = read_json(numbers).get("refinement") if numbers.exists() else None
            taken = {name: s for name, s in read_times(times).items() if name.startswith("refine")}
            return {} if said is None else {"refinement": said}, taken
        if found is None:
            return {}, {}
        return {"refinement": refinement_numbers(found, result.scene)}, found.times

    def _draw(self, result: Optimisation) -> None:
        from beamopt.plot.figures import convergence_figure, design_figure, design_title
        from beamopt.plot.style import save_figure

        title = design_title(result.best)
        lowest = [record.best_loss for record in result.history]
        ever = [record.ever_loss for record in result.history]
        mean = np.array([record.mean_loss for record in result.history])
        for name, figure in (
            ("best", design_figure(result.best, result.target, title)),
            ("convergence", convergence_figure(lowest, mean, ever, title)),
        ):
            save_figure(figure, self.path / f"{name}.svg", self.path / f"{name}.png")


def _search_texts(result: Optimisation) -> dict[str, str]:
    """Texts by file: findings of the search, and tips of the best design."""
    texts = {"history.csv": history_csv(result.history, result.scene.making.rules_set)}
    if result.verdict.status is not JudgeStatus.JUDGED:
        return texts
    texts["best.json"] = result.best.json()
    if result.last.best.verdict.status is JudgeStatus.JUDGED:
        texts["final.json"] = result.final.json()
    aim = result.target.aim
    if _has_tables(result) and len(aim):
        texts["tips.csv"] = tips_table_csv(aim, result.answers)
    if _has_tables(result) and result.reach is not None:
        counts = [len(path) for path in result.target.paths]
        texts["paths.csv"] = paths_csv(result.reach, counts)
    return texts


def _has_tables(result: Optimisation) -> bool:
    """True if the best design is judged as drawn; a sealed outline may not carry its loads."""
    judged = result.verdict.status is JudgeStatus.JUDGED
    return judged and math.isfinite(result.outline_loss)


def history_csv(history: Sequence[GenerationNumbers], with_rules: bool = False) -> str:
    """L [mm²] of each generation's population and of the best so far, with that one's K.

    With rules also its R [mm²], and how many candidates so far were not judged.
    """
    header = "generation,evaluations,lowest_L,mean_L,highest_L,lowest_T,best_ever_L,best_ever_K"
    header += ",best_ever_R,rejected" if with_rules else ""
    rows = []
    for one in history:
        spread = (one.lowest_loss, one.mean_loss, one.highest_loss, one.lowest_total)
        ruled = (one.ever_rule_loss, one.rejected) if with_rules else ()
        ever = (one.ever_loss, one.ever_neighbour_loss)
        rows.append((one.generation, one.evaluations, *spread, *ever, *ruled))
    return csv_text(header, rows)
