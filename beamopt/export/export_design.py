"""A design into a folder of files that other programs take."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

from beamopt.base.errors import InputError
from beamopt.base.provenance import provenance
from beamopt.export.bodies import BASE_THICKNESS, ExtrudedFace, body_solids, mould_solids
from beamopt.export.drawing import Drawing, section_drawing
from beamopt.export.dxf import dxf_bytes
from beamopt.export.faces import section_faces
from beamopt.export.record import SCHEMA, export_record, notes_on
from beamopt.export.step import NEEDS, is_installed, require, step_text
from beamopt.export.stl import stl_bytes
from beamopt.export.svg import svg_text
from beamopt.outline.build import build_outline
from beamopt.outline.ring import usual_sagitta
from beamopt.scene.design import Design
from beamopt.storage.input_file import read_json
from beamopt.storage.result_folder import FolderKind, check_same, claimed
from beamopt.storage.writing import json_text, write_atomic

__all__ = ["FORMATS", "ExportOptions", "Exported", "export_design"]

FORMATS = ("step", "stl", "svg", "dxf")
THICKEST, COARSEST = 1000.0, 1.0  # mm
MARKER = "export.json"
FILES = {
    "body.step": "step",
    "mould.step": "step",
    "body.stl": "stl",
    "cores.stl": "stl",
    "section.svg": "svg",
    "section.dxf": "dxf",
}
"""Every file that an export may write, and its format."""

OWN = ("provenance.json", *FILES)
KIND = FolderKind("an export", MARKER, ('{"schema":"beamopt-export/',), files=OWN)
PACKAGES = ("shapely", "gmsh", "ezdxf")


@dataclass(frozen=True, slots=True)
class ExportOptions:
    """What to export, and how.

    formats : any of "step", "stl", "svg", "dxf"; None for all that installed packages can write.
    cap : thickness of a closed plate at each end of the body [mm]; 0 leaves chambers open there.
    tolerance : how far edges may be from the smooth section [mm]; None takes the design's own
        outline, whose area and moments are the beam's.
    base_thickness : of the plate that the mould's cores stand on [mm].

    Raises
    ------
    InputError : no such format, or a thickness or tolerance that can not be.
    """

    formats: tuple[str, ...] | None = None
    cap: float = 0.0
    tolerance: float | None = None
    base_thickness: float = BASE_THICKNESS

    def __post_init__(self) -> None:
        formats = FORMATS if self.formats is None else self.formats
        unknown = [name for name in formats if name not in FORMATS]
        if unknown or not formats:
            said = ", ".join(unknown) or "nothing"
            raise InputError("--format", "", said, f"any of {','.join(FORMATS)}")
        if not (math.isfinite(self.cap) and 0 <= self.cap <= THICKEST):
            raise InputError("--cap", "", f"{self.cap:g}", f"0 … {THICKEST:g} mm")
        if self.tolerance is not None and not 1e-4 <= self.tolerance <= COARSEST:
            allowed = f"0.0001 … {COARSEST:g} mm"
            raise InputError("--tolerance", "", f"{self.tolerance:g}", allowed)
        if not (math.isfinite(self.base_thickness) and 0 < self.base_thickness <= THICKEST):
            said = f"above 0, at most {THICKEST:g} mm"
            raise InputError("base_thickness", "", f"{self.base_thickness:g}", said)


@dataclass(frozen=True, slots=True)
class Exported:
    """What was written.

    files : name in the folder, and its size in bytes.
    notes : what a person should know before making it, one line each.
    """

    folder: Path
    files: tuple[tuple[str, int], ...]
    notes: tuple[str, ...]


def export_design(
    design: Design, name: str, folder: Path, options: ExportOptions | None = None
) -> Exported:
    """Write a design's solids and drawing into a folder, its own or an empty one.

    All is computed before the first file is written, each whole or not at all; the same design
    gives the same bytes with the same versions of gmsh and ezdxf. Files of an earlier export of
    this name that were not asked for now are removed.

    Raises
    ------
    InputError : a package is missing for a format that was named, the section's polygons are
        invalid, caps were asked for where chambers are open, or the folder holds what is not an
        export of this name.
    """
    options = options or ExportOptions()
    formats, left_out = _formats(options)
    with claimed(folder, KIND, resume=True):
        _check_owner(folder, name)
        exported = _exported(design, name, folder, options, formats)
    return replace(exported, notes=(*left_out, *exported.notes))


def _exported(
    design: Design, name: str, folder: Path, options: ExportOptions, formats: tuple[str, ...]
) -> Exported:
    """Compute everything, then write it."""
    grid, length = design.grid.build(), design.actuator.length
    sagitta, outline = usual_sagitta(grid), design.outline
    if options.tolerance is not None:
        sagitta = options.tolerance
        outline = build_outline(grid, design.source, design.seal.rules, sagitta)
    findings = design.findings_on(outline)
    faces = section_faces(outline, grid, sagitta)
    body = body_solids(faces, length, options.cap)
    mould = mould_solids(faces, grid, length, sagitta, options.base_thickness)
    drawing = section_drawing(design, faces, name, sagitta, options.cap)
    strict = options.formats is not None
    files, failed = _contents(drawing, body, mould, formats, all_or_none=strict)
    record = export_record(
        name,
        design,
        drawing,
        {"body": body, "mould": mould},
        files,
        sagitta=sagitta,
        cap=options.cap,
        faults=findings,
    )
    _write(folder, files, json_text(record))
    sizes = tuple((file, len(content)) for file, content in files.items())
    return Exported(folder, sizes, (*failed, *notes_on(design, drawing, sagitta, findings)))


def _formats(options: ExportOptions) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The formats to write, and a line on each that needs a package which is not installed."""
    if options.formats is not None:
        for form in [form for form in NEEDS if form in options.formats]:
            require(form)
        return options.formats, ()
    missing = {form: said for form, (name, said) in NEEDS.items() if not is_installed(name)}
    left_out = tuple(f"{form} is left out: {said}" for form, said in missing.items())
    return tuple(form for form in FORMATS if form not in missing), left_out


