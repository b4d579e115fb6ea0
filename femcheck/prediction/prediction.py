"""What was predicted: 27 answers or why there is none, limits, and the box that is safe."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray
from beamopt.base.brief import Brief
from beamopt.storage.writing import csv_text
from femcheck.continuation.outcome import Status
from femcheck.material.law import Law
from femcheck.mesh.gmsh_section import MeshFailure
from femcheck.mesh.quality import Quality
from femcheck.prediction.answer import Answer
from femcheck.prediction.options import PredictionOptions
from femcheck.prediction.ray_trace import RayResult
from femcheck.prediction.rays import Ray
from femcheck.prediction.two_meshes import Agreement, RayEnds, SafeBox, safe_box
from femcheck.prediction.work import RayKey
from femcheck.solved.beside_beam import BesideBeam
from femcheck.solved.case import Solid
from femcheck.solved.cells import COMPARE, both, cells, plain
from femcheck.solved.subject import Subject

if TYPE_CHECKING:
    from pandas import DataFrame

__all__ = ["Prediction", "compare_csv", "ratios_of", "stretch_cells"]

MORE = ",ends_at_kpa,snaps_at_kpa,largest_stretch,stretch_at_x,stretch_at_y,stretch_at_z"


@dataclass(frozen=True, eq=False)
class Prediction(BesideBeam):
    """What a design of a real material does at its 27 pressure combinations.

    failure : why there is no solid; results are then empty.
    solids : by mesh, "standard" and "coarse".
    rays, places : through the combinations; each combination's ray and load, None without pressure.
    results : of every ray on the standard mesh; on the coarse one of the principal rays and of
        those that decide the verdict.

    Examples
    --------
    >>> import femcheck
    >>> from pathlib import Path
    >>> import beamopt
    >>> drawn = beamopt.load_design(str(beamopt.load_scene("gravity").target.file))
    >>> subject = femcheck.sealed_copy("round", drawn, 1.0)
    >>> without = femcheck.PredictionOptions(mesher=femcheck.Mesher("no-such-gmsh"))
    >>> found = femcheck.predict_design(subject, Path("predicted"), without)
    >>> found.has_answers
    False
    """

    subject: Subject
    options: PredictionOptions
    law: Law
    failure: MeshFailure | None
    quality: Quality | None
    solids: Mapping[str, Solid]
    rays: tuple[Ray, ...]
    places: tuple[tuple[int, float] | None, ...]
    results: Mapping[RayKey, RayResult]

    def __repr__(self) -> str:
        name, failure = Brief(self.subject.name), self.failure
        if failure is not None:
            return f"<Prediction {name}: {failure!r}>"
        found = int(self.is_loaded.sum()) - self.unanswered
        return (
            f"<Prediction {name}: {self.options.title}, {found} of {self.is_loaded.sum()} "
            f"combinations answered, beam off by {100 * self.worst:.3g} % of displacement, "
            f"safe up to {self.safe_box.pressure:.4g} kPa>"
        )

    def to_frame(self) -> DataFrame:
        """Tips of solid and beam (`compare.csv`), as a data frame (needs pandas)."""
        from beamopt.storage.frames import frame_of

        return frame_of(compare_csv(self))

    @property
    def has_answers(self) -> bool:
        """Whether there is a solid at all."""
        return self.failure is None

    @property
    def largest(self) -> float:
        """Largest pressure asked for [kPa]."""
        return float(np.abs(self.subject.pressures).max())

    def result(self, number: int) -> RayResult:
        """Of a ray on the standard mesh."""
        return self.results["standard", number]

    def answer(self, row: int, mesh: str = "standard") -> Answer | None:
        """The stable equilibrium at a combination; None without pressure or where none is."""
        place = self.places[row]
        if place is None or (mesh, place[0]) not in self.results:
            return None
        number, load = place
        return self.results[mesh, number].answers[self.rays[number].stops.index(load)]

    def status(self, row: int, mesh: str = "standard") -> Status:
        """How a combination ended: what its ray met before it, if it met anything."""
        place = self.places[row]
        if place is None or self.answer(row, mesh) is not None:
            return Status.CONVERGED
        return self.results[mesh, place[0]].status

    def ended_at(self, row: int, mesh: str = "standard") -> float:
        """Load at which a combination's ray lost its stability before it [kPa]; NaN if not."""
        place = self.places[row]
        if place is None or self.answer(row, mesh) is not None:
            return float("nan")
        return self.results[mesh, place[0]].critical

    def snap(self, row: int, mesh: str = "standard") -> float:
        """Load at which a combination's ray jumps to another shape on its way [kPa]; NaN: never."""
        place = self.places[row]
        snaps = () if place is None else self.results[mesh, place[0]].snaps
        return snaps[0] if place is not None and snaps and snaps[0] < place[1] else float("nan")

    def growth(self, number: int) -> float:
        """Growth of a ray's chambers where its stable part ends, or at its last stop; NaN: none.

        Volume over that at rest.
        """
        result = self.result(number)
        if not np.isnan(result.growth):
            return result.growth
        last, weights = result.last, np.abs(np.array(self.rays[number].direction))
        rest = self.solids["standard"].section.moments.chamber_areas @ weights
        rest = rest * self.subject.design.actuator.length
        return float(last.volumes @ weights / rest) if last is not None and rest > 0 else np.nan

    @property
    def is_loaded(self) -> NDArray[np.bool_]:
        """(27,) whether any supply has pressure; empty without a solid."""
        return np.array([place is not None for place in self.places], dtype=np.bool_)

    @cached_property
    def tips(self) -> FloatArray:
        """(27, 3) tips [mm], the base's material centroid at the origin; NaN without an answer."""
        return self.tips_on("standard")

    def tips_on(self, mesh: str) -> FloatArray:
        """(27, 3) tips on a mesh."""
        tips = np.full((len(self.places), 3), np.nan)
        if not self.has_answers:
            return tips
        length = self.subject.design.actuator.length
        tips[~self.is_loaded] = (0.0, 0.0, length)
        centroid = np.append(self.solids[mesh].section.moments.centroid, 0.0)
        for row in range(len(self.places)):
            answer = self.answer(row, mesh)
            if answer is not None:
                tips[row] = answer.tip - centroid
        return tips

    @property
    def solid_tips(self) -> FloatArray:
        """(27, 3) the tips on the standard mesh [mm]."""
        return self.tips

    @property
    def discretisation(self) -> FloatArray:
        """(27,) change of the tip from the coarse mesh to the standard one [mm]; NaN: not known."""
        return np.asarray(np.linalg.norm(self.tips - self.tips_on("coarse"), axis=1))

    @property
    def first_to_end(self) -> int | None:
        """The ray whose stable part ends at the lowest load; None where none ends."""
        return self._first({status for status in Status if status.is_physical})

    @property
    def first_to_leave(self) -> int | None:
        """The ray that leaves what the law describes at the lowest load; None where none does."""
        return self._first({Status.BEYOND_LAW})

    @property
    def first_to_fail(self) -> int | None:
        """The ray that the computation lost at the lowest load; None where it lost none."""
        return self._first({status for status in Status if _is_lost(status)})

    def _first(self, statuses: set[Status]) -> int | None:
        found = [n for n in range(len(self.rays)) if self.result(n).status in statuses]
        return min(found, key=lambda n: (self.result(n).critical, n)) if found else None

    @property
    def not_computed(self) -> int:
        """Combinations without an answer because the computation lost their rays."""
        return sum(_is_lost(self.status(row)) for row in range(len(self.places)))

    @property
    def beyond_law(self) -> int:
        """Combinations without an answer because the law describes no stretch so large."""
        return sum(self.status(row) is Status.BEYOND_LAW for row in range(len(self.places)))

    @property
    def is_checked(self) -> bool:
        """Whether unstable directions were counted at every equilibrium."""
        return all((result.track[:, -1] >= 0).all() for result in self.results.values())

    @property
    def stable_box(self) -> float:
        """P [kPa] so that combinations up to P in every supply have a stable answer on both meshes.

        As far as the rays tell: the combinations, scaled down, lie on the same ones. Where the
        computation lost a ray, or one left what the law describes, it is what is known, and may be
        more.
        """
        ends = [one.critical for one in self.results.values() if np.isfinite(one.critical)]
        return min(ends, default=self.largest)

    @cached_property
    def safe_box(self) -> SafeBox:
        """The box to advise: the stable one with a margin, and no chamber grown too far."""
        return safe_box(self.rays, self.results, self.largest)

    @property
    def decisive(self) -> list[int]:
        """Rays that the verdict stands on: the first to end, to leave the law, to be lost.

        Where all have their answers, that of the combination that the beam is farthest off at.
        """
        firsts = (self.first_to_end, self.first_to_leave, self.first_to_fail)
        found = [n for n in firsts if n is not None]
        shares = np.where(self.is_loaded, self.share, np.nan)
        if not found and np.isfinite(shares).any():
            place = self.places[int(np.nanargmax(shares))]
            found += [] if place is None else [place[0]]
        return sorted(set(found))

    @property
    def compared(self) -> list[RayEnds]:
        """The principal rays and the decisive ones, with what is known of each on both meshes."""
        chosen = {n for n, ray in enumerate(self.rays) if ray.is_principal} | set(self.decisive)
        return [self.ends(number) for number in sorted(chosen)]

    def ends(self, number: int) -> RayEnds:
        """One ray on both meshes."""
        return RayEnds(self.rays[number], self.result(number), self.results.get(("coarse", number)))

    @property
    def mesh_share(self) -> float:
        """Largest change of a tip from the coarse mesh to the standard one, over displacement.

        Of the combinations that both meshes have an answer to; NaN without any.
        """
        shares = (self.discretisation / self._moved)[self.is_loaded]
        known = shares[np.isfinite(shares)]
        return float(known.max()) if known.size else float("nan")

    @property
    def certain(self) -> bool:
        """True if both meshes agree on the ends of rays and on the beam's difference."""
        if not self.has_answers:
            return False
        if not self.is_loaded.any():
            return True
        if any(one.agreement is not Agreement.AGREE for one in self.compared):
            return False
        return self.unanswered > 0 or abs(self.worst - self.options.agree) > self.mesh_share

    @property
    def holds(self) -> bool:
        """Whether every combination has a stable answer and the beam is near enough to all."""
        return self.has_answers and self.unanswered == 0 and self.worst <= self.options.agree


