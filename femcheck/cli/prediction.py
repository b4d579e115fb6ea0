"""What was predicted, told on the terminal."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from rich.markup import escape
from rich.table import Table

from beamopt.cli.progress import console
from femcheck.cli.report import notes_of
from femcheck.continuation.ended import Ended
from femcheck.continuation.outcome import Status
from femcheck.material.catalogue import constants_of
from femcheck.prediction.prediction import Prediction
from femcheck.prediction.verdict import advice, verdict

__all__ = ["report_prediction"]


def report_prediction(found: Prediction, folder: Path) -> None:
    """Say what was predicted."""
    console.print(f"[bold]{escape(found.subject.name)}[/]")
    for name, text in _lines(found):
        console.print(f"  {name:<16}{text}", soft_wrap=True, markup=False)
    if found.has_answers:
        console.print(_combinations(found))
        console.print(_limits(found))
    said = [("prediction", verdict(found)), ("", advice(found)), ("files", f"{folder}/")]
    for name, line in said:
        if line is not None:
            console.print(f"  {name:<16}{line}", soft_wrap=True, markup=False)


def _lines(found: Prediction) -> Iterator[tuple[str, str]]:
    """Material, mesh and notes, before the tables."""
    yield "material", f"{found.options.title}: {found.law.text}"
    for one in constants_of(found.law):
        unit = f" {one.unit}" if one.unit else ""
        yield "", f"{one.name} = {one.value:.6g}{unit} ({one.source})"
    if found.options.wound is not None:
        thread = found.options.thread
        said = f"{thread.stiffness:g} N/m, slack below rest, toe {thread.toe:g}"
        yield "winding", f"{found.options.wound.value}, {said}"
    actuator = found.subject.design.actuator
    yield "actuator", f"H = {actuator.length:g} mm, H/D = {found.subject.slenderness:.3g}"
    yield from (("note", note) for note in notes_of(found.subject, found.quality))
    for mesh, solid in found.solids.items():
        size = f"{len(solid.section.triangles)} triangles × {solid.heights.size - 1} layers"
        form = "displacements" if found.law.volumetric_compliance is None else "mixed"
        unknowns = f"{solid.body().unknowns:,} unknowns"
        yield f"{mesh} mesh", f"{size} of {solid.element} ({form}), {unknowns}"


def _combinations(found: Prediction) -> Table:
    """27 rows of what matters most."""
    title = f"beam against solid: {found.options.title}"
    table = Table(title=title, title_justify="left")
    for name in ("p1 [kPa]", "p2", "p3", "moves [mm]", "differs [mm]", "share", "stretch"):
        table.add_column(name, justify="right")
    table.add_column("status")
    for row, pressures in enumerate(found.subject.pressures):
        answer, difference = found.answer(row), found.difference[row]
        answered = not np.isnan(difference)
        table.add_row(
            *(f"{value:g}" for value in pressures),
            f"{found.displacement[row]:.2f}",
            f"{difference:.3f}" if answered else "–",
            f"{100 * found.share[row]:.2f} %" if answered else "–",
            f"{answer.stretch:.2f}" if answer is not None else "–",
            _ended(found.status(row), found.ended_at(row)) + _snapped(found.snap(row)),
        )
    return table


def _ended(status: Status, load: float) -> str:
    return str(Ended(status, None if np.isnan(load) else load))


def _snapped(load: float) -> str:
    return "" if np.isnan(load) else f", snapped at {load:.4g} kPa"


def _limits(found: Prediction) -> Table:
    """Where each supply alone, and all alike, end."""
    table = Table(title="limits", title_justify="left")
    for name in ("pressure in", "ends", "on the coarse mesh", "meshes", "chambers grow", "stretch"):
        table.add_column(name)
    for ends in found.compared:
        ray, result, last, coarse = ends.ray, ends.standard, ends.standard.last, ends.coarse
        if last is None:
            continue
        growth = found.growth(found.rays.index(ray))
        x, y, z = last.stretch_at
        table.add_row(
            ray.text,
            "–" if np.isnan(result.critical) else _ended(result.status, result.critical),
            "–" if coarse is None or np.isnan(coarse.critical) else f"{coarse.critical:.4g} kPa",
            ends.agreement.value + (f", {ends.ratio:.3g} times" if 1 < ends.ratio < np.inf else ""),
            f"{growth:.3g} times at {last.load:.3g} kPa" if np.isfinite(growth) else "–",
            f"{last.stretch:.2f} at ({x:.1f}, {y:.1f}, {z:.1f}) mm",
        )
    return table
