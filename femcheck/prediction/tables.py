"""A prediction as tables: combinations, limits, paths, strains along the axis, summary."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.storage.writing import csv_text, json_text
from femcheck.continuation.ended import Ended
from femcheck.material.catalogue import constants_of
from femcheck.material.isotropic import Isotropic
from femcheck.material.law import Law
from femcheck.prediction.prediction import Prediction, compare_csv, ratios_of, stretch_cells
from femcheck.prediction.ray_trace import TRACK
from femcheck.prediction.two_meshes import AGREE, GROWTH, MARGIN, Agreement, RayEnds
from femcheck.prediction.verdict import advice, verdict
from femcheck.solved.cells import DIGITS, both, cells, plain
from femcheck.solved.summaries import (
    largest,
    rounded,
    section_summary,
    size_summary,
    timing_rows,
    work_summary,
)

__all__ = ["tables_of"]

LIMITS = (
    "mesh,d1,d2,d3,status,ended,ends_at_kpa,stable_up_to_kpa,volume_ratio_1,volume_ratio_2,"
    "volume_ratio_3,largest_stretch,stretch_at_x,stretch_at_y,stretch_at_z,mode_at_x,mode_at_y,"
    "mode_at_z,mode_share,points,steps,iterations,"
    "on_the_other_mesh_kpa,ratio,meshes"
)
AXIS = (
    "d1,d2,d3,load_kpa,z,extension,curvature_x,curvature_y,"
    "beam_extension,beam_curvature_x,beam_curvature_y"
)


def tables_of(found: Prediction) -> dict[str, str | None]:
    """All files that are text; None where there is nothing to say."""
    files: dict[str, str | None] = {"summary.json": json_text(_summary(found))}
    files["compare.csv"] = compare_csv(found) if found.has_answers else None
    tables = {
        "limits.csv": (LIMITS, _limits),
        "paths.csv": ("mesh,d1,d2,d3," + ",".join(TRACK), _paths),
        "axis.csv": (AXIS, _axis),
    }
    for name, (header, rows) in tables.items():
        files[name] = csv_text(header, rows(found)) if found.has_answers else None
    files["timing.csv"] = csv_text("what,value,unit", _timing(found))
    return files


def _limits(found: Prediction) -> Iterator[tuple[object, ...]]:
    for (mesh, number), result in sorted(found.results.items(), key=lambda item: item[0][::-1]):
        last = result.last
        yield (
            mesh,
            *map(plain, found.rays[number].direction),
            *both(result.status),
            *cells([result.critical, math.nan if last is None else last.load]),
            *cells(ratios_of(found, mesh, last)),
            *stretch_cells(last),
            *cells([*result.mode_at, result.mode_share]),
            len(result.track),
            result.statistics.steps,
            result.statistics.iterations,
            *_other_mesh(found, mesh, number),
        )


def _other_mesh(found: Prediction, mesh: str, number: int) -> list[object]:
    """Up to where the ray is stable on the other mesh, the ratio, and whether the meshes agree."""
    ends = found.ends(number)
    standard, coarse = ends.loads
    other = coarse if mesh == "standard" else standard
    return [*_finite([other, ends.ratio]), ends.agreement.name]


def _finite(values: Sequence[float]) -> list[object]:
    return cells([value if math.isfinite(value) else math.nan for value in values])


def _paths(found: Prediction) -> Iterator[tuple[object, ...]]:
    for (mesh, number), result in sorted(found.results.items(), key=lambda item: item[0][::-1]):
        for row in result.track.tolist():
            unstable = None if row[-1] < 0 else int(row[-1])
            yield mesh, *map(plain, found.rays[number].direction), *cells(row[:-1]), unstable


def _axis(found: Prediction) -> Iterator[tuple[object, ...]]:
    """Strains of the last stable equilibrium of every ray, beside the beam's."""
    for number, ray in enumerate(found.rays):
        last = found.result(number).last
        if last is None:
            continue
        pressures = last.load * np.array(ray.direction)
        beam = _strain_cells(found.subject.response.strains(pressures[None])[0])
        for z, *strains in last.axis.tolist():
            head = (*map(plain, ray.direction), *cells([last.load, z]))
            yield *head, *_strain_cells(np.array(strains)), *beam


def _strain_cells(strains: FloatArray) -> list[object]:
    """Rounded further than millimetres: curvatures [1/mm] are small numbers."""
    return [round(float(value), 3 + DIGITS) + 0.0 for value in strains]


