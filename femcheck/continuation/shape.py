"""A state as what can be added up: strains between planes and the warping of each plane.

Positions of a bending actuator do not extrapolate: they follow circles. Its strains do. A state is
taken apart into the rigid motion from each plane of nodes to the next, seen from the first, and
what deforms each plane in its own frame; shapes are vectors that may be combined linearly, and are
put together again along the actuator.
"""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from femcheck.solid.body import Body
from femcheck.solid.plate import rotation
from femcheck.solid.state import State, placed

__all__ = ["Shapes"]


class Shapes:
    """Taking the states of one body apart and putting them together."""

    def __init__(self, body: Body) -> None:
        self._body = body
        heights = np.round(body.nodes[:, 2], 6)
        levels, plane = np.unique(heights, return_inverse=True)
        order = np.argsort(plane, kind="stable")
        ends = np.cumsum(np.bincount(plane))[:-1]
        self._planes: list[IndexArray] = np.split(order, ends)
        centre = body.tip_centre[:2]
        self._origins = np.column_stack([np.tile(centre, (levels.size, 1)), levels])
        flat = body.nodes - self._origins[plane]
        self._flat = flat

    def of(self, state: State) -> FloatArray:
        """Turns and moves from plane to plane, then every node's warping, then pressures."""
        turns, moves = [], []
        warping = np.empty_like(state.x)
        R_before, h_before = np.eye(3), self._origins[0]
        for k, nodes in enumerate(self._planes):
            R, h = _rigid_motion(self._flat[nodes], state.x[nodes])
            warping[nodes] = (state.x[nodes] - h) @ R - self._flat[nodes]
            if k > 0:
                step = self._origins[k] - self._origins[k - 1]
                turns.append(_vector(R_before.T @ R))
                moves.append(R_before.T @ (h - h_before) - step)
            R_before, h_before = R, h
        return np.concatenate(
            [np.ravel(turns), np.ravel(moves), warping.ravel(), state.hydrostatic]
        )

    def axis(self, state: State) -> FloatArray:
        """(k, 4) z [mm], ε, κ1, κ2 [1, 1/mm, 1/mm] of the rod that the planes of nodes make.

        Strains from each plane to the next, as of a Cosserat rod: R' = R [κ]×, h' = (1 + ε) R e3;
        z is halfway between the undeformed planes, h follows the section's material centroid.
        """
        heights = self._origins[:, 2]
        steps = np.diff(heights)
        count = 3 * steps.size
        shape = self.of(state)
        turns, moves = shape[:count].reshape(-1, 3), shape[count : 2 * count].reshape(-1, 3)
        middle = (heights[1:] + heights[:-1]) / 2
        chords = moves + np.column_stack([np.zeros((steps.size, 2)), steps])
        stretch = _unrolled(turns, chords)[:, 2] / steps - 1
        return np.column_stack([middle, stretch, turns[:, :2] / steps[:, None]])

    def state(self, shape: FloatArray) -> State:
        """The state of a shape; the base is held and the tip face plane, whatever its warping."""
        count = 3 * (len(self._planes) - 1)
        turns, moves = (part.reshape(-1, 3) for part in np.split(shape[: 2 * count], 2))
        rest = shape[2 * count :]
        warping, hydrostatic = rest[: self._flat.size].reshape(-1, 3), rest[self._flat.size :]
        x = np.empty_like(self._body.nodes)
        R, h = np.eye(3), self._origins[0]
        for k, nodes in enumerate(self._planes):
            if k > 0:
                h = h + R @ (moves[k - 1] + self._origins[k] - self._origins[k - 1])
                R = R @ rotation(turns[k - 1])
            x[nodes] = h + (self._flat[nodes] + warping[nodes]) @ R.T
        return placed(self._body, x, h, R, hydrostatic)


def _rigid_motion(flat: FloatArray, now: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Rotation, and place of the reference point, of a plane's nearest rigid motion (Kabsch)."""
    middle, there = flat.mean(axis=0), now.mean(axis=0)
    U, _, Vt = np.linalg.svd((flat - middle).T @ (now - there))
    mirror = np.sign(np.linalg.det(Vt.T @ U.T))
    R = Vt.T @ np.diag([1.0, 1.0, mirror]) @ U.T
    return R, there - R @ middle


def _unrolled(turns: FloatArray, chords: FloatArray) -> FloatArray:
    """(k, 3) ∫ Rᵀ h' along helices that end at `chords`, turned by `turns` [rad]."""
    angle = np.linalg.norm(turns, axis=1, keepdims=True)
    half = angle / 2
    factor = np.full_like(angle, 1 / 12)
    np.divide(1 - half / np.tan(half + (half == 0)), angle**2, out=factor, where=angle > 1e-3)
    across = np.cross(turns, chords)
    return np.asarray(chords - across / 2 + factor * np.cross(turns, across))


def _vector(R: FloatArray) -> FloatArray:
    """Rotation vector of a rotation matrix by less than half a turn."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_matrix(R).as_rotvec())
