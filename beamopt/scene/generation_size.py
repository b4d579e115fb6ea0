"""How many sections may be judged at once: their memory is taken together."""

from __future__ import annotations

from beamopt.base.errors import InputError

__all__ = ["check_generation"]

MOST_POINTS = 20_000_000
MOST_ELEMENTS = 2_000_000_000
"""Of all sections judged at once: feature points, and elements of the grid; a gigabyte or two."""


def check_generation(key: str, population: int, batch: int, points: int, elements: int) -> None:
    """Refuse a generation that takes gigabytes.

    key, population : what asks for it. batch : sections judged at once.
    points, elements : feature points of each, and elements of its grid.

    Raises
    ------
    InputError : the key, its value and what is allowed.
    """
    for each, most, what in (
        (points, MOST_POINTS, "section.feature_points"),
        (elements, MOST_ELEMENTS, "grid.radial × grid.angular"),
    ):
        if batch * each > most:
            said = f"sections of a generation × {what} ({each:,}): at most {most:,}"
            raise InputError("", key, population, said)
