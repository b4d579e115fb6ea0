"""The panels that are asked for, and the closed form beside them."""

from dataclasses import replace
from functools import partial
from itertools import pairwise

import pytest

import femcheck.stability.specimen
from femcheck.cli.application import app
from femcheck.material.neo_hookean import NeoHookean
from femcheck.mesh.gmsh_section import Mesher
from femcheck.stability.axes import AXES
from femcheck.stability.axis import Axis
from femcheck.stability.closed_tube import closed_tube_limit
from femcheck.stability.ending import MapEnding
from femcheck.stability.solve import solve_cell, trace_row
from femcheck.stability.specimen import Absent, solid_of
from tests.femcheck.stability.small import DISC
from tests.validation.inflation_formulas import closed_tube_limit as by_other_variables


def test_enough_cases() -> None:
    assert sum(axis.count for axis in AXES.values()) >= 300
    assert {"wall", "nu", "slenderness", "element"} <= set(AXES)


@pytest.mark.parametrize("axis", AXES.values(), ids=AXES.keys())
def test_panels_make_sense(axis: Axis) -> None:
    assert all(a < b for a, b in pairwise(axis.pressures))
    assert len({column.label for column in axis.columns}) == len(axis.columns)
    assert len({axis.digest(number) for number in range(len(axis.columns))}) == len(axis.columns)


def test_the_command_names_them_all() -> None:
    from typer.main import get_command

    options = get_command(app).commands["stability"].params  # type: ignore[attr-defined]
    (said,) = [option.help for option in options if option.name == "axis"]
    assert all(name in said.replace(" or ", ", ") for name in AXES)


@pytest.mark.parametrize("ratio", [1.1, 20 / 13, 2.0])
def test_closed_tube_by_two_ways_of_writing_it(ratio: float) -> None:
    expected = 100 * by_other_variables(ratio)
    assert closed_tube_limit(10.0, 10 * ratio, 100.0) == pytest.approx(expected, rel=1e-9)


def test_closed_tube_published() -> None:
    assert closed_tube_limit(13.0, 20.0, 100.0) == pytest.approx(32.278, abs=6e-4)


def test_no_solid_is_an_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    """A linear tetrahedron has no pair for the mixed form; a mesher that fails says how."""
    unpaired = solid_of(replace(DISC, element="tet4"))
    assert isinstance(unpaired, Absent)
    assert "no stable pair for ν = 0.5" in unpaired.reason
    law = NeoHookean(100.0, 0.49, mixed=False)
    assert not isinstance(solid_of(replace(DISC, element="tet4", law=law)), Absent)
    without = partial(Mesher, "no-such-gmsh")
    monkeypatch.setattr(femcheck.stability.specimen, "Mesher", without)
    unmeshed = solid_of(replace(DISC, length=61.5))
    assert unmeshed == Absent(MapEnding.NO_MESH, "gmsh is not installed: no-such-gmsh")
    cell = solve_cell(replace(DISC, length=61.5), 5.0)
    assert (cell.ending, cell.reason) == (unmeshed.ending, unmeshed.reason)
    path = trace_row(replace(DISC, length=61.5), (5.0,))
    assert (path.ending, path.reason) == (unmeshed.ending, unmeshed.reason)


def test_finer_is_finer() -> None:
    finer = DISC.finer
    assert (finer.layers, finer.sagitta, finer.size) == (3, pytest.approx(0.08), 2.0)
