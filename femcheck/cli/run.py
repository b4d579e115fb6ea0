"""`femcheck run`."""

from __future__ import annotations

import re
import shutil
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import typer
from rich.markup import escape

from beamopt.cli.progress import console, progress_bar
from beamopt.design import Design, load_design
from beamopt.errors import InputError
from beamopt.provenance import thread_settings
from femcheck.check.checked import Checked
from femcheck.check.folder import CheckFolder
from femcheck.check.options import CheckOptions
from femcheck.check.run import check_design
from femcheck.check.subject import Subject, UnsealedDesignError, check_sealed, sealed_copy
from femcheck.cli.report import report
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
    for subject, folder in zip(subjects, folders, strict=True):
        CheckFolder.open(folder, subject, options, resume=request.resume)  # before any work
    threads = " ".join(f"{key}={value}" for key, value in thread_settings().items())
    console.print(f"{request.workers} cases at once, {threads}", soft_wrap=True)
    everything_holds = True
    for subject, folder in zip(subjects, folders, strict=True):
        checked = _checked(subject, folder, options, request)
        report(checked, folder)
        everything_holds = everything_holds and checked.holds
    if not everything_holds:
        raise typer.Exit(1)


def _checked(subject: Subject, folder: Path, options: CheckOptions, request: RunRequest) -> Checked:
    with progress_bar("cases") as bar:
        task = bar.add_task(escape(subject.name), total=None, said="outline and meshes")

        def show(done: int, total: int, said: str) -> None:
            bar.update(task, completed=done, total=total, said=said)

        try:
            return check_design(
                subject, folder, options, workers=request.workers, resume=True, progress=show
            )
        except KeyboardInterrupt:
            asked = "femcheck run … --out … --resume goes on where it was"
            console.print(f"{folder}: {asked}", soft_wrap=True, markup=False)
            raise


def _options(request: RunRequest) -> CheckOptions:
    for name in ("seconds", "gmsh_seconds"):
        value = getattr(request, name)
        if not 0 < value < np.inf:
            raise InputError(f"--{name.replace('_', '-')}", "", value, "above 0 s")
    if request.gmsh is not None and shutil.which(request.gmsh) is None:
        raise InputError("--gmsh", "", request.gmsh, "no such executable")
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
    except InputError as error:
        if error.where:
            raise
        raise InputError(f"--{error.key}", "", error.value, error.allowed) from None


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
    except ValueError:
        raise InputError("--solver", "", name, "one of auto, pardiso, superlu") from None
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
            said = f"a second design called {name}; results are kept by name: rename a file"
            raise InputError(request.designs[number], "", None, said)
    return subjects


def _name(path: Path, design: Design) -> str:
    """A run's scene and seed; another design's file name."""
    scene, seed = design.notes.get("scene"), design.notes.get("seed")
    of_run = path.is_dir() or path.stem in ("best", "final")
    named = isinstance(scene, str) and re.fullmatch(r"[\w-]+", scene) and isinstance(seed, int)
    if of_run and named:
        return f"{scene}-{seed}-final" if path.stem == "final" else f"{scene}-{seed}"
    return path.resolve().name if path.is_dir() else path.stem


def _subject(file: Path, name: str, design: Design, skin: float | None) -> Subject:
    if skin is not None:
        if not 0 < skin < np.inf:
            raise InputError("--seal", "", skin, "a skin in mm, above 0")
        try:
            return sealed_copy(name, design, skin)
        except ValueError as error:
            raise InputError("--seal", "", skin, str(error)) from None
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
