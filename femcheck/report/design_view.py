"""Runs of one design together, and a line for each in the summary."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from femcheck.report.embedding import Picture, drawn
from femcheck.report.figures import section_figure
from femcheck.report.other_runs import SearchRun
from femcheck.report.other_views import SearchView, search_view
from femcheck.report.run_view import RunView, view_of
from femcheck.report.solid_run import SolidRun
from femcheck.report.wording import Badge, badge_of, duration, number, per_cent

__all__ = ["DesignView", "Line", "design_views"]


@dataclass(frozen=True, slots=True)
class Line:
    """A run in the summary. anchor : where the page has more. cells : as its columns."""

    name: str
    anchor: str
    question: str
    badge: Badge
    cells: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class DesignView:
    """A design and all that was found out about it.

    section : None where no solid was made of it. facts : names and values, from its file.
    """

    name: str
    anchor: str
    section: Picture | None
    facts: tuple[tuple[str, str], ...]
    searches: tuple[SearchView, ...]
    runs: tuple[RunView, ...]
    lines: tuple[Line, ...]


def design_views(runs: Sequence[SolidRun], searches: Sequence[SearchRun]) -> list[DesignView]:
    """Put together what belongs to the same design: whose design files are the same.

    Raises
    ------
    InputError : a deformed mesh that is damaged.
    """
    texts = dict.fromkeys(run.design_text for run in runs)
    views = []
    count = 0
    for text in texts:
        count += 1
        mine = [run for run in runs if run.design_text == text]
        found = [one for one in searches if one.design_text == text]
        views.append(_view(mine, found, f"design-{count}"))
    for alone in searches:
        if alone.design_text not in texts:
            count += 1
            anchor = f"design-{count}"
            views.append(DesignView(alone.name, anchor, None, (), (search_view(alone),), (), ()))
    return views


def _view(runs: Sequence[SolidRun], searches: Sequence[SearchRun], anchor: str) -> DesignView:
    subject = runs[0].subject
    caption = "The section that was meshed; material grey, chambers numbered by their supply."
    anchors = [f"{anchor}-run-{place}" for place in range(1, len(runs) + 1)]
    return DesignView(
        subject.name,
        anchor,
        drawn("section", section_figure(subject), caption),
        tuple(_facts(runs[0])),
        tuple(search_view(one) for one in searches),
        tuple(view_of(run, name) for run, name in zip(runs, anchors, strict=True)),
        tuple(_line(run, name) for run, name in zip(runs, anchors, strict=True)),
    )


def _facts(run: SolidRun) -> Iterator[tuple[str, str]]:
    """What the design is, as far as the section's picture does not say it."""
    design, summary = run.subject.design, run.summary
    grid, actuator = design.grid, design.actuator
    yield "ring", f"radii {grid.inner_radius:g} … {grid.outer_radius:g} mm"
    yield "length", f"{actuator.length:g} mm, {run.subject.slenderness:.3g} outer diameters"
    yield "Young's modulus", f"{actuator.youngs_modulus:g} kPa"
    yield "pressures", ", ".join(f"{level:g}" for level in design.pressures) + " kPa"
    chambers = " + ".join(str(count) for count in summary.list("section.chambers"))
    yield "chambers", f"{chambers}, of supplies 1, 2, 3"
    if summary.has("mesh.thinnest_wall_mm"):
        yield "thinnest wall", f"{number(summary.number('mesh.thinnest_wall_mm'))} mm"
    for key in ("scene", "seed"):
        if key in design.notes:
            yield key, str(design.notes[key])


def _line(run: SolidRun, anchor: str) -> Line:
    summary = run.summary
    box = (
        f"{number(summary.number('stable_box_kpa'))} kPa" if summary.has("stable_box_kpa") else "–"
    )
    return Line(
        run.subject.name,
        anchor,
        "prediction" if run.is_prediction else "implementation",
        badge_of(run),
        (
            summary.text("verdict.law"),
            per_cent(summary.number("verdict.agree")),
            per_cent(summary.number_or_nan("difference.worst_of_displacement")),
            per_cent(summary.number_or_nan("difference.median_of_displacement")),
            box,
            duration(run.seconds),
        ),
    )
