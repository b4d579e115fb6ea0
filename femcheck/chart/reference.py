"""What a question's tips really are: extrapolated from a family of elements, with a band."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from beamopt.base.arrays import FloatArray
from femcheck.chart.lineup import Series
from femcheck.chart.measure import Measured, key_of
from femcheck.models.beam import TIGHTEST, RodOnOutline
from femcheck.models.question import Question
from femcheck.models.solid import SolidModel
from femcheck.solid.elements import ELEMENTS

__all__ = ["Limit", "Reference", "limits_of", "reference_of"]


@dataclass(frozen=True, eq=False)
class Limit:
    """What a family converges to.

    tips : (n, 3) extrapolated [mm]. band : (n,) what extrapolation moved them by in all, which
    the true value is taken to be within [mm]. is_whole : whether all that can be refined was.
    """

    family: str
    tips: FloatArray
    band: FloatArray
    is_whole: bool = True

    @property
    def uncertainty(self) -> float:
        """The largest band [mm]; NaN without any tip."""
        known = self.band[np.isfinite(self.band)]
        return float(known.max()) if known.size else np.nan

    def apart(self, other: Limit) -> FloatArray:
        """(n,) distances between two families' limits [mm]."""
        return np.asarray(np.linalg.norm(self.tips - other.tips, axis=1))

    def agrees(self, other: Limit) -> bool:
        """Whether two families converge to the same tips, as far as their bands tell."""
        apart = self.apart(other)
        known = np.isfinite(apart)
        return bool(known.any() and (apart[known] <= (self.band + other.band)[known]).all())


@dataclass(frozen=True, eq=False)
class Reference(Limit):
    """The limit that errors are measured from.

    others : limits of other families, which it was held against.
    """

    others: tuple[Limit, ...] = ()

    @property
    def is_confirmed(self) -> bool:
        """Whether another family was there, and all agree."""
        return bool(self.others) and all(self.agrees(other) for other in self.others)


def reference_of(
    question: Question, series: Sequence[Series], measured: Mapping[str, Measured]
) -> Reference | None:
    """The limit with the narrowest band of those that were refined in all respects.

    None where there is none. The others are held against it.

    Under the beam's own law that is the closed form, or the rod to its tightest tolerance.
    """
    limits = limits_of(series, measured, SOLVED * question.design.actuator.length)
    if question.is_of_the_beam:
        limits = [_closed_form(question), *limits]
    known = [limit for limit in limits if np.isfinite(limit.uncertainty)]
    if not known:
        return None
    whole = [limit for limit in known if limit.is_whole]
    if not whole:
        return None
    best = min(whole, key=lambda limit: limit.uncertainty)
    others = tuple(limit for limit in known if limit is not best)
    return Reference(best.family, best.tips, best.band, others=others)


LEAST_ORDER = 1.0
"""Below it three solutions do not tell yet where they lead."""

ROUNDING = 1e-10  # of the length: what is left of a closed form


def _closed_form(question: Question) -> Limit:
    length = question.design.actuator.length
    loaded = question.design.loaded_rod.loads.any
    share = TIGHTEST if loaded else ROUNDING
    model = RodOnOutline(share * length if loaded else None)
    tips = model.reply(question).tips
    band = np.where(np.isnan(tips[:, 0]), np.nan, share * length)
    return Limit("closed form" if not loaded else "beam", tips, band)


SOLVED = 1e-6  # of the length: what Newton's last steps leave of a solid's tips, extrapolated


def limits_of(
    series: Sequence[Series], measured: Mapping[str, Measured], solved: float = 0.0
) -> list[Limit]:
    """Of every family of elements that converges and has two resolutions.

    solved : what is left of the solution itself [mm], which every band has.
    """
    found = []
    for one in series:
        limit = _limit(one, measured)
        if limit is not None:
            found.append(replace(limit, band=limit.band + solved))
    return found


def _limit(series: Series, measured: Mapping[str, Measured]) -> Limit | None:
    """From the two finest, with the element's order, or the one that three show if it is lower.

    Two do not show an order: the band is as wide as the least one makes it. What finer triangles
    and stiffer penalties change is added; all of it counts in the band.
    """
    solved = [
        (model, measured[key_of(model)].reply.tips)
        for model in series.models
        if isinstance(model, SolidModel) and key_of(model) in measured
    ]
    solved = [(model, tips) for model, tips in solved if np.isfinite(tips).any()]
    if len(solved) < 2:
        return None
    (coarser, before), (finest, tips) = solved[-2:]
    order = ELEMENTS[finest.element].tip_order
    if order is None:
        return None
    least = LEAST_ORDER
    if len(solved) > 2:
        shown = _observed_order([(model.layers, own) for model, own in solved[-3:]])
        order = least = min(order, shown)
        if order < LEAST_ORDER:
            return None
    change, finer = tips - before, finest.layers / coarser.layers
    limit = tips + change / (finer**order - 1)
    band = np.linalg.norm(change, axis=1) / (finer**least - 1)
    by_layers = {model.layers: own for model, own in solved}
    extras = [extra for extra in (series.sized, series.stiffer) if extra is not None]
    is_whole = series.sized is not None
    for extra in extras:
        if key_of(extra) not in measured or extra.layers not in by_layers:
            is_whole = False
            continue
        moved = measured[key_of(extra)].reply.tips - by_layers[extra.layers]
        if not np.isfinite(moved).any():  # it was left out
            is_whole = False
            continue
        limit = limit + moved
        band = band + np.linalg.norm(moved, axis=1)
    return Limit(series.family, limit, np.asarray(band), is_whole and bool(np.isfinite(band).any()))


def _observed_order(solved: Sequence[tuple[int, FloatArray]]) -> float:
    """p of an error that goes with layers⁻ᵖ, of three solutions; 0 where they do not converge."""
    from scipy.optimize import brentq

    (a, first), (b, second), (c, third) = solved
    known = np.isfinite(first + second + third).all(axis=1)  # the largest of the same tips
    changes = [_largest((second - first)[known]), _largest((third - second)[known])]
    if not 0 < changes[1] < changes[0]:
        return 0.0

    def off(p: float) -> float:
        return float((a**-p - b**-p) / (b**-p - c**-p) - changes[0] / changes[1])

    low, high = 0.05, 12.0
    if off(low) >= 0:
        return 0.0
    return high if off(high) <= 0 else float(brentq(off, low, high))


def _largest(changes: FloatArray) -> float:
    return float(np.linalg.norm(changes, axis=1).max(initial=0.0))
