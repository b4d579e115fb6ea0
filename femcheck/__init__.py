"""Check a beam-optimised section as a solid: volume mesh, hyperelastic, under pressure.

    subject = femcheck.Subject("mine", beamopt.load_design("best.json"))
    checked = femcheck.check_design(subject, Path("checked"), femcheck.CheckOptions(), workers=2)
    print(checked.holds, checked.comparison.worst)
    found = femcheck.predict_design(subject, Path("silicone"), femcheck.PredictionOptions())
    print(femcheck.verdict(found), found.safe_box.pressure)
    question = femcheck.Question.of("mine", subject.design, femcheck.PredictionOptions())
    within = femcheck.answer_within(question, 0.1)  # mm; the cheapest model that is near enough
    print(within.ending.value, within.chosen, within.worst)

Units are mm, kPa, and so mN and mN·mm.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from femcheck.accuracy.ending import Within
    from femcheck.accuracy.within import answer_within
    from femcheck.chart.chart import Chart
    from femcheck.chart.run import run_chart
    from femcheck.check.checked import Checked
    from femcheck.check.comparison import Comparison
    from femcheck.check.options import CheckOptions
    from femcheck.check.run import check_design
    from femcheck.check.subject import Subject, sealed_copy, slender_copy
    from femcheck.continuation.outcome import Status
    from femcheck.material.catalogue import law_by_name
    from femcheck.material.fibre import Thread
    from femcheck.material.law import Law
    from femcheck.material.rigid_section import RigidSection
    from femcheck.mesh.geo import SectionSizes
    from femcheck.mesh.gmsh_section import Mesher, MeshFailure, MeshProblem
    from femcheck.models.question import Question
    from femcheck.prediction.options import PredictionOptions
    from femcheck.prediction.prediction import Prediction
    from femcheck.prediction.run import predict_design
    from femcheck.prediction.verdict import verdict
    from femcheck.solid.winding import Wound

_HOMES = {
    "femcheck.accuracy.ending": ("Within",),
    "femcheck.accuracy.within": ("answer_within",),
    "femcheck.chart.chart": ("Chart",),
    "femcheck.chart.run": ("run_chart",),
    "femcheck.check.checked": ("Checked",),
    "femcheck.check.comparison": ("Comparison",),
    "femcheck.check.options": ("CheckOptions",),
    "femcheck.check.run": ("check_design",),
    "femcheck.check.subject": ("Subject", "sealed_copy", "slender_copy"),
    "femcheck.continuation.outcome": ("Status",),
    "femcheck.material.catalogue": ("law_by_name",),
    "femcheck.material.fibre": ("Thread",),
    "femcheck.material.law": ("Law",),
    "femcheck.material.rigid_section": ("RigidSection",),
    "femcheck.mesh.geo": ("SectionSizes",),
    "femcheck.mesh.gmsh_section": ("MeshFailure", "MeshProblem", "Mesher"),
    "femcheck.models.question": ("Question",),
    "femcheck.prediction.options": ("PredictionOptions",),
    "femcheck.prediction.prediction": ("Prediction",),
    "femcheck.prediction.run": ("predict_design",),
    "femcheck.prediction.verdict": ("verdict",),
    "femcheck.solid.winding": ("Wound",),
}

__all__ = [
    "Chart",
    "CheckOptions",
    "Checked",
    "Comparison",
    "Law",
    "MeshFailure",
    "MeshProblem",
    "Mesher",
    "Prediction",
    "PredictionOptions",
    "Question",
    "RigidSection",
    "SectionSizes",
    "Status",
    "Subject",
    "Thread",
    "Within",
    "Wound",
    "answer_within",
    "check_design",
    "law_by_name",
    "predict_design",
    "run_chart",
    "sealed_copy",
    "slender_copy",
    "verdict",
]


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used: nothing heavy is loaded before."""
    for home, names in _HOMES.items():
        if name in names:
            value = getattr(import_module(home), name)
            globals()[name] = value
            return value
    raise AttributeError(f"module 'femcheck' has no attribute {name!r}")
