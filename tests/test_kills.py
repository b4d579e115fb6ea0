"""Killed before any change of a file, every command goes on and ends in the same bytes.

Full chains, of whole commands and solids, are in the validation suite `resume`.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.text import Text

import beamopt.rod_map.stability
import femcheck.stability.work
from beamopt.base.processes import in_process
from beamopt.bound.certificate import Certificate, certificate
from beamopt.bound.folder import claimed_for_bound, write_bound
from beamopt.chart.chart import run_chart
from beamopt.chart.measure import TimeLimits
from beamopt.comparators.shooting import Shooting
from beamopt.export.export_design import ExportOptions, export_design
from beamopt.pareto.find_front import find_front
from beamopt.refine.folder import KIND as REFINEMENT
from beamopt.refine.folder import write_refined_design
from beamopt.refine.refine_design import Refinement, refine_design
from beamopt.rod_map.sampling import Sample, solve_sample
from beamopt.rod_map.stability import run_stability
from beamopt.scene.design import load_design
from beamopt.scene.scene import load_scene
from beamopt.search.optimize import optimize
from beamopt.storage.result_folder import claimed
from beamopt.storage.writing import write_atomic
from beamopt.study.plan import Plan
from beamopt.study.study import run_study
from femcheck.accuracy.folder import run_accuracy
from femcheck.chart.campaign import run_chart as run_chart_of_models
from femcheck.regression.regression import hold_designs
from tests.femcheck.made_up import NEO, MadeUp, powers, question_of
from tests.femcheck.regression.small import saved
from tests.femcheck.stability.small import make, told_cell, told_row
from tests.kills import MOMENT, survives
from tests.test_foreign_files import SEALED

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs a system that forks")


@pytest.fixture(autouse=True)
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A place for temporary folders, none of which is left in the end."""
    place = tmp_path / "temporary"
    place.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(place))
    return place


def moment(*_: object) -> None:
    """Name a moment at which nothing is written."""
    sys.audit(MOMENT)


def search(folder: Path) -> None:
    keys = ["search.generations=4", "refine.finish=true", "refine.rounds=1"]
    scene = load_scene("hand-drawn-section", keys)
    optimize(scene, folder, resume=True, figures=False, callback=moment, refining=moment)


def stop_at(generation: int, record: Any) -> None:
    """Be interrupted, as by Ctrl-C."""
    if record.index == generation:
        raise KeyboardInterrupt


def interrupted_search(folder: Path) -> None:
    """A folder with all files of the first generations; figures of them must not stay."""
    scene = load_scene("hand-drawn-section", ["search.generations=4"])
    optimize(scene, folder, callback=partial(stop_at, 1))


def goes_on(folder: Path) -> None:
    optimize(load_scene("hand-drawn-section", ["search.generations=4"]), folder, resume=True)


def interrupted_front(folder: Path) -> None:
    """The same of a front."""
    scene = load_scene("hand-drawn-workspace", ["search.generations=4"])
    find_front(scene, ("L", "mass"), folder, population=8, callback=partial(stop_at, 1))


def front_goes_on(folder: Path) -> None:
    scene = load_scene("hand-drawn-workspace", ["search.generations=4"])
    find_front(scene, ("L", "mass"), folder, population=8, resume=True)


def study(folder: Path) -> None:
    plan = Plan(1, 0, ("search.generations=1",), ("hand-drawn-section",), refine=False)
    run_study(folder, plan, resume=True, figures=False)


def front(folder: Path, generations: int = 2) -> None:
    scene = load_scene("hand-drawn-workspace", [f"search.generations={generations}"])
    find_front(scene, ("L", "mass"), folder, population=8, resume=True, figures=False)


def front_that_grows(folder: Path) -> None:
    """Designs that a front had before and has not now are deleted, whenever it was killed."""
    for generations in (0, 2):
        try:
            front(folder, generations)
        except ValueError:  # it has more already
            assert generations == 0


@cache
def bounded() -> Certificate:
    scene = load_scene("hand-drawn-workspace")
    return certificate(scene, scene.load_target())


def bound(folder: Path) -> None:
    scene = load_scene("hand-drawn-workspace")
    with claimed_for_bound(folder, scene):
        write_bound(folder, scene, scene.load_target(), bounded())


def refinement(folder: Path) -> None:
    scene = load_scene("hand-drawn-section")
    with claimed(folder, REFINEMENT, resume=False):
        write_refined_design(folder, scene, scene.load_target(), refined())


