"""Annealing over the types of feature points, judged on T = L + K + R.

A chain of flips is walked on a model, the fragments' moments and whatever they left out when a
section was last judged; where it ends is judged on the true section. It is accepted where the true
T is lower, else by how much more T rose than the model said (after surrogate transitions, Liu
2001). Flips lean towards the types of neighbours, and nothing makes up for that: chains search,
they do not sample. Without a seal, weighted rules and paths, and on the lowest rung, the model is
exact, walls included.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.judge.judge import Judge
from beamopt.reach.reach import arcs_are_linear
from beamopt.refine.arc_loss import ArcAim
from beamopt.refine.flips import Flips, walk
from beamopt.refine.fragments import Fragments, fragments_of, kinds_of, moments_of_kinds
from beamopt.refine.orbits import Orbits
from beamopt.refine.truth import Judged, Truth
from beamopt.rod.response import linear_response
from beamopt.section.neighbours import cell_neighbours, neighbours_of

__all__ = ["Cooling", "anneal"]

AT_ONCE = 100_000  # flips whose random numbers are drawn together


@dataclass(frozen=True, slots=True)
class Cooling:
    """How an annealing cools.

    flips : proposed in all. walks : chains that they are cut into, each judged at its end.
    hot, cold : first and last temperature [mm²]; geometric in between.
    """

    flips: int
    walks: int
    hot: float
    cold: float

    def flips_of(self, walk: int) -> int:
        """Flips proposed in one of the chains."""
        return (walk + 1) * self.flips // self.walks - walk * self.flips // self.walks

    def temperature(self, walk: int) -> float:
        """Of one of the chains [mm²]."""
        share = walk / max(self.walks - 1, 1)
        return float(self.hot * (self.cold / self.hot) ** share)


def anneal(
    judge: Judge,
    truth: Truth,
    start: Judged,
    orbits: Orbits,
    schedule: Cooling,
    rng: np.random.Generator,
) -> tuple[Judged, int]:
    """The section with the lowest T of those that were accepted, and how many were judged.

    The start is not among them: where it was best, a descent has been there already.
    """
    grid, points = judge.grid, start.points
    fragments = fragments_of(grid, points, judge.wall_elements, judge.rules)
    edges = cell_neighbours(points.x, points.y, grid.domain)
    around = neighbours_of(edges, len(points))
    flips = Flips(fragments, edges, *around, orbits, judge.neighbour_weight)
    here, best, judged = start, None, 0
    for chain in range(schedule.walks):
        temperature = schedule.temperature(chain)
        types, total = here.points.type.copy(), here.verdict.T - here.verdict.R
        about = temperature, flips, _arc_aim(judge, here)
        added = _left_out(fragments, here)
        for begin in range(0, schedule.flips_of(chain), AT_ONCE):
            draws = rng.random((min(AT_ONCE, schedule.flips_of(chain) - begin), 4))
            total = walk(types, added, total, *about, draws)
        luck = rng.random()
        if np.array_equal(types, here.points.type):
            continue
        there = truth(points.with_types(types))
        judged += 1
        if not there.found:
            continue
        lower = there.verdict.T <= here.verdict.T
        worse = there.verdict.T - here.verdict.T - (total - here.verdict.T + here.verdict.R)
        if lower or worse <= 0 or luck < np.exp(-worse / temperature):
            here = there
            if best is None or here.verdict.T < best.verdict.T:
                best = here
    return best or start, judged


def _left_out(fragments: Fragments, judged: Judged) -> FloatArray:
    """(4, 6) what the fragments do not know of: skins, walls in mm, corners, an outline."""
    kinds = kinds_of(fragments, judged.points.type)
    return np.asarray(judged.section.moments.raw - moments_of_kinds(fragments, kinds))


def _arc_aim(judge: Judge, judged: Judged) -> ArcAim:
    """What an arc should do, so that the true rod, as last judged, would do what it should."""
    rod, aim = judge.rod, judged.aim
    tips, directions = aim.tips, aim.directions
    if not arcs_are_linear(rod, judged.section.moments):
        response = linear_response(judged.section.moments, rod.youngs_modulus)
        arc = replace(judge.question, rod=replace(rod, response_of=lambda _: response), aim=aim)
        arcs = arc.of_arcs(judged.section.moments)
        tips = tips - (judged.answers.tips - arcs.tips)
        if aim.turns and judged.answers.directions is not None and arcs.directions is not None:
            directions = directions - (judged.answers.directions - arcs.directions)
    return ArcAim(
        rod.length,
        rod.youngs_modulus,
        np.ascontiguousarray(rod.curvature[:2]),
        aim.pressures,
        np.ascontiguousarray(tips),
        aim.weights,
        np.ascontiguousarray(directions),
        aim.direction_weights,
        aim.turns,
    )
