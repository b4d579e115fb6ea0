"""Baselines written, and held against what the rungs say now."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from glob import escape
from pathlib import Path

from beamopt.base.errors import InputError
from beamopt.base.provenance import provenance
from beamopt.storage.result_folder import claimed, clear_leftovers
from beamopt.storage.writing import json_text, write_atomic
from femcheck.regression.agreement import contradictions
from femcheck.regression.baseline import (
    KIND,
    Baseline,
    baseline_file,
    check_baseline_file,
    check_unchanged,
    read_baseline,
    still_held,
    write_baseline,
)
from femcheck.regression.held import LADDER, Held, is_late
from femcheck.regression.held_design import BUNDLED, HeldDesign, design_digest, find_design
from femcheck.regression.kept_mesh import check_mesh_file, is_of, make_section, write_section
from femcheck.regression.measure import MeasuredPart, measure_all, parts_of
from femcheck.regression.moved import Moved, compare, lowest

__all__ = ["ContradictionError", "Regression", "hold_designs", "regress", "update_baseline"]

PROVENANCE = "provenance.json"
WAITING = 600.0  # s, for another update of the same folder
LIBRARIES = ("scikit-fem", "pypardiso", "gmsh", "meshio")

Callback = Callable[[str, str, int], None]
"""Called with a design, a part of it that is done, and how many parts there are in all."""

DesignCallback = Callable[[HeldDesign], None]
"""Called with every design that is named, before its rungs are computed."""


class ContradictionError(ValueError):
    """Rungs of a design contradict each other: there is nothing that could be held."""


@dataclass(frozen=True, eq=False)
class Regression:
    """What became of baselines.

    moved : rows that moved, from the lowest rung on, whatever the design.
    late : rows whose case ended by its time limit: whether they moved is not known.
    rungs, rows : how many were compared; designs : their names.
    """

    moved: tuple[Moved, ...]
    late: tuple[Moved, ...]
    designs: tuple[str, ...]
    rungs: int
    rows: int

    @property
    def holds(self) -> bool:
        """Whether nothing moved, and all is known."""
        return not self.moved and not self.late

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
    named: DesignCallback | None = None,
) -> list[Path]:
    """Write what all rungs of the designs say today; those of the package if none is named.

    Raises
    ------
    InputError : a baseline, or another file in the place of one or of its mesh, is there already
        and `force` is not given; the folder has other files and no baseline; no such design.
    ContradictionError : independent rungs contradict each other; nothing is written.
    """
    designs = [find_design(name, meshes) for name in names or BUNDLED]
    _check_names(designs)
    _call(named, designs if names else ())
    for one in designs:
        check_baseline_file(folder, one, force=force)
        file = baseline_file(folder, one.name)
        if file.exists() and not force:
            raise InputError(file, "", None, "there already; --force writes it anew")
    with claimed(folder, KIND, resume=True):
        _clear(folder, designs)
        for one in designs:
            _have_mesh(one, force=force)
        measured = measure_all(
            designs, estimate=True, workers=workers, callback=_counted(callback, designs)
        )
        wrong = [f"{one.name}: {said}" for one in designs for said in _wrong(one, measured)]
        if wrong:
            raise ContradictionError("; ".join(wrong))
        files = [write_baseline(folder, one, measured[one.name].held) for one in designs]
        write_atomic(folder / PROVENANCE, json_text(provenance(LIBRARIES)))
    return files


def _clear(folder: Path, designs: Sequence[HeldDesign]) -> None:
    """Delete what a kill left of writing the baselines of these designs."""
    names = [baseline_file(folder, one.name).name for one in designs]
    clear_leftovers(folder, [*map(escape, names), PROVENANCE])
    for one in designs:
        if one.mesh.parent.is_dir():
            clear_leftovers(one.mesh.parent, [escape(one.mesh.name)])


def update_baseline(design: HeldDesign, folder: Path, rungs: Collection[str] | None = None) -> Path:
    """Write what rungs of one design say today; what is held of other ones stays.

    rungs : those that are wanted; the design's own `rungs`, as far as it has them, if None.

    Raises
    ------
    InputError : no mesh of its section; a rung that is wanted and that the design does not have;
        a file that is no baseline, or no mesh of one, in its place.
    ContradictionError : independent rungs contradict each other; nothing is written.
    """
    if rungs is not None:
        design = replace(design, rungs=frozenset(rungs))
    check_baseline_file(folder, design, force=False)
    with claimed(folder, KIND, resume=True, patience=WAITING):
        _clear(folder, [design])
        _have_mesh(design, force=False)
        measured = measure_all([design], estimate=True)
        wrong = _wrong(design, measured)
        if wrong:
            raise ContradictionError(f"{design.name}: {'; '.join(wrong)}")
        now = measured[design.name].held
        if rungs is not None:
            _require(rungs, {one.rung for one in now}, design.name, "of this design there is")
        rest = still_held(baseline_file(folder, design.name), design)
        held = sorted((*rest, *now), key=lambda one: LADDER.index(one.rung))
        return write_baseline(folder, design, tuple(held))


def regress(
    names: Sequence[str],
    folder: Path,
    meshes: Path,
    *,
    workers: int = 1,
    rungs: Collection[str] | None = None,
    callback: Callback | None = None,
    named: DesignCallback | None = None,
) -> Regression:
    """Compute everything that is held anew, and compare.

    names : designs; all that have a baseline in the folder if there are none.
    rungs : those that are looked at; all that are held if None.

    Raises
    ------
    InputError : a baseline is missing or damaged, does not hold one of `rungs`, or its design
        changed since.
    """
    found = [_read(folder, name, meshes) for name in names or _all_in(folder)]
    if not names:
        _require_bundled(folder, found)
    chosen = []
    for design, base in found:
        wanted = base.rungs if rungs is None else frozenset(rungs)
        _require(wanted, base.rungs, baseline_file(folder, design.name), "what is held:")
        chosen.append((replace(design, rungs=wanted), base))
    designs = [design for design, _ in chosen]
    _check_names(designs)
    _call(named, designs if names else ())
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
    late = tuple(one for one in moved if is_late(one.now))
    rest = tuple(one for one in moved if not is_late(one.now))
    rows = sum(len(one.rows) for one in compared)
    count = sum(len(design.rungs) for design in designs)
    return Regression(rest, late, tuple(one.name for one in designs), count, rows)


def _read(folder: Path, given: str, meshes: Path) -> tuple[HeldDesign, Baseline]:
    """A baseline and the design that it is of, by the baseline's name or the design's file."""
    file = baseline_file(folder, given)
    if Path(given).name == given and file.exists():
        baseline = read_baseline(file)
        origin = baseline.design.file  # goes before the package's designs: names may be the same
        design = find_design(given if origin is None else str(folder / origin), meshes)
        design = replace(design, name=given, mesh=meshes / f"{given}.msh")
    else:
        design = find_design(given, meshes)
        file = baseline_file(folder, design.name)
        baseline = read_baseline(file)
    check_unchanged(file, baseline, design)
    return design, baseline


def _require(wanted: Collection[str], there: Collection[str], where: object, said: str) -> None:
    """Refuse rungs that are not there: nothing would be held of them."""
    missing = [rung for rung in wanted if rung not in there]
    if missing:
        known = ", ".join(rung for rung in LADDER if rung in there) or "nothing"
        raise InputError(where, "rungs", ", ".join(missing), f"{said} {known}")


def _require_bundled(folder: Path, found: Sequence[tuple[HeldDesign, Baseline]]) -> None:
    """Where some of the package's designs are held, all are: a lost baseline holds nothing."""
    held = {design.name for design, base in found if base.design.file is None}
    lost = [name for name in BUNDLED if held and name not in held]
    if lost:
        said = f"no baseline of {', '.join(lost)}: `femcheck baseline` writes it, or name DESIGNs"
        raise InputError(folder, "", None, said)


