"""Drawn chambers against the definition of a rounded shape and against closed-form areas."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import KDTree

from beamopt.base.arrays import FloatArray
from beamopt.section.drawing import Circle, RingPiece, rasterise
from beamopt.section.grid import PolarGrid

PIECES = [
    RingPiece(1, (13.0, 22.0), (20.0, 100.0), 1.5),
    RingPiece(1, (13.0, 22.0), (-40.0, 40.0), 4.4),
    RingPiece(1, (3.0, 9.0), (300.0, 390.0), 2.0),
    RingPiece(1, (4.0, 12.0), (50.0, 75.0), 0.9),  # close to what the narrow inner end admits
    RingPiece(1, (5.0, 9.0), (-100.0, 130.0), 1.5),
    RingPiece(1, (2.0, 8.0), (10.0, 350.0), 1.0),
    RingPiece(1, (0.0, 8.0), (-120.0, 130.0), 2.0),  # the axis is a re-entrant corner: not rounded
    RingPiece(1, (0.0, 8.0), (15.0, 195.0), 3.0),
]


def outline(piece: RingPiece, spacing: float) -> FloatArray:
    """Points (n, 2) along the piece's boundary with sharp corners."""
    a, b = np.radians(piece.phi)
    inner, outer = piece.r
    around = np.linspace(a, b, int((b - a) * outer / spacing) + 2)
    along = np.linspace(inner, outer, int((outer - inner) / spacing) + 2)
    arcs = [r * np.stack([np.cos(around), np.sin(around)], axis=1) for r in (inner, outer)]
    sides = [along[:, None] * np.array([np.cos(t), np.sin(t)]) for t in (a, b)]
    return np.concatenate([*arcs, *sides])


def is_in_sharp_piece(piece: RingPiece, points: FloatArray) -> NDArray[np.bool_]:
    radius = np.linalg.norm(points, axis=1)
    middle = np.radians(sum(piece.phi) / 2)
    turned = (
        points @ np.array([np.cos(middle), np.sin(middle)]),
        points @ np.array([-np.sin(middle), np.cos(middle)]),
    )
    half = np.radians(piece.phi[1] - piece.phi[0]) / 2
    within = np.abs(np.arctan2(turned[1], turned[0])) <= half
    return np.asarray(within & (radius >= piece.r[0]) & (radius <= piece.r[1]))


@pytest.mark.parametrize("piece", PIECES, ids=str)
def test_rounded_corners_are_an_opening(piece: RingPiece) -> None:
    """Inside is what lies within `corner` of the piece shrunk by `corner`.

    The shrunk piece is sampled on a lattice: its points are at least `corner` from the boundary.
    """
    spacing = 0.05
    line = np.arange(-piece.r[1], piece.r[1] + spacing, spacing)
    lattice = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
    lattice = lattice[is_in_sharp_piece(piece, lattice)]
    depth, _ = KDTree(outline(piece, spacing / 5)).query(lattice)
    shrunk = lattice[depth >= piece.corner]
    points = np.random.default_rng(1).uniform(-piece.r[1], piece.r[1], size=(20_000, 2))
    distance, _ = KDTree(shrunk).query(points)
    # between two lattice points, at an angle to the shrunk piece's sharp corners
    doubt = 2.5 * spacing
    covered = piece.covers(*points.T)
    assert covered[distance < piece.corner].all()
    assert not covered[distance > piece.corner + doubt].any()
    cut = is_in_sharp_piece(piece, points) & ~covered
    assert cut.any()  # corners were among the points


def test_a_piece_as_wide_as_two_corners_has_round_ends() -> None:
    """With 2 corner = R − r: all points within `corner` of an arc in the middle."""
    piece = RingPiece(1, (10.0, 14.0), (30.0, 120.0), 2.0)
    trim = np.arcsin(2.0 / 12.0)
    ends = np.radians(30.0) + trim, np.radians(120.0) - trim
    x, y = np.random.default_rng(2).uniform(-15, 15, size=(2, 20_000))
    angle = np.clip(np.arctan2(y, x), *ends)
    # beyond an end the nearest point of the arc is that end, on either side
    away = np.minimum(*(np.hypot(x - 12 * np.cos(t), y - 12 * np.sin(t)) for t in ends))
    on_arc = np.hypot(x - 12 * np.cos(angle), y - 12 * np.sin(angle))
    np.testing.assert_array_equal(piece.covers(x, y), np.minimum(away, on_arc) <= 2.0)


