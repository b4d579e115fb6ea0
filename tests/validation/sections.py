"""Random sealed sections: what is made by the rules keeps them, or names what it does not keep.

Skins are measured without shapely, by radii alone. In every fourth section thin material is
searched for by another method: what is thinner than asked must be named.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import numpy as np

from beamopt.outline.build import SLACK, build_outline
from beamopt.outline.faults import FaultKind, Severity
from beamopt.outline.outline import Outline
from beamopt.section.feature_points import FeaturePoints
from tests.beamopt.outline.hostile import RING, RULES
from tests.beamopt.outline.necks import thinnest
from tests.beamopt.outline.sound import check_sound
from tests.validation.check import Check, Row

__all__ = ["SAGITTA", "TOLERANCE", "checks", "random_section"]

SAGITTA = 0.04
TOLERANCE = 2 * SAGITTA + SLACK
VIOLATED = 0.05
"""Largest share of sections in which a rule can not be kept, and is named."""


def random_section(seed: int) -> FeaturePoints:
    rng = np.random.default_rng(seed)
    return FeaturePoints.random(RING, int(rng.integers(60, 101)), rng)


def skin_of(outline: Outline) -> float:
    """Least skin [mm]: outer chords against chambers' vertices and chords, by radii alone."""
    outer = [chamber.exterior for chamber in outline.chambers]
    return min(
        25 - SAGITTA - max(np.hypot(*points.T).max() for points in outer),
        min(np.hypot(*((points + np.roll(points, -1, axis=0)) / 2).T).min() for points in outer)
        - 10,
    )


def is_sound(outline: Outline) -> bool:
    try:
        check_sound(outline, RING)
    except AssertionError:
        return False
    return outline.buildable


def broken(seed: int) -> Iterator[str]:
    """What is wrong with one section, and "violated" where it names a violation."""
    outline = build_outline(RING, random_section(seed), RULES, SAGITTA)
    found = [fault for fault in outline.faults if fault.severity is Severity.VIOLATION]
    if not is_sound(outline):
        yield "not sound"
    if found:
        yield "violated"
    elif not skin_of(outline) > RULES.skin - TOLERANCE:
        yield "a skin too thin"
    if seed % 4 == 0 and all(fault.status is FaultKind.SKIN for fault in found):
        # two tenths less than asked: straight ways that are not square to the walls count too
        width = RULES.wall - TOLERANCE - 0.01
        if thinnest(outline, width)[0] != width:
            yield "thin material that is not named"
    if not min(chamber.area for chamber in outline.chambers) > 0.9 * RULES.smallest_chamber:
        yield "a chamber too small"


def checks(full: bool) -> list[Check]:
    """200 sections, or 60."""
    count = 200 if full else 60

    def rows() -> Iterator[Row]:
        found = Counter(what for seed in range(count) for what in broken(seed))
        rules = "r 10…25 mm, 60 … 100 feature points"
        for what in (
            "not sound",
            "a skin too thin",
            "thin material that is not named",
            "a chamber too small",
        ):
            yield Row(f"{what}, of {count} sections", rules, 0, found[what], 0)
        share = found["violated"] / count
        yield Row(f"share of {count} that name a violation", rules, 0, share, VIOLATED)

    return [Check("random sealed sections keep the rules", rows)]
