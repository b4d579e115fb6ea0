"""What an export says about itself: volumes, areas, files, and what is wrong with the section."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from beamopt.export.bodies import ExtrudedFace
from beamopt.export.drawing import Drawing, is_thinner
from beamopt.export.faces import SectionFaces
from beamopt.outline.faults import Fault, summaries
from beamopt.scene.design import Design
from beamopt.section.feature_points import SUPPLIES

__all__ = ["SCHEMA", "export_record", "notes_on"]

SCHEMA = "beamopt-export/1"


def export_record(
    name: str,
    design: Design,
    drawing: Drawing,
    solids: Mapping[str, Sequence[ExtrudedFace]],
    files: Mapping[str, bytes],
    *,
    sagitta: float,
    cap: float,
    faults: Sequence[Fault],
) -> dict[str, object]:
    """The content of export.json.

    Areas and volumes are those of STEP and of the drawings, with true circles; what STL holds, and
    the beam's section, is within straight edges and stands beside them.
    """
    faces = drawing.faces
    return {
        "schema": SCHEMA,
        "design": name,
        "length_mm": design.actuator.length,
        "cap_mm": cap,
        "sagitta_mm": sagitta,
        "least_skin_mm": drawing.least_skin,
        "least_wall_mm": drawing.least_wall,
        "asked_skin_mm": design.seal.skin,
        "asked_wall_mm": design.seal.wall,
        "area_mm2": _areas(faces),
        "solids": [
            {"assembly": assembly} | _measures(solid)
            for assembly, parts in solids.items()
            for solid in parts
        ],
        "files": [{"name": file, "bytes": len(content)} for file, content in files.items()],
        "notes": list(notes_on(design, drawing, sagitta, faults)),
        "faults": [str(fault) for fault in faults],
    }


def notes_on(
    design: Design, drawing: Drawing, sagitta: float, faults: Iterable[Fault]
) -> tuple[str, ...]:
    """What a person should know before making it: what the files leave out, what is wrong."""
    notes = []
    if design.rod.segments:
        count = len(design.rod.segments)
        notes.append(f"one of {count} segments' sections, extruded over the whole length")
    if any(design.rod.rest_curvature):
        notes.append("its mould is curved (rod.rest_curvature); the files hold it straight")
    if not design.seal.rules.sealed:
        notes.append("not sealed: chambers may be open or have no wall, walls are not measured")
    return (*notes, *_thinner(design, drawing, sagitta), *summaries(faults))


def _thinner(design: Design, drawing: Drawing, sagitta: float) -> Iterator[str]:
    """One line where straight edges leave less of a skin or a wall than was asked for."""
    named = (
        ("skin", drawing.least_skin, design.seal.skin),
        ("wall between chambers", drawing.least_wall, design.seal.wall),
    )
    thin = [
        f"least {name} {least:.3f} mm, asked {asked:g}"
        for name, least, asked in named
        if is_thinner(least, asked)
    ]
    if thin:
        yield f"{'; '.join(thin)}: straight edges are up to {sagitta:g} mm off the smooth section"


def _areas(faces: SectionFaces) -> dict[str, object]:
    return {
        "material": sum(face.area for face in faces.pieces),
        "material_straight_edges": sum(face.polygon_area for face in faces.pieces),
        "supplies": [faces.chamber_area(supply) for supply in SUPPLIES],
    }


def _measures(solid: ExtrudedFace) -> dict[str, object]:
    return {
        "name": solid.name,
        "low_mm": solid.low,
        "high_mm": solid.high,
        "volume_ml": solid.volume / 1000,
        "volume_straight_edges_ml": solid.polygon_volume / 1000,
    }
