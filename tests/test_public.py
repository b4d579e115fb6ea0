"""The public face: names that completion shows, short representations, a design from its parts."""

import importlib
import inspect
import subprocess
import sys
import typing
from dataclasses import replace
from enum import Enum
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from pydantic import BaseModel

import beamopt
import femcheck
from beamopt.judge.judge import Judge
from beamopt.search.algorithm import Individual
from beamopt.storage.checked_keys import CheckedKeys
from femcheck.accuracy.ending import Tried
from femcheck.check.comparison import SolidTips
from femcheck.continuation.ended import Ended
from femcheck.models.beam import RodOnOutline
from femcheck.models.reply import Reply
from tests.femcheck.check.small import small_subject

FACES = (beamopt, femcheck)
NAMES = [(face, name) for face in FACES for name in face.__all__]
POINTS = {"x": (12.0, 0.0, -15.0, -18.0), "y": (0.0, 16.0, 0.0, 2.0), "type": (1, 2, 3, 0)}


@pytest.mark.parametrize("face", FACES)
def test_completion_lists_the_public_names(face: ModuleType) -> None:
    assert dir(face) == sorted([*face.__all__, "__version__"])
    assert face.__version__ == beamopt.__version__ != ""


@pytest.mark.parametrize("face", FACES)
def test_the_stub_names_what_is_public(face: ModuleType) -> None:
    """A name of the stub is in `__all__` of its own module."""
    stub = Path(str(face.__file__)).with_suffix(".pyi").read_text()
    listed = [line.split() for line in stub.splitlines() if line.startswith("from ")]
    assert sorted(words[-1] for words in listed) == face.__all__
    for _, home, _, name, *alias in listed:
        module = importlib.import_module(home, face.__name__)
        assert name in module.__all__
        assert alias == ["as", name]


def test_starting_takes_no_numerics() -> None:
    code = "import sys, beamopt, femcheck; dir(beamopt); print('numpy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def models_in(annotation: object) -> set[type[BaseModel]]:
    """Tables of keys in the annotation of a key."""
    if inspect.isclass(annotation) and issubclass(annotation, BaseModel):
        fields = annotation.model_fields.values()
        return {annotation}.union(*(models_in(field.annotation) for field in fields))
    return set().union(*(models_in(part) for part in typing.get_args(annotation)))


@pytest.mark.parametrize("model", [beamopt.Design, beamopt.Scene])
def test_every_table_of_a_file_is_public(model: type[BaseModel]) -> None:
    public = {getattr(beamopt, name) for name in beamopt.__all__}
    assert models_in(model) - public == set()


@pytest.mark.parametrize("face", FACES)
def test_what_a_public_class_is_made_of_is_public(face: ModuleType) -> None:
    """Of classes that people make: settings, and what they hold."""
    public = {getattr(one, name) for one, name in NAMES}
    for name in ("CheckOptions", "PredictionOptions", "Plan", "Question", "Subject", "Judge"):
        made = getattr(face, name, None)
        for hint in typing.get_type_hints(made).values() if made is not None else ():
            for part in (hint, *typing.get_args(hint)):
                if inspect.isclass(part) and part.__module__.startswith(("beamopt", "femcheck")):
                    assert part in public or name == "Judge"


def drawn() -> beamopt.Design:
    """A design of public names alone."""
    return beamopt.Design(
        schema="beamopt-design/1",
        grid=beamopt.Grid(),
        feature_points=beamopt.Points(**POINTS),
        wall_elements=0,
        seal=beamopt.Seal(skin=1.0, wall=1.0),
        actuator=beamopt.Actuator(length=120.0),
        pressures=(0.0, 10.0, 20.0),
        rod=beamopt.RodRules(),
        loads=beamopt.Loading(density=1070.0),
    )


def test_a_judge_takes_the_points_of_a_design() -> None:
    scene = beamopt.load_scene("random-section")
    judge = Judge.of_scene(scene, scene.load_target())
    points = scene.random_points(np.random.default_rng(0))
    design = scene.design_of(points)
    assert judge([design.points]) == judge([points])
    assert design.points.digest == points.digest
    target = beamopt.load_scene("hand-drawn-section").target
    with pytest.raises(beamopt.InputError) as refused:
        beamopt.load_design(str(target.file)).points  # noqa: B018
    assert refused.value.key == "drawing"


def test_completion_of_a_design_shows_no_deprecated_names() -> None:
    design = drawn()
    shown = {name for name in dir(design) if not name.startswith("_")}
    own = {"tips", "workspace", "section", "save", "json", "grid", "points", "model_copy"}
    assert own <= shown
    assert set(type(design).model_fields) <= shown
    pydantic = {name for name in dir(BaseModel) if not name.startswith("_")}
    assert shown & pydantic == {"json", "model_copy"}
    assert not set(dir(design.grid)) & (pydantic - {"model_copy"})
    assert all(hasattr(design, name) for name in shown - {"workspace"})