def _check_owner(folder: Path, name: str) -> None:
    """Refuse a folder with the export of another name, or another version's."""
    there = folder / MARKER
    if not there.exists():
        return
    kept = read_json(there)
    if kept.get("schema") != SCHEMA:
        raise InputError(there, "schema", kept.get("schema"), f"this version writes {SCHEMA}")
    check_same(there, {"design": kept.get("design")}, {"design": name}, "export")


def _contents(
    drawing: Drawing,
    body: tuple[ExtrudedFace, ...],
    mould: tuple[ExtrudedFace, ...],
    formats: tuple[str, ...],
    *,
    all_or_none: bool,
) -> tuple[dict[str, bytes], tuple[str, ...]]:
    """The files by name, and a line on each format whose package does not load or fails.

    Raises
    ------
    InputError : a format failed, and `all_or_none` is set.
    """
    title = drawing.title
    makers = {
        "body.step": lambda: step_text(body, f"{title} body").encode("latin-1"),
        "mould.step": lambda: step_text(mould, f"{title} mould").encode("latin-1"),
        "body.stl": lambda: stl_bytes(body),
        "cores.stl": lambda: stl_bytes(mould),
        "section.svg": lambda: svg_text(drawing).encode(),
        "section.dxf": lambda: dxf_bytes(drawing),
    }
    files: dict[str, bytes] = {}
    failed: dict[str, str] = {}
    for file, form in FILES.items():
        if form not in formats or form in failed:
            continue
        try:
            files[file] = makers[file]()
        except InputError as error:
            if all_or_none:
                raise
            failed[form] = f"{form} is left out: {error}"
    made = {file: text for file, text in files.items() if FILES[file] not in failed}
    return made, tuple(failed.values())


def _write(folder: Path, files: dict[str, bytes], record: str) -> None:
    """The record first: it tells the folder's owner, should the rest be interrupted."""
    write_atomic(folder / MARKER, record)
    for file, content in files.items():
        write_atomic(folder / file, content)
    for file in FILES:
        if file not in files:
            (folder / file).unlink(missing_ok=True)
    write_atomic(folder / "provenance.json", json_text(provenance(PACKAGES)))
