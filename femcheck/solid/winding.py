"""Thread wound round chambers or round the actuator: circumferential fibres bonded to a surface."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from femcheck.assembly.fibres import add_fibre_forces, add_fibre_stiffness, fibre_vectors
from femcheck.assembly.pattern import Pattern, places_in
from femcheck.material.fibre import Thread
from femcheck.mesh.extrusion import Extrusion
from femcheck.solid.body import Body, surface_facets
from femcheck.solid.elements import ELEMENTS

__all__ = ["Winding", "Wound", "wind"]


class Wound(Enum):
    """What is wound; the value is the name that files and the command line use.

    Examples
    --------
    >>> import femcheck
    >>> [wound.value for wound in femcheck.Wound]
    ['chambers', 'outer', 'both']
    """

    CHAMBERS = "chambers"
    OUTER = "outer"
    BOTH = "both"


@dataclass(frozen=True, eq=False)
class Winding:
    """Fibres on facets of one body.

    Parameters
    ----------
    thread : what pulls.
    facets : (f, b) nodes.
    gradients : (f, g, b) derivative of the shape functions along the undeformed fibre [1/mm].
    areas : (f, g) undeformed areas of the points [mm²].
    """

    thread: Thread
    facets: IndexArray
    gradients: FloatArray
    areas: FloatArray

    def vectors(self, x: FloatArray) -> FloatArray:
        """(f, g, 3) deformed unit vectors of the fibres."""
        out = np.empty((*self.areas.shape, 3))
        fibre_vectors(x, self.facets, self.gradients, out)
        return out

    def strains(self, x: FloatArray) -> FloatArray:
        """(f, g) stretch less one."""
        return np.asarray(np.linalg.norm(self.vectors(x), axis=2) - 1)

    def energy(self, x: FloatArray) -> float:
        """What the threads have stored [mN mm]."""
        return float((self.areas * self.thread.energy(self.strains(x))).sum())

    def add_forces(self, x: FloatArray, forces: FloatArray) -> None:
        """Add the derivative of the energy to the forces (n, 3) [mN]."""
        vectors = self.vectors(x)
        strain = np.linalg.norm(vectors, axis=2) - 1
        tension = self.areas * self.thread.tension(strain)
        add_fibre_forces(self.facets, self.gradients, vectors, tension, forces)

    def add_stiffness(self, x: FloatArray, pattern: Pattern, data: FloatArray) -> None:
        """Add the second derivative of the energy to the upper triangle of a pattern."""
        vectors = self.vectors(x)
        strain = np.linalg.norm(vectors, axis=2) - 1
        blocks, places = pattern.blocks[self.facets], places_in(pattern, self.facets)
        tension = self.areas * self.thread.tension(strain)
        slope = self.areas * self.thread.slope(strain)
        add_fibre_stiffness(
            self.gradients, vectors, tension, slope, blocks, places, pattern.starts, data
        )


def wind(body: Body, where: Wound, thread: Thread) -> Winding:
    """Wind thread along the section's contour on the walls of an actuator's chambers, or outside.

    The fibres follow the contour at constant height. The thread on a wall works as a membrane
    without stiffness along the axis or in shear.
    """
    extrusion = body.extrusion
    chosen = np.zeros(extrusion.supply.size, dtype=np.bool_)
    if where in (Wound.CHAMBERS, Wound.BOTH):
        chosen |= extrusion.supply > 0
    if where in (Wound.OUTER, Wound.BOTH):
        chosen |= _is_outside(extrusion)
    choice = ELEMENTS[body.element]
    facets, _, shape = surface_facets(extrusion, choice, body.nodes, chosen)
    X = body.nodes[facets]
    along, across = (np.einsum("gb,fbx->fgx", part, X) for part in (shape.along, shape.across))
    areas = np.linalg.norm(np.cross(along, across), axis=2)
    # the fibre is level: α X,s + β X,t has no part along the axis, and length one
    alpha, beta = across[..., 2].copy(), -along[..., 2].copy()
    fibre = alpha[..., None] * along + beta[..., None] * across
    length = np.linalg.norm(fibre, axis=2)
    alpha, beta = alpha / length, beta / length
    gradients = alpha[..., None] * shape.along + beta[..., None] * shape.across
    return Winding(thread, facets, np.ascontiguousarray(gradients), areas * shape.weights)


def _is_outside(extrusion: Extrusion) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """(w,) boundary quadrangles on the outer contour: their normal leaves the ring's axis."""
    a, b = (extrusion.points[extrusion.walls[:, k], :2] for k in (0, 1))
    edge, middle = b - a, (a + b) / 2
    leaves = edge[:, 1] * middle[:, 0] - edge[:, 0] * middle[:, 1] > 0
    return np.asarray((extrusion.supply == 0) & leaves)
