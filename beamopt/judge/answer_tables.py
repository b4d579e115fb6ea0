"""Tables of what the best design of a search does: its tips, and how it follows trajectories."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from beamopt.judge.answers import Answers
from beamopt.reach.reach import Reach
from beamopt.storage.writing import csv_text
from beamopt.target.aim import Aim

__all__ = ["paths_csv", "tips_table_csv"]


def tips_table_csv(aim: Aim, answers: Answers) -> str:
    """A design's tips, the target's, and the distance between them; directions if they count."""
    away = np.linalg.norm(answers.tips - aim.tips, axis=1)
    table = np.column_stack([aim.pressures, answers.tips, aim.tips, away]).tolist()
    header = "p1,p2,p3,x,y,z,target_x,target_y,target_z,distance_mm"
    if aim.turns and answers.directions is not None:
        header += ",tx,ty,tz,target_tx,target_ty,target_tz,turned_degrees"
        ways = zip(answers.directions, aim.directions, aim.direction_weights, strict=True)
        for row, (found, wanted, weight) in zip(table, ways, strict=True):
            row += found.tolist()
            turned = 2 * np.arcsin(min(float(np.linalg.norm(found - wanted)) / 2, 1.0))
            row += [*wanted.tolist(), float(np.degrees(turned))] if weight else [None] * 4
    return csv_text(header, table)


def paths_csv(reach: Reach, counts: Sequence[int]) -> str:
    """Points of trajectories, and the pressures that bring the tip nearest.

    counts : how many of the points belong to each trajectory, one after the other.
    """
    header = "path,sample,x,y,z,p1,p2,p3,reached_x,reached_y,reached_z,distance_mm"
    places = [(path, k) for path, count in enumerate(counts, 1) for k in range(1, count + 1)]
    values = np.column_stack([reach.points, reach.pressures, reach.tips, reach.distances])
    rows = (
        (*place, *(None if np.isnan(value) else value for value in row))
        for place, row in zip(places, values.tolist(), strict=True)
    )
    return csv_text(header, rows)
