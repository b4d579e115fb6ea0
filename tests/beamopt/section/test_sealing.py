"""Sealed sections: every rule, and areas and centroids of the same rules on polygons."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import KDTree
from scipy.spatial.distance import cdist

from beamopt.base.arrays import LabelArray
from beamopt.section.cross_section import CrossSection
from beamopt.section.drawing import Circle, RingPiece, Shape
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.moments import moments_of
from beamopt.section.phenotype import phenotypes
from beamopt.section.seal import UNSEALED, SealRules
from tests.beamopt.section.outline_seal import first_moments, ring, sealed_chambers

PAPER = PolarGrid()
RING = PolarGrid(radial=40, angular=120)
SECTOR = PolarGrid(radial=40, angular=60, start=20.0, stop=200.0)
REFLEX = PolarGrid(radial=40, angular=110, start=-10.0, stop=320.0)
DISC = PolarGrid(0.0, 25.0, radial=60, angular=120)
WEDGE = PolarGrid(0.0, 25.0, radial=60, angular=60, start=0.0, stop=130.0)
GRIDS = [RING, SECTOR, REFLEX, DISC, WEDGE]
RULES = SealRules(1.0, 0.9, 0.5, 3.0, True)
GRID_NAMES = ["ring", "sector", "reflex", "disc", "wedge"]

seeds = st.integers(0, 2**32)
rules_of_all_kinds = st.builds(
    SealRules,
    skin=st.sampled_from([0.0, 0.4, 1.0, 3.0]),
    wall=st.sampled_from([0.0, 0.9, 2.5]),
    rounding=st.sampled_from([0.0, 0.5, 1.5]),
    smallest_chamber=st.sampled_from([0.0, 3.0, 20.0]),
    remove_islands=st.booleans(),
)


def random_points(grid: PolarGrid, seed: int, most: int = 40) -> FeaturePoints:
    """No two positions equally far from any centroid, so that nothing hangs on a tie."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, most))
    x, y = rng.uniform(-grid.outer_radius, grid.outer_radius, size=(2, count))
    return FeaturePoints(x, y, rng.choice(4, size=count, p=[0.4, 0.2, 0.2, 0.2]))


def sealed(grid: PolarGrid, points: FeaturePoints, rules: SealRules) -> LabelArray:
    return CrossSection.from_points(grid, points, 0, rules).labels


def largest_element(grid: PolarGrid) -> float:
    """Longer side of the largest element [mm]."""
    across = np.diff(grid.edges).max()
    return float(max(across, grid.outer_radius * np.radians(grid.span) / grid.angular))


@given(st.sampled_from(GRIDS), seeds, rules_of_all_kinds)
def test_no_chamber_stands_in_the_skin(grid: PolarGrid, seed: int, rules: SealRules) -> None:
    labels = sealed(grid, random_points(grid, seed), rules)
    x, y = grid.centroids
    radius = np.hypot(x, y)
    within = radius > grid.outer_radius - rules.skin
    if grid.inner_radius > 0:
        within |= radius < grid.inner_radius + rules.skin
    if not grid.is_full_ring:
        for angle in np.radians([grid.start, grid.stop]):
            along = x * np.cos(angle) + y * np.sin(angle)
            across = np.abs(y * np.cos(angle) - x * np.sin(angle))
            within |= (along > grid.inner_radius) & (across < rules.skin - 1e-9)
            if grid.inner_radius == 0:
                within |= radius < rules.skin
    assert not labels[within].any()


@given(st.sampled_from(GRIDS), seeds, rules_of_all_kinds)
def test_supplies_keep_a_wall_apart(grid: PolarGrid, seed: int, rules: SealRules) -> None:
    labels = sealed(grid, random_points(grid, seed), rules)
    x, y = grid.centroids
    places = [np.stack([x[labels == s], y[labels == s]], axis=1) for s in (1, 2, 3)]
    for one in range(3):
        for other in range(one):
            if len(places[one]) and len(places[other]):
                apart = KDTree(places[one]).query(places[other])[0].min()
                assert apart >= rules.wall - 1.05 * largest_element(grid)


