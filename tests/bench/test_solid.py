"""What the solid's benchmark stands on: its law, its bent state, its sizes."""

import numpy as np

from femcheck.solid.equilibrium import Equilibrium, actuator
from tests.bench.neo_hooke import NeoHooke
from tests.bench.solid_assembly import bent, body_of


def test_neo_hooke_is_the_derivative_of_its_energy() -> None:
    law, h = NeoHooke(), 1e-6
    F = np.eye(3) + 0.2 * np.random.default_rng(3).normal(size=(4, 3, 3))
    C = np.einsum("nki,nkj->nij", F, F)[:, [0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]]
    stress, stiffness = np.empty_like(C), np.empty((len(C), 6, 6))
    for k in range(6):
        step = h * np.eye(6)[k]
        # C12 stands twice in C, and by E = (C − 1)/2 a doubled shear 2 E12 is C12
        factor = 2.0 if k < 3 else 1.0
        stress[:, k] = factor * (law.energy(C + step) - law.energy(C - step)) / (2 * h)
        stiffness[:, :, k] = factor * (law.stress(C + step) - law.stress(C - step)) / (2 * h)
    np.testing.assert_allclose(law.stress(C), stress, atol=1e-5 * abs(stress).max())
    np.testing.assert_allclose(law.stiffness(C), stiffness, atol=1e-5 * abs(stiffness).max())
    assert abs(law.energy(np.array([[1.0, 1, 1, 0, 0, 0]]))) < 1e-12


def test_bodies_have_the_size_asked_for_and_bend_without_inversion() -> None:
    for element in ("wedge18", "hex27"):
        body = body_of(element, 6000)
        assert 3 * len(body.nodes) < 12000
        state = bent(body)
        forces = actuator(body, NeoHooke()).forces(state, np.zeros(3))
        assert forces.least_volume_ratio > 0.8
        # the plate is where the bent axis ends, and upright on it
        np.testing.assert_allclose(state.turn[:, 2], [np.sin(0.6), 0, np.cos(0.6)], atol=1e-12)
