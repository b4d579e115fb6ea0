"""The actuators that the solid's benchmarks are about."""

from __future__ import annotations

import time

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.scene.actuator import Actuator
from beamopt.scene.design import Design, Grid
from beamopt.scene.drawn_chambers import DrawnChamber
from beamopt.scene.seal_keys import Seal
from femcheck.continuation.direct import DirectSolver, direct_solver
from femcheck.continuation.load_steps import LoadSteps
from femcheck.continuation.shape import Shapes
from femcheck.material.law import Law
from femcheck.material.rigid_section import RigidSection
from femcheck.mesh.extrusion import extrude, stations
from femcheck.mesh.geo import SectionSizes
from femcheck.mesh.gmsh_section import Mesher, MeshFailure
from femcheck.mesh.section_mesh import SectionMesh
from femcheck.solid.body import discretise
from femcheck.solid.equilibrium import Equilibrium, actuator
from femcheck.solid.state import State

__all__ = [
    "LENGTH",
    "LOAD",
    "RIGID",
    "iteration",
    "loaded",
    "problem_of",
    "section_of",
    "three_chambers",
]

LENGTH = 100.0
LOAD = np.array([10.0, 5.0, 0.0])
"""[kPa] small enough for one walk of Newton's method from rest; its cost does not depend on it."""
RIGID = RigidSection(300.0, 2500.0)


def three_chambers() -> Design:
    """Three drawn chambers 13…22 mm × 80°, walls of 3 mm all around, no skin asked for."""
    return Design(
        schema="beamopt-design/1",
        grid=Grid(),
        drawing=[
            DrawnChamber(supply=i + 1, r=(13, 22), phi=(120 * i - 40, 120 * i + 40), corner=1.0)
            for i in range(3)
        ],
        wall_elements=0,
        seal=Seal(),
        actuator=Actuator(length=LENGTH, youngs_modulus=300.0),
        pressures=(0.0, 50.0, 100.0),
    )


def section_of(factor: float, design: Design | None = None) -> SectionMesh:
    """A design's section, or the three chambers', with sizes multiplied by `factor`."""
    outline = (design or three_chambers()).outline
    section = Mesher().mesh(outline, SectionSizes(factor=factor))
    if isinstance(section, MeshFailure):
        raise RuntimeError(str(section))
    return section


def problem_of(section: SectionMesh, layers: int, law: Law = RIGID) -> Equilibrium:
    """The actuator of 18-node wedges."""
    return actuator(discretise(extrude(section, stations(LENGTH, layers, 1.5))), law)


def loaded(problem: Equilibrium) -> tuple[State, DirectSolver]:
    """Its equilibrium at `LOAD`, and the solver that found it."""
    solver = direct_solver()
    start = (problem.rest(), np.zeros(3))
    found = LoadSteps().walk(problem, Shapes(problem.body), start, LOAD, solver)
    if found.state is None:
        raise RuntimeError(found.status.value)
    return found.state, solver


def iteration(
    problem: Equilibrium, state: State, pressures: FloatArray, solver: DirectSolver
) -> FloatArray:
    """(3,) seconds of an iteration's assembly (forces and tangent), factor and solve."""
    began = time.perf_counter()
    forces = problem.forces(state, pressures)
    tangent = problem.tangent(state, pressures, forces)
    assembled = time.perf_counter()
    solver.factor(tangent)
    factored = time.perf_counter()
    solver.solve(-forces.reduced)
    return np.diff([began, assembled, factored, time.perf_counter()])
