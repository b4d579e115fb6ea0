"""Bodies of about as many unknowns as asked for, a bent state of theirs, and a law.

All on the hand-made three-chamber section; the assembly and the comparison with FElupe use them.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from femcheck.material.neo_hookean import NeoHookean
from femcheck.mesh.extrusion import extrude, stations
from femcheck.solid.body import Body, discretise
from femcheck.solid.plate import rotation
from femcheck.solid.state import State, placed
from tests.bench.solid_cases import LENGTH
from tests.femcheck.ring_section import ring_section

__all__ = ["PARTS", "bent", "body_of", "compressible", "free_part"]

PARTS = {"wedge18": 2, "tet10": 2, "hex27": 1}
"""How finely the section's cells are cut: hexahedra have six times the nodes a triangle."""


def compressible(mu: float = 100.0, lmbda: float = 1000.0) -> NeoHookean:
    """μ/2 (tr C − 3) − μ ln J + λ/2 (ln J)² in displacements alone, by Lamé's constants [kPa].

    It is FElupe's NeoHookeCompressible.
    """
    E = mu * (3 * lmbda + 2 * mu) / (lmbda + mu)
    return NeoHookean(E, lmbda / (2 * (lmbda + mu)), mixed=False)


def body_of(element: str, dofs: int) -> Body:
    """The body with as many layers as bring it nearest to `dofs` = 3 × nodes."""
    section = ring_section(PARTS[element])
    one, two = (len(_body(section, element, layers).nodes) for layers in (1, 2))
    return _body(section, element, max(round((dofs / 3 - one) / (two - one)), 0) + 1)


def _body(section: Any, element: str, layers: int) -> Body:
    return discretise(extrude(section, stations(LENGTH, layers)), element)


def bent(body: Body) -> State:
    """A state like that of an inflated actuator: bent by 0.6 rad, stretched, a little creased."""
    angle, stretch = 0.6, 1.05
    s = body.nodes[:, 2] / LENGTH
    theta, radius = angle * s, stretch * LENGTH / angle
    x, y = body.nodes[:, 0] - body.tip_centre[0], body.nodes[:, 1]
    arm = radius - x
    at = np.stack([radius - arm * np.cos(theta), y, arm * np.sin(theta)], axis=1)
    at[:, 0] += body.tip_centre[0]
    at += 0.02 * np.sin(3 * body.nodes[:, [1, 2, 0]])
    tip = np.array([radius * (1 - np.cos(angle)), 0, radius * np.sin(angle)]) + body.tip_centre
    tip[2] -= LENGTH
    return placed(body, at, tip, rotation(np.array([0, angle, 0])))


def free_part(body: Body, matrix: Any) -> Any:
    """Rows and columns of the nodes between both faces, of a matrix by all nodes."""
    held = np.union1d(body.base, body.tip)
    free = np.setdiff1d(np.arange(len(body.nodes)), held)
    kept = (3 * free[:, None] + np.arange(3)).ravel()
    return matrix.tocsr()[kept][:, kept]
