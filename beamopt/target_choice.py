"""Where a scene's target comes from."""

from __future__ import annotations

from typing import Literal

from pydantic import model_validator

from beamopt.actuator import Vector
from beamopt.model import Count, Model, quantity
from beamopt.target import BaseFrame

__all__ = ["TargetChoice"]


class TargetChoice(Model):
    """The workspace to reach.

    kind "random": that of a random section; "section": that of a design file; "workspace": a CSV
    file with the columns p1,p2,p3,x,y,z.
    """

    kind: Literal["random", "section", "workspace"] = quantity("random", "where it comes from")
    seed: Count = quantity(0, 'seed of the random section, for kind "random"', low=0)
    file: str | None = quantity(None, "design (JSON) or table (CSV), relative to this scene")
    base_origin: Vector = quantity((0.0, 0.0, 0.0), "the base in the table's frame", unit="mm")
    base_x: Vector = quantity((1.0, 0.0, 0.0), "direction of the section's x axis in that frame")
    base_z: Vector = quantity((0.0, 0.0, 1.0), "direction of the straight actuator in that frame")

    @model_validator(mode="after")
    def _has_its_file(self) -> TargetChoice:
        if self.kind != "random" and self.file is None:
            raise ValueError(f'target.file must be given for kind "{self.kind}"')
        if self.kind == "random" and self.file is not None:
            raise ValueError('target.file goes with kind "section" or "workspace"')
        base = self.base  # checks the directions
        if self.kind != "workspace" and base != BaseFrame():
            raise ValueError('base_origin, base_x, base_z go with kind "workspace"')
        return self

    @property
    def base(self) -> BaseFrame:
        """The actuator's base in the frame of the table."""
        return BaseFrame(self.base_origin, self.base_x, self.base_z)
