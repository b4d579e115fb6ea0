"""A process that dies in any command with `--workers`: its tasks are done again, to the same bytes.

Commands run in this process; their workers are forks of it, so that they load nothing.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import warnings
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

import pytest
import typer

import beamopt.base.processes
from beamopt.cli.application import app as beamopt_app
from beamopt.cli.application import run as beamopt_run
from beamopt.rod_map.sampling import Sample, solve_sample
from femcheck.cli.application import app as femcheck_app
from femcheck.cli.application import run as femcheck_run
from femcheck.models.question import LawChoice
from femcheck.models.solid import SolidModel
from tests.femcheck.check.small import SIZES, Coarse, design_of, three_circles
from tests.femcheck.stability.small import axes_of, told_cell, told_row
from tests.kills import differing

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs a system that forks")

T = TypeVar("T")
THE_SECOND = 2
"""The task that a process dies of."""


class Forks(ProcessPoolExecutor):
    """Forks of this process, the first of which dies of the second task that is begun."""

    begun = 0
    dies_at = 0

    @classmethod
    def begin(cls, dies_at: int) -> None:
        """Count tasks anew; a process dies of this one, none if 0."""
        cls.begun, cls.dies_at = 0, dies_at

    def __init__(self, workers: int, **_: object) -> None:
        super().__init__(workers, mp_context=multiprocessing.get_context("fork"))

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:
        """Have it done, or be what a process dies of."""
        Forks.begun += 1
        with warnings.catch_warnings():  # of threads, from Python 3.12 on
            warnings.simplefilter("ignore", DeprecationWarning)
            if Forks.begun == Forks.dies_at:
                return super().submit(_die, fn)  # type: ignore[arg-type]
            return super().submit(fn, *args, **kwargs)


def _die(_: object) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


LINES: dict[str, str] = {
    "study": "beamopt study --workers 2 --iterations 1 --no-refine --target random-section "
    "--set search.generations=0 --out OUT",
    "map of rods": "beamopt stability --samples 3 --out OUT",
    "check": "femcheck run small.json --layers 2 --size 9 --out OUT",
    "prediction": "femcheck run small.json --law neo-hookean --layers 2 --size 9 --out OUT",
    "accuracy": "femcheck run small.json --accuracy 9mm --rung solid --out OUT",
    "chart": "femcheck chart small.json --family raster --out OUT",
    "map": "femcheck stability --axis length --axis other --out OUT",
    "baseline": "femcheck baseline gravity --out OUT",
    "regress": "femcheck regress gravity --baseline baseline --out OUT",
}
UNLIKE = ("reading.md", "cheapest.csv", "chart.svg", "chart.png")
"""Files that hold times, besides those that always do."""
IN_THIS_PROCESS = {"beamopt optimize", "beamopt pareto"}
"""Commands whose workers are threads."""
RUN = {"beamopt": beamopt_run, "femcheck": femcheck_run}


def sample_by_modes(seed: int, index: int, methods: Sequence[str]) -> Sample:
    """Two methods, one of either kind; all of them take 20 s."""
    return solve_sample(seed, index, ("adaptive", "modes"))


solid_options = SolidModel.options


def coarse_options(model: SolidModel, law: LawChoice) -> LawChoice:
    """The options of the model, as coarse as a solid can be."""
    return replace(solid_options(model, law), layers=2, sizes=SIZES)


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Workers that load nothing; maps of few and made-up answers; no figures."""
    monkeypatch.setattr(beamopt.base.processes, "_Processes", Forks)
    monkeypatch.setattr("beamopt.rod_map.map_report._draw", lambda *_: None)
    monkeypatch.setattr("beamopt.rod_map.stability.solve_sample", sample_by_modes)
    monkeypatch.setattr("femcheck.cli.stability.AXES", axes_of())
    monkeypatch.setattr("femcheck.stability.work.solve_cell", told_cell)
    monkeypatch.setattr("femcheck.stability.work.trace_row", told_row)
    monkeypatch.setattr("femcheck.chart.lineup.GRIDS", ((16, 60), (32, 120)))
    for module in ("femcheck.cli.subjects", "femcheck.models.question"):
        monkeypatch.setattr(f"{module}.Subject", Coarse)
    monkeypatch.setattr(SolidModel, "options", coarse_options)
    monkeypatch.setattr("femcheck.chart.measure.SPENT", 0.0)


@pytest.mark.parametrize("name", LINES)
@pytest.mark.usefixtures("quick")
def test_its_work_is_done_again(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    design_of(three_circles(), pressures=[0, 4, 8]).save("small.json")
    program, *arguments = LINES[name].split()
    codes = []
    for out, dies_at in (("baseline", 0), ("whole", 0), ("lost", THE_SECOND)):
        if out == "baseline":
            if name == "regress":
                Forks.begin(0)
                assert femcheck_run(["baseline", "gravity", "--out", out]) == 0
            continue
        Forks.begin(dies_at)
        codes.append(RUN[program]([out if one == "OUT" else one for one in arguments]))
        assert Forks.begun >= THE_SECOND
    assert codes[0] == codes[1] in (0, 1)
    assert differing(tmp_path / "whole", tmp_path / "lost", UNLIKE) == []


def test_every_command_with_workers_has_a_line() -> None:
    found = set()
    for program, app in (("beamopt", beamopt_app), ("femcheck", femcheck_app)):
        group: Any = typer.main.get_command(app)
        for name, command in group.commands.items():
            if any(option.name == "workers" for option in command.params):
                found.add(f"{program} {name}")
    assert found - IN_THIS_PROCESS == {" ".join(line.split()[:2]) for line in LINES.values()}
