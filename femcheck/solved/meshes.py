"""The two meshes of a check: sections by gmsh, and planes between layers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from beamopt.base.arrays import FloatArray
from femcheck.mesh.extrusion import stations
from femcheck.mesh.gmsh_section import MeshFailure, MeshProblem
from femcheck.mesh.section_mesh import SectionMesh
from femcheck.solved.solid_options import SolidOptions
from femcheck.solved.subject import Subject

__all__ = ["heights_of", "layers_for", "section_meshes"]

COARSER = 1.6  # sizes of the coarse section mesh over those of the standard one
TURN_PER_LAYER = 0.2  # rad; the error of the tip goes with its fourth power: 0.05 % there
LONGEST_LAYER = 3.0  # outer radii; longer ones lock as the penalty grows
FEWEST_LAYERS, MOST_LAYERS = 4, 40


def section_meshes(
    subject: Subject, options: SolidOptions
) -> tuple[SectionMesh, SectionMesh] | MeshFailure:
    """The standard and the coarse section mesh."""
    fatal = subject.fatal
    if fatal is not None:
        return MeshFailure(MeshProblem.FATAL, str(fatal))
    standard = options.mesher.mesh(subject.outline, options.sizes)
    if isinstance(standard, MeshFailure):
        return standard
    sizes = replace(options.sizes, factor=COARSER * options.sizes.factor)
    coarse = options.mesher.mesh(subject.outline, sizes)
    return coarse if isinstance(coarse, MeshFailure) else (standard, coarse)


def heights_of(subject: Subject, options: SolidOptions) -> dict[str, FloatArray]:
    """Planes between layers [mm] of the "standard" and the "coarse" mesh."""
    length = subject.design.actuator.length
    slenderness = length / subject.design.grid.outer_radius
    layers = options.layers or layers_for(subject.largest_turn, slenderness)
    fewer = max(layers - max(layers // 3, 1), 1)
    return {
        mesh: stations(length, count, options.grading)
        for mesh, count in (("standard", layers), ("coarse", fewer))
    }


def layers_for(turn: float, slenderness: float) -> int:
    """Layers for an actuator that the beam says turns by at most `turn` [rad].

    slenderness : length over outer radius.
    """
    needed = max(turn / TURN_PER_LAYER, slenderness / LONGEST_LAYER)
    return int(np.clip(np.ceil(needed), FEWEST_LAYERS, MOST_LAYERS))
