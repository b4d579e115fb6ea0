"""Cells against lines: agreement is counted, and so is what contradicts."""

from dataclasses import replace
from pathlib import Path

import pytest

from femcheck.continuation.outcome import Status
from femcheck.stability.ending import MapEnding, ending_of
from femcheck.stability.found import AxisFound, MapRow, agreement_of, share_of_cell
from femcheck.stability.reading import reading
from tests.femcheck.stability.small import make


@pytest.fixture
def found(told: None, tmp_path: Path) -> list[AxisFound]:
    return make(tmp_path / "map")


def rows_of(found: list[AxisFound]) -> list[MapRow]:
    return [row for one in found for row in one.rows]


def with_cell(row: MapRow, place: int, ending: MapEnding) -> MapRow:
    cell = row.cells[place]
    assert cell is not None
    cells = list(row.cells)
    cells[place] = replace(cell, ending=ending)
    return replace(row, cells=tuple(cells))


def test_all_agree(found: list[AxisFound]) -> None:
    said = agreement_of(rows_of(found))
    assert (said.agree, said.near, said.against, said.neither) == (15, 0, (), ())
    assert said.tips == pytest.approx(0.0)


@pytest.mark.parametrize(
    ("place", "ending", "counted"),
    [
        (2, MapEnding.STABLE, "against"),  # an equilibrium above the limit
        (0, MapEnding.LIMIT_POINT, "against"),  # none below it
        (0, MapEnding.BUCKLED, "against"),
        (2, MapEnding.INVERTED, "neither"),
        (0, MapEnding.UNSTABLE, "neither"),
        (0, MapEnding.NO_MESH, "neither"),
        (2, MapEnding.BUCKLED, "agree"),  # there is none, for another reason
    ],
)
def test_what_contradicts_is_counted(
    found: list[AxisFound], place: int, ending: MapEnding, counted: str
) -> None:
    row = with_cell(found[0].rows[0], place, ending)
    said = agreement_of([row])
    assert said.agree == (3 if counted == "agree" else 2)
    assert len(said.against) == (counted == "against")
    assert len(said.neither) == (counted == "neither")
    for line in (*said.against, *said.neither):
        assert line.startswith(f"length 60, {row.axis.pressures[place]:g} kPa: {ending.value}")
        assert "ends at 6 kPa" in line


def test_near_the_line_nothing_is_judged(found: list[AxisFound]) -> None:
    row = found[0].rows[0]
    assert row.trace is not None
    for critical, near in ((8.05, 1), (8.2, 0)):
        said = agreement_of([replace(row, trace=replace(row.trace, critical=critical))])
        assert said.near == near


def test_a_path_that_failed_says_nothing_above(found: list[AxisFound]) -> None:
    row = found[0].rows[0]
    assert row.trace is not None
    said = agreement_of([replace(row, trace=replace(row.trace, ending=MapEnding.INVERTED))])
    assert (said.agree, said.near) == (1, 2)


def test_tips_off_the_path_are_seen(found: list[AxisFound]) -> None:
    row = found[0].rows[0]
    cell = row.cells[0]
    assert cell is not None
    moved = replace(cell, tip=(0.5, 0.0, 60.0))
    said = agreement_of([replace(row, cells=(moved, *row.cells[1:]))])
    assert said.tips == pytest.approx(0.2)  # 0.1 mm of 0.5


def test_share(found: list[AxisFound]) -> None:
    row = found[0].rows[0]
    stable, none, _ = row.cells
    assert stable is not None
    assert none is not None
    assert share_of_cell(row, stable) == pytest.approx(2 / 3)
    assert share_of_cell(row, none) is None


def test_endings() -> None:
    assert ending_of(Status.CONVERGED, 0) is MapEnding.STABLE
    assert ending_of(Status.CONVERGED, 2) is MapEnding.UNSTABLE
    assert ending_of(Status.CONVERGED, None) is MapEnding.UNCHECKED
    for status in Status:
        if status is not Status.CONVERGED:
            assert ending_of(status, None).value == status.value


def test_the_reading_tells_what_contradicts(found: list[AxisFound]) -> None:
    text = " ".join(reading(found).split())
    assert "15 cases on 2 panels. They end as: " in text
    assert "15 of 15 cells say what the line" in text
    assert "| length: 90 | 9 | 10 | -10.0% |" in text
    assert "| 60 | limit point at 6 kPa, after snaps at 1.5 kPa | 3 × | nowhere |" in text
    assert "| 130 | not up to 12 kPa | | 7.5…12 kPa (the end) |" in text
    wrong = with_cell(found[0].rows[0], 2, MapEnding.STABLE)
    less = replace(found[0].rows[1], cells=(None, *found[0].rows[1].cells[1:]))
    other = AxisFound(found[0].axis, (wrong, less, found[0].rows[2]))
    text = " ".join(reading([other]).split())
    assert "(1 are not solved yet)" in text
    assert "1 say the opposite" in text
    assert "unstable" not in text
    assert "- length 60, 12 kPa: stable equilibrium, the path ends at 6 kPa (limit point)" in text


def test_the_reading_tells_where_load_control_misses_the_stable_path(
    found: list[AxisFound],
) -> None:
    row = with_cell(with_cell(found[0].rows[1], 0, MapEnding.UNSTABLE), 2, MapEnding.UNSTABLE)
    text = reading([AxisFound(found[0].axis, (found[0].rows[0], row, found[0].rows[2]))])
    assert "In 1 cells load control ends at an equilibrium that is unstable" in " ".join(
        text.split()
    )
