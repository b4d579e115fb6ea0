"""Memory of long searches: nothing stays in it for every section that was judged."""

from __future__ import annotations

import gc
import math
import os
import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

from beamopt.pareto.find_front import find_front
from beamopt.scene.scene import load_scene
from beamopt.search.optimize import optimize
from tests.validation.check import Check, Row

__all__ = ["checks"]

SMALL = ("grid.radial=16", "grid.angular=48", "search.generations=1000000")
FROM, TO = 10_000, 100_000
REDUCED = 20  # so many times fewer sections; what they take is multiplied
MOST = 20.0  # MB
POPULATION = 100
SOURCE = "flat within 20 MB"


def checks(full: bool) -> list[Check]:
    """The paper's search, one of few sections a generation, and one for a front."""
    times = 1 if full else REDUCED
    return [
        Check("search", partial(_rows, "search", _search, times)),
        Check("small-generations", partial(_rows, "two individuals", _small, times)),
        Check("front", partial(_rows, "front", _front, times)),
    ]


def _rows(
    name: str, search: Callable[[int, Callable[[Any], None]], object], times: int
) -> Iterator[Row]:
    """By how much the memory of this process grows, in whole MB."""
    sizes: list[float] = []
    limits = [FROM // times, TO // times]

    def look(record: Any) -> None:
        if limits and record.evaluations >= limits[0]:
            limits.pop(0)
            gc.collect()
            sizes.append(_resident())

    search(TO // times + 2 * POPULATION, look)
    grown = max(0, math.ceil((sizes[1] - sizes[0]) * times))
    said = f"MB more from {FROM:,} to {TO:,} sections, {name}"
    yield Row(said, SOURCE, 0.0, float(grown), MOST)


def _resident() -> float:
    """Memory of this process [MB]."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def _search(evaluations: int, look: Callable[[Any], None], *keys: str) -> object:
    scene = load_scene("random-section", [*SMALL, f"stop.evaluations={evaluations}", *keys])
    with tempfile.TemporaryDirectory() as folder:
        return optimize(scene, Path(folder) / "run", callback=look, figures=False)


def _small(evaluations: int, look: Callable[[Any], None]) -> object:
    return _search(evaluations, look, "search.population=2", "search.crossover_probability=1")


def _front(evaluations: int, look: Callable[[Any], None]) -> object:
    generations = f"search.generations={evaluations // POPULATION}"
    scene = load_scene("random-section", [*SMALL, generations])
    with tempfile.TemporaryDirectory() as folder:
        about = {"population": POPULATION, "callback": look, "figures": False}
        return find_front(scene, ("L", "mass"), Path(folder) / "front", **about)
