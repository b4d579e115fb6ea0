"""The folder of one search: scene, target, journal, and in the end designs, tables and figures."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from beamopt.actuator import Loading, RodRules
from beamopt.aim import Aim
from beamopt.arrays import FloatArray
from beamopt.bound_folder import bound_summary
from beamopt.errors import InputError
from beamopt.evolve.algorithm import Generation
from beamopt.files import csv_text, json_text, write_atomic
from beamopt.folder import claim_folder, clear_leftovers
from beamopt.judge import Status, Verdict
from beamopt.kept_scene import PATHS, SOURCES, scene_to_keep
from beamopt.pairs import aim_csv
from beamopt.provenance import provenance
from beamopt.reach.reach import TOLERANCE
from beamopt.refinement_folder import REFINEMENT_FILES, refinement_numbers, write_refinement
from beamopt.result import Optimisation
from beamopt.result_tables import paths_csv, tips_table_csv
from beamopt.scene import Scene, load_scene
from beamopt.scene_text import scene_text
from beamopt.target import Target

__all__ = ["RunFolder"]

GOES_ON = {"search.generations", "stop", "refine"}  # keys that may change when a run goes on

FIGURES = ("best.svg", "best.png", "convergence.svg", "convergence.png")
BEGINNING = (
    "journal.jsonl",
    "target.csv",
    *SOURCES.values(),
    *PATHS,
)  # may be there before scene.toml
NAMES = (
    *BEGINNING,
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


@dataclass(frozen=True, slots=True)
class RunFolder:
    """The files of a run."""

    path: Path

    @classmethod
    def open(cls, path: Path, *, resume: bool) -> RunFolder:
        """Make a run folder, or with `resume` take the one there.

        Raises
        ------
        InputError : it holds something already, or something else, or can not be written.
        """
        claim_folder(path, "scene.toml", BEGINNING, resume=resume)
        return cls(path)

    @property
    def journal(self) -> Path:
        """The append-only journal; whoever holds its lock may write to the folder."""
        return self.path / "journal.jsonl"

    def begin(self, scene: Scene, target: Target) -> None:
        """Keep what is asked for, or check that it is what the run there was asked for.

        Raises
        ------
        InputError : the run to go on with has another scene or target.
        """
        kept, sources = scene_to_keep(scene)
        if (self.path / "scene.toml").exists():
            self._check_same(kept, sources)
        clear_leftovers(self.path, NAMES)
        for name, content in sources.items():
            write_atomic(self.path / name, content)
        if len(target.aim):
            write_atomic(self.path / "target.csv", aim_csv(target.aim))
        write_atomic(self.path / "scene.toml", scene_text(kept))

    def _check_same(self, scene: Scene, sources: dict[str, bytes]) -> None:
        """Refuse to go on with another scene's run, naming the first key that differs."""
        there = self.path / "scene.toml"
        old = load_scene(there).model_dump(by_alias=True)
        new = scene.model_dump(by_alias=True)
        if old["target"]["file"] is not None:
            old["target"]["file"] = Path(old["target"]["file"]).name
        old["target"]["paths"] = tuple(Path(path).name for path in old["target"]["paths"])
        for key, before, now in _differences(old, new):
            raise InputError(there, key, before, f"the run to go on with; now asked for: {now}")
        for name, content in sources.items():
            kept = self.path / name
            if kept.exists() and kept.read_bytes() != content:
                raise InputError(kept, "", None, "differs from the file that the scene names now")

    def write_result(self, result: Optimisation, *, figures: bool = True) -> None:
        """Write designs, tables and figures; each whole or not at all.

        Where no candidate, or none of the last population, could be judged, there is no design to
        write as the best, or as the final one.
        """
        rules = result.scene.making.rules_set
        write_atomic(self.path / "history.csv", history_csv(result.history, rules))
        if result.verdict.status is Status.JUDGED:
            result.best.save(self.path / "best.json")
            if result.history[-1].best.verdict.status is Status.JUDGED:
                result.final.save(self.path / "final.json")
            if math.isfinite(result.outline_loss):  # a sealed outline may not carry its loads
                self._write_tables(result)
                if figures:
                    self._draw(result)
        refinement = result.refinement
        if refinement is None:  # what is there belongs to an earlier best
            for name in REFINEMENT_FILES:
                (self.path / name).unlink(missing_ok=True)
        else:
            write_refinement(self.path, result.scene, result.target, refinement, figures=figures)
        write_atomic(self.path / "summary.json", json_text(summary(result)))
        timing = [
            ("search", result.seconds, "s"),
            ("evaluation", result.seconds / result.evaluations, "s"),
        ]
        if refinement is not None:
            timing.append(("refinement", refinement.seconds, "s"))
        write_atomic(self.path / "timing.csv", csv_text("what,value,unit", timing))
        made = {"seed": result.scene.search.seed, **provenance()}
        write_atomic(self.path / "provenance.json", json_text(made))

    def _write_tables(self, result: Optimisation) -> None:
        """What the best design's tip does."""
        aim = result.target.aim
        if len(aim):
            write_atomic(self.path / "tips.csv", tips_table_csv(aim, result.answers))
        if result.reach is not None:
            counts = [len(path) for path in result.target.paths]
            write_atomic(self.path / "paths.csv", paths_csv(result.reach, counts))

    def _draw(self, result: Optimisation) -> None:
        from beamopt.plot.figures import convergence_figure, design_figure, design_title
        from beamopt.plot.style import save_figure

        title = design_title(result.best)
        lowest = [record.best.verdict.L for record in result.history]
        ever = [record.best_ever.verdict.L for record in result.history]
        mean = np.array([np.mean(_losses(record)) for record in result.history])
        for name, figure in (
            ("best", design_figure(result.best, result.target, title)),
            ("convergence", convergence_figure(lowest, mean, ever, title)),
        ):
            save_figure(figure, self.path / f"{name}.svg", self.path / f"{name}.png")


