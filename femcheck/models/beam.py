"""The beam's rungs as models: arcs on rasters and on the outline, rods by several methods."""

from __future__ import annotations

from dataclasses import dataclass, replace

from beamopt.comparators.methods import all_methods
from beamopt.rod.ladder import RodModel, Rung, SectionValues, Tips
from beamopt.rod.pressure_tree import parents_on_grid
from beamopt.scene.design import Design
from femcheck.continuation.ended import Ended, NoReply
from femcheck.models.question import Question
from femcheck.models.reply import Reply, nothing

__all__ = ["TIGHTEST", "ArcOnGrid", "RodByMethod", "RodOnOutline", "on_grid"]

TIGHTEST = 1e-9  # of the length: smallest tolerance that a rod is solved to


@dataclass(frozen=True, slots=True)
class ArcOnGrid:
    """The rod on the moments of a raster, whatever the section is; loads as the design has them.

    radial, angular : elements of the grid; walls between supplies keep their thickness.
    """

    radial: int
    angular: int

    @property
    def family(self) -> str:
        """Its name."""
        return "raster"

    @property
    def resolution(self) -> str:
        """The grid."""
        return f"{self.radial}×{self.angular}"

    def refuses(self, question: Question) -> str | None:
        """It can always be asked."""
        return None

    def reply(self, question: Question, workers: int = 0) -> Reply:
        """Of the same section on this grid."""
        design = on_grid(question.design, self.radial, self.angular)
        if not design.section.moments.is_stiff:
            return nothing(question, Ended(NoReply.NOT_STIFF))
        return _rod(question, design, SectionValues(design.section.moments))


def on_grid(design: Design, radial: int, angular: int) -> Design:
    """The same design on another raster; walls of elements scaled with it, to an even number."""
    grid = design.grid.model_copy(update={"radial": radial, "angular": angular})
    walls = design.wall_elements
    scaled = 2 * max(round(walls * radial / design.grid.radial / 2), min(walls, 1))
    return design.model_copy(update={"grid": grid, "wall_elements": scaled})


@dataclass(frozen=True, slots=True)
class RodOnOutline:
    """The rod of what the section is: the outline's polygons of a sealed design, else its raster.

    Without loads it is a closed form; with them it is solved as finely as `tolerance` [mm] takes,
    which is at least `TIGHTEST` and at most a tenth of the length.
    """

    tolerance: float | None = None

    @property
    def family(self) -> str:
        """Its name."""
        return "beam"

    @property
    def resolution(self) -> str:
        """The tolerance, where there is one."""
        return "" if self.tolerance is None else f"{self.tolerance:g} mm"

    def refuses(self, question: Question) -> str | None:
        """It can always be asked."""
        return None

    def reply(self, question: Question, workers: int = 0) -> Reply:
        """Of the design as it is, read anew: nothing known before makes it cheap."""
        design = question.design
        rules = design.rod
        if self.tolerance is not None:
            share = self.tolerance / design.actuator.length
            rules = rules.model_copy(update={"tolerance": min(max(share, TIGHTEST), 0.1)})
        return _rod(question, design.model_copy(update={"rod": rules}), None)


def _rod(question: Question, design: Design, values: SectionValues | None) -> Reply:
    """Tips on the rung that the design has to climb to."""
    model = design.climb.model
    known = values if values is not None and not model.loads.any else design.values
    parents = parents_on_grid() if question.is_on_grid else None
    return _answered(model.tips(known, question.pressures, parents))


def _answered(tips: Tips) -> Reply:
    return Reply(tips.positions, tuple(Ended(one) for one in tips.status))


@dataclass(frozen=True, slots=True)
class RodByMethod:
    """The rod of the design's section by one of the methods for loaded rods.

    method : a name of `beamopt.comparators.methods`. count : modes, elements, steps, or digits.
    """

    method: str
    count: int

    @property
    def family(self) -> str:
        """The method's name."""
        return f"rod, {self.method}"

    @property
    def resolution(self) -> str:
        """Its count."""
        return str(self.count)

    def refuses(self, question: Question) -> str | None:
        """It can always be asked."""
        return None

    def reply(self, question: Question, workers: int = 0) -> Reply:
        """Tips by this method, whether loads make it necessary or not; see `RodOnOutline`."""
        design = question.design.model_copy()  # measured from scratch
        parents = parents_on_grid() if question.is_on_grid else None
        method = next(one for one in all_methods(parents) if one.name == self.method)
        model: RodModel = design.climb.model.on(Rung.LOADED)
        values = design.values if model.loads.any else SectionValues(design.moments)
        rod, rest = model.rod(values), model.rest(values, question.pressures)
        found = method.solve(rod, rest, self.count)
        tips = model.centroids(values, found.tips, found.rotations)
        return replace(_answered(Tips(tips, found.status)), errors=found.error)
