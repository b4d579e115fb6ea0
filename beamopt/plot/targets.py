"""What of a target and of a design's answer to it is drawn."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import NoEquilibriumError
from beamopt.plot.workspace import Dots, FollowedTrajectories
from beamopt.reach.reach import reach
from beamopt.scene.design import Design
from beamopt.target.aim import Aim
from beamopt.target.target import Target
from beamopt.target.workspace import Workspace

__all__ = ["answered", "asked", "following"]


def asked(target: Target | None) -> Workspace | Dots | None:
    """The target's tips: a workspace where they are one; None where there are none."""
    if target is None or target.workspace is not None:
        return None if target is None else target.workspace
    aim = target.aim
    return Dots(aim.pressures, aim.tips, _counted(aim, aim.directions)) if len(aim) else None


def answered(design: Design, target: Target | None) -> Workspace | Dots:
    """The design's workspace, or its tips where the target's are no workspace."""
    if target is None or target.workspace is not None:
        return design.workspace
    aim = target.aim
    if not len(aim):
        return _in_which_it_moves(design)
    found = design.solve(aim.pressures)
    ways = np.zeros_like(aim.tips) if found.directions is None else found.directions
    return Dots(aim.pressures, found.positions, _counted(aim, ways))


def _in_which_it_moves(design: Design) -> Workspace | Dots:
    """Trajectories alone are drawn in the design's workspace, where there is all of it."""
    try:
        return design.workspace
    except NoEquilibriumError:
        return Dots(*(np.zeros((0, 3)) for _ in range(3)))


def _counted(aim: Aim, directions: FloatArray) -> FloatArray:
    """Directions (n, 3), NaN where they do not count."""
    return np.where((aim.direction_weights > 0)[:, None], directions, np.nan)


def following(design: Design | None, target: Target | None) -> FollowedTrajectories | None:
    """The target's trajectories, and what the design reaches of them."""
    if target is None or not target.paths:
        return None
    if design is None:
        return FollowedTrajectories(target.paths)
    low, _, high = design.pressures
    model, points = design.climb.model, target.aim.paths
    return FollowedTrajectories(target.paths, reach(model, design.values, points, low, high).tips)
