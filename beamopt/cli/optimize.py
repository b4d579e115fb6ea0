"""`beamopt optimize`."""

from __future__ import annotations

import math
import shlex
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import typer

from beamopt.cli.bound import gap_text
from beamopt.cli.exit_codes import ExitCode
from beamopt.cli.findings import say_findings
from beamopt.cli.progress import console, progress_bar
from beamopt.cli.refine import refinement_lines
from beamopt.judge.judge import JudgeStatus
from beamopt.reach.reach import TOLERANCE
from beamopt.refine.folder import EarlierRefinement
from beamopt.refine.refine import StageRecord
from beamopt.scene.design import load_design
from beamopt.scene.scene import load_scene
from beamopt.search.algorithm import Generation
from beamopt.search.optimize import optimize
from beamopt.search.result import Optimisation
from beamopt.search.stopping import StopReason
from beamopt.storage.result_folder import design_file

__all__ = ["optimize_command"]

SHOWN = 0.5  # s; less is not worth a word


def optimize_command(
    scene_name: str,
    out: Path | None,
    seed: int | None,
    workers: int,
    resume: bool,
    overrides: Sequence[str],
) -> None:
    """Search, show progress, and say what was found and where it is."""
    seeded = [] if seed is None else [f"search.seed={seed}"]
    scene = load_scene(scene_name, [*overrides, *seeded])
    folder = out or Path("runs") / f"{scene.name}-{scene.search.seed}"
    with progress_bar("generations") as bar, ThreadPoolExecutor(workers) as executor:
        task = bar.add_task(
            scene.name,
            total=scene.search.generations + 1,
            said="starting (compiles once on a machine)",
        )

        def show(record: Generation) -> None:
            best = record.best_ever.verdict
            said = f"L {best.L:.4g} mm²  T {best.T:.4g}"
            bar.update(task, completed=record.index + 1, said=said)

        def refining(record: StageRecord) -> None:
            said = f"refining: L {record.verdict.L:.4g} mm²"
            bar.update(task, said=said)

        result = optimize(
            scene,
            folder,
            resume=resume,
            executor=executor,
            workers=workers,
            callback=show,
            refining=refining,
        )
    _report(result, folder)
    if result.status is StopReason.INTERRUPTED:
        asked = shlex.join([scene_name, *(f"--set={key}" for key in [*overrides, *seeded])])
        console.print(f"go on with: beamopt optimize {asked} --out {folder} --resume", markup=False)
        raise KeyboardInterrupt
    if result.verdict.status is not JudgeStatus.JUDGED:
        raise typer.Exit(ExitCode.DOES_NOT_HOLD)


def _report(result: Optimisation, folder: Path) -> None:
    climb = result.scene.climb
    lines = [("rod", f"{climb.model.rung.value}: {climb.reason}")]
    lines += [("ended", f"{result.status.value}; {result.evaluations} sections judged")]
    if result.verdict.status is JudgeStatus.JUDGED:
        lines += _found(result)
    else:
        lines.append(("no design", result.verdict.status.value))
    if result.refinement is not None:
        lines += refinement_lines(result.refinement, result.scene, result.bound)
    if result.there not in (EarlierRefinement.NONE, EarlierRefinement.REPLACED):
        lines.append(("note", result.there.value))
    lines += _rejected(result)
    lines.append(("time", _times(result)))
    lines.append(("files", f"{folder}/ ({', '.join(_worth_a_look(folder))}, …)"))
    for warning in result.target.warnings:
        console.print(f"[yellow]note[/]: {warning}")
    console.print(f"[bold]{result.scene.name}[/], seed {result.scene.search.seed}")
    for name, text in lines:
        console.print(f"  {name:<13}{text}", soft_wrap=True, markup=False)
    if result.verdict.status is JudgeStatus.JUDGED:
        say_findings(load_design(design_file(folder)))


def _found(result: Optimisation) -> list[tuple[str, str]]:
    verdict, pieces = result.verdict, result.best.section.pieces
    final = result.last.best.verdict.L
    chambers = " + ".join(str(count) for count in pieces.chambers)
    return [
        ("L", f"{verdict.L:.6g} mm²   (lowest in the last population: {final:.6g})"),
        ("bound", gap_text(result.bound, verdict.L)),
        *_outline(result),
        *_neglected(result),
        ("RMS distance", f"{result.rms_distance:.4g} mm a {_unit(result)}"),
        *_followed(result),
        ("K", f"{verdict.K:.6g}"),
        *_total(result),
        ("islands", f"{pieces.islands} of material; chambers per supply {chambers}"),
    ]


def _times(result: Optimisation) -> str:
    found = result.refinement
    refining = "" if found is None else f" searching, {found.seconds:.2f} s refining"
    compiling = result.timing.compiling
    before = f" (and {compiling:.2f} s before, to compile)" if compiling >= SHOWN else ""
    return f"{result.seconds:.2f} s{refining}{before}"


def _total(result: Optimisation) -> list[tuple[str, str]]:
    """The total loss, with what weighted rules add where there are rules."""
    verdict = result.verdict
    if not result.scene.making.rules_set:
        return [("T = L + K", f"{verdict.T:.6g}")]
    return [("R", f"{verdict.R:.6g} mm²"), ("T = L+K+R", f"{verdict.T:.6g}")]


def _rejected(result: Optimisation) -> list[tuple[str, str]]:
    """How many candidates were not judged, by reason; nothing where all were."""
    counts = result.last.rejected
    said = "; ".join(f"{counts[one]}: {one.value}" for one in JudgeStatus if one in counts)
    return [("not judged", said)] if said else []


def _outline(result: Optimisation) -> list[tuple[str, str]]:
    """What a sealed section is, as against the raster that the search judged."""
    if not result.best.seal.rules.sealed:
        return []
    return [("L of outline", f"{result.outline_loss:.6g} mm²")]


def _unit(result: Optimisation) -> str:
    return "node" if result.target.workspace is not None and not result.target.paths else "point"


def _followed(result: Optimisation) -> list[tuple[str, str]]:
    """How trajectories are followed."""
    if result.reach is None:
        return []
    distances = result.reach.distances
    reached = int((distances <= TOLERANCE).sum())
    worst = f"; the farthest is {distances.max():.3g} mm away" if reached < len(distances) else ""
    said = f"{reached} of {len(distances)} points reached within {TOLERANCE:g} mm{worst}"
    return [("trajectories", said)]


def _neglected(result: Optimisation) -> list[tuple[str, str]]:
    """What the loads would do to the best design, where its rung leaves them out."""
    moved = result.neglected
    if moved is None:
        return []
    said = f"the loads that are left out move its tips by up to {moved:.2g} mm"
    return [("note", said if math.isfinite(moved) else "it has no equilibrium under its loads")]


def _worth_a_look(folder: Path) -> list[str]:
    names = (
        "refined.json",
        "refined.png",
        "best.json",
        "best.png",
        "tips.csv",
        "convergence.png",
        "summary.json",
    )
    return [name for name in names if (folder / name).exists()]
