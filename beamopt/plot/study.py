"""Figures of a study: losses over generations, best and worst designs beside their target."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.plot.section import draw_section
from beamopt.plot.style import (
    ASIDE_COLOUR,
    BELOW,
    SERIES_COLOURS,
    count_generations,
    log_losses,
    new_figure,
    styled,
)
from beamopt.plot.targets import answered, asked, following
from beamopt.plot.workspace import draw_diagonal, draw_from_above
from beamopt.scene.design import Design
from beamopt.target.target import Target

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["case_figure", "losses_figure", "refined_figure"]


@styled
def losses_figure(
    spreads: Mapping[str, Mapping[str, FloatArray]], titles: Mapping[str, str]
) -> Figure:
    """Minimum, mean and maximum of L over the iterations: a panel a target (paper, Fig. loss).

    spreads : target → combination → (3, generations + 1) [mm²].
    """
    figure = new_figure(13.0, 4.2)
    panels = np.atleast_1d(figure.subplots(1, len(spreads)))
    dashes = ("-", (0, (5, 1.5)), "-.", (0, (1, 1)))
    for axes, (target, lines) in zip(panels, spreads.items(), strict=True):
        for (name, spread), colour, dash in zip(lines.items(), SERIES_COLOURS, dashes, strict=True):
            low, mean, high = spread
            axes.fill_between(np.arange(len(mean)), low, high, color=colour, alpha=0.13, lw=0)
            axes.plot(mean, color=colour, ls=dash, lw=1.5, label=f"{name} {mean[-1]:,.1f}")
        axes.set(xlabel="generation", title=titles.get(target, target))
        log_losses(axes, np.stack([spread[1] for spread in lines.values()]))
        count_generations(axes)
        axes.grid(True)
        axes.legend(title="mean, at the end [mm²]", loc="upper right", frameon=True, framealpha=0.8)
    panels[0].set_ylabel("lowest L of the population [mm²]")
    return figure


@styled
def case_figure(target: Target, designs: Sequence[tuple[str, Design]]) -> Figure:
    """A column for the target and one for each design: section, from above, diagonally."""
    figure = new_figure(4.4 * (1 + len(designs)), 12.5)
    shape = (3, 1 + len(designs))
    wanted, paths = asked(target), following(None, target)
    if target.section is not None:
        draw_section(figure.add_subplot(*shape, 1), target.section, "target's section")
    first = figure.add_subplot(*shape, 1 + shape[1])
    draw_from_above(first, None, wanted, followed=paths)
    diagonal = figure.add_subplot(*shape, 1 + 2 * shape[1], projection="3d")
    draw_diagonal(diagonal, None, wanted, followed=paths)
    for k, (title, design) in enumerate(designs, 2):
        draw_section(figure.add_subplot(*shape, k), design.section, title)
        above = figure.add_subplot(*shape, k + shape[1], sharex=first, sharey=first)
        space, paths = answered(design, target), following(design, target)
        draw_from_above(above, space, wanted, followed=paths)
        above.legend(**BELOW)
        diagonal = figure.add_subplot(*shape, k + 2 * shape[1], projection="3d")
        draw_diagonal(diagonal, space, wanted, followed=paths)
    return figure


@styled
def refined_figure(
    points: Mapping[str, FloatArray], bounds: Mapping[str, float | None], titles: Mapping[str, str]
) -> Figure:
    """Loss and neighbour ratio of every search's best design and of what refining made of it.

    points : target → (runs, 4): L before and after [mm²], ratio before and after.
    """
    figure = new_figure(13.0, 4.4)
    panels = np.atleast_1d(figure.subplots(1, len(points)))
    for axes, (target, rows) in zip(panels, points.items(), strict=True):
        before, after, ratio, refined = rows[np.isfinite(rows).all(axis=1)].T
        for k in range(len(before)):
            axes.plot([ratio[k], refined[k]], [before[k], after[k]], color=ASIDE_COLOUR, lw=0.5)
        axes.plot(ratio, before, "o", color=SERIES_COLOURS[0], ms=4, label="genetic algorithm")
        axes.plot(refined, after, "^", color=SERIES_COLOURS[1], ms=4, label="refined")
        low = bounds[target]
        if low is not None and low > 1e-6:
            axes.axhline(low, color="black", ls="--", lw=1.0, label=f"bound {low:.4g} mm²")
        axes.set(xlabel="neighbour ratio", title=titles.get(target, target))
        if (before > 0).any():
            axes.set_yscale("log")
        axes.grid(True)
        axes.legend(frameon=True, framealpha=0.8)
    panels[0].set_ylabel("L [mm²]")
    return figure
