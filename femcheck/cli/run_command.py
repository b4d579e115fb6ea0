"""`femcheck run`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import numpy as np

from beamopt.base.errors import InputError
from beamopt.cli.exit_codes import end_with, joined
from beamopt.cli.findings import say_findings
from beamopt.cli.progress import console, counted, say_workers
from femcheck.check.check_design import check_design
from femcheck.check.options import CheckOptions
from femcheck.cli.prediction import report_prediction
from femcheck.cli.report import report
from femcheck.cli.request import RunRequest, options_of
from femcheck.cli.subjects import folders_of, subjects_of
from femcheck.cli.verdicts import code_of
from femcheck.prediction.options import PredictionOptions
from femcheck.prediction.predict_design import predict_design
from femcheck.solved.folder import CheckFolder
from femcheck.solved.subject import (
    Subject,
)

__all__ = ["run_command"]

Result = TypeVar("Result")


def run_command(request: RunRequest) -> None:
    """Check every design, say what was found, and end with the code of all verdicts."""
    options = options_of(request)
    if request.accuracy is not None:
        from femcheck.cli.accuracy import accuracy_command

        accuracy_command(request, options)
        return
    if request.rung != "auto":
        raise InputError("--rung", "", request.rung, "goes with --accuracy")
    if not request.budget == np.inf:
        raise InputError("--budget", "", request.budget, "goes with --accuracy")
    subjects = subjects_of(request, options)
    folders = folders_of(request, [subject.name for subject in subjects])
    for subject, folder in zip(subjects, folders, strict=True):  # before any work
        say_findings(subject.design, subject.name if len(subjects) > 1 else "")
        with CheckFolder.open(folder, subject, options.question, resume=request.resume):
            pass
    say_workers(request.workers)
    codes = []
    for subject, folder in zip(subjects, folders, strict=True):
        if isinstance(options, CheckOptions):
            checked = _followed(check_design, "cases", subject, folder, options, request)
            report(checked, folder)
            codes.append(code_of(checked))
        else:
            found = _followed(predict_design, "rays", subject, folder, options, request)
            report_prediction(found, folder)
            codes.append(code_of(found))
    end_with(joined(codes))


def _followed(
    judge: Callable[..., Result],
    unit: str,
    subject: Subject,
    folder: Path,
    options: CheckOptions | PredictionOptions,
    request: RunRequest,
) -> Result:
    """Judge a design with a bar that shows how far it is."""
    with counted(unit, subject.name, said="outline and meshes") as show:
        try:
            return judge(
                subject, folder, options, workers=request.workers, resume=True, progress=show
            )
        except KeyboardInterrupt:
            asked = "femcheck run … --out … --resume goes on where it was"
            console.print(f"{folder}: {asked}", soft_wrap=True, markup=False)
            raise