def _all_in(folder: Path) -> list[str]:
    names = sorted(file.stem for file in folder.glob("*.json") if file.name != PROVENANCE)
    if not names:
        raise InputError(folder, "", None, "no baseline here: `femcheck baseline` writes them")
    return names


def _check_names(designs: Sequence[HeldDesign]) -> None:
    names = [one.name for one in designs]
    for name in names:
        if names.count(name) > 1:
            raise InputError("", "DESIGN", name, "twice: every design needs a name of its own")


def _have_mesh(design: HeldDesign, *, force: bool) -> None:
    """Make the small mesh of a design that has a solid; one of the design as it is is kept.

    force : whether it may take the place of a file that is no such mesh.
    """
    digest = design_digest(design.design)
    is_meshed = any(part not in ("sections", "rods") for part in parts_of(design))
    if is_meshed and not is_of(design.mesh, digest):
        check_mesh_file(design.mesh, force=force)
        design.mesh.parent.mkdir(parents=True, exist_ok=True)
        write_section(design.mesh, make_section(design.design), digest)


def _wrong(design: HeldDesign, measured: Mapping[str, MeasuredPart]) -> list[str]:
    found = measured[design.name]
    broken = [found.broken] if found.broken else []
    return broken + contradictions(found.held, design.design.actuator.length)


def _call(callback: DesignCallback | None, designs: Sequence[HeldDesign]) -> None:
    if callback is not None:
        for design in designs:
            callback(design)


def _counted(
    callback: Callback | None,
    designs: Sequence[HeldDesign],
) -> Callable[[str, str], None] | None:
    if callback is None:
        return None
    total = sum(len(parts_of(one)) for one in designs)
    return lambda design, part: callback(design, part, total)
