"""The folder of one verdict: the design, what was solved, tables, meshes, picture."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError
from beamopt.base.provenance import provenance
from beamopt.storage.input_file import read_bytes, read_json
from beamopt.storage.result_folder import (
    FolderKind,
    check_same,
    claimed,
    clear_leftovers,
    own_subfolder,
)
from beamopt.storage.writing import json_text, write_atomic
from femcheck.solved.case import Solid
from femcheck.solved.subject import Subject

__all__ = ["CheckFolder"]

MARKER = "check.json"
COMMON = (MARKER, "design.json", "compare.csv", "summary.json", "timing.csv", "provenance.json")
PICTURES = (
    *("mesh.msh", "mesh.vtu", "picture.png", "picture.log"),
    *("paths.png", "paths.svg", "axis.png", "axis.svg"),  # of a prediction
)
KIND = FolderKind("a check", MARKER, ('{"schema":"femcheck/',))
PACKAGES = ("scikit-fem", "gmsh", "meshio", "pyvista", "pypardiso", "shapely")


class CheckFolder:
    """The folder of one verdict on one design."""

    def __init__(self, path: Path) -> None:
        self.path = path

    @classmethod
    @contextmanager
    def open(
        cls, path: Path, subject: Subject, question: Mapping[str, object], *, resume: bool
    ) -> Iterator[CheckFolder]:
        """Make the folder, or with `resume` take the one there; hold it meanwhile.

        question : what must be the same for what is there to be gone on with.

        Raises
        ------
        InputError : it holds another design's verdict or question's, or see `claimed`.
        """
        asked = {"schema": "femcheck/1", "design": subject.name, "question": dict(question)}
        text, design_text = json_text(asked), subject.design.json()  # before the folder is made
        with claimed(path, KIND, resume=resume):
            folder = cls(path)
            folder._begin(text, design_text)
            yield folder

    def _begin(self, text: str, design_text: str) -> None:
        there, design = self.path / MARKER, self.path / "design.json"
        if there.exists():
            check_same(there, read_json(there), json.loads(text), "verdict")
            if design.exists() and read_bytes(design) != design_text.encode():
                raise InputError(design, "", None, "differs from the design asked for now")
        write_atomic(there, text)
        write_atomic(design, design_text)
        own_subfolder(self.cases)
        if self.deformed.exists():
            own_subfolder(self.deformed)

    @property
    def cases(self) -> Path:
        """What was solved, one file each."""
        return self.path / "cases"

    @property
    def deformed(self) -> Path:
        """Deformed meshes, one file a combination."""
        return self.path / "deformed"

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
        own_subfolder(self.deformed)
        for name, x in states.items():
            write_deformed(self.deformed / f"{name}.vtu", shown.extrusion, x[shown.nodes])

    def without_answer(self) -> None:
        """Take away pictures and meshes of a verdict that had an answer before."""
        for name in PICTURES:
            (self.path / name).unlink(missing_ok=True)
