"""What a file says about the actuator but for its section: body, rod, loads."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from functools import partial
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError
from beamopt.rod.ladder import Loads, RodModel, RodPiece, Rung, SectionValues
from beamopt.rod.law import poissons_ratio
from beamopt.rod.response import linear_response
from beamopt.rod.rod import LineLoad, PointLoad
from beamopt.storage.checked_keys import CheckedKeys, Number, quantity
from beamopt.storage.free_values import FreeTable

__all__ = ["RUNGS", "Actuator", "Loading", "RodRules", "SegmentChoice", "Vector", "rod_model"]

Component = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-1e6, le=1e6)]
Vector = tuple[Component, Component, Component]

NEWTON_PER_MILLINEWTON = 1e-3
CUBIC_MM_PER_M3 = 1e9
GRAMS_PER_KG = 1e3


def _incompressible(given: dict[str, Any]) -> float:
    """G of E alone: E/(2(1 + ν)) with ν = ½ of rubber; the paper's 100 kPa for its E."""
    return float(given["youngs_modulus"] / 3)


class Actuator(CheckedKeys):
    """The extruded body and its material; without a shear modulus it has G = E/3.

    Examples
    --------
    >>> import beamopt
    >>> beamopt.Actuator(youngs_modulus=60.0).shear_modulus
    20.0
    """

    length: Number = quantity(100.0, "undeformed length H", unit="mm", low=0.1, high=1e5)
    youngs_modulus: Number = quantity(300.0, "Young's modulus E", unit="kPa", low=5, high=50_000)
    shear_modulus: Number = Field(
        default_factory=_incompressible,
        description="shear modulus G",
        ge=1,
        le=50_000,
        json_schema_extra={"unit": "kPa"},
    )


class SegmentChoice(CheckedKeys):
    """A piece of the actuator; without `file` or `section` of the section that is searched.

    Examples
    --------
    >>> import beamopt
    >>> half = beamopt.SegmentChoice(share=0.5)
    >>> len(beamopt.RodRules(segments=(half, half)).segments)
    2
    """

    share: Number = quantity(..., "of the actuator's length; they add to 1", low=1e-3, high=1)
    turned: Number = quantity(
        0.0, "angle of its section about the axis", unit="degrees", low=-360, high=360
    )
    file: str | None = quantity(None, "design file whose section it has, relative to this one")
    section: FreeTable | None = quantity(None, "a whole design, instead of a file")

    @model_validator(mode="after")
    def _has_one_section(self) -> SegmentChoice:
        if self.file is not None and self.section is not None:
            raise ValueError("either file or section")
        try:
            json.dumps(self.section, ensure_ascii=False, allow_nan=False).encode()
        except UnicodeEncodeError:
            raise ValueError("section: text with half a surrogate pair") from None
        return self


class RodRules(CheckedKeys):
    """The rod that judges sections: an arc, a chain of them, or a rod under loads.

    "auto" takes the lowest rung that is exact, or near enough; `beamopt rung SCENE` says why.

    Examples
    --------
    >>> import beamopt
    >>> beamopt.RodRules(rest_curvature=(0.01, 0.0, 0.0)).rung
    'auto'
    """

    rung: Literal["auto", "arc", "chain", "loaded"] = quantity("auto", "how it is solved")
    method: Literal["modes", "elements"] = quantity(
        "modes", "of the loaded rod: Legendre modes, or finite elements"
    )
    tolerance: Number = quantity(
        0.001, "error of a tip that is near enough, as a share of the length", low=1e-9, high=0.1
    )
    twist: Literal["auto", "stiff", "saint-venant"] = quantity(
        "auto", "sections twist and shear under loads after Saint-Venant, or do not twist"
    )
    rest_curvature: Vector = quantity(
        (0.0, 0.0, 0.0), "of a pre-curved actuator, about the section's x and y, and twist",
        unit="1/mm",
    )  # fmt: skip
    segments: tuple[SegmentChoice, ...] = quantity(
        (), 'pieces from the base on, as {share = 0.5, turned = 0.0, file = "a.json"}; [] is one'
    )

    @model_validator(mode="after")
    def _is_whole(self) -> RodRules:
        total = sum(one.share for one in self.segments)
        if self.segments and abs(total - 1) > 1e-9:
            raise ValueError(f"the shares of rod.segments add to {total:.9g}: must be 1")
        if self.segments and all(one.file or one.section for one in self.segments):
            raise ValueError("rod.segments: at least one without a file, to be searched")
        return self


