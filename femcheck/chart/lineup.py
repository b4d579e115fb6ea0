"""Which models a chart holds against each other, each from coarse to fine."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

from beamopt.base.errors import InputError
from femcheck.models.beam import ArcOnGrid, RodByMethod, RodOnOutline
from femcheck.models.felupe import FelupeModel
from femcheck.models.question import Question
from femcheck.models.reply import Model
from femcheck.models.solid import SolidModel

__all__ = ["FAMILIES", "Series", "line_up", "mark_of"]

GRIDS = ((32, 90), (64, 180), (128, 360), (256, 720), (512, 1440))
RODS = {
    "adaptive": (3, 6, 9),
    "modes": (4, 8, 12),
    "elements": (16, 64, 256),
    "shooting": (16, 64, 256),
    "multiple-shooting": (16, 64, 256),
    "collocation": (3, 5, 8),
}
COARSEST = 2.0  # size of triangles below which the outline's own edges hardly let a mesh be
STIFFER = (10_000.0, 40_000.0)  # penalties that tell what is left of the usual ones
CORRECTED = 4  # layers at which size and penalty are varied
GRADED = 2.0  # grading of a material's solid, times the layers: the clamp's reach is a wall's


@dataclass(frozen=True)
class Series:
    """Models of one family, from coarse to fine.

    models : of which each is finer than the one before in the same respect.
    sized, stiffer : a model that is finer in its triangles alone, or in its penalties; None where
        there is none. Both differ from the one of `models` with as many layers.
    """

    family: str
    models: tuple[Model, ...]
    sized: SolidModel | None = None
    stiffer: SolidModel | None = None

    @property
    def all(self) -> Iterator[Model]:
        """Every model of it."""
        yield from self.models
        for extra in (self.sized, self.stiffer):
            if extra is not None:
                yield extra


def line_up(
    question: Question, families: Sequence[str] | None = None, *, whatever: bool = False
) -> list[Series]:
    """All series that can be asked, or those of these families.

    whatever : also those that can not be asked here, as a library is missing.

    Raises
    ------
    InputError : a family that there is not.
    """
    for name in families or ():
        if name not in FAMILIES:
            raise InputError("--family", "", name, f"one of {', '.join(FAMILIES)}")
    found = []
    for series in _all(question):
        wanted = families is None or series.family in families
        if wanted and (whatever or series.models[0].refuses(question) is None):
            found.append(series)
    return found


def _all(question: Question) -> Iterator[Series]:
    yield Series("raster", tuple(ArcOnGrid(*grid) for grid in GRIDS))
    yield Series("beam", (RodOnOutline(),))
    for name, counts in RODS.items():
        yield Series(f"rod, {name}", tuple(RodByMethod(name, count) for count in counts))
    solids = partial(_solid, question)
    stiffer = None
    if question.is_of_the_beam:
        stiffer = SolidModel(layers=CORRECTED, size=COARSEST, penalties=STIFFER)
    finer = solids("wedge18", CORRECTED, COARSEST / 4)
    layers = (2, 3, 4, 6, 8) if question.is_of_the_beam else (3, 4, 6, 8, 12)
    yield Series("wedge18", tuple(solids("wedge18", n, COARSEST) for n in layers), finer, stiffer)
    yield Series("hex27", tuple(solids("hex27", n, 2 * COARSEST) for n in (2, 3, 4)))
    refined = zip((4, 6, 8, 12), (COARSEST, 1.4, 1.0, 0.7), strict=True)
    yield Series("tet10", tuple(solids("tet10", n, size) for n, size in refined))
    yield Series("tet4", tuple(solids("tet4", n, size) for n, size in ((8, 1.0), (16, 0.5))))
    yield Series("felupe", tuple(FelupeModel(layers, COARSEST) for layers in (2,)))


def mark_of(model: Model) -> str:
    """The resolution in as few characters as a figure has room for: layers / size of a solid."""
    if isinstance(model, SolidModel | FelupeModel):
        return f"{model.layers} / {model.size:g}"
    return model.resolution


def _solid(question: Question, element: str, layers: int, size: float) -> SolidModel:
    """Graded where the law feels the clamp."""
    grading = None if question.is_of_the_beam else GRADED * layers
    return SolidModel(element, layers, size, grading=grading)


FAMILIES = (
    "raster",
    "beam",
    *(f"rod, {name}" for name in RODS),
    "wedge18",
    "hex27",
    "tet10",
    "tet4",
    "felupe",
)
"""Names that a chart may be asked for."""