@given(seeds)
def test_walls_on_a_fine_grid_are_as_thick_as_asked(seed: int) -> None:
    """To a part of an element: a wall is two columns at the outer surface, ten rows across."""
    labels = sealed(PAPER, random_points(PAPER, seed), SealRules(1.0, 0.9, 0.0))
    x, y = PAPER.centroids
    places = [np.stack([x[labels == s], y[labels == s]], axis=1) for s in (1, 2, 3)]
    for one in range(3):
        for other in range(one):
            if len(places[one]) and len(places[other]):
                assert KDTree(places[one]).query(places[other])[0].min() > 0.9 - 0.1


@given(st.sampled_from(GRIDS), seeds)
def test_gaps_in_one_supply_are_closed_and_slivers_opened(grid: PolarGrid, seed: int) -> None:
    """What comes out is, but for the elements of its edges, closed and open already."""
    rules = SealRules(1.0, 1.6, 0.8)
    points = random_points(grid, seed)
    supply = int(points.type.max())
    if supply == 0:
        return
    one_supply = points.with_types(np.where(points.type == 0, 0, supply).astype(np.uint8))
    labels = sealed(grid, one_supply, rules) > 0
    if not labels.any() or labels.all():
        return
    x, y = (part.ravel() for part in grid.centroids)
    chamber = labels.ravel()
    deep = KDTree(np.stack([x[~chamber], y[~chamber]], axis=1)).query(np.stack([x, y], axis=1))[0]
    core = chamber & (deep > 0.8 - 0.75 * largest_element(grid))
    assert core.any()
    reached = KDTree(np.stack([x[core], y[core]], axis=1)).query(np.stack([x, y], axis=1))[0]
    assert (reached[chamber] <= 0.8 + 0.75 * largest_element(grid)).all()


@pytest.mark.parametrize("grid", GRIDS, ids=GRID_NAMES)
def test_small_chambers_and_islands_go(grid: PolarGrid) -> None:
    shapes: list[Shape] = [
        Circle(1, (0.0, 17.0), 5.0),
        Circle(2, (12.0, 12.0), 0.8),  # 2.0 mm²
        Circle(3, (-12.0, 12.0), 1.5),  # 7.1 mm²
    ]
    x, y = grid.centroids
    kept = CrossSection.from_drawing(grid, shapes, 0, SealRules(1.0, smallest_chamber=3.0))
    at = np.array([np.hypot(x - u, y - v).argmin() for u, v in ((0, 17), (12, 12), (-12, 12))])
    expected = [1, 0, 3] if grid is not WEDGE else [1, 0, 0]
    assert kept.labels.ravel()[at].tolist() == expected


def test_an_island_becomes_chamber() -> None:
    """A material point in the middle of chamber points; what reaches the skin stays."""
    turn = np.linspace(0, 2 * np.pi, 8, endpoint=False)
    x, y = 17.5 + np.append(0.0, 5 * np.cos(turn)), np.append(0.0, 5 * np.sin(turn))
    points = FeaturePoints([*x, -17.5], [*y, 0.0], [0] + [2] * 8 + [0])
    keeps = CrossSection.from_points(PAPER, points, 0, SealRules(1.0, 0.9, 0.5))
    removes = CrossSection.from_points(PAPER, points, 0, SealRules(1.0, 0.9, 0.5, 0.0, True))
    assert (keeps.pieces.islands, removes.pieces.islands) == (1, 0)
    middle = PAPER.elements_at(np.array([17.5]), np.array([0.0]))[:2]
    assert (keeps.labels[middle][0], removes.labels[middle][0]) == (0, 2)
    changed = keeps.labels != removes.labels
    assert (removes.labels[changed] == 2).all()
    only_that = CrossSection.from_points(PAPER, points, 0, SealRules(remove_islands=True))
    plain = CrossSection.from_points(PAPER, points, 0)
    assert (plain.pieces.islands, only_that.pieces.islands) == (1, 0)


@given(st.sampled_from(GRIDS), seeds, st.integers(0, 120), rules_of_all_kinds)
def test_turning_by_whole_columns_turns(
    grid: PolarGrid, seed: int, columns: int, rules: SealRules
) -> None:
    if not grid.is_full_ring:
        return
    points = random_points(grid, seed)
    angle = np.radians(columns * grid.span / grid.angular)
    c, s = np.cos(angle), np.sin(angle)
    turned = FeaturePoints(c * points.x - s * points.y, s * points.x + c * points.y, points.type)
    found = np.roll(sealed(grid, points, rules), columns, axis=1)
    np.testing.assert_array_equal(sealed(grid, turned, rules), found)


