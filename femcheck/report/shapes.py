"""Deformed solids of a folder, and the beam's centreline at the same pressures."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.base.errors import InputError
from beamopt.rod.arc import arc_centreline
from beamopt.storage.input_file import MOST_MESH, check_regular
from beamopt.target.workspace import NODES
from femcheck.mesh.files import DISPLACEMENT, TAGS, VTU_WEDGE
from femcheck.mesh.vtu_size import check_unpacked_size
from femcheck.prediction.rays import rays_of
from femcheck.report.solid_run import Combinations, SolidRun
from femcheck.report.surface import Surface, surface_of

__all__ = ["DeformedSurface", "RunShapes", "read_shapes"]

LINE_POINTS = 33


@dataclass(frozen=True, eq=False)
class DeformedSurface:
    """One deformed surface.

    pressures : (3,) [kPa]. at : (v, 3) vertices [mm]. stretch : (v,).
    line : (k, 3) the beam's centreline at these pressures [mm].
    """

    pressures: FloatArray
    at: FloatArray
    stretch: FloatArray
    line: FloatArray


@dataclass(frozen=True, eq=False)
class RunShapes:
    """What there is to see of a run.

    shapes : the undeformed one first.
    of : (27,) place in `shapes` of each combination; −1 where there is nothing to see.
    is_last : (27,) whether that is not the combination's own shape, which does not exist, but the
        last stable one on the way there.
    """

    surface: Surface
    shapes: tuple[DeformedSurface, ...]
    of: tuple[int, ...]
    is_last: tuple[bool, ...]


def read_shapes(run: SolidRun) -> RunShapes | None:
    """Read the deformed meshes of a run; None where its folder has none.

    Raises
    ------
    InputError : a mesh that is missing beside others, or damaged.
    """
    folder = run.folder / "deformed"
    found = run.combinations
    if found is None or not folder.is_dir():
        return None
    files = _files(run, found, folder)
    if not files:
        return None
    reader = _Reader(run, next(iter(files.values()))[0])
    shapes = [reader.undeformed()]
    places: dict[Path, int] = {}
    for file, pressures in files.values():
        if file not in places:
            places[file] = len(shapes)
            shapes.append(reader.shape(file, pressures))
    of = [places[files[row][0]] if row in files else -1 for row in range(NODES)]
    of = [place if loaded else 0 for place, loaded in zip(of, found.loaded, strict=True)]
    is_last = [row in files and not answered for row, answered in enumerate(found.answered)]
    return RunShapes(reader.surface, tuple(shapes), tuple(of), tuple(is_last))


def _files(run: SolidRun, found: Combinations, folder: Path) -> dict[int, tuple[Path, FloatArray]]:
    """By row: the file of a loaded combination's shape, and the pressures of that shape."""
    files = {}
    last = _last_files(run, found, folder) if run.is_prediction else {}
    for row, pressures in enumerate(found.pressures):
        if found.answered[row] and pressures.any():
            name = "-".join(f"{value:g}" for value in pressures)
            files[row] = (folder / f"{name}.vtu", pressures)
        elif row in last:
            files[row] = last[row]
    return files


def _last_files(
    run: SolidRun, found: Combinations, folder: Path
) -> dict[int, tuple[Path, FloatArray]]:
    """The last stable shape of every combination's ray, where it was kept."""
    table = next((one for one in run.tables if one.file.name == "limits.csv"), None)
    if table is None:
        return {}
    standard = table.where("mesh", "standard")
    directions = standard.numbers("d1", "d2", "d3").tolist()
    ups = standard.numbers("stable_up_to_kpa")[:, 0].tolist()
    loads = {tuple(direction): up for direction, up in zip(directions, ups, strict=True)}
    rays, places = rays_of(found.pressures)
    files = {}
    for row, place in enumerate(places):
        if place is not None:
            ray = rays[place[0]]
            file, load = folder / f"last-{ray.name}.vtu", loads.get(ray.direction, np.nan)
            if file.exists() and np.isfinite(load):
                files[row] = (file, load * np.array(ray.direction))
    return files


