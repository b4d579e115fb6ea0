"""What a candidate is worth in each objective."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError
from beamopt.judge.judge import Judge, JudgeStatus, Verdict
from beamopt.section.feature_points import FeaturePoints

__all__ = ["BEST", "OBJECTIVES", "Score", "chosen_objectives", "nondominated", "scored"]

OBJECTIVES = {
    "L": "loss L [mm²]",
    "ratio": "neighbour ratio r",
    "mass": "mass of the actuator [g]",
    "chambers": "separate chambers",
}
"""The objectives by name, as a figure's axis says them; the less the better."""

BEST = {
    "L": "lowest L",
    "ratio": "lowest ratio",
    "mass": "lowest mass",
    "chambers": "fewest chambers",
}
"""What the best design of each objective is called."""

WORST = 1e6  # chambers too many of what can not be judged at all


@dataclass(frozen=True, slots=True)
class Score:
    """A verdict, and what stands in the objectives beside it.

    ratio : neighbour ratio r of the paper. mass : of the actuator [g].
    chambers : separate chambers of each supply. too_many : of them, beyond what the scene allows.
    """

    verdict: Verdict
    ratio: float
    mass: float
    chambers: tuple[int, int, int]
    too_many: int

    @property
    def judged(self) -> bool:
        """Whether it can be on a front."""
        return self.verdict.status is JudgeStatus.JUDGED

    @property
    def excess(self) -> float:
        """How far it is from being judged: chambers too many; 0 for one that is."""
        if self.judged:
            return 0.0
        few = self.verdict.status is JudgeStatus.TOO_MANY_CHAMBERS
        return float(self.too_many) if few else WORST

    def values(self, objectives: Sequence[str]) -> tuple[float, ...]:
        """Its value in each objective; the first, "L", is L + R where rules are weighted."""
        known = {
            "L": self.verdict.ruled_loss,
            "ratio": self.ratio,
            "mass": self.mass,
            "chambers": float(sum(self.chambers)),
        }
        return tuple(known[name] for name in objectives)


def scored(judge: Judge, candidates: Sequence[FeaturePoints]) -> list[Score]:
    """Judge a batch; `judge` must count chambers."""
    measured = judge.measured(candidates)
    verdicts = judge.verdicts(measured, [len(points) for points in candidates])
    making = judge.making
    rows = zip(
        verdicts,
        measured.neighbour_ratio.tolist(),
        making.mass(measured).tolist(),
        measured.chambers.tolist(),
        making.chambers_too_many(measured).tolist(),
        strict=True,
    )
    return [Score(v, ratio, mass, (a, b, c), many) for v, ratio, mass, (a, b, c), many in rows]


def chosen_objectives(text: str) -> tuple[str, ...]:
    """Objectives from a text "L,mass".

    Raises
    ------
    InputError : a name that is not known or stands there twice, or not L and at least one more.
    """
    names = tuple(name.strip() for name in text.split(","))
    known = all(name in OBJECTIVES for name in names) and len(set(names)) == len(names)
    if not known or names[0] != "L" or len(names) < 2:
        others = ", ".join(list(OBJECTIVES)[1:])
        raise InputError("--objectives", "", text, f"L and one or more of {others}, as L,mass")
    return names


def nondominated(values: FloatArray) -> list[int]:
    """Those of `values` (n, objectives) that no other one beats; of equal ones the first.

    One beats another if it is nowhere worse and somewhere better.
    """
    kept: list[int] = []
    for k in np.lexsort(values.T[::-1]).tolist():  # whatever beats it comes before it
        if not any((values[m] <= values[k]).all() for m in kept):
            kept.append(k)
    return sorted(kept)
