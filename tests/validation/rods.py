"""Rods against published and closed-form answers."""

from __future__ import annotations

from tests.validation import published_rods, published_rods_stability
from tests.validation.check import Check

__all__ = ["checks"]


def checks(full: bool) -> list[Check]:
    """All of it takes seconds; reduced, paths beyond the limits are left out."""
    found = [
        Check("45° bend", published_rods.bend_rows),
        Check("cantilever, dead load", published_rods.dead_load_rows),
        Check("roll-up", published_rods.roll_up_rows),
        Check("follower force", published_rods.follower_rows),
        Check("columns", published_rods_stability.column_rows),
        Check("Lee's frame", published_rods_stability.lee_rows),
        Check("measured strip", published_rods_stability.strip_rows),
    ]
    if full:
        found.append(Check("Lee's frame, beyond", published_rods_stability.lee_path_rows))
    return found
