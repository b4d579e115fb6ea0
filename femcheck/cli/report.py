"""What a check found, told on the terminal."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from rich.markup import escape
from rich.table import Table

from beamopt.base.arrays import FloatArray
from beamopt.cli.progress import console
from femcheck.check.checked import Checked
from femcheck.check.comparison import Comparison
from femcheck.check.tables import verdict
from femcheck.continuation.ended import Ended
from femcheck.mesh.quality import Quality
from femcheck.solved.subject import Subject

__all__ = ["notes_of", "report"]


def report(checked: Checked, folder: Path) -> None:
    """Say what a check found."""
    subject = checked.subject
    console.print(f"[bold]{escape(subject.name)}[/]")
    for name, text in _lines(checked):
        console.print(f"  {name:<16}{text}", soft_wrap=True, markup=False)
    if checked.comparison is not None:
        console.print(_table(checked))
    console.print(f"  {'implementation':<16}{verdict(checked)}", soft_wrap=True, markup=False)
    said = "not asked; --law neo-hookean or --law wound predicts"
    console.print(f"  {'prediction':<16}{said}", soft_wrap=True, markup=False)
    console.print(f"  {'files':<16}{folder}/", soft_wrap=True, markup=False)


def _lines(checked: Checked) -> list[tuple[str, str]]:
    """Facts and notes, before the table."""
    outline = checked.subject.outline
    chambers = " + ".join(str(len(outline.chambers_of(supply))) for supply in (1, 2, 3))
    area = float(outline.moments.area)
    return [
        ("section", f"{area:.1f} mm² of material; chambers per supply {chambers}"),
        *(("note", note) for note in notes_of(checked.subject, checked.quality)),
        *_geometry(checked),
        *_solids(checked),
        *_parts(checked),
    ]


def notes_of(subject: Subject, quality: Quality | None) -> Iterator[str]:
    """What a person should know about a section before believing anything about it."""
    if quality is not None:
        yield from quality.notes
    if subject.has_islands:
        yield "with an island the beam is not what the solid converges to"
    moved = subject.sealing_moved
    if moved is not None:
        median = float(np.median(moved))
        yield f"sealing moved the beam's tips by {median:.2f} (median) … {moved.max():.2f} mm"


def _geometry(checked: Checked) -> Iterator[tuple[str, str]]:
    steps = checked.geometry
    if steps is not None:
        smooth, outline = steps.raster_to_smooth, steps.smooth_to_outline
        yield "beam's tip", f"raster → outline {smooth:.3f} mm, → polygons {outline:.3f} mm"
        yield "", f"→ mesh {steps.outline_to_mesh:.3f} mm"


def _solids(checked: Checked) -> Iterator[tuple[str, str]]:
    """One line a mesh: both penalties share it."""
    for stage in {stage.mesh: stage for stage in checked.stages}.values():
        solid = stage.solid
        size = f"{len(solid.section.triangles)} triangles × {solid.heights.size - 1} layers"
        unknowns = solid.body().unknowns
        yield f"{stage.mesh} mesh", f"{size} of {solid.element}, {unknowns:,} unknowns"


def _parts(checked: Checked) -> Iterator[tuple[str, str]]:
    """What the difference is made of, by the worst case of each."""
    compared = checked.comparison
    if compared is not None:
        loaded = compared.is_loaded
        mesh, rest = (
            _most(part[loaded]) for part in (compared.discretisation, compared.assumptions)
        )
        yield "difference", f"from the mesh (estimated) up to {mesh}, else up to {rest}"
        most = max(checked.options.penalties)
        error = _most(compared.penalty_error[loaded])
        yield "", f"c = {most:g} alone would leave up to {error}; extrapolated to ∞"


def _most(values: FloatArray) -> str:
    known = values[~np.isnan(values)]
    return f"{known.max():.3f} mm" if known.size else "an unknown amount"


def _table(checked: Checked) -> Table:
    """27 rows of what matters most."""
    compared = checked.comparison
    assert compared is not None
    table = Table(title="beam against solid, extrapolated in 1/c", title_justify="left")
    for name in ("p1 [kPa]", "p2", "p3", "moves [mm]", "differs [mm]", "share"):
        table.add_column(name, justify="right")
    table.add_column("status")
    for row, pressures in enumerate(compared.subject.pressures):
        difference, share = compared.difference[row], compared.share[row]
        answered = not np.isnan(difference)
        table.add_row(
            *(f"{value:g}" for value in pressures),
            f"{compared.displacement[row]:.2f}",
            f"{difference:.4f}" if answered else "–",
            f"{100 * share:.3f} %" if answered else "–",
            _ended(compared, row),
        )
    return table


def _ended(compared: Comparison, row: int) -> str:
    load = compared.final.reached[row] * float(np.abs(compared.subject.pressures[row]).max())
    return str(Ended(compared.final.statuses[row], load))
