"""The files of a bound: numbers, the ideal tips, figures."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError
from beamopt.base.provenance import provenance
from beamopt.bound.certificate import Certificate
from beamopt.bound.rays import RayBound
from beamopt.bound.response import ResponseBound
from beamopt.bound.ring_bound import RingBound
from beamopt.bound.wanted import Wanted
from beamopt.scene.scene import Scene
from beamopt.storage.input_file import read_json
from beamopt.storage.result_folder import FolderKind, claimed
from beamopt.storage.writing import csv_text, json_text, write_atomic
from beamopt.target.target import Target

__all__ = ["bound_numbers", "bound_summary", "claimed_for_bound", "write_bound"]

MARKER = "bound.json"
OF_RESPONSE = ("ideal.csv", "bound.svg", "bound.png")
FILES = (*OF_RESPONSE, "timing.csv", "provenance.json")
SCHEMA = "beamopt-bound/1"
# those of earlier versions had no schema
KIND = FolderKind("a bound", MARKER, ('{"schema":"beamopt-bound/', '{"scene":"'), files=FILES)
HEADER = "p1,p2,p3,x,y,z,target_x,target_y,target_z,weight,distance_mm"


@contextmanager
def claimed_for_bound(folder: Path, scene: Scene) -> Iterator[None]:
    """Take an empty folder, or that of an earlier bound of a scene of this name; hold it meanwhile.

    Raises
    ------
    InputError : it holds anything else, or see `claimed`.
    """
    with claimed(folder, KIND, resume=True):
        there = folder / MARKER
        kept = read_json(there).get("scene") if there.exists() else scene.name
        if kept != scene.name:
            said = f"is what is there; now asked for: {scene.name}; name another folder"
            raise InputError(there, "scene", kept, said)
        yield


def write_bound(
    folder: Path,
    scene: Scene,
    target: Target,
    found: Certificate,
    assumed: Mapping[str, Any] | None = None,
) -> None:
    """Write what was found to a folder that is taken; each file whole or not at all.

    assumed : what the question did not say, by the names under which `bound.json` has it.

    Without a bound there are only `bound.json`, which says why, and the provenance; what an earlier
    one left is removed.
    """
    wanted, response = found.wanted, found.response
    if wanted is None or response is None:
        for name in OF_RESPONSE:
            (folder / name).unlink(missing_ok=True)
    else:
        write_atomic(folder / "ideal.csv", _ideal_csv(wanted, response))
        _draw(folder, scene, target, wanted, response)
    timing = [(part, seconds, "s") for part, seconds in found.seconds.items()]
    write_atomic(folder / "timing.csv", csv_text("what,value,unit", timing))
    write_atomic(folder / "provenance.json", json_text(provenance()))
    numbers = {"schema": SCHEMA, "scene": scene.name, **(assumed or {}), **bound_numbers(found)}
    write_atomic(folder / MARKER, json_text(numbers))


def bound_numbers(found: Certificate) -> dict[str, Any]:
    """All that was found, without times."""
    wanted, response = found.wanted, found.response
    if wanted is None or response is None:
        return {**_ended(found)}
    parts: dict[str, Any] = {"response": _response_numbers(wanted, response)}
    parts["response"] |= {
        "matrix": [row.tolist() for row in response.matrix],
        "starts_L": response.starts.tolist(),
    }
    if found.proven is not None:
        parts["proven"] = _proven(found.proven)
    if found.ring is not None:
        parts["ring"] = _ring(found.ring)
    return {**_ended(found), "rows": len(wanted.tips), **parts}


def _ended(found: Certificate) -> dict[str, str]:
    return {"status": found.status.value, "ended": found.status.name}


def bound_summary(found: Certificate, loss: float) -> dict[str, Any]:
    """What a search's summary says of the bound, and how far a loss [mm²] is above it."""
    if found.wanted is None or found.response is None:
        return {**_ended(found)}
    above = {"L_above": loss - found.response.loss} if math.isfinite(loss) else {}
    numbers = _response_numbers(found.wanted, found.response)
    return {**_ended(found), **numbers, **above}


def _response_numbers(wanted: Wanted, response: ResponseBound) -> dict[str, Any]:
    """The response bound: L [mm²], distances [mm], and how sure it is."""
    worst = int(response.distances.argmax())
    return {
        "L": response.loss,
        "kind": "numerical",
        "rms_distance": response.rms_distance(wanted),
        "worst_distance": float(response.distances[worst]),
        "worst_pressures": wanted.pressures[worst].tolist(),
        "starts": len(response.starts),
        "agreeing": response.agreeing,
    }


def _proven(proven: RayBound) -> dict[str, Any]:
    rays: FloatArray = np.array([(*ray.direction, ray.rows, ray.lower) for ray in proven.rays])
    return {
        "L": proven.loss,
        "kind": "proven",
        "box": {"stretch": list(proven.box.stretch), "turn": proven.box.turn},
        "priced": proven.priced,
        "exact_rays_at_most": proven.upper,
        "unmoved": proven.unmoved,
        "rays": rays.tolist(),
    }


def _ring(ring: RingBound) -> dict[str, Any]:
    return {
        "L": ring.outer,
        "kind": "numerical",
        "attained": ring.inner,
        "realisable": ring.realisable,
        "agrees": ring.agrees,
        "matrix": [row.tolist() for row in ring.matrix],
        "rounds": ring.rounds,
        "elements": list(ring.elements),
    }


def _ideal_csv(wanted: Wanted, response: ResponseBound) -> str:
    columns = wanted.pressures, response.tips, wanted.tips, wanted.weights, response.distances
    return csv_text(HEADER, np.column_stack(columns).tolist())


def _draw(
    folder: Path, scene: Scene, target: Target, wanted: Wanted, response: ResponseBound
) -> None:
    from beamopt.plot.bound import bound_figure
    from beamopt.plot.style import save_figure

    title = f"{scene.name}: no response found with L below {response.loss:.4g} mm² (numerical)"
    levels = None if target.workspace is None else target.workspace.levels
    figure = bound_figure(wanted.pressures, response.tips, wanted.tips, levels, title)
    save_figure(figure, folder / "bound.svg", folder / "bound.png")
