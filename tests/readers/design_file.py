"""A design file of an unsealed section, rasterised by the rules of the format's description."""

import json
from pathlib import Path
from typing import Any

import numpy as np

TIE = 1e-9  # mm², of squared distances


def rasterise(file: Path) -> tuple[np.ndarray, np.ndarray]:
    """Types (radial, angular) of the elements, and integrals (4, 6) over each type."""
    design: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    assert design["schema"] == "beamopt-design/1"
    assert design["seal"]["skin"] == 0
    grid = design["grid"]
    squares = np.linspace(grid["inner_radius"] ** 2, grid["outer_radius"] ** 2, grid["radial"] + 1)
    radii, span = np.sqrt(squares), grid["stop"] - grid["start"]
    angles = np.radians(grid["start"] + span * np.arange(grid["angular"] + 1) / grid["angular"])
    half = np.diff(angles)[0] / 2
    distance = 2 / 3 * np.diff(radii**3) / np.diff(radii**2) * np.sin(half) / half
    middle = angles[:-1] + half
    x, y = distance[:, None] * np.cos(middle), distance[:, None] * np.sin(middle)
    types = _nearest(design, x, y) if "feature_points" in design else _drawn(design, x, y)
    types = _walled(types, design["wall_elements"] // 2, span == 360)
    return types, _integrals(types, radii, angles)


def _nearest(design: dict[str, Any], x: np.ndarray, y: np.ndarray) -> np.ndarray:
    points = design["feature_points"]
    away = [(x - a) ** 2 + (y - b) ** 2 for a, b in zip(points["x"], points["y"], strict=True)]
    distances = np.stack(away)
    first = np.argmax(distances <= distances.min(axis=0) + TIE, axis=0)
    return np.asarray(np.array(points["type"])[first])


def _drawn(design: dict[str, Any], x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Ring pieces with sharp corners and circles, by centroid, a later one over an earlier."""
    types = np.zeros(x.shape, dtype=int)
    for chamber in design["drawing"]:
        if "radius" in chamber:
            a, b = chamber["center"]
            inside = (x - a) ** 2 + (y - b) ** 2 < chamber["radius"] ** 2
        else:
            assert not chamber.get("corner")
            (low, high), (first, last) = chamber["r"], chamber["phi"]
            turned = (np.degrees(np.arctan2(y, x)) - first) % 360
            inside = (np.hypot(x, y) > low) & (np.hypot(x, y) < high) & (turned < last - first)
        types[inside] = chamber["supply"]
    return types


def _walled(types: np.ndarray, steps: int, is_ring: bool) -> np.ndarray:
    """Material within so many steps over edges of another supply's elements."""
    walled = types.copy()
    for supply in (1, 2, 3):
        near = (types > 0) & (types != supply)
        for _ in range(steps):
            grown = near.copy()
            grown[1:] |= near[:-1]
            grown[:-1] |= near[1:]
            grown[:, 1:] |= near[:, :-1]
            grown[:, :-1] |= near[:, 1:]
            if is_ring:
                grown[:, 0] |= near[:, -1]
                grown[:, -1] |= near[:, 0]
            near = grown
        walled[near & (types == supply)] = 0
    return walled


def _integrals(types: np.ndarray, radii: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Exact over each sector of a ring: powers of r times sines and cosines."""
    a, b = angles[:-1], angles[1:]
    second, third, fourth = (np.diff(radii**k) / k for k in (2, 3, 4))
    double = (np.sin(2 * b) - np.sin(2 * a)) / 4
    parts = (
        np.outer(second, b - a),
        np.outer(third, np.sin(b) - np.sin(a)),
        np.outer(third, np.cos(a) - np.cos(b)),
        np.outer(fourth, (b - a) / 2 + double),
        np.outer(fourth, (b - a) / 2 - double),
        np.outer(fourth, (np.cos(2 * a) - np.cos(2 * b)) / 4),
    )
    return np.array([[part[types == kind].sum() for part in parts] for kind in range(4)])
