"""Where the body is: positions of its nodes, place and rotation of its tip plate."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from femcheck.solid.body import Body
from femcheck.solid.plate import rotation

__all__ = ["State", "moved", "placed", "rest_state"]

NONE = np.zeros(0)


@dataclass(frozen=True, eq=False)
class State:
    """A configuration of a body.

    x : (n, 3) positions of all nodes [mm]; those of the tip face follow from the plate.
    tip : (3,) position of the tip face's material centroid [mm].
    turn : (3, 3) rotation of the tip plate.
    hydrostatic : (m,) hydrostatic pressure of the mixed form at the corners [kPa], positive in
        tension; empty where there is none.
    """

    x: FloatArray
    tip: FloatArray
    turn: FloatArray
    hydrostatic: FloatArray = field(default_factory=lambda: NONE)


def rest_state(body: Body) -> State:
    """The undeformed body."""
    return State(body.nodes.copy(), body.tip_centre.copy(), np.eye(3))


def placed(
    body: Body, x: FloatArray, tip: FloatArray, turn: FloatArray, hydrostatic: FloatArray = NONE
) -> State:
    """The state with inner nodes at `x`, the base held and the tip face on its plate."""
    at = x.copy()
    at[body.base] = body.nodes[body.base]
    at[body.tip] = tip + (body.nodes[body.tip] - body.tip_centre) @ turn.T
    return State(at, tip, turn, hydrostatic)


def moved(body: Body, state: State, free: IndexArray, step: FloatArray) -> State:
    """The state after a step (3 k + 6 + m,): free nodes (k,), the plate, hydrostatic pressures."""
    x, plate = state.x.copy(), 3 * free.size
    x[free] += step[:plate].reshape(-1, 3)
    tip, turn = state.tip + step[plate : plate + 3], rotation(step[plate + 3 : plate + 6])
    hydrostatic = state.hydrostatic + step[plate + 6 :]
    return placed(body, x, tip, turn @ state.turn, hydrostatic)
