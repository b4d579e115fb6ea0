"""How far up the ladder of rods a scene has to climb, and why."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.rod.ladder import RodModel, Rung, SectionValues
from beamopt.rod.pressure_tree import parents_on_grid
from beamopt.scene.actuator import RUNGS, RodRules
from beamopt.target.workspace import pressure_grid

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
    asked = None if rules.rung == "auto" else RUNGS[rules.rung]
    if asked is Rung.LOADED and exact is Rung.LOADED:
        full, twist = _twisting(model, rules, levels, samples())
        return Climb(full, f"asked for{twist}")
    if asked is not None:
        neglects = list(Rung).index(asked) < list(Rung).index(exact)
        left_out = f"; {exact.value} would be exact" if neglects else ""
        return Climb(replace(model, rung=asked, twists=False), f"asked for{left_out}")
    if exact is not Rung.LOADED:
        what = "uniform section" if exact is Rung.ARC else "sections or rest shape vary"
        return Climb(replace(model, rung=exact, twists=False), f"no loads, {what}: exact")
    return _tried(model, rules, levels, samples())


def _tried(
    model: RodModel,
    rules: RodRules,
    levels: tuple[float, float, float],
    samples: Sequence[SectionValues],
) -> Climb:
    """Try the lower rung on sample sections; one without equilibrium needs the loads."""
    full, twist = _twisting(model, rules, levels, samples)
    pressures = pressure_grid(levels)
    unloaded = replace(model, loads=type(model.loads)())
    below = replace(unloaded, rung=unloaded.lowest_rung, twists=False)
    away = [
        np.linalg.norm(
            full.tips(one, pressures, parents_on_grid(), all_or_none=True).positions
            - below.tips(one, pressures).positions,
            axis=1,
        )
        for one in samples
    ]
    moved, lost = _summed_up(away)
    count = f"{len(samples)} sample section{'' if len(samples) == 1 else 's'}"
    said = f"the loads move the tips of {count} by"
    allowed = f"(tolerance {model.tolerance:.2g} mm)"
    if samples and not lost and moved <= model.tolerance:
        kept = replace(below, loads=model.loads)  # which a lower rung does not look at
        return Climb(kept, f"{said} at most {moved:.2g} mm {allowed}")
    without = "; some have no equilibrium under them" if lost else ""
    return Climb(full, f"{said} up to {moved:.3g} mm {allowed}{without}{twist}")


def _twisting(
    model: RodModel,
    rules: RodRules,
    levels: tuple[float, float, float],
    samples: Sequence[SectionValues],
) -> tuple[RodModel, str]:
    """The loaded model with twist and shear or without, and why."""
    full = replace(model, rung=Rung.LOADED, twists=rules.twist != "stiff")
    if rules.twist != "auto":
        return full, ", with twist and shear" if full.twists else ", without twist"
    pressures, stiff = pressure_grid(levels), replace(full, twists=False)
    away = [
        np.linalg.norm(
            full.tips(one, pressures, parents_on_grid(), all_or_none=True).positions
            - stiff.tips(one, pressures, parents_on_grid(), all_or_none=True).positions,
            axis=1,
        )
        for one in samples
    ]
    moved, lost = _summed_up(away)
    if samples and not lost and moved <= model.tolerance:
        return stiff, f"; twist and shear would move them by {moved:.2g} mm"
    return full, f"; twist and shear move them by up to {moved:.2g} mm"


def _summed_up(away: Sequence[FloatArray]) -> tuple[float, int]:
    """Largest distance [mm] of tips that are there, and how many are not."""
    distances = np.array(away)
    there = np.isfinite(distances)
    return float(distances[there].max(initial=0.0)), int((~there).sum())
