"""Cook's membrane, nearly incompressible: what locks is found out."""

from __future__ import annotations

from collections.abc import Iterator

from femcheck.continuation.trace import PathSteps
from femcheck.material.neo_hookean import NeoHookean
from tests.validation.check import Row
from tests.validation.published_bodies import DIRECTION, cook
from tests.validation.published_inflation import told_apart

SHEAR, LAME = 80.1938, 400889.8  # μ and λ [kPa]
TRACTION = 6.25  # kPa, upwards on the right side, by undeformed area
CORNER, ACCEPTED = 6.93, 0.03
"""Vertical displacement of the upper right corner and what is accepted of it [mm]."""
PUBLISHED = {4: 6.820, 8: 6.885, 16: 6.911, 32: 6.922}
"""By quadratic mixed elements an edge [mm]."""
SOURCE = "Cook's membrane, plane strain"


def corner(edges: int, element: str, *, mixed: bool) -> float:
    """u_y of the corner [mm]; NaN, which holds nowhere, if the load is not reached."""
    poisson_ratio = LAME / (2 * (LAME + SHEAR))
    law = NeoHookean(2 * SHEAR * (1 + poisson_ratio), poisson_ratio, mixed=mixed)
    body, node = cook(law, edges, element)
    path = PathSteps().trace(body.problem, body.predictor, DIRECTION, [TRACTION], body.solver)
    if path.stops[0] is None:
        return float("nan")
    return float(path.stops[0].state.x[node, 1] - body.problem.body.nodes[node, 1])


def rows(finest: dict[str, int]) -> Iterator[Row]:
    """Edges of the mesh by element with which each is accepted; two ways to lock that are not."""
    for element, edges in finest.items():
        name = f"Cook, {element}, {edges} edges: corner [mm]"
        yield Row(name, SOURCE, CORNER, corner(edges, element, mixed=True), ACCEPTED)
    for element, edges in (("tet4", 16), ("wedge18", 8)):
        locked = corner(edges, element, mixed=False)
        name = f"Cook, {element}, {edges} edges: corner"
        yield told_apart(name, SOURCE, CORNER, locked, ACCEPTED)


def convergence_rows() -> Iterator[Row]:
    """The published ones are quadrangles, ours halves of them: nearer with every refinement.

    Differences are 0.010, 0.004, 0.001 and 0.0005 mm; they are allowed 0.06 mm over the edges.
    """
    for edges, published in PUBLISHED.items():
        name = f"Cook, wedge18 beside quadrangles, {edges} edges: corner [mm]"
        measured = corner(edges, "wedge18", mixed=True)
        yield Row(name, SOURCE, published, measured, 0.06 / edges)
