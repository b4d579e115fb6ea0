"""The order in which cases end must not matter: each gets the same guess and the same start."""

from collections.abc import Callable
from concurrent.futures import Executor, Future
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from beamopt.base import tasks as work
from beamopt.base.tasks import solve_all
from femcheck.check import check_design as check_run
from femcheck.check import schedule as module
from femcheck.check.schedule import Key, Schedule
from femcheck.check.stage import Stage
from femcheck.continuation.limits import Limits
from femcheck.continuation.outcome import SolidOutcome, Status
from femcheck.continuation.pressure_tree import all_nodes
from femcheck.material.rigid_section import RigidSection
from femcheck.solid.state import State
from femcheck.solved.case import Case, CaseResult
from femcheck.solved.meshes import layers_for
from tests.femcheck.lattice import lattice_section

LEVELS = (0.0, 20.0, 50.0)
FAILING = {(20.0, 20.0, 0.0), (0.0, 50.0, 20.0), (20.0, 20.0, 20.0), (50.0, 0.0, 0.0)}


class Later(Executor):
    """Keeps what it is given until it is told to do one of them."""

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng(seed)
        self.open: dict[Future[Any], tuple[Any, Any]] = {}
        self.most = 0

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        if fn is module.rest_slopes:
            future.set_result(np.array([[1.0, 0.0], [0.0, 1.0], [2.0, 3.0]]))
        else:
            self.open[future] = (fn, args)
            self.most = max(self.most, len(self.open))
        return future

    def finish_one(self, running: Any, return_when: str) -> tuple[set[Future[Any]], set[Any]]:
        futures = list(self.open)
        future = futures[self._rng.integers(len(futures))]
        fn, args = self.open.pop(future)
        future.set_result(fn(*args))
        return {future}, set(running) - {future}


def solved(case: Case) -> CaseResult:
    """A shape that is no sum, so that every other prediction shows; some have no answer."""
    p = case.pressures
    if tuple(p.tolist()) in FAILING:
        return CaseResult(SolidOutcome(Status.STEP_TOO_SMALL, None))
    shape = np.array([p @ p + p.prod(), p[0] - p[1] * p[2]]) * (1 + len(case.solid.name))
    state = State(np.zeros((1, 3)), p, np.eye(3))
    return CaseResult(SolidOutcome(Status.CONVERGED, state), shape, np.zeros(3), 1.0)


def stages() -> list[Stage]:
    from femcheck.solved.case import Solid

    names = (("soft", None), ("hard", "soft"), ("other", None))
    section = lattice_section()
    return [
        Stage(
            Solid(name, section, np.array([0.0, 1.0]), "tet4", RigidSection(300.0, 1000.0)),
            "standard",
            1.0,
            follows,
        )
        for name, follows in names
    ]


def given(
    monkeypatch: pytest.MonkeyPatch,
    workers: int,
    seed: int,
    known: dict[Key, CaseResult],
    solve: Callable[[Case], CaseResult] = solved,
) -> tuple[dict[Key, tuple[Any, Any]], dict[Key, CaseResult], int]:
    """What each case that is solved was given: its guess, and where it starts."""
    pool, seen = Later(seed), {}
    schedule = Schedule(stages(), LEVELS, Limits(), dict(known))
    monkeypatch.setattr(work, "wait", pool.finish_one)
    make = schedule.case

    def case(key: Key) -> Case:
        made = make(key)
        start = None if made.start is None else tuple(made.start[1].tolist())
        seen[key] = (None if made.guess is None else tuple(made.guess.tolist()), start)
        return made

    monkeypatch.setattr(schedule, "case", case)
    monkeypatch.setattr(module, "solve_case", solve)
    solve_all(schedule, lambda: nullcontext(pool), workers, lambda key, result: None)
    return seen, schedule.results, pool.most


def test_guesses_and_starts_do_not_depend_on_the_order(monkeypatch: pytest.MonkeyPatch) -> None:
    wanted, results, _ = given(monkeypatch, 1, 0, {})
    assert len(wanted) == 3 * 27
    for workers in (2, 30):
        for seed in range(4):
            found, _, most = given(monkeypatch, workers, seed, {})
            assert found == wanted
            assert most > 1
    # nor on what is lost of an earlier run
    rng = np.random.default_rng(1)
    for seed in range(10):
        share = rng.uniform()
        known = {key: one for key, one in results.items() if rng.uniform() < share}
        found, again, _ = given(monkeypatch, 3, seed, known)
        assert found == {key: value for key, value in wanted.items() if key not in known}
        assert set(again) == set(results)


def test_a_failed_case_leads_nobody_astray(monkeypatch: pytest.MonkeyPatch) -> None:
    """What follows from it starts from the nearest equilibrium on the way back, unguessed."""
    wanted, _, _ = given(monkeypatch, 1, 0, {})
    assert wanted["soft", (2, 1, 0)] == (None, (0.0, 20.0, 0.0))
    assert wanted["soft", (0, 0, 0)] == ((0.0, 0.0), None)
    # led by the solid that it follows where its own prediction is missing
    assert wanted["hard", (2, 1, 0)][0] is not None


@pytest.mark.parametrize("status", [Status.TIME_OUT, Status.STOPPED, Status.WORK_LIMIT])
@pytest.mark.parametrize("late", [(20.0, 0.0, 0.0), (0.0, 0.0, 50.0), (20.0, 50.0, 0.0)])
def test_what_is_taken_over_was_solved_as_it_would_be_now(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, status: Status, late: tuple[float, ...]
) -> None:
    """A limit ended one case of one solid: what followed from it began elsewhere than it should."""

    def limited(case: Case) -> CaseResult:
        is_late = tuple(case.pressures.tolist()) == late and case.solid.name == "soft"
        return CaseResult(SolidOutcome(status, None)) if is_late else solved(case)

    wanted, _, _ = given(monkeypatch, 1, 0, {})
    before, kept, _ = given(monkeypatch, 1, 0, {}, limited)
    assert before != wanted
    monkeypatch.setattr(check_run, "read_case", lambda folder, key, shapes, digest: kept[key])
    monkeypatch.setattr(check_run, "Shapes", lambda body: None)
    schedule = Schedule(stages(), LEVELS, Limits())
    check_run._take_kept(tmp_path, schedule)
    assert {key: before[key] for key in schedule.results} == {
        key: wanted[key] for key in schedule.results
    }
    assert all(kept[key].status is not status for key in schedule.results)
    assert {key for key in wanted if key[0] == "other"} <= set(schedule.results)
    assert len(schedule.results) > 27
    again, _, _ = given(monkeypatch, 1, 0, schedule.results)
    assert again == {key: value for key, value in wanted.items() if key not in schedule.results}


def test_no_more_at_once_than_workers(monkeypatch: pytest.MonkeyPatch) -> None:
    for workers in (1, 4):
        assert given(monkeypatch, workers, 3, {})[2] == workers


def test_keys() -> None:
    schedule = Schedule(stages(), LEVELS, Limits())
    assert [node for name, node in schedule.keys if name == "hard"] == all_nodes()
    assert schedule.pressures((2, 0, 1)).tolist() == [50, 0, 20]


def test_layers_follow_the_turn() -> None:
    counts = [layers_for(turn, 4.0) for turn in (0.0, 0.5, 1.0, 2.0, 3.0)]
    assert counts == sorted(counts)
    assert counts[0] >= 3
    assert counts[-1] >= 10
    assert layers_for(0.1, 60.0) >= 20  # a slender one: no layer far longer than it is wide
