"""`beamopt bound`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import nullcontext
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError
from beamopt.bound.certificate import BoundStatus, Certificate, certificate
from beamopt.bound.folder import claimed_for_bound, write_bound
from beamopt.bound.rays import RayBound
from beamopt.bound.response import ResponseBound
from beamopt.bound.ring_bound import RingBound
from beamopt.bound.wanted import Wanted
from beamopt.bound.work import MOST_WORK
from beamopt.cli.exit_codes import ExitCode, end_with
from beamopt.cli.findings import say_findings
from beamopt.cli.progress import console, work_progress
from beamopt.scene.design import load_design
from beamopt.scene.named import is_scene
from beamopt.scene.overrides import overridden
from beamopt.scene.scene import Pressures, Scene, load_scene
from beamopt.scene.target_keys import TargetChoice
from beamopt.scene.toml_text import scene_text
from beamopt.storage.checked_keys import parse
from beamopt.storage.input_file import parse_toml
from beamopt.storage.number_table import Table, read_table
from beamopt.target.target import ONLY_OF_POINTS, SAME_PRESSURE, Target
from beamopt.target.workspace import COLUMNS, pressure_grid

__all__ = ["bound_command", "gap_text"]

NOTHING = 1e-12  # of H²: less than this is rounding


class LengthSource(Enum):
    """Source of the length of a bare table's actuator; the value is the text for people."""

    REST = "the table's tip without pressure"
    ASKED = "--set actuator.length"
    DEFAULT = "the default: no tip without pressure says it; --set actuator.length"


def bound_command(
    subject: str, out: Path | None, work: float | None, overrides: Sequence[str]
) -> None:
    """Say how low L can be, whatever the section, and write it where asked.

    work : most tips to compute [millions].
    """
    if work is not None and not 0 < work < math.inf:
        raise InputError("--work", "", work, "a finite number of million tips above 0")
    scene, notes, assumed = _scene_of(subject, overrides)
    target = scene.load_target()
    with nullcontext() if out is None else claimed_for_bound(out, scene):
        with work_progress() as callback:
            found = certificate(scene, target, callback, MOST_WORK if work is None else 1e6 * work)
        if out is not None:
            write_bound(out, scene, target, found, assumed)
    for note in (*notes, *target.warnings):
        console.print(f"[yellow]note[/]: {note}", soft_wrap=True)
    _report(scene, target, found, out)
    end_with(ExitCode.HOLDS if found.status.is_bound else ExitCode.NOT_COMPUTED)


def _scene_of(
    subject: str, overrides: Sequence[str]
) -> tuple[Scene, tuple[str, ...], dict[str, Any]]:
    """A scene, also that of a run folder; for a table or a design one with it as the target.

    Returns it with notes on it, and what a table does not say and was assumed.
    """
    path = Path(subject)
    if path.is_dir() and not is_scene(subject):
        return load_scene(_kept_scene(path), overrides), (), {}
    kind = path.suffix.lower()
    if kind not in (".csv", ".json"):
        return load_scene(subject, overrides), (), {}
    name = "".join(c if c.isalnum() or c in "-_" else "-" for c in path.stem) or "target"
    if kind == ".csv":
        return _scene_of_table(path, name, overrides)
    design = load_design(path)
    say_findings(design)
    scene = Scene(
        name=name,
        actuator=design.actuator,
        grid=design.grid,
        seal=design.seal,
        pressures=Pressures(levels=design.pressures),
        rod=design.rod,
        loads=design.loads,
        target=TargetChoice(kind="section", file=str(path.resolve())),
    )
    return _with(scene, overrides), (), {}


def _kept_scene(folder: Path) -> Path:
    """The scene file of a run folder."""
    file = folder / "scene.toml"
    if not file.exists():
        raise InputError(folder, "", None, f"no run folder: it has no {file.name}")
    return file


def _scene_of_table(
    path: Path, name: str, overrides: Sequence[str]
) -> tuple[Scene, tuple[str, ...], dict[str, Any]]:
    """The default scene with a table as its target: of points, unless it is a workspace's."""
    table = read_table(path, COLUMNS)
    file = str(path.resolve())
    asked = {text.partition("=")[0].strip() for text in overrides}
    usual = Scene(name=name, target=TargetChoice(kind="points", file=file))
    usual, source = _with_length(usual, table, overrides)
    if "actuator.length" in asked:
        source = LengthSource.ASKED
    scene = _with(usual, overrides)
    assumed, notes = _assumed(scene, source)
    if "target.kind" in asked:
        return scene, notes, assumed
    levels = scene.pressures.levels
    columns = [column for column in ONLY_OF_POINTS if column in table.header]
    if not columns and _is_workspace(table.stacked(["p1", "p2", "p3"]), levels):
        return _with(usual, [*overrides, "target.kind=workspace"]), notes, assumed
    said = f"it has the columns {', '.join(columns)}"
    if not columns:
        listed = ", ".join(f"{level:g}" for level in levels)
        said = f"its rows are not the 27 combinations of {listed} kPa"
    return scene, (*notes, f"taken as a table of points: {said}"), assumed


def _with_length(
    usual: Scene, table: Table, overrides: Sequence[str]
) -> tuple[Scene, LengthSource]:
    """The scene with the length that the tip without pressure says, where that can be one."""
    scene = _with(usual, overrides)
    at_rest = ~table.stacked(["p1", "p2", "p3"]).any(axis=1)
    if not at_rest.any() or scene.climb.model.straight_length is None:
        return usual, LengthSource.DEFAULT
    tips = scene.target.base.to_local(table.stacked(["x", "y", "z"])[at_rest])
    length = float(tips[:, 2].mean())
    if length < scene.grid.outer_radius:  # no rod: a table in metres, say
        return usual, LengthSource.DEFAULT
    try:
        actuator = usual.actuator.model_copy(update={"length": length})
    except InputError:
        return usual, LengthSource.DEFAULT
    return usual.model_copy(update={"actuator": actuator}), LengthSource.REST


