"""A chart as a table: a row a model."""

from __future__ import annotations

import numpy as np

from beamopt.storage.writing import csv_text
from femcheck.chart.chart import Chart, Row

__all__ = ["chart_csv"]

HEADER = "family,resolution,error_mm,cpu_seconds,unknowns,found,of,size,status,ended"


def chart_csv(chart: Chart) -> str:
    """Error, cost and ending of every model."""
    return csv_text(HEADER, [_cells(row) for row in chart.rows])


def _cells(row: Row) -> tuple[object, ...]:
    one, reply = row.measured, row.measured.reply
    error, seconds = (None if np.isnan(x) else x for x in (row.error, one.seconds))
    found = int(reply.found.sum())
    cells = (one.family, one.resolution, error, seconds, reply.unknowns or None, found)
    return (*cells, len(reply.endings), reply.size or None, str(reply.ended), reply.ended.key)
