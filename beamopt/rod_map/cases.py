"""Random sections under loads of every kind and size, from harmless to far beyond sense."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum
from functools import lru_cache

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.comparators.workload import random_section
from beamopt.rod.ladder import Loads, RodModel, SectionValues
from beamopt.rod.rod import LineLoad, PointLoad, Rod
from beamopt.scene.scene import Scene, load_scene

__all__ = ["SLENDERNESSES", "CaseKind", "LoadedSection", "RodCase", "case_of", "sizes_of"]

SCENE = "random-section"  # whose rules make the sections
SIZES = 13
SLENDERNESSES: tuple[float, ...] = tuple(np.round(np.geomspace(2.0, 200.0, 9), 1).tolist())
"""Length over diameter."""

CROOKED = 0.01  # rad: angle of an axially loaded rod's rest shape
LIGHT = 0.1  # weight L³/EI of a rod under pressure


class CaseKind(Enum):
    """What loads a rod; the value is the text shown to people."""

    WEIGHT = "weight"
    TRANSVERSE = "transverse"
    AXIAL = "axial"
    FOLLOWER = "follower"
    PRESSURE = "pressure"

    @property
    def text(self) -> str:
        """What it is, and what its size is."""
        return {
            CaseKind.WEIGHT: "weight in any direction, w L³/EI",
            CaseKind.TRANSVERSE: "dead force across the tip, F L²/EI",
            CaseKind.AXIAL: "dead force on the tip of a crooked column, F L²/EI",
            CaseKind.FOLLOWER: "follower force across the tip, F L²/EI",
            CaseKind.PRESSURE: "pressure, and a little weight: angle of the rest shape [rad]",
        }[self]


def sizes_of(kind: CaseKind) -> tuple[float, ...]:
    """Dimensionless sizes of a load; EI is the smaller principal one."""
    low, high = (0.1, 100.0) if kind is CaseKind.PRESSURE else (1e-2, 1e4)
    return tuple(float(f"{size:.3g}") for size in np.geomspace(low, high, SIZES))


@dataclass(frozen=True)
class RodCase:
    """A rod under load to be solved: number `index` of a seed. size : see `CaseKind.text`."""

    seed: int
    index: int
    kind: CaseKind
    size: float
    slenderness: float


def case_of(seed: int, index: int) -> RodCase:
    """The case of that number; a row of cases fills kinds and sizes evenly."""
    kinds = list(CaseKind)
    kind = kinds[index % len(kinds)]
    cell, turn = index % (len(kinds) * SIZES), index // (len(kinds) * SIZES)
    slenderness = SLENDERNESSES[(turn + 4 * cell) % len(SLENDERNESSES)]
    return RodCase(seed, index, kind, sizes_of(kind)[cell // len(kinds)], slenderness)


@dataclass(frozen=True, eq=False)
class LoadedSection:
    """The rod of a case, straight at rest but for pressure or crookedness.

    rest : (1, 1, 6) strains.
    """

    rod: Rod
    rest: FloatArray

    @classmethod
    def of(cls, case: RodCase) -> LoadedSection:
        """Section and directions come from a stream of the case's own."""
        scene, plain = _plain_model()
        section = random_section(scene, plain, (case.seed, case.index))
        rng = np.random.default_rng([case.seed, case.index, 0xD1])
        length = case.slenderness * 2 * scene.grid.outer_radius
        model, pressures = LOADED[case.kind](replace(plain, length=length), section, case.size, rng)
        return cls(model.rod(section), model.rest(section, pressures))


@lru_cache(maxsize=1)
def _plain_model() -> tuple[Scene, RodModel]:
    """A scene and its actuator without loads, with twist and shear after Saint-Venant."""
    scene = load_scene(SCENE)
    return scene, replace(scene.climb.model, twists=True)


Loaded = Callable[
    [RodModel, SectionValues, float, np.random.Generator], tuple[RodModel, FloatArray]
]
NO_PRESSURE: FloatArray = np.zeros((1, 3))


def _weight(
    model: RodModel, section: SectionValues, size: float, rng: np.random.Generator
) -> tuple[RodModel, FloatArray]:
    force = size * _stiffness(model, section) / model.length**3 * _direction(rng)
    return replace(model, loads=Loads(line=LineLoad(force))), NO_PRESSURE


def _transverse(
    model: RodModel, section: SectionValues, size: float, rng: np.random.Generator
) -> tuple[RodModel, FloatArray]:
    force = size * _stiffness(model, section) / model.length**2 * _across(rng)
    return replace(model, loads=Loads(tip=PointLoad(force))), NO_PRESSURE


def _axial(
    model: RodModel, section: SectionValues, size: float, rng: np.random.Generator
) -> tuple[RodModel, FloatArray]:
    force = np.array([0.0, 0.0, -size * _stiffness(model, section) / model.length**2])
    crooked = CROOKED / model.length * _across(rng)
    return replace(model, loads=Loads(tip=PointLoad(force)), curvature=crooked), NO_PRESSURE


def _follower(
    model: RodModel, section: SectionValues, size: float, rng: np.random.Generator
) -> tuple[RodModel, FloatArray]:
    force = size * _stiffness(model, section) / model.length**2 * _across(rng)
    return replace(model, loads=Loads(tip=PointLoad(follower_force=force))), NO_PRESSURE


def _pressure(
    model: RodModel, section: SectionValues, size: float, rng: np.random.Generator
) -> tuple[RodModel, FloatArray]:
    pressures = rng.uniform(size=(1, 3))
    bent = float(np.linalg.norm(model.response_of(section.moments).strains(pressures)[0, 1:]))
    light, _ = _weight(model, section, LIGHT, rng)
    return light, pressures * size / (bent * model.length)


LOADED: dict[CaseKind, Loaded] = {
    CaseKind.WEIGHT: _weight,
    CaseKind.TRANSVERSE: _transverse,
    CaseKind.AXIAL: _axial,
    CaseKind.FOLLOWER: _follower,
    CaseKind.PRESSURE: _pressure,
}


def _stiffness(model: RodModel, section: SectionValues) -> float:
    """The smaller principal EI [mN·mm²]."""
    values, _ = section.moments.principal
    return model.youngs_modulus * float(values[0])


def _direction(rng: np.random.Generator) -> FloatArray:
    vector = rng.normal(size=3)
    return np.asarray(vector / np.linalg.norm(vector))


def _across(rng: np.random.Generator) -> FloatArray:
    angle = rng.uniform(0, 2 * np.pi)
    return np.array([np.cos(angle), np.sin(angle), 0.0])
