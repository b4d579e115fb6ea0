"""Cells of tables with tips: rounded numbers and statuses, written alike by every command."""

from __future__ import annotations

import math
from typing import Any

from femcheck.continuation.ended import Ended
from femcheck.continuation.outcome import Status

__all__ = ["COMPARE", "DIGITS", "both", "cells", "plain"]

DIGITS = 6  # of a millimetre or a share: coarser than rounding, finer than any mesh
COMPARE = (
    "law,c,nu,mesh,p1,p2,p3,beam_x,beam_y,beam_z,solid_x,solid_y,solid_z,difference_mm,"
    "difference_of_length,difference_of_displacement,"
    "volume_ratio_1,volume_ratio_2,volume_ratio_3,status,ended"
)


def both(status: Status) -> tuple[str, str]:
    """Cells of the columns "status" and "ended": the text for people, the key for programs."""
    return status.value, Ended(status).key


def plain(value: float) -> object:
    """Whole numbers without a point, infinity as inf."""
    return int(value) if float(value).is_integer() else value


def cells(values: Any) -> list[object]:
    """Rounded, so that the last bits of a solver do not show; empty where there is no answer."""
    rounded = [round(float(value), DIGITS) + 0.0 for value in values]
    return [None if math.isnan(value) else value for value in rounded]
