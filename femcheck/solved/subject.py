"""The section that beam and solid are both made of, and how it came to be."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.brief import Brief
from beamopt.outline.faults import Fault, FaultKind, Severity
from beamopt.outline.outline import Outline
from beamopt.rod.arc import arc_tips
from beamopt.rod.response import LinearResponse, linear_response
from beamopt.scene.design import Design
from beamopt.section.moments import Moments
from beamopt.target.workspace import pressure_grid
from femcheck.mesh.section_mesh import SectionMesh

__all__ = [
    "GeometrySteps",
    "LoadedDesignError",
    "Subject",
    "UnsealedDesignError",
    "check_sealed",
    "check_unloaded",
    "geometry_steps",
    "sealed_copy",
    "slender_copy",
]


class UnsealedDesignError(ValueError):
    """A design whose chambers are open: no solid can be made of it.

    Examples
    --------
    >>> import femcheck
    >>> issubclass(femcheck.UnsealedDesignError, ValueError)
    True
    """


class LoadedDesignError(ValueError):
    """A design whose rod is not straight, uniform and under pressure alone.

    Examples
    --------
    >>> import femcheck
    >>> import beamopt
    >>> loaded = beamopt.load_design(str(beamopt.load_scene("gravity").target.file)).model_copy(
    ...     update={"loads": beamopt.Loading(density=1070.0)}
    ... )
    >>> try:
    ...     subject = femcheck.Subject("heavy", loaded)
    ... except femcheck.LoadedDesignError as error:
    ...     print(str(error).partition(":")[0])
    heavy has loads
    """


@dataclass(frozen=True, eq=False)
class Subject:
    """A design to be checked.

    name : of its folder and in tables.
    design : as it is checked, sealed if it was asked for.
    sealing_moved : (27,) how far sealing a copy moved the beam's tips [mm]; None where the design
        was taken as it is.

    Raises
    ------
    LoadedDesignError : loads, segments or a rest curvature, which the solid does not have.

    Examples
    --------
    >>> import femcheck
    >>> import beamopt
    >>> drawn = beamopt.load_design(str(beamopt.load_scene("gravity").target.file))
    >>> subject = femcheck.sealed_copy("round", drawn, 1.0)
    >>> subject = femcheck.Subject("renamed", subject.design)
    >>> round(subject.slenderness, 3)
    2.0
    """

    name: str
    design: Design
    sealing_moved: FloatArray | None = None

    def __repr__(self) -> str:
        return f"<Subject {Brief(self.name)}: {self.design!r}>"

    def __post_init__(self) -> None:
        check_unloaded(self.name, self.design)

    @property
    def outline(self) -> Outline:
        """The polygons that the section is."""
        return self.design.outline

    @cached_property
    def pressures(self) -> FloatArray:
        """(27, 3) [kPa]."""
        return pressure_grid(self.design.pressures)

    @cached_property
    def response(self) -> LinearResponse:
        """Of the beam on the outline's exact moments."""
        return linear_response(self.outline.moments, self.design.actuator.youngs_modulus)

    @cached_property
    def beam_tips(self) -> FloatArray:
        """(27, 3) [mm], the base's material centroid at the origin."""
        return self.tips_of(self.outline.moments)

    def tips_of(self, moments: Moments) -> FloatArray:
        """(27, 3) tips [mm] of the beam on any view of the section."""
        actuator = self.design.actuator
        response = linear_response(moments, actuator.youngs_modulus)
        return arc_tips(response.strains(self.pressures), actuator.length)

    @property
    def largest_turn(self) -> float:
        """Largest angle between the beam's tip and its base [rad]."""
        strains = self.response.strains(self.pressures)
        return float(np.hypot(strains[:, 1], strains[:, 2]).max() * self.design.actuator.length)

    @property
    def slenderness(self) -> float:
        """H/D: length over outer diameter."""
        return self.design.actuator.length / (2 * self.design.grid.outer_radius)

    @property
    def fatal(self) -> Fault | None:
        """Why no solid can be made of it."""
        return next((f for f in self.outline.faults if f.severity is Severity.FATAL), None)

    @property
    def has_islands(self) -> bool:
        """Whether material hangs in a chamber: the beam is not the solid's limit then."""
        return bool(self.outline.islands)


