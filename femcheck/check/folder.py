"""The folder of one verdict: the design, what was solved, tables, meshes, picture."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from beamopt.arrays import FloatArray
from beamopt.errors import InputError
from beamopt.files import json_text, write_atomic
from beamopt.folder import claim_folder, clear_leftovers, differences
from beamopt.input_file import read_json
from beamopt.provenance import provenance
from femcheck.check.case import Solid
from femcheck.check.subject import Subject

__all__ = ["CheckFolder"]

MARKER = "check.json"
COMMON = (MARKER, "design.json", "compare.csv", "summary.json", "timing.csv", "provenance.json")
PICTURES = ("mesh.msh", "mesh.vtu", "picture.png", "picture.log")
EARLY = ("cases", "design.json")  # what may be there before the marker
PACKAGES = ("scikit-fem", "gmsh", "meshio", "pyvista", "pypardiso", "shapely")


class CheckFolder:
    """The folder of one verdict on one design."""

    def __init__(self, path: Path) -> None:
        self.path = path

    @classmethod
    def open(
        cls, path: Path, subject: Subject, question: Mapping[str, object], *, resume: bool
    ) -> CheckFolder:
        """Make the folder, or with `resume` take the one there.

        question : what must be the same for what is there to be gone on with.

        Raises
        ------
        InputError : it holds something already, or another design's verdict or question's.
        """
        asked = {"schema": "femcheck/1", "design": subject.name, "question": dict(question)}
        text, design_text = json_text(asked), subject.design.json()  # before the folder is made
        claim_folder(path, MARKER, EARLY, resume=resume)
        there = path / MARKER
        if there.exists():
            kept = read_json(there)
            for key, before, now in differences(kept, json.loads(text)):
                said = f"is what is there; now asked for: {now}; name another folder, or ask alike"
                raise InputError(there, key, before, said)
            design = path / "design.json"
            if design.exists() and design.read_bytes() != design_text.encode():
                raise InputError(design, "", None, "differs from the design asked for now")
        cases = path / "cases"
        cases.mkdir(exist_ok=True)
        clear_leftovers(cases, None)
        write_atomic(path / "design.json", design_text)
        write_atomic(there, text)
        return cls(path)

    @property
    def cases(self) -> Path:
        """What was solved, one file each."""
        return self.path / "cases"

    def write(self, files: Mapping[str, str | None]) -> None:
        """Write texts by file name, each whole or not at all; None takes a file away."""
        clear_leftovers(self.path, (*COMMON, *PICTURES, *files))
        for name, text in files.items():
            if text is None:
                (self.path / name).unlink(missing_ok=True)
            else:
                write_atomic(self.path / name, text)
        write_atomic(self.path / "provenance.json", json_text(provenance(PACKAGES)))

    def write_meshes(self, solid: Solid, states: Mapping[str, FloatArray]) -> None:
        """Write the undeformed mesh, and below `deformed` positions of its nodes by name."""
        from femcheck.mesh.files import write_deformed, write_mesh

        shown = solid.shown()
        write_mesh(self.path, solid.body().extrusion)
        deformed = self.path / "deformed"
        deformed.mkdir(exist_ok=True)
        for name, x in states.items():
            write_deformed(deformed / f"{name}.vtu", shown.extrusion, x[shown.nodes])

    def without_answer(self) -> None:
        """Take away pictures and meshes of a verdict that had an answer before."""
        for name in PICTURES:
            (self.path / name).unlink(missing_ok=True)
