"""How tips change with the moments of a section."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.judge.answers import Answers
from beamopt.judge.judge import Judge
from beamopt.reach.reach import arcs_are_linear
from beamopt.refine.truth import Judged, answers_to
from beamopt.rod.arc import arc_tip_direction_jacobian, arc_tip_jacobian
from beamopt.section.grid import PolarGrid
from beamopt.section.moments import Moments
from beamopt.target.aim import Aim

__all__ = ["moment_sizes", "residual_of", "residual_slopes", "response_slopes"]

COUNTED = [(0, m) for m in range(6)] + [(i, m) for i in (1, 2, 3) for m in range(3)]
"""The raw moments (type, integral) that a rod looks at."""

STEP = 1e-5  # of a moment's size, in differences
SMALLEST = 1e-3  # size of a moment that is zero, of what the whole ring could have


def residual_of(aim: Aim, answers: Answers) -> FloatArray:
    """(rows,) weighted differences of tips, and of directions where they count [mm]: |·|² is L."""
    parts = [np.sqrt(aim.weights)[:, None] * (answers.tips - aim.tips)]
    if aim.turns and answers.directions is not None:
        roots = np.sqrt(aim.direction_weights)[:, None]
        parts.append(roots * (answers.directions - aim.directions))
    return np.concatenate(parts).reshape(-1)


def moment_sizes(grid: PolarGrid, moments: Moments) -> FloatArray:
    """(6,) sizes of the integrals of {1, x, y, x², y², xy}, above 0 [mm², mm³, mm⁴]."""
    ring = grid.area * grid.outer_radius ** np.array([0, 1, 1, 2, 2, 2])
    return np.asarray(np.maximum(np.abs(moments.raw).max(axis=0), SMALLEST * ring))


def residual_slopes(judge: Judge, judged: Judged) -> FloatArray:
    """Derivatives (rows, 4, 6) of the residual by the raw moments of the section.

    Exact for arcs; by differences for rods on higher rungs, whose twist is taken as it is. Zero for
    a moment that can be moved to neither side without the rod losing its equilibrium.
    """
    if arcs_are_linear(judge.rod, judged.section.moments):
        return _slopes_of_arcs(judge, judged)
    raw = judged.section.moments.raw
    residual = residual_of(judged.aim, judged.answers)
    slopes = np.zeros((residual.size, 4, 6))
    steps = STEP * moment_sizes(judge.grid, judged.section.moments)
    for kind, m in COUNTED:
        for step in (steps[m], -steps[m]):
            moved = raw.copy()
            moved[kind, m] += step
            section = replace(judged.section, moments=Moments(moved))
            change = residual_of(judged.aim, answers_to(judge, judged.aim, section)) - residual
            if np.isfinite(change).all():
                slopes[:, kind, m] = change / step
                break
    return slopes


def _slopes_of_arcs(judge: Judge, judged: Judged) -> FloatArray:
    aim, rod = judged.aim, judge.rod
    moments = judged.section.moments
    strains = rod.arc_strains(moments, aim.pressures)
    roots = np.sqrt(aim.weights)[:, None, None]
    parts = [roots * arc_tip_jacobian(strains, rod.length)]
    if aim.turns:
        roots = np.sqrt(aim.direction_weights)[:, None, None]
        parts.append(roots * arc_tip_direction_jacobian(strains, rod.length))
    by_response = response_slopes(moments, rod.youngs_modulus)
    by_moments = np.einsum("ijtm,nj->nitm", by_response, aim.pressures)
    rows = [np.einsum("nxi,nitm->nxtm", part, by_moments, optimize=True) for part in parts]
    return np.concatenate(rows).reshape(-1, 4, 6)


def response_slopes(moments: Moments, youngs_modulus: float) -> FloatArray:
    """Derivatives (3, 3, 4, 6) of the linear response matrix B by the raw moments of one section.

    From E A ε_i = A_i and E I κ_i = (s_y, −s_x)_i with s_i = S_i − A_i c: the differentials of both
    sides, with dc = (dS_0 − c dA)/A and Steiner's terms in dI.
    """
    area, centroid = moments.raw[0, 0], moments.centroid
    own, first = moments.chamber_areas, moments.chamber_first_moments
    inertia = moments.second_moments
    curvatures = np.linalg.solve(inertia, np.stack([first[:, 1], -first[:, 0]]))  # times E
    d_centroid, d_inertia = _steiner(area, centroid)
    result = np.zeros((3, 3, 4, 6))
    for i in range(3):
        result[0, i, i + 1, 0] += 1 / area
        result[0, i, 0, 0] -= own[i] / area**2
        d_first = -own[i] * d_centroid
        d_first[:, i + 1, 0] -= centroid
        d_first[0, i + 1, 1] += 1
        d_first[1, i + 1, 2] += 1
        d_sides = np.stack([d_first[1], -d_first[0]])
        d_sides -= np.einsum("abtm,b->atm", d_inertia, curvatures[:, i])
        result[1:, i] = np.linalg.solve(inertia, d_sides.reshape(2, -1)).reshape(2, 4, 6)
    return result / youngs_modulus


def _steiner(area: float, centroid: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Derivatives by the raw moments of the centroid (2, 4, 6) and of I (2, 2, 4, 6) about it."""
    d_centroid = np.zeros((2, 4, 6))
    for axis in range(2):
        d_centroid[axis, 0, 0], d_centroid[axis, 0, 1 + axis] = -centroid[axis] / area, 1 / area
    d_inertia = np.zeros((2, 2, 4, 6))
    # I11 = ∫ y², I22 = ∫ x², I12 = −∫ xy, less what Steiner's theorem takes
    for a, b, column, u, v in ((0, 0, 4, 1, 1), (1, 1, 3, 0, 0), (0, 1, 5, 0, 1)):
        change = -area * (centroid[u] * d_centroid[v] + d_centroid[u] * centroid[v])
        change[0, 0] -= centroid[u] * centroid[v]
        change[0, column] += 1
        d_inertia[a, b] = change if a == b else -change
    d_inertia[1, 0] = d_inertia[0, 1]
    return d_centroid, d_inertia
