"""The options of `femcheck run` as they were given, and what they ask for."""

from __future__ import annotations

import math
import shutil
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from beamopt.base.errors import InputError
from femcheck.check.options import CheckOptions
from femcheck.continuation.limits import Limits
from femcheck.material.catalogue import MATERIALS
from femcheck.material.fibre import Thread
from femcheck.mesh.geo import SectionSizes
from femcheck.mesh.gmsh_section import Mesher
from femcheck.prediction.options import WOUND, PredictionOptions
from femcheck.solid.winding import Wound

__all__ = ["RunRequest", "options_of"]

RIGID = "rigid-section"
KEYS = {"sizes": "size", "poisson_ratio": "nu"}  # options that are called otherwise in the code


@dataclass(frozen=True, slots=True)
class RunRequest:
    """The options as they were given."""

    designs: list[str]
    out: Path | None = None
    seal: float | None = None
    agree: str = "5%"
    law: str = RIGID
    nu: float | None = None
    constants: list[str] = field(default_factory=list)
    wind: str | None = None
    winding: float | None = None
    slenderness: float | None = None
    workers: int = 2
    layers: int | None = None
    size: float = 1.0
    element: str = "wedge18"
    solver: str = "auto"
    iterations: int = Limits().iterations
    seconds: float = np.inf
    gmsh: str | None = None
    gmsh_seconds: float = Mesher().seconds
    resume: bool = False
    accuracy: str | None = None
    rung: str = "auto"
    budget: float = np.inf


def options_of(request: RunRequest) -> CheckOptions | PredictionOptions:
    """What is asked: the implementation's check, or the prediction of a material.

    Raises
    ------
    InputError : an option that can not be used.
    """
    if not 0 < request.gmsh_seconds < np.inf:
        raise InputError("--gmsh-seconds", "", request.gmsh_seconds, "above 0 s")
    if request.gmsh is not None and shutil.which(request.gmsh) is None:
        raise InputError("--gmsh", "", request.gmsh, "no such executable")
    laws = (RIGID, *MATERIALS, WOUND)
    if request.law not in laws:
        raise InputError("--law", "", request.law, f"one of {', '.join(laws)}")
    try:
        solid: dict[str, Any] = {
            "agree": _share(request.agree),
            "element": request.element,
            "layers": request.layers,
            "sizes": SectionSizes(factor=request.size),
            "iterations": request.iterations,
            "seconds": request.seconds,
            "solver": _solver(request.solver),
            "mesher": Mesher(request.gmsh, request.gmsh_seconds),
        }
        if request.law == RIGID:
            _refuse_of_materials(request)
            return CheckOptions(**solid)
        return PredictionOptions(**solid, **_material(request))
    except InputError as error:
        if error.where:
            raise
        if error.key in dict(_constant(text) for text in request.constants):
            raise InputError("--constant", error.key, error.value, error.allowed) from None
        key = KEYS.get(error.key, error.key)
        raise InputError(f"--{key}", "", error.value, error.allowed) from None


def _refuse_of_materials(request: RunRequest) -> None:
    for name in ("nu", "wind", "winding"):
        value = getattr(request, name)
        if value is not None:
            raise InputError(f"--{name}", "", value, f"--law {RIGID} is no material")
    if request.constants:
        raise InputError("--constant", "", request.constants[0], f"--law {RIGID} is no material")


def _material(request: RunRequest) -> dict[str, Any]:
    """The law, its constants, and what is wound."""
    wound = None if request.wind is None else _wound(request.wind)
    if request.winding is not None and wound is None and request.law != WOUND:
        raise InputError("--winding", "", request.winding, "goes with --law wound or --wind")
    try:
        thread = Thread(1e5 if request.winding is None else request.winding)
    except ValueError:
        raise InputError("--winding", "", request.winding, "N/m, above 0") from None
    return {
        "law": request.law,
        "poisson_ratio": 0.5 if request.nu is None else request.nu,
        "constants": dict(_constant(text) for text in request.constants),
        "wound": wound,
        "thread": thread,
    }


def _wound(text: str) -> Wound:
    try:
        return Wound(text)
    except ValueError:
        known = ", ".join(one.value for one in Wound)
        raise InputError("--wind", "", text, f"one of {known}") from None


def _constant(text: str) -> tuple[str, float]:
    name, _, value = text.partition("=")
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not name.strip() or math.isnan(number):
        raise InputError("--constant", "", text, "NAME=NUMBER, as Jm=30")
    return name.strip(), number


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
