"""What the README shows is run."""

import re
import shlex
from collections.abc import Iterator
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any

import pytest
from typer.main import get_command

import beamopt.cli.application
import beamopt.storage.campaign
import femcheck.cli.application
import femcheck.cli.stability
import femcheck.cli.subjects
import femcheck.regression.measure
import femcheck.solved.picture
import femcheck.stability.work
from beamopt.base.processes import in_process
from femcheck.chart import lineup
from femcheck.chart.campaign import run_chart
from femcheck.check.check_design import check_design
from femcheck.prediction.predict_design import predict_design
from femcheck.regression.held import LADDER
from femcheck.stability.stability_map import run_map
from tests.femcheck.check.small import Coarse, design_of, three_circles
from tests.femcheck.made_up import MadeUp, powers
from tests.femcheck.stability.small import axes_of, told_cell, told_row

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text()
BLOCKS = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
SHELL = "".join(re.findall(r"```sh\n(.*?)```", README, re.DOTALL))
LINES = re.findall(r"^((?:beamopt|femcheck) .*?) *(?:#.*)?$", SHELL, re.MULTILINE)
PROGRAMS = {
    "beamopt": beamopt.cli.application,
    "femcheck": femcheck.cli.application,
}

LINEAR = "--layers 2 --size 9 --element tet4"
SOFTER = f"{LINEAR} --nu 0.4"
HERE = f"--baseline {ROOT}/reports/baseline --meshes {ROOT}/meshes"
SMALL = " ".join(
    f"--set={key}"
    for key in (
        "search.generations=0",
        "search.population=2",
        "section.feature_points=8",
        "pressures.levels=[0,5,10]",
    )
)
MORE: dict[str, str] = {
    "beamopt optimize sealed-section --out sealed": SMALL,
    "femcheck run sealed --out checked": LINEAR,
    "femcheck run run --seal 1.0": LINEAR,
    "femcheck run a.json b.json --agree 1% --out checks": LINEAR,
    "femcheck run sealed --law neo-hookean --out silicone": SOFTER,
    "femcheck run sealed --law wound --out wound": SOFTER,
    "femcheck run gravity --accuracy 0.01mm": "",
    "femcheck chart sealed/best.json --out solids": "--family beam --family raster",
    "femcheck laws": "",
    "femcheck run sealed --law gent --accuracy 0.1mm --out to-a-tenth": "",
    "femcheck stability --out map --workers 2": "",
    "femcheck baseline sealed/best.json": "",
    "femcheck regress": f"stiff_column {HERE}",
    "femcheck report sealed checked silicone --out report.html": "",
}
MORE |= {line: LINEAR for line in LINES if " --law yeoh --nu 0.4 --wind outer " in line}
"""Lines that are run, with what makes them cheap: a random section, coarse meshes, few models."""


@pytest.mark.parametrize("block", BLOCKS)
def test_python_examples_run(block: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    exec(compile(block, "README.md", "exec"), {})


def test_there_is_an_example() -> None:
    assert BLOCKS
    assert {line.split()[0] for line in LINES} == set(PROGRAMS)


@pytest.mark.parametrize("line", LINES)
def test_every_option_is_one(line: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A line is read up to its command, which is not run."""
    program, name, *arguments = shlex.split(line)
    app = PROGRAMS[program].app
    command = get_command(app).commands[name]  # type: ignore[attr-defined]
    called: list[dict[str, Any]] = []
    monkeypatch.setattr(command, "callback", lambda **options: called.append(options))
    command.main(arguments, standalone_mode=False)
    assert len(called) == 1


def test_every_line_of_femcheck_is_run() -> None:
    of_femcheck = {line for line in LINES if line.startswith("femcheck ")}
    assert of_femcheck == {line for line in MORE if line.startswith("femcheck ")}
    assert set(MORE) <= set(LINES)


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Designs of the names that the README takes for granted; no process but this, no pictures."""
    folder = tmp_path_factory.mktemp("readme")
    levels = [0, 5, 10]
    for name in ("a", "b"):
        design_of(three_circles(), pressures=levels).save(folder / f"{name}.json")
    (folder / "run").mkdir()
    unsealed = {"skin": 0, "wall": 0, "rounding": 0, "smallest_chamber": 0}
    touching = {"supply": 1, "center": [12, 0], "radius": 4}
    design = design_of([touching, *three_circles()[1:]], seal=unsealed, pressures=levels)
    design.save(folder / "run" / "best.json")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setattr(femcheck.solved.picture, "draw", lambda *scene: False)
        patch.setattr(femcheck.cli.subjects, "Subject", Coarse)
        patch.setattr(lineup, "GRIDS", ((16, 60), (32, 120)))
        for judged in (check_design, predict_design, run_chart, run_map):
            patch.setitem(judged.__kwdefaults__, "pool", in_process)
        yield folder


def shorten(line: str, patch: pytest.MonkeyPatch) -> AbstractContextManager[object]:
    """Leave out what takes minutes: solids of an answer and of a map, rungs above the sections."""
    if line.startswith("femcheck stability"):
        patch.setattr(femcheck.cli.stability, "AXES", axes_of())
        patch.setattr(femcheck.stability.work, "solve_cell", told_cell)
        patch.setattr(femcheck.stability.work, "trace_row", told_row)
    if line.startswith("femcheck baseline"):
        sections = {"sections": LADDER[: LADDER.index("raster")]}
        patch.setattr(femcheck.regression.measure, "PARTS", sections)
        patch.setattr(beamopt.storage.campaign, "processes", in_process)
    return MadeUp(powers(1.0, 2)).instead() if "--law gent" in line else nullcontext()


@pytest.mark.parametrize("line", MORE)
def test_lines_run(
    line: str, place: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """In the order of the README; a coarse solid may well disagree, but it is computed."""
    assert place.is_dir()
    program, *arguments = shlex.split(f"{line} {MORE[line]}")
    with shorten(line, monkeypatch):
        assert PROGRAMS[program].run(arguments) in (0, 1), capsys.readouterr().err
