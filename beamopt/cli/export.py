"""`beamopt export`."""

from __future__ import annotations

from pathlib import Path

import typer

from beamopt.cli.progress import console
from beamopt.design import load_design
from beamopt.export.run import ExportOptions, export_design
from beamopt.folder import design_file

__all__ = ["export_command"]


def export_command(
    path: Path, out: Path | None, formats: str | None, cap: float, tolerance: float | None
) -> None:
    """Write a design, or the best design of a run, as solids and drawings."""
    named = None
    if formats is not None:
        named = tuple(dict.fromkeys(part.strip() for part in formats.split(",")))
    options = ExportOptions(named, cap, tolerance)
    is_run = path.is_dir()
    design = load_design(design_file(path))
    name = path.resolve().name if is_run else path.resolve().stem
    exported = export_design(design, name, out or Path(f"{name}-export"), options)
    for note in exported.notes:
        typer.echo(f"note: {note}", err=True)
    for file, size in exported.files:
        console.print(f"{exported.folder / file}  {_size(size)}", soft_wrap=True, markup=False)


def _size(count: int) -> str:
    return f"{count / 1e6:.1f} MB" if count >= 1e6 else f"{count / 1e3:.0f} kB"
