"""What tips should be: at which pressures, how much each counts, which way they point."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from beamopt.arrays import FloatArray
from beamopt.workspace import NODES, Workspace

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

    Raises
    ------
    ValueError : shapes that do not fit, values that are not finite, or negative weights.
    """

    pressures: FloatArray
    tips: FloatArray
    weights: FloatArray = field(default_factory=lambda: np.ones(NODES))
    directions: FloatArray = field(default_factory=lambda: np.zeros((NODES, 3)))
    direction_weights: FloatArray = field(default_factory=lambda: np.zeros(NODES))

    def __post_init__(self) -> None:
        n = len(self.pressures)
        shapes = {"pressures": (n, 3), "tips": (n, 3), "directions": (n, 3)}
        for name, shape in (shapes | {"weights": (n,), "direction_weights": (n,)}).items():
            array = getattr(self, name)
            if array.shape != shape or not np.isfinite(array).all():
                raise ValueError(f"{name}: finite and of shape {shape}, not {array.shape}")
        if min(self.weights.min(initial=0), self.direction_weights.min(initial=0)) < 0:
            raise ValueError("weights and direction_weights: at least 0")

    def __len__(self) -> int:
        return len(self.pressures)

    @cached_property
    def turns(self) -> bool:
        """Whether any tip should point anywhere."""
        return bool(self.direction_weights.any())

    def loss(self, tips: FloatArray) -> FloatArray:
        """L = Σ w_j |h_j − t_j|² of tips (…, n, 3) → (…) [mm²] (paper, First Objective)."""
        squares = self.weights[:, None] * (tips - self.tips) ** 2
        return np.asarray(squares.sum(axis=(-2, -1)))


def aim_of_workspace(workspace: Workspace) -> Aim:
    """The paper's: 27 tips that count alike."""
    return Aim(workspace.pressures, workspace.tips)
