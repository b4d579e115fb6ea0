"""One model on one question: its reply and its processor time, on disk as they come."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from femcheck.models.question import Question
from femcheck.models.reply import Model, Reply, cpu_seconds

__all__ = ["Measured", "key_of", "measure", "read", "written"]

REPEATS, SPENT = 5, 0.5  # a quick reply is asked for again, until so many times and seconds


@dataclass(frozen=True, eq=False)
class Measured:
    """A reply and what it cost.

    seconds : of processor time, the least of several replies where one is quick.
    """

    family: str
    resolution: str
    reply: Reply
    seconds: float


def key_of(model: Model) -> str:
    """Tells one model from another."""
    return f"{model.family} {model.resolution}"


def measure(question: Question, model: Model) -> Measured:
    """Ask once to have everything loaded if that is quick, then for good."""
    reply, seconds = _asked(question, model)
    spent, repeats = seconds, 1
    if seconds < SPENT:
        seconds = np.inf  # of the first one a part was loading
    while spent < SPENT and repeats <= REPEATS:
        _, again = _asked(question, model)
        seconds, spent, repeats = min(seconds, again), spent + again, repeats + 1
    return Measured(model.family, model.resolution, reply, float(seconds))


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
    return Measured(line["family"], line["resolution"], reply, float(line["seconds"]))
