"""What a stability map says, in words: where methods succeed, where and how they fail."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from textwrap import fill

import numpy as np

from beamopt.rod.status import RodStatus
from beamopt.rod_map.cases import CaseKind, sizes_of
from beamopt.rod_map.sampling import ADAPTIVE, LIMIT, MethodSample, Sample
from beamopt.rod_map.summary import Rates, rates_of
from beamopt.rod_map.verdict import NEAR, RIGHT, MethodVerdict, Witness

__all__ = ["reading"]

SAFE = 0.9  # share of successes in all cells up to a size that counts as mastered
MOST_LISTED = 20
WIDTH = 110
SENSE = 10.0  # sizes up to this one are what scenes are made of

Rows = dict[str, list[MethodSample]]


def reading(samples: Sequence[Sample]) -> str:
    """The text, in Markdown."""
    rows: Rows = {}
    for sample in samples:
        for row in sample.rows:
            rows.setdefault(row.method, []).append(row)
    rates = {method: rates_of(own) for method, own in rows.items()}
    parts = [
        "# Where methods for loaded rods are right",
        _setting(samples),
        "## Rates",
        _rates_table(rows, rates),
        "## Where each is right",
        f"The largest size up to which a method succeeds in at least {SAFE:.0%} of the cases of "
        "every size.",
        _reach_table(rows),
        "## How each fails",
        "\n".join(f"- **{method}**: {_failures(rows[method], rates[method])}" for method in rates),
        "## Successes less wrong tips",
        _order(rows, rates),
        f"## Wrong tips of {ADAPTIVE} and modes, by case",
        _wrong_tips(rows),
    ]
    return "\n\n".join(parts) + "\n"


def _setting(samples: Sequence[Sample]) -> str:
    witnesses = Counter(sample.witness for sample in samples)
    refusing = sum(
        sample.truth is not RodStatus.CONVERGED
        for sample in samples
        if sample.witness is not Witness.NEITHER
    )
    return _paragraph(
        f"{len(samples):,} random sections, each as a rod under one load, from its straight rest.",
        "The truth is where growing loads lead through stable equilibria, as strain modes and",
        "elements find it that both follow the load: in",
        f"{witnesses[Witness.BOTH]:,} cases they agree; in {witnesses[Witness.ELEMENTS]} elements",
        f"alone find it, in {witnesses[Witness.MODES]} modes alone, where the other method fails;",
        f"{witnesses[Witness.NEITHER]} are undecided and are left out of all rates.",
        f"In {refusing} of the decided cases there is no equilibrium, and",
        f"a status is the right answer. Right is a tip within {RIGHT:.0%} of the length, a wrong",
        f"branch one that is more than {NEAR:.0%} away, for whatever reason; too slow is more than",
        f"{LIMIT:g} s of processor time.",
    )


def _paragraph(*parts: str) -> str:
    return fill(" ".join(parts), WIDTH)


def _rates_table(rows: Rows, rates: dict[str, Rates]) -> str:
    lines = [
        "| method | success | inaccurate | refused wrongly | too slow | wrong tip | median time "
        f"| success up to size {SENSE:g} | wrong tip there |",
        "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for method, one in rates.items():
        verdicts = (MethodVerdict.INACCURATE, MethodVerdict.REFUSED_WRONGLY, MethodVerdict.TOO_SLOW)
        shares = [one.verdicts[verdict] / max(one.decided, 1) for verdict in verdicts]
        cells = [f"{share:.1%}" for share in (one.success, *shares, one.wrong_tips)]
        cells.append(f"{1e3 * one.seconds:.2g} ms")
        sane = rates_of([row for row in rows[method] if row.case.size <= SENSE])
        cells += [f"{sane.success:.1%}", f"{sane.wrong_tips:.1%}"]
        lines.append(f"| {method} | {' | '.join(cells)} |")
    return "\n".join(lines)


def _reach_table(rows: Rows) -> str:
    head = " | ".join(kind.value for kind in CaseKind)
    lines = [f"| method | {head} |", f"| --- |{' ---: |' * len(CaseKind)}"]
    for method, own in rows.items():
        cells = [_reach(own, kind) for kind in CaseKind]
        lines.append(f"| {method} | {' | '.join(cells)} |")
    return "\n".join(lines)


def _reach(rows: Sequence[MethodSample], kind: CaseKind) -> str:
    """The largest size up to which a method masters a kind of load; what was reached at all."""
    reached, beyond = None, False
    for size in sizes_of(kind):
        rates = rates_of([row for row in rows if (row.case.kind, row.case.size) == (kind, size)])
        if not rates.decided:
            continue
        if rates.success < SAFE:
            beyond = True
            break
        reached = size
    if reached is None:
        return "none"
    return f"{reached:g}" if beyond else f"{reached:g} (all)"


def _failures(rows: Sequence[MethodSample], rates: Rates) -> str:
    """Verdicts other than success, the commonest first, with the kinds of load they come with."""
    said = []
    for verdict, count in rates.verdicts.most_common():
        if verdict.is_success or verdict is MethodVerdict.UNDECIDED:
            continue
        kinds = Counter(row.case.kind.value for row in rows if row.verdict is verdict)
        where = ", ".join(f"{kind} {number}" for kind, number in kinds.most_common())
        text = f"{verdict.value} {count} ({where})"
        if verdict is MethodVerdict.REFUSED_WRONGLY:
            why = rates.reasons.most_common()
            text += ", saying " + ", ".join(f"“{one.value}” {number}" for one, number in why)
        said.append(text)
    return "; ".join(said) + "." if said else "nowhere in this map."


def _score(rates: Rates) -> float:
    """A refusal tells nothing, a wrong tip tells what is not so."""
    return rates.success - rates.wrong_tips if rates.decided else -np.inf


def _order(rows: Rows, rates: dict[str, Rates]) -> str:
    """The methods by their score, and what the first two come to together."""
    order = sorted(
        (name for name in rates if name != ADAPTIVE),
        key=lambda name: (-_score(rates[name]), rates[name].seconds),
    )
    if len(order) < 2:
        return "Too few methods were tried."
    first, second = order[:2]
    known = {row.case.index: row.verdict for row in rows[first]}
    missed = {index for index, verdict in known.items() if _is_failure(verdict)}
    wrong = {index for index in missed if known[index].is_wrong_tip}
    right = {row.case.index for row in rows[second] if row.verdict.is_success}
    a, b = rates[first], rates[second]
    said = [
        "Share of successes less share of wrong tips:",
        ", ".join(f"{name} {_score(rates[name]):.3f}" for name in order) + ".",
        f"First: **{first}** ({a.success:.1%} success, {a.wrong_tips:.1%} wrong tips,",
        f"{1e3 * a.seconds:.2g} ms); second: **{second}** ({b.success:.1%}, {b.wrong_tips:.1%},",
        f"{1e3 * b.seconds:.2g} ms). {second} succeeds in {len(missed & right)} of the",
        f"{len(missed)} cases in which {first} fails, and in {len(wrong & right)} of the",
        f"{len(wrong)} in which the tip of {first} is wrong.",
    ]
    if ADAPTIVE in rates:
        c = rates[ADAPTIVE]
        said.append(
            f"The method {ADAPTIVE} refines modes until its own estimate of the error is within"
            f" 0.1 % of the length: {c.success:.1%} success, {c.wrong_tips:.1%} wrong tips."
        )
    return _paragraph(*said)


def _is_failure(verdict: MethodVerdict) -> bool:
    return not verdict.is_success and verdict is not MethodVerdict.UNDECIDED


def _wrong_tips(rows: Rows) -> str:
    """The cases that converged to another equilibrium than the true one."""
    lines = []
    for method in (ADAPTIVE, "modes"):
        wrong = [row for row in rows.get(method, []) if row.verdict.is_wrong_tip]
        lines.append(f"{method}: {len(wrong)}")
        for row in wrong[:MOST_LISTED]:
            case = row.case
            far = f", {row.distance:.2g} apart" if np.isfinite(row.distance) else ""
            lines.append(
                f"- seed {case.seed}, case {case.index}: {case.kind.value} {case.size:g}, "
                f"L/D {case.slenderness:g}: {row.verdict.value}{far}"
            )
        if len(wrong) > MOST_LISTED:
            lines.append(f"- and {len(wrong) - MOST_LISTED} more, in stability.csv")
        lines.append("")
    return "\n".join(lines).rstrip()
