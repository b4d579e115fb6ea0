"""Arguments and options that several commands share: the material, the design."""

from __future__ import annotations

from typing import Annotated

import typer

__all__ = [
    "Constants",
    "Law",
    "Nu",
    "Seal",
    "Slenderness",
    "Wind",
    "Winding",
]

Law = Annotated[
    str,
    typer.Option(
        help="rigid-section: does the solid converge to the beam? What real material does: "
        "neo-hookean, gent, mooney-rivlin, yeoh; wound: neo-hookean, every chamber wound."
    ),
]
Nu = Annotated[
    float | None, typer.Option(help="Poisson's ratio of a material, 0…0.5; 0.5 if left out.")
]
Constants = Annotated[
    list[str] | None,
    typer.Option(
        "--constant", metavar="NAME=VALUE", help="A constant of a law; `femcheck laws` has them."
    ),
]
Wind = Annotated[
    str | None,
    typer.Option(help="Wind thread round chambers, outer (the outside) or both; any material."),
]
Winding = Annotated[
    float | None,
    typer.Option(
        metavar="N/M", help="Stiffness of the thread times turns per metre; 1e5 if left out."
    ),
]
Seal = Annotated[
    float | None,
    typer.Option(
        metavar="MM", help="Take a copy sealed by a skin of so many mm, and say what it moved."
    ),
]
Slenderness = Annotated[
    float | None,
    typer.Option(metavar="H/D", help="Take another length, in outer diameters; for the beam too."),
]
