"""`beamopt export`."""

from __future__ import annotations

from pathlib import Path

import typer

from beamopt.cli.progress import console
from beamopt.export.export_design import ExportOptions, export_design
from beamopt.scene.named import named_design

__all__ = ["export_command"]


def export_command(
    source: str, out: Path | None, formats: str | None, cap: float, tolerance: float | None
) -> None:
    """Write a design, or the best design of a run, as solids and drawings."""
    named = None
    if formats is not None:
        named = tuple(dict.fromkeys(part.strip() for part in formats.split(",")))
    options = ExportOptions(named, cap, tolerance)
    _, design = named_design(source)
    path = Path(source).resolve()
    name = path.name if path.is_dir() else path.stem
    exported = export_design(design, name, out or Path(f"{name}-export"), options)
    for note in exported.notes:
        typer.echo(f"note: {note}", err=True)
    for file, size in exported.files:
        console.print(f"{exported.folder / file}  {_size(size)}", soft_wrap=True, markup=False)


def _size(count: int) -> str:
    return f"{count / 1e6:.1f} MB" if count >= 1e6 else f"{count / 1e3:.0f} kB"
