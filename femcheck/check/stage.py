"""The solids that a check solves, and which of them follows which."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from femcheck.check.case import Solid

__all__ = ["Stage", "layers_for"]

TURN_PER_LAYER = 0.2  # rad; the error of the tip goes with its fourth power: 0.05 % there
LONGEST_LAYER = 3.0  # outer radii; longer ones lock as the penalty grows
FEWEST_LAYERS, MOST_LAYERS = 4, 40


@dataclass(frozen=True, eq=False)
class Stage:
    """A solid at all pressure combinations.

    mesh : "standard" or "coarse". penalty : c of the law; NaN for a law without.
    follows : name of the stage whose results at the same pressures are a first guess; or None.
    """

    solid: Solid
    mesh: str
    penalty: float
    follows: str | None = None

    @property
    def name(self) -> str:
        """Its solid's name."""
        return self.solid.name


def layers_for(turn: float, slenderness: float) -> int:
    """Layers for an actuator that the beam says turns by at most `turn` [rad].

    slenderness : length over outer radius.
    """
    needed = max(turn / TURN_PER_LAYER, slenderness / LONGEST_LAYER)
    return int(np.clip(np.ceil(needed), FEWEST_LAYERS, MOST_LAYERS))
