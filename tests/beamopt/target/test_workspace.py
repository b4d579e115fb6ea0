"""The workspace: node order, interpolation and loss."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray
from beamopt.target.workspace import (
    HEXAHEDRON_EDGES,
    HEXAHEDRON_NODES,
    Workspace,
    loss,
    pressure_grid,
    rms_distance,
)

LEVELS = [(0.0, 50.0, 100.0), (-5.0, 12.0, 90.0), (10.0, 80.0, 81.0)]


def some_tips(seed: int = 1) -> FloatArray:
    return np.random.default_rng(seed).uniform(-50, 50, size=(27, 3))


def polynomial(coefficients: FloatArray, pressures: FloatArray) -> FloatArray:
    """Σ c_abc p1ᵃ p2ᵇ p3ᶜ with exponents up to 2 each; pressures in 100 kPa."""
    powers = [(pressures[:, axis, None] / 100) ** np.arange(3) for axis in range(3)]
    return np.asarray(np.einsum("na,nb,nc,abcx->nx", *powers, coefficients))


def test_pressures_run_with_p3_fastest() -> None:
    expected = list(product([0, 50, 100], repeat=3))
    np.testing.assert_array_equal(pressure_grid([0, 50, 100]), expected)
    assert pressure_grid([0, 50, 100])[:4].tolist() == [
        [0, 0, 0],
        [0, 0, 50],
        [0, 0, 100],
        [0, 50, 0],
    ]


def test_pressure_grid_takes_any_number_of_levels() -> None:
    np.testing.assert_array_equal(pressure_grid([1, 2]), list(product([1.0, 2.0], repeat=3)))
    assert pressure_grid([0, 1, 2, 3, 4]).shape == (125, 3)
    assert pressure_grid([0, 1]).dtype == np.float64


def test_nodes_are_in_the_order_of_vtk() -> None:
    """VTK's parametric coordinates (0, ½, 1) along p1, p2, p3."""
    model = pytest.importorskip("vtkmodules.vtkCommonDataModel")
    cell = model.vtkTriQuadraticHexahedron()
    parametric = np.reshape([cell.GetParametricCoords()[k] for k in range(81)], (27, 3))
    levels = pressure_grid([0.0, 0.5, 1.0])
    np.testing.assert_array_equal(levels[HEXAHEDRON_NODES], parametric)
    assert cell.GetCellType() == 29


def test_edges_are_those_of_vtk() -> None:
    model = pytest.importorskip("vtkmodules.vtkCommonDataModel")
    cell = model.vtkTriQuadraticHexahedron()
    for k in range(27):
        cell.GetPointIds().SetId(k, k)
    expected = set()
    for e in range(12):
        ids = cell.GetEdge(e).GetPointIds()  # both ends, then the middle
        a, b, middle = (int(HEXAHEDRON_NODES[ids.GetId(k)]) for k in range(3))
        expected.add((min(a, b), middle, max(a, b)))
    assert {tuple(map(int, edge)) for edge in HEXAHEDRON_EDGES} == expected


def test_every_node_occurs_once() -> None:
    np.testing.assert_array_equal(np.sort(HEXAHEDRON_NODES), np.arange(27))
    tips = some_tips()
    hexahedron = Workspace((0.0, 1.0, 2.0), tips).hexahedron
    np.testing.assert_array_equal(hexahedron[[0, 6, 26]], tips[[0, 26, 13]])  # low, high, centre


@pytest.mark.parametrize("levels", LEVELS)
def test_position_reproduces_the_nodes(levels: tuple[float, float, float]) -> None:
    workspace = Workspace(levels, some_tips())
    found = workspace.position(workspace.pressures)
    np.testing.assert_allclose(found, workspace.tips, rtol=0, atol=1e-12)


