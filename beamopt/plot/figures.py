"""Whole figures, put together from the pictures of sections and workspaces."""

from __future__ import annotations

from collections.abc import Sequence
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
from beamopt.plot.workspace import draw_diagonal, draw_down, draw_from_above, pressure_handles
from beamopt.rod.pressure_tree import parents_on_grid
from beamopt.scene.design import Design
from beamopt.target.target import Target
from beamopt.target.workspace import Workspace

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["convergence_figure", "design_figure", "design_title"]


def design_title(design: Design) -> str:
    """Scene and loss of a design that a search made; "" for another one."""
    name, loss = design.notes.get("scene"), design.notes.get("L")
    return f"{name}: L = {loss:.4g} mm²" if name and isinstance(loss, float) else ""


@styled
def design_figure(
    design: Design, target: Workspace | Target | None = None, title: str = ""
) -> Figure:
    """A section beside its workspace, from above and diagonally, over the target if there is one.

    Backbones are coloured by pressure: supply 1 red, 2 green, 3 blue. Beside a target without a
    workspace stand the design's tips at the target's pressures; trajectories with what is reached.

    Examples
    --------
    >>> import beamopt
    >>> design = beamopt.load_design(str(beamopt.load_scene("sealed-section").target.file))
    >>> beamopt.design_figure(design).savefig("design.png")
    """
    wanted = target if isinstance(target, Target) or target is None else Target.of_workspace(target)
    figure = new_figure(13.0, 5.6, below=0.1)
    left, middle = figure.add_subplot(131), figure.add_subplot(132)
    right = figure.add_subplot(133, projection="3d")
    sealed = design.seal.rules.sealed
    draw_section(left, design.section, "section", design.outline if sealed else None)
    space, aimed, followed = answered(design, wanted), asked(wanted), following(design, wanted)
    on_grid = isinstance(space, Workspace)
    lines = design.climb.model.backbones(
        design.values, space.pressures, parents_on_grid() if on_grid else None
    )
    draw_from_above(middle, space, aimed, lines, followed)
    draw_diagonal(right, space, aimed, lines, followed)
    if not on_grid or followed is not None:
        middle.set_adjustable("datalim")  # tips may lie in a narrow strip
    if design.loads.weighs:
        draw_down(right, -design.loads.mount[2], lines.reshape(-1, 3))
    middle.legend(handles=[*middle.get_legend_handles_labels()[0], *pressure_handles()], **BELOW)
    if title:
        figure.suptitle(title)
    return figure


@styled
def convergence_figure(
    lowest: Sequence[float], mean: FloatArray, ever: Sequence[float], title: str = ""
) -> Figure:
    """L over generations: lowest and mean of the population, lowest ever [mm²]."""
    figure = new_figure(6.4, 4.0)
    axes = figure.add_subplot()
    axes.plot(mean, color=ASIDE_COLOUR, lw=1.0, label="mean of the population")
    axes.plot(lowest, color=SERIES_COLOURS[0], lw=1.6, label="lowest of the population")
    axes.plot(ever, color=SERIES_COLOURS[1], lw=1.2, ls="--", label="lowest so far")
    axes.set(xlabel="generation", ylabel="loss L [mm²]", title=title)
    log_losses(axes, np.array(ever))
    count_generations(axes)
    axes.grid(True, which="both")
    axes.legend()
    return figure