class Loading(CheckedKeys):
    """What loads the actuator besides pressure. The room's z axis points up.

    Forces keep their direction in the room; followers turn with the section that they act on.

    Examples
    --------
    >>> import beamopt
    >>> beamopt.Loading(density=1070.0).weighs
    True
    """

    mount_z: Vector = quantity((0.0, 0.0, 1.0), "direction of the straight actuator in the room")
    mount_x: Vector = quantity((1.0, 0.0, 0.0), "direction of the section's x axis in the room")
    density: Number = quantity(
        0.0, "of the material; 0 has no weight", unit="kg/m³", low=0, high=30_000
    )
    gravity: Number = quantity(9.81, "acceleration", unit="m/s²", low=0, high=1000)
    tool_mass: Number = quantity(0.0, "of a tool at the tip", unit="g", low=0, high=1e6)
    tool_at: Vector = quantity(
        (0.0, 0.0, 0.0), "where tool and tip forces act, from the tip, in its axes", unit="mm"
    )
    tip_force: Vector = quantity((0.0, 0.0, 0.0), "dead force, in the room", unit="mN")
    tip_moment: Vector = quantity((0.0, 0.0, 0.0), "dead moment, in the room", unit="mN·mm")
    follower_force: Vector = quantity((0.0, 0.0, 0.0), "in the tip's axes", unit="mN")
    follower_moment: Vector = quantity((0.0, 0.0, 0.0), "in the tip's axes", unit="mN·mm")
    line_force: Vector = quantity((0.0, 0.0, 0.0), "dead, along the rod", unit="mN/mm")
    line_follower: Vector = quantity((0.0, 0.0, 0.0), "in the sections' axes", unit="mN/mm")

    @model_validator(mode="after")
    def _is_mounted(self) -> Loading:
        z, x = np.array(self.mount_z), np.array(self.mount_x)
        lengths = math.hypot(*z), math.hypot(*x)
        if not min(lengths) > 0:
            raise ValueError("mount_z and mount_x must not be zero vectors")
        if abs(z @ x) > 1e-6 * lengths[0] * lengths[1]:
            raise ValueError("mount_z and mount_x must be perpendicular")
        return self

    @property
    def mount(self) -> FloatArray:
        """(3, 3) rotation from the base's axes to the room's."""
        z = np.array(self.mount_z) / math.hypot(*self.mount_z)
        x = np.array(self.mount_x) / math.hypot(*self.mount_x)
        return np.stack([x, np.cross(z, x), z], axis=1)

    @property
    def weighs(self) -> bool:
        """Whether gravity pulls at anything."""
        return self.gravity > 0 and (self.density > 0 or self.tool_mass > 0)

    @property
    def loads(self) -> Loads:
        """The loads in the frame of the base [mN, mN·mm, mN/mm, mN/mm³]."""
        to_base = self.mount.T
        down = np.array([0.0, 0.0, -self.gravity / NEWTON_PER_MILLINEWTON])
        tool = down * self.tool_mass / GRAMS_PER_KG
        tip = PointLoad(
            force=to_base @ (tool + np.array(self.tip_force)),
            moment=to_base @ np.array(self.tip_moment),
            follower_force=np.array(self.follower_force),
            follower_moment=np.array(self.follower_moment),
            at=np.array(self.tool_at),
        )
        line = LineLoad(to_base @ np.array(self.line_force), np.array(self.line_follower))
        return Loads(to_base @ down * self.density / CUBIC_MM_PER_M3, line, tip)


RUNGS = {"arc": Rung.ARC, "chain": Rung.CHAIN, "loaded": Rung.LOADED}
"""The rungs by their names in a file."""


def rod_model(
    actuator: Actuator,
    rules: RodRules,
    loads: Loading,
    values_of: Callable[[dict[str, Any], float], SectionValues],
) -> RodModel:
    """The rod of an actuator but for its section; `climb` puts it on its rung.

    values_of : what makes values of a section that is given as a whole design, and of ν.

    Raises
    ------
    InputError : a segment whose file was not read.
    """
    for one in rules.segments:
        if one.file is not None:
            raise InputError("", "rod.segments", one.file, "read by load_scene and load_design")
    nu = poissons_ratio(actuator.youngs_modulus, actuator.shear_modulus)
    return RodModel(
        length=actuator.length,
        youngs_modulus=actuator.youngs_modulus,
        shear_modulus=actuator.shear_modulus,
        response_of=partial(linear_response, youngs_modulus=actuator.youngs_modulus),
        pieces=tuple(
            RodPiece(
                one.share,
                math.radians(one.turned),
                None if one.section is None else values_of(one.section, nu),
            )
            for one in rules.segments
        )
        or (RodPiece(1.0),),
        loads=loads.loads,
        curvature=np.array(rules.rest_curvature),
        method=rules.method,
        tolerance=rules.tolerance * actuator.length,
    )
