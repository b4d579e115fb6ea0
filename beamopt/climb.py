"""How far up the ladder of rods a scene has to climb, and why."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from beamopt.actuator import RUNGS, RodRules
from beamopt.arrays import FloatArray
from beamopt.rod.ladder import RodModel, Rung, SectionValues
from beamopt.rod.pressure_tree import parents_on_grid
from beamopt.workspace import pressure_grid

__all__ = ["Climb", "climb"]

Samples = Callable[[], Sequence[SectionValues]]


@dataclass(frozen=True, eq=False)
class Climb:
    """A model on its rung. reason : one sentence, for people."""

    model: RodModel
    reason: str


def climb(
    model: RodModel, rules: RodRules, levels: tuple[float, float, float], samples: Samples
) -> Climb:
    """Take the lowest rung that is exact for a model, or within its tolerance on the samples.

    Parameters
    ----------
    model : whose rung and twist are not looked at.
    rules : what is asked for.
    levels : three pressures [kPa], whose 27 combinations count.
    samples : makes sections to try the rungs on; called only where that is needed.
    """
    exact = model.lowest_rung
    if rules.rung != "auto":
        rung = RUNGS[rules.rung]
        model = replace(model, rung=rung, twists=rules.twist == "saint-venant")
        reason = "asked for" if rung is not Rung.LOADED else "asked for" + _stiffness(model)
        return Climb(model, reason + _left_out(rung, exact))
    if exact is not Rung.LOADED:
        what = "uniform section" if exact is Rung.ARC else "sections or rest shape vary"
        return Climb(replace(model, rung=exact, twists=False), f"no loads, {what}: exact")
    return _tried(model, rules, levels, samples())


def _left_out(rung: Rung, exact: Rung) -> str:
    order = list(Rung)
    lower = order.index(rung) < order.index(exact)
    return f"; {exact.value} would be exact" if lower else ""


def _stiffness(model: RodModel) -> str:
    return ", with twist and shear after Saint-Venant" if model.twists else ", without twist"


def _tried(
    model: RodModel,
    rules: RodRules,
    levels: tuple[float, float, float],
    samples: Sequence[SectionValues],
) -> Climb:
    """Try the rungs on sample sections; a sample without equilibrium needs the loads."""
    pressures, allowed = pressure_grid(levels), model.tolerance
    full = replace(model, rung=Rung.LOADED, twists=rules.twist != "stiff")
    known = [full.tips(one, pressures, parents_on_grid()).positions for one in samples]
    unloaded = replace(model, loads=type(model.loads)())
    below = replace(unloaded, rung=unloaded.lowest_rung, twists=False)
    moved = _largest(known, [below.tips(one, pressures).positions for one in samples])
    count = f"{len(samples)} sample section{'s' if len(samples) > 1 else ''}"
    if moved <= allowed:
        reason = f"the loads move the tips of {count} by at most {moved:.2g} mm"
        kept = replace(below, loads=model.loads)  # which a lower rung does not look at
        return Climb(kept, f"{reason} (tolerance {allowed:.2g} mm)")
    far = f"by up to {moved:.3g} mm" if np.isfinite(moved) else "away from any equilibrium"
    reason = f"the loads move the tips of {count} {far}"
    if rules.twist == "auto":
        stiff = replace(full, twists=False)
        tips = [stiff.tips(one, pressures, parents_on_grid()).positions for one in samples]
        twisted = _largest(known, tips)
        if twisted <= allowed:
            full = stiff
        if np.isfinite(twisted):
            reason += f", finite twist and shear by {twisted:.2g} mm"
    return Climb(full, f"{reason} (tolerance {allowed:.2g} mm){_stiffness(full)}")


def _largest(some: Sequence[FloatArray], others: Sequence[FloatArray]) -> float:
    """Largest distance of tips [mm]; infinite where one has none."""
    distances = [np.linalg.norm(a - b, axis=-1) for a, b in zip(some, others, strict=True)]
    return float(np.max(np.nan_to_num(distances, nan=np.inf)))
