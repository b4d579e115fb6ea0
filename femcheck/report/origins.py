"""Where each result comes from: versions, machine, threads, seeds, meshes, energies."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from femcheck.material.rigid_section import RigidSection
from femcheck.report.accuracy_run import AccuracyRun
from femcheck.report.content import Record
from femcheck.report.other_runs import FigureRun, SearchRun
from femcheck.report.solid_run import SolidRun
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
    rest = {key: value for key, value in made.data.items() if key not in KNOWN}
    yield from flat(rest).items()
    machine = made.table("machine")
    yield "CPU", f"{machine.get('processor', '–')}, {machine.get('processors', '–')} processors"
    system = (str(machine[key]) for key in ("system", "architecture") if key in machine)
    yield "system", ", ".join(system)
    yield "threads", _pairs(made, "threads", "=")
    yield "versions", _pairs(made, "versions", " ")


KNOWN = ("versions", "machine", "threads", "verdict")


def _pairs(made: Record, key: str, between: str) -> str:
    return ", ".join(f"{name}{between}{value}" for name, value in made.table(key).items())


def _solid(run: SolidRun) -> Iterator[tuple[str, str]]:
    summary, design = run.summary, run.subject.design
    yield "design", run.subject.name
    if "seed" in design.notes:
        yield "seed of the search", str(design.notes["seed"])
    if summary.has("material.energy"):
        yield "energy W", summary.text("material.energy")
        for constant in summary.list("material.constants"):
            yield "constant", _constant(Record(summary.file, {"constant": constant}))
        winding = summary.data["material"].get("winding")
        yield "winding", "none" if winding is None else _winding(winding)
    elif not run.is_prediction:
        modulus = design.actuator.youngs_modulus
        for penalty in _penalties(summary):
            yield "energy W", RigidSection(modulus, penalty).text
    if summary.has("solids"):
        for place in range(len(summary.list("solids"))):
            yield "mesh", _mesh(Record(summary.file, {"solid": summary.list("solids")[place]}))
    yield "processor time", duration(run.seconds)


def _penalties(summary: Record) -> list[float]:
    """c of every solid, each once."""
    solids = summary.list("solids") if summary.has("solids") else []
    found = [Record(summary.file, {"solids": one}).number("solids.c") for one in solids]
    return list(dict.fromkeys(found))


def _constant(one: Record) -> str:
    unit = one.text("constant.unit")
    value = f"{number(one.number('constant.value'), 6)} {unit}".strip()
    return f"{one.text('constant.name')} = {value} ({one.text('constant.source')})"


def _winding(winding: Any) -> str:
    if isinstance(winding, Mapping):
        return ", ".join(f"{name} {value}" for name, value in flat(winding).items())
    return str(winding)


def _mesh(one: Record) -> str:
    """Size of a solid, in words."""
    triangles, layers, unknowns = (
        one.number(f"solid.{key}") for key in ("triangles", "layers", "unknowns")
    )
    kind = f", c = {number(one.number('solid.c'), 6)}" if one.has("solid.c") else ""
    form = f", {one.text('solid.form')}" if one.has("solid.form") else ""
    return (
        f"{one.text('solid.mesh')}{kind}{form}: {triangles:.0f} triangles × {layers:.0f} layers of "
        f"{one.text('solid.element')}, {unknowns:,.0f} unknowns; {one.text('solid.stability')}"
    )