def test_settings_show_what_differs_from_the_default() -> None:
    assert repr(beamopt.Loading(density=1.5)) == "Loading(density=1.5)"
    assert repr(beamopt.Actuator(youngs_modulus=60.0)) == "Actuator(youngs_modulus=60.0)"
    assert repr(femcheck.CheckOptions(layers=3)) == "CheckOptions(layers=3)"
    sizes = femcheck.SectionSizes(factor=2.0)
    assert repr(femcheck.PredictionOptions(sizes=sizes)).startswith("PredictionOptions(sizes=Sec")


def instances() -> dict[str, object]:
    """One of each public class that can be large, as large as it gets."""
    scene = beamopt.load_scene("hand-drawn-section", ["search.generations=1"])
    target = scene.load_target()
    found = beamopt.optimize(scene)
    small = ["search.generations=0", "refine.flips=100", "refine.rounds=1", "refine.steps=1"]
    quick = beamopt.load_scene("random-section", small)
    last = found.last
    verdict = beamopt.Verdict(1 / 3, 2 / 3)
    run = beamopt.Plan().runs()[0]
    nan = np.full((27, 3), np.nan)
    status = (femcheck.Status.CONVERGED,) * 27
    tips = SolidTips(
        "standard", np.inf, nan, nan, status, np.zeros(27), np.zeros(27, dtype=np.int64)
    )
    subject = small_subject()
    compared = femcheck.Comparison(subject, (tips, replace(tips, mesh="coarse")), 2.0, 1.0)
    failure = femcheck.MeshFailure(femcheck.MeshProblem.CRASHED, "said " * 1000)
    none = None, None, None, (), {}
    options = femcheck.PredictionOptions(constants={"C2_share": 1 / 3}, law="mooney-rivlin")
    question = femcheck.Question.of("x" * 1000, subject.design, options)
    ended = Ended(femcheck.Status.LIMIT_POINT, 1 / 3)
    reply = Reply(nan, (ended,) * 27)
    rod = Tried(RodOnOutline(), reply, 1 / 3)
    made = [
        *(getattr(scene, name) for name in type(scene).model_fields),
        scene, target, found, last, last.best, found.history,
        found.history[-1], verdict, found.best, found.best.section, run,
        found.best.points, found.best.feature_points, found.best.moments, found.best.workspace,
        found.best.response, beamopt.PolarGrid(), beamopt.SealRules(), beamopt.Plan(),
        beamopt.Fault(beamopt.FaultKind.CUT, 1 / 3, (1 / 3, 1 / 3), (1, 2, 3), 1 / 3, 1),
        beamopt.GeneticAlgorithm(scene), Judge.of_scene(scene, target),
        beamopt.certificate(scene, target),
        beamopt.load_design(str(scene.target.file)).drawing[0],  # type: ignore[index]
        beamopt.SegmentChoice(share=1.0, section=found.best.model_dump(by_alias=True)),
        beamopt.find_front(scene, ["L", "mass"], population=8),
        beamopt.refine_design(beamopt.optimize(quick).best, quick),
        beamopt.Outcome(run, verdict, 1 / 3, 1000, (1 / 3,) * 1000, 1 / 3),
        beamopt.StudyOutcomes([beamopt.Outcome(run, verdict, 1 / 3, 1000, (1 / 3,), 1 / 3)] * 48),
        subject, compared, failure, options, question, reply,
        femcheck.CheckOptions(), femcheck.Mesher("x" * 1000), femcheck.SectionSizes(),
        femcheck.Checked(subject, femcheck.CheckOptions(), failure, *none),
        femcheck.Checked(subject, femcheck.CheckOptions(), None, compared, *none[1:]),
        femcheck.Prediction(subject, options, options.law_for(subject.design.actuator), failure,
                            None, {}, (), (None,) * 27, {}),
        femcheck.RigidSection(1 / 3, 1 / 3, 1 / 3), femcheck.Thread(1 / 3, 1 / 3),
        femcheck.Within(question, 1 / 3, femcheck.Ending.REACHED, reply, nan[:, 0], (rod,), ""),
        femcheck.Chart.of(question, [], None),
    ]  # fmt: skip
    return {type(one).__name__: one for one in made}


def test_representations_are_one_short_line() -> None:
    made = instances()
    for face, name in NAMES:
        public = getattr(face, name)
        if not inspect.isclass(public) or issubclass(public, (Enum, Exception)):
            continue
        if getattr(public, "_is_protocol", False):
            continue
        one = made[name if name != "Subject" else "Coarse"]
        has_text = type(one).__str__ is not object.__str__ and not isinstance(one, BaseModel)
        for text in (repr(one), *(() if has_text else (str(one),))):
            assert len(text) < 300, text[:500]
            assert "\n" not in text
            assert " object at 0x" not in text, text


def test_a_representation_says_the_loss() -> None:
    verdict = beamopt.Verdict(1 / 3, 2 / 3)
    points = beamopt.Points(**POINTS).build()
    assert "L = 0.3333 mm²" in repr(Individual(points, verdict))


def test_an_own_method_of_a_hidden_name_is_shown() -> None:
    class WithText(CheckedKeys):
        def json(self) -> str:  # type: ignore[override]
            """Return text."""
            return ""

    assert "json" in dir(WithText())
    assert "dict" not in dir(WithText())