def summary(result: Optimisation) -> dict[str, Any]:
    """How a search ended and what it found, without times."""
    pieces = result.best.section.pieces
    return (
        {
            "status": result.status.value,
            "ended": result.status.name,
            "scene": result.scene.name,
            "seed": result.scene.search.seed,
            "generations": result.history[-1].index,
            "evaluations": result.evaluations,
            "best": _summary_of(result.verdict, result.target.aim)
            | {"islands": pieces.islands, "chambers": list(pieces.chambers)},
            "final": _summary_of(result.history[-1].best.verdict, result.target.aim),
            "warnings": list(result.target.warnings),
        }
        | {"bound": bound_summary(result.bound, result.verdict.L)}
        | _making(result)
        | _rod(result)
        | _outline(result)
        | _paths(result)
        | _refinement(result)
    )


def _refinement(result: Optimisation) -> dict[str, Any]:
    """What refining the best design came to; nothing where nobody asked."""
    found = result.refinement
    return {} if found is None else {"refinement": refinement_numbers(found, result.scene)}


def _making(result: Optimisation) -> dict[str, Any]:
    """What the rules for what can be made did; nothing without any."""
    if not result.scene.making.rules_set:
        return {}
    counts = result.history[-1].rejected
    rejected = {status.name: counts[status] for status in Status if status in counts}
    best = result.history[-1].best_ever.verdict
    weighted = {"best_R": best.R} if best.status is Status.JUDGED else {}
    return {"rejected": rejected, **weighted}


def _rod(result: Optimisation) -> dict[str, Any]:
    """How the rod is solved; nothing for the paper's arc."""
    scene, climb = result.scene, result.scene.climb
    if (scene.rod, scene.loads) == (RodRules(), Loading()):
        return {}
    said = {"rung": climb.model.rung.value, "reason": climb.reason}
    moved = result.neglected if result.verdict.status is Status.JUDGED else None
    if moved is None:
        return {"rod": said}
    there = moved if math.isfinite(moved) else Status.NO_EQUILIBRIUM.value
    return {"rod": said | {"neglected_loads_move_mm": there}}


def _outline(result: Optimisation) -> dict[str, Any]:
    """What the best design is once it is polygons; nothing for an unsealed one."""
    sealed = result.best.seal.rules.sealed and result.verdict.status is Status.JUDGED
    if not sealed:
        return {}
    faults = [str(fault) for fault in result.best.outline.faults]
    if not math.isfinite(result.outline_loss):
        return {"outline": {"status": Status.NO_EQUILIBRIUM.value, "faults": faults}}
    rms = result.target.aim.rms_distance(result.outline_loss)
    return {"outline": {"L": result.outline_loss, "rms_distance": rms, "faults": faults}}


def _paths(result: Optimisation) -> dict[str, Any]:
    """How the best design follows trajectories; nothing without any."""
    judged = result.verdict.status is Status.JUDGED
    if not judged or result.reach is None or np.isnan(result.reach.distances).any():
        return {}
    distances = result.reach.distances
    reached = int((distances <= TOLERANCE).sum())
    said = {"samples": len(distances), "reached": reached, "tolerance": TOLERANCE}
    return {"paths": said | {"largest_distance": float(distances.max())}}


def _summary_of(verdict: Verdict, aim: Aim) -> dict[str, Any]:
    if verdict.status is not Status.JUDGED:
        return {"status": verdict.status.value}
    rms = aim.rms_distance(verdict.L)
    losses = {"L": verdict.L, "K": verdict.K, "T": verdict.T, "rms_distance": rms}
    return {"status": verdict.status.value, **losses}


def history_csv(history: tuple[Generation, ...], with_rules: bool = False) -> str:
    """L [mm²] of each generation's population and of the best so far, with that one's K.

    With rules also its R [mm²], and how many candidates so far were not judged.
    """
    header = "generation,evaluations,lowest_L,mean_L,highest_L,lowest_T,best_ever_L,best_ever_K"
    header += ",best_ever_R,rejected" if with_rules else ""
    rows = []
    for record in history:
        losses = _losses(record)
        lowest_T = min(one.verdict.T for one in record.population)
        ever = record.best_ever.verdict
        spread = (float(losses.min()), float(losses.mean()), float(losses.max()))
        ruled = (ever.R, sum(record.rejected.values())) if with_rules else ()
        rows.append((record.index, record.evaluations, *spread, lowest_T, ever.L, ever.K, *ruled))
    return csv_text(header, rows)


def _losses(record: Generation) -> FloatArray:
    return np.array([one.verdict.L for one in record.population])


def _differences(old: Any, new: Any, key: str = "") -> Iterator[tuple[str, Any, Any]]:
    if isinstance(old, dict) and isinstance(new, dict):
        for name in new:
            inner = f"{key}.{name}" if key else name
            if inner not in GOES_ON:
                yield from _differences(old.get(name), new[name], inner)
    elif old != new:
        yield key, old, new
