"""Beam and solid side by side at 27 pressures, and what their difference is made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.storage.writing import csv_text
from beamopt.target.workspace import NODES, node_index
from femcheck.check.schedule import Key
from femcheck.check.stage import Stage
from femcheck.continuation.outcome import Status
from femcheck.continuation.pressure_tree import all_nodes
from femcheck.solid.elements import ELEMENTS
from femcheck.solved.beside_beam import STILL, BesideBeam
from femcheck.solved.case import CaseResult
from femcheck.solved.cells import both, cells, plain
from femcheck.solved.subject import Subject

if TYPE_CHECKING:
    from pandas import DataFrame

__all__ = ["Comparison", "SolidTips", "compare", "table_csv"]

TABLE = (
    "p1,p2,p3,beam_x,beam_y,beam_z,solid_x,solid_y,solid_z,difference_mm,difference_of_length,"
    "difference_of_displacement,discretisation_mm,assumptions_mm,penalty_mm,"
    "volume_ratio_1,volume_ratio_2,volume_ratio_3,status,ended,iterations"
)


@dataclass(frozen=True, eq=False)
class SolidTips:
    """Tips of one solid, or extrapolated from several.

    mesh : "coarse" or "standard". penalty : c; infinite where extrapolated.
    tips : (27, 3) [mm] in the order of `pressure_grid`; NaN without an answer.
    volume_ratios : (27, 3) of each supply's chambers to their undeformed volume; NaN without any.
    statuses : (27,) how each case ended.
    reached : (27,) share of the load at the last equilibrium; 1 with an answer.
    iterations : (27,) that were spent on it.
    """

    mesh: str
    penalty: float
    tips: FloatArray
    volume_ratios: FloatArray
    statuses: tuple[Status, ...]
    reached: FloatArray
    iterations: IndexArray


@dataclass(frozen=True, eq=False)
class Comparison(BesideBeam):
    """The beam's tips against the solid's.

    solids : what was computed, and extrapolated.
    refinement : layers of the standard mesh over those of the coarse one.
    order : p of the tip's convergence with the layers; None where it is not known.

    Examples
    --------
    >>> import femcheck
    >>> from pathlib import Path
    >>> import beamopt
    >>> drawn = beamopt.load_design(str(beamopt.load_scene("gravity").target.file))
    >>> subject = femcheck.sealed_copy("round", drawn, 1.0)
    >>> quick = femcheck.CheckOptions(
    ...     layers=2, element="tet4", sizes=femcheck.SectionSizes(factor=9.0)
    ... )
    >>> checked = femcheck.check_design(subject, Path("compared"), quick)
    >>> compared: femcheck.Comparison | None = checked.comparison
    >>> if compared is not None:
    ...     print(compared.final.tips.shape, compared.unanswered)
    (27, 3) 0
    """

    subject: Subject
    solids: tuple[SolidTips, ...]
    refinement: float
    order: float | None

    def __repr__(self) -> str:
        return (
            f"<Comparison: {100 * self.worst:.3g} % of displacement at worst, "
            f"{100 * self.median:.3g} % in the median, {self.unanswered} without an answer>"
        )

    def solid(self, mesh: str, penalty: float) -> SolidTips:
        """One of the solids."""
        return next(one for one in self.solids if (one.mesh, one.penalty) == (mesh, penalty))

    @cached_property
    def final(self) -> SolidTips:
        """The standard mesh, extrapolated in 1/c: what the beam is judged against."""
        return self.solid("standard", np.inf)

    def to_frame(self) -> DataFrame:
        """Beam and solid at each combination (`table.csv`), as a data frame (needs pandas)."""
        from beamopt.storage.frames import frame_of

        return frame_of(table_csv(self))

    @property
    def solid_tips(self) -> FloatArray:
        """(27, 3) what the beam is judged against [mm]."""
        return self.final.tips

    @property
    def moves(self) -> bool:
        """Whether any tip moves, so that there is something to compare."""
        return bool(self.displacement.max() > STILL)

    @property
    def discretisation(self) -> FloatArray:
        """(27,) estimated error of the standard mesh [mm]; NaN where the order is not known."""
        return np.asarray(np.linalg.norm(self._mesh_error, axis=1))

    @property
    def assumptions(self) -> FloatArray:
        """(27,) difference that is left once both meshes are extrapolated too [mm].

        What beam and solid assume differently; for the rigid-section law that is nothing.
        """
        solid = self.final.tips + self._mesh_error
        return np.asarray(np.linalg.norm(solid - self.subject.beam_tips, axis=1))

    @property
    def _mesh_error(self) -> FloatArray:
        """(27, 3) what the standard mesh's tips still lack [mm].

        With r times the layers an error of order p leaves 1/(rᵖ − 1) of the change (Richardson).
        """
        coarse = self.solid("coarse", np.inf)
        left = np.nan if self.order is None else 1 / (self.refinement**self.order - 1)
        return np.asarray((self.final.tips - coarse.tips) * left)

    @property
    def penalty_error(self) -> FloatArray:
        """(27,) what the finite penalty still moved the tip of the stiffest solid by [mm]."""
        stiffest = max(one.penalty for one in self.solids if np.isfinite(one.penalty))
        change = self.final.tips - self.solid("standard", stiffest).tips
        return np.asarray(np.linalg.norm(change, axis=1))

    @property
    def left(self) -> float:
        """Largest share that mesh and penalty may still move a tip by, over displacement.

        The estimated error of the standard mesh, or where its order is not known all that changes
        from the coarse mesh to it, and what extrapolating in 1/c did. NaN where a loaded case has
        no answer on both meshes.
        """
        change = np.linalg.norm(self.final.tips - self.solid("coarse", np.inf).tips, axis=1)
        mesh = change if self.order is None else self.discretisation
        shares = (mesh + self.penalty_error) / self._moved
        loaded = shares[self.is_loaded]
        return float(loaded.max()) if loaded.size else float("nan")


def compare(
    subject: Subject, stages: Sequence[Stage], results: Mapping[Key, CaseResult]
) -> Comparison:
    """Put the results of all stages beside the beam, and extrapolate them in 1/c."""
    solids = [_tips(subject, stage, results) for stage in stages]
    for mesh in dict.fromkeys(stage.mesh for stage in stages):
        low, high = sorted((one for one in solids if one.mesh == mesh), key=lambda one: one.penalty)
        solids.append(_extrapolated(low, high))
    layers = {stage.mesh: stage.solid.heights.size - 1 for stage in stages}
    order = ELEMENTS[stages[0].solid.element].tip_order
    return Comparison(subject, tuple(solids), layers["standard"] / layers["coarse"], order)


def _tips(subject: Subject, stage: Stage, results: Mapping[Key, CaseResult]) -> SolidTips:
    tips, ratios = np.full((NODES, 3), np.nan), np.full((NODES, 3), np.nan)
    statuses, reached = [Status.STOPPED] * NODES, np.zeros(NODES)
    iterations = np.zeros(NODES, dtype=np.int64)
    centroid = np.append(stage.solid.section.moments.centroid, 0.0)
    undeformed = stage.solid.section.moments.chamber_areas * subject.design.actuator.length
    for node in all_nodes():
        result, row = results[stage.name, node], node_index(*node)
        statuses[row], reached[row] = result.status, result.outcome.reached
        iterations[row] = result.outcome.statistics.iterations
        if result.outcome.state is not None and result.volumes is not None:
            tips[row] = result.outcome.state.tip - centroid
            with np.errstate(invalid="ignore", divide="ignore"):
                ratios[row] = np.where(undeformed > 0, result.volumes / undeformed, np.nan)
    return SolidTips(stage.mesh, stage.penalty, tips, ratios, tuple(statuses), reached, iterations)


def _extrapolated(low: SolidTips, high: SolidTips) -> SolidTips:
    """Linear in 1/c to 0; a case without an answer in either has none."""
    ratio = 1 / (high.penalty / low.penalty - 1)
    tips = high.tips + ratio * (high.tips - low.tips)
    volumes = high.volume_ratios + ratio * (high.volume_ratios - low.volume_ratios)
    worse = [
        first if first is not Status.CONVERGED else second
        for first, second in zip(low.statuses, high.statuses, strict=True)
    ]
    reached = np.minimum(low.reached, high.reached)
    spent = low.iterations + high.iterations
    return SolidTips(high.mesh, np.inf, tips, volumes, tuple(worse), reached, spent)


def table_csv(compared: Comparison) -> str:
    """27 rows: beam, solid, difference and what it is made of."""
    subject = compared.subject
    length = subject.design.actuator.length
    columns = np.column_stack(
        [
            subject.beam_tips,
            compared.final.tips,
            compared.difference,
            compared.difference / length,
            np.where(compared.displacement > 0, compared.share, np.nan),
            compared.discretisation,
            compared.assumptions,
            compared.penalty_error,
            compared.final.volume_ratios,
        ]
    )
    pressures = subject.pressures.tolist()
    final = compared.final
    rows = zip(pressures, columns, final.statuses, final.iterations.tolist(), strict=True)
    return csv_text(
        TABLE,
        [(*map(plain, at), *cells(row), *both(status), spent) for at, row, status, spent in rows],
    )
