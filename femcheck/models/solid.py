"""The solid as a model: an element, its layers and its triangles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.processes import in_process, processes
from beamopt.scene.design import Design
from beamopt.storage.campaign import Campaign
from beamopt.target.workspace import node_index
from femcheck.check.options import CheckOptions
from femcheck.check.schedule import Schedule
from femcheck.check.stage import Stage
from femcheck.continuation.ended import FOUND, Ended
from femcheck.continuation.limits import Limits
from femcheck.continuation.outcome import Status
from femcheck.continuation.pressure_tree import all_nodes
from femcheck.material.law import Law
from femcheck.material.rigid_section import RigidSection
from femcheck.mesh.extrusion import stations
from femcheck.mesh.gmsh_section import MeshFailure
from femcheck.mesh.section_mesh import SectionMesh
from femcheck.models.points import PointWork
from femcheck.models.question import LawChoice, Question
from femcheck.models.reply import Reply, nothing
from femcheck.prediction.options import PredictionOptions
from femcheck.prediction.ray_trace import RayResult
from femcheck.prediction.rays import Ray, rays_of
from femcheck.prediction.work import RayKey, RayWork
from femcheck.solid.elements import DEFAULT_ELEMENT, ELEMENTS
from femcheck.solved.case import CaseResult, Solid

__all__ = ["SolidModel"]

PENALTIES = (2500.0, 10000.0)
"""c of the rigid-section law; tips are extrapolated in 1/c."""


@dataclass(frozen=True, slots=True)
class SolidModel:
    """A discretised solid of the question's law.

    element : its name. layers : along the actuator. size : of the triangles, see `SectionSizes`.
    penalties : c of the rigid-section law, two of them; other laws have none.
    grading : thickness of the middle layers over that of the end ones; None is the question's.
    """

    element: str = DEFAULT_ELEMENT
    layers: int = 4
    size: float = 2.0
    penalties: tuple[float, float] = PENALTIES
    grading: float | None = None

    @property
    def family(self) -> str:
        """The element's name."""
        return self.element

    @property
    def resolution(self) -> str:
        """Layers and size, and c where it is not the usual one."""
        said = f"{self.layers} layers, size {self.size:g}"
        if self.grading is not None:
            said += f", graded {self.grading:g}"
        return said if self.penalties == PENALTIES else f"{said}, c to {self.penalties[1]:g}"

    def refuses(self, question: Question) -> str | None:
        """Why there is no such solid."""
        missing = question.no_solid
        if missing is not None:
            return missing
        if self._is_mixed(question) and not ELEMENTS[self.element].has_pair:
            return f"{self.element} has no stable pair for an incompressible material"
        return None

    def options(self, law: LawChoice) -> LawChoice:
        """The law's options with this model's mesh."""
        sizes = replace(law.sizes, factor=self.size)
        graded = law.grading if self.grading is None else self.grading
        changed = replace(law, layers=self.layers, sizes=sizes, grading=graded)
        if isinstance(changed, CheckOptions):
            return replace(changed, penalties=self.penalties)
        return changed

    def _is_mixed(self, question: Question) -> bool:
        law = question.law
        if not isinstance(law, PredictionOptions):
            return False
        return law.law_for(question.design.actuator).volumetric_compliance is not None

    def reply(self, question: Question, workers: int = 0, kind: type[Solid] = Solid) -> Reply:
        """Mesh and solve; the whole of it is done anew. kind : whose elements these are."""
        options, subject = self.options(question.law), question.subject
        section = options.mesher.mesh(subject.outline, options.sizes)
        if isinstance(section, MeshFailure):
            return nothing(question, Ended.of_mesh(section))
        campaign = Campaign(max(workers, 1), processes if workers else in_process)
        ask = _Solving(question, options, self, section, campaign, kind)
        tips, endings = ask.rigid() if question.is_of_the_beam else ask.material()
        solid = ask.solid("size", RigidSection(1.0, 1.0))
        body = solid.body()
        mixed = body.corner_nodes.size if self._is_mixed(question) else 0
        size = f"{len(section.triangles)} triangles × {self.layers} layers of {self.element}"
        return Reply(tips, endings, body.unknowns + mixed, size)


