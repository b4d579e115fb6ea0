"""Files that people keep, read by readers that know the formats' descriptions alone."""

import csv
import json
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from beamopt.cli.application import run
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.design import Design, load_design
from beamopt.scene.scene import load_scene
from tests.beamopt.export.samples import random_section
from tests.readers.design_file import rasterise

SCENES = bundled_scenes()["gravity"].parent


def unsealed(name: str) -> Design:
    """A bundled design, its ring pieces with sharp corners."""
    design = load_design(SCENES / name)
    data = design.model_dump(by_alias=True, exclude_none=True)
    for chamber in data["drawing"]:
        chamber.pop("corner", None)
    return Design.model_validate(data)


def of_points(seed: int, walls: int, **grid: float) -> Design:
    design = random_section(seed, skin=0.0)
    data = design.model_dump(by_alias=True, exclude_none=True)
    data["grid"] |= {"radial": 40, "angular": 120, **grid}
    return Design.model_validate(data | {"wall_elements": walls})


DESIGNS = {
    "hand_drawn": lambda: unsealed("hand_drawn_section.json"),
    "round": lambda: unsealed("round_chambers.json"),
    "points": lambda: of_points(0, 0),
    "walls": lambda: of_points(1, 4),
    "sector": lambda: of_points(2, 2, start=30.0, stop=200.0),
    "disc": lambda: of_points(3, 6, inner_radius=0.0),
}


@pytest.mark.parametrize("name", DESIGNS)
def test_a_design_is_rebuilt_from_its_file_alone(name: str, tmp_path: Path) -> None:
    """Every element's type, and the moments, by the format's description."""
    design = DESIGNS[name]()
    types, integrals = rasterise(design.save(tmp_path / "design.json"))
    np.testing.assert_array_equal(types, design.section.labels)
    size = np.abs(integrals).max(axis=0)
    np.testing.assert_allclose(design.moments.raw / size, integrals / size, rtol=0, atol=1e-11)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short search."""
    place = tmp_path_factory.mktemp("formats") / "run"
    keys = ["search.generations=3", "search.population=6", "grid.radial=32", "grid.angular=90"]
    sets = [part for key in keys for part in ("--set", key)]
    assert run(["optimize", "random-section", "--out", str(place), *sets]) == 0
    return place


def rows_of(file: Path) -> list[dict[str, str]]:
    text = file.read_bytes()
    assert not text.startswith(b"\xef\xbb\xbf")
    with file.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream, strict=True))


def numbers(rows: list[dict[str, str]], *names: str) -> np.ndarray:
    return np.array([[float(row[name]) for name in names] for row in rows])


def arc_tips(integrals: np.ndarray, pressures: np.ndarray, E: float, H: float) -> np.ndarray:
    """Tips [mm] of the beam that the paper has, from the section's integrals alone."""
    area, first, second = integrals[0, 0], integrals[0, 1:3], integrals[0, 3:]
    c = first / area
    xx, yy, xy = second - area * np.array([c[0] ** 2, c[1] ** 2, c[0] * c[1]])
    loads = (pressures @ integrals[1:, 0])[:, None]
    arms = pressures @ (integrals[1:, 1:3] - integrals[1:, :1] * c)
    moments = np.stack([arms[:, 1], -arms[:, 0]], axis=1)
    stretch = 1 + loads[:, 0] / (E * area)
    curvature = np.linalg.solve(E * np.array([[yy, -xy], [-xy, xx]]), moments.T).T
    size = np.hypot(*curvature.T)
    angle = np.where(size > 0, size, 1.0) * H
    across = (
        np.stack([curvature[:, 1], -curvature[:, 0]], axis=1) / np.maximum(size, 1e-300)[:, None]
    )
    side, along = (1 - np.cos(angle)) / angle, np.where(size > 0, np.sin(angle) / angle, 1.0)
    return H * stretch[:, None] * np.column_stack([side[:, None] * across, along])


def test_tips_follow_from_the_design_file(folder: Path) -> None:
    """The table's 27 rows, by another's raster, section and arc; L by its definition."""
    rows = rows_of(folder / "tips.csv")
    pressures, tips = numbers(rows, "p1", "p2", "p3"), numbers(rows, "x", "y", "z")
    design = json.loads((folder / "best.json").read_text(encoding="utf-8"))
    _, integrals = rasterise(folder / "best.json")
    actuator = design["actuator"]
    found = arc_tips(integrals, pressures, actuator["youngs_modulus"], actuator["length"])
    np.testing.assert_allclose(tips, found, rtol=0, atol=1e-9 * actuator["length"])
    target = {
        tuple(at): xyz
        for at, xyz in zip(
            numbers(rows_of(folder / "target.csv"), "p1", "p2", "p3").tolist(),
            numbers(rows_of(folder / "target.csv"), "x", "y", "z"),
            strict=True,
        )
    }
    away = [tip - target[tuple(at)] for at, tip in zip(pressures.tolist(), found, strict=True)]
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert design["notes"]["L"] == pytest.approx(float(np.sum(np.square(away))), rel=1e-9)
    assert str(design["notes"]["L"]) in json.dumps(summary)


def test_a_scene_file_is_toml_with_the_scenes_keys(folder: Path) -> None:
    with (folder / "scene.toml").open("rb") as stream:
        keys: dict[str, Any] = tomllib.load(stream)
    assert keys["grid"]["radial"] == 32
    assert keys["search"]["population"] == 6
    assert load_scene(folder / "scene.toml").search.generations == keys["search"]["generations"]


def test_a_journal_is_json_line_by_line(folder: Path) -> None:
    """Every section that was judged; the lowest L is the best design's."""
    lines = (folder / "journal.jsonl").read_text(encoding="utf-8").splitlines()
    entries = [json.loads(line) for line in lines]
    losses = [one[1] for entry in entries[1:] for one in entry["judged"]]
    history = rows_of(folder / "history.csv")
    assert len(losses) == int(history[-1]["evaluations"])
    design = json.loads((folder / "best.json").read_text(encoding="utf-8"))
    assert min(losses) == design["notes"]["L"] == float(history[-1]["best_ever_L"])