@given(st.sampled_from([RING, DISC]), seeds, rules_of_all_kinds)
def test_mirroring_mirrors(grid: PolarGrid, seed: int, rules: SealRules) -> None:
    points = random_points(grid, seed)
    mirrored = FeaturePoints(points.x, -points.y, points.type)
    found = sealed(grid, points, rules)[:, ::-1]
    np.testing.assert_array_equal(sealed(grid, mirrored, rules), found)


@given(st.sampled_from(GRIDS), seeds, st.permutations([1, 2, 3]), rules_of_all_kinds)
def test_permuting_supplies_permutes(
    grid: PolarGrid, seed: int, order: list[int], rules: SealRules
) -> None:
    points = random_points(grid, seed)
    renamed = np.array([0, *order], dtype=np.uint8)
    found = sealed(grid, points.with_types(renamed[points.type]), rules)
    np.testing.assert_array_equal(found, renamed[sealed(grid, points, rules)])


@given(st.sampled_from(GRIDS), seeds)
def test_no_rule_no_change(grid: PolarGrid, seed: int) -> None:
    points = random_points(grid, seed)
    plain = CrossSection.from_points(grid, points, 4).labels
    np.testing.assert_array_equal(CrossSection.from_points(grid, points, 4, UNSEALED).labels, plain)
    unwalled = CrossSection.from_points(grid, points, 0).labels
    hardly = SealRules(skin=1e-9)  # through all of the sealing, which has walls in mm alone
    for elements in (0, 4):
        sealed_labels = CrossSection.from_points(grid, points, elements, hardly).labels
        np.testing.assert_array_equal(sealed_labels, unwalled)


@given(st.sampled_from(GRIDS), seeds)
def test_skin_alone_takes_nothing_but_skin(grid: PolarGrid, seed: int) -> None:
    points = random_points(grid, seed)
    plain = CrossSection.from_points(grid, points, 0).labels
    skinned = sealed(grid, points, SealRules(1.0))
    everything = FeaturePoints([3.0], [4.0], [1])
    free = sealed(grid, everything, SealRules(1.0)) > 0
    np.testing.assert_array_equal(skinned, np.where(free, plain, 0))


HOSTILE = {
    "none": ([], [], []),
    "one of air": ([15.0], [0.0], [2]),
    "one of material": ([15.0], [0.0], [0]),
    "all air": ([15.0, -3.0, 4.0], [0.0, 12.0, -20.0], [1, 1, 1]),
    "all material": ([15.0, -3.0, 4.0], [0.0, 12.0, -20.0], [0, 0, 0]),
    "coincident": ([15.0, 15.0, 15.0], [1.0, 1.0, 1.0], [0, 1, 2]),
    "nearly coincident": ([15.0, 15.0 + 1e-6, -15.0], [1.0, 1.0, 0.0], [1, 2, 3]),
    "collinear": ([-20.0, -10.0, 0.0, 10.0, 20.0], [0.0] * 5, [1, 0, 2, 3, 1]),
    "far outside": ([1e6, -1e6, 0.0, 3e5], [0.0, 1e6, -1e6, 3e5], [1, 2, 3, 0]),
    "at the axis": ([0.0, 1e-300, 12.0], [0.0, 0.0, 3.0], [1, 2, 3]),
}


@pytest.mark.parametrize("hostile", HOSTILE.values(), ids=HOSTILE)
@pytest.mark.parametrize("grid", GRIDS, ids=GRID_NAMES)
def test_hostile_genotypes(
    grid: PolarGrid, hostile: tuple[list[float], list[float], list[int]]
) -> None:
    points = FeaturePoints(*hostile)
    for rules in (RULES, SealRules(12.0, 100.0, 100.0), SealRules(0.3, 5.0, 0.01)):
        labels = sealed(grid, points, rules)
        drawn = CrossSection.from_points(grid, points, 0).labels
        assert set(np.unique(labels)) <= {0, *np.unique(drawn).tolist()}
        assert rules.skin < 12 or grid.inner_radius == 0 or not labels.any()


