"""What is read off an equilibrium: tip, chambers, strains along the axis, largest stretch."""

from __future__ import annotations

from dataclasses import dataclass

from beamopt.base.arrays import FloatArray
from femcheck.continuation.path import PathPoint
from femcheck.continuation.shape import Shapes
from femcheck.solid.equilibrium import Equilibrium

__all__ = ["Answer", "read_off"]


@dataclass(frozen=True, eq=False)
class Answer:
    """A stable equilibrium.

    load : P on its ray [kPa].
    x : (n, 3) positions of all nodes [mm]. tip : (3,) of the tip face's material centroid [mm].
    volumes : (3,) of the chambers [mm³].
    strain_energy : [mN mm].
    stretch, stretch_at : largest principal stretch at a quadrature point, and the undeformed place
        (3,) of it [mm].
    axis : (k, 4) z [mm], ε, κ1, κ2 [1, 1/mm, 1/mm] between neighbouring planes of nodes.
    """

    load: float
    x: FloatArray
    tip: FloatArray
    volumes: FloatArray
    strain_energy: float
    stretch: float
    stretch_at: FloatArray
    axis: FloatArray


def read_off(problem: Equilibrium, shapes: Shapes, point: PathPoint) -> Answer:
    """What an equilibrium shows."""
    state = point.state
    stretch, where = problem.largest_stretch(state)
    return Answer(
        load=point.load,
        x=state.x,
        tip=state.tip,
        volumes=problem.volumes(state),
        strain_energy=problem.strain_energy(state),
        stretch=stretch,
        stretch_at=where,
        axis=shapes.axis(state),
    )
