"""The folder of a front: table, designs, figure."""

from __future__ import annotations

import re
from collections.abc import Collection
from pathlib import Path

from beamopt.base.provenance import provenance
from beamopt.bound.folder import bound_summary
from beamopt.judge.judge import Judge, JudgeStatus
from beamopt.pareto.front import Front, design_name, designs_of, front_csv
from beamopt.pareto.scores import BEST, OBJECTIVES
from beamopt.scene.design import Design
from beamopt.scene.scene import Scene
from beamopt.scene.toml_text import scene_text
from beamopt.search.kept_scene import PATHS, SOURCES, scene_to_keep
from beamopt.storage.result_folder import FolderKind
from beamopt.storage.timing import write_times
from beamopt.storage.writing import csv_text, json_text, still_complete, write_atomic, write_changed

__all__ = ["KIND", "begin_folder", "write_front"]

FIGURES = ("pareto.svg", "pareto.png")
DESIGN = re.compile(r"front-\d{3,}\.json")
FILES = (
    *("scene.toml", *SOURCES.values(), *PATHS, "front-*.json", "front.csv"),
    *("history.csv", "summary.json", *FIGURES, "timing.csv", "provenance.json"),
)
KIND = FolderKind("a front", "journal.jsonl", ('{"schema":"beamopt-pareto/',), files=FILES)


def begin_folder(folder: Path, scene: Scene) -> None:
    """Keep the question beside the journal: the scene, and copies of its target's files."""
    kept, sources = scene_to_keep(scene)
    for name, content in sources.items():
        write_changed(folder / name, content)
    write_changed(folder / "scene.toml", scene_text(kept))


def write_front(folder: Path, front: Front, judge: Judge, *, figures: bool = True) -> None:
    """Write table, designs and figure to a folder with its question; each whole or not at all.

    What is there already stays as it is, the times too where nothing else changes.
    """
    designs = designs_of(front)
    names = {k: design_name(k) for k in designs}
    # the table before the designs: a kill leaves none that it does not name
    texts = {"front.csv": front_csv(front, judge)}
    texts |= {names[k]: design.json() for k, design in designs.items()}
    texts["history.csv"] = _history_csv(front)
    texts["summary.json"] = json_text(_summary(front))
    complete = still_complete(folder, texts)
    _delete_designs(folder, names.values())
    for name, text in texts.items():
        write_changed(folder / name, text)
    drawn = complete and all((folder / name).exists() for name in FIGURES)
    if figures and front.designs and not drawn:
        _draw(folder, front, designs)
    if not complete:
        write_times(folder / "timing.csv", front.timing, {})
        made = {"seed": front.scene.search.seed, **provenance(["pymoo", "moocore"])}
        write_atomic(folder / "provenance.json", json_text(made))


def _delete_designs(folder: Path, wanted: Collection[str]) -> None:
    """Delete the designs that the table in the folder names, and that are not `wanted` now."""
    table = folder / "front.csv"
    if not table.exists():
        return
    lines = table.read_text(encoding="utf-8", errors="replace").split("\n")
    cells = [cell for line in lines for cell in line.split(",")]
    for name in set(cells).difference(wanted):
        if DESIGN.fullmatch(name):
            (folder / name).unlink(missing_ok=True)


def _history_csv(front: Front) -> str:
    lowest = [f"lowest_{name}" for name in front.objectives]
    rows = []
    for record in front.history:
        least = record.values.min(axis=0).tolist() if len(record.values) else [None] * len(lowest)
        rows.append((record.index, record.evaluations, len(record.values), *least))
    return csv_text(",".join(["generation", "evaluations", "front", *lowest]), rows)


def _summary(front: Front) -> dict[str, object]:
    """How it ended and what it found, without times."""
    rejected = {one.name: front.rejected[one] for one in JudgeStatus if one in front.rejected}
    return {
        "status": front.status.value,
        "ended": front.status.name,
        "scene": front.scene.name,
        "seed": front.scene.search.seed,
        "objectives": list(front.objectives),
        "population": front.population,
        "generations": front.history[-1].index,
        "evaluations": front.evaluations,
        "front": len(front.designs),
        "knee": front.knee if front.designs else None,
        "bound": bound_summary(front.bound, front.lowest_loss),
        "rejected": rejected,
    }


def _draw(folder: Path, front: Front, designs: dict[int, Design]) -> None:
    from beamopt.plot.pareto import pareto_figure
    from beamopt.plot.style import save_figure

    second = front.objectives[1]
    least = int(front.values[:, 1].argmin())
    titles = {
        least: BEST[second],
        front.knee: "knee" if front.bends else "middle",
        0: BEST["L"],
    }
    kept = dict.fromkeys((0, front.knee, least))
    figure = pareto_figure(
        front.values[:, :2],
        front.seen[:, :2],
        [OBJECTIVES[name] for name in front.objectives[:2]],
        [(k, titles[k], designs[k]) for k in kept],
        f"{front.scene.name}: {len(front.designs)} designs of {front.evaluations} judged",
    )
    save_figure(figure, *(folder / name for name in FIGURES))
