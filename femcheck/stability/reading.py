"""What the map says, in sentences: counts, limits beside closed forms, the beam's validity."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from textwrap import fill

from femcheck.stability.ending import MapEnding
from femcheck.stability.found import AxisFound, MapRow, agreement_of
from femcheck.stability.solve import TraceResult
from femcheck.stability.validity import AGREE, intervals_of

__all__ = ["reading"]

MOST = 12  # lines of a list before it is cut
WIDTH = 112

SECTION = """\
The hand-made section is a ring, r 10…25 mm, with three chambers of 80°, r 13…22 mm, corners rounded
by 1 mm, of neo-Hookean silicone, E = 300 kPa, ν = ½, H/D = 2; supply 1 alone is under pressure.
Differences are between the tips of solid and beam, over the beam's displacement; both are of the
meshed polygons. A path is followed from rest through every pressure of its column, to its end."""

HOW = """\
Each case is solved by itself, by load control from rest; where that finds nothing the path is
followed anew, which tells a limit point (the load has a maximum) from a bifurcation (buckled)."""


def reading(found: Sequence[AxisFound]) -> str:
    """The text of `reading.md`."""
    rows = [row for one in found for row in one.rows]
    parts = ["# What the stability map of the solid says", _counts(found, rows), HOW, SECTION]
    parts += ["## Cells and lines", *_agreement(rows)]
    parts += ["## Limits beside closed forms", _closed_form(rows)]
    parts += ["## How far the mesh matters", *_finer(rows)]
    parts += ["## Where the beam is right", *(_valid_in(one) for one in found)]
    for one in found:
        parts += [f"## {_capital(one.axis.title)}", one.axis.told, _axis(one)]
    return "\n\n".join(_wrapped(part) for part in parts) + "\n"


def _wrapped(text: str) -> str:
    """A paragraph in lines of a readable length; tables, lists and headings as they are."""
    return text if text.startswith(("|", "-", "#")) else fill(text, WIDTH)


def _counts(found: Sequence[AxisFound], rows: Sequence[MapRow]) -> str:
    endings = Counter(cell.ending.value for row in rows for _, cell in row.solved)
    solved, asked = sum(endings.values()), sum(one.axis.count for one in found)
    counts = "; ".join(f"{name} {count}" for name, count in endings.most_common())
    missing = "" if solved == asked else f" ({asked - solved} are not solved yet)"
    return f"{solved} cases on {len(found)} panels{missing}. They end as: {counts}."


def _agreement(rows: Sequence[MapRow]) -> Iterator[str]:
    said = agreement_of(rows)
    judged = said.agree + len(said.against) + len(said.neither)
    yield (
        f"{said.agree} of {judged} cells say what the line of their column says; "
        f"{len(said.against)} say the opposite, {len(said.neither)} say neither; {said.near} more "
        "are within 1% of the line, or in columns whose path says nothing there. Where cell and "
        "path both have an equilibrium at one pressure, their tips differ by at most "
        f"{said.tips:.1g} of the displacement."
    )
    missed = sum(
        cell.ending is MapEnding.UNSTABLE and pressure < (row.trace.critical or math.inf)
        for row in rows
        for pressure, cell in row.solved
        if row.trace is not None
    )
    if missed:
        yield (
            f"In {missed} cells load control ends at an equilibrium that is unstable, although the "
            "path has a stable one there; the inertia of the tangent tells them apart."
        )
    listed = [*said.against, *said.neither]
    if listed:
        more = [f"- and {len(listed) - MOST} more"] if len(listed) > MOST else []
        yield "\n".join([*(f"- {line}" for line in listed[:MOST]), *more])


def _closed_form(rows: Sequence[MapRow]) -> str:
    """Limits of closed tubes beside the exact ones of long tubes; see `closed_tube_limit`."""
    lines = []
    for row in rows:
        exact, limit = row.column.exact, None if row.trace is None else row.trace.critical
        if exact is not None:
            shown, off = "none", ""
            if limit is not None:
                shown, off = f"{limit:.4g}", f"{limit / exact - 1:+.1%}"
            lines.append((f"{row.axis.title}: {row.label}", shown, f"{exact:.5g}", off))
    if not lines:
        return "No specimen of this map has a limit in closed form."
    return _table("specimen | found [kPa] | long tube, closed ends [kPa] | difference", lines)


def _finer(rows: Sequence[MapRow]) -> Iterator[str]:
    yield (
        "The map is made on coarse meshes. The same specimens on finer ones, their polygons five "
        "times nearer to the arcs and half as many layers more:"
    )
    lines = []
    for row in rows:
        coarse, fine = row.trace, row.finer
        if coarse is None or fine is None:
            continue
        off = ""
        if coarse.critical is not None and fine.critical is not None:
            off = f"{coarse.critical / fine.critical - 1:+.1%}"
        limits = [
            one.ending.value if one.critical is None else f"{one.critical:.4g}"
            for one in (coarse, fine)
        ]
        meshes = [
            f"{one.triangles} × {one.layers}, {one.unknowns:,} unknowns" for one in (coarse, fine)
        ]
        valid = [_valid(one) for one in (coarse, fine)]
        lines.append((f"{row.axis.title}: {row.label}", *limits, off, *valid, *meshes))
    head = (
        "specimen | limit [kPa] | on the finer mesh | difference | beam within "
        f"{AGREE:.0%} | on the finer mesh | triangles × layers | finer"
    )
    yield _table(head, lines)


def _valid_in(one: AxisFound) -> str:
    """Where the beam is within 5 % of one panel's solids, in a sentence."""
    found = {
        row.label: intervals_of(row.trace.track)
        for row in one.rows
        if row.trace is not None and row.trace.track
    }
    valid = [label for label, intervals in found.items() if intervals]
    passed = [label for label in valid if all(i.begins and i.ends for i in found[label])]
    from_rest = [label for label in valid if not found[label][0].begins]
    stays = [label for label in valid if not found[label][-1].ends]
    widest = max((i.high - i.low for label in passed for i in found[label]), default=0.0)
    passing = (
        f"only where the solid's tip passes the beam's on its way, over at most {widest:.2g} kPa, "
        "which is no validity"
    )
    groups = (
        ("from rest on", from_rest),
        (
            "from some pressure on, to the end of the path",
            [x for x in stays if x not in from_rest],
        ),
        (passing, passed),
        ("nowhere", [label for label in found if label not in valid]),
    )
    said = [f"for {_list(labels, len(found))} {text}" for text, labels in groups if labels]
    return f"**{_capital(one.axis.title)}**: the beam is within {AGREE:.0%}: {'; '.join(said)}."


