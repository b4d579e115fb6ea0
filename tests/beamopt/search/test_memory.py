"""Long searches take no more memory than short ones: nothing is held for every section judged."""

from __future__ import annotations

import gc
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import beamopt
from beamopt.pareto.find_front import find_front
from beamopt.search.history import History

SMALL = [
    "grid.radial=8",
    "grid.angular=24",
    "section.feature_points=100",
    "search.generations=1000000",
]
FIRST, THEN = 1500, 3000
"""Sections judged before the first and the second look at the memory."""
LONG = 90_000
MOST = 20e6  # bytes that a search may grow by between 10,000 and 100,000 sections


class Looks:
    """The memory in use after `FIRST` and `THEN` sections."""

    def __init__(self) -> None:
        self.sizes: list[int] = []

    def __call__(self, record: Any) -> None:
        if record.evaluations >= (FIRST, THEN)[min(len(self.sizes), 1)] and len(self.sizes) < 2:
            gc.collect()
            self.sizes.append(tracemalloc.get_traced_memory()[0])

    @property
    def growth(self) -> float:
        """By which a long search grows [bytes]."""
        return (self.sizes[1] - self.sizes[0]) / (THEN - FIRST) * LONG


def growth_of(search: Callable[[Looks], object]) -> float:
    looks = Looks()
    tracemalloc.start()
    try:
        search(looks)
    finally:
        tracemalloc.stop()
    return looks.growth


@pytest.mark.parametrize("keys", [[], ["search.population=2", "search.crossover_probability=1"]])
def test_a_search_does_not_grow(tmp_path: Path, keys: list[str]) -> None:
    scene = beamopt.load_scene("random-section", [*SMALL, f"stop.evaluations={THEN + 40}", *keys])

    def search(looks: Looks) -> object:
        return beamopt.optimize(scene, tmp_path / "run", callback=looks, figures=False)

    assert growth_of(search) < MOST


def test_a_search_for_a_front_does_not_grow(tmp_path: Path) -> None:
    generations = f"search.generations={THEN // 40 + 1}"
    scene = beamopt.load_scene("random-section", [*SMALL, generations])

    def search(looks: Looks) -> object:
        about = {"population": 40, "callback": looks, "figures": False}
        return find_front(scene, ("L", "mass"), tmp_path / "front", **about)

    assert growth_of(search) < MOST


def test_a_history_is_a_sequence_of_numbers() -> None:
    scene = beamopt.load_scene("random-section", [*SMALL[:3], "search.generations=5"])
    records: list[beamopt.Generation] = []
    found = beamopt.optimize(scene, callback=records.append)
    history = found.history
    assert isinstance(history, History)
    assert [one.generation for one in history] == [0, 1, 2, 3, 4, 5]
    for one, record in zip(history, records, strict=True):
        losses = [each.verdict.L for each in record.population]
        assert (one.lowest_loss, one.highest_loss) == (min(losses), max(losses))
        assert one.mean_loss == pytest.approx(sum(losses) / len(losses))
        assert one.lowest_total == min(each.verdict.T for each in record.population)
        assert one.evaluations == record.evaluations
        assert one.best_loss == record.best.verdict.L
        ever = record.best_ever.verdict
        assert (one.ever_loss, one.ever_neighbour_loss) == (ever.L, ever.K)
        assert one.rejected == sum(record.rejected.values())
    assert history[-1] == history[5] == history[1:][-1]
    with pytest.raises(IndexError):
        history[6]
    assert found.last is records[-1]
