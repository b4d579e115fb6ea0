"""One row that is really solved: its cells say what its path says."""

from pathlib import Path

import numpy as np
import pytest

import femcheck.solved.case
from femcheck.stability.axis import Axis, Column
from femcheck.stability.ending import MapEnding
from femcheck.stability.found import agreement_of, share_of_cell
from femcheck.stability.solve import TRACK
from tests.femcheck.stability.small import DISC, make


@pytest.fixture(autouse=True)
def without_workshops(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(femcheck.solved.case, "_WORKSHOPS", {})


def test_cells_of_a_real_row_agree_with_its_path(tmp_path: Path) -> None:
    """Three pressures below the limit, one above, on a disc of 1,000 unknowns."""
    axis = Axis("disc", "disc", "", "A disc.", (Column("disc", DISC),), (5.0, 15.0, 25.0, 45.0))
    (found,) = make(tmp_path / "map", axes={"disc": axis})
    (row,) = found.rows
    said = agreement_of([row])
    assert (said.agree, said.near, said.against, said.neither) == (4, 0, (), ())
    assert said.tips < 1e-4
    assert row.trace is not None
    assert row.trace.ending is MapEnding.LIMIT_POINT
    last = row.cells[-1]
    assert last is not None
    assert last.ending is MapEnding.LIMIT_POINT
    assert row.trace.critical is not None
    assert last.reached == pytest.approx(row.trace.critical, rel=1e-3)
    first = row.cells[0]
    assert first is not None
    at = next(point for point in row.trace.track if point[0] == pytest.approx(5.0))
    apart = np.linalg.norm(at[TRACK.index("apart_x") : TRACK.index("apart_z") + 1])
    assert share_of_cell(row, first) == pytest.approx(apart, rel=1e-4)
    assert first.stretch is not None
    assert 1 < first.stretch < 1.5
