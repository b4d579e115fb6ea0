"""What the searches' benchmark stands on: sections are counted once each, curves only fall."""

from contextlib import suppress
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from beamopt.judge.judge import Judge
from beamopt.refine.refine import refine
from beamopt.scene.scene import Scene, load_scene
from tests.bench.search import Compared, at_evaluations, at_seconds, curve, table
from tests.bench.search_figure import LOOKS, search_figure
from tests.bench.search_methods import METHODS, random_starts, with_search
from tests.bench.search_tape import BudgetSpentError, Mark, Tape, TapedJudge

BUDGET = 60


@pytest.fixture(scope="module")
def scene() -> Scene:
    """The paper's, with one generation where a method's search ends by itself."""
    return with_search(load_scene("random-section"), {"generations": 1})


def without_seconds(marks: tuple[Mark, ...]) -> list[Mark]:
    return [replace(mark, seconds=0.0) for mark in marks]


@pytest.mark.parametrize("method", METHODS)
def test_a_search_keeps_its_budget_and_only_falls(method: str, scene: Scene) -> None:
    marks = curve(METHODS[method], scene, 3, BUDGET)
    assert 0 < marks[-1].evaluations <= BUDGET
    for before, after in pairwise(marks):
        assert before.evaluations <= after.evaluations
        assert before.seconds <= after.seconds
        assert before.flips <= after.flips
        assert after.T <= before.T
        assert after.L <= before.L
    assert all(0 < mark.L <= mark.T and mark.ratio > 0 for mark in marks)


@pytest.mark.parametrize("method", METHODS)
def test_the_same_seed_gives_the_same_curve_but_for_seconds(method: str, scene: Scene) -> None:
    once, again, other = (curve(METHODS[method], scene, seed, BUDGET) for seed in (3, 3, 4))
    assert without_seconds(once) == without_seconds(again)
    assert without_seconds(once) != without_seconds(other)


@pytest.mark.parametrize("method", METHODS)
def test_every_section_that_a_search_has_judged_is_counted(
    method: str, scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    judged = 0
    plain = Judge.verdicts

    def spied(self: Judge, measured: object, counts: list[int]) -> object:
        nonlocal judged
        judged += len(counts)
        return plain(self, measured, counts)  # type: ignore[arg-type]

    monkeypatch.setattr(Judge, "verdicts", spied)
    marks = curve(METHODS[method], scene, 3, BUDGET)
    if marks[-1].evaluations < BUDGET:
        assert marks[-1].evaluations == judged
    else:  # the last batch may have had more than there was budget for
        assert BUDGET <= judged < BUDGET + scene.search.population


@pytest.mark.parametrize("method", [name for name in METHODS if "GA" in name or "paper" in name])
def test_populations_begin_alike(method: str, scene: Scene) -> None:
    count = scene.search.population
    random = curve(METHODS["random search"], scene, 3, count)
    assert curve(METHODS[method], scene, 3, count)[-1].L == random[-1].L


def test_a_refinement_begins_with_the_first_of_the_population(scene: Scene) -> None:
    first = curve(METHODS["random search"], scene, 3, 1)
    assert curve(METHODS["refine"], scene, 3, 1)[-1].L == first[-1].L


def test_a_tape_ends_a_search_at_its_budget_and_marks_what_it_is_asked_to(scene: Scene) -> None:
    tape = Tape(50, (7, 33))
    with suppress(BudgetSpentError):
        METHODS["random search"](
            scene, TapedJudge.of(Judge.of_scene(scene, scene.load_target()), tape)
        )
    marks = tape.finished()
    assert marks[-1].evaluations == 50
    assert {7, 33} <= {mark.evaluations for mark in marks}
    assert at_evaluations(marks, 33).evaluations == 33
    assert at_seconds(marks, np.inf) == marks[-1]
    assert at_seconds(marks, -1.0) == marks[0]


def test_flips_are_those_that_a_refinement_says_it_proposed(scene: Scene) -> None:
    judge = Judge.of_scene(scene, scene.load_target())
    points = next(random_starts(scene))
    refined = refine(judge, points, scene.refine, seed=scene.search.seed)
    marks = curve(METHODS["refine"], scene, scene.search.seed, 10_000)
    assert marks[-1].flips == refined.flips > 0
    assert marks[-1].L <= refined.after.L
    walks = [mark.flips for mark in curve(METHODS["refine"], scene, 3, 10)]
    assert 0 < walks[-1] < scene.refine.flips


def test_a_taped_judge_gives_the_same_verdicts(scene: Scene) -> None:
    judge = Judge.of_scene(scene, scene.load_target())
    candidates = [scene.random_points(np.random.default_rng([k])) for k in range(5)]
    tape = Tape(10)
    assert TapedJudge.of(judge, tape)(candidates) == judge(candidates)
    found = tape.finished()[-1]
    best = min(judge(candidates), key=lambda verdict: verdict.L)
    assert (found.L, found.ratio) == (best.L, best.K / judge.neighbour_weight)


def test_outlines_are_counted_but_not_compared_with_rasters() -> None:
    scene = load_scene("sealed-section")
    judge = Judge.of_scene(scene, scene.load_target())
    points = scene.random_points(np.random.default_rng([1]))
    tape = Tape(10)
    taped = TapedJudge.of(judge, tape)
    of_raster = taped.measured([points])
    taped.verdicts(replace(of_raster), [len(points)])
    assert (tape.evaluations, tape.L) == (1, np.inf)
    taped.verdicts(of_raster, [len(points)])
    assert tape.evaluations == 2
    assert tape.L == judge([points])[0].L


def test_table_and_figure_are_made_of_the_marks() -> None:
    def falling(lowest: float) -> list[Mark]:
        return [
            Mark(1, 0.01, 100 * lowest, 2.0, 9e3, 0),
            Mark(1820, 0.9, 10 * lowest, 1.5, 2e3, 0),
            Mark(7280, 4.0, lowest, 1.0, 1e3, 0),
        ]

    curves = {name: [falling(s) for s in (3.0, 1.0, 2.0)] for name in METHODS}
    curves["refine"] = [[Mark(5, 0.1, 15.0, 1.0, 1e3, 0), Mark(9, 0.2, 0.1, 0.7, 700.0, 40)]] * 3
    rows = {(row.what, row.unit): row.value for row in table(Compared("a", 65.6, curves))}
    start = "a, paper FD"
    assert rows[f"{start}: L at 1,820 sections judged", "mm²"] == 20.0
    assert rows[f"{start}: L at 1,820 sections judged, worst seed", "mm²"] == 30.0
    assert rows[f"{start}: L at 1 s of processor time", "mm²"] == 20.0
    assert rows[f"{start}: L in the end", "mm²"] == 2.0
    assert rows["a, refine: in all", "flips proposed to the model"] == 40
    below = "a, refine: until it is below the best of the paper's four"
    assert rows[below, "sections judged"] == 5
    assert set(METHODS) <= set(LOOKS)
    figure = search_figure([("a", 65.6, curves)], 1820, 1.0)
    assert len(figure.axes) == 2