@pytest.mark.parametrize(
    "grid",
    [
        PolarGrid(radial=1, angular=1, stop=90.0),
        PolarGrid(radial=1, angular=1),
        PolarGrid(radial=2, angular=3),
    ],
)
def test_tiny_grids(grid: PolarGrid) -> None:
    points = FeaturePoints([15.0, -15.0, 0.0], [1.0, 0.0, 17.0], [1, 2, 3])
    for rules in (RULES, SealRules(0.1, 0.2, 0.3), SealRules(0.1, 30.0)):
        assert sealed(grid, points, rules).shape == grid.shape


@given(seeds, rules_of_all_kinds, st.sampled_from([0, 4]))
def test_a_batch_equals_one_by_one(seed: int, rules: SealRules, wall_elements: int) -> None:
    for grid in (RING, SECTOR):
        sets = [random_points(grid, seed + k) for k in range(3)]
        sets.insert(1, FeaturePoints([], [], []))
        found = phenotypes(grid, sets, wall_elements, rules)
        one_by_one = [CrossSection.from_points(grid, p, wall_elements, rules) for p in sets]
        expected = [section.moments.raw for section in one_by_one]
        np.testing.assert_array_equal(found.moments.raw, expected)  # bit for bit
        plain = phenotypes(grid, sets, wall_elements)
        np.testing.assert_array_equal(found.neighbour_ratio, plain.neighbour_ratio)


@given(seeds)
def test_walls_of_elements_have_no_effect_on_a_sealed_section(seed: int) -> None:
    points = random_points(RING, seed)
    with_and_without = [CrossSection.from_points(RING, points, n, SealRules(1.0)) for n in (4, 0)]
    np.testing.assert_array_equal(*(one.labels for one in with_and_without))


def test_walls_of_elements_have_no_effect_on_a_sealed_drawing() -> None:
    shapes = [RingPiece(1, (13.0, 22.0), (0.3, 60.4)), RingPiece(2, (13.0, 22.0), (60.4, 120.0))]
    drawn = [CrossSection.from_drawing(PAPER, shapes, n, SealRules(1.0)) for n in (4, 0)]
    np.testing.assert_array_equal(*(one.labels for one in drawn))
    unsealed = [CrossSection.from_drawing(PAPER, shapes, n) for n in (4, 0)]
    assert (unsealed[0].labels != unsealed[1].labels).any()


MEASURED = [
    (PAPER, SealRules(1.0), 0.002),
    (PAPER, SealRules(1.0, 0.9), 0.003),
    (PAPER, SealRules(1.0, 0.0, 0.5), 0.002),
    (PAPER, SealRules(1.0, 0.9, 0.5), 0.003),
    (PAPER, SealRules(1.0, 2.0, 1.0), 0.008),
    (PolarGrid(start=30.0, stop=180.0), SealRules(1.0, 0.9, 0.5), 0.006),
]


@pytest.mark.parametrize(("grid", "rules", "bias"), MEASURED)
def test_areas_and_centroids_are_those_of_the_outline(
    grid: PolarGrid, rules: SealRules, bias: float
) -> None:
    """The same rules on polygons: sums of areas to 0.1…0.5 %, a chamber's to 5 mm²."""
    raster, outline = [], []
    for seed in range(6):
        points = FeaturePoints.random(grid, 60, np.random.default_rng(seed))
        chambers = sealed_chambers(grid, points, rules)
        outline.append([first_moments(chamber) for chamber in chambers])
        raster.append(moments_of(grid, sealed(grid, points, rules)).raw[1:, :3])
    found, exact = np.array(raster), np.array(outline)
    areas = exact[..., 0]
    assert abs(found[..., 0].sum() / areas.sum() - 1) < bias
    assert np.abs(found[..., 0] - areas).max() < 5.0
    off = np.hypot(*(found[..., 1:] - exact[..., 1:]).transpose(2, 0, 1))
    assert np.median(off / np.maximum(areas, 1.0)) < 0.15  # mm


