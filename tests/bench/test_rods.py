"""What the rods' benchmark stands on: its baselines find our tips, its parts give sane rows."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from tests.bench.measured import Measured
from tests.bench.rods import elastica, growth, solvers
from tests.bench.rods_bvp import Start, compiled_tips, plain_tips
from tests.bench.rods_elastica import Clamp, Relaxation
from tests.bench.rods_search import searches
from tests.bench.rods_workspaces import SCENES, as_shipped, workspace

FEW = [0, 5, 26]


def values_of(rows: Iterator[Measured]) -> dict[str, float]:
    """By `what` and unit; all of them positive numbers."""
    found = {f"{row.what} [{row.unit}]": row.value for row in rows}
    assert all(0 < value < np.inf for value in found.values()), found
    return found


@pytest.mark.parametrize("scene", SCENES)
def test_solve_bvp_finds_our_tips_from_either_start_and_in_plain_numpy(scene: str) -> None:
    on = workspace(scene)
    assert on.error_of(as_shipped(on.rod, on.rest)) <= 1e-3
    for tips in (
        compiled_tips(on.rod, on.rest[FEW], Start.STRAIGHT, 9, 1e-6),
        compiled_tips(on.rod, on.rest[FEW], Start.REST, 9, 1e-6),
        plain_tips(on.rod, on.rest[FEW], 9, 1e-6),
    ):
        np.testing.assert_allclose(tips, on.truth[FEW], atol=1e-5 * on.rod.length)


def test_solvers_are_timed_where_they_are_exact_enough() -> None:
    rows = values_of(solvers(SCENES[:1], (5,), (0.01,), rounds=1))
    errors = [value for name, value in rows.items() if name.endswith("largest error [% of L]")]
    assert len(errors) == 4
    assert max(errors) <= 0.1
    assert sum("[times as long]" in name for name in rows) == 3


def test_search_and_growth_have_rows_of_every_kind() -> None:
    rows = values_of(searches(1, rounds=1))
    assert sum(name.startswith("optimize") for name in rows) == 10
    assert sum(name.startswith("part") for name in rows) == 4
    rows = values_of(growth(rounds=1))
    errors = [value for name, value in rows.items() if "largest error" in name]
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 1e-8


def test_pyelastica_comes_to_rest_at_our_tips_in_second_order() -> None:
    pytest.importorskip("elastica", reason="PyElastica is not installed: pip install '.[bench]'")
    on = workspace(SCENES[0]).without_coupling()
    apart = []
    for elements in (12, 24):
        one = Relaxation(on.rod, on.rest[[26], 0], on.density, elements)
        _, tips = one.timed(int(20 / one.frequency / one.time_step), 1)
        apart.append(np.linalg.norm(tips - on.truth[26]) / on.rod.length)
    assert apart[0] < 1e-3
    assert 3.5 < apart[0] / apart[1] < 5.0
    rows = values_of(elastica([13], {Clamp.CENTRED: (12,)}))
    assert rows["elastica, clamp mended: largest error [% of L]"] <= 0.1
    straight = replace(one, clamp=Clamp.MANUAL)
    _, tips = straight.timed(int(20 / one.frequency / straight.time_step), 1)
    assert np.linalg.norm(tips - on.truth[26]) / on.rod.length > 20 * apart[1]
