"""A discretised piece of material: nodes, gradients at quadrature points, wall facets."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from femcheck.solid.facets import FacetShape

__all__ = ["Continuum"]


@dataclass(frozen=True, eq=False)
class Continuum:
    """What energy, forces and stiffness are summed over; arrays over scikit-fem's.

    Parameters
    ----------
    nodes : (n, 3) undeformed positions [mm].
    connectivity : (e, a) nodes of each element, its corners first.
    gradients : (e, q, 3, a) undeformed gradients of the shape functions [1/mm].
    weights : (e, q) volumes that belong to the quadrature points [mm³].
    walls : (f, b) nodes of each wall facet of a chamber.
    wall_supply : (f,) 1…3.
    facet : shape functions of a wall facet.
    corner_values : (q, c) linear functions of the corners at the quadrature points.
    has_pair : whether a hydrostatic pressure in these functions makes a stable pair.
    """

    nodes: FloatArray
    connectivity: IndexArray
    gradients: FloatArray
    weights: FloatArray
    walls: IndexArray
    wall_supply: IndexArray
    facet: FacetShape
    corner_values: FloatArray
    has_pair: bool

    @cached_property
    def size(self) -> float:
        """Its largest extent [mm]."""
        return float(np.ptp(self.nodes, axis=0).max())

    @cached_property
    def corner_nodes(self) -> IndexArray:
        """(m,) nodes that are a corner of an element: where the hydrostatic pressure lives."""
        return np.unique(self.connectivity[:, : self.corner_values.shape[1]])

    @cached_property
    def corners(self) -> IndexArray:
        """(e, c) each element's corners by their place among `corner_nodes`."""
        of_element = self.connectivity[:, : self.corner_values.shape[1]]
        return np.searchsorted(self.corner_nodes, of_element)

    @cached_property
    def places(self) -> FloatArray:
        """(e, q, 3) undeformed positions of the quadrature points of straight elements [mm]."""
        corners = self.nodes[self.connectivity[:, : self.corner_values.shape[1]]]
        return np.asarray(np.einsum("qc,ecx->eqx", self.corner_values, corners))
