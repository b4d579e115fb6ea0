"""One model on one question: its reply and its processor time, on disk as they come."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from beamopt.base.provenance import provenance
from femcheck.continuation.ended import Ended
from femcheck.continuation.old_wordings import ended_of
from femcheck.continuation.outcome import Status
from femcheck.models.question import Question
from femcheck.models.reply import Model, Reply, cpu_seconds
from femcheck.solved.case import forget_workshops
from femcheck.solved.folder import PACKAGES

__all__ = ["Measured", "is_final", "key_of", "made_with", "measure", "read", "written"]

REPEATS, SPENT = 5, 0.5  # a quick reply is asked for again, until so many times and seconds


@dataclass(frozen=True, eq=False)
class Measured:
    """A reply and what it cost.

    seconds : of processor time, the least of several replies where one is quick.
    made_with : threads, processor and versions.
    iterations : the work limit of one case.
    """

    family: str
    resolution: str
    reply: Reply
    seconds: float
    made_with: str = ""
    iterations: int = 0

    @property
    def name(self) -> str:
        """Its model's, as `key_of` has it."""
        return f"{self.family} {self.resolution}"


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
    most = question.law.limits.iterations
    return Measured(model.family, model.resolution, reply, float(seconds), about, most)


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
        "model": measured.name,
        "family": measured.family,
        "resolution": measured.resolution,
        "seconds": measured.seconds,
        "unknowns": reply.unknowns,
        "size": reply.size,
        "tips": [[None if np.isnan(x) else x for x in tip] for tip in reply.tips.tolist()],
        "endings": [[one.key, one.load, one.detail] for one in reply.endings],
        "made_with": measured.made_with,
        "iterations": measured.iterations,
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
    endings = _endings(line)
    if len(endings) != len(tips):
        raise ValueError("an ending for every tip")
    reply = Reply(tips, endings, int(line["unknowns"]), str(line["size"]))
    seconds, about = float(line["seconds"]), str(line["made_with"])
    most = int(line.get("iterations", 0))  # earlier lines never ended by it
    return Measured(line["family"], line["resolution"], reply, seconds, about, most)


def _endings(line: dict[str, Any]) -> tuple[Ended, ...]:
    if "endings" not in line:
        return tuple(ended_of(str(text)) for text in line["reasons"])
    return tuple(
        Ended.of_key(str(key), None if load is None else float(load), str(detail))
        for key, load, detail in line["endings"]
    )


def is_final(measured: Measured, iterations: int) -> bool:
    """True if nothing was cut short by a clock, a dead process, or a work limit below `iterations`.

    iterations : the work limit of one case that is asked for now.
    """
    statuses = {one.status for one in measured.reply.endings}
    more = Status.WORK_LIMIT in statuses and measured.iterations < iterations
    return not more and not any(one.is_interrupted for one in statuses)
