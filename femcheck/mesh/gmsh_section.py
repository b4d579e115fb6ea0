"""A section meshed by gmsh in a process of its own: it may hang or crash, and a batch goes on."""

from __future__ import annotations

import contextlib
import io
import os
import shutil
import signal
import subprocess
import sys
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.base.brief import Brief, changed_fields
from beamopt.outline.outline import Outline
from beamopt.storage.scratch import scratch_folder
from beamopt.storage.writing import naming
from femcheck.mesh.geo import SectionSizes, geo_script, least_triangles
from femcheck.mesh.section_mesh import SectionMesh

__all__ = ["MeshFailure", "MeshProblem", "Mesher", "read_section"]

MOST_TRIANGLES = 2_000_000  # gmsh takes a kilobyte for each, a solid thousands


class MeshProblem(Enum):
    """Why there is no mesh; the value is the text shown to people.

    Examples
    --------
    >>> import femcheck
    >>> femcheck.MeshProblem.NO_GMSH.value
    'gmsh is not installed'
    """

    NO_GMSH = "gmsh is not installed"
    CRASHED = "gmsh crashed"
    HUNG = "gmsh did not end within its time limit"
    NO_MESH = "gmsh wrote no mesh that can be read"
    WRONG = "gmsh's mesh is not that of the outline"
    FATAL = "no solid can be made of the outline"
    INVERTED = "a mesh element is inside out or flat"
    TOO_FINE = "the mesh would take more memory than there is"

    @property
    def is_interrupted(self) -> bool:
        """True if a clock ended gmsh: with more time there may be a mesh."""
        return self is MeshProblem.HUNG

    @property
    def is_settled(self) -> bool:
        """False: no mesh says nothing of the actuator."""
        return False


@dataclass(frozen=True, slots=True)
class MeshFailure:
    """No mesh, and why.

    Examples
    --------
    >>> import femcheck
    >>> import beamopt
    >>> drawn = beamopt.load_design(str(beamopt.load_scene("gravity").target.file))
    >>> subject = femcheck.sealed_copy("round", drawn, 1.0)
    >>> found = femcheck.Mesher("no-such-gmsh").mesh(subject.outline, femcheck.SectionSizes())
    >>> isinstance(found, femcheck.MeshFailure) and found.problem.name
    'NO_GMSH'
    """

    problem: MeshProblem
    detail: str = ""

    def __repr__(self) -> str:
        return f"<MeshFailure {self.problem.name}: {Brief(self.detail)}>"

    def __str__(self) -> str:
        return f"{self.problem.value}: {self.detail}" if self.detail else self.problem.value


@dataclass(frozen=True, slots=True)
class Mesher:
    """How gmsh is called.

    command : the executable; None takes the first on the path, then the one beside python.
    seconds : of a clock, after which gmsh is taken to hang; a mesh takes one or two [s].

    Examples
    --------
    >>> import femcheck
    >>> femcheck.Mesher(seconds=60.0)
    Mesher(seconds=60.0)
    """

    command: str | None = None
    seconds: float = 600.0

    __repr__ = changed_fields

    def mesh(self, outline: Outline, sizes: SectionSizes) -> SectionMesh | MeshFailure:
        """Triangulate a section, or say why that failed."""
        if not outline.buildable:
            return MeshFailure(MeshProblem.FATAL, str(outline.faults[0]))
        least = least_triangles(outline, sizes)
        if least > MOST_TRIANGLES:
            said = f"at least {least:,} triangles, at most {MOST_TRIANGLES:,} are made"
            return MeshFailure(MeshProblem.TOO_FINE, f"{said}: thin walls, or a larger size")
        command = _find(self.command)
        if command is None:
            return MeshFailure(MeshProblem.NO_GMSH, self.command or "pip install gmsh")
        with scratch_folder() as folder:
            script, written = folder / "section.geo", folder / "section.msh"
            with naming(script):
                script.write_text(geo_script(outline, sizes), encoding="utf-8")
            arguments = [*command, "-2", "-v", "1", "-format", "msh41"]
            failure = _run([*arguments, "-o", str(written), str(script)], self.seconds)
            if failure is not None:
                return failure
            return _read(written, outline)


