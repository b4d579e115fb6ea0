"""The closed-form arc against shooting on the paper's own equations."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from beamopt.rod.arc import arc_tip_jacobian_by_response, arc_tips
from beamopt.rod.response import linear_response
from beamopt.scene.design import load_design
from beamopt.scene.scene import Scene, load_scene
from beamopt.section.moments import Moments
from tests.validation.check import Check, Row
from tests.validation.paper_odes import shoot

E, G, LENGTH = 300.0, 100.0, 100.0


def paper_tip(moments: Moments, pressures: np.ndarray) -> np.ndarray:
    """The tip by shooting, in the principal frame, turned back to the grid's axes [mm]."""
    (i1, i2), axes = moments.principal
    turn = np.eye(3)
    turn[:2, :2] = axes
    turn[:, 1] *= np.linalg.det(turn)  # right-handed
    areas = moments.chamber_areas
    arms = np.zeros((3, 3))
    present = areas > 0
    arms[present, :2] = moments.chamber_first_moments[present] / areas[present, None]
    stretch, shear = E * moments.area, G * moments.area
    stiffness = (
        np.array([shear, shear, stretch]),
        E * np.array([i1, i2, (i1 + i2)]),  # any torsional stiffness: nothing twists
    )
    return np.asarray(turn @ shoot(stiffness, pressures * areas, arms @ turn, LENGTH))


def difference(moments: Moments, pressures: np.ndarray) -> float:
    """Distance of the two tips over the distance of the tip from the base."""
    closed = arc_tips(linear_response(moments, E).strains(pressures[None]), LENGTH)[0]
    return float(np.linalg.norm(closed - paper_tip(moments, pressures)) / np.linalg.norm(closed))


def checks(full: bool) -> list[Check]:
    sections = 40 if full else 2

    def random_sections() -> Iterator[Row]:
        scene = Scene()
        for seed in range(sections):
            rng = np.random.default_rng([seed])
            design = scene.design_of(scene.random_points(rng))
            pressures = rng.uniform(0, 100, 3)
            measured = difference(design.section.moments, pressures)
            yield Row(
                f"tip of random section {seed} at {pressures.round(1).tolist()} kPa, relative",
                "paper, f_p l_p F_i L_i by shooting",
                0.0,
                measured,
                1e-9,
            )

    def drawn_section() -> Iterator[Row]:
        target = load_scene("hand-drawn-section").target.file
        moments = load_design(str(target)).section.moments
        cases = [[100, 0, 0], [0, 0, 0], [50, 100, 50], [100, 100, 100]]
        for pressures in cases if full else cases[:1]:
            yield Row(
                f"tip of the hand-drawn section at {pressures} kPa, relative",
                "paper, f_p l_p F_i L_i by shooting",
                0.0,
                difference(moments, np.array(pressures, dtype=float)),
                1e-9,
            )

    def derivatives() -> Iterator[Row]:
        """Central differences, fourth order: rounding over the step leaves about 1e-9."""
        rng = np.random.default_rng([99])
        worst = 0.0
        for _ in range(200 if full else 20):
            matrix = rng.normal(size=(3, 3)) * 10.0 ** rng.uniform(-6, -3, (3, 1))
            pressures = rng.uniform(0, 100, (1, 3))
            exact = arc_tip_jacobian_by_response(pressures @ matrix.T, pressures, LENGTH)[0]
            for i, j in np.ndindex(3, 3):
                step = np.zeros((3, 3))
                step[i, j] = 1e-5 if i == 0 else 1e-7
                near = [arc_tips(pressures @ (matrix + k * step).T, LENGTH) for k in (-2, -1, 1, 2)]
                slope = (near[0] - 8 * near[1] + 8 * near[2] - near[3])[0] / (12 * step[i, j])
                worst = max(
                    worst, float(np.abs(slope - exact[:, i, j]).max() / np.abs(exact).max())
                )
        what = "derivatives of the tip by the response matrix, relative"
        yield Row(what, "central differences", 0.0, worst, 1e-7)

    return [
        Check("random sections", random_sections),
        Check("drawn section", drawn_section),
        Check("derivatives", derivatives),
    ]
