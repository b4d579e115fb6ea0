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

from beamopt.base.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