def _assumed(scene: Scene, source: LengthSource) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Assumptions on what a table does not say, for `bound.json` and for people."""
    length, grid, E = scene.actuator.length, scene.grid, scene.actuator.youngs_modulus
    numbers = {
        "length_mm": length,
        "length_from": source.name.lower(),
        "youngs_modulus_kPa": E,
        "inner_radius_mm": grid.inner_radius,
        "outer_radius_mm": grid.outer_radius,
    }
    ring = f"a ring of radii {grid.inner_radius:g} … {grid.outer_radius:g} mm, E = {E:g} kPa"
    return {"assumed": numbers}, (f"length {length:g} mm ({source.value})", f"assumed: {ring}")


def _is_workspace(pressures: FloatArray, levels: Sequence[float]) -> bool:
    """Whether pressures (n, 3) are the 27 combinations, in any order."""
    nodes = pressure_grid(levels)
    if len(pressures) != len(nodes):
        return False
    away = np.abs(pressures[:, None] - nodes).max(axis=2)
    return bool((away.min(axis=0) < SAME_PRESSURE).all())


def _with(scene: Scene, overrides: Sequence[str]) -> Scene:
    """A scene with keys replaced."""
    if not overrides:
        return scene
    data = overridden(parse_toml(scene_text(scene), "--set"), overrides)
    return parse(Scene, data, "--set")


def _report(scene: Scene, target: Target, found: Certificate, out: Path | None) -> None:
    lines: list[tuple[str, str]]
    wanted, response = found.wanted, found.response
    if wanted is None or response is None:
        lines = [("bound", found.status.value), ("rod", scene.climb.reason)]
    else:
        lines = _of_response(wanted, response)
        if found.proven is not None:
            lines += _of_rays(found.proven, wanted)
        if found.ring is not None:
            lines += _of_ring(found.ring, wanted)
        if target.aim.turns or target.aim.has_paths:
            lines.append(("note", "of the tips alone; what directions and paths add is left out"))
        if found.status is BoundStatus.WORK_LIMIT:
            lines.append(("ended", f"{found.status.value}: --work"))
        lines.append(("time", _times(found)))
    if out is not None:
        figures = "" if response is None else "bound.png, ideal.csv, "
        lines.append(("files", f"{out}/ ({figures}bound.json, …)"))
    console.print(f"[bold]{scene.name}[/]: how low L can be")
    for name, text in lines:
        console.print(f"  {name:<13}{text}", soft_wrap=True, markup=False)


def _of_response(wanted: Wanted, response: ResponseBound) -> list[tuple[str, str]]:
    worst = int(response.distances.argmax())
    at = ", ".join(f"{value:g}" for value in wanted.pressures[worst])
    highest = _area(float(response.starts.max()), wanted.length)
    low = _area(response.loss, wanted.length)
    ended = f"{response.agreeing} of {len(response.starts)} starts end there, the highest"
    said = f"numerical: no response matrix found below it; {ended} at {highest}"
    lines = [("response", f"{low}   ({said})")]
    if response.loss < NOTHING * wanted.length**2:
        return lines
    rms, far = response.rms_distance(wanted), float(response.distances[worst])
    ideal = f"{rms:.4g} mm a node of its ideal tips from the target's"
    return [*lines, ("RMS distance", ideal), ("worst node", f"{far:.4g} mm at {at} kPa")]


def _of_rays(proven: RayBound, wanted: Wanted) -> list[tuple[str, str]]:
    low = _area(proven.loss, wanted.length)
    return [("proven", f"{low}   (no response matrix is below it, while {proven.box.text})")]


def _of_ring(ring: RingBound, wanted: Wanted) -> list[tuple[str, str]]:
    low, high = (_area(value, wanted.length) for value in (ring.outer, ring.inner))
    kind = "numerical, on {} × {} elements".format(*ring.elements)
    if ring.realisable:
        said = "chambers in the ring can have the best response"
        return [("ring", f"{low}   ({kind}: {said})")]
    gap = ring.inner - ring.outer
    between = f"a mixture of chambers in the ring reaches {high}, {gap:.2g} mm² more"
    return [("ring", f"{low}   ({kind}: {between})")]


def gap_text(found: Certificate, loss: float) -> str:
    """How far a loss [mm²] is above what was found to be the lowest, for people."""
    if found.wanted is None or found.response is None:
        return found.status.value
    least, length = found.response.loss, found.wanted.length
    above = f"L is {_area(max(0.0, loss - least), length)} above it"
    if NOTHING * length**2 < least and loss < 10 * least:
        above += f" ({100 * (loss / least - 1):.3g} %)"
    return f"{_area(least, length)} (numerical, over all response matrices): {above}"


def _times(found: Certificate) -> str:
    total = sum(found.seconds.values())
    parts = ", ".join(f"{part} {seconds:.2g} s" for part, seconds in found.seconds.items())
    return f"{total:.2f} s ({parts})"


def _area(loss: float, length: float) -> str:
    """A loss for people; what is rounding alone is 0."""
    return "0 mm²" if loss < NOTHING * length**2 else f"{loss:.6g} mm²"
