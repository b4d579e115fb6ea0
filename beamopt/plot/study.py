"""Figures of a study: losses over generations, best and worst designs beside their target."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from beamopt.arrays import FloatArray
from beamopt.design import Design
from beamopt.plot.section import draw_section
from beamopt.plot.style import (
    BELOW,
    SERIES_COLOURS,
    count_generations,
    log_losses,
    new_figure,
    styled,
)
from beamopt.plot.workspace import draw_diagonal, draw_from_above
from beamopt.target import Target

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["case_figure", "losses_figure"]


@styled
def losses_figure(
    spreads: Mapping[str, Mapping[str, FloatArray]], titles: Mapping[str, str]
) -> Figure:
    """Minimum, mean and maximum of L over the iterations: a panel a target (paper, Fig. loss).

    spreads : target → combination → (3, generations + 1) [mm²].
    """
    figure = new_figure(13.0, 4.2)
    panels = figure.subplots(1, len(spreads))
    dashes = ("-", (0, (5, 1.5)), "-.", (0, (1, 1)))
    for axes, (target, lines) in zip(np.atleast_1d(panels), spreads.items(), strict=True):
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
    wanted = target.workspace
    if target.section is not None:
        draw_section(figure.add_subplot(*shape, 1), target.section, "target's section")
    first = figure.add_subplot(*shape, 1 + shape[1])
    draw_from_above(first, None, wanted)
    draw_diagonal(figure.add_subplot(*shape, 1 + 2 * shape[1], projection="3d"), None, wanted)
    for k, (title, design) in enumerate(designs, 2):
        draw_section(figure.add_subplot(*shape, k), design.section, title)
        above = figure.add_subplot(*shape, k + shape[1], sharex=first, sharey=first)
        draw_from_above(above, design.workspace, wanted)
        above.legend(**BELOW)
        diagonal = figure.add_subplot(*shape, k + 2 * shape[1], projection="3d")
        draw_diagonal(diagonal, design.workspace, wanted)
    return figure
