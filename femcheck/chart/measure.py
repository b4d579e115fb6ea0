"""One model on one question: its reply and its processor time, on disk as they come."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from beamopt.provenance import provenance
from femcheck.check.case import forget_workshops
from femcheck.check.folder import PACKAGES
from femcheck.continuation.outcome import Status
from femcheck.models.question import Question
from femcheck.models.reply import Model, Reply, cpu_seconds

__all__ = ["Measured", "is_final", "key_of", "made_with", "measure", "read", "written"]

REPEATS, SPENT = 5, 0.5  # a quick reply is asked for again, until so many times and seconds


@dataclass(frozen=True, eq=False)
class Measured:
    """A reply and what it cost.

    seconds : of processor time, the least of several replies where one is quick.
    made_with : threads, processor and versions.
    """

    family: str
    resolution: str
    reply: Reply
    seconds: float
    made_with: str = ""


def key_of(model: Model) -> str:
    """Tells one model from another."""
    return f"{model.family} {model.resolution}"


def measure(question: Question, model: Model) -> Measured:
    """Ask for one tip to have everything loaded, then for all; quick models several times."""
    if model.family not in _WARM:
        _WARM.add(model.family)
        model.reply(question.at(question.pressures[:1]))
    forget_workshops()
    reply, seconds = _asked(question, model)
    spent, repeats = seconds, 1
    while spent < SPENT and repeats < REPEATS:
        _, again = _asked(question, model)
        seconds, spent, repeats = min(seconds, again), spent + again, repeats + 1
    about = made_with(provenance(PACKAGES))
    return Measured(model.family, model.resolution, reply, float(seconds), about)


_WARM: set[str] = set()
"""Families of which this process has loaded everything."""


def made_with(about: Mapping[str, Any]) -> str:
    """Threads, processor and versions in a line."""
    threads = set(about["threads"].values())
    number = "1 thread" if threads == {"1"} else f"threads: {', '.join(sorted(threads))}"
    versions = about["versions"]
    named = ", ".join(
        f"{name} {versions[name]}" for name in ("beamopt", "numpy", "scikit-fem", "gmsh")
        if name in versions
    )  # fmt: skip
    return f"{number} a model; {about['machine']['processor']}; {named}"


def _asked(question: Question, model: Model) -> tuple[Reply, float]:
    before = cpu_seconds()
    reply = model.reply(question)
    return reply, cpu_seconds() - before


def written(measured: Measured) -> dict[str, Any]:
    """As a line of a journal."""
    reply = measured.reply
    return {
        "model": f"{measured.family} {measured.resolution}",
        "family": measured.family,
        "resolution": measured.resolution,
        "seconds": measured.seconds,
        "unknowns": reply.unknowns,
        "size": reply.size,
        "tips": [[None if np.isnan(x) else x for x in tip] for tip in reply.tips.tolist()],
        "reasons": list(reply.reasons),
        "made_with": measured.made_with,
    }


def read(line: dict[str, Any]) -> Measured:
    """Of a journal's line.

    Raises
    ------
    KeyError, TypeError, ValueError : it is none.
    """
    tips = np.array(
        [[np.nan if x is None else float(x) for x in tip] for tip in line["tips"]]
    ).reshape(-1, 3)
    reasons = tuple(str(reason) for reason in line["reasons"])
    if len(reasons) != len(tips):
        raise ValueError("a reason for every tip")
    reply = Reply(tips, reasons, int(line["unknowns"]), str(line["size"]))
    seconds, about = float(line["seconds"]), str(line["made_with"])
    return Measured(line["family"], line["resolution"], reply, seconds, about)


AGAIN = (Status.TIME_OUT, Status.STOPPED)


def is_final(measured: Measured) -> bool:
    """Whether nothing was cut short that would be tried again."""
    return not any(
        reason.startswith(one.value) for reason in measured.reply.reasons for one in AGAIN
    )