def _summary(found: Prediction) -> dict[str, Any]:
    """The prediction without times."""
    options = found.options
    data: dict[str, Any] = {
        "design": found.subject.name,
        "verdict": {
            "kind": "prediction",
            "law": options.law,
            "holds": found.holds,
            "certain": found.certain,
            "text": verdict(found),
            "advice": advice(found),
            "agree": options.agree,
        },
        "material": {
            "energy": found.law.text,
            "constants": [
                {"name": one.name, "value": one.value, "unit": one.unit, "source": one.source}
                for one in constants_of(found.law)
            ],
            "winding": options.question["wound"],
            "rises_up_to_stretch": _rises(found.law),
        },
        "actuator": {
            "length_mm": found.subject.design.actuator.length,
            "slenderness": round(found.subject.slenderness, DIGITS),
        },
    } | section_summary(found.subject)
    if found.has_answers:
        data["stable_box_kpa"] = round(found.stable_box, DIGITS)
        data["safe_box"] = _safe_box(found)
        data["meshes"] = {
            "agree_up_to_ratio": AGREE,
            "rays": len(found.rays),
            "rays_on_both": sum(key[0] == "coarse" for key in found.results),
            "largest_ratio": largest(np.array([one.ratio for one in found.compared])),
        }
        data["limits"] = [_limit(found, one) for one in found.compared]
        data["growth_at_the_end"] = {
            found.rays[number].text: rounded(found.growth(number)) for number in _principal(found)
        }
        data["difference"] = {
            "cases": int(found.is_loaded.sum()),
            "without_answer": found.unanswered,
            "worst_of_displacement": rounded(found.worst),
            "median_of_displacement": rounded(found.median),
            "worst_between_meshes_mm": largest(found.discretisation),
            "worst_between_meshes_of_displacement": rounded(found.mesh_share),
        }
        data["solids"] = [_solid(found, mesh) for mesh in found.solids]
    return data


def _rises(law: Law) -> dict[str, float | None]:
    """Up to which stretch the law's responses rise; null where they always do."""
    if not isinstance(law, Isotropic):
        return {}
    ends = law.stretch_range._asdict()
    return {name: None if math.isinf(end) else round(end, DIGITS) for name, end in ends.items()}


def _principal(found: Prediction) -> list[int]:
    return [number for number, ray in enumerate(found.rays) if ray.is_principal]


def _safe_box(found: Prediction) -> dict[str, Any]:
    """What may be advised, and what limits it."""
    box = found.safe_box
    mesh, number = (None, None) if box.key is None else box.key
    return {
        "kpa": rounded(box.pressure),
        "margin": MARGIN,
        "largest_growth": GROWTH,
        "limited_by": box.why.name,
        "of": None if number is None else found.rays[number].text,
        "mesh": mesh,
        "there_kpa": rounded(box.at),
    }


def _limit(found: Prediction, ends: RayEnds) -> dict[str, Any]:
    """The end of a ray, with both meshes' figures."""
    ray, result, coarse = ends.ray, ends.standard, ends.coarse
    last = result.last
    ratios = ratios_of(found, "standard", last)
    return {
        "of": ray.text,
        "status": result.status.value,
        "ended": Ended(result.status).key,
        "ends_at_kpa": rounded(result.critical),
        "status_on_the_coarse_mesh": None if coarse is None else coarse.status.value,
        "ended_on_the_coarse_mesh": None if coarse is None else Ended(coarse.status).key,
        "on_the_coarse_mesh_kpa": None if coarse is None else rounded(coarse.critical),
        "ratio": rounded(ends.ratio),
        "ratio_is_a_lower_bound": ends.is_bound,
        "certain": ends.agreement is Agreement.AGREE,
        "volume_ratios": [rounded(value) for value in ratios.tolist()],
        "largest_stretch": None if last is None else rounded(last.stretch),
        "largest_stretch_at_mm": None
        if last is None
        else [round(value, 3) for value in last.stretch_at.tolist()],
    }


def _solid(found: Prediction, mesh: str) -> dict[str, Any]:
    solid = found.solids[mesh]
    results = [result for key, result in found.results.items() if key[0] == mesh]
    return {
        "mesh": mesh,
        "element": solid.element,
        "form": "displacements" if found.law.volumetric_compliance is None else "mixed",
        **size_summary(solid),
        "rays": len(results),
        **work_summary([result.statistics for result in results]),
        "stability": "checked by inertia" if found.is_checked else "not checked",
    }


def _timing(found: Prediction) -> Iterator[tuple[str, float, str]]:
    """Processor time of the rays, summed over processes."""
    for mesh in found.solids:
        spent = [result.statistics for key, result in found.results.items() if key[0] == mesh]
        yield from timing_rows(mesh, spent)
