"""What every law costs: an iteration, a path from rest to where it ends, memory.

The three-chamber section of the validation (80° chambers, sharp corners; of the wound law its round
ones) through gmsh, 18-node wedges, a length of 100 mm, E = 300 kPa. Each law works in a process of
its own, so that its peak memory is its own: `python -m tests.bench.solid_laws NAME LAYERS` prints
what it took.

Supply 1 alone is followed from rest to 100 kPa, or to where stable equilibria end and as far behind
as `PathSteps` looks for a snap. At the last stable point, with the pattern analysed, assembly
(forces and tangent), factor and solve are timed. A degree of freedom is a component of a node, as
in the other parts; unknowns are without those of held nodes and with the hydrostatic pressures.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from beamopt.scene.design import Design
from femcheck.continuation.direct import direct_solver
from femcheck.continuation.outcome import Status
from femcheck.continuation.shape import Shapes
from femcheck.continuation.trace import PathSteps
from femcheck.material.catalogue import law_by_name
from femcheck.material.fibre import Thread
from femcheck.material.law import Law
from femcheck.mesh.extrusion import extrude, stations
from femcheck.solid.body import discretise
from femcheck.solid.equilibrium import actuator
from femcheck.solid.winding import Wound, wind
from tests.bench.measured import Measured, in_own_process, peak_memory
from tests.bench.solid_cases import LENGTH, RIGID, iteration, section_of
from tests.validation.material import round_chambers
from tests.validation.solid import three_chambers

__all__ = ["CASES", "laws"]


class Case(NamedTuple):
    law: Law
    design: Callable[[], Design] = three_chambers
    wound: bool = False


CASES = {
    "rigid-section, c = 2500": Case(RIGID),
    "neo-hookean": Case(law_by_name("neo-hookean", 300.0)),
    "neo-hookean, ν = 0.4": Case(law_by_name("neo-hookean", 300.0, 0.4)),
    "gent": Case(law_by_name("gent", 300.0)),
    "mooney-rivlin": Case(law_by_name("mooney-rivlin", 300.0)),
    "yeoh": Case(law_by_name("yeoh", 300.0)),
    "neo-hookean, chambers wound": Case(law_by_name("neo-hookean", 300.0), round_chambers, True),
}
"""By name; in the mixed form with ν = 0.5 where nothing else is said."""

ALONE = np.array([1.0, 0.0, 0.0])
HIGHEST = 100.0
"""[kPa]"""
BUDGET = 300.0
"""[s] of the neo-Hookean trace."""
THREAD = Thread(1e5)
REPEATS = 5
ENDS = {
    Status.CONVERGED.name: f"to {HIGHEST:.0f} kPa",
    Status.LIMIT_POINT.name: "to limit point",
    Status.BUCKLED.name: "to buckling",
}


def laws(layers: int) -> Iterator[Measured]:
    """Every law on as many layers."""
    for name in CASES:
        took = in_own_process("tests.bench.solid_laws", name, str(layers))
        yield from _rows(f"laws: {name}", took)
        if name == "neo-hookean":
            said = "laws: neo-hookean, trace of one supply to its limit"
            yield Measured(said, took["seconds"], "s")
            yield Measured(f"{said}, budget", BUDGET, "s")


def _rows(at: str, took: dict[str, Any]) -> Iterator[Measured]:
    yield Measured(f"{at}, degrees of freedom", took["dofs"], "")
    yield Measured(f"{at}, unknowns", took["unknowns"], "")
    yield Measured(f"{at}, hydrostatic unknowns", took["hydrostatic"], "")
    yield Measured(f"{at}, forces and tangent", took["assembly"], "s")
    yield Measured(f"{at}, assembly speed", took["dofs"] / took["assembly"], "dof/s")
    yield Measured(f"{at}, factor", took["factor"], "s")
    yield Measured(f"{at}, solve", took["solve"], "s")
    status = took["status"]
    end = ENDS.get(status, f"until {Status[status].value}")
    yield Measured(f"{at}, seconds {end}", took["seconds"], "s")
    yield Measured(f"{at}, iterations {end}", took["iterations"], "")
    yield Measured(f"{at}, equilibria {end}", took["points"], "")
    yield Measured(f"{at}, pressure reached", took["reached"], "kPa")
    yield Measured(f"{at}, peak memory", took["memory"] / 2**20, "MiB")


def _measure(case: Case, layers: int) -> dict[str, Any]:
    section = section_of(1.0, case.design())
    body = discretise(extrude(section, stations(LENGTH, layers, 1.5)))
    winding = wind(body, Wound.CHAMBERS, THREAD) if case.wound else None
    problem, solver = actuator(body, case.law, winding), direct_solver()
    iteration(problem, problem.rest(), np.zeros(3), direct_solver())  # compiles, loads the library
    path = PathSteps().trace(problem, Shapes(body), ALONE, (HIGHEST,), solver)
    if path.last is None:
        raise RuntimeError(path.status.value)
    last = path.last
    rounds = [iteration(problem, last.state, last.load * ALONE, solver) for _ in range(REPEATS)]
    assembly, factor, solve = np.min(rounds, axis=0).tolist()
    return {
        "dofs": 3 * len(body.nodes),
        "unknowns": problem.unknowns,
        "hydrostatic": problem.hydrostatic_unknowns,
        "assembly": assembly,
        "factor": factor,
        "solve": solve,
        "status": path.status.name,
        "reached": path.last.load if np.isnan(path.critical) else path.critical,
        "points": len(path.points),
        "iterations": path.statistics.iterations,
        "seconds": path.statistics.seconds,
        "memory": peak_memory(),
    }


if __name__ == "__main__":
    print(json.dumps(_measure(CASES[sys.argv[1]], int(sys.argv[2]))))
