"""The prediction in a sentence that a person can act on."""

from __future__ import annotations

import numpy as np

from femcheck.continuation.outcome import Status
from femcheck.prediction.prediction import Prediction
from femcheck.prediction.ray_trace import RayResult
from femcheck.prediction.two_meshes import (
    AGREE,
    GROWTH,
    MARGIN,
    Agreement,
    RayEnds,
    SafeBox,
    Why,
)
from femcheck.solid.winding import Wound

__all__ = ["advice", "verdict"]

MORE = {
    Status.WORK_LIMIT: "--resume and more --iterations, or with ",
    Status.TIME_OUT: "--resume and without --seconds, or with ",
    Status.STOPPED: "--resume, or with ",
}
"""What may help where a ray was cut short."""

BALLOON = 1.5  # growth of the chambers at a limit point above which it is no wall that snaps


def verdict(found: Prediction) -> str:
    """What happens, and whether the beam's workspace exists.

    Examples
    --------
    >>> import femcheck
    >>> from pathlib import Path
    >>> import beamopt
    >>> drawn = beamopt.load_design(str(beamopt.load_scene("gravity").target.file))
    >>> subject = femcheck.sealed_copy("round", drawn, 1.0)
    >>> without = femcheck.PredictionOptions(mesher=femcheck.Mesher("no-such-gmsh"))
    >>> print(femcheck.verdict(femcheck.predict_design(subject, Path("judged"), without)))
    no answer: gmsh is not installed: no-such-gmsh
    """
    if found.failure is not None:
        return f"no answer: {found.failure}"
    if not found.is_loaded.any():
        return "nothing to predict: no combination has pressure"
    said = _answered(found) if found.unanswered == 0 else _unanswered(found)
    unchecked = "" if found.is_checked else "; stability not checked: the solver can not count"
    return f"{_condition(found)}, {said}{unchecked}{_uncertain(found)}"


def _answered(found: Prediction) -> str:
    """Every combination has an answer: how far the beam is off."""
    agree = f"{100 * found.options.agree:g} %"
    worst, median = _percent(found.worst), _percent(found.median)
    stable = "a stable answer" if found.is_checked else "an answer"
    count = int(found.is_loaded.sum())
    said = f"up to {found.largest:g} kPa all {count} combinations have {stable}{_snaps(found)}"
    judged = "the beam holds" if found.holds else "the beam can not be trusted"
    off = f"its tips are off by {median} (median) … {worst} of displacement"
    moved = "" if np.isnan(found.mesh_share) else f"; meshes differ by {_percent(found.mesh_share)}"
    return f"{said}; {judged}: {off} (asked {agree}{moved})"


def _unanswered(found: Prediction) -> str:
    """Some have none: what happens first, and what of the workspace is lost."""
    loaded, failed, beyond = int(found.is_loaded.sum()), found.not_computed, found.beyond_law
    parts = []
    first = found.first_to_end
    lost = found.unanswered - failed - beyond
    if first is not None and lost:
        ray, result = found.rays[first], found.result(first)
        parts.append(
            f"this section {_verb(found, first)} at {result.critical:.3g} kPa "
            f"({ray.text}, {_on_the_coarse(found.ends(first))}{_place(result)})"
        )
        exists = "does not exist" if found.unanswered == loaded else "exists in part only"
        parts.append(
            f"{lost} of {loaded} combinations {_have(lost)} no stable answer: "
            f"the beam's workspace at {found.largest:g} kPa {exists}"
        )
    left = found.first_to_leave
    if beyond and left is not None:
        parts.append(
            f"{beyond} of {loaded} combinations {_have(beyond)} no answer that is known: "
            f"{found.law.name} {_range(found)}, which {_passed(found, left)}"
        )
    worst = found.first_to_fail
    if failed and worst is not None:
        result = found.result(worst)
        parts.append(
            f"{failed} of {loaded} combinations {_have(failed)} no answer that is known: "
            f"{result.status.value} at {result.critical:.3g} kPa ({found.rays[worst].text}, "
            f"{_on_the_coarse(found.ends(worst))})"
        )
    return "; ".join(parts)


