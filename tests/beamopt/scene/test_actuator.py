"""The material of an actuator whose file says only half of it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.base.errors import InputError
from beamopt.rod.law import poissons_ratio
from beamopt.scene.actuator import Actuator, Loading
from beamopt.scene.scene import Scene
from beamopt.storage.checked_keys import parse


def test_without_moduli_it_has_the_paper_s() -> None:
    assert (Actuator().youngs_modulus, Actuator().shear_modulus) == (300.0, 100.0)


@given(st.floats(5, 50_000))
def test_a_modulus_alone_is_of_an_incompressible_material(E: float) -> None:
    alone = Actuator(youngs_modulus=E)
    assert alone.shear_modulus == E / 3
    assert poissons_ratio(E, alone.shear_modulus) == pytest.approx(0.5, rel=1e-12)
    changed = Actuator().model_copy(update={"youngs_modulus": E})
    assert changed.shear_modulus == E / 3


@given(st.floats(5, 50_000), st.floats(1, 50_000))
def test_what_is_given_stays(E: float, G: float) -> None:
    given_both = Actuator(youngs_modulus=E, shear_modulus=G)
    assert given_both.model_copy(update={"length": 50.0}).shear_modulus == G


def test_the_first_thing_that_is_wrong_is_named() -> None:
    with pytest.raises(InputError) as caught:
        parse(Scene, {"actuator": {"youngs_modulus": "soft"}}, "scene.toml")
    assert caught.value.key == "actuator.youngs_modulus"


def test_loads_of_the_room_are_turned_into_the_axes_of_the_base() -> None:
    """A base whose x, y, z point along the room's y, z, x: the room's weight is along its −y."""
    mounted = {"mount_x": (0.0, 1.0, 0.0), "mount_z": (1.0, 0.0, 0.0)}
    loads = Loading(density=1000.0, tip_force=(5.0, 7.0, 11.0), **mounted).loads
    np.testing.assert_allclose(loads.tip.force, [7.0, 11.0, 5.0], atol=1e-12)
    weight = 9.81e3 * 1000.0 / 1e9  # mN/mm³
    np.testing.assert_allclose(loads.weight, [0.0, -weight, 0.0], atol=1e-18)
