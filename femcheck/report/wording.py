"""Numbers and verdicts as people read them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from femcheck.continuation.ended import Ended, ReplyStatus
from femcheck.continuation.outcome import Status
from femcheck.report.solid_run import SolidRun

__all__ = [
    "MEANINGS",
    "Badge",
    "badge_of",
    "duration",
    "flat",
    "meaning",
    "number",
    "per_cent",
    "pressures_text",
]

MEANINGS: Mapping[ReplyStatus, str] = {
    Status.CONVERGED: "an equilibrium was found; for predictions, a stable one",
    Status.LIMIT_POINT: "the largest pressure of its path: the section balloons, or a thin "
    "wall of it snaps; beyond it there is no equilibrium near this one",
    Status.BUCKLED: "it leaves its path while the volume still grows; where few nodes move, "
    "a surface creases",
    Status.BEYOND_LAW: "the largest stretch passes what the law describes: beyond it the response "
    "falls that was fitted to a test; another law may have an answer",
    Status.INVERTED: "the mesh gave way, not the actuator: the computation ends here",
    Status.STEP_TOO_SMALL: "the computation could not follow its path any further",
    Status.LINEAR_SOLVER: "the tangent was singular, or too badly conditioned to solve",
    Status.WORK_LIMIT: "more work (--iterations) may bring an answer",
    Status.TIME_OUT: "the clock set by --seconds ran out, which depends on the machine; "
    "--resume tries it again",
    Status.STOPPED: "it was killed or never begun; --resume goes on with it",
}


class Badge(NamedTuple):
    """A verdict in a few words. mood : "good", "bad" or "none", for its mark and colour."""

    text: str
    mood: str


def badge_of(run: SolidRun) -> Badge:
    """What a run found, in a few words."""
    found = run.combinations
    if found is None:
        return Badge("no answer", "none")
    missing = int((found.loaded & ~found.answered).sum())
    unsure = "" if run.is_certain else ", uncertain"
    if run.summary.holds:
        said = "beam holds" if run.is_prediction else "agrees"
        return Badge(said + unsure, "good" if run.is_certain else "none")
    if missing:
        return Badge(f"{missing} of {int(found.loaded.sum())} without answer{unsure}", "bad")
    return Badge(("beam is off" if run.is_prediction else "differs") + unsure, "bad")


def meaning(ended: Ended | None) -> str:
    """Return the meaning of an ending, "" for one that is not known here."""
    return "" if ended is None else MEANINGS.get(ended.status, "")


def number(value: float | None, digits: int = 3) -> str:
    """To so many digits; a dash where there is none."""
    if value is None or math.isnan(value):
        return "–"
    shown = f"{value:.{digits}g}"
    return (f"{value:,.0f}" if "e+" in shown else shown).replace("-", "−")


def per_cent(share: float | None) -> str:
    """A share as per cent."""
    return "–" if share is None or math.isnan(share) else f"{number(100 * share)} %"


def pressures_text(pressures: Any) -> str:
    """Three pressures with their unit."""
    return " · ".join(f"{value:.4g}" for value in pressures) + " kPa"


def duration(seconds: float) -> str:
    """A time in the units that fit it."""
    if math.isnan(seconds):
        return "–"
    if seconds < 60:
        return f"{seconds:.3g} s"
    minutes, rest = divmod(round(seconds), 60)
    if minutes < 60:
        return f"{minutes} min {rest} s"
    return f"{minutes // 60} h {minutes % 60} min"


def flat(data: Mapping[str, Any], key: str = "") -> dict[str, str]:
    """Nested tables as lines "a.b" → text."""
    lines: dict[str, str] = {}
    for name, value in data.items():
        inner = f"{key}.{name}" if key else str(name)
        if isinstance(value, Mapping):
            lines |= flat(value, inner)
        elif isinstance(value, list) and any(isinstance(item, Mapping) for item in value):
            for place, item in enumerate(value, 1):
                lines |= flat(item if isinstance(item, Mapping) else {"": item}, f"{inner} {place}")
        else:
            lines[inner] = _plain(value)
    return lines


def _plain(value: Any) -> str:
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return number(value, 6)
    if isinstance(value, list):
        return ", ".join(map(_plain, value)) or "none"
    return str(value)
