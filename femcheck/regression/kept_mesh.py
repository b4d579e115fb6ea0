"""Section meshes that are kept, so that what a solid says does not depend on gmsh's version."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from beamopt.base.errors import InputError
from beamopt.outline.build import build_outline
from beamopt.outline.outline import Outline
from beamopt.outline.ring import usual_sagitta
from beamopt.scene.design import Design
from beamopt.storage.input_file import MOST_MESH, check_regular, read_bytes
from beamopt.storage.writing import check_replaceable, replacing
from femcheck.mesh.geo import SectionSizes
from femcheck.mesh.gmsh_section import Mesher, MeshFailure, read_section
from femcheck.mesh.section_mesh import SectionMesh

__all__ = [
    "KeptMesher",
    "check_mesh_file",
    "is_of",
    "make_section",
    "mesh_digest",
    "read_kept",
    "write_section",
]

COARSER = 10.0  # times as far from the smooth outline as a design's own edges
SIZES = SectionSizes(factor=4.0, growth=5.0)
MATERIAL_GROUP = 10
MARK = "$Comments\ndesign "


@dataclass(frozen=True, slots=True)
class KeptMesher(Mesher):
    """Gives one mesh, whatever outline it is asked about."""

    section: SectionMesh | None = None

    def mesh(self, outline: Outline, sizes: SectionSizes) -> SectionMesh | MeshFailure:
        """The kept mesh."""
        assert self.section is not None
        return self.section


def make_section(design: Design) -> SectionMesh:
    """A small mesh of a design's section: the same rules, its curves in longer chords.

    Raises
    ------
    InputError : there is no such mesh.
    """
    grid = design.grid.build()
    sagitta = COARSER * usual_sagitta(grid)
    outline = build_outline(grid, design.source, design.seal.rules, sagitta)
    section = Mesher().mesh(outline, SIZES)
    if isinstance(section, MeshFailure):
        raise InputError("", "mesh", None, f"no mesh of the section: {section}")
    return section


def read_kept(file: Path) -> SectionMesh:
    """A kept mesh.

    Raises
    ------
    InputError : its file is missing or damaged.
    """
    _require(file)
    section = read_section(file)
    if isinstance(section, MeshFailure):
        raise InputError(file, "", None, str(section))
    return section


def is_of(file: Path, digest: str) -> bool:
    """Whether a file holds the mesh of the design of a digest; false where there is no file."""
    return file.exists() and _comment(digest).encode() in read_bytes(file, MOST_MESH)


def _comment(digest: str) -> str:
    """A section of gmsh's format that readers pass over."""
    return f"{MARK}{digest}\n$EndComments\n"


def check_mesh_file(file: Path, *, force: bool) -> None:
    """Refuse to write a mesh over a file that was not written by `write_section`.

    Raises
    ------
    InputError : it is one, and `force` is off.
    """
    check_replaceable(file, MARK, "femcheck baseline", force=force)


def write_section(file: Path, section: SectionMesh, digest: str) -> None:
    """Write a mesh as gmsh 2.2 text; a kill never leaves half of it.

    digest : of the design that it is of, for `is_of`.
    """
    import meshio

    cells = [("triangle", section.triangles), ("line", section.edges)]
    groups = [np.full(len(section.triangles), MATERIAL_GROUP), section.supply + 1]
    marked = {"gmsh:physical": groups, "gmsh:geometrical": groups}
    flat = np.column_stack([section.points, np.zeros(len(section.points))])
    mesh = meshio.Mesh(flat, cells, cell_data=marked)
    with replacing(file) as temporary:
        meshio.gmsh.write(temporary, mesh, fmt_version="2.2", binary=False)
        with temporary.open("a", encoding="utf-8", newline="\n") as stream:
            stream.write(_comment(digest))


def mesh_digest(file: Path) -> str:
    """Tells kept meshes apart.

    Raises
    ------
    InputError : the file is missing.
    """
    _require(file)
    return hashlib.blake2b(read_bytes(file, MOST_MESH), digest_size=12).hexdigest()


def _require(file: Path) -> None:
    if not file.exists():
        raise InputError(file, "", None, "missing: `femcheck baseline` writes it")
    check_regular(file, MOST_MESH)
