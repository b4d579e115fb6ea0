"""`beamopt rung`."""

from __future__ import annotations

from beamopt.base.errors import InputError
from beamopt.cli.findings import say_findings
from beamopt.cli.progress import console
from beamopt.rod.ladder import Rung
from beamopt.scene.named import is_scene, named_design
from beamopt.scene.rod_choice import Climb
from beamopt.scene.scene import load_scene

__all__ = ["rung_command"]


def rung_command(subject: str, overrides: list[str]) -> None:
    """Say which rung of the ladder a scene or a design needs, and why."""
    climb = _climb(subject, overrides)
    for rung in Rung:
        mark = "→" if rung is climb.model.rung else " "
        console.print(f"{mark} {rung.value:<8}{rung.text}", markup=False)
    console.print(climb.reason, soft_wrap=True, markup=False)


def _climb(subject: str, overrides: list[str]) -> Climb:
    if is_scene(subject):
        return load_scene(subject, overrides).climb
    if overrides:
        said = "of scenes alone: a design has its rod and its loads in its file"
        raise InputError("--set", "", overrides[0], said)
    _, design = named_design(subject)
    say_findings(design)
    return design.climb
