"""Limits of what may be asked for: each names its key, before memory is taken or time spent."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest
import shapely

import beamopt
from beamopt.base.errors import InputError
from beamopt.outline import drawn
from beamopt.outline.ring import fine_sagitta
from beamopt.pareto.find_front import find_front
from beamopt.section.drawing import RingPiece
from beamopt.storage.number_table import read_table
from beamopt.target.point_table import read_pairs


@pytest.mark.parametrize(
    "keys",
    [
        ["search.population=10000", "section.feature_points=10000"],
        ["search.population=10000", "search.crossover_probability=10", "grid.radial=1000"],
        ["search.population=2000", "grid.radial=1000", "grid.angular=4000"],
    ],
)
def test_a_population_beyond_the_memory_is_refused(keys: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        beamopt.load_scene("random-section", keys)
    assert caught.value.key == "search.population"


def test_a_large_population_of_usual_sections_is_allowed() -> None:
    beamopt.load_scene("random-section", ["search.population=10000"])
    beamopt.load_scene("random-section", ["section.feature_points=10000"])


def test_a_front_of_a_population_beyond_the_memory_is_refused() -> None:
    scene = beamopt.load_scene("random-section")
    with pytest.raises(InputError) as caught:
        find_front(scene, ("L", "mass"), population=10**12)
    assert (caught.value.key, caught.value.value) == ("population", 10**12)


def test_tables_of_very_many_rows_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.csv"
    file.write_text("p1,p2,p3,x,y,z\n" + "0,0,0,0,0,100\n" * 20_001)
    with pytest.raises(InputError) as caught:
        read_pairs(file, 100.0)
    assert (caught.value.key, caught.value.value) == ("rows", 20_001)
    file.write_text("x\n" + "1\n" * 100_001)
    with pytest.raises(InputError) as caught:
        read_table(file, {"x": "mm"})
    assert caught.value.key == "rows"


def test_trajectories_of_very_many_samples_are_refused_together(tmp_path: Path) -> None:
    (tmp_path / "p.csv").write_text("x,y,z\n0,0,100\n50,0,100\n")
    scene = 'target = {kind = "paths", paths = ["p.csv", "p.csv", "p.csv"], path_step = 0.01}'
    (tmp_path / "s.toml").write_text(scene)
    with pytest.raises(InputError) as caught:
        beamopt.load_scene(tmp_path / "s.toml").load_target()
    assert caught.value.key == "target.paths"


def pieces(count: int, share: float, seed: int | None = None) -> list[RingPiece]:
    """As many ring pieces around, each of a share of its room or, with a seed, anywhere."""
    starts = np.linspace(0, 360, count, endpoint=False)
    if seed is not None:
        starts = np.random.default_rng(seed).uniform(0, 360, count)
    wide = share * 360 / count
    return [
        RingPiece(1 + k % 3, (12.0, 20.0), (start, start + wide))
        for k, start in enumerate(starts.tolist())
    ]


def test_many_chambers_are_compared_with_their_neighbours_only() -> None:
    sagitta = fine_sagitta(beamopt.load_scene("random-section").grid.build())

    def seconds(count: int) -> float:
        polygons = drawn._drawn_polygons(pieces(count, 0.5), sagitta)
        started = time.process_time()
        assert len(drawn._visible(polygons, sagitta)) == count
        return time.process_time() - started

    few, many = (min(seconds(count) for _ in range(3)) for count in (150, 1200))
    assert many < 60 * few  # 144 where each is compared with a union of all later ones


@pytest.mark.parametrize("seed", range(5))
def test_hidden_chambers_are_those_that_all_later_ones_cover(seed: int) -> None:
    sagitta = fine_sagitta(beamopt.load_scene("random-section").grid.build())
    polygons = drawn._drawn_polygons(pieces(40, 4.0, seed), sagitta)
    visible = [
        number
        for number, polygon in enumerate(polygons)
        if not drawn._without(polygon, shapely.union_all(polygons[number + 1 :]), sagitta).is_empty
    ]
    assert 10 < len(visible) < 40
    assert drawn._visible(polygons, sagitta) == visible
