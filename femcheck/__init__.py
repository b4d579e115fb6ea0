"""Check a beam-optimised section as a solid: volume mesh, hyperelastic, under pressure.

    subject = femcheck.Subject("mine", beamopt.load_design("best.json"))
    checked = femcheck.check_design(subject, Path("checked"), femcheck.CheckOptions(), workers=2)
    print(checked.holds, checked.comparison.worst)

Units are mm, kPa, and so mN and mN·mm.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from femcheck.check.checked import Checked
    from femcheck.check.comparison import Comparison
    from femcheck.check.options import CheckOptions
    from femcheck.check.run import check_design
    from femcheck.check.subject import Subject, sealed_copy
    from femcheck.continuation.outcome import Status
    from femcheck.material.law import Law
    from femcheck.material.rigid_section import RigidSection
    from femcheck.mesh.geo import SectionSizes
    from femcheck.mesh.gmsh_section import Mesher, MeshFailure, MeshProblem

_HOMES = {
    "femcheck.check.checked": ("Checked",),
    "femcheck.check.comparison": ("Comparison",),
    "femcheck.check.options": ("CheckOptions",),
    "femcheck.check.run": ("check_design",),
    "femcheck.check.subject": ("Subject", "sealed_copy"),
    "femcheck.continuation.outcome": ("Status",),
    "femcheck.material.law": ("Law",),
    "femcheck.material.rigid_section": ("RigidSection",),
    "femcheck.mesh.geo": ("SectionSizes",),
    "femcheck.mesh.gmsh_section": ("MeshFailure", "MeshProblem", "Mesher"),
}

__all__ = [
    "CheckOptions",
    "Checked",
    "Comparison",
    "Law",
    "MeshFailure",
    "MeshProblem",
    "Mesher",
    "RigidSection",
    "SectionSizes",
    "Status",
    "Subject",
    "check_design",
    "sealed_copy",
]


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used: nothing heavy is loaded before."""
    for home, names in _HOMES.items():
        if name in names:
            value = getattr(import_module(home), name)
            globals()[name] = value
            return value
    raise AttributeError(f"module 'femcheck' has no attribute {name!r}")
