"""Where a scene's target comes from."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from beamopt.base.errors import InputError
from beamopt.scene.actuator import Vector
from beamopt.storage.checked_keys import CheckedKeys, Count, Number, quantity
from beamopt.target.aim import Aim
from beamopt.target.point_table import read_pairs
from beamopt.target.target import BaseFrame, Target
from beamopt.target.trajectory import MOST_SAMPLES, read_path

__all__ = ["MOST_PATHS", "TargetChoice"]

MOST_PATHS = 99
Paths = Annotated[tuple[str, ...], Field(max_length=MOST_PATHS)]

OF_FILES = ("section", "workspace", "points")
OF_TABLES = ("workspace", "points", "paths")


class TargetChoice(CheckedKeys):
    """What the tip should reach.

    kind "random": the workspace of a random section; "section": that of a design file; "workspace":
    a CSV file with the columns p1,p2,p3,x,y,z at all 27 combinations; "points": such a file with
    rows at any pressures, also with the columns weight, tx,ty,tz (direction of the tip's axis) and
    direction_weight; "paths": nothing but the trajectories of `paths`, which go with any kind.

    Examples
    --------
    >>> import beamopt
    >>> beamopt.TargetChoice(kind="random", seed=3).seed
    3
    """

    kind: Literal["random", "section", "workspace", "points", "paths"] = quantity(
        "random", "where it comes from"
    )
    seed: Count = quantity(0, 'seed of the random section, for kind "random"', low=0)
    file: str | None = quantity(None, "design (JSON) or table (CSV), relative to this scene")
    direction_weight: Number | None = Field(
        default=None,
        description="of a squared difference of unit tangents, for kind \"points\"; (length/10)² "
        "if left out",
        ge=0,
        le=1e9,
        json_schema_extra={"unit": "mm²"},
    )  # fmt: skip
    paths: Paths = quantity(
        (), "trajectories (CSV, x,y,z in mm) to be followed at any pressures between the levels"
    )
    path_step: Number = quantity(
        5.0, "largest distance of their points", unit="mm", low=0.01, high=1000
    )
    path_weight: Number = quantity(1.0, "of their squared distances", low=0, high=1e6)
    base_origin: Vector = quantity((0.0, 0.0, 0.0), "the base in the tables' frame", unit="mm")
    base_x: Vector = quantity((1.0, 0.0, 0.0), "direction of the section's x axis in that frame")
    base_z: Vector = quantity((0.0, 0.0, 1.0), "direction of the straight actuator in that frame")

    @model_validator(mode="after")
    def _has_its_files(self) -> TargetChoice:
        if self.kind in OF_FILES and self.file is None:
            raise ValueError(f'target.file must be given for kind "{self.kind}"')
        if self.kind not in OF_FILES and self.file is not None:
            raise ValueError('target.file goes with kind "section", "workspace" or "points"')
        if self.kind == "paths" and not (self.paths and self.path_weight > 0):
            raise ValueError('target.paths and path_weight must be given for kind "paths"')
        if self.kind != "points" and self.direction_weight is not None:
            raise ValueError('target.direction_weight goes with kind "points"')
        base = self.base  # checks the directions
        if self.kind not in OF_TABLES and not self.paths and base != BaseFrame():
            raise ValueError(
                'base_origin, base_x, base_z go with kind "workspace" or "points", or with paths'
            )
        return self

    @property
    def base(self) -> BaseFrame:
        """The actuator's base in the frame of the tables."""
        return BaseFrame(self.base_origin, self.base_x, self.base_z)

    @property
    def files(self) -> tuple[str, ...]:
        """All of its files: `file` first, if any."""
        return (*(() if self.file is None else (self.file,)), *self.paths)

    def beside(self, folder: Path) -> TargetChoice:
        """The same with its files' whole paths, which are relative to `folder`."""
        changed: dict[str, object] = {"paths": tuple(str(folder / path) for path in self.paths)}
        if self.file is not None:
            changed["file"] = str(folder / self.file)
        return self.model_copy(update=changed)

    def by_name(self) -> TargetChoice:
        """The same with its files' names alone: a scene beside which they lie."""
        changed: dict[str, object] = {"paths": tuple(Path(path).name for path in self.paths)}
        if self.file is not None:
            changed["file"] = Path(self.file).name
        return self.model_copy(update=changed)

    def pairs(self, length: float, straight: bool) -> Target:
        """The rows of its table of points; none for kind "paths".

        length : of the actuator [mm]. straight : see `read_pairs`.

        Raises
        ------
        InputError : see `read_pairs`.
        """
        if self.kind == "points":
            path = Path(str(self.file))
            return read_pairs(path, length, self.base, straight, self.direction_weight)
        none, nothing = np.zeros((0, 3)), np.zeros(0)
        return Target(Aim(none, none, nothing, none, nothing))

    def with_paths(self, target: Target, length: float) -> Target:
        """A target with its trajectories, for an actuator of `length` [mm].

        Raises
        ------
        InputError : see `read_path`.
        """
        if not self.paths:
            return target
        paths = tuple(
            read_path(Path(path), length, self.path_step, self.base) for path in self.paths
        )
        samples = sum(len(path) for path in paths)
        if samples > MOST_SAMPLES:
            said = f"{MOST_SAMPLES} samples at most, of all trajectories: a larger path_step"
            raise InputError("", "target.paths", f"{samples} samples", said)
        return target.with_paths(paths, self.path_weight)
