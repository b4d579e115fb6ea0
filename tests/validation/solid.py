"""The solid of the rigid-section law converges to the beam."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from functools import partial
from itertools import count, islice
from pathlib import Path

import numpy as np

from beamopt.scene.actuator import Actuator
from beamopt.scene.design import Design, Grid
from beamopt.scene.drawn_chambers import DrawnChamber
from beamopt.scene.scene import load_scene
from beamopt.scene.seal_keys import Seal
from beamopt.search.optimize import optimize
from femcheck.check.check_design import check_design
from femcheck.check.comparison import Comparison
from femcheck.check.options import CheckOptions
from femcheck.mesh.geo import SectionSizes
from femcheck.solved.subject import Subject
from tests.validation.check import Check, Row

DESIGNS = 5
SOURCE = "rigid sections: what is left falls with 1/c"


def three_chambers() -> Design:
    """Three chambers of 80°, r 13…22 mm, sharp corners, in the ring of 10…25 mm."""
    chambers = [
        DrawnChamber(supply=k + 1, r=(13.0, 22.0), phi=(120.0 * k - 40.0, 120.0 * k + 40.0))
        for k in range(3)
    ]
    return drawn(chambers)


def drawn(chambers: list[DrawnChamber]) -> Design:
    """Chambers in the ring of 10…25 mm, at 0, 50 and 100 kPa."""
    return Design(
        schema="beamopt-design/1",
        grid=Grid(),
        drawing=chambers,
        wall_elements=4,
        seal=Seal(),
        actuator=Actuator(),
        pressures=(0.0, 50.0, 100.0),
    )


def compared(name: str, design: Design, options: CheckOptions) -> Comparison:
    with tempfile.TemporaryDirectory() as folder:
        done = check_design(Subject(name, design), Path(folder) / "check", options, workers=2)
    assert done.comparison is not None, done.failure
    return done.comparison


def checks(full: bool) -> list[Check]:
    if not full:
        return [Check("three chambers, coarse", coarse_three_chambers)]
    return [
        Check("three chambers", three_chamber_rows),
        *(
            Check(f"optimised section {number}", partial(voronoi_rows, number))
            for number in range(DESIGNS)
        ),
    ]


def coarse_three_chambers() -> Iterator[Row]:
    """All 27 combinations through the whole chain: some ten seconds, for a wrong sign or area.

    Two layers leave half a percent to the mesh.
    """
    options = CheckOptions(layers=2, sizes=SectionSizes(factor=3.0))
    found = compared("three", three_chambers(), options)
    yield from rows("three chambers, coarse", found, median=0.005, worst=0.01)


def three_chamber_rows() -> Iterator[Row]:
    standard = compared("three", three_chambers(), CheckOptions())
    yield from rows("three chambers", standard, median=0.001, worst=0.001)
    # fine enough that what is left at a finite penalty is the penalty's
    fine = compared("three", three_chambers(), CheckOptions(layers=8))
    low, high = (fine.solid("standard", c).tips for c in (2500.0, 10000.0))
    beam, loaded = fine.subject.beam_tips, fine.is_loaded
    first, second = (np.linalg.norm(tips - beam, axis=1)[loaded] for tips in (low, high))
    yield Row(
        "three chambers: error at c = 2500 over 10⁴", SOURCE, 4.0, _middle(first / second), 0.1
    )
    error = np.linalg.norm(standard.final.tips - fine.final.tips, axis=1)[loaded]
    estimate = standard.discretisation[loaded]
    bound = float((error / np.maximum(estimate, 1e-4)).max())
    yield Row("three chambers: mesh error over its estimate", "a finer mesh", 0.0, bound, 2.0)
    share = float((estimate / standard.displacement[loaded]).max())
    yield Row("three chambers: mesh error of the displacement", "two meshes", 0.0, share, 1e-3)


def _middle(values: np.ndarray) -> float:
    return float(np.median(values))


def voronoi_rows(number: int) -> Iterator[Row]:
    seed, design = next(islice(_without_islands(), number, None))
    found = compared(f"optimised-{seed}", design, CheckOptions())
    yield from rows(f"optimised section, seed {seed}", found, median=0.003, worst=0.01)


def _without_islands() -> Iterator[tuple[int, Design]]:
    """Sealed Voronoi designs found with seeds 0, 1, 2, … that have no island."""
    for seed in count():
        design = optimize(load_scene("sealed-section", [f"search.seed={seed}"])).best
        if not design.outline.islands:
            yield seed, design


def rows(name: str, found: Comparison, *, median: float, worst: float) -> Iterator[Row]:
    yield Row(f"{name}: cases without an answer", "27 combinations", 0.0, found.unanswered, 0.0)
    yield Row(f"{name}: worst share of the displacement", SOURCE, 0.0, found.worst, worst)
    yield Row(f"{name}: median share of the displacement", SOURCE, 0.0, found.median, median)
