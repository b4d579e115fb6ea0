"""Baselines written, and held against what the rungs say now."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from beamopt.errors import InputError
from beamopt.files import json_text, write_atomic
from beamopt.provenance import provenance
from femcheck.regression.agreement import contradictions
from femcheck.regression.baseline import (
    Baseline,
    baseline_file,
    check_unchanged,
    read_baseline,
    write_baseline,
)
from femcheck.regression.held import LADDER, Held
from femcheck.regression.held_design import BUNDLED, HeldDesign, find_design
from femcheck.regression.kept_mesh import make_section, write_section
from femcheck.regression.measure import Measured, measure_all, parts_of
from femcheck.regression.moved import Moved, compare, lowest

__all__ = ["ContradictionError", "Regression", "hold_designs", "regress", "update_baseline"]

LIBRARIES = ("scikit-fem", "pypardiso", "gmsh", "meshio")

Callback = Callable[[str, str, int], None]
"""Called with a design, a part of it that is done, and how many parts there are in all."""


class ContradictionError(ValueError):
    """Rungs of a design contradict each other: there is nothing that could be held."""


@dataclass(frozen=True, eq=False)
class Regression:
    """What became of baselines.

    moved : rows that moved, from the lowest rung on, whatever the design.
    rungs, rows : how many were compared; designs : their names.
    """

    moved: tuple[Moved, ...]
    designs: tuple[str, ...]
    rungs: int
    rows: int

    @property
    def holds(self) -> bool:
        """Whether nothing moved."""
        return not self.moved

    @property
    def lowest(self) -> Moved | None:
        """What moved on the lowest rung."""
        return lowest(self.moved)


def hold_designs(
    names: Sequence[str],
    folder: Path,
    meshes: Path,
    *,
    force: bool = False,
    workers: int = 1,
    callback: Callback | None = None,
) -> list[Path]:
    """Write what all rungs of the designs say today; those of the package if none is named.

    Raises
    ------
    InputError : a baseline is there already and `force` is not given; no such design.
    ContradictionError : independent rungs contradict each other; nothing is written.
    """
    designs = [find_design(name, meshes) for name in names or BUNDLED]
    _check_names(designs)
    there = [baseline_file(folder, one.name) for one in designs]
    for file in there:
        if file.exists() and not force:
            raise InputError(file, "", None, "there already; --force writes it anew")
    folder.mkdir(parents=True, exist_ok=True)
    for one in designs:
        _have_mesh(one)
    measured = measure_all(
        designs, estimate=True, workers=workers, callback=_counted(callback, designs)
    )
    wrong = [f"{one.name}: {said}" for one in designs for said in _wrong(one, measured[one.name])]
    if wrong:
        raise ContradictionError("; ".join(wrong))
    write_atomic(folder / "provenance.json", json_text(provenance(LIBRARIES)))
    return [write_baseline(folder, one, measured[one.name].held) for one in designs]


def update_baseline(design: HeldDesign, folder: Path) -> Path:
    """Write what the rungs of one design say today, over what was there.

    Raises
    ------
    InputError : no mesh of its section.
    ContradictionError : independent rungs contradict each other; nothing is written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    _have_mesh(design)
    measured = measure_all([design], estimate=True)[design.name]
    wrong = _wrong(design, measured)
    if wrong:
        raise ContradictionError(f"{design.name}: {'; '.join(wrong)}")
    return write_baseline(folder, design, measured.held)


def regress(
    names: Sequence[str],
    folder: Path,
    meshes: Path,
    *,
    workers: int = 1,
    rungs: Collection[str] | None = None,
    callback: Callback | None = None,
) -> Regression:
    """Compute everything that is held anew, and compare.

    names : designs; all that have a baseline in the folder if there are none.
    rungs : those that are looked at; all that are held if None.

    Raises
    ------
    InputError : a baseline is missing or damaged, or its design changed since.
    """
    found = [_read(folder, name, meshes) for name in names or _all_in(folder)]
    chosen = [
        (replace(design, rungs=base.rungs if rungs is None else base.rungs & set(rungs)), base)
        for design, base in found
    ]
    designs = [design for design, _ in chosen]
    _check_names(designs)
    measured = measure_all(
        designs, estimate=False, workers=workers, callback=_counted(callback, designs)
    )
    moved: list[Moved] = []
    compared: list[Held] = []
    for design, base in chosen:
        held = [entry.held for entry in base.held if entry.rung in design.rungs]
        compared += held
        moved += compare(design.name, held, measured[design.name])
    moved.sort(key=lambda one: LADDER.index(one.held.rung))
    rows = sum(len(one.rows) for one in compared)
    count = sum(len(design.rungs) for design in designs)
    return Regression(tuple(moved), tuple(one.name for one in designs), count, rows)


def _read(folder: Path, given: str, meshes: Path) -> tuple[HeldDesign, Baseline]:
    """A baseline and the design that it is of, by the design's name or file."""
    plain = Path(given).name == given and not Path(given).suffix
    name = given if given in BUNDLED else Path(given).stem
    file = baseline_file(folder, name)
    baseline = read_baseline(file)
    origin = baseline.design.file
    from_there = plain and given not in BUNDLED and origin is not None
    design = find_design(str(folder / str(origin)) if from_there else given, meshes)
    check_unchanged(file, baseline, design)
    return design, baseline


def _all_in(folder: Path) -> list[str]:
    names = sorted(file.stem for file in folder.glob("*.json") if file.name != "provenance.json")
    if not names:
        raise InputError(folder, "", None, "no baseline here: `femcheck baseline` writes them")
    return names


def _check_names(designs: Sequence[HeldDesign]) -> None:
    names = [one.name for one in designs]
    for name in names:
        if names.count(name) > 1:
            raise InputError("", "DESIGN", name, "twice: every design needs a name of its own")


def _have_mesh(design: HeldDesign) -> None:
    """Make the small mesh of a design that has a solid; one that is there is kept."""
    if "meshes" in parts_of(design) and not design.mesh.exists():
        design.mesh.parent.mkdir(parents=True, exist_ok=True)
        write_section(design.mesh, make_section(design.design))


def _wrong(design: HeldDesign, measured: Measured) -> list[str]:
    broken = [measured.broken] if measured.broken else []
    return broken + contradictions(measured.held, design.design.actuator.length)


def _counted(
    callback: Callback | None,
    designs: Sequence[HeldDesign],
) -> Callable[[str, str], None] | None:
    if callback is None:
        return None
    total = sum(len(parts_of(one)) for one in designs)
    return lambda design, part: callback(design, part, total)