def test_sharp_corners_cut_nothing() -> None:
    piece = RingPiece(2, (5.0, 9.0), (-100.0, 130.0))
    points = np.random.default_rng(3).uniform(-10, 10, size=(20_000, 2))
    np.testing.assert_array_equal(piece.covers(*points.T), is_in_sharp_piece(piece, points))


@pytest.mark.parametrize("phi", [(-40.0, 40.0), (320.0, 400.0), (-400.0, -320.0)])
def test_angles_may_run_across_0_degrees(phi: tuple[float, float]) -> None:
    piece = RingPiece(1, (13.0, 22.0), phi, 1.0)
    angles = np.radians([0.0, 39.0, -39.0, 41.0, -41.0, 180.0])
    inside = piece.covers(17 * np.cos(angles), 17 * np.sin(angles))
    np.testing.assert_array_equal(inside, [True, True, True, False, False, False])


@pytest.mark.parametrize("phi", [(0.0, 360.0), (-77.0, 283.0)])
def test_a_full_ring_has_no_corners(phi: tuple[float, float]) -> None:
    x, y = np.random.default_rng(4).uniform(-25, 25, size=(2, 5000))
    radius = np.hypot(x, y)
    inside = RingPiece(3, (13.0, 22.0), phi, 2.0).covers(x, y)
    np.testing.assert_array_equal(inside, (radius >= 13) & (radius <= 22))


def area_of_the_corners(piece: RingPiece) -> float:
    """What rounding takes away.

    A corner's circle of radius c touches the side, at the distance t from the axis, and the arc of
    radius R. The triangle axis, touching point, circle's centre and the sector of the circle from
    the side to the arc make up, with the corner, a sector of the disc R (outer arc); at the inner
    arc, the triangle consists of the other two and the corner.
    """
    total = 0.0
    for radius, middle, sign in (
        (piece.r[1], piece.r[1] - piece.corner, 1),
        (piece.r[0], piece.r[0] + piece.corner, -1),
    ):
        c = piece.corner
        alpha = np.arcsin(c / middle)
        triangle = np.sqrt(middle**2 - c**2) * c / 2
        circle = c**2 * (np.pi / 2 + sign * alpha) / 2
        total += 2 * (sign * (radius**2 * alpha / 2 - triangle) - circle)
    return float(total)


@pytest.mark.parametrize("piece", PIECES[:6], ids=str)
def test_area_converges_with_the_grid(piece: RingPiece) -> None:
    """The grid is the piece with sharp corners, so only the corners are missing."""
    expected = area_of_the_corners(piece)
    errors = []
    for n in (30, 120, 480):
        grid = PolarGrid(*piece.r, n, n, *piece.phi)
        missing = (rasterise(grid, [piece]) == 0).sum() * grid.element_area
        errors.append(abs(missing / expected - 1))
    # one element wide along the round edge at most, and mostly evened out
    assert errors[-1] < 0.02
    assert errors[-1] < errors[0]


def test_a_circle_covers_its_disc() -> None:
    circle = Circle(2, (3.0, -15.0), 4.5)
    x, y = np.random.default_rng(5).uniform(-25, 25, size=(2, 5000))
    np.testing.assert_array_equal(circle.covers(x, y), np.hypot(x - 3, y + 15) <= 4.5)
    grid = PolarGrid(radial=300, angular=900)
    area = (rasterise(grid, [circle]) == 2).sum() * grid.element_area
    assert area == pytest.approx(np.pi * 4.5**2, rel=2e-3)  # about 9000 elements


def test_a_later_shape_covers_an_earlier_one() -> None:
    grid = PolarGrid(radial=30, angular=72)
    first, second = RingPiece(1, (12.0, 20.0), (0.0, 90.0)), Circle(3, (12.0, 12.0), 4.0)
    a, b = first.covers(*grid.centroids), second.covers(*grid.centroids)
    assert (a & b).any()
    np.testing.assert_array_equal(rasterise(grid, [first, second]), np.where(b, 3, a * 1))
    np.testing.assert_array_equal(rasterise(grid, [second, first]), np.where(a, 1, b * 3))


