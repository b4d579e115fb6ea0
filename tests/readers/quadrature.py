"""Integrals over triangles and tetrahedra by rules that are exact for quadratic functions."""

import numpy as np

A, B = 0.5854101966249685, 0.1381966011250105  # of the rule with four points


def monomials(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return np.stack([np.ones_like(x), x, y, x * x, y * y, x * y], axis=-1)


def over_triangles(corners: np.ndarray) -> np.ndarray:
    """(6,) integrals over triangles (n, 3, 2); a clockwise one counts negative."""
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas = (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2
    middles = (corners + np.roll(corners, 1, axis=1)) / 2
    return areas @ monomials(middles[..., 0], middles[..., 1]).mean(axis=1)


def over_loop(points: np.ndarray) -> np.ndarray:
    """(6,) integrals over a polygon (n, 2) by a fan about its first corner, signed."""
    first = np.broadcast_to(points[0], points.shape)
    return over_triangles(np.stack([first, points, np.roll(points, -1, axis=0)], axis=1))


def over_edges(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(6,) integrals over what closed chains of edges enclose, by a fan about the origin."""
    return over_triangles(np.stack([np.zeros_like(a), a, b], axis=1))


def over_circle(x: float, y: float, radius: float) -> np.ndarray:
    """(6,) integrals over a disc."""
    area, own = np.pi * radius**2, np.pi * radius**4 / 4
    return area * monomials(np.array(x), np.array(y)) + own * np.array([0, 0, 0, 1, 1, 0])


def over_surface(triangles: np.ndarray) -> np.ndarray:
    """(6,) volume integrals within closed surfaces of triangles (n, 3, 3), seen from outside."""
    volumes = np.linalg.det(triangles) / 6
    total = triangles.sum(axis=1, keepdims=True)
    points = B * total + (A - B) * np.concatenate([triangles, np.zeros_like(total)], axis=1)
    return volumes @ monomials(points[..., 0], points[..., 1]).mean(axis=1)
