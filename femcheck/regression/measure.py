"""Rungs computed, part by part: what a process does at a time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass, field

from beamopt.base.errors import InputError
from beamopt.base.tasks import Work
from beamopt.storage.campaign import Campaign
from femcheck.regression.held import LADDER, Held
from femcheck.regression.held_design import HeldDesign
from femcheck.regression.rods import held_rods
from femcheck.regression.sections import held_sections
from femcheck.regression.solids import LAWS, held_limit, held_meshes, held_solid

__all__ = ["MeasuredPart", "PartKey", "measure_all", "parts_of"]

PartKey = tuple[str, str]
"""The name of a design, and of a part of its rungs."""

Callback = Callable[[str, str], None]


@dataclass(frozen=True, eq=False)
class MeasuredPart:
    """What was found of a part, or of a design. broken : what stopped it; "" where nothing did."""

    held: tuple[Held, ...]
    broken: str = ""


PARTS: dict[str, tuple[str, ...]] = {
    "sections": LADDER[: LADDER.index("raster")],
    "rods": LADDER[LADDER.index("raster") : LADDER.index("kept mesh")],
    "meshes": LADDER[LADDER.index("kept mesh") : LADDER.index("solid, rigid-section")],
    **{law.rung: (law.rung,) for law in LAWS},
    "solid, limit": ("solid, limit",),
}
"""Rungs that are computed together."""


def parts_of(design: HeldDesign) -> list[str]:
    """The parts that a design has, and that have one of its rungs."""
    has = set(PARTS) if design.has_solid else {"sections", "rods"}
    return [name for name, found in PARTS.items() if name in has and design.rungs & set(found)]


def measure_all(
    designs: Sequence[HeldDesign],
    *,
    estimate: bool,
    workers: int = 1,
    callback: Callback | None = None,
) -> dict[str, MeasuredPart]:
    """What all rungs of the designs say, by the designs' names; each from the lowest rung on.

    estimate : whether tolerances are wanted.
    callback : called with the name of a design and of a part that is done.

    Raises
    ------
    InputError : a kept mesh is missing or damaged.
    """
    work = _PartWork(designs, estimate)

    def done(key: PartKey, result: MeasuredPart) -> None:
        if callback is not None:
            callback(*key)

    Campaign(workers).solve(work, done)
    return {design.name: work.of(design) for design in designs}


@dataclass
class _PartWork(Work[PartKey, MeasuredPart]):
    """What is to be measured; see `beamopt.base.tasks`."""

    designs: Sequence[HeldDesign]
    estimate: bool
    results: dict[PartKey, MeasuredPart] = field(default_factory=dict)

    @property
    def keys(self) -> list[PartKey]:
        """Parts with solids first: they take the longest."""
        found = [(one.name, part) for one in self.designs for part in parts_of(one)]
        order = list(PARTS)
        return sorted(found, key=lambda key: -order.index(key[1]))

    def submit(self, executor: Executor, key: PartKey) -> Future[MeasuredPart]:
        """Have a part measured."""
        design = next(one for one in self.designs if one.name == key[0])
        return executor.submit(_measure, design, key[1], self.estimate)

    def stopped(self, key: PartKey) -> MeasuredPart:
        """The result of a part whose process died."""
        return MeasuredPart((), "its process ended before it was done")

    def of(self, design: HeldDesign) -> MeasuredPart:
        """All parts of a design as one."""
        found = [self.results[key] for key in ((design.name, part) for part in parts_of(design))]
        held = [one for part in found for one in part.held if one.rung in design.rungs]
        held.sort(key=lambda one: LADDER.index(one.rung))
        broken = [part.broken for part in found if part.broken]
        return MeasuredPart(tuple(held), broken[0] if broken else "")


def _measure(design: HeldDesign, part: str, estimate: bool) -> MeasuredPart:
    """One part; what stops it is a result, since a rung that held has no answer any more."""
    found: list[Held] = []
    try:
        found.extend(_found(design, part, estimate))
    except InputError:
        raise
    except Exception as error:  # whatever a changed tree may raise
        said = " ".join(f"{type(error).__name__}: {error}".split())
        return MeasuredPart(tuple(found), said)
    return MeasuredPart(tuple(found))


def _found(design: HeldDesign, part: str, estimate: bool) -> Iterator[Held]:
    if part == "sections":
        return held_sections(design)
    if part == "rods":
        return held_rods(design, estimate=estimate)
    if part == "meshes":
        return held_meshes(design)
    if part == "solid, limit":
        return held_limit(design, estimate=estimate)
    law = next(law for law in LAWS if law.rung == part)
    return held_solid(design, law, estimate=estimate)