def test_nothing_drawn_is_material() -> None:
    labels = rasterise(PolarGrid(radial=4, angular=5), [])
    assert labels.shape == (4, 5)
    assert labels.dtype == np.uint8
    assert not labels.any()


@pytest.mark.parametrize(
    ("r", "phi", "corner", "named"),
    [
        ((22.0, 13.0), (0.0, 80.0), 0.0, r"r = \[22, 13\]"),
        ((13.0, 13.0), (0.0, 80.0), 0.0, r"r = \[13, 13\]"),
        ((-1.0, 13.0), (0.0, 80.0), 0.0, r"r = \[-1, 13\]"),
        ((13.0, 22.0), (80.0, 0.0), 0.0, r"phi = \[80, 0\]"),
        ((13.0, 22.0), (0.0, 0.0), 0.0, r"phi = \[0, 0\]"),
        ((13.0, 22.0), (0.0, 361.0), 0.0, r"phi = \[0, 361\]"),
        ((13.0, 22.0), (0.0, 80.0), -1.0, r"corner = -1"),
        ((13.0, 22.0), (0.0, 80.0), 4.6, r"corner = 4\.6: must be 0…4\.5 mm"),
        # the narrow inner end: c ≤ r sin(φ/2)/(1 − sin(φ/2)) = 10 sin 5°/(1 − sin 5°)
        ((10.0, 22.0), (0.0, 10.0), 1.0, r"corner = 1: must be 0…0\.9548 mm"),
        ((0.0, 22.0), (0.0, 90.0), 1.0, r"corner = 1: must be 0…0 mm"),
    ],
)
def test_misuse_of_a_piece_names_the_value(
    r: tuple[float, float], phi: tuple[float, float], corner: float, named: str
) -> None:
    with pytest.raises(ValueError, match=named):
        RingPiece(1, r, phi, corner)


@pytest.mark.parametrize("corner", [4.5, 0.0])
def test_the_largest_corner_fits(corner: float) -> None:
    assert RingPiece(1, (13.0, 22.0), (0.0, 80.0), corner).corner == corner


@pytest.mark.parametrize("radius", [0.0, -2.0, float("nan")])
def test_a_circle_needs_a_radius(radius: float) -> None:
    with pytest.raises(ValueError, match=f"radius = {radius:g}"):
        Circle(1, (0.0, 15.0), radius)


@pytest.mark.parametrize("first", [0.5, 20.5, 200.5, 310.5])
def test_sides_through_centroids_are_straight(first: float) -> None:
    """Centroids lie at half degrees: such a side takes its whole column, at both ends."""
    grid = PolarGrid()
    labels = rasterise(grid, [RingPiece(1, (13.0, 22.0), (first, first + 80))])
    rows = labels.any(axis=1)
    columns = labels.any(axis=0)
    assert columns.sum() == 81
    assert labels[np.ix_(rows, columns)].all()


@pytest.mark.parametrize(
    "make",
    [
        lambda: RingPiece(7, (13.0, 22.0), (0.0, 80.0)),
        lambda: RingPiece(1, (13.0, np.inf), (0.0, 80.0)),
        lambda: RingPiece(1, (13.0, 22.0), (0.0, 80.0), np.nan),
        lambda: RingPiece(1, (13.0, 22.0), (0.0, 360.0), -1.0),
        lambda: Circle(0, (0.0, 0.0), 3.0),
        lambda: Circle(1, (np.nan, 0.0), 3.0),
        lambda: Circle(1, (0.0, 0.0), np.inf),
    ],
)
def test_values_that_are_no_chamber(make) -> None:
    with pytest.raises(ValueError, match=r"supply|r = |corner|radius"):
        make()


@pytest.mark.parametrize(("first", "last"), [(152.2, 512.2), (152.3, 512.3)])
def test_a_whole_turn_is_one_wherever_it_starts(first: float, last: float) -> None:
    """No sides, so no corners: whichever way the difference of the decimals rounds."""
    grid = PolarGrid()
    turned = rasterise(grid, [RingPiece(1, (13.0, 22.0), (first, last), 1.5)])
    np.testing.assert_array_equal(turned, rasterise(grid, [RingPiece(1, (13.0, 22.0), (0, 360))]))
