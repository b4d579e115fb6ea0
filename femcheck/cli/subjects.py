"""What the commands' arguments name: subjects of checks, questions, folders for what is found."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from beamopt.base.errors import InputError
from beamopt.scene.actuator import Actuator
from beamopt.scene.design import Design
from beamopt.scene.named import named_design
from beamopt.storage.checked_keys import allowed
from femcheck.cli.request import RunRequest
from femcheck.models.question import LawChoice, Question
from femcheck.prediction.options import PredictionOptions
from femcheck.solved.subject import (
    LoadedDesignError,
    Subject,
    UnsealedDesignError,
    check_sealed,
    check_unloaded,
    sealed_copy,
    slender_copy,
)

__all__ = ["folders_of", "question_of", "refuse_twins", "subjects_of"]


def subjects_of(request: RunRequest, law: LawChoice) -> list[Subject]:
    """All designs as they are checked, read before anything is computed."""
    subjects = []
    for source in request.designs:
        name, design = named_design(source)
        subjects.append(_subject_of(source, name, design, request.seal, request.slenderness))
        _check_material(law, name, design)
    refuse_twins(request, [subject.name for subject in subjects])
    return subjects


def question_of(source: str, request: RunRequest, law: LawChoice) -> Question:
    """The tips of a design, sealed and of another length where asked for, under a law.

    The design may have loads, as long as it is taken as it is.
    """
    name, design = named_design(source)
    if request.seal is not None or request.slenderness is not None:
        design = _subject_of(source, name, design, request.seal, request.slenderness).design
    _check_material(law, name, design)
    return Question.of(name, design, law)


def _check_material(law: LawChoice, name: str, design: Design) -> None:
    """Refuse a law that contradicts a design's moduli."""
    if isinstance(law, PredictionOptions):
        try:
            law.law_for(design.actuator)
        except InputError as error:
            raise InputError(name, error.key, error.value, error.allowed) from None


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


def _subject_of(
    source: str, name: str, design: Design, skin: float | None, slenderness: float | None
) -> Subject:
    """As it is to be checked: of the length that is asked for, and sealed."""
    try:
        check_unloaded(name, design)
    except LoadedDesignError as error:
        raise InputError(source, "", None, str(error)) from None
    if slenderness is not None:
        try:
            design = slender_copy(Subject(name, design), slenderness).design
        except ValueError:
            diameter = 2 * design.grid.outer_radius
            said = f"H/D with H = {allowed(Actuator.model_fields['length'])}, D = {diameter:g} mm"
            raise InputError("--slenderness", "", slenderness, said) from None
    return _sealed(source, name, design, skin)


def _sealed(source: str, name: str, design: Design, skin: float | None) -> Subject:
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
        raise InputError(source, "", None, str(error)) from None
    return Subject(name, design)


def folders_of(request: RunRequest, names: Sequence[str]) -> list[Path]:
    """One design: the folder itself; several: one below it each."""
    if request.out is not None and len(names) == 1:
        return [request.out]
    return [(request.out or Path("checks")) / name for name in names]
