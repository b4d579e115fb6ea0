"""Baseline files: what is held of one design, its digest, and where it stands."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from beamopt.base.errors import InputError
from beamopt.storage.checked_keys import CheckedKeys, Number, parse
from beamopt.storage.checked_keys import quantity as described
from beamopt.storage.input_file import read_json
from beamopt.storage.result_folder import FolderKind
from beamopt.storage.writing import check_replaceable, json_text, write_atomic
from femcheck.continuation.ended import Ended
from femcheck.continuation.old_wordings import OLD_FAULTS, ended_of
from femcheck.regression.held import LADDER, Held, Row
from femcheck.regression.held_design import HeldDesign, design_digest
from femcheck.regression.kept_mesh import mesh_digest

__all__ = [
    "KIND",
    "Baseline",
    "baseline_file",
    "check_baseline_file",
    "check_unchanged",
    "read_baseline",
    "still_held",
    "write_baseline",
]

SCHEMA = "femcheck-baseline/1"
KIND = FolderKind("baselines", "*.json", ('{"schema":"femcheck-baseline/',))


def _known(rung: str) -> str:
    if rung not in LADDER:
        raise ValueError(f"one of {', '.join(LADDER)}")
    return rung


def _reason(key: str) -> str:
    ended_of(key)
    return key


Reason = Annotated[str, AfterValidator(_reason)]
"""The key of an ending; in earlier files its text."""


class Entry(CheckedKeys):
    """One thing held; see `Held`."""

    rung: Annotated[str, AfterValidator(_known)] = described(..., "of the ladder")
    resolution: str = described(..., "how fine, for people")
    law: str = described(..., "of the material")
    quantity: str = described(..., "what the rows are")
    unit: str = described(..., "of the numbers")
    rows: dict[str, tuple[Number, ...] | Reason] = described(..., "numbers, or why there are none")
    tolerance: Number = described(..., "how far a row may move", low=0)
    source: str = described(..., "where the tolerance comes from")

    @property
    def held(self) -> Held:
        """What it holds."""
        values = {name: getattr(self, name) for name in type(self).model_fields}
        rows: dict[str, Row] = {
            OLD_FAULTS.get(name, name): ended_of(row) if isinstance(row, str) else row
            for name, row in self.rows.items()
        }
        return Held(**values | {"rows": rows})


class BaselineOrigin(CheckedKeys):
    """Of which design it is."""

    digest: str = described(..., "of all that its tips depend on")
    file: str | None = described(None, "relative to this file; none for one of the package's")


class Baseline(CheckedKeys):
    """What is held of one design."""

    schema_: Literal["femcheck-baseline/1"] = Field(alias="schema")
    name: str = described(..., "of the design")
    design: BaselineOrigin = described(..., "digest and file")
    mesh: str | None = described(None, "digest of its kept section mesh, where it has a solid")
    held: tuple[Entry, ...] = described(..., "from the lowest rung on")

    @property
    def rungs(self) -> frozenset[str]:
        """The rungs that are held."""
        return frozenset(entry.rung for entry in self.held)


def baseline_file(folder: Path, name: str) -> Path:
    """Where the baseline of a design stands."""
    return folder / f"{name}.json"


def check_baseline_file(folder: Path, design: HeldDesign, *, force: bool) -> None:
    """Refuse to write a baseline over what is none.

    Raises
    ------
    InputError : the design itself stands under that name, or a file that is no baseline and `force`
        is off.
    """
    file = baseline_file(folder, design.name)
    if design.file is not None and file.resolve() == design.file.resolve():
        raise InputError(file, "", None, "is the design itself: another folder for its baseline")
    check_replaceable(file, SCHEMA, "femcheck baseline", force=force)


def write_baseline(folder: Path, design: HeldDesign, held: tuple[Held, ...]) -> Path:
    """Write what is held of a design, with no more digits than its tolerances leave a meaning to.

    Raises
    ------
    OSError : the folder is missing or can not be written.
    """
    file = baseline_file(folder, design.name)
    where = None if design.file is None else Path(os.path.relpath(design.file, folder)).as_posix()
    content = {
        "design": {"digest": design_digest(design.design), "file": where},
        "held": [_entry(one.written()) for one in held],
        "mesh": mesh_digest(design.mesh) if _meshed(held) else None,
        "name": design.name,
    }
    write_atomic(file, json_text({"schema": SCHEMA} | content, escaped=False))  # "mm³" as it is
    return file


def _meshed(held: tuple[Held, ...]) -> bool:
    return any(_needs_mesh(one.rung) for one in held)


def _needs_mesh(rung: str) -> bool:
    return LADDER.index(rung) >= LADDER.index("kept mesh")


def _entry(held: Held) -> dict[str, object]:
    rows = {n: row.key if isinstance(row, Ended) else list(row) for n, row in held.rows.items()}
    values = {name: getattr(held, name) for name in sorted(Entry.model_fields)}
    return values | {"rows": rows}


def read_baseline(file: Path) -> Baseline:
    """Read a baseline.

    Raises
    ------
    InputError : it is missing, damaged, or of another schema.
    """
    if not file.exists():
        raise InputError(file, "", None, "no baseline: `femcheck baseline` writes it")
    data = read_json(file)
    schema = data.get("schema")
    if schema != SCHEMA:
        raise InputError(file, "schema", schema, f"this version reads {SCHEMA}")
    return parse(Baseline, data, file)


def still_held(file: Path, design: HeldDesign) -> tuple[Held, ...]:
    """What a baseline holds of the design as it is, on rungs that are not the design's `rungs`.

    Nothing where there is no baseline that can be read, or one of another section; of rungs on a
    mesh nothing where that is another one.
    """
    try:
        found = read_baseline(file)
    except InputError:
        return ()
    if found.design.digest != design_digest(design.design):
        return ()
    same = found.mesh is not None and design.mesh.exists()
    same = same and found.mesh == mesh_digest(design.mesh)
    rest = [one.held for one in found.held if one.rung not in design.rungs]
    return tuple(one for one in rest if same or not _needs_mesh(one.rung))


def check_unchanged(file: Path, baseline: Baseline, design: HeldDesign) -> None:
    """Refuse to compare results of another design, or on another mesh.

    Raises
    ------
    InputError : the design or its mesh changed since the baseline was written.
    """
    again = "that says nothing of the code; write the baseline anew if it is meant"
    if baseline.design.digest != design_digest(design.design):
        said = f"{design.name} is not the design that this was written of any more; {again}"
        raise InputError(file, "design.digest", None, said)
    if baseline.mesh is not None and baseline.mesh != mesh_digest(design.mesh):
        said = f"{design.mesh} is not the mesh that this was written on any more; {again}"
        raise InputError(file, "mesh", None, said)
