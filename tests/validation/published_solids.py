"""The solid against published and closed-form answers on bodies that are no actuators."""

from __future__ import annotations

from functools import partial

from tests.validation import published_cook
from tests.validation.check import Check
from tests.validation.published_inflation import (
    SPHERES,
    closed_tube_rows,
    sphere_rows,
    tube_convergence_rows,
    tube_rows,
)


def checks(full: bool) -> list[Check]:
    """In full all elements and finer meshes; reduced, what shows a wrong sign, area or constant."""
    if not full:
        return [
            Check("thick tube", partial(tube_rows, ("wedge18",))),
            Check("closed tube", partial(closed_tube_rows, 4, 2, 5e-3)),
            Check("thick sphere", partial(sphere_rows, 1.5, 2, 1e-3)),
            Check("Cook's membrane", partial(published_cook.rows, {"wedge18": 16})),
        ]
    finest = {"wedge18": 32, "hex27": 8, "tet10": 16}
    return [
        Check("thick tube", partial(tube_rows, ("wedge18", "hex27", "tet10"))),
        Check("thick tube, convergence", tube_convergence_rows),
        Check("closed tube", partial(closed_tube_rows, 4, 2, 5e-3)),
        Check("closed tube, fine", partial(closed_tube_rows, 8, 4, 1e-4)),
        *(
            Check(f"thick sphere, B/A = {ratio:g}, {edges}", partial(sphere_rows, ratio, edges, t))
            for ratio, _, _ in SPHERES
            for edges, t in ((2, 1e-3), (4, 1e-4))
        ),
        Check("Cook's membrane", partial(published_cook.rows, finest)),
        Check("Cook's membrane, convergence", published_cook.convergence_rows),
    ]
