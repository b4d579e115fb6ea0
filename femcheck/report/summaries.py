"""Keys of `summary.json` and `provenance.json` that a page shows; all others are ignored."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

from pydantic import AliasPath, BaseModel, ConfigDict, Field

from beamopt.storage.checked_keys import Number, parse
from beamopt.storage.input_file import read_json

__all__ = [
    "AccuracySummary",
    "ConstantKeys",
    "ProvenanceKeys",
    "SearchSummary",
    "SolidKeys",
    "SolidSummary",
    "read_keys",
]

Flag = Annotated[bool, Field(strict=True)]
Keys = TypeVar("Keys", bound=BaseModel)


def _at(path: str, default: Any = ...) -> Any:
    """A key below others, as "verdict.kind"; it must be there without a default."""
    return Field(default, validation_alias=AliasPath(*path.split(".")))


class ConstantKeys(BaseModel):
    """A law's constant."""

    name: str
    value: Number
    unit: str
    source: str


class SolidKeys(BaseModel):
    """Size of a solid. c : its penalty."""

    mesh: str
    element: str
    triangles: Number
    layers: Number
    unknowns: Number
    stability: str
    c: Number | None = None
    form: str | None = None


class SolidSummary(BaseModel):
    """A check or a prediction; `solids` is None where nothing was meshed."""

    design: str
    kind: Literal["implementation", "prediction"] = _at("verdict.kind")
    law: str = _at("verdict.law")
    text: str = _at("verdict.text")
    holds: Flag = _at("verdict.holds")
    certain: Flag = _at("verdict.certain", True)
    agree: Number = _at("verdict.agree")
    advice: str | None = _at("verdict.advice", None)
    faults: list[Any] = _at("section.faults")
    chambers: list[Any] = _at("section.chambers")
    islands: Number = _at("section.islands")
    mesh_notes: list[Any] = _at("mesh.notes", [])
    thinnest_wall: Number | None = _at("mesh.thinnest_wall_mm", None)
    sealing_median: Number | None = _at("sealing_moved_mm.median", None)
    sealing_worst: Number | None = _at("sealing_moved_mm.worst", None)
    worst: Number | None = _at("difference.worst_of_displacement", None)
    median: Number | None = _at("difference.median_of_displacement", None)
    left: Number | None = _at("difference.worst_left_of_displacement", None)
    stable_box: Number | None = _at("stable_box_kpa", None)
    safe_box: Number | None = _at("safe_box.kpa", None)
    meshes: dict[str, Any] | None = None
    largest_ratio: Number | None = _at("meshes.largest_ratio", None)
    energy: str | None = _at("material.energy", None)
    constants: list[ConstantKeys] = _at("material.constants", [])
    winding: Any = _at("material.winding", None)
    solids: list[SolidKeys] | None = None


class AccuracySummary(BaseModel):
    """An answer to an accuracy."""

    design: str
    law: str
    ending: str
    chosen: str
    reason: str
    reached: Flag
    accuracy_mm: Number
    worst_estimate_mm: Number | None = None
    estimate_is: str | None = None
    compared_with: list[Any] = []


class SearchSummary(BaseModel):
    """A search; losses are None where no section could be judged, or none is sealed."""

    status: str
    scene: str
    seed: Number
    best_status: str = _at("best.status")
    L: Number | None = _at("best.L", None)
    K: Number | None = _at("best.K", None)
    rms_distance: Number | None = _at("best.rms_distance", None)
    outline_loss: Number | None = _at("outline.L", None)
    outline_rms_distance: Number | None = _at("outline.rms_distance", None)
    warnings: list[Any] = []
    evaluations: Number | None = None


class ProvenanceKeys(BaseModel):
    """What made a folder's results; other keys are shown as they are."""

    model_config = ConfigDict(extra="allow")

    versions: dict[str, Any]
    machine: dict[str, Any]
    threads: dict[str, Any]
    verdict: str = ""


def read_keys(model: type[Keys], path: Path) -> Keys:
    """Read the keys of a JSON file that a page shows.

    Raises
    ------
    InputError : missing, cut off, or a key that is missing or of another kind.
    """
    return parse(model, read_json(path), path)