@dataclass(frozen=True, slots=True)
class GeometrySteps:
    """Worst tip differences of the beam between one view of the section and the next [mm]."""

    raster_to_smooth: float
    smooth_to_outline: float
    outline_to_mesh: float


def geometry_steps(subject: Subject, mesh: SectionMesh) -> GeometrySteps:
    """How far the tips move from raster to smooth outline, to its polygons, to the mesh."""
    views = subject.outline.views(subject.design.section.moments)
    tips = [subject.tips_of(moments) for moments in (*views, mesh.moments)]
    raster, smooth, outline = (
        float(np.linalg.norm(after - before, axis=1).max()) for before, after in pairwise(tips)
    )
    return GeometrySteps(raster, smooth, outline)


def sealed_copy(name: str, design: Design, skin: float) -> Subject:
    """A copy of a design sealed by a skin [mm], walls and corners to go with it, and what it moved.

    Raises
    ------
    ValueError : a skin that leaves nothing of the ring, or not more than the design has already.

    Examples
    --------
    >>> import femcheck
    >>> import beamopt
    >>> drawn = beamopt.load_design(str(beamopt.load_scene("gravity").target.file))
    >>> subject = femcheck.sealed_copy("round", drawn, 1.0)
    >>> subject.design.seal.skin
    1.0
    """
    if design.seal.skin >= skin:
        raise ValueError(f"the design has a skin of {design.seal.skin:g} mm already; ask for more")
    seal = design.seal.sealed_by(skin)
    seal.check_fits(design.grid.build())
    # walls in mm take the place of walls of elements, which an outline can not have
    changes = {"seal": seal, "wall_elements": 0, "notes": {"sealed_copy_of": name}}
    sealed = design.model_copy(update=changes)
    moved = np.linalg.norm(sealed.workspace.tips - design.workspace.tips, axis=1)
    return Subject(name, sealed, moved)


def slender_copy(subject: Subject, slenderness: float) -> Subject:
    """A subject of another length: H/D outer diameters; the beam is of that length too.

    Raises
    ------
    ValueError : a length that no design can have.

    Examples
    --------
    >>> import femcheck
    >>> import beamopt
    >>> drawn = beamopt.load_design(str(beamopt.load_scene("gravity").target.file))
    >>> subject = femcheck.sealed_copy("round", drawn, 1.0)
    >>> femcheck.slender_copy(subject, 4.0).design.actuator.length
    200.0
    """
    length = slenderness * 2 * subject.design.grid.outer_radius
    actuator = subject.design.actuator.model_copy(update={"length": length})
    return replace(subject, design=subject.design.model_copy(update={"actuator": actuator}))


def check_sealed(name: str, design: Design) -> None:
    """Refuse a design whose chambers are open.

    Raises
    ------
    UnsealedDesignError : the chamber, and the way out.
    """
    opened = [f for f in design.outline.faults if f.status is FaultKind.UNSEALED]
    if opened:
        raise UnsealedDesignError(
            f"{name} is not sealed: {opened[0]}; --seal 1.0 seals a copy by a skin of 1 mm and "
            "says how far that moves the tips"
        )


def check_unloaded(name: str, design: Design) -> None:
    """Refuse a design whose beam is not an arc.

    Raises
    ------
    LoadedDesignError : what it has that the solid does not.
    """
    model = design.loaded_rod
    extras = {
        "loads": model.loads.any,
        "rod.segments": not model.is_uniform,
        "rod.rest_curvature": bool(np.any(model.curvature)),
    }
    found = [key for key, there in extras.items() if there]
    if found:
        raise LoadedDesignError(
            f"{name} has {', '.join(found)}: the solid is a straight actuator of one section under "
            "pressure alone; take the keys out of a copy to check its section"
        )
