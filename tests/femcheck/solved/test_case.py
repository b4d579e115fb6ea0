"""A solid is discretised as its description says."""

import re
from dataclasses import replace

import pytest

from femcheck.material.fibre import Thread
from femcheck.material.neo_hookean import NeoHookean
from femcheck.solid.elements import ELEMENTS
from femcheck.solid.winding import Wound, wind
from femcheck.solved.case import Solid
from tests.femcheck.lattice import lattice_body

THREAD = Thread(500.0)


def test_a_wound_solid_has_its_thread() -> None:
    body = lattice_body("wedge18")
    mesh = body.extrusion
    plain = Solid("standard", mesh.section, mesh.heights, "wedge18", NeoHookean(300.0, 0.4))
    wound = replace(plain, wound=(Wound.CHAMBERS, THREAD))
    assert plain.problem(body).winding is None
    winding = wound.problem(body).winding
    assert winding is not None
    expected = wind(body, Wound.CHAMBERS, THREAD).areas.sum()
    assert winding.areas.sum() == pytest.approx(expected)
    assert wound.digest != plain.digest


@pytest.mark.parametrize("name", ELEMENTS)
def test_an_element_has_the_functions_of_its_name(name: str) -> None:
    """wedge18 has 18 functions, and the body as many nodes an element."""
    (functions,) = map(int, re.findall(r"\d+", name))
    assert ELEMENTS[name].functions == functions
    assert lattice_body(name).connectivity.shape[1] == functions
