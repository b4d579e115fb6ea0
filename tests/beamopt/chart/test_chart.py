"""Error against time: small charts of two methods, and bad calls."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError
from beamopt.chart.chart import HEADER, RodChart, run_chart
from beamopt.chart.measure import (
    MeasuredMethod,
    RodReference,
    TimeLimits,
    measure_rungs,
    reference_of,
)
from beamopt.cli.application import run
from beamopt.comparators.methods import DEFAULT_RESOLUTIONS, Adaptive, all_methods, limited
from beamopt.comparators.shooting import Shooting
from beamopt.comparators.workload import workload_of
from beamopt.rod.ladder import Rung
from beamopt.rod.modes import StrainModes
from beamopt.rod.rod import Rod
from beamopt.rod.solution import Method, RodSolution
from beamopt.rod.status import RodStatus
from beamopt.scene.scene import load_scene

TWO: tuple[Method, ...] = (
    StrainModes(resolutions=(2, 4)),
    Shooting(resolutions=(8, 16)),
)
ONCE = TimeLimits(repeats=1, spent=0.0)
UNLOADED = ("loads.density=0.0",)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, RodChart]:
    folder = tmp_path_factory.mktemp("charts") / "gravity"
    return folder, run_chart(load_scene("gravity"), folder, methods=TWO, limits=ONCE)


def test_what_a_chart_leaves(made: tuple[Path, RodChart]) -> None:
    folder, chart = made
    names = {path.name for path in folder.iterdir()}
    assert names == {"chart.csv", "chart.png", "chart.svg", "provenance.json"}
    text = (folder / "chart.csv").read_text()
    assert text.splitlines()[0] == HEADER
    rows = list(csv.DictReader(text.splitlines()))
    assert [row["method"] for row in rows] == ["arc", "chain"] + ["modes"] * 2 + ["shooting"] * 2
    assert {(row["converged"], row["of"], row["scene"]) for row in rows} == {
        ("27", "27", "gravity")
    }
    assert {row["ended"] for row in rows} == {RodStatus.CONVERGED.name}
    about = json.loads((folder / "provenance.json").read_text())
    assert about["verdict"] == chart.verdict
    assert about["uncertainty_mm"] == chart.uncertainty


def test_finer_is_nearer(made: tuple[Path, RodChart]) -> None:
    """And the rungs that leave the weight out miss it by more than the scene allows."""
    _, chart = made
    errors = {(row.method, row.resolution): row.error for row in chart.rows}
    assert errors["arc", None] > chart.tolerance
    assert errors["arc", None] == pytest.approx(errors["chain", None], rel=1e-9)
    assert errors["modes", 4] < errors["modes", 2] / 100 < chart.tolerance
    assert errors["shooting", 16] < errors["shooting", 8] / 8
    assert chart.uncertainty < errors["shooting", 16] * 1.01


def test_the_chain_is_exact_without_loads() -> None:
    """Also where segments' centroids lie beside the axis, which methods' tips do not know."""
    load = workload_of(load_scene("two-segments"))
    reference = reference_of(load)
    centroids = load.model.on(Rung.LOADED).tips(load.section, load.pressures).positions
    assert np.linalg.norm(centroids - reference.solution.tips, axis=1).max() > 0.1
    arc, chain = measure_rungs(load, reference, ONCE)
    assert chain.error < 1e-9
    assert arc.error > 1.0


def test_the_pressures_begin_at_their_neighbours_or_at_rest() -> None:
    """The reference does not depend on it."""
    load = workload_of(load_scene("pre-curved"))
    tips = reference_of(load).solution.tips
    alone = StrainModes(direct=False).solve(load.rod, load.rest, 12).tips
    np.testing.assert_allclose(tips, alone, rtol=0, atol=1e-6)


def test_a_seed_takes_a_random_section() -> None:
    scene = load_scene("gravity", UNLOADED)
    drawn, one, same, other = (workload_of(scene, seed) for seed in (None, 0, 0, 1))
    areas = [float(load.section.moments.area) for load in (drawn, one, same, other)]
    assert areas[1] == areas[2]
    assert len(set(areas)) == 3


def test_a_target_without_a_section_takes_a_random_one() -> None:
    load = workload_of(load_scene("hand-drawn-workspace"))
    assert load.section.moments.is_stiff


def test_a_scene_without_equilibrium_is_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    solve = StrainModes.solve

    def fails(self: StrainModes, rod: Rod, rest: FloatArray, resolution: int) -> RodSolution:
        return solve(self, rod, rest, 2).failed(range(27), RodStatus.BUCKLED)

    monkeypatch.setattr(StrainModes, "solve", fails)
    with pytest.raises(InputError, match="no equilibrium at any pressure: buckled"):
        run_chart(load_scene("gravity"), tmp_path / "chart", methods=TWO, limits=ONCE)
    assert not (tmp_path / "chart").exists()


def test_time_runs_out(tmp_path: Path) -> None:
    limits = replace(ONCE, seconds=0.0)
    chart = run_chart(load_scene("gravity"), tmp_path / "c", methods=TWO[:1], limits=limits)
    late = [row for row in chart.rows if row.method == "modes"]
    assert [row.status for row in late] == [RodStatus.TOO_SLOW] * 2
    assert all(np.isnan(row.error) and np.isnan(row.seconds) for row in late)
    rows = list(csv.DictReader((tmp_path / "c" / "chart.csv").read_text().splitlines()))
    assert (rows[-1]["error_mm"], rows[-1]["seconds"]) == ("", "")
    assert rows[-1]["status"] == RodStatus.TOO_SLOW.value


def test_who_is_fastest() -> None:
    found = RodStatus.CONVERGED
    rows = (
        MeasuredMethod("a", 1, 0.05, 1.0, 27, 27, found),
        MeasuredMethod("b", 2, 1e-4, 2.0, 27, 27, found),
        MeasuredMethod("c", 3, 1e-9, 0.5, 26, 27, RodStatus.BUCKLED),
        MeasuredMethod("d", 4, np.nan, np.nan, 0, 27, RodStatus.TOO_SLOW),
    )
    chart = RodChart("x", rows, 0.1, 1e-5)
    assert chart.fastest(0.1) is rows[0]
    assert chart.fastest(1e-3) is rows[1]
    assert chart.fastest(1e-6) is None
    assert chart.verdict == (
        "x: fastest to 0.1 mm a 1 in 1e+03 ms, to 0.001 mm b 2 in 2e+03 ms, "
        "to 1e-06 mm unknown (reference: 1e-05 mm)"
    )
    assert "to 1e-06 mm none" in replace(chart, uncertainty=1e-9).verdict


def test_an_error_is_the_largest_where_both_have_a_tip() -> None:
    tips = np.array([[0.0, 0.0, 100.0], [3.0, 0.0, 99.0], [np.nan] * 3, [5.0, 0.0, 98.0]])
    solution = cast("RodSolution", SimpleNamespace(tips=tips))
    moved = tips + np.array([[0.0, 0.1, 0.0], [0.0, 0.0, 0.3], [1.0] * 3, [np.nan] * 3])
    assert RodReference(solution, 0.0).error_of(moved) == pytest.approx(0.3)
    assert np.isnan(RodReference(solution, 0.0).error_of(moved * np.nan))


def test_every_method_has_a_sensible_resolution() -> None:
    methods = all_methods()
    assert [method.name for method in methods] == list(DEFAULT_RESOLUTIONS)
    for method in methods:
        assert list(method.resolutions) == sorted(method.resolutions)
        late = limited(method, 0.5)
        assert late.name == method.name
        assert getattr(late, "seconds", 0.5) == 0.5


def test_adaptive_keeps_its_tolerance() -> None:
    load = workload_of(load_scene("gravity"))
    reference = reference_of(load)
    for resolution in (3, 5, 7):
        found = Adaptive().solve(load.rod, load.rest, resolution)
        assert reference.error_of(found.tips) <= 10.0**-resolution * load.rod.length


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["no-such-scene"], "no such scene"),
        (["gravity", "--set", "loads.density=-1"], "loads.density"),
        (["gravity", "--seed", "-1"], "--seed"),
        (["gravity", "--out", "."], "holds files already"),
    ],
)
def test_bad_calls_are_one_line(
    arguments: list[str],
    said: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    monkeypatch.chdir(tmp_path)
    assert run(["chart", *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("beamopt: ")
    assert err.count("\n") == 1
    assert said in err
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_the_command_says_who_is_fastest(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """With two methods in the place of all."""
    monkeypatch.setattr("beamopt.chart.chart.all_methods", lambda parents: TWO)
    monkeypatch.setattr("beamopt.chart.chart.TimeLimits", lambda: ONCE)
    assert run(["chart", "gravity", "--out", str(tmp_path / "chart")]) == 0
    said = capsys.readouterr().out
    assert "gravity: fastest to 0.1 mm" in said
    assert "reference: ±" in said
    assert (tmp_path / "chart" / "chart.png").exists()
