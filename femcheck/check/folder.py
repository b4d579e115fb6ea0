"""The folder of one check: the design, solved cases, tables, meshes, picture."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from beamopt.errors import InputError
from beamopt.files import csv_text, json_text, write_atomic
from beamopt.folder import claim_folder, clear_leftovers
from beamopt.model import read_json
from beamopt.provenance import provenance
from femcheck.check.checked import Checked
from femcheck.check.options import CheckOptions
from femcheck.check.subject import Subject
from femcheck.check.tables import compare_csv, summary, table_csv, timing_csv

__all__ = ["CheckFolder"]

MARKER = "check.json"
NAMES = (
    MARKER,
    "design.json",
    "compare.csv",
    "table.csv",
    "summary.json",
    "timing.csv",
    "provenance.json",
    "mesh.msh",
    "mesh.vtu",
    "picture.png",
    "picture.log",
)
EARLY = ("cases", "design.json")  # what may be there before the marker
OF_A_SOLID = ("compare.csv", "table.csv", "mesh.msh", "mesh.vtu", "picture.png", "picture.log")
PACKAGES = ("scikit-fem", "gmsh", "meshio", "pyvista", "pypardiso", "shapely")


@dataclass(frozen=True, slots=True)
class CheckFolder:
    """The files of a check."""

    path: Path

    @classmethod
    def open(
        cls, path: Path, subject: Subject, options: CheckOptions, *, resume: bool
    ) -> CheckFolder:
        """Make the folder, or with `resume` take the one there.

        Raises
        ------
        InputError : it holds something already, or the check of another design or question.
        """
        claim_folder(path, MARKER, EARLY, resume=resume)
        clear_leftovers(path, NAMES)
        asked = {
            "schema": "femcheck/1",
            "design": subject.name,
            "question": options.question,
        }
        there = path / MARKER
        if there.exists():
            kept = read_json(there)
            for key, before, now in _differences(kept, json.loads(json_text(asked))):
                said = f"the check to go on with; now asked for: {now}"
                raise InputError(there, key, before, said)
            design = path / "design.json"
            if design.exists() and design.read_text(encoding="utf-8") != subject.design.json():
                raise InputError(design, "", None, "differs from the design asked for now")
        cases = path / "cases"
        cases.mkdir(exist_ok=True)
        clear_leftovers(cases, None)
        subject.design.save(path / "design.json")
        write_atomic(there, json_text(asked))
        return cls(path)

    @property
    def cases(self) -> Path:
        """Solved cases, one file each."""
        return self.path / "cases"

    def write(self, checked: Checked) -> None:
        """Write tables, meshes and the picture; each whole or not at all."""
        if checked.comparison is None:
            for name in OF_A_SOLID:  # of a check that had an answer before
                (self.path / name).unlink(missing_ok=True)
        else:
            write_atomic(self.path / "compare.csv", compare_csv(checked))
            write_atomic(self.path / "table.csv", table_csv(checked.comparison))
        write_atomic(self.path / "summary.json", json_text(summary(checked)))
        write_atomic(self.path / "timing.csv", csv_text("what,value,unit", timing_csv(checked)))
        write_atomic(self.path / "provenance.json", json_text(provenance(PACKAGES)))
        if checked.comparison is not None:
            self._write_meshes(checked)

    def _write_meshes(self, checked: Checked) -> None:
        from femcheck.mesh.files import write_deformed, write_mesh

        stage = [one for one in checked.stages if one.mesh == "standard"][-1]
        write_mesh(self.path, stage.solid.body().extrusion)
        shown = stage.solid.shown()
        deformed = self.path / "deformed"
        deformed.mkdir(exist_ok=True)
        for (name, node), result in checked.results.items():
            if name == stage.name and result.outcome.state is not None:
                levels = [checked.subject.design.pressures[index] for index in node]
                file = deformed / f"{'-'.join(f'{level:g}' for level in levels)}.vtu"
                write_deformed(file, shown.extrusion, result.outcome.state.x[shown.nodes])


def _differences(before: Any, now: Any, key: str = "") -> Iterator[tuple[str, Any, Any]]:
    """Keys of nested tables whose values differ, with both values."""
    if isinstance(before, dict) and isinstance(now, dict):
        for name in now:
            yield from _differences(before.get(name), now[name], f"{key}.{name}" if key else name)
    elif before != now:
        yield key, before, now
