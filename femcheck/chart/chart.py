"""What a chart says: every model's error and cost, and the cheapest for an accuracy."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from beamopt.base.brief import Brief
from beamopt.storage.writing import csv_text
from femcheck.chart.lineup import line_up
from femcheck.chart.measure import Measured, key_of
from femcheck.chart.reference import Reference
from femcheck.models.question import Question
from femcheck.models.solid import SolidModel

if TYPE_CHECKING:
    from pandas import DataFrame

__all__ = ["ACCURACIES", "Chart", "ChartRow", "chart_csv"]

HEADER = "family,resolution,error_mm,cpu_seconds,unknowns,found,of,size,status,ended"

ACCURACIES = (1.0, 0.1, 0.01)
"""[mm]"""

NO_MARKS: Mapping[str, str] = {}


@dataclass(frozen=True, eq=False)
class ChartRow:
    """A model's place on the chart.

    error : largest distance of a tip from the reference [mm]; NaN without any, or any reference.
    missing : tips that the reference has and the model has not.
    is_aside : whether it is finer in another respect than its family's other models.
    mark : its resolution in a figure.
    """

    measured: Measured
    error: float
    missing: int
    is_aside: bool = False
    mark: str = ""

    @property
    def is_whole(self) -> bool:
        """Whether it has every tip that there is."""
        return self.missing == 0 and bool(np.isfinite(self.error))


@dataclass(frozen=True, eq=False)
class Chart:
    """All rows of a question. reference : None where nothing could be extrapolated.

    Examples
    --------
    >>> import femcheck
    >>> import beamopt
    >>> drawn = beamopt.load_design(str(beamopt.load_scene("gravity").target.file))
    >>> subject = femcheck.sealed_copy("round", drawn, 1.0)
    >>> question = femcheck.Question.of("round", subject.design, femcheck.CheckOptions())
    >>> femcheck.Chart.of(question, [], None)
    <Chart 'round': 0 models, reference within inf mm>
    """

    question: Question
    rows: tuple[ChartRow, ...]
    reference: Reference | None

    def __repr__(self) -> str:
        return (
            f"<Chart {Brief(self.question.name)}: {len(self.rows)} models, "
            f"reference within {self.uncertainty:.2g} mm>"
        )

    @classmethod
    def of(
        cls,
        question: Question,
        measured: Sequence[Measured],
        reference: Reference | None,
        aside: Collection[str] = (),
        marks: Mapping[str, str] = NO_MARKS,
    ) -> Chart:
        """Errors of what was measured.

        aside : names of models that stand aside. marks : of models in a figure, by name; the
        resolution where there is none.
        """
        rows = [
            replace(
                _row(one, reference),
                is_aside=one.name in aside,
                mark=marks.get(one.name, one.resolution),
            )
            for one in measured
        ]
        return cls(question, tuple(rows), reference)

    def to_frame(self) -> DataFrame:
        """Error, cost and ending of every model, a row each, as a data frame (needs pandas)."""
        from beamopt.storage.frames import frame_of

        return frame_of(chart_csv(self))

    @property
    def uncertainty(self) -> float:
        """Of the reference [mm]; infinite where there is none."""
        return np.inf if self.reference is None else self.reference.uncertainty

    @property
    def made_with(self) -> list[str]:
        """Threads, processor and versions; several where it was gone on with elsewhere."""
        return list(
            dict.fromkeys(row.measured.made_with for row in self.rows if row.measured.made_with)
        )

    def within(self, accuracy: float) -> list[ChartRow]:
        """Rows with all tips within `accuracy` [mm] wherever the truth is in its band.

        The cheapest first.
        """
        most = accuracy - self.uncertainty
        near = [row for row in self.rows if row.is_whole and row.error <= most]
        return sorted(near, key=lambda row: row.measured.seconds)

    def cheapest(self, accuracy: float, family: str | None = None) -> ChartRow | None:
        """The cheapest within `accuracy` [mm], of all or of one family; None where none is."""
        near = self.within(accuracy)
        return next((row for row in near if family in (None, row.measured.family)), None)

    def solids(self, element: str) -> Iterator[tuple[SolidModel, ChartRow]]:
        """The solids of an element with their rows, from coarse to fine."""
        rows = {row.measured.name: row for row in self.rows}
        for series in line_up(self.question, [element]):
            for model in series.all:
                if isinstance(model, SolidModel) and key_of(model) in rows:
                    yield model, rows[key_of(model)]

    def sentences(self) -> Iterator[str]:
        """What is to be read off it."""
        yield (
            f"{self.question.name}, {self.question.law_text}: "
            f"{len(self.question.pressures)} tips, error against processor time."
        )
        yield from self._of_reference()
        if not self.is_confirmed:
            yield "What follows stands on the reference alone: no other family confirms it."
        for accuracy in ACCURACIES:
            if accuracy < self.uncertainty:
                yield f"Within {accuracy:g} mm: the reference does not tell."
                continue
            best, solid = self.cheapest(accuracy), self._cheapest_solid(accuracy)
            if best is None:
                yield f"Within {accuracy:g} mm: none of them."
                continue
            said = f"Within {accuracy:g} mm: {_said(best)}"
            if solid is not None and solid is not best:
                said += f"; of the solids {_said(solid)}"
            yield said + "."

    def _of_reference(self) -> Iterator[str]:
        reference = self.reference
        if reference is None:
            yield "No family of elements was solved finely enough to extrapolate from."
            return
        yield f"Reference: {reference.family}, ± {reference.uncertainty:.2g} mm."
        for other in reference.others:
            apart, band = reference.apart(other), reference.band + other.band
            if not np.isfinite(apart).any():
                yield f"{other.family} has no tip in common with it."
                continue
            agrees = reference.agrees(other)
            worst = int(np.nanargmax(apart if agrees else apart - band))
            verdict = "agrees" if agrees else "DISAGREES"
            yield (
                f"{other.family} extrapolates to within {apart[worst]:.2g} mm of it, "
                f"bands together {band[worst]:.2g} mm: {verdict}."
            )

    @property
    def is_confirmed(self) -> bool:
        """Whether another family was there, and none contradicts the reference."""
        return self.reference is not None and self.reference.is_confirmed

    def _cheapest_solid(self, accuracy: float) -> ChartRow | None:
        solids = (row for row in self.within(accuracy) if row.measured.reply.unknowns)
        return next(solids, None)


def _said(row: ChartRow) -> str:
    one = row.measured
    name = f"{one.family} {one.resolution}".strip()
    return f"{name} in {seconds_text(one.seconds)} (error {row.error:.2g} mm)"


def seconds_text(seconds: float) -> str:
    """In ms, s or min."""
    if seconds < 1:
        return f"{1e3 * seconds:.3g} ms"
    return f"{seconds:.3g} s" if seconds < 120 else f"{seconds / 60:.3g} min"


def _row(measured: Measured, reference: Reference | None) -> ChartRow:
    if reference is None:
        return ChartRow(measured, np.nan, len(measured.reply.endings))
    there = np.isfinite(reference.tips[:, 0])
    away = measured.reply.away(reference.tips)
    known = np.isfinite(away)
    error = float(away[known].max()) if known.any() else np.nan
    return ChartRow(measured, error, int((there & ~known).sum()))


def chart_csv(chart: Chart) -> str:
    """Error, cost and ending of every model."""
    return csv_text(HEADER, [_cells(row) for row in chart.rows])


def _cells(row: ChartRow) -> tuple[object, ...]:
    one, reply = row.measured, row.measured.reply
    error, seconds = (None if np.isnan(x) else x for x in (row.error, one.seconds))
    found = int(reply.found.sum())
    cells = (one.family, one.resolution, error, seconds, reply.unknowns or None, found)
    return (*cells, len(reply.endings), reply.size or None, str(reply.ended), reply.ended.key)
