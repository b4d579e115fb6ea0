"""`femcheck run`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np
import typer
from rich.markup import escape

from beamopt.actuator import Actuator
from beamopt.cli.findings import say_findings
from beamopt.cli.progress import console, progress_bar
from beamopt.design import Design, load_design
from beamopt.errors import InputError
from beamopt.folder import design_file
from beamopt.model import allowed
from beamopt.provenance import thread_settings
from femcheck.check.folder import CheckFolder
from femcheck.check.options import CheckOptions
from femcheck.check.run import check_design
from femcheck.check.subject import (
    LoadedDesignError,
    Subject,
    UnsealedDesignError,
    check_sealed,
    check_unloaded,
    sealed_copy,
    slender_copy,
)
from femcheck.cli.prediction import report_prediction
from femcheck.cli.report import report
from femcheck.cli.request import RunRequest, options_of
from femcheck.models.named import name_of
from femcheck.prediction.options import PredictionOptions
from femcheck.prediction.run import predict_design

__all__ = ["folders_of", "refuse_twins", "run_command", "subject_of"]

Result = TypeVar("Result")


def run_command(request: RunRequest) -> None:
    """Check every design, say what was found, and end with 1 unless all agree."""
    options = options_of(request)
    if request.accuracy is not None:
        from femcheck.cli.accuracy import accuracy_command

        accuracy_command(request, options)
        return
    if request.rung != "auto":
        raise InputError("--rung", "", request.rung, "goes with --accuracy")
    if not request.budget == np.inf:
        raise InputError("--budget", "", request.budget, "goes with --accuracy")
    subjects = _subjects(request)
    folders = folders_of(request, [subject.name for subject in subjects])
    for subject, folder in zip(subjects, folders, strict=True):  # before any work
        say_findings(subject.design, subject.name if len(subjects) > 1 else "")
        if isinstance(options, PredictionOptions):
            _check_material(options, subject)
        with CheckFolder.open(folder, subject, options.question, resume=request.resume):
            pass
    threads = " ".join(f"{key}={value}" for key, value in thread_settings().items())
    console.print(f"{request.workers} at once, {threads}", soft_wrap=True)
    everything_holds = True
    for subject, folder in zip(subjects, folders, strict=True):
        if isinstance(options, CheckOptions):
            checked = _followed(check_design, "cases", subject, folder, options, request)
            report(checked, folder)
            everything_holds = everything_holds and checked.holds
        else:
            found = _followed(predict_design, "rays", subject, folder, options, request)
            report_prediction(found, folder)
            everything_holds = everything_holds and found.holds
    if not everything_holds:
        raise typer.Exit(1)


def _check_material(options: PredictionOptions, subject: Subject) -> None:
    try:
        options.law_for(subject.design.actuator)
    except InputError as error:
        raise InputError(subject.name, error.key, error.value, error.allowed) from None


def _followed(
    judge: Callable[..., Result],
    counted: str,
    subject: Subject,
    folder: Path,
    options: CheckOptions | PredictionOptions,
    request: RunRequest,
) -> Result:
    """Judge a design with a bar that shows how far it is."""
    with progress_bar(counted) as bar:
        task = bar.add_task(escape(subject.name), total=None, said="outline and meshes")

        def show(done: int, total: int, said: str) -> None:
            bar.update(task, completed=done, total=total, said=said)

        try:
            return judge(
                subject, folder, options, workers=request.workers, resume=True, progress=show
            )
        except KeyboardInterrupt:
            asked = "femcheck run … --out … --resume goes on where it was"
            console.print(f"{folder}: {asked}", soft_wrap=True, markup=False)
            raise


def _subjects(request: RunRequest) -> list[Subject]:
    """All designs, read before anything is computed."""
    subjects = []
    for path in request.designs:
        file = design_file(path)
        design = load_design(file)
        name = name_of(path, design)
        subjects.append(subject_of(file, name, design, request.seal, request.slenderness))
    refuse_twins(request, [subject.name for subject in subjects])
    return subjects


def refuse_twins(request: RunRequest, names: Sequence[str]) -> None:
    """Refuse designs of one name.

    Raises
    ------
    InputError : two of them would be kept in the same place.
    """
    for number, name in enumerate(names):
        if name in names[:number]:
            said = f"a second design called {name}; results are kept by name: rename a file"
            raise InputError(request.designs[number], "", None, said)


def subject_of(
    file: Path, name: str, design: Design, skin: float | None, slenderness: float | None
) -> Subject:
    """As it is to be checked: of the length that is asked for, and sealed."""
    try:
        check_unloaded(name, design)
    except LoadedDesignError as error:
        raise InputError(file, "", None, str(error)) from None
    if slenderness is not None:
        try:
            design = slender_copy(Subject(name, design), slenderness).design
        except ValueError:
            diameter = 2 * design.grid.outer_radius
            said = f"H/D with H = {allowed(Actuator.model_fields['length'])}, D = {diameter:g} mm"
            raise InputError("--slenderness", "", slenderness, said) from None
    return _sealed(file, name, design, skin)


def _sealed(file: Path, name: str, design: Design, skin: float | None) -> Subject:
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


def folders_of(request: RunRequest, names: Sequence[str]) -> list[Path]:
    """One design: the folder itself; several: one below it each."""
    if request.out is not None and len(names) == 1:
        return [request.out]
    return [(request.out or Path("checks")) / name for name in names]
