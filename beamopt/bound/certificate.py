"""How low the loss can be for a scene's target: three bounds, or why there is none."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from enum import Enum

from beamopt.bound.prices import ray_bound
from beamopt.bound.rays import RayBound
from beamopt.bound.response import ResponseBound, response_bound
from beamopt.bound.ring import RingMoments
from beamopt.bound.ring_bound import RingBound, ring_bound
from beamopt.bound.wanted import Wanted, wanted_of
from beamopt.bound.work import MOST_WORK, Progress, WorkLeft
from beamopt.rod.ladder import Rung
from beamopt.scene.scene import Scene
from beamopt.target.target import Target

__all__ = ["BoundStatus", "Certificate", "Progress", "certificate", "quick_certificate"]


class BoundStatus(Enum):
    """Whether there is a bound; the value is the text shown to people."""

    BOUNDED = "bounded"
    WORK_LIMIT = "bounded by what the work allowed has proven; more work may prove more"
    NOT_AN_ARC = "no bound: the tips of this scene's rod do not depend on a response matrix alone"
    NO_ROWS = "no bound: the target names no tips at given pressures"

    @property
    def is_bound(self) -> bool:
        """True if L has a proven bound, whatever more work would add to it."""
        return self in (BoundStatus.BOUNDED, BoundStatus.WORK_LIMIT)


@dataclass(frozen=True, eq=False)
class Certificate:
    """Bounds of L = Σ w_j |h_j − t_j|² over the target's rows.

    What directions and trajectories add to a scene's L is left out: it is never below 0, and so
    the bounds hold for the whole L as well.

    wanted : the rows and the rod.
    response : numerical, over all response matrices.
    proven : over the response matrices in a box; None where it was not asked for, as `ring`.
    ring : numerical, over what chambers in the scene's ring can have.
    seconds : time of each part.

    Examples
    --------
    >>> import beamopt
    >>> scene = beamopt.load_scene("random-section", ["search.generations=0"])
    >>> bound: beamopt.Certificate = beamopt.optimize(scene).bound
    >>> bound.status.name
    'BOUNDED'
    """

    status: BoundStatus
    wanted: Wanted | None = None
    response: ResponseBound | None = None
    proven: RayBound | None = None
    ring: RingBound | None = None
    seconds: dict[str, float] = field(default_factory=dict)

    def __repr__(self) -> str:
        found = None if self.response is None else self.response.loss
        proven = None if self.proven is None else self.proven.loss
        ring = None if self.ring is None else self.ring.inner
        losses = {"found": found, "proven": proven, "in the ring": ring}
        said = ", ".join(f"{name} {L:.4g} mm²" for name, L in losses.items() if L is not None)
        return f"<Certificate: {said or self.status.name}>"


def quick_certificate(scene: Scene, target: Target) -> Certificate:
    """The response bound alone: some hundredths of a second."""
    if scene.climb.model.rung is not Rung.ARC:
        return Certificate(BoundStatus.NOT_AN_ARC)
    wanted = wanted_of(target, scene.climb.model)
    if wanted is None:
        return Certificate(BoundStatus.NO_ROWS)
    started = time.perf_counter()
    response = response_bound(wanted)
    seconds = {"response": time.perf_counter() - started}
    return Certificate(BoundStatus.BOUNDED, wanted, response, seconds=seconds)


def certificate(
    scene: Scene,
    target: Target,
    callback: Progress | None = None,
    most_work: float = MOST_WORK,
) -> Certificate:
    """All three bounds: seconds for 27 rows, a minute or two for thousands.

    Parameters
    ----------
    callback : called with the part that goes on and the share of the work that is spent.
    most_work : tips of arcs to compute at most, half of them for the proof. Where that is not
        enough the bounds are what is known by then: valid, but lower than they could be.

    Examples
    --------
    >>> import beamopt
    >>> scene = beamopt.load_scene("hand-drawn-workspace")
    >>> beamopt.certificate(scene, scene.load_target())
    <Certificate: found 65.58 mm², proven 65.52 mm², in the ring 65.58 mm²>
    """
    quick = quick_certificate(scene, target)
    wanted, response = quick.wanted, quick.response
    if wanted is None or response is None:
        return quick
    started = time.perf_counter()
    proof, rounds = WorkLeft(most_work / 2, callback), WorkLeft(most_work / 2, callback)
    proven = ray_bound(wanted, response=response.matrix, work=proof)
    between = time.perf_counter()
    moments = RingMoments.of(scene.grid.build(), scene.seal.rules.skin)
    ring = ring_bound(
        wanted,
        moments,
        scene.actuator.youngs_modulus,
        response.loss,
        rounds,
    )
    seconds = {
        **quick.seconds,
        "proven": between - started,
        "ring": time.perf_counter() - between,
    }
    short = proof.short or rounds.short
    status = BoundStatus.WORK_LIMIT if short else BoundStatus.BOUNDED
    return Certificate(status, wanted, response, proven, ring, seconds)