def test_drawn_chambers_are_parted_half_way() -> None:
    """Thin material between two supplies becomes a wall, half of it from each side."""
    shapes = [RingPiece(1, (13.0, 22.0), (0.0, 60.0)), RingPiece(2, (13.0, 22.0), (61.0, 120.0))]
    rules = SealRules(1.0, 2.0)
    section = CrossSection.from_drawing(PAPER, shapes, 0, rules)
    middle = np.radians(60.5)
    side = np.array([np.cos(middle), np.sin(middle)])
    x, y = PAPER.centroids
    off = np.abs(x * side[1] - y * side[0])
    front = (x * side[0] + y * side[1] > 0) & (section.labels > 0)
    assert 0.9 < off[front].min() < 1.0 + 0.5 * largest_element(PAPER)
    areas = section.moments.chamber_areas
    for supply, (first, last) in ((1, (0.0, 60.0)), (2, (61.0, 120.0))):
        phi = np.radians(np.linspace(first, last, 400))
        out, back = np.stack([np.cos(phi), np.sin(phi)], 1), np.stack([np.cos(phi), np.sin(phi)], 1)
        piece = shapely.Polygon(np.concatenate([22 * out, 13 * back[::-1]]))
        wall = shapely.LineString([5 * side, 30 * side]).buffer(1.0)
        exact = (piece & ring(PAPER, 1.0)) - wall
        assert areas[supply - 1] == pytest.approx(exact.area, rel=0.005)


def test_a_drawn_chamber_is_closed_and_rounded() -> None:
    """Two halves 0.6 mm apart become one chamber; its corners get their radius."""
    shapes = [RingPiece(1, (13.0, 22.0), (0.0, 40.0)), RingPiece(1, (13.0, 22.0), (42.0, 80.0))]
    apart = CrossSection.from_drawing(PAPER, shapes, 0, SealRules(1.0, 0.2))
    closed = CrossSection.from_drawing(PAPER, shapes, 0, SealRules(1.0, 0.9))
    assert (apart.pieces.chambers, closed.pieces.chambers) == ((2, 0, 0), (1, 0, 0))
    plain = CrossSection.from_drawing(PAPER, shapes[:1], 0, SealRules(1.0))
    for radius in (1.0, 2.0):
        rounded = CrossSection.from_drawing(PAPER, shapes[:1], 0, SealRules(1.0, 0.0, radius))
        lost = plain.moments.chamber_areas[0] - rounded.moments.chamber_areas[0]
        assert lost == pytest.approx((4 - np.pi) * radius**2, rel=0.25)  # four corners
        assert not (rounded.labels > plain.labels).any()


def test_a_sealed_drawing_has_the_drawn_borders() -> None:
    """With a skin that touches nothing the drawing stays as it is, whatever its borders."""
    shapes = [RingPiece(1, (13.0, 22.0), (-38.3, 38.7), 1.5), Circle(2, (-15.0, 3.0), 4.0)]
    plain = CrossSection.from_drawing(PAPER, shapes, 4)
    skinned = CrossSection.from_drawing(PAPER, shapes, 4, SealRules(0.5))
    np.testing.assert_array_equal(skinned.labels, plain.labels)
    rounded = CrossSection.from_drawing(PAPER, shapes, 0, SealRules(0.5, 0.9, 1.0))
    np.testing.assert_allclose(
        rounded.moments.chamber_areas, plain.moments.chamber_areas, rtol=0.002
    )


def test_distances_are_those_of_millimetres() -> None:
    """The wall between two half rings, by the distance of its two sides at every radius."""
    points = FeaturePoints([0.0, 0.0], [15.0, -15.0], [1, 2])
    labels = sealed(PAPER, points, SealRules(1.0, 2.0))
    x, y = PAPER.centroids
    for supply in (1, 2):
        assert np.abs(y[labels == supply]).min() >= 1.0
    rows = np.flatnonzero(labels.any(axis=1))
    for i in rows[:: len(rows) // 10]:
        ours = np.stack([x[i, labels[i] == 1], y[i, labels[i] == 1]], axis=1)
        theirs = np.stack([x[i, labels[i] == 2], y[i, labels[i] == 2]], axis=1)
        column = 2 * np.hypot(x[i, 0], y[i, 0]) * np.pi / 360
        assert 2.0 <= cdist(ours, theirs).min() <= 2.0 + 2 * column
