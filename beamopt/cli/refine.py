"""`beamopt refine`."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

import typer

from beamopt.base.errors import InputError
from beamopt.bound.certificate import Certificate, quick_certificate
from beamopt.cli.bound import gap_text
from beamopt.cli.exit_codes import ExitCode
from beamopt.cli.findings import say_findings
from beamopt.cli.progress import console, progress_bar
from beamopt.refine.folder import KIND, EarlierRefinement, write_refined_design
from beamopt.refine.refine import RefineStatus, StageRecord, rounds_of
from beamopt.refine.refine_design import Refinement, refine_design
from beamopt.scene.design import load_design
from beamopt.scene.named import is_scene, named_design
from beamopt.scene.scene import Scene, load_scene
from beamopt.search.optimize import optimize
from beamopt.search.stopping import StopReason
from beamopt.storage.input_file import read_json
from beamopt.storage.old_wordings import OLD_STOP_REASONS
from beamopt.storage.result_folder import claimed

__all__ = ["refine_command", "refinement_lines", "stages_shown"]


def refine_command(
    subject: Path, scene_name: str | None, out: Path | None, overrides: Sequence[str]
) -> None:
    """Refine the best design of a run, or a design for a scene; say what that came to."""
    if subject.is_dir() and not is_scene(str(subject)):
        scene, found, bound, there = _refined_run(subject, scene_name, out, overrides)
        folder = subject
    else:
        scene, found, bound, folder = _refined_file(subject, scene_name, out, overrides)
        there = EarlierRefinement.NONE
    console.print(f"[bold]{scene.name}[/], seed {scene.search.seed}")
    lines = [*refinement_lines(found, scene, bound), ("time", f"{found.seconds:.2f} s")]
    if there is EarlierRefinement.BETTER:
        lines.append(("note", there.value))
    files = [
        name
        for name in ("refined.json", "refined.png", "refined_paths.csv")
        if (folder / name).exists()
    ]
    for name, text in (*lines, ("files", f"{folder}/ ({', '.join(files)}, …)")):
        console.print(f"  {name:<13}{text}", soft_wrap=True, markup=False)
    if found.refined.status is RefineStatus.NOT_JUDGED:
        raise typer.Exit(ExitCode.DOES_NOT_HOLD)
    say_findings(load_design(folder / "refined.json"))


def _refined_run(
    run: Path, scene_name: str | None, out: Path | None, overrides: Sequence[str]
) -> tuple[Scene, Refinement, Certificate, EarlierRefinement]:
    for option, value in (("--scene", scene_name), ("--out", out)):
        if value is not None:
            said = "goes with a design file; a run folder has its scene, and gets the files"
            raise InputError(option, "", str(value), said)
    for override in overrides:
        if not override.strip().startswith("refine."):
            raise InputError("--set", "", override, "a key of [refine]; the rest is the run's")
    if not (run / "scene.toml").exists():
        raise InputError(run, "", None, "no run folder: it has no scene.toml")
    _check_ended(run)
    scene = load_scene(run / "scene.toml", [*overrides, "refine.finish=true"])
    with stages_shown(scene) as show:
        result = optimize(scene, run, resume=True, refining=show)
    if result.status is StopReason.INTERRUPTED:
        raise KeyboardInterrupt
    if result.refinement is None:
        raise InputError(run, "", None, f"no design to refine: {result.status.value}")
    return scene, result.refinement, result.bound, result.there


def _check_ended(run: Path) -> None:
    """Refuse a run whose search would go on."""
    summary = run / "summary.json"
    ended = _ended(read_json(summary)) if summary.exists() else None
    if ended is None or ended.goes_on:
        allowed = (
            "a search that ended: go on with it by `beamopt optimize --resume`, or refine its "
            f"{run / 'best.json'} with --scene {run / 'scene.toml'}"
        )
        raise InputError(summary, "ended", "not ended" if ended is None else ended.value, allowed)


def _ended(summary: Mapping[str, object]) -> StopReason | None:
    """Reason why a search ended, by its summary; None where that does not say."""
    name = summary.get("ended", OLD_STOP_REASONS.get(str(summary.get("status"))))
    return StopReason.__members__.get(str(name))


def _refined_file(
    file: Path, scene_name: str | None, out: Path | None, overrides: Sequence[str]
) -> tuple[Scene, Refinement, Certificate, Path]:
    _, design = named_design(file)
    if scene_name is None:
        said = "must name a scene: its target and rules are what the design is refined for"
        raise InputError("--scene", "", None, said)
    scene = load_scene(scene_name, overrides)
    target = scene.load_target()
    folder = out or Path(f"{file.stem}-refined")
    with claimed(folder, KIND, resume=False):
        with stages_shown(scene) as show:
            found = refine_design(design, scene, target, show)
        write_refined_design(folder, scene, target, found)
    return scene, found, quick_certificate(scene, target), folder


@contextmanager
def stages_shown(scene: Scene) -> Iterator[Callable[[StageRecord], None]]:
    """A bar of a refinement's rounds; the most there can be."""
    with progress_bar("rounds") as bar:
        most = rounds_of(scene.refine, scene.seal.rules.sealed)
        task = bar.add_task("refine", total=most, said="starting")

        def show(record: StageRecord) -> None:
            said = f"{record.stage.value}: L {record.verdict.L:.4g} mm²"
            bar.update(task, completed=record.round, said=said)

        yield show


def refinement_lines(found: Refinement, scene: Scene, bound: Certificate) -> list[tuple[str, str]]:
    """What a refinement came to, for people."""
    refined = found.refined
    if refined.status is not RefineStatus.REFINED:
        return [("refined", refined.status.value)]
    before, after = refined.before, refined.after
    lines = [
        ("refined L", f"{after.L:.6g} mm²   (before: {before.L:.6g})"),
        ("bound", gap_text(bound, after.L)),
    ]
    if scene.making.rules_set:
        lines.append(("refined R", f"{after.R:.6g} mm²   (before: {before.R:.6g})"))
    lines.append(("ratio", f"{refined.ratio:.3f}   (before: {refined.ratio_before:.3f})"))
    judged = f"{refined.evaluations} sections judged, {refined.flips:,} flips proposed"
    return [*lines, ("refinement", judged)]
