"""Where the body is: positions of its nodes, place and rotation of its tip plate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beamopt.arrays import FloatArray, IndexArray
from femcheck.solid.body import Body
from femcheck.solid.plate import rotation

__all__ = ["State", "moved", "placed", "rest_state"]


@dataclass(frozen=True, eq=False)
class State:
    """A configuration of a body.

    x : (n, 3) positions of all nodes [mm]; those of the tip face follow from the plate.
    tip : (3,) position of the tip face's material centroid [mm].
    turn : (3, 3) rotation of the tip plate.
    """

    x: FloatArray
    tip: FloatArray
    turn: FloatArray


def rest_state(body: Body) -> State:
    """The undeformed body."""
    return State(body.nodes.copy(), body.tip_centre.copy(), np.eye(3))


def placed(body: Body, x: FloatArray, tip: FloatArray, turn: FloatArray) -> State:
    """The state with inner nodes at `x`, the base held and the tip face on its plate."""
    at = x.copy()
    at[body.base] = body.nodes[body.base]
    at[body.tip] = tip + (body.nodes[body.tip] - body.tip_centre) @ turn.T
    return State(at, tip, turn)


def moved(body: Body, state: State, free: IndexArray, step: FloatArray, plate: FloatArray) -> State:
    """The state after moving the nodes `free` (k,) by `step` (k, 3) and the plate by (6,)."""
    x = state.x.copy()
    x[free] += step
    return placed(body, x, state.tip + plate[:3], rotation(plate[3:]) @ state.turn)
