"""Where each result comes from: versions, machine, threads, seeds, meshes, energies."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from femcheck.material.rigid_section import RigidSection
from femcheck.report.accuracy_run import AccuracyRun
from femcheck.report.other_runs import FigureRun, SearchRun
from femcheck.report.solid_run import SolidRun
from femcheck.report.summaries import ConstantKeys, SolidKeys
from femcheck.report.wording import duration, flat, number

__all__ = ["Origin", "origin_of"]


@dataclass(frozen=True, slots=True)
class Origin:
    """A folder's provenance. lines : names and texts."""

    name: str
    lines: tuple[tuple[str, str], ...]


def origin_of(run: SolidRun | AccuracyRun | SearchRun | FigureRun) -> Origin:
    """What made a folder's results.

    Raises
    ------
    InputError : a provenance without versions, machine or threads.
    """
    folder = run.folder.resolve()
    return Origin(f"{folder.parent.name}/{folder.name}", tuple(_lines(run)))


def _lines(run: SolidRun | AccuracyRun | SearchRun | FigureRun) -> Iterator[tuple[str, str]]:
    if isinstance(run, SolidRun):
        yield from _solid(run)
    elif isinstance(run, AccuracyRun):
        yield "design", run.name
        yield "processor time", duration(run.seconds)
    elif isinstance(run, SearchRun):
        yield "search", run.name
        yield "time", duration(run.seconds)
    made = run.provenance
    yield from flat(made.model_extra or {}).items()
    machine = made.machine
    yield "CPU", f"{machine.get('processor', '–')}, {machine.get('processors', '–')} processors"
    system = (str(machine[key]) for key in ("system", "architecture") if key in machine)
    yield "system", ", ".join(system)
    yield "threads", _pairs(made.threads, "=")
    yield "versions", _pairs(made.versions, " ")


def _pairs(values: Mapping[str, Any], between: str) -> str:
    return ", ".join(f"{name}{between}{value}" for name, value in values.items())


def _solid(run: SolidRun) -> Iterator[tuple[str, str]]:
    summary, design = run.summary, run.subject.design
    yield "design", run.subject.name
    if "seed" in design.notes:
        yield "seed of the search", str(design.notes["seed"])
    solids = summary.solids or []
    if summary.energy is not None:
        yield "energy W", summary.energy
        for constant in summary.constants:
            yield "constant", _constant(constant)
        yield "winding", "none" if summary.winding is None else _winding(summary.winding)
    elif not run.is_prediction:
        modulus = design.actuator.youngs_modulus
        for penalty in dict.fromkeys(one.c for one in solids if one.c is not None):
            yield "energy W", RigidSection(modulus, penalty).text
    for one in solids:
        yield "mesh", _mesh(one)
    yield "processor time", duration(run.seconds)


def _constant(one: ConstantKeys) -> str:
    value = f"{number(one.value, 6)} {one.unit}".strip()
    return f"{one.name} = {value} ({one.source})"


def _winding(winding: Any) -> str:
    if isinstance(winding, Mapping):
        return ", ".join(f"{name} {value}" for name, value in flat(winding).items())
    return str(winding)


def _mesh(one: SolidKeys) -> str:
    """Size of a solid, in words."""
    kind = "" if one.c is None else f", c = {number(one.c, 6)}"
    form = "" if one.form is None else f", {one.form}"
    return (
        f"{one.mesh}{kind}{form}: {one.triangles:.0f} triangles × {one.layers:.0f} layers of "
        f"{one.element}, {one.unknowns:,.0f} unknowns; {one.stability}"
    )
