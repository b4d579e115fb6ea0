"""What is held of the rod: tips on rasters, on the outline, and by two methods under loads."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from beamopt.rod.ladder import Rung
from femcheck.check.options import CheckOptions
from femcheck.models.beam import ArcOnGrid, RodByMethod, RodOnOutline
from femcheck.models.question import Question
from femcheck.models.reply import Model, Reply
from femcheck.regression.held import Held, of_reply, rounding
from femcheck.regression.held_design import HeldDesign
from femcheck.regression.sections import GRIDS

__all__ = ["SAFETY", "held_rods"]

SAFETY = 3.0
"""Times an estimate from two resolutions: Roache's factor where there are no more than two."""

WANTED = 1e-4  # mm: tolerance that a rod under load is solved to
MODES, ELEMENTS = 12, 64

NAMES = {
    Rung.ARC: "beam",
    Rung.CHAIN: "chain of segments",
    Rung.LOADED: "rod under load",
}


def held_rods(held: HeldDesign, *, estimate: bool) -> Iterator[Held]:
    """Tips at the design's 27 combinations; as a closed form where that is exact.

    estimate : whether tolerances are wanted, which half the elements have to be solved for.
    """
    question = Question.of(held.name, held.design, CheckOptions())
    rung = held.design.climb.model.rung
    closed = rounding(held.design.actuator.length)
    if rung is not Rung.LOADED:
        for grid in GRIDS if rung is Rung.ARC else ():
            yield _tips("raster", ArcOnGrid(*grid), question, *closed)
        yield _tips(NAMES[rung], RodOnOutline(), question, *closed)
        return
    source = f"the error that is asked of the solver: {WANTED:g} mm"
    yield _tips(NAMES[rung], RodOnOutline(WANTED), question, WANTED, source)
    modes = RodByMethod("modes", MODES)
    reply = modes.reply(question)
    yield _held("rod, modes", modes, question, reply, *_own_estimate(reply, closed[0]))
    elements = RodByMethod("elements", ELEMENTS)
    reply = elements.reply(question)
    half = RodByMethod("elements", ELEMENTS // 2).reply(question) if estimate else None
    yield _held("rod, elements", elements, question, reply, *_from_half(reply, half))


def _tips(rung: str, model: Model, question: Question, tolerance: float, source: str) -> Held:
    return _held(rung, model, question, model.reply(question), tolerance, source)


def _held(
    rung: str, model: Model, question: Question, reply: Reply, tolerance: float, source: str
) -> Held:
    rows = of_reply(question.pressures, reply)
    return Held(rung, model.resolution, "tips", "mm", rows, tolerance, source)


def _own_estimate(reply: Reply, least: float) -> tuple[float, str]:
    """What the method itself estimates, at worst over the cases."""
    worst = 0.0 if reply.errors is None else float(np.nanmax(reply.errors, initial=0.0))
    said = f"{SAFETY:g} times the method's own estimate, {worst:.2g} mm at worst"
    return max(SAFETY * worst, least), f"{said}; at least rounding, {least:.2g} mm"


def _from_half(reply: Reply, half: Reply | None) -> tuple[float, str]:
    """Richardson's estimate, of second order; NaN where it was not asked for."""
    if half is None:
        return np.nan, ""
    worst = float(np.nanmax(reply.away(half.tips), initial=0.0)) / 3
    counts = f"{ELEMENTS // 2} and {ELEMENTS} elements"
    return SAFETY * worst, f"{SAFETY:g} times Richardson's estimate from {counts}, order 2"