class _TipRays(RayWork):
    """Rays that combinations lie on, and no others, of one mesh."""

    def __init__(self, solid: Solid, rays: Sequence[Ray], used: set[int], limits: Limits) -> None:
        super().__init__({"standard": solid}, rays, limits)
        self.used = used

    @property
    def keys(self) -> list[RayKey]:
        return [("standard", number) for number in sorted(self.used)]


@dataclass(frozen=True, eq=False)
class _Solving:
    """A question put to one solid."""

    question: Question
    options: LawChoice
    model: SolidModel
    section: SectionMesh
    campaign: Campaign
    kind: type[Solid]

    @property
    def design(self) -> Design:
        return self.question.design

    def solid(self, name: str, law: Law) -> Solid:
        length, options = self.design.actuator.length, self.options
        heights = stations(length, self.model.layers, options.grading)
        wound = None
        if isinstance(options, PredictionOptions) and options.wound is not None:
            wound = (options.wound, options.thread)
        element, solver = self.model.element, options.solver
        return self.kind(name, self.section, heights, element, law, solver, wound)

    @property
    def centroid(self) -> FloatArray:
        return np.append(self.section.moments.centroid, 0.0)

    def rigid(self) -> tuple[FloatArray, tuple[Ended, ...]]:
        """Both penalties, extrapolated."""
        E = self.design.actuator.youngs_modulus
        low, high = (
            Stage(self.solid(f"c{c:g}", RigidSection(E, c)), "standard", c, follows)
            for c, follows in zip(
                self.model.penalties, (None, f"c{self.model.penalties[0]:g}"), strict=True
            )
        )
        results = self._on_grid(low, high) if self.question.is_on_grid else self._at(low, high)
        tips, endings = [], []
        ratio = 1 / (high.penalty / low.penalty - 1)
        for pressures, coarse, fine in zip(self.question.pressures, *results, strict=True):
            tips.append(self._tip(fine) + ratio * (self._tip(fine) - self._tip(coarse)))
            worse = coarse if coarse.status is not Status.CONVERGED else fine
            load = worse.outcome.reached * float(np.abs(pressures).max())
            found = worse.status is Status.CONVERGED
            endings.append(FOUND if found else Ended(worse.status, load))
        return np.array(tips), tuple(endings)

    def _tip(self, result: CaseResult) -> FloatArray:
        state = result.outcome.state
        return np.full(3, np.nan) if state is None else state.tip - self.centroid

    def _on_grid(self, low: Stage, high: Stage) -> tuple[list[CaseResult], list[CaseResult]]:
        """All 27, each predicted from its neighbours."""
        schedule = Schedule((low, high), self.design.pressures, self.options.limits)
        self.campaign.solve(schedule)
        nodes = sorted(all_nodes(), key=lambda node: node_index(*node))
        first, second = (
            [schedule.results[stage.name, node] for node in nodes] for stage in (low, high)
        )
        return first, second

    def _at(self, low: Stage, high: Stage) -> tuple[list[CaseResult], list[CaseResult]]:
        """Each by itself, from rest."""
        pressures = self.question.pressures
        work = PointWork((low.solid, high.solid), pressures, self.options.limits)
        self.campaign.solve(work)
        first, second = ([work.results[k, row] for row in range(len(pressures))] for k in (0, 1))
        return first, second

    def material(self) -> tuple[FloatArray, tuple[Ended, ...]]:
        """Along rays from rest, which tell stable equilibria from others."""
        options = self.options
        assert isinstance(options, PredictionOptions)
        solid = self.solid("standard", options.law_for(self.design.actuator))
        rays, places = rays_of(self.question.pressures)
        used = {place[0] for place in places if place is not None}
        work = _TipRays(solid, rays, used, options.limits)
        self.campaign.solve(work)
        tips, endings = [], []
        for place in places:
            if place is None:
                tips.append(np.array([0.0, 0.0, self.design.actuator.length]))
                endings.append(FOUND)
                continue
            number, load = place
            tip, ended = self._on_ray(work.results["standard", number], rays[number], load)
            tips.append(tip)
            endings.append(ended)
        return np.array(tips), tuple(endings)

    def _on_ray(self, result: RayResult, ray: Ray, load: float) -> tuple[FloatArray, Ended]:
        found = result.answers[ray.stops.index(load)]
        if found is not None:
            return found.tip - self.centroid, FOUND
        return np.full(3, np.nan), Ended(result.status, result.critical)