def _find(command: str | None) -> list[str] | None:
    """The executable as it was asked for; else a "gmsh" on the path, else the one beside python."""
    if command is not None:
        found = shutil.which(command)
        return [found] if found else None
    found = shutil.which("gmsh")
    if found is not None:
        return [found]
    beside = Path(sys.executable).with_name("gmsh")
    return [sys.executable, str(beside)] if beside.exists() else None


def _run(arguments: list[str], seconds: float) -> MeshFailure | None:
    """Run to the end, or kill it with everything that it started."""
    try:
        process = subprocess.Popen(
            arguments,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            start_new_session=True,
        )
    except OSError as error:
        return MeshFailure(MeshProblem.CRASHED, (error.strerror or str(error)).lower())
    try:
        said, _ = process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        _kill(process)
        return MeshFailure(MeshProblem.HUNG, f"{seconds:g} s")
    except BaseException:
        _kill(process)
        raise
    if process.returncode != 0:
        last = said.strip().splitlines()[-1:] or [""]
        code = process.returncode
        how = f"signal {-code}" if code < 0 else f"exit code {code}"
        with contextlib.suppress(ValueError):  # real-time signals have no name
            how = signal.Signals(-code).name if code < 0 else how
        return MeshFailure(MeshProblem.CRASHED, f"{how} {last[0]}".strip())
    return None


def _kill(process: subprocess.Popen[str]) -> None:
    if hasattr(os, "killpg"):
        with contextlib.suppress(ProcessLookupError):  # it has just ended by itself
            os.killpg(process.pid, signal.SIGKILL)
    else:
        process.kill()
    with contextlib.suppress(subprocess.TimeoutExpired):  # a child of its own may hold the pipe
        process.communicate(timeout=2.0)


def _read(file: Path, outline: Outline) -> SectionMesh | MeshFailure:
    """The mesh in a file, checked against the outline that it is of."""
    section = read_section(file)
    if isinstance(section, MeshFailure):
        return section
    wanted, area = outline.moments.area, section.areas.sum()
    if abs(area - wanted) > 1e-6 * wanted or not np.allclose(
        section.moments.raw, outline.moments.raw, rtol=1e-6, atol=1e-6 * float(wanted)
    ):
        return MeshFailure(MeshProblem.WRONG, f"area {area:.3f} mm², outline {wanted:.3f} mm²")
    thinnest = int(np.argmin(section.areas))
    if section.areas[thinnest] <= 0:
        x, y = section.points[section.triangles[thinnest]].mean(axis=0)
        return MeshFailure(MeshProblem.INVERTED, f"triangle at ({x:.2f}, {y:.2f}) mm")
    return section


def read_section(file: Path) -> SectionMesh | MeshFailure:
    """The mesh in a gmsh file, whatever it is of; its physical groups as in `geo_script`."""
    import meshio

    try:
        with contextlib.redirect_stdout(io.StringIO()):  # meshio prints empty lines
            mesh = meshio.gmsh.read(file)  # `meshio.read` ends the process
        triangles = mesh.get_cells_type("triangle").astype(np.int64)
        edges = mesh.get_cells_type("line").astype(np.int64)
        supply = mesh.get_cell_data("gmsh:physical", "line").astype(np.int64) - 1
        points = mesh.points[:, :2].astype(np.float64)
    except Exception as error:  # what meshio's reader raises at a damaged file has no end
        said = " ".join(str(error).split())
        return MeshFailure(MeshProblem.NO_MESH, said or type(error).__name__)
    if not triangles.size or not edges.size:
        return MeshFailure(MeshProblem.NO_MESH, "no triangles")
    return _ordered(points, triangles, edges, supply)


def _ordered(
    points: FloatArray, triangles: IndexArray, edges: IndexArray, supply: IndexArray
) -> SectionMesh:
    """Only the points that triangles use; triangles counter-clockwise."""
    used, triangles = np.unique(triangles, return_inverse=True)
    number = np.full(len(points), -1)
    number[used] = np.arange(used.size)
    triangles = triangles.reshape(-1, 3)
    a, b, c = (points[used][triangles[:, k]] for k in range(3))
    (ux, uy), (vx, vy) = (b - a).T, (c - a).T
    clockwise = ux * vy - uy * vx < 0
    triangles[clockwise] = triangles[clockwise][:, ::-1]
    return SectionMesh(points[used], triangles, number[edges], supply)
