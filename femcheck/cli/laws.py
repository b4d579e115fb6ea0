"""`femcheck laws`."""

from __future__ import annotations

import numpy as np
import typer
from rich.markup import escape
from rich.table import Table

from beamopt.cli.progress import console
from femcheck.material.catalogue import MATERIALS, Constant, constants_of, law_by_name
from femcheck.material.differentiate import PressureTerm, differences, random_deformations
from femcheck.material.law import Law
from femcheck.material.rigid_section import RigidSection

__all__ = ["laws_command"]

E = 300.0  # [kPa]: a soft silicone, to have numbers to show
PENALTY = 1000.0
MOST = 1e-6
POINTS, SEED = 200, 7


def laws_command() -> None:
    """Print every law with its constants, differentiate it, and end with 1 if one is wrong."""
    C = random_deformations(POINTS, SEED)
    table = Table(title="laws", title_justify="left", show_lines=True)
    for name in ("law", "energy", "constants"):
        table.add_column(name, overflow="fold")
    table.add_column("∂W − S", justify="right")
    table.add_column("∂S − D", justify="right")
    wrong = []
    for law in _laws():
        errors = differences(law, C)
        lines = "\n".join(_line(constant) for constant in constants_of(law))
        table.add_row(law.name, escape(law.text), escape(lines), *(f"{e:.0e}" for e in errors))
        wrong += _wrong(f"{law.name} ({_form(law)})", errors)
    pressures = np.random.default_rng(SEED).uniform(-E, E, POINTS)
    errors = differences(PressureTerm(pressures), C)
    table.add_row("pressure", "p ln J, of every mixed form", "", *(f"{e:.0e}" for e in errors))
    wrong += _wrong("pressure", errors)
    console.print(table)
    said = f"at {POINTS} random deformations, errors as shares of the largest; allowed {MOST:g}"
    console.print(said, soft_wrap=True, markup=False)
    for line in wrong:
        console.print(line, soft_wrap=True, markup=False)
    if wrong:
        raise typer.Exit(1)


def _laws() -> list[Law]:
    """Every law, the materials in both forms."""
    materials = [law_by_name(name, E, nu) for name in MATERIALS for nu in (0.5, 0.4)]
    cubic = law_by_name("yeoh", E, constants={"C3_ratio": 0.1})  # none of the published ones has it
    return [RigidSection(E, PENALTY), *materials, cubic]


def _form(law: Law) -> str:
    return "displacements" if law.volumetric_compliance is None else "mixed"


def _line(constant: Constant) -> str:
    number = f"{constant.value:.6g} {constant.unit}".strip()
    return f"{constant.name} = {number}: {constant.source}"


def _wrong(name: str, errors: tuple[float, float]) -> list[str]:
    """What is wrong with a law; a NaN is."""
    said = ("stress is not its energy's derivative", "stiffness is not its stress's derivative")
    return [
        f"{name}: the {what}: {error:.1e}"
        for what, error in zip(said, errors, strict=True)
        if not error <= MOST
    ]
