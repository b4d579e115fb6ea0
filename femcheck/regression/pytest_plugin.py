"""A fixture for pytest that holds a project's own designs, as `femcheck regress` holds ours.

def test_the_gripper_stays(hold_design):
    hold_design("gripper.json")

Loaded with every pytest run: what it needs is imported when a design is held.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from pathlib import Path

import pytest

__all__ = ["hold_design"]

UPDATE = "--femcheck-update"
MOST = 12  # lines of what moved

HoldDesign = Callable[..., None]


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option that writes baselines."""
    parser.getgroup("femcheck").addoption(
        UPDATE,
        action="store_true",
        help="write what the designs of hold_design give now as their baselines",
    )


@pytest.fixture
def hold_design(request: pytest.FixtureRequest) -> HoldDesign:
    """Hold a design against its baseline: `hold_design(file, rungs=None)`.

    file : of the design, relative to the test's folder; baseline (and section mesh, where there is
        a solid) stand in `baselines/` there.
    rungs : those that are looked at, by their names in `femcheck.regression.held.LADDER`; all that
        are held if None. Several tests may hold rungs of one design: updates are put together.
    """
    folder = request.path.parent
    update = bool(request.config.getoption(UPDATE))

    def hold(file: str | Path, rungs: Collection[str] | None = None) -> None:
        __tracebackhide__ = True
        said = _hold(folder / file, folder / "baselines", rungs, update)
        if said:
            pytest.fail(said, pytrace=False)

    return hold


def _hold(file: Path, folder: Path, rungs: Collection[str] | None, update: bool) -> str:
    """Compare, or write; what is wrong, "" where nothing is."""
    from beamopt.base.errors import InputError
    from femcheck.regression.baseline import baseline_file
    from femcheck.regression.held_design import find_design
    from femcheck.regression.regression import ContradictionError, regress, update_baseline

    _check_rungs(rungs)
    try:
        design = find_design(str(file), folder)
        if update:
            update_baseline(design, folder, rungs)
            return ""
        kept = baseline_file(folder, design.name)
        if not kept.exists():
            return f"{kept}: no baseline; pytest {UPDATE} writes it"
        found = regress([str(file)], folder, folder, rungs=rungs)
    except InputError as error:
        return f"{error} (pytest {UPDATE} writes baselines anew)"
    except ContradictionError as error:
        return f"nothing is written: {error}"
    if found.holds:
        return ""
    moved = _listed(found.moved, f"of {found.rows} rows moved, the lowest rung first:")
    late = _listed(found.late, f"of {found.rows} rows not compared, time limit reached:")
    return "\n".join(filter(None, (moved, late)))


def _listed(rows: Sequence[object], head: str) -> str:
    """The first rows under their number; "" where there are none."""
    if not rows:
        return ""
    rest = [f"… and {len(rows) - MOST} more"] if len(rows) > MOST else []
    return "\n  ".join([f"{len(rows)} {head}", *map(str, rows[:MOST]), *rest])


def _check_rungs(rungs: Collection[str] | None) -> None:
    """Refuse names that are no rungs: they would hold nothing."""
    from femcheck.regression.held import LADDER

    unknown = [rung for rung in rungs or () if rung not in LADDER]
    if unknown or isinstance(rungs, str):
        raise ValueError(f"rungs = {rungs!r}: some of {', '.join(LADDER)}")
