"""The paper's own boundary-value problem, solved by shooting: an answer independent of the arc.

The Cosserat equations with quaternions, the distributed loads f_p, l_p and the end loads F_i, L_i
as the paper prints them (Geometrically exact beam models, Pressure loads), in the principal frame
about the material centroid. With h' = R v, for R maps local to global, as its other equations need.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import root

E3 = np.array([0.0, 0.0, 1.0])


def rotation(q: np.ndarray) -> np.ndarray:
    """Rotation matrix, local to global, of a quaternion (w, x, y, z) of any length."""
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion_rate(q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Q' = ½ q ∘ (0, u) for the local curvature u."""
    w, v = q[0], q[1:]
    return np.concatenate([[-v @ u], w * u + np.cross(v, u)]) / 2


def shoot(
    stiffness: tuple[np.ndarray, np.ndarray],
    forces: np.ndarray,
    lever_arms: np.ndarray,
    length: float,
) -> np.ndarray:
    """Tip position in the principal frame [mm].

    stiffness : diagonals of K [mN] and J [mN·mm²].
    forces : (3,) P_i A_i [mN]. lever_arms : (3, 3) r_i [mm].
    """
    K, J = stiffness

    def local_strains(y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        R = rotation(y[3:7])
        v = (R.T @ y[7:10]) / K + E3
        u = (R.T @ y[10:13]) / J
        return R, v, u

    def rates(_s: float, y: np.ndarray) -> np.ndarray:
        R, v, u = local_strains(y)
        turned = np.cross(u, E3)  # R' e3 = R (u × e3)
        f_p = -forces.sum() * (R @ turned)
        l_p = -sum(
            force * (R @ (np.cross(v + np.cross(u, r), E3) + np.cross(r, turned)))
            for force, r in zip(forces, lever_arms, strict=True)
        )
        h_rate = R @ v
        return np.concatenate(
            [h_rate, quaternion_rate(y[3:7], u), -f_p, -np.cross(h_rate, y[7:10]) - l_p]
        )

    moments = np.cross(lever_arms, forces[:, None] * E3).sum(axis=0)
    scale = np.concatenate([np.full(3, K[2]), np.full(3, J[:2].max() / length)])

    def end_state(start: np.ndarray) -> np.ndarray:
        y0 = np.concatenate([np.zeros(3), [1.0, 0, 0, 0], start * scale])
        solution = solve_ivp(rates, (0, length), y0, method="DOP853", rtol=1e-13, atol=1e-11)
        return np.asarray(solution.y[:, -1])

    def mismatch(start: np.ndarray) -> np.ndarray:
        y = end_state(start)
        R = rotation(y[3:7])
        wanted = np.concatenate([R @ (forces.sum() * E3), R @ moments])
        return (y[7:] - wanted) / scale

    # away from the answer on purpose: the shooting has to find the equilibrium
    guess = 0.95 * np.concatenate([forces.sum() * E3, moments]) / scale
    found = root(mismatch, guess, method="hybr", options={"xtol": 1e-14})
    worst = np.abs(found.fun).max()
    assert worst < 1e-11, f"{found.message} {worst}"
    return end_state(found.x)[:3]
