"""Cross-sections of slender soft pneumatic actuators, found for a target workspace.

    scene = beamopt.load_scene("hand-drawn-section")
    result = beamopt.optimize(scene)
    print(result.best.section.pieces, result.best.workspace.tips)
    result.best.save("best.json")

Units are mm, kPa, and so mN and mN·mm.
"""

from __future__ import annotations

from beamopt.base.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
