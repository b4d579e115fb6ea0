"""`femcheck run`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import typer
from rich.table import Table

from beamopt.arrays import FloatArray
from beamopt.cli.progress import console, progress_bar
from beamopt.design import Design, load_design
from beamopt.errors import InputError
from beamopt.provenance import thread_settings
from femcheck.check.checked import Checked
from femcheck.check.options import CheckOptions
from femcheck.check.run import check_design
from femcheck.check.subject import Subject, UnsealedDesignError, check_sealed, sealed_copy
from femcheck.check.tables import verdict
from femcheck.mesh.geo import SectionSizes
from femcheck.mesh.gmsh_section import Mesher

__all__ = ["RunRequest", "run_command"]


@dataclass(frozen=True, slots=True)
class RunRequest:
    """The options as they were given."""

    designs: list[Path]
    out: Path | None
    seal: float | None
    agree: str
    law: str
    workers: int
    layers: int | None
    size: float
    element: str
    solver: str
    seconds: float
    gmsh: str | None
    gmsh_seconds: float
    resume: bool


def run_command(request: RunRequest) -> None:
    """Check every design, say what was found, and end with 1 unless all agree."""
    options = _options(request)
    subjects = _subjects(request)
    folders = _folders(request, subjects)
    threads = " ".join(f"{key}={value}" for key, value in thread_settings().items())
    console.print(f"threads: {threads}; {request.workers} cases at once", soft_wrap=True)
    everything_holds = True
    for subject, folder in zip(subjects, folders, strict=True):
        checked = _checked(subject, folder, options, request)
        _report(checked, folder)
        everything_holds = everything_holds and checked.holds
    if not everything_holds:
        raise typer.Exit(1)


def _checked(subject: Subject, folder: Path, options: CheckOptions, request: RunRequest) -> Checked:
    with progress_bar("cases") as bar:
        task = bar.add_task(subject.name, total=None, said="outline and meshes")

        def show(done: int, total: int, said: str) -> None:
            bar.update(task, completed=done, total=total, said=said)

        return check_design(
            subject,
            folder,
            options,
            workers=request.workers,
            resume=request.resume,
            progress=show,
        )


def _options(request: RunRequest) -> CheckOptions:
    for name in ("size", "seconds", "gmsh_seconds"):
        value = getattr(request, name)
        if not 0 < value < np.inf:
            raise InputError(f"--{name.replace('_', '-')}", "", value, "above 0")
    try:
        return CheckOptions(
            law=request.law,
            agree=_share(request.agree),
            element=request.element,
            layers=request.layers,
            sizes=SectionSizes(factor=request.size),
            seconds=request.seconds,
            solver=_solver(request.solver),
            mesher=Mesher(request.gmsh, request.gmsh_seconds),
        )
    except InputError:
        raise
    except ValueError as error:
        key, _, rest = str(error).partition(" = ")
        value, _, allowed = rest.partition(": ")
        raise InputError(f"--{key}", "", value, allowed) from None


def _share(text: str) -> float:
    """ "5%", "5 %" or "0.05" as a share."""
    number, percent, rest = text.strip().partition("%")
    try:
        value = float(number) / (100 if percent else 1)
    except ValueError:
        value = float("nan")
    if rest.strip() or not 0 < value <= 1:
        raise InputError("--agree", "", text, "a share as 5% or 0.05, above 0 and at most 100%")
    return value


def _solver(name: str) -> str:
    from femcheck.continuation.direct import direct_solver

    try:
        direct_solver(name)
    except ImportError:
        raise InputError("--solver", "", name, "not installed; auto or superlu") from None
    return name


def _subjects(request: RunRequest) -> list[Subject]:
    """All designs, read before anything is computed."""
    subjects = []
    for path in request.designs:
        file = path / "best.json" if path.is_dir() else path
        design = load_design(file)
        name = _name(path, design)
        subjects.append(_subject(file, name, design, request.seal))
    names = [subject.name for subject in subjects]
    for number, name in enumerate(names):
        if name in names[:number]:
            said = "stands there twice; results are kept by name"
            raise InputError(request.designs[number], "", None, said)
    return subjects


def _name(path: Path, design: Design) -> str:
    """A run's scene and seed; another design's file name."""
    scene, seed = design.notes.get("scene"), design.notes.get("seed")
    if path.is_dir() and isinstance(scene, str) and isinstance(seed, int):
        return f"{scene}-{seed}"
    return path.resolve().name if path.is_dir() else path.stem


def _subject(file: Path, name: str, design: Design, skin: float | None) -> Subject:
    if skin is not None:
        if not 0 < skin < np.inf:
            raise InputError("--seal", "", skin, "a skin in mm, above 0")
        try:
            return sealed_copy(name, design, skin)
        except ValueError as error:
            first = str(error).strip().splitlines()[-1 if "seal.skin" not in str(error) else 0]
            raise InputError("--seal", "", skin, first) from None
    try:
        check_sealed(name, design)
    except UnsealedDesignError as error:
        raise InputError(file, "", None, str(error)) from None
    return Subject(name, design)


def _folders(request: RunRequest, subjects: list[Subject]) -> list[Path]:
    """One design: the folder itself; several: one below it each."""
    if request.out is not None and len(subjects) == 1:
        return [request.out]
    above = request.out or Path("checks")
    return [above / subject.name for subject in subjects]


def _report(checked: Checked, folder: Path) -> None:
    subject = checked.subject
    console.print(f"[bold]{subject.name}[/]")
    for name, text in _lines(checked):
        console.print(f"  {name:<16}{text}", soft_wrap=True, markup=False)
    if checked.comparison is not None:
        console.print(_table(checked))
    console.print(f"  {'implementation':<16}{verdict(checked)}", soft_wrap=True, markup=False)
    console.print(
        f"  {'prediction':<16}not asked: {checked.options.law} is a check of the beam, no material",
        soft_wrap=True,
        markup=False,
    )
    console.print(f"  {'files':<16}{folder}/", soft_wrap=True, markup=False)


def _lines(checked: Checked) -> list[tuple[str, str]]:
    subject, outline = checked.subject, checked.subject.outline
    chambers = " + ".join(str(len(outline.chambers_of(supply))) for supply in (1, 2, 3))
    area = float(outline.moments.area)
    lines = [("section", f"{area:.1f} mm² of material; chambers per supply {chambers}")]
    lines += [("note", str(fault)) for fault in outline.faults]
    if checked.quality is not None:
        lines += [("note", said) for said in checked.quality.notes]
    if subject.has_islands:
        lines.append(("note", "with an island the beam is not what the solid converges to"))
    moved = subject.sealing_moved
    if moved is not None:
        said = f"moved the beam's tips by {np.median(moved):.2f} mm (median), {moved.max():.2f} mm"
        lines.append(("sealing a copy", f"{said} (worst)"))
    steps, compared = checked.geometry, checked.comparison
    if steps is None or compared is None:
        return lines
    lines.append(
        (
            "geometry",
            f"raster → smooth outline {steps.raster_to_smooth:.3f} mm, → polygons "
            f"{steps.smooth_to_outline:.3f} mm, → mesh {steps.outline_to_mesh:.2g} mm of the tip",
        )
    )
    for stage in checked.stages:
        body = stage.solid.body()
        lines.append(
            (
                "solid",
                f"{stage.name}: {stage.solid.element}, {len(stage.solid.section.triangles)} "
                f"triangles × {stage.solid.heights.size - 1} layers, {body.unknowns} unknowns",
            )
        )
    loaded = compared.is_loaded
    lines.append(
        (
            "made of",
            f"discretisation at most {_most(compared.discretisation[loaded])} mm, penalty at c = "
            f"{max(checked.options.penalties):g} (extrapolated away) "
            f"{_most(compared.penalty_error[loaded])} mm",
        )
    )
    return lines


def _most(values: FloatArray) -> str:
    known = values[~np.isnan(values)]
    return f"{known.max():.3f}" if known.size else "?"


def _table(checked: Checked) -> Table:
    """27 rows of what matters most."""
    compared = checked.comparison
    assert compared is not None
    table = Table(title="beam against solid, extrapolated in 1/c", title_justify="left")
    for name in ("P1", "P2", "P3 kPa", "moves mm", "differs mm", "of it"):
        table.add_column(name, justify="right")
    table.add_column("status")
    for row, pressures in enumerate(compared.subject.pressures):
        difference, share = compared.difference[row], compared.share[row]
        answered = not np.isnan(difference)
        table.add_row(
            *(f"{value:g}" for value in pressures),
            f"{compared.displacement[row]:.2f}",
            f"{difference:.4f}" if answered else "–",
            f"{100 * share:.3f}%" if answered else "–",
            compared.final.statuses[row].value,
        )
    return table
