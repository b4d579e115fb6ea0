"""The paper's table of losses, with Best, Mean and Worst."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from beamopt.base.brief import Brief
from beamopt.judge.judge import Verdict
from beamopt.storage.writing import csv_text
from beamopt.study.plan import COMBINATIONS, Run

if TYPE_CHECKING:
    from pandas import DataFrame

__all__ = [
    "PAPER",
    "Outcome",
    "RefinedOutcome",
    "StudyOutcomes",
    "comparison_markdown",
    "row",
    "table_csv",
    "table_markdown",
    "targets_of",
    "title",
]

PAPER = {
    "random-section": {"Best": 19.49, "Mean": 81.59, "Worst": 152.52},
    "hand-drawn-section": {"Best": 15.07, "Mean": 63.66, "Worst": 135.75},
    "hand-drawn-workspace": {"Best": 1119.73, "Mean": 1340.68, "Worst": 1693.46},
}
"""The paper's L [mm²] over its 16 runs a target (paper, Table 1); its targets are other ones."""

TITLES = {
    "random-section": "Random geometry",
    "hand-drawn-section": "Specific geometry",
    "hand-drawn-workspace": "Without geometry",
}


@dataclass(frozen=True, slots=True)
class RefinedOutcome:
    """What refining a run's best design came to.

    L_before, L : of the design that was refined, and of what came out [mm²]; of the outline where
    it is sealed. ratio_before, ratio : their neighbour ratios.
    """

    L_before: float
    L: float
    ratio_before: float
    ratio: float
    evaluations: int
    seconds: float


@dataclass(frozen=True, slots=True)
class Outcome:
    """What one run came to.

    final : losses of the individual with the lowest L in the last population, the paper's metric.
    best_ever : the lowest L [mm²] of all that the run judged.
    lowest : (generations + 1,) lowest L [mm²] of each generation's population.

    Examples
    --------
    >>> import beamopt
    >>> run = beamopt.Plan().runs()[0]
    >>> beamopt.Outcome(run, beamopt.Verdict(10.0, 2.0), 9.0, 1820, (10.0,), 1.5)
    <Outcome 'random-section-FD-1': L = 10 mm², 1820 sections judged>
    """

    run: Run
    final: Verdict
    best_ever: float
    evaluations: int
    lowest: tuple[float, ...]
    seconds: float
    refined: RefinedOutcome | None = None

    def __repr__(self) -> str:
        run = Brief(self.run.name)
        return f"<Outcome {run}: L = {self.final.L:.4g} mm², {self.evaluations} sections judged>"


class StudyOutcomes(list[Outcome]):
    """Outcomes of the runs of a study, in the order of its table.

    Examples
    --------
    >>> import beamopt
    >>> run = beamopt.Plan().runs()[0]
    >>> outcome = beamopt.Outcome(run, beamopt.Verdict(10.0, 2.0), 9.0, 1820, (10.0,), 1.5)
    >>> beamopt.StudyOutcomes([outcome])
    <StudyOutcomes: 1 runs, lowest L = 10 mm²>
    """

    def __repr__(self) -> str:
        losses = [one.final.L for one in self]
        lowest = f", lowest L = {min(losses):.4g} mm²" if losses else ""
        return f"<StudyOutcomes: {len(self)} runs{lowest}>"

    def to_frame(self) -> DataFrame:
        """Runs, then the best, mean and worst of each kind, as a data frame (needs pandas)."""
        from beamopt.storage.frames import frame_of

        return frame_of(table_csv(self))


SUMMARIES: dict[str, Callable[[Sequence[float]], float]] = {
    "Best": min,
    "Mean": lambda values: float(np.mean(values)),
    "Worst": max,
}


def targets_of(outcomes: Sequence[Outcome]) -> tuple[str, ...]:
    """The targets of a study, in its order."""
    return tuple(dict.fromkeys(one.run.target for one in outcomes))


def title(target: str) -> str:
    """A target's title: the paper's where it has one."""
    return TITLES.get(target, target)


def table_csv(outcomes: Sequence[Outcome]) -> str:
    """`target,combination,iteration,L,K,T,evaluations`, iterations then Best, Mean, Worst of L.

    K and T of the Best and Worst rows belong to that run; those of the Mean row are means.
    """
    rows: list[tuple[object, ...]] = []
    for target in targets_of(outcomes):
        for combination in COMBINATIONS:
            mine = _of(outcomes, target, combination)
            rows += [(target, combination, one.run.iteration, *_losses(one)) for one in mine]
            by_loss = sorted(mine, key=lambda one: one.final.L)
            means = [float(column) for column in np.mean([_losses(one) for one in mine], axis=0)]
            rows.append((target, combination, "Best", *_losses(by_loss[0])))
            rows.append((target, combination, "Mean", *means))
            rows.append((target, combination, "Worst", *_losses(by_loss[-1])))
    return csv_text("target,combination,iteration,L,K,T,evaluations", rows)


def table_markdown(outcomes: Sequence[Outcome]) -> str:
    """The table in the paper's form: an iteration a row, a target and combination a column.

    The lowest Best, Mean and Worst of each target are bold, the highest in italics.
    """
    columns = [
        (target, combination) for target in targets_of(outcomes) for combination in COMBINATIONS
    ]
    losses = {c: [one.final.L for one in _of(outcomes, *c)] for c in columns}
    head = ["It."] + [f"{title(target)} {combination}" for target, combination in columns]
    lines = [row(head), row(["---"] + ["---:"] * len(columns))]
    lines += [
        row([str(k + 1)] + [f"{losses[c][k]:.2f}" for c in columns])
        for k in range(len(losses[columns[0]]))
    ]
    for name, summarise in SUMMARIES.items():
        values = {c: summarise(losses[c]) for c in columns}
        lines.append(row([f"**{name}**"] + [_marked(c, values) for c in columns]))
    return "\n".join(lines) + "\n"


def comparison_markdown(outcomes: Sequence[Outcome]) -> str:
    """L over all runs of each target, beside the paper's."""
    lines = [row(["Target", "Runs", *(f"{name}, here / paper" for name in SUMMARIES)])]
    lines.append(row(["---", "---:", *["---:"] * len(SUMMARIES)]))
    for target in (target for target in targets_of(outcomes) if target in PAPER):
        losses = [one.final.L for one in outcomes if one.run.target == target]
        pairs = [
            f"{summarise(losses):.2f} / {PAPER[target][name]:.2f}"
            for name, summarise in SUMMARIES.items()
        ]
        lines.append(row([title(target), str(len(losses)), *pairs]))
    return "\n".join(lines) + "\n"


def _of(outcomes: Sequence[Outcome], target: str, combination: str) -> list[Outcome]:
    return [
        one for one in outcomes if (one.run.target, one.run.combination) == (target, combination)
    ]


def _losses(one: Outcome) -> tuple[float, float, float, int]:
    return one.final.L, one.final.K, one.final.T, one.evaluations


def row(cells: Sequence[str]) -> str:
    """A row of a Markdown table."""
    return "| " + " | ".join(cells) + " |"


def _marked(column: tuple[str, str], values: dict[tuple[str, str], float]) -> str:
    same_target = [value for (target, _), value in values.items() if target == column[0]]
    text = f"{values[column]:.2f}"
    if values[column] == min(same_target):
        return f"**{text}**"
    return f"*{text}*" if values[column] == max(same_target) else text
