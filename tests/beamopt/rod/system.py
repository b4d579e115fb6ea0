"""A rod's equations in its modes, from the kernels themselves."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.rod.balance import reaction_of, unknown_count
from beamopt.rod.newton import CLOSE, evaluate, newton
from beamopt.rod.packed import pack, stations_of
from beamopt.rod.rod import Rod
from beamopt.rod.shape import empty_shape
from beamopt.rod.tangent import tangent_into

__all__ = ["System"]


class System:
    """Residual, tangent and iteration of a rod at `factor` of its loads; a held tip is there."""

    def __init__(self, rod: Rod, modes: int = 6, factor: float = 1.0) -> None:
        self.rod, self.rest, self.factor = pack(rod), rod.rest, factor
        self.conservative = rod.is_conservative
        self.at = stations_of(tuple(one.length for one in rod.segments), modes)
        self.shape = empty_shape(len(self.at.at), len(rod.segments), len(self.at.step))
        self.size = unknown_count(self.rod, self.at)
        self.amplitudes = self.at.basis.shape[1] * len(rod.free)
        self.order = np.arange(self.amplitudes) // len(rod.free) % modes  # of the polynomials
        x = rod.tip.position
        self.held = (np.zeros(3) if x is None else x, np.zeros(3))

    def residual(self, unknowns: FloatArray) -> FloatArray:
        out = np.empty(self.size)
        parts = (self.rod, self.at, self.rest, *self.held, self.factor)
        evaluate(*parts, unknowns, self.shape, out)
        return out

    def tangent(self, unknowns: FloatArray) -> FloatArray:
        out = np.empty((self.size, self.size))
        self.residual(unknowns)
        reaction = reaction_of(self.rod, self.at, unknowns)
        tangent_into(self.rod, self.at, self.shape, self.factor, reaction, out)
        return out

    def differences(self, unknowns: FloatArray, step: float) -> FloatArray:
        columns = [
            (self.residual(unknowns + step * e) - self.residual(unknowns - step * e)) / (2 * step)
            for e in np.eye(self.size)
        ]
        return np.column_stack(columns)

    def somewhere(self, rng: np.random.Generator) -> FloatArray:
        """Curved by some tenths, higher modes less; hinge and reaction by some tenths."""
        unknowns = 0.3 * rng.normal(size=self.size)
        unknowns[: self.amplitudes] /= (1 + self.order) ** 2
        return unknowns

    def iterated(self, start: FloatArray | None = None) -> tuple[int, FloatArray]:
        """How Newton's iteration ended, and where; `shape` is the shape there."""
        unknowns = np.zeros(self.size) if start is None else start.copy()
        parts = (self.rod, self.at, self.rest, *self.held, self.conservative, False, CLOSE)
        ended, _ = newton(*parts, self.factor, unknowns, self.shape)
        return ended, unknowns

    def reaction(self, unknowns: FloatArray) -> FloatArray:
        """(6,) force and moment that hold the tip."""
        return reaction_of(self.rod, self.at, unknowns)
