"""A bound takes the work that it is allowed, and is what is proven by then."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from beamopt.bound.cells import Box, RaySum, ray_minimum
from beamopt.bound.certificate import BoundStatus, certificate
from beamopt.bound.prices import ray_bound
from beamopt.bound.response import response_bound
from beamopt.bound.ring import RingMoments
from beamopt.bound.ring_bound import ring_bound
from beamopt.bound.wanted import Wanted
from beamopt.bound.work import ROUND, WorkLeft
from beamopt.cli import progress
from beamopt.cli.application import run
from beamopt.scene.scene import load_scene
from tests.beamopt.bound.cases import bowl, random_response, wanted

GRID = load_scene("random-section").grid.build()


def many(rows: int, seed: int = 5) -> Wanted:
    """A table of as many rows, each at pressures of its own."""
    pressures = np.random.default_rng(seed).uniform(0, 100, (rows, 3))
    return wanted(0.3 * random_response(seed), 1.0, seed, pressures=pressures)


def test_less_work_proves_less_and_never_too_much() -> None:
    asked = bowl()
    best = response_bound(asked)
    found = []
    for most in (1.0, 1e4, 1e5, 3e5, 1e8, math.inf):
        work = WorkLeft(most)
        found.append(ray_bound(asked, response=best.matrix, work=work))
        assert found[-1].loss <= best.loss * (1 + 1e-12)
        assert work.short == (most < 1e8)
        # a ray's first step, and the last one that it is allowed, are done whole
        rays = len(found[-1].rays)
        assert work.spent <= most + 3 * rays * 20 * ROUND
    assert found[0].loss < found[-1].loss
    assert found[-1].loss == ray_bound(asked, response=best.matrix).loss


def test_thousands_of_rows_end_within_the_work_allowed() -> None:
    asked = many(400)
    best = response_bound(asked)
    work = WorkLeft(6e5)
    found = ray_bound(asked, response=best.matrix, work=work)
    assert work.short
    assert work.spent <= 6e5 + 3 * 400 * 2 * ROUND
    assert 0 <= found.loss <= best.loss
    assert len(found.rays) == 400


def test_the_rays_of_one_pass_share_the_work() -> None:
    """The last ray gets as much as the first, and what one leaves is the others'."""
    asked = many(40)
    found = ray_bound(asked, work=WorkLeft(3 * 40 * 4 * ROUND))
    cells = [ray.cells for ray in found.rays]
    assert min(cells[20:]) >= min(cells[:20]) / 2


def test_cells_of_many_rows_are_computed_in_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("beamopt.bound.cells.AT_ONCE", 1000)
    rng = np.random.default_rng(0)
    tips = rng.uniform(-1, 1, (300, 3))
    ray = RaySum(rng.uniform(0, 1, 300), tips, np.ones(300), np.zeros(2))
    centres, halves = rng.uniform(-0.3, 0.3, (50, 3)), np.full((50, 3), 0.01)
    sums, bounds = ray.cells(centres, halves, np.zeros(3), 1e9)
    few = ray.cells(centres[40:42], halves[40:42], np.zeros(3), 1e9)
    np.testing.assert_allclose(sums[40:42], few[0], rtol=1e-12)
    np.testing.assert_allclose(bounds[40:42], few[1], rtol=1e-12)


def test_a_ray_cut_short_is_bounded_from_below() -> None:
    ray = RaySum(np.array([1.0]), np.array([[0.4, 0.0, 0.8]]), np.ones(1), np.zeros(2))
    guess = np.array([0.0, 0.0, 0.4])
    whole = ray_minimum(ray, Box(), np.array([0.1, 0.0, 0.0]), guess, 1e-6)
    assert not whole.cut
    for most in (0.0, 5 * ROUND, 20 * ROUND):
        cut = ray_minimum(ray, Box(), np.array([0.1, 0.0, 0.0]), guess, 1e-6, 0.0, most)
        assert cut.cut
        assert cut.lower <= whole.lower + 1e-6
        assert cut.work <= max(most, 2 * ROUND) + ROUND


def test_the_rings_rounds_end_with_the_work() -> None:
    asked = many(50)
    least = response_bound(asked).loss
    moments, work = RingMoments.of(GRID), WorkLeft(1.0)
    cut = ring_bound(asked, moments, 300.0, least, work)
    whole = ring_bound(asked, moments, 300.0, least)
    assert (cut.rounds, work.short) == (1, True)
    assert cut.outer <= whole.outer * (1 + 1e-9)
    assert whole.rounds > 1


def test_a_certificate_says_that_its_work_was_spent() -> None:
    scene = load_scene("hand-drawn-workspace")
    shares: dict[str, list[float]] = {}
    found = certificate(
        scene,
        scene.load_target(),
        lambda part, share: shares.setdefault(part, []).append(share),
        10,
    )
    assert found.status is BoundStatus.WORK_LIMIT
    assert set(shares) == {"proven", "ring"}
    for part in shares.values():
        assert part == sorted(part)
        assert part[-1] == 1.0


def test_the_command_writes_how_it_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["bound", "hand-drawn-workspace", "--work", "0.001", "--out", "b"]) == 0
    kept = json.loads((tmp_path / "b" / "bound.json").read_text())
    assert kept["ended"] == "WORK_LIMIT"
    assert kept["proven"]["L"] < 65
    assert run(["bound", "hand-drawn-workspace", "--work", "nan"]) == 2
    assert run(["bound", "hand-drawn-workspace", "--work", "0"]) == 2


def test_progress_is_shown_without_a_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(progress, "EVERY", 0.0)
    with progress.work_progress() as show:
        show("proven", 0.0)
        show("proven", 0.5)
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 2
    assert "left" in lines[1]
