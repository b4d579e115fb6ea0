"""What every command says of the design that it was given or that it found."""

from __future__ import annotations

import typer

from beamopt.outline.faults import summaries
from beamopt.scene.design import Design

__all__ = ["say_findings"]


def say_findings(design: Design, name: str = "") -> None:
    """Print what is wrong with a design's section, one line for each kind, on standard error."""
    of = f"{name}: " if name else ""
    for line in summaries(design.findings):
        typer.echo(f"note: {of}{line}", err=True)