def _is_lost(status: Status) -> bool:
    """Whether the computation lost a ray: no answer, and no end that the actuator or law has."""
    return status is not Status.CONVERGED and not status.is_settled


def compare_csv(found: Prediction) -> str:
    """Tips of solid and beam, a row a combination and mesh."""
    return csv_text(COMPARE + MORE, _compare(found))


def _compare(found: Prediction) -> Iterator[tuple[object, ...]]:
    """Every combination on the standard mesh, those of the principal rays on the coarse one."""
    subject, length = found.subject, found.subject.design.actuator.length
    beam, displacement = subject.beam_tips, found.displacement
    for mesh in found.solids:
        tips = found.tips_on(mesh)
        difference = np.linalg.norm(tips - beam, axis=1)
        for row, pressures in enumerate(subject.pressures.tolist()):
            place, moved = found.places[row], displacement[row]
            if place is not None and (mesh, place[0]) not in found.results:
                continue
            answer = found.answer(row, mesh)
            yield (
                found.options.law,
                None,
                found.options.poisson_ratio,
                mesh,
                *map(plain, pressures),
                *cells(beam[row]),
                *cells(tips[row]),
                *cells([difference[row], difference[row] / length]),
                *cells([difference[row] / moved if moved > 0 else math.nan]),
                *cells(ratios_of(found, mesh, answer)),
                *both(found.status(row, mesh)),
                *cells([found.ended_at(row, mesh), found.snap(row, mesh)]),
                *stretch_cells(answer),
            )


def ratios_of(found: Prediction, mesh: str, answer: Answer | None) -> FloatArray:
    """(3,) volume of each supply's chambers over that at rest; NaN for a supply without any."""
    if answer is None:
        return np.full(3, np.nan)
    length = found.subject.design.actuator.length
    rest = found.solids[mesh].section.moments.chamber_areas * length
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.where(rest > 0, answer.volumes / rest, np.nan))


def stretch_cells(answer: Answer | None) -> list[object]:
    """Cells of the largest stretch and its place; empty without an answer."""
    return [None] * 4 if answer is None else cells([answer.stretch, *answer.stretch_at])
