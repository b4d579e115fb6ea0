"""What the solid's benchmark stands on: its law, its bent state, its sizes, its comparison."""

import numpy as np
import pytest

from femcheck.solid.equilibrium import actuator
from tests.bench.solid_bodies import bent, body_of, compressible
from tests.bench.solid_felupe import AGREED, felupe_agreement


def test_compressible_law_has_the_lame_constants_asked_for_and_no_pressure_field() -> None:
    law = compressible(100.0, 1000.0)
    assert law.volumetric_compliance is None
    np.testing.assert_allclose([law.shear_modulus, law.volumetric_modulus], [100, 1000], rtol=1e-12)
    stretch = np.array([1.2, 0.9, 1.1])
    C = np.append(stretch**2, np.zeros(3))[None]
    log_J = np.log(stretch.prod())
    energy = 50 * ((stretch**2).sum() - 3 - 2 * log_J) + 500 * log_J**2
    np.testing.assert_allclose(law.energy(C), energy, rtol=1e-12)


def test_bodies_have_the_size_asked_for_and_bend_without_inversion() -> None:
    for element in ("wedge18", "hex27"):
        body = body_of(element, 6000)
        assert 3 * len(body.nodes) < 12000
        state = bent(body)
        forces = actuator(body, compressible()).forces(state, np.zeros(3))
        assert forces.least_volume_ratio > 0.8
        # the plate is where the bent axis ends, and upright on it
        np.testing.assert_allclose(state.turn[:, 2], [np.sin(0.6), 0, np.cos(0.6)], atol=1e-12)


def test_felupe_has_the_same_forces_and_tangents_at_our_equilibrium() -> None:
    pytest.importorskip("felupe")
    rows = list(felupe_agreement(6000))
    differences = {row.what: row.value for row in rows if row.unit == "of largest"}
    assert len(differences) == 6
    assert all(value <= AGREED for value in differences.values()), differences
    assert rows[-1].what == "felupe: agrees to 1e-8"
    assert rows[-1].value == 1
