"""Cross-sections of slender soft pneumatic actuators, found for a target workspace.

    scene = beamopt.load_scene("hand-drawn-section")
    result = beamopt.optimize(scene)
    print(result.best.section.pieces, result.best.workspace.tips)
    result.best.save("best.json")

Units are mm, kPa, and so mN and mN·mm.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from beamopt.bound.certificate import Certificate, certificate
    from beamopt.bundled import bundled_scenes
    from beamopt.design import Design, load_design
    from beamopt.errors import InputError
    from beamopt.evolve.algorithm import Generation, GeneticAlgorithm
    from beamopt.evolve.run import run
    from beamopt.evolve.stopping import StopReason
    from beamopt.judge import Judge, Status, Verdict
    from beamopt.optimisation import optimize
    from beamopt.outline.faults import Fault, FaultKind, Severity
    from beamopt.pareto.front import Front
    from beamopt.pareto.run import find_front
    from beamopt.plot.figures import design_figure
    from beamopt.refinement import Refinement, refine_design
    from beamopt.result import Optimisation
    from beamopt.rod.response import LinearResponse, Response, linear_response
    from beamopt.scene import Scene, load_scene
    from beamopt.section.cross_section import CrossSection
    from beamopt.section.feature_points import FeaturePoints
    from beamopt.section.grid import PolarGrid
    from beamopt.section.seal import SealRules
    from beamopt.study.plan import Plan
    from beamopt.study.run import run_study
    from beamopt.target import Target
    from beamopt.workspace import Workspace

_HOMES = {
    "beamopt.bound.certificate": ("Certificate", "certificate"),
    "beamopt.bundled": ("bundled_scenes",),
    "beamopt.design": ("Design", "load_design"),
    "beamopt.errors": ("InputError",),
    "beamopt.evolve.algorithm": ("Generation", "GeneticAlgorithm"),
    "beamopt.evolve.run": ("run",),
    "beamopt.evolve.stopping": ("StopReason",),
    "beamopt.judge": ("Judge", "Status", "Verdict"),
    "beamopt.optimisation": ("optimize",),
    "beamopt.outline.faults": ("Fault", "FaultKind", "Severity"),
    "beamopt.pareto.front": ("Front",),
    "beamopt.pareto.run": ("find_front",),
    "beamopt.plot.figures": ("design_figure",),
    "beamopt.refinement": ("Refinement", "refine_design"),
    "beamopt.result": ("Optimisation",),
    "beamopt.rod.response": ("LinearResponse", "Response", "linear_response"),
    "beamopt.scene": ("Scene", "load_scene"),
    "beamopt.section.cross_section": ("CrossSection",),
    "beamopt.section.feature_points": ("FeaturePoints",),
    "beamopt.section.grid": ("PolarGrid",),
    "beamopt.section.seal": ("SealRules",),
    "beamopt.study.plan": ("Plan",),
    "beamopt.study.run": ("run_study",),
    "beamopt.target": ("Target",),
    "beamopt.workspace": ("Workspace",),
}

__all__ = [
    "Certificate",
    "CrossSection",
    "Design",
    "Fault",
    "FaultKind",
    "FeaturePoints",
    "Front",
    "Generation",
    "GeneticAlgorithm",
    "InputError",
    "Judge",
    "LinearResponse",
    "Optimisation",
    "Plan",
    "PolarGrid",
    "Refinement",
    "Response",
    "Scene",
    "SealRules",
    "Severity",
    "Status",
    "StopReason",
    "Target",
    "Verdict",
    "Workspace",
    "bundled_scenes",
    "certificate",
    "design_figure",
    "find_front",
    "linear_response",
    "load_design",
    "load_scene",
    "optimize",
    "refine_design",
    "run",
    "run_study",
]


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used: the command line starts without numerics."""
    if name == "__version__":
        from importlib.metadata import version

        return version("beamopt")
    for home, names in _HOMES.items():
        if name in names:
            value = getattr(import_module(home), name)
            globals()[name] = value
            return value
    raise AttributeError(f"module 'beamopt' has no attribute {name!r}")
