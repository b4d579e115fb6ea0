"""`beamopt pareto`."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import typer

from beamopt.base.errors import InputError
from beamopt.cli.bound import gap_text
from beamopt.cli.exit_codes import ExitCode
from beamopt.cli.findings import say_findings
from beamopt.cli.progress import console, progress_bar
from beamopt.pareto.find_front import find_front
from beamopt.pareto.front import Front
from beamopt.pareto.scores import BEST, chosen_objectives
from beamopt.pareto.search import FrontRecord
from beamopt.scene.scene import Scene, load_scene
from beamopt.search.stopping import StopReason

__all__ = ["pareto_command"]


def pareto_command(
    scene_name: str,
    objectives: str,
    out: Path | None,
    overrides: Sequence[str],
    population: int,
    workers: int,
    resume: bool,
) -> None:
    """Search for a front, show progress, and say what was found and where it is."""
    names = chosen_objectives(objectives)
    scene = load_scene(scene_name, overrides)
    ignored = _ignored(scene)
    if ignored:
        said = f"a search for a front ignores {', '.join(ignored)}"
        console.print(f"[yellow]note[/]: {said}", soft_wrap=True)
    folder = out or Path("fronts") / f"{scene.name}-{'-'.join(names)}-{scene.search.seed}"
    with progress_bar("generations") as bar, ThreadPoolExecutor(workers) as executor:
        total = scene.search.generations + 1
        task = bar.add_task(scene.name, total=total, said="starting (compiles once on a machine)")

        def show(record: FrontRecord) -> None:
            lowest = record.front[0].score.verdict.L if record.front else float("inf")
            said = f"{len(record.front)} on the front, L from {lowest:.4g} mm²"
            bar.update(task, completed=record.index + 1, said=said)

        try:
            front = find_front(
                scene,
                names,
                folder,
                population=population,
                resume=resume,
                executor=executor,
                workers=workers,
                callback=show,
            )
        except ImportError as error:
            raise _not_installed(error) from None
    _report(front, folder)
    if front.status is StopReason.INTERRUPTED:
        asked = shlex.join([scene_name, *(f"--set={key}" for key in overrides)])
        more = f"--population {front.population} --objectives {objectives} --out {folder} --resume"
        said = f"go on with: beamopt pareto {asked} {more}"
        console.print(said, soft_wrap=True, markup=False)
        raise KeyboardInterrupt
    if not front.designs:
        raise typer.Exit(ExitCode.DOES_NOT_HOLD)


def _ignored(scene: Scene) -> list[str]:
    """Keys of a scene that are set, but only to a search for one design."""
    keys = [f"stop.{name}" for name, value in scene.stop if value is not None]
    keys += ["search.improved_share"] if scene.search.improved_share > 0 else []
    return keys + (["refine.finish"] if scene.refine.finish else [])


def _not_installed(error: ImportError) -> InputError:
    missing = (error.name or str(error)).partition(".")[0]
    return InputError("", "", None, f"{missing} is not installed: pip install 'beamopt[search]'")


def _report(front: Front, folder: Path) -> None:
    lines = [("ended", f"{front.status.value}; {front.evaluations} sections judged")]
    lines.append(("front", f"{len(front.designs)} designs, of which none beats another"))
    shown = _shown(front)
    if front.designs:
        for said, k in shown.items():
            reached = zip(front.objectives, front.values[k], strict=True)
            text = ", ".join(f"{name} {value:.4g}" for name, value in reached)
            lines.append((said, f"{text}   (index {k})"))
        lines.append(("bound", gap_text(front.bound, front.lowest_loss)))
    counts = front.rejected
    if counts:
        lines.append(("not judged", "; ".join(f"{n}: {one.value}" for one, n in counts.items())))
    lines.append(("time", f"{front.seconds:.2f} s"))
    files = [name for name in ("front.csv", "pareto.png") if (folder / name).exists()]
    files += ["front-*.json"] if front.designs else []
    lines.append(("files", f"{folder}/ ({', '.join(files)}, …)"))
    console.print(f"[bold]{front.scene.name}[/], seed {front.scene.search.seed}")
    for name, text in lines:
        console.print(f"  {name:<16}{text}", soft_wrap=True, markup=False)
    for k in dict.fromkeys(shown.values()):
        say_findings(front.scene.design_of(front.designs[k].points), f"index {k}")


def _shown(front: Front) -> dict[str, int]:
    """Places on the front of the lowest of each objective and of the knee, by their names."""
    if not front.designs:
        return {}
    lowest = front.values.argmin(axis=0).tolist()
    places = {BEST[name]: k for name, k in zip(front.objectives, lowest, strict=True)}
    return places | {"knee" if front.bends else "middle": front.knee}
