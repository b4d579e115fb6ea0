"""All rays of all meshes as independent tasks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass, field

from beamopt.base.tasks import Work
from femcheck.continuation.limits import Limits
from femcheck.prediction.ray_trace import RayResult, RayTask, stopped_ray, trace_ray
from femcheck.prediction.rays import Ray
from femcheck.solved.case import Solid

__all__ = ["RayKey", "RayWork"]

RayKey = tuple[str, int]
"""A mesh, "standard" or "coarse", and the number of a ray."""


@dataclass
class RayWork(Work[RayKey, RayResult]):
    """What is to be traced; see `beamopt.base.tasks`.

    solids : by mesh. rays : all of them; the coarse mesh traces the `principal` ones alone, and
    those that are `asked` for, for an estimate of the mesh's error. limits : of a ray.
    """

    solids: Mapping[str, Solid]
    rays: Sequence[Ray]
    limits: Limits
    results: dict[RayKey, RayResult] = field(default_factory=dict)
    asked: set[int] = field(default_factory=set)

    @property
    def keys(self) -> list[RayKey]:
        """The standard mesh's rays, then the principal ones and those asked for of the coarse."""
        standard = [("standard", number) for number in range(len(self.rays))]
        coarse = [("coarse", n) for n in range(len(self.rays)) if self._is_on_both(n)]
        return standard + coarse

    def _is_on_both(self, number: int) -> bool:
        return self.rays[number].is_principal or number in self.asked

    def submit(self, executor: Executor, key: RayKey) -> Future[RayResult]:
        """Have a ray followed."""
        mesh, number = key
        task = RayTask(self.solids[mesh], self.rays[number], self.limits)
        return executor.submit(trace_ray, task)

    def stopped(self, key: RayKey) -> RayResult:
        """The result of a ray whose process died."""
        return stopped_ray(self.rays[key[1]])
