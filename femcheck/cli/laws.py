"""`femcheck laws`."""

from __future__ import annotations

import numpy as np
import typer
from rich.markup import escape
from rich.table import Table

from beamopt.cli.exit_codes import ExitCode
from beamopt.cli.progress import console
from femcheck.material.catalogue import MATERIALS, Constant, constants_of, law_by_name
from femcheck.material.differentiate import PressureTerm, differences, random_deformations
from femcheck.material.isotropic import Isotropic
from femcheck.material.law import Law
from femcheck.material.rigid_section import RigidSection

__all__ = ["laws_command"]

E = 300.0  # [kPa]: a soft silicone, to have numbers to show
PENALTY = 1000.0
MOST = 1e-6
POINTS, SEED = 200, 7
FITTED = (7.83, 0.103, -0.0008)  # C1, C2, C3 [kPa] of a silicone's test curve


def laws_command() -> None:
    """Print every law with its constants, differentiate it, and end with 1 if one is wrong."""
    C = random_deformations(POINTS, SEED)
    table = Table(title="laws", title_justify="left", show_lines=True)
    for name in ("law", "energy", "constants", "rises up to a stretch of"):
        table.add_column(name, overflow="fold")
    table.add_column("∂W − S", justify="right")
    table.add_column("∂S − D", justify="right")
    wrong = []
    for law in _laws():
        errors = differences(law, C)
        lines = "\n".join(_line(constant) for constant in constants_of(law))
        texts = (law.name, law.text, lines, _range(law))
        table.add_row(*map(escape, texts), *(f"{e:.0e}" for e in errors))
        wrong += _wrong(f"{law.name} ({_form(law)})", errors)
    pressures = np.random.default_rng(SEED).uniform(-E, E, POINTS)
    errors = differences(PressureTerm(pressures), C)
    table.add_row("pressure", "p ln J, of every mixed form", "", "", *(f"{e:.0e}" for e in errors))
    wrong += _wrong("pressure", errors)
    console.print(table)
    said = f"at {POINTS} random deformations, errors as shares of the largest; allowed {MOST:g}"
    console.print(said, soft_wrap=True, markup=False)
    for line in wrong:
        console.print(line, soft_wrap=True, markup=False)
    if wrong:
        raise typer.Exit(ExitCode.DOES_NOT_HOLD)


def _laws() -> list[Law]:
    """Every law, the materials in both forms."""
    materials = [law_by_name(name, E, nu) for name in MATERIALS for nu in (0.5, 0.4)]
    # cubics: none of those above is one, and most test curves give one that falls in the end
    rising = law_by_name("yeoh", E, constants={"C3_ratio": 0.1})
    C1, C2, C3 = FITTED
    falling = law_by_name("yeoh", 6 * C1, constants={"C1": C1, "C2": C2, "C3": C3})
    return [RigidSection(E, PENALTY), *materials, rising, falling]


def _range(law: Law) -> str:
    """In each test where its response rises up to a stretch; "any" where it always does."""
    if not isinstance(law, Isotropic):
        return ""
    return law.stretch_range.text or "any"


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