def _list(labels: Sequence[str], of: int) -> str:
    return "every column" if len(labels) == of > 1 else ", ".join(labels)


def _capital(text: str) -> str:
    return text[0].upper() + text[1:]


def _axis(one: AxisFound) -> str:
    lines = []
    for row in one.rows:
        trace = row.trace
        if trace is None:
            continue
        ends = trace.ending.value
        if trace.critical is not None:
            ends += f" at {trace.critical:.4g} kPa"
        elif trace.ending.has_equilibrium:
            ends = f"not up to {row.axis.pressures[-1]:g} kPa"
        if trace.snaps:
            ends += ", after snaps at " + ", ".join(f"{at:.4g}" for at in trace.snaps) + " kPa"
        growth = "" if trace.growth is None else f"{trace.growth:.2g} ×"
        lines.append((row.label, ends, growth, _valid(trace)))
    head = f"{one.axis.label or one.axis.title} | path ends | chamber grows | beam within"
    return _table(f"{head} {AGREE:.0%}", lines)


def _valid(trace: TraceResult) -> str:
    if not trace.track:
        return ""
    said = [
        f"{one.low:.3g}…{one.high:.3g} kPa" + ("" if one.ends else " (the end)")
        for one in intervals_of(trace.track)
    ]
    return " and ".join(said) or "nowhere"


def _table(head: str, lines: Iterable[Sequence[str]]) -> str:
    """A table; `head` has its cells between bars."""
    rule = " | ".join("---" for _ in head.split("|"))
    return "\n".join(f"| {line} |" for line in (head, rule, *(" | ".join(one) for one in lines)))