@cache
def refined() -> Refinement:
    scene = load_scene("hand-drawn-section", ["refine.rounds=1"])
    design = scene.design_of(scene.random_points(np.random.default_rng(0)))
    return refine_design(design, scene, scene.load_target())


def chart_of_rods(folder: Path) -> None:
    few = (Shooting(resolutions=(8,)),)
    once = TimeLimits(repeats=1, spent=0.0)
    run_chart(load_scene("gravity"), folder, methods=few, limits=once, callback=moment)


@cache
def sample(seed: int, index: int, methods: tuple[str, ...]) -> Sample:
    return solve_sample(seed, index, methods)


def map_of_rods(folder: Path) -> None:
    run_stability(folder, 3, methods=("modes",), resume=True, figures=False)


def export(folder: Path) -> None:
    design = load_design(SEALED)
    export_design(design, "sealed", folder, ExportOptions(("svg", "stl")))


def accuracy(folder: Path) -> None:
    with MadeUp(powers(10.0, 2)).instead():
        run_accuracy(question_of(NEO), 0.5, folder, resume=True)


def chart(folder: Path) -> None:
    with MadeUp(powers(5.0, 4)).instead():
        families = ("wedge18", "hex27")
        question = question_of(NEO)
        run_chart_of_models(question, folder, families=families, pool=in_process, resume=True)


def baselines(folder: Path) -> None:
    designs = [str(saved(folder.parent, name)) for name in ("a", "b")]
    hold_designs(designs, folder, folder, force=True)


WORK: dict[str, tuple[Callable[[Path], None], tuple[str, ...]]] = {
    "search": (search, ()),
    "study": (study, ()),
    "front": (front, ()),
    "front that grows": (front_that_grows, ()),
    "bound": (bound, ()),
    "refinement": (refinement, ()),
    "chart of rods": (chart_of_rods, ("chart.svg", "chart.png")),
    "map of rods": (map_of_rods, ("reading.md",)),
    "export": (export, ()),
    "accuracy": (accuracy, ()),
    "chart": (chart, ("reading.md", "cheapest.csv")),
    "map": (partial(make, resume=True), ()),
    "baselines": (baselines, ()),
}
"""What makes a folder or goes on with it, and files that hold times."""

DEAR = {"search", "study", "bound", "chart of rods", "refinement"}


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Solids, samples and figures that take no time."""

    def touch(figure: Any, *paths: Path) -> None:
        texts = [] if figure is None else [one.get_text() for one in figure.findobj(Text)]
        for path in paths:
            write_atomic(path, json.dumps(texts))

    monkeypatch.setattr("beamopt.plot.style.save_figure", touch)
    for module in ("beamopt.chart.chart", "femcheck.chart.campaign"):
        monkeypatch.setattr(f"{module}.save_figure", touch)
    monkeypatch.setattr("femcheck.chart.campaign.chart_figure", lambda chart: None)
    monkeypatch.setattr("femcheck.chart.lineup.GRIDS", ((16, 60),))
    monkeypatch.setattr("femcheck.chart.lineup.RODS", {"modes": (4,)})
    monkeypatch.setattr("femcheck.chart.measure.SPENT", 0.0)
    monkeypatch.setattr(femcheck.stability.work, "solve_cell", told_cell)
    monkeypatch.setattr(femcheck.stability.work, "trace_row", told_row)
    monkeypatch.setattr(
        beamopt.rod_map.stability,
        "solve_sample",
        lambda seed, index, methods: sample(seed, index, tuple(methods)),
    )


@pytest.mark.parametrize(
    ("begin", "work"), [(interrupted_search, goes_on), (interrupted_front, front_goes_on)]
)
def test_killed_after_an_interrupted_one(
    begin: Callable[[Path], None], work: Callable[[Path], None], tmp_path: Path
) -> None:
    """What shows the first generations is made again, wherever the kill was."""
    survives(work, tmp_path, kills=12, begin=begin)


@pytest.mark.parametrize("name", WORK)
def test_killed_it_ends_in_the_same_bytes(name: str, tmp_path: Path, temporary: Path) -> None:
    work, apart = WORK[name]
    prepare = {"bound": bounded, "refinement": refined}.get(name)
    if prepare is not None:
        prepare()
    if name == "map of rods":
        for index in range(3):
            sample(0, index, ("modes",))
    survives(work, tmp_path, kills=3 if name in DEAR else 8, apart=apart)
    assert list(temporary.iterdir()) == []