class _Reader:
    """Reads shapes of one surface, which the first file and the tagged mesh give."""

    def __init__(self, run: SolidRun, first: Path) -> None:
        self.subject = run.subject
        self.rest, _, self.wedges = _deformed(first)
        tagged = run.folder / "mesh.vtu"
        try:
            self.surface = surface_of(self.rest, self.wedges, _supplies(tagged, self.rest))
        except ValueError as error:
            if isinstance(error, InputError):
                raise
            raise InputError(tagged, "tag", None, str(error)) from None

    def undeformed(self) -> DeformedSurface:
        """The surface at rest."""
        return self._shape(self.surface.rest, np.zeros(3))

    def shape(self, file: Path, pressures: FloatArray) -> DeformedSurface:
        """The surface in a file."""
        rest, moved, wedges = _deformed(file)
        same = rest.shape == self.rest.shape and np.array_equal(wedges, self.wedges)
        if not same or not np.allclose(rest, self.rest, rtol=0, atol=1e-6):
            raise InputError(file, "", None, "is of another mesh than the files beside it")
        return self._shape((rest + moved)[self.surface.nodes], pressures)

    def _shape(self, at: FloatArray, pressures: FloatArray) -> DeformedSurface:
        strains = self.subject.response.strains(pressures[None])
        stations = np.linspace(0, self.subject.design.actuator.length, LINE_POINTS)
        centroid = np.append(self.subject.outline.moments.centroid, 0.0)
        line = arc_centreline(strains, stations)[0] + centroid
        return DeformedSurface(pressures, at, self.surface.stretch(at), line)


def _deformed(file: Path) -> tuple[FloatArray, FloatArray, IndexArray]:
    """Undeformed points (n, 3), displacements (n, 3) [mm], wedges (m, 6) of a deformed mesh."""
    mesh = _mesh(file)
    wedges = [np.asarray(block.data) for block in mesh.cells if block.type == "wedge"]
    moved = mesh.point_data.get(DISPLACEMENT)
    rest = np.asarray(mesh.points, dtype=np.float64)
    if not wedges or len(wedges[0]) == 0:
        raise InputError(file, "Cells", None, "must hold wedges")
    if moved is None or np.shape(moved) != rest.shape or rest.shape[1:] != (3,):
        said = "must be given at every point; --resume writes the file again"
        raise InputError(file, DISPLACEMENT, None, said)
    if not (np.isfinite(rest).all() and np.isfinite(moved).all()):
        raise InputError(file, "Points", None, "must be finite numbers")
    if wedges[0].min() < 0 or wedges[0].max() >= len(rest):
        raise InputError(file, "connectivity", None, "names a node that is not there")
    return rest, np.asarray(moved, dtype=np.float64), wedges[0][:, VTU_WEDGE].astype(np.int64)


def _supplies(file: Path, rest: FloatArray) -> dict[tuple[int, int], int]:
    """Supply of each boundary edge of the section, by the tags of the undeformed mesh."""
    mesh = _mesh(file)
    n = int((rest[:, 2] <= rest[:, 2].min()).sum())
    if len(mesh.points) < n or not np.allclose(mesh.points[:n], rest[:n], rtol=0, atol=1e-6):
        raise InputError(file, "Points", None, "is of another section than the deformed meshes")
    tags = mesh.cell_data.get("tag")
    if tags is None:
        raise InputError(file, "tag", None, "must be given for every cell")
    found: dict[tuple[int, int], int] = {}
    first = TAGS["surface"][0]
    for block, tag in zip(mesh.cells, tags, strict=True):
        if block.type == "quad":
            edges = np.sort(np.asarray(block.data)[:, :2] % n, axis=1).tolist()
            found |= {(a, b): int(one) - first for (a, b), one in zip(edges, tag, strict=True)}
    if not set(found.values()) <= set(range(4)):
        raise InputError(file, "tag", None, "quadrangles are tagged 1…4")
    return found


def _mesh(file: Path) -> Any:
    """A mesh as meshio reads it.

    Raises
    ------
    InputError : missing, damaged or too large.
    """
    from meshio import vtu

    if not file.is_file():
        said = "is missing; make the folder again, or go on with --resume, which writes it"
        raise InputError(file, "", None, said)
    check_regular(file, MOST_MESH)
    try:
        check_unpacked_size(file, MOST_MESH)
        return vtu.read(str(file))
    except InputError:
        raise
    except Exception as error:  # a reader of damaged bytes may fall over anything
        said = f"no whole mesh: {type(error).__name__} {error}"
        raise InputError(file, "", None, said) from None
