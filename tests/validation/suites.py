"""The suites by name."""

from __future__ import annotations

from collections.abc import Callable

from tests.validation import (
    accuracy,
    arc,
    genotypes,
    geometry,
    material,
    memory,
    never_worse,
    published_solids,
    refinement,
    regression,
    resume,
    rods,
    sections,
    solid,
    symmetry,
)
from tests.validation.check import Check

__all__ = ["SUITES"]

SUITES: dict[str, Callable[[bool], list[Check]]] = {
    "arc": arc.checks,
    "genotypes": genotypes.checks,
    "geometry": geometry.checks,
    "sections": sections.checks,
    "symmetry": symmetry.checks,
    "resume": resume.checks,
    "solid": solid.checks,
    "material": material.checks,
    "published-solids": published_solids.checks,
    "rods": rods.checks,
    "accuracy": accuracy.checks,
    "regression": regression.checks,
    "refinement": refinement.checks,
    "never-worse": never_worse.checks,
    "memory": memory.checks,
}
