"""Copies of designs and scenes: what was computed of one never passes for another's."""

import copy
import importlib
import pickle
import pkgutil
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import beamopt
import femcheck
from beamopt.base.errors import InputError, NoEquilibriumError
from beamopt.scene.actuator import Actuator, Loading, RodRules
from beamopt.scene.design import Design, Grid, load_design
from beamopt.scene.scene import Pressures, Scene, SectionRules, load_scene
from beamopt.scene.seal_keys import Seal
from beamopt.storage.checked_keys import CheckedKeys
from tests.beamopt.scene.test_design import DRAWN

GRID = Grid(radial=16, angular=48)
DESIGN = load_design(DRAWN).model_copy(update={"grid": GRID, "wall_elements": 2})
SCENE = Scene(grid=GRID, section=SectionRules(feature_points=40, wall_elements=2))

SHARED = {
    "actuator": st.builds(
        Actuator,
        length=st.floats(50, 200),
        youngs_modulus=st.floats(200, 400),
        shear_modulus=st.floats(100, 150),
    ),
    "grid": st.builds(Grid, radial=st.integers(12, 20), angular=st.integers(40, 60)),
    "seal": st.sampled_from([Seal(), Seal(skin=1.0, wall=0.9)]),
    "rod": st.builds(RodRules, rest_curvature=st.tuples(*[st.floats(-0.005, 0.005)] * 3)),
    "loads": st.builds(Loading, tip_force=st.tuples(*[st.floats(-3, 3)] * 3)),
}
LEVELS = st.floats(5, 40).map(lambda step: (0.0, step, 2 * step))
OF_DESIGN = SHARED | {"pressures": LEVELS, "wall_elements": st.sampled_from([0, 2, 4])}
OF_SCENE = SHARED | {
    "pressures": LEVELS.map(lambda levels: Pressures(levels=levels)),
    "section": st.builds(SectionRules, feature_points=st.integers(20, 60)),
}


def some_of(strategies: Mapping[str, st.SearchStrategy[Any]]) -> st.SearchStrategy[dict[str, Any]]:
    return st.fixed_dictionaries({}, optional=dict(strategies))


def cached(model: type[CheckedKeys]) -> list[str]:
    return [name for name, one in vars(model).items() if isinstance(one, cached_property)]


def value(model: CheckedKeys, name: str) -> object:
    try:
        return getattr(model, name)
    except NoEquilibriumError as error:
        return error.args


def same(one: Any, other: Any) -> bool:
    """The same values, whatever object holds them."""
    if isinstance(one, np.ndarray):
        return bool(np.array_equal(one, other, equal_nan=True))
    if isinstance(one, partial):
        return same((one.func, one.args, one.keywords), (other.func, other.args, other.keywords))
    if is_dataclass(one) and not isinstance(one, type):
        names = [field.name for field in fields(one)]
        return all(same(getattr(one, name), getattr(other, name)) for name in names)
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(same(one[key], other[key]) for key in one)
    if isinstance(one, list | tuple):
        return len(one) == len(other) and all(map(same, one, other))
    return bool(one == other)


def built(model: CheckedKeys) -> CheckedKeys:
    """The model built from nothing but its keys' values."""
    return type(model).model_validate(model.model_dump(by_alias=True, exclude_none=True))


def knows_nothing_old(model: CheckedKeys, update: dict[str, Any]) -> None:
    for name in cached(type(model)):
        value(model, name)
    changed = model.model_copy(update=update)
    for name, wanted in update.items():
        assert getattr(changed, name) == wanted
    fresh = built(changed)
    assert changed == fresh
    for name in cached(type(model)):
        assert same(value(changed, name), value(fresh, name)), name


@settings(max_examples=25)
@given(some_of(OF_DESIGN))
def test_a_changed_design_is_the_one_built_anew(update: dict[str, Any]) -> None:
    knows_nothing_old(DESIGN, update)


@settings(max_examples=25)
@given(some_of(OF_SCENE))
def test_a_changed_scene_is_the_one_built_anew(update: dict[str, Any]) -> None:
    knows_nothing_old(SCENE, update)


def test_every_model_that_caches_is_tried_above() -> None:
    for package in (beamopt, femcheck):
        for module in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
            importlib.import_module(module.name)
    waiting, found = [CheckedKeys], set()
    while waiting:
        model = waiting.pop()
        waiting += model.__subclasses__()
        found |= {model.__name__} if cached(model) else set()
    assert found == {"Design", "Scene"}


COPIES: dict[str, Callable[[Any], Any]] = {
    "model_copy": lambda model: model.model_copy(),
    "deep model_copy": lambda model: model.model_copy(deep=True),
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "pickle": lambda model: pickle.loads(pickle.dumps(model)),
}


@pytest.mark.parametrize("how", COPIES)
@pytest.mark.parametrize("model", [DESIGN, SCENE], ids=["design", "scene"])
def test_a_copy_carries_no_computed_value(model: CheckedKeys, how: str) -> None:
    _ = model.climb  # type: ignore[attr-defined]
    copied = COPIES[how](model)
    assert set(vars(copied)) == set(type(model).model_fields)
    assert copied == model
    assert copied.model_fields_set == model.model_fields_set
    assert "climb" in vars(model)


@pytest.mark.parametrize(
    ("update", "key"),
    [
        ({"pressures": (0.0, 5.0, 1.0)}, "pressures"),
        ({"actuator": {"length": -1.0}}, "actuator.length"),
        ({"lenght": 3.0}, "lenght"),
        ({"wall_elements": 3}, "wall_elements"),
        ({"feature_points": {"x": [1.0], "y": [20.0], "type": [0]}}, ""),
    ],
)
def test_a_bad_update_is_refused_by_its_key(update: dict[str, Any], key: str) -> None:
    with pytest.raises(InputError) as caught:
        DESIGN.model_copy(update=update)
    assert (caught.value.where, caught.value.key) == ("Design", key)


def test_a_copy_keeps_the_shape_that_a_chamber_was_given_in() -> None:
    piece = next(one for one in DESIGN.drawing or [] if one.r is not None)
    assert piece.model_copy(update={"supply": 2}).build().supply == 2
    with pytest.raises(InputError):
        piece.model_copy(update={"radius": 2.0})
    assert isinstance(DESIGN.model_copy(update={"drawing": [piece]}), Design)


def test_the_copy_that_pydantic_names_copy_is_no_other() -> None:
    design = DESIGN.model_copy()
    stiff = design.actuator.model_copy(update={"youngs_modulus": 600.0, "shear_modulus": 200.0})
    before = design.workspace.tips
    changed = design.copy(update={"actuator": stiff})
    assert not np.allclose(changed.workspace.tips, before)
    assert same(changed.workspace, design.model_copy(update={"actuator": stiff}).workspace)


def test_what_a_section_is_made_of_can_not_be_changed_in_place() -> None:
    """A list could be, and computed values would stay."""
    scene = load_scene("random-section", ["section.feature_points=5"])
    design = scene.design_of(scene.random_points(np.random.default_rng(1)))
    assert design.feature_points is not None
    for values in (design.feature_points.x, design.feature_points.type, DESIGN.drawing):
        assert isinstance(values, tuple)