@pytest.mark.parametrize("levels", LEVELS)
@pytest.mark.parametrize("seed", [1, 2])
def test_position_is_exact_for_triquadratic_polynomials(
    levels: tuple[float, float, float], seed: int
) -> None:
    rng = np.random.default_rng(seed)
    coefficients = rng.normal(size=(3, 3, 3, 3))
    workspace = Workspace(levels, polynomial(coefficients, pressure_grid(levels)))
    anywhere = rng.uniform(*levels[::2], size=(50, 3))
    # the Lagrange polynomials reach 10³ where two levels are close; three factors of rounding
    np.testing.assert_allclose(
        workspace.position(anywhere), polynomial(coefficients, anywhere), rtol=0, atol=1e-8
    )


@given(st.integers(0, 2**32), st.tuples(*[st.floats(0, 100)] * 3))
def test_positions_move_with_the_nodes(seed: int, at: tuple[float, float, float]) -> None:
    """The shape functions add up to one: x → Q x + b goes through."""
    rng = np.random.default_rng(seed)
    Q, b, tips = rng.normal(size=(3, 3)), rng.normal(size=3), some_tips(seed)
    p = np.array([at])
    here = Workspace(LEVELS[0], tips).position(p)
    there = Workspace(LEVELS[0], tips @ Q.T + b).position(p)
    np.testing.assert_allclose(there, here @ Q.T + b, rtol=0, atol=1e-10)


def test_edge_curves_go_through_their_nodes() -> None:
    workspace = Workspace((0.0, 1.0, 7.0), some_tips())
    curves = workspace.edge_curves(points=5)
    assert curves.shape == (12, 5, 3)
    np.testing.assert_allclose(
        curves[:, [0, 2, 4]], workspace.tips[HEXAHEDRON_EDGES], rtol=0, atol=1e-13
    )
    assert workspace.edge_curves().shape == (12, 13, 3)


def test_edge_curves_are_positions_between_even_levels() -> None:
    """Along an edge one pressure runs through the levels while the others stay at an end."""
    workspace = Workspace((0.0, 50.0, 100.0), some_tips(2))
    share = np.linspace(0, 1, 9)[:, None]
    for edge, curve in zip(HEXAHEDRON_EDGES, workspace.edge_curves(9), strict=True):
        first, _, last = workspace.pressures[edge]
        assert np.count_nonzero(last - first) == 1
        found = workspace.position(first + share * (last - first))
        np.testing.assert_allclose(curve, found, rtol=0, atol=1e-11)


def test_loss_adds_squared_distances() -> None:
    """L = Σ |h_j − w_j|²."""
    target = some_tips(1)
    assert loss(target, target) == 0
    assert loss(target + np.array([1.0, -2.0, 2.0]), target) == pytest.approx(27 * 9)
    moved = target.copy()
    moved[4] += [3.0, 4.0, 0.0]
    assert loss(moved, target) == pytest.approx(25)


def test_loss_of_a_batch() -> None:
    rng = np.random.default_rng(3)
    tips, target = rng.normal(size=(2, 5, 27, 3)), some_tips()
    found = loss(tips, target)
    assert found.shape == (2, 5)
    for k in np.ndindex(2, 5):
        expected = sum(np.linalg.norm(h - w) ** 2 for h, w in zip(tips[k], target, strict=True))
        assert found[k] == pytest.approx(expected, rel=1e-13)


def test_rms_distance_of_a_shift_is_its_length() -> None:
    shifted = float(loss(some_tips() + np.array([2.0, 3.0, 6.0]), some_tips()))
    assert rms_distance(shifted, 27) == pytest.approx(7)


def test_misuse_names_shape_and_levels() -> None:
    with pytest.raises(ValueError, match=r"\(26, 3\)"):
        Workspace((0.0, 1.0, 2.0), np.zeros((26, 3)))
    for levels in ((0.0, 0.0, 1.0), (0.0, 2.0, 1.0), (3.0, 2.0, 1.0), (0.0, 1.0, float("nan"))):
        with pytest.raises(ValueError, match=r"levels = .*must ascend"):
            Workspace(levels, np.zeros((27, 3)))
