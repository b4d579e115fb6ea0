"""A small body without gmsh: a lattice of squares of which some are chambers, and its states."""

from dataclasses import replace

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from femcheck.material.rigid_section import RigidSection
from femcheck.mesh.extrusion import Extrusion, extrude, stations
from femcheck.mesh.section_mesh import SectionMesh
from femcheck.solid.body import Body, discretise
from femcheck.solid.plate import rotation
from femcheck.solid.state import State, placed

SQUARES = 5
CHAMBERS = {(1, 1): 1, (3, 1): 2, (2, 3): 3}
LENGTH = 12.0
SOFT = RigidSection(300.0, 20.0)
"""A penalty so low that every part of the law counts."""


def lattice_section(distortion: float = 0.15, chambers: dict = CHAMBERS) -> SectionMesh:
    """Squares of 1 mm, two triangles each, their corners moved by up to `distortion` [mm]."""
    side = SQUARES + 1
    at = np.stack(np.meshgrid(np.arange(side), np.arange(side), indexing="ij"), axis=-1)
    points = at.reshape(-1, 2) - np.array([2.0, 3.0])
    points = points + np.random.default_rng(5).uniform(-distortion, distortion, points.shape)
    triangles, edges, supply = [], [], []
    for i in range(SQUARES):
        for j in range(SQUARES):
            if (i, j) in chambers:
                continue
            ring = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            a, b, c, d = (p * side + q for p, q in ring)
            triangles += [[a, b, c], [a, c, d]] if (i + j) % 2 else [[a, b, d], [b, c, d]]
            for (p, q), edge in zip(
                ((i, j - 1), (i + 1, j), (i, j + 1), (i - 1, j)),
                ((a, b), (b, c), (c, d), (d, a)),
                strict=True,
            ):
                inside = 0 <= p < SQUARES and 0 <= q < SQUARES
                if not inside or (p, q) in chambers:
                    edges.append(edge)
                    supply.append(chambers.get((p, q), 0))
    return SectionMesh(points, np.array(triangles), np.array(edges), np.array(supply))


def lattice_extrusion(layers: int = 2, distortion: float = 0.15) -> Extrusion:
    """Corners between the end faces are moved too: on a wall up and down, within it anywhere."""
    section = lattice_section(distortion)
    body = extrude(section, stations(LENGTH, layers, 1.3))
    inner = (body.points[:, 2] > 0) & (body.points[:, 2] < LENGTH)
    on_wall = np.zeros(len(section.points), dtype=bool)
    on_wall[section.edges] = True
    step = np.random.default_rng(6).uniform(-distortion, distortion, body.points.shape)
    step[np.tile(on_wall, layers + 1), :2] = 0
    return replace(body, points=body.points + inner[:, None] * step)


def lattice_body(element: str, layers: int = 2, distortion: float = 0.15) -> Body:
    return discretise(lattice_extrusion(layers, distortion), element)


def bent_state(body: Body, turn: tuple[float, float, float], noise: float, seed: int = 1) -> State:
    """Sections turned gradually up to `turn` [rad], then every free node moved a little."""
    vector = np.array(turn)
    share = body.nodes[:, 2] / body.extrusion.length
    flat = body.nodes - np.outer(share, body.tip_centre)
    centre = np.outer(share, body.tip_centre * [1.0, 1.0, 1.05]) + np.outer(share**2, [1.5, -1, 0])
    x = np.stack([rotation(s * vector) @ y for s, y in zip(share, flat, strict=True)]) + centre
    x += np.random.default_rng(seed).uniform(-noise, noise, x.shape)
    tip = body.tip_centre * [1.0, 1.0, 1.05] + np.array([1.5, -1.0, 0.0])
    return placed(body, x, tip, rotation(vector))


def inner_nodes(body: Body) -> IndexArray:
    """Nodes that lie on no boundary: those of facets with elements on both sides only."""
    outer = set(body.base) | set(body.tip) | set(body.walls.ravel())
    section = body.extrusion.section
    x, y = body.nodes[:, 0], body.nodes[:, 1]
    lowest, highest = section.points.min(axis=0) + 0.4, section.points.max(axis=0) - 0.4
    within = (x > lowest[0]) & (x < highest[0]) & (y > lowest[1]) & (y < highest[1])
    return np.array([node for node in np.flatnonzero(within) if node not in outer])


def random_direction(size: int, seed: int) -> FloatArray:
    return np.random.default_rng(seed).uniform(-1.0, 1.0, size)
