"""FElupe's view of our 27-node hexahedra; only where `installed()`."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from femcheck.material.neo_hookean import NeoHookean
from femcheck.solid.body import Body

__all__ = ["condensed", "installed", "solid", "three_fields", "version", "wall_pressure"]

BULK = 5000.0
"""[kPa] of the nearly incompressible forms; what they cost does not depend on it."""


def installed() -> bool:
    return find_spec("felupe") is not None


def version() -> str:
    import felupe

    return str(felupe.__version__)


def solid(body: Body, x: FloatArray, law: NeoHookean) -> tuple[Any, Any]:
    """SolidBody in the law and its field; the nodes are at x (n, 3) [mm]."""
    import felupe

    field = felupe.FieldContainer([felupe.Field(_region(body), dim=3)])
    field[0].values[:] = x - body.nodes
    material = felupe.NeoHookeCompressible(law.shear_modulus, law.volumetric_modulus)
    return felupe.SolidBody(material, field), field


def three_fields(body: Body, x: FloatArray, mu: float) -> tuple[Any, Any]:
    """SolidBody in displacement, pressure and volume ratio, which are linear on an element.

    Pressure and ratio are FElupe's default for this region: not continuous. μ [kPa].
    """
    import felupe

    field = felupe.FieldsMixed(_region(body), n=3)
    field[0].values[:] = x - body.nodes
    material = felupe.NearlyIncompressible(felupe.NeoHookeCompressible(mu), BULK)
    return felupe.SolidBody(material, field), field


def condensed(body: Body, x: FloatArray, mu: float) -> tuple[Any, Any]:
    """SolidBodyNearlyIncompressible: pressure and ratio constant on an element, condensed."""
    import felupe

    field = felupe.FieldContainer([felupe.Field(_region(body), dim=3)])
    field[0].values[:] = x - body.nodes
    return felupe.SolidBodyNearlyIncompressible(felupe.NeoHooke(mu), field, bulk=BULK), field


def wall_pressure(body: Body, x: FloatArray, walls: IndexArray, pressure: float) -> tuple[Any, Any]:
    """SolidBodyPressure on the faces whose nodes are among `walls` (f, 9), and its field.

    Raises
    ------
    ValueError : FElupe finds another number of faces.
    """
    import felupe

    on_wall = np.zeros(len(body.nodes), dtype=np.bool_)
    on_wall[walls] = True
    region = felupe.RegionTriQuadraticHexahedronBoundary(_mesh(body), mask=on_wall)
    if len(region.mesh.cells) != len(walls):
        raise ValueError(f"{len(region.mesh.cells)} faces for {len(walls)} facets")
    field = felupe.FieldContainer([felupe.Field(region, dim=3)])
    field[0].values[:] = x - body.nodes
    return felupe.SolidBodyPressure(field, pressure), field


def _region(body: Body) -> Any:
    import felupe

    return felupe.RegionTriQuadraticHexahedron(_mesh(body))


def _mesh(body: Body) -> Any:
    import felupe
    from skfem import ElementHex2

    theirs = felupe.element.TriQuadraticHexahedron().points
    ours = 2 * ElementHex2().doflocs - 1
    order = [int(np.abs(ours - place).sum(axis=1).argmin()) for place in theirs]
    return felupe.Mesh(body.nodes, body.connectivity[:, order], "hexahedron27")
