"""The files of a refinement: design, stages, distances, figure."""

from __future__ import annotations

import itertools
import math
import os
from enum import Enum
from pathlib import Path
from typing import Any

from beamopt.base.provenance import provenance
from beamopt.judge.answer_tables import paths_csv, tips_table_csv
from beamopt.judge.judge import Judge, JudgeStatus, Verdict
from beamopt.refine.refine_design import Refinement
from beamopt.scene.design import load_design
from beamopt.scene.scene import Scene
from beamopt.storage.input_file import read_text
from beamopt.storage.result_folder import FolderKind
from beamopt.storage.writing import csv_text, json_text, write_atomic
from beamopt.target.target import Target

__all__ = [
    "KIND",
    "REFINEMENT_FILES",
    "EarlierRefinement",
    "becomes",
    "refinement_numbers",
    "set_aside",
    "write_refined_design",
    "write_refinement",
]

REFINEMENT_FILES = (
    "refined.json",
    "refinement.csv",
    "refined_tips.csv",
    "refined_paths.csv",
    "refined.svg",
    "refined.png",
)
"""Every file that `write_refinement` writes."""

OWN = (*REFINEMENT_FILES, "summary.json", "timing.csv")
KIND = FolderKind("a refinement", "provenance.json", ("{",), goes_on=False, files=OWN)
"""Folder of a refinement that is not a search's."""


class EarlierRefinement(Enum):
    """Fate of a refinement in the folder of a run; the value is the text for people."""

    NONE = "there was none"
    REPLACED = "refined anew"
    STAYS = "refined.json stays: it is of this best design"
    BETTER = "refined.json stays: what was found now is not better"
    SET_ASIDE = "refined.json was of an earlier best design and went to earlier-refinement-1, -2, …"


def write_refinement(
    folder: Path, scene: Scene, target: Target, found: Refinement, *, figures: bool = True
) -> None:
    """Write what was found to a folder that is there; each file whole or not at all."""
    found.design.save(folder / "refined.json")
    write_atomic(folder / "refinement.csv", stages_csv(found))
    if found.refined.after.status is not JudgeStatus.JUDGED:
        return
    question = Judge.of_scene(scene, target).question
    if len(target.aim):
        answers = question.of_section(found.design.values)[0]
        write_atomic(folder / "refined_tips.csv", tips_table_csv(target.aim, answers))
    if target.paths:
        counts = [len(path) for path in target.paths]
        reached = question.reach(found.design.values)
        write_atomic(folder / "refined_paths.csv", paths_csv(reached, counts))
    if figures:
        from beamopt.plot.figures import design_figure, design_title
        from beamopt.plot.style import save_figure

        figure = design_figure(found.design, target, f"{design_title(found.design)}, refined")
        save_figure(figure, folder / "refined.svg", folder / "refined.png")


def write_refined_design(folder: Path, scene: Scene, target: Target, found: Refinement) -> None:
    """The same with a summary, for a refinement that is not a search's: a folder of its own."""
    write_refinement(folder, scene, target, found)
    numbers = {"scene": scene.name, "seed": scene.search.seed, **refinement_numbers(found, scene)}
    write_atomic(folder / "summary.json", json_text(numbers))
    timing = [(name, seconds, "s") for name, seconds in found.times.items()]
    write_atomic(folder / "timing.csv", csv_text("what,value,unit", timing))
    write_atomic(folder / "provenance.json", json_text(provenance()))


def becomes(folder: Path, best: str | None, found: Refinement | None) -> EarlierRefinement:
    """What is to become of the refinement in a folder.

    best : the text of the run's best design now; that of the folder may be of an earlier one.
    found : of it, where it was refined now.

    Raises
    ------
    InputError : the refined design there is damaged.
    """
    there, earlier = folder / "refined.json", folder / "best.json"
    if not there.exists():
        return EarlierRefinement.NONE
    if not earlier.exists() or read_text(earlier) != best:
        return EarlierRefinement.SET_ASIDE
    if found is None:
        return EarlierRefinement.STAYS
    notes = load_design(there).notes
    is_better = notes.get("L", math.inf) + notes.get("R", 0.0) < found.refined.after.ruled_loss
    return EarlierRefinement.BETTER if is_better else EarlierRefinement.REPLACED


def set_aside(folder: Path) -> Path:
    """Move a refinement that is of an earlier best design into a folder of its own."""
    numbers = itertools.count(1)
    names = (folder / f"earlier-refinement-{number}" for number in numbers)
    aside = next(path for path in names if not os.path.lexists(path))
    aside.mkdir()
    for name in reversed(REFINEMENT_FILES):  # the design last: until then it can be done again
        if (folder / name).exists():
            (folder / name).replace(aside / name)
    return aside


def stages_csv(found: Refinement) -> str:
    """What every stage ended in: sections judged so far, L, K, R [mm²]."""
    rows = [
        (one.stage.value, one.round, one.evaluations, one.verdict.L, one.verdict.K, one.verdict.R)
        for one in found.refined.stages
        if one.verdict.status is JudgeStatus.JUDGED
    ]
    return csv_text("stage,round,evaluations,L,K,R", rows)


def refinement_numbers(found: Refinement, scene: Scene) -> dict[str, Any]:
    """How it ended and what it changed, without times."""
    refined, rules = found.refined, scene.making.rules_set
    return {
        "status": refined.status.value,
        "ended": refined.status.name,
        "before": _losses(refined.before, refined.ratio_before, rules),
        "after": _losses(refined.after, refined.ratio, rules),
        "faults": [str(fault) for fault in found.design.findings],
        "evaluations": refined.evaluations,
        "flips": refined.flips,
    }


def _losses(verdict: Verdict, ratio: float, rules: bool) -> dict[str, Any]:
    if verdict.status is not JudgeStatus.JUDGED:
        return {"status": verdict.status.value, "ended": verdict.status.name}
    ruled = {"R": verdict.R} if rules else {}
    return {"L": verdict.L, "K": verdict.K, **ruled, "T": verdict.T, "neighbour_ratio": ratio}
