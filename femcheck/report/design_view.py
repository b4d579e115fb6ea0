"""Runs of one design together, and a line for each in the summary."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from femcheck.report.accuracy_run import AccuracyRun, AccuracyView, accuracy_view
from femcheck.report.embedding import Picture, drawn
from femcheck.report.figures import section_figure
from femcheck.report.other_runs import SearchRun
from femcheck.report.other_views import SearchView, search_view
from femcheck.report.run_view import RunView, view_of
from femcheck.report.solid_run import SolidRun
from femcheck.report.wording import Badge, badge_of, duration, number, per_cent

__all__ = ["DesignView", "RunLine", "design_views"]


@dataclass(frozen=True, slots=True)
class RunLine:
    """A run in the summary. anchor : where the page has more. cells : as its columns."""

    name: str
    anchor: str
    question: str
    badge: Badge
    cells: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class DesignView:
    """A design and all that was found out about it.

    section : None where there is no check and no prediction of it. facts : names and values, from
        its file.
    """

    name: str
    anchor: str
    section: Picture | None
    facts: tuple[tuple[str, str], ...]
    searches: tuple[SearchView, ...]
    runs: tuple[RunView, ...]
    answers: tuple[AccuracyView, ...]
    lines: tuple[RunLine, ...]


def design_views(
    runs: Sequence[SolidRun], answers: Sequence[AccuracyRun], searches: Sequence[SearchRun]
) -> list[DesignView]:
    """Put together what belongs to the same design: whose design files are the same.

    Raises
    ------
    InputError : a deformed mesh that is damaged.
    """
    texts = dict.fromkeys(
        [*(run.design_text for run in runs), *(one.design_text for one in answers)]
    )
    views = []
    count = 0
    for text in texts:
        count += 1
        mine = [run for run in runs if run.design_text == text]
        asked = [one for one in answers if one.design_text == text]
        found = [one for one in searches if one.design_text == text]
        views.append(_view(mine, asked, found, f"design-{count}"))
    for alone in searches:
        if alone.design_text not in texts:
            count += 1
            anchor = f"design-{count}"
            views.append(
                DesignView(alone.name, anchor, None, (), (search_view(alone),), (), (), ())
            )
    return views


def _view(
    runs: Sequence[SolidRun],
    answers: Sequence[AccuracyRun],
    searches: Sequence[SearchRun],
    anchor: str,
) -> DesignView:
    caption = "The section that was meshed; material grey, chambers numbered by their supply."
    named = [(run, f"{anchor}-run-{place}") for place, run in enumerate(runs, 1)]
    asked = [(run, f"{anchor}-accuracy-{place}") for place, run in enumerate(answers, 1)]
    return DesignView(
        runs[0].subject.name if runs else answers[0].name,
        anchor,
        drawn("section", section_figure(runs[0].subject), caption) if runs else None,
        tuple(_facts(runs[0])) if runs else (),
        tuple(search_view(one) for one in searches),
        tuple(view_of(run, name) for run, name in named),
        tuple(accuracy_view(run, name) for run, name in asked),
        (
            *(_line(run, name) for run, name in named),
            *(_accuracy_line(run, name) for run, name in asked),
        ),
    )


def _facts(run: SolidRun) -> Iterator[tuple[str, str]]:
    """What the design is, as far as the section's picture does not say it."""
    design, summary = run.subject.design, run.summary
    grid, actuator = design.grid, design.actuator
    yield "ring", f"radii {grid.inner_radius:g} … {grid.outer_radius:g} mm"
    yield "length", f"{actuator.length:g} mm, {run.subject.slenderness:.3g} outer diameters"
    yield "Young's modulus", f"{actuator.youngs_modulus:g} kPa"
    yield "pressures", ", ".join(f"{level:g}" for level in design.pressures) + " kPa"
    chambers = " + ".join(str(count) for count in summary.chambers)
    yield "chambers", f"{chambers}, of supplies 1, 2, 3"
    if summary.thinnest_wall is not None:
        yield "thinnest wall", f"{number(summary.thinnest_wall)} mm"
    for key in ("scene", "seed"):
        if key in design.notes:
            yield key, str(design.notes[key])


def _line(run: SolidRun, anchor: str) -> RunLine:
    summary = run.summary
    box = "–" if summary.stable_box is None else f"{number(summary.stable_box)} kPa"
    return RunLine(
        run.subject.name,
        anchor,
        "prediction" if run.is_prediction else "implementation",
        badge_of(run),
        (
            summary.law,
            per_cent(summary.agree),
            per_cent(summary.worst),
            per_cent(summary.median),
            box,
            duration(run.seconds),
        ),
    )


def _accuracy_line(run: AccuracyRun, anchor: str) -> RunLine:
    summary = run.summary
    law, asked = summary.law, f"{number(summary.accuracy_mm)} mm"
    cells = (law, asked, "–", "–", "–", duration(run.seconds))
    return RunLine(run.name, anchor, "to an accuracy", run.badge, cells)
