"""Strains along the axis, as of the rod that the planes of nodes make."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray
from femcheck.continuation.shape import Shapes
from femcheck.material.rigid_section import RigidSection
from femcheck.mesh.extrusion import stations
from femcheck.mesh.gmsh_section import MeshFailure
from femcheck.prediction.ray_trace import RayTask, trace_ray
from femcheck.prediction.rays import Ray
from femcheck.solid.body import Body
from femcheck.solid.plate import cross_matrix, rotation
from femcheck.solid.state import State, placed, rest_state
from femcheck.solved.case import Solid
from femcheck.solved.meshes import section_meshes
from tests.femcheck.check.small import Coarse, design_of, three_circles
from tests.femcheck.lattice import LENGTH, lattice_body
from tests.femcheck.prediction.small import options_of


def helix(body: Body, strain: float, curvature: FloatArray) -> State:
    """Every plane rigid, on the curve R' = R [κ]×, h' = (1 + ε) R e3 through the reference axis."""
    centre = np.append(body.tip_centre[:2], 0)

    def at(z: float) -> tuple[FloatArray, FloatArray]:
        # h = ∫ R e3 by the series of exp: [[K, e3], [0, 0]] z, exponentiated
        turn, ahead = curvature * z, np.array([0.0, 0.0, (1 + strain) * z])
        K, term, h = cross_matrix(turn), ahead, ahead.copy()
        for n in range(2, 40):
            term = K @ term / n
            h = h + term
        return rotation(turn), centre + h

    x = np.empty_like(body.nodes)
    for z in np.unique(body.nodes[:, 2]):
        R, h = at(float(z))
        on = body.nodes[:, 2] == z
        x[on] = h + (body.nodes[on] * [1, 1, 0] - centre) @ R.T
    R, h = at(LENGTH)
    return placed(body, x, h, R)


BODY = lattice_body("wedge18", layers=3, distortion=0.0)


@given(
    strain=st.floats(-0.3, 1.0),
    curvature=st.tuples(*[st.floats(-0.2, 0.2)] * 3),
)
def test_exact_on_a_prescribed_helix(strain: float, curvature: tuple[float, ...]) -> None:
    """Chords between planes are shorter than the arc: they are unrolled, not divided by lengths.

    Twist is among what is prescribed and not among what is read. Planes are told apart by heights
    rounded to 1e-6 mm, of steps of 2 mm: 1e-6.
    """
    kappa = np.array(curvature)
    found = Shapes(BODY).axis(helix(BODY, strain, kappa))
    np.testing.assert_allclose(found[:, 1], strain, atol=1e-6)
    np.testing.assert_allclose(found[:, 2:], np.tile(kappa[:2], (len(found), 1)), atol=1e-6)


def test_places_are_halfway_between_the_planes_of_nodes() -> None:
    """Planes of corners and of mid-nodes both; at rest nothing is strained."""
    found = Shapes(BODY).axis(rest_state(BODY))
    planes = np.unique(np.round(BODY.nodes[:, 2], 6))
    assert len(planes) == 7
    np.testing.assert_allclose(found[:, 0], (planes[1:] + planes[:-1]) / 2)
    np.testing.assert_allclose(found[:, 1:], 0, atol=1e-12)


@pytest.fixture(scope="module")
def rigid() -> tuple[FloatArray, FloatArray]:
    """The axis of a solid that has the beam's assumptions, and the beam's strains."""
    subject = Coarse("small", design_of(three_circles()))
    sections = section_meshes(subject, options_of())
    assert not isinstance(sections, MeshFailure)
    heights = stations(subject.design.actuator.length, 4, 1.0)
    solid = Solid("rigid", sections[0], heights, "wedge18", RigidSection(300.0, 1e4))
    ray = Ray((1.0, 0.25, 0.0), (40.0,))
    last = trace_ray(RayTask(solid, ray)).last
    assert last is not None
    assert last.load == 40
    return last.axis, subject.response.strains(40 * np.array([ray.direction]))[0]


def test_a_solid_with_the_beam_s_assumptions_has_the_beam_s_strains(
    rigid: tuple[FloatArray, FloatArray],
) -> None:
    """To 1 % away from the ends; clamp and cap agree with rigid sections, the mesh with neither."""
    axis, beam = rigid
    inner = axis[2:-2]
    assert len(inner) == 4
    np.testing.assert_allclose(inner[:, 1], beam[0], rtol=0.01)
    size = np.hypot(*beam[1:])
    np.testing.assert_allclose(inner[:, 2:], np.tile(beam[1:], (4, 1)), atol=0.01 * size)
