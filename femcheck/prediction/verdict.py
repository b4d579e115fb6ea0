"""The prediction in a sentence that a person can act on."""

from __future__ import annotations

import numpy as np

from femcheck.continuation.outcome import Status
from femcheck.prediction.prediction import Prediction
from femcheck.prediction.ray_trace import RayResult
from femcheck.solid.winding import Wound

__all__ = ["advice", "verdict"]

BALLOON = 1.5  # growth of the chambers at a limit point above which it is no wall that snaps
VERBS = {
    Status.BUCKLED: "buckles",
    Status.INVERTED: "is lost to the computation (an element turned inside out)",
    Status.STEP_TOO_SMALL: "is lost to the computation (steps became too small)",
    Status.LINEAR_SOLVER: "is lost to the computation (no solution of a linear system)",
    Status.TIME_OUT: "is not followed further (time limit)",
    Status.STOPPED: "is not followed (its process ended)",
}


def verdict(found: Prediction) -> str:
    """What happens, and whether the beam's workspace exists."""
    if found.failure is not None:
        return f"no answer: {found.failure}"
    loaded = int(found.is_loaded.sum())
    if loaded == 0:
        return "nothing to predict: no combination has pressure"
    first = found.first_to_end
    if found.unanswered == 0 and first is None:
        agree = f"{100 * found.options.agree:g} %"
        worst, median = (f"{100 * value:.3g} %" for value in (found.worst, found.median))
        said = f"up to {found.largest:g} kPa all {loaded} combinations have a stable answer"
        judged = "the beam holds" if found.holds else "the beam can not be trusted"
        off = f"its tips are off by {median} (median) … {worst} of displacement"
        return f"{_condition(found)}, {said}{_snaps(found)}; {judged}: {off} (asked {agree})"
    assert first is not None
    ray, result = found.rays[first], found.result(first)
    lost = f"{found.unanswered} of {loaded} combinations have no stable answer"
    exists = "does not exist" if found.unanswered == loaded else "exists in part only"
    return (
        f"{_condition(found)}, this section {_verb(found, first)} at {result.critical:.3g} kPa "
        f"({ray.text}{_place(result)}); "
        f"{lost}: the beam's workspace at {found.largest:g} kPa {exists}"
    )


def advice(found: Prediction) -> str | None:
    """What may be done about it; None where there is nothing to be done."""
    if not found.has_answers or found.first_to_end is None:
        return None
    box = f"stay below {found.stable_box:.3g} kPa in every supply"
    if found.options.wound in (Wound.CHAMBERS, Wound.BOTH):
        return f"{box}, or thicken the walls"
    return f"{box}, or wind every chamber (--law wound shows what that does)"


def _snaps(found: Prediction) -> str:
    """That some are reached only by a jump to another shape."""
    snapped = [found.snap(row) for row in range(len(found.places))]
    count = int(np.isfinite(snapped).sum())
    return f" ({count} of them behind a snap at {np.nanmin(snapped):.3g} kPa)" if count else ""


def _verb(found: Prediction, number: int) -> str:
    """What a ray's section does where its stable part ends."""
    result = found.result(number)
    if result.status is Status.LIMIT_POINT:
        return "balloons" if found.growth(number) >= BALLOON else "snaps"
    return "creases" if result.creases else VERBS[result.status]


def _place(result: RayResult) -> str:
    """Where it happens, where that is known."""
    if np.isnan(result.mode_at).any():
        return ""
    x, y, z = result.mode_at
    return f", most of all near ({x:.1f}, {y:.1f}, {z:.1f}) mm"


def _condition(found: Prediction) -> str:
    wound = found.options.wound
    if wound is None:
        return "unreinforced"
    places = {
        Wound.CHAMBERS: "its chambers",
        Wound.OUTER: "the outside",
        Wound.BOTH: "its chambers and the outside",
    }
    return f"with {places[wound]} wound"
