"""A prediction drawn: pressure against chamber growth, and strains along the axis."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.plot.style import (
    ASIDE_COLOUR,
    DESIGN_COLOUR,
    SUPPLY_COLOURS,
    new_figure,
    styled,
)
from femcheck.continuation.outcome import Status
from femcheck.prediction.prediction import Prediction

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["axis_figure", "paths_figure"]

DASHES = ("-", "--", "-.", ":")
"""Of supplies 1, 2, 3 and all alike: told apart without colour too."""


@styled
def paths_figure(found: Prediction) -> Figure:
    """Pressure against what it does to the chambers' volume; where each path ends."""
    figure = new_figure(7.0, 4.4)
    axes = figure.add_subplot()
    for number, ray in enumerate(found.rays):
        track = found.result(number).track
        if len(track) == 0:
            continue
        weights = np.abs(np.array(ray.direction))
        volume = track[:, 1:4] @ weights
        growth = volume / volume[0] if volume[0] > 0 else np.ones_like(volume)
        if ray.is_principal:
            colour, dashes = _look(ray.supplies)
            axes.plot(growth, track[:, 0], dashes, color=colour, lw=1.8, label=ray.text, zorder=3)
        else:
            axes.plot(growth, track[:, 0], color=ASIDE_COLOUR, lw=0.6, zorder=1)
        _mark_end(axes, found, number, growth, track[:, 0])
    axes.plot([], [], color=ASIDE_COLOUR, lw=0.6, label="other directions")
    axes.plot([], [], "o", color=DESIGN_COLOUR, ms=4, label="limit point")
    axes.plot([], [], "X", color=DESIGN_COLOUR, ms=5, label="other end")
    if found.first_to_end is not None:
        look: dict[str, Any] = {"color": DESIGN_COLOUR, "lw": 0.7, "ls": (0, (1, 3))}
        axes.axhline(found.safe_box.pressure, label="advised at most", **look)
    axes.set(xlabel="volume of the loaded chambers / that at rest", ylabel="pressure [kPa]")
    axes.set_title(f"{found.subject.name}: {found.options.title}")
    axes.set_ylim(bottom=0)
    axes.grid(True)
    axes.legend(loc="best")
    return figure


def _mark_end(
    axes: Axes, found: Prediction, number: int, growth: FloatArray, load: FloatArray
) -> None:
    result = found.result(number)
    if result.status is Status.CONVERGED or result.last is None:
        return
    at = int(np.argmin(np.abs(load - result.critical)))
    marker = "o" if result.status is Status.LIMIT_POINT else "X"
    axes.plot(growth[at], result.critical, marker, color=DESIGN_COLOUR, ms=4, zorder=4)


def _look(supplies: tuple[int, ...]) -> tuple[str, str]:
    if len(supplies) == 1:
        return SUPPLY_COLOURS[supplies[0] - 1], DASHES[supplies[0] - 1]
    return DESIGN_COLOUR, DASHES[3]


@styled
def axis_figure(found: Prediction) -> Figure:
    """Curvature and stretch along the actuator, solid and beam, each supply alone and all alike.

    Of the last stable equilibrium: what clamp and cap disturb is where the solid is not constant.
    """
    figure = new_figure(7.0, 5.8, below=0.12)
    bending, stretching = figure.subplots(2, 1, sharex=True)
    length = found.subject.design.actuator.length
    for number, ray in enumerate(found.rays):
        last = found.result(number).last
        if not ray.is_principal or last is None or last.load == 0:
            continue
        pressures = last.load * np.array(ray.direction)
        beam = found.subject.response.strains(pressures[None])[0]
        colour, dashes = _look(ray.supplies)
        z, stretch, *curvature = last.axis.T
        along = beam[1:] / max(float(np.linalg.norm(beam[1:])), 1e-300)
        label = f"{ray.text}, {last.load:.3g} kPa"
        look: dict[str, Any] = {"color": colour, "ls": dashes, "marker": ".", "ms": 4}
        bending.plot(z, 1e3 * along @ np.array(curvature), label=label, **look)
        stretching.plot(z, 100 * stretch, **look)
        for axes, value in ((bending, 1e3 * np.hypot(*beam[1:])), (stretching, 100 * beam[0])):
            axes.plot([0, length], [value, value], dashes, color=colour, lw=0.7, alpha=0.6)
    bending.set_ylabel("curvature, the beam's way [1/m]")
    stretching.set(ylabel="extension [%]", xlabel="along the actuator at rest [mm]")
    diameter = 2 * found.subject.design.grid.outer_radius
    for axes in (bending, stretching):
        axes.grid(True)
        for end in (diameter, length - diameter):
            if 0 < end < length:
                axes.axvline(end, color=ASIDE_COLOUR, lw=0.7, ls=(0, (1, 3)))
    slenderness = f"H/D = {found.subject.slenderness:.3g}"
    bending.set_title(f"{found.subject.name}: {found.options.title}, {slenderness}")
    bending.plot([], [], color=ASIDE_COLOUR, lw=0.7, label="thin: the beam")
    bending.plot([], [], color=ASIDE_COLOUR, lw=0.7, ls=(0, (1, 3)), label="a diameter from an end")
    figure.legend(*bending.get_legend_handles_labels(), loc="lower center", ncols=3)
    return figure
