"""What tips should be: at which pressures, how much each counts, which way they point."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.target.workspace import NODES, Workspace

__all__ = ["Aim", "aim_of_workspace"]


@dataclass(frozen=True, eq=False)
class Aim:
    """Pairs of pressures and tips, with weights; what the loss L is measured against.

    Parameters
    ----------
    pressures : (n, 3) [kPa].
    tips : (n, 3) wanted tips, from the base's material centroid [mm].
    weights : (n,) of the squared distances; 1 each in the paper.
    directions : (n, 3) wanted unit tangents of the tip's axis; anything where they do not count.
    direction_weights : (n,) of the squared differences of the tangents [mm²]; 0: does not count.
    paths : (m, 3) points [mm] that the tip should reach at some pressures, whichever.
    path_weight : of their squared distances.

    Raises
    ------
    ValueError : shapes that do not fit, values that are not finite, or negative weights.
    """

    pressures: FloatArray
    tips: FloatArray
    weights: FloatArray = field(default_factory=lambda: np.ones(NODES))
    directions: FloatArray = field(default_factory=lambda: np.zeros((NODES, 3)))
    direction_weights: FloatArray = field(default_factory=lambda: np.zeros(NODES))
    paths: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    path_weight: float = 1.0

    def __post_init__(self) -> None:
        n, m = len(self.pressures), len(self.paths)
        shapes: dict[str, tuple[int, ...]]
        shapes = {"pressures": (n, 3), "tips": (n, 3), "directions": (n, 3), "paths": (m, 3)}
        for name, shape in (shapes | {"weights": (n,), "direction_weights": (n,)}).items():
            array = getattr(self, name)
            if array.shape != shape or not np.isfinite(array).all():
                raise ValueError(f"{name}: finite and of shape {shape}, not {array.shape}")
        if min(self.weights.min(initial=0), self.direction_weights.min(initial=0)) < 0:
            raise ValueError("weights and direction_weights: at least 0")
        if not 0 <= self.path_weight < np.inf:
            raise ValueError("path_weight: finite and at least 0")

    def __len__(self) -> int:
        return len(self.pressures)

    @cached_property
    def turns(self) -> bool:
        """Whether any tip should point anywhere."""
        return bool(self.direction_weights.any())

    @property
    def has_paths(self) -> bool:
        """Whether there are points to reach at whichever pressures."""
        return len(self.paths) > 0

    def loss(
        self,
        tips: FloatArray,
        directions: FloatArray | None = None,
        squares: FloatArray | None = None,
    ) -> FloatArray:
        """L = Σ w_j |h_j − t_j|² + Σ ω_j |d_j − d*_j|² + path_weight · Σ_q |h(p_q) − q|² [mm²].

        Parameters
        ----------
        tips : (…, n, 3) h_j [mm] (paper, First Objective).
        directions : (…, n, 3) unit tangents d_j of the tips' axis; needed where `turns`.
        squares : (…, m) squared distances of the paths' points from the nearest tip [mm²]; needed
            where `has_paths`.

        Returns
        -------
        (…)

        Raises
        ------
        ValueError : directions or squares that are needed are not given.
        """
        parts = self.weights[:, None] * (tips - self.tips) ** 2
        total = np.asarray(parts.sum(axis=(-2, -1)))
        if self.turns:
            if directions is None:
                raise ValueError("directions: this aim counts them")
            parts = self.direction_weights[:, None] * (directions - self.directions) ** 2
            total = total + parts.sum(axis=(-2, -1))
        if self.has_paths:
            if squares is None:
                raise ValueError("squares: this aim has paths")
            total = total + self.path_weight * squares.sum(axis=-1)
        return np.asarray(total)

    def settled(self, pressures: FloatArray) -> Aim:
        """The same without paths, their points as rows at the pressures (m, 3) [kPa].

        Where those are the best pressures of a section, both aims' losses have the same gradient
        by the section: of L = min_p f(section, p) it is ∂f/∂section at fixed p, also where p is
        held at the ends of its range.
        """
        m = len(self.paths)
        return Aim(
            np.concatenate([self.pressures, pressures]),
            np.concatenate([self.tips, self.paths]),
            np.concatenate([self.weights, np.full(m, self.path_weight)]),
            np.concatenate([self.directions, np.zeros((m, 3))]),
            np.concatenate([self.direction_weights, np.zeros(m)]),
        )

    def rms_distance(self, loss: float) -> float:
        """Root mean square distance [mm] that belongs to a loss L [mm²]: √(L/Σ weights).

        What directions add to L counts as distance.
        """
        counted = float(self.weights.sum()) + self.path_weight * len(self.paths)
        return float(np.sqrt(loss / (counted if counted > 0 else float(len(self)))))


def aim_of_workspace(workspace: Workspace) -> Aim:
    """The paper's: 27 tips that count alike."""
    return Aim(workspace.pressures, workspace.tips)
