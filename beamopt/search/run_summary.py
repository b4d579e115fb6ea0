"""The summary of a run: how its search ended and what it found."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from beamopt.bound.folder import bound_summary
from beamopt.judge.judge import JudgeStatus, Verdict
from beamopt.reach.reach import TOLERANCE
from beamopt.scene.actuator import Loading, RodRules
from beamopt.search.result import Optimisation
from beamopt.target.aim import Aim

__all__ = ["summary"]


def summary(result: Optimisation) -> dict[str, Any]:
    """Return the ending and the results of a search, without refining and without times."""
    pieces = result.best.section.pieces
    return (
        {
            "status": result.status.value,
            "ended": result.status.name,
            "scene": result.scene.name,
            "seed": result.scene.search.seed,
            "generations": result.last.index,
            "evaluations": result.evaluations,
            "best": _summary_of(result.verdict, result.target.aim)
            | {"islands": pieces.islands, "chambers": list(pieces.chambers)},
            "final": _summary_of(result.last.best.verdict, result.target.aim),
            "warnings": list(result.target.warnings),
        }
        | {"bound": bound_summary(result.bound, result.verdict.L)}
        | _making(result)
        | _rod(result)
        | _outline(result)
        | _paths(result)
    )


def _making(result: Optimisation) -> dict[str, Any]:
    """What the rules for what can be made did; nothing without any."""
    if not result.scene.making.rules_set:
        return {}
    counts = result.last.rejected
    rejected = {status.name: counts[status] for status in JudgeStatus if status in counts}
    best = result.last.best_ever.verdict
    weighted = {"best_R": best.R} if best.status is JudgeStatus.JUDGED else {}
    return {"rejected": rejected, **weighted}


def _rod(result: Optimisation) -> dict[str, Any]:
    """How the rod is solved; nothing for the paper's arc."""
    scene, climb = result.scene, result.scene.climb
    if (scene.rod, scene.loads) == (RodRules(), Loading()):
        return {}
    said = {"rung": climb.model.rung.value, "reason": climb.reason}
    moved = result.neglected if result.verdict.status is JudgeStatus.JUDGED else None
    if moved is None:
        return {"rod": said}
    there = moved if math.isfinite(moved) else JudgeStatus.NO_EQUILIBRIUM.value
    return {"rod": said | {"neglected_loads_move_mm": there}}


def _outline(result: Optimisation) -> dict[str, Any]:
    """What the best design is once it is polygons; nothing for an unsealed one."""
    sealed = result.best.seal.rules.sealed and result.verdict.status is JudgeStatus.JUDGED
    if not sealed:
        return {}
    faults = [str(fault) for fault in result.best.findings]
    if not math.isfinite(result.outline_loss):
        return {"outline": _ended(JudgeStatus.NO_EQUILIBRIUM) | {"faults": faults}}
    rms = result.target.aim.rms_distance(result.outline_loss)
    return {"outline": {"L": result.outline_loss, "rms_distance": rms, "faults": faults}}


def _paths(result: Optimisation) -> dict[str, Any]:
    """How the best design follows trajectories; nothing without any."""
    judged = result.verdict.status is JudgeStatus.JUDGED
    if not judged or result.reach is None or np.isnan(result.reach.distances).any():
        return {}
    distances = result.reach.distances
    reached = int((distances <= TOLERANCE).sum())
    said = {"samples": len(distances), "reached": reached, "tolerance": TOLERANCE}
    return {"paths": said | {"largest_distance": float(distances.max())}}


def _summary_of(verdict: Verdict, aim: Aim) -> dict[str, Any]:
    if verdict.status is not JudgeStatus.JUDGED:
        return _ended(verdict.status)
    rms = aim.rms_distance(verdict.L)
    losses = {"L": verdict.L, "K": verdict.K, "T": verdict.T, "rms_distance": rms}
    return _ended(verdict.status) | losses


def _ended(status: JudgeStatus) -> dict[str, str]:
    """The text for people, and the name for programs."""
    return {"status": status.value, "ended": status.name}
