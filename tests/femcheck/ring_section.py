"""The three-chamber section meshed by hand, coarser than gmsh's: chords for arcs, sharp corners."""

from itertools import pairwise

import numpy as np

from femcheck.mesh.section_mesh import SectionMesh

RADII = (10.0, 13.0, 22.0, 25.0)
STEP = 20  # degrees of a cell; chambers take four, the walls between them two


def ring_section(parts: int = 1) -> SectionMesh:
    """Chambers 13…22 mm × 120 i ± 40°; every cell cut into parts × parts × 2 triangles."""
    pieces = [np.linspace(a, b, parts, endpoint=False) for a, b in pairwise(RADII)]
    radii = np.append(np.concatenate(pieces), RADII[-1])
    around = 360 // STEP * parts
    angles = np.radians(np.arange(around) * STEP / parts - 40)
    points = np.stack([np.outer(radii, np.cos(angles)), np.outer(radii, np.sin(angles))], axis=2)
    r, a = (k.ravel() for k in np.meshgrid(np.arange(3 * parts), np.arange(around), indexing="ij"))
    chamber = (r // parts == 1) & (a // parts % 6 < 4)
    r, a = r[~chamber], a[~chamber]
    corners = [i * around + j % around for i, j in ((r, a), (r + 1, a), (r + 1, a + 1), (r, a + 1))]
    first, second, third, fourth = corners
    triangles = np.concatenate(
        [np.stack([first, second, third], 1), np.stack([first, third, fourth], 1)]
    )
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    count = len(radii) * around
    keys = sides[:, 0] * count + sides[:, 1]
    edges = sides[~np.isin(keys, sides[:, 1] * count + sides[:, 0])]
    flat = points.reshape(-1, 2)
    on_surface = np.isin(edges // around, (0, len(radii) - 1)).all(axis=1)
    middle = flat[edges].mean(axis=1)
    turned = np.degrees(np.arctan2(middle[:, 1], middle[:, 0])) + 60
    supply = np.where(on_surface, 0, (turned % 360 // 120).astype(np.int64) + 1)
    used, triangles = np.unique(triangles, return_inverse=True)
    return SectionMesh(flat[used], triangles.reshape(-1, 3), np.searchsorted(used, edges), supply)
