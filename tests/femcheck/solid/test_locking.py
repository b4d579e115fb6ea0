"""Three drawn chambers, one pressurised: the default element bends as the beam, tet4 locks."""

import numpy as np
import pytest

from beamopt.rod.arc import arc_tips
from beamopt.rod.response import linear_response
from femcheck.continuation.direct import direct_solver
from femcheck.continuation.newton import Newton
from femcheck.material.rigid_section import RigidSection
from femcheck.mesh.extrusion import extrude, stations
from femcheck.mesh.geo import SectionSizes
from femcheck.mesh.gmsh_section import Mesher
from femcheck.mesh.section_mesh import SectionMesh
from femcheck.solid.body import discretise
from femcheck.solid.equilibrium import actuator
from femcheck.solid.state import rest_state
from tests.femcheck.sections import three_chambers

E, LENGTH, KPA = 300.0, 100.0, np.array([10.0, 0.0, 0.0])


@pytest.fixture(scope="module")
def section() -> SectionMesh:
    mesh = Mesher().mesh(three_chambers(0.5), SectionSizes(factor=3.0))
    assert isinstance(mesh, SectionMesh)
    return mesh


def bending(section: SectionMesh, element: str) -> tuple[float, float]:
    """Sideways way of the tip over the beam's, and distance of the tips over the beam's way."""
    body = discretise(extrude(section, stations(LENGTH, 4, 1.5)), element)
    problem = actuator(body, RigidSection(E, 10000.0))
    outcome = Newton().solve(problem, rest_state(body), KPA, direct_solver())
    assert outcome.state is not None
    found = outcome.state.tip - np.append(section.moments.centroid, 0.0)
    beam = arc_tips(linear_response(section.moments, E).strains(KPA[None]), LENGTH)[0]
    assert np.hypot(*beam[:2]) > 3
    way = np.linalg.norm(beam - [0, 0, LENGTH])
    return float(np.hypot(*found[:2]) / np.hypot(*beam[:2])), float(
        np.linalg.norm(found - beam) / way
    )


def test_the_default_element_bends_as_the_beam(section: SectionMesh) -> None:
    share, off = bending(section, "wedge18")
    assert share == pytest.approx(1, abs=0.01)
    assert off < 0.01


def test_the_linear_tetrahedron_locks(section: SectionMesh) -> None:
    """What a check that can fail must refuse: nine tenths of the bending and more are lost."""
    share, off = bending(section, "tet4")
    assert share < 0.1
    assert off > 0.9