def advice(found: Prediction) -> str | None:
    """What may be done about it; None where there is nothing to be done."""
    if not found.has_answers or found.unanswered == 0:
        return None
    first = found.first_to_end
    if found.unanswered == found.not_computed:
        lost = None if found.first_to_fail is None else found.result(found.first_to_fail).status
        more = MORE.get(lost, "") if lost is not None else ""
        return f"try again with {more}another --size or --layers"
    box = found.safe_box
    stay = f"stay below {_down(box.pressure)} kPa in every supply ({_why(found, box)})"
    if not found.certain:
        stay += ", and ask again with a smaller --size or more --layers before relying on that"
    if first is None:
        return f"{stay}; or take a law that was fitted to larger stretches"
    if found.options.wound in (Wound.CHAMBERS, Wound.BOTH):
        return f"{stay}; or thicken the walls that give way"
    if found.result(first).status is Status.LIMIT_POINT and found.growth(first) >= BALLOON:
        return f"{stay}; or wind every chamber (--law wound shows what that does)"
    return f"{stay}; or thicken the walls that give way, and wind every chamber"


def _why(found: Prediction, box: SafeBox) -> str:
    """What limits the pressure that is advised."""
    if box.key is None:
        return "no larger one was asked for"
    mesh, number = box.key
    of = f"{found.rays[number].text}, {mesh} mesh"
    if box.why is Why.GROWTH:
        return f"there a chamber has {GROWTH:g} times its volume: {of}"
    return f"{box.at:.3g} kPa over a margin of {MARGIN:g}: {of}"


def _uncertain(found: Prediction) -> str:
    """What the two meshes do not agree on; "" where the verdict is certain."""
    if found.certain:
        return ""
    differ = [one for one in found.compared if one.agreement is Agreement.DIFFER]
    unknown = [one for one in found.compared if one.agreement is Agreement.UNKNOWN]
    alone = [one for one in found.compared if one.agreement is Agreement.ONE_MESH]
    parts = []
    if differ:
        limit = f"{100 * (AGREE - 1):.3g} %"
        rays = ", ".join(f"{one.ray.text} {_both(one)}" for one in differ)
        parts.append(f"the meshes differ by more than {limit}: {rays}")
    if unknown:
        rays = ", ".join(f"{one.ray.text} {_both(one)}" for one in unknown)
        parts.append(f"not known on both meshes: {rays}")
    if alone:
        parts.append(f"on one mesh only: {', '.join(one.ray.text for one in alone)}")
    if not parts:
        known = not np.isnan(found.mesh_share)
        by = "what the meshes differ by could turn it over"
        parts.append(by if known else "no combination has an answer on both meshes")
    return f"; uncertain, {'; '.join(parts)}"


def _both(one: RayEnds) -> str:
    """Both figures."""
    results = (one.standard, one.coarse)
    said = [
        f"{'' if result is not None and result.status.is_settled else 'above '}{load:.3g}"
        for load, result in zip(one.loads, results, strict=True)
    ]
    times = f" ({'at least ' if one.is_bound else ''}{one.ratio:.3g} times)"
    return f"{said[0]} and {said[1]} kPa{times if np.isfinite(one.ratio) else ''}"


def _on_the_coarse(one: RayEnds) -> str:
    """Where the same ray ends on the coarse mesh."""
    if one.coarse is None:
        return "on one mesh only"
    above = "" if one.coarse.status.is_settled else "above "
    return f"{above}{one.loads[1]:.3g} kPa on the coarse mesh"


def _percent(share: float) -> str:
    return f"{100 * share:.3g} %"


def _range(found: Prediction) -> str:
    return f"describes stretches up to {found.law.most_stretch:.3g}"


def _passed(found: Prediction, number: int) -> str:
    """Where a ray leaves what the law describes."""
    result, ray = found.result(number), found.rays[number]
    coarse = _on_the_coarse(found.ends(number))
    said = f"is passed at {result.critical:.3g} kPa ({ray.text}, {coarse}"
    if result.last is None:
        return f"{said})"
    x, y, z = np.round(result.last.stretch_at, 1) + 0.0
    return f"{said}, near ({x:.1f}, {y:.1f}, {z:.1f}) mm)"


def _have(count: int) -> str:
    return "has" if count == 1 else "have"


def _down(pressure: float) -> str:
    """To three digits, never more than it is."""
    if pressure <= 0:
        return "0"
    unit = 10.0 ** (np.floor(np.log10(pressure)) - 2)
    return f"{np.floor(pressure / unit) * unit:.6g}"


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
    return "creases" if result.is_local else "buckles"


def _place(result: RayResult) -> str:
    """Where it happens, where only a small part of the section moves."""
    if not result.is_local:
        return ""
    x, y, z = np.round(result.mode_at, 1) + 0.0
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
