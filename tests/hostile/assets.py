"""Sound files and folders of every kind that commands read; hostile ones are made of them."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np

from beamopt.pareto.find_front import find_front
from beamopt.rod_map.journal import SCHEMA
from beamopt.rod_map.sampling import METHODS
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.scene import load_scene
from beamopt.search.optimize import optimize
from beamopt.storage.line_journal import LineJournal
from beamopt.storage.writing import json_text
from tests.femcheck.check.small import design_of, three_circles
from tests.femcheck.report.folders import figure_folder

SCENES = bundled_scenes()["random-section"].parent
REPORTS = Path(__file__).resolve().parents[2] / "reports"
TINY = ("search.generations=1", "search.population=4", "section.feature_points=6")

SCENE = """name = "mine"
[search]
generations = 1
population = 4
[section]
feature_points = 6
[grid]
radial = 32
angular = 120
[target]
kind = "{kind}"
file = "{file}"
"""
SEGMENTED = """name = "two"
[search]
generations = 1
population = 4
[rod]
segments = [{share = 0.5}, {share = 0.5, turned = 60.0, file = "drawn.json"}]
"""
POINTS = """p1,p2,p3,x,y,z,weight,tx,ty,tz
0,0,0,0,0,100,1,0,0,1
100,0,0,-20,5,98,2,,,
0,50,100,10,-12,99,1,,,
"""
STUDY = {
    "schema": "beamopt-study/1",
    "seed": 0,
    "overrides": ["search.generations=1"],
    "iterations": 1,
    "targets": ["random-section"],
    "refine": False,
}


def make_assets(folder: Path) -> Path:
    """Write all of them; five seconds."""
    drawn = json.loads((SCENES / "hand_drawn_section.json").read_text())
    drawn["grid"] |= {"radial": 32, "angular": 120}
    (folder / "drawn.json").write_text(json.dumps(drawn, indent=1))
    small = design_of(three_circles())
    small.save(folder / "sealed.json")
    asked = json.loads((REPORTS / "check" / "check.json").read_text())
    (folder / "asked").mkdir()
    (folder / "asked" / "check.json").write_text(json_text(asked | {"design": "sealed"}))
    small.save(folder / "asked" / "design.json")
    shutil.copy(SCENES / "hand_drawn_workspace.csv", folder / "table.csv")
    (folder / "points.csv").write_text(POINTS)
    (folder / "path.csv").write_text("x,y,z\n0,0,100\n5,0,99.5\n5,5,99.5\n")
    for kind, file in (
        ("section", "drawn.json"),
        ("workspace", "table.csv"),
        ("points", "points.csv"),
    ):
        (folder / f"{kind}.toml").write_text(SCENE.format(kind=kind, file=file))
    (folder / "segments.toml").write_text(SEGMENTED)
    optimize(load_scene("random-section", TINY), folder / "run", figures=False)
    front = load_scene("random-section", TINY)
    find_front(front, ["L", "ratio"], folder / "front", population=4, figures=False)
    (folder / "study").mkdir()
    (folder / "study" / "study.json").write_text(json.dumps(STUDY))
    (folder / "map").mkdir()
    asked = {"schema": SCHEMA, "seed": 0, "methods": list(METHODS)}
    LineJournal(folder / "map" / "journal.jsonl", asked, "stability map")
    shutil.copytree(REPORTS / "check", folder / "check")
    shutil.copytree(REPORTS / "prediction", folder / "prediction")
    shutil.copytree(REPORTS / "chart" / "disc-rigid-section", folder / "chart")
    shutil.copy(REPORTS / "chart" / "disc.json", folder / "disc.json")
    (folder / "solids").mkdir()
    journal = (REPORTS / "stability" / "journal.jsonl").read_bytes().splitlines(keepends=True)
    (folder / "solids" / "journal.jsonl").write_bytes(b"".join(journal[:20]))
    (folder / "baseline").mkdir()
    for name in ("gravity.json", "sealed_section.json"):
        shutil.copy(REPORTS / "baseline" / name, folder / "baseline")
    shutil.copytree(REPORTS.parent / "meshes", folder / "meshes")
    figure_folder(folder / "figures")
    assert np.isfinite(json.loads((folder / "run" / "best.json").read_text())["notes"]["L"])
    return folder
