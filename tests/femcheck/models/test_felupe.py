"""FElupe as a comparator: what it is not asked, and that it finds the same where it is."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from beamopt.scene.named import named_design
from femcheck.check.options import CheckOptions
from femcheck.continuation.ended import Ended
from femcheck.continuation.outcome import Status
from femcheck.material.law import Law
from femcheck.material.rigid_section import RigidSection
from femcheck.models import felupe
from femcheck.models.felupe import FelupeEquilibrium, FelupeModel
from femcheck.models.question import LawChoice, Question
from femcheck.models.solid import SolidModel
from femcheck.prediction.options import PredictionOptions
from femcheck.solid.equilibrium import actuator
from femcheck.solid.winding import Wound
from tests.bench.solid_bodies import bent, body_of, compressible
from tests.femcheck.check.small import SIZES, design_of, three_circles

pytestmark = pytest.mark.usefixtures("coarse")

LEVELS = [0, 10, 20]
BENT = np.array([[0.0, 10.0, 20.0]])
FELUPE = FelupeModel(layers=2, size=9.0)
OURS = SolidModel("hex27", layers=2, size=9.0)
RIGID = CheckOptions(sizes=SIZES)
COMPRESSIBLE = PredictionOptions(poisson_ratio=0.3, sizes=SIZES)


def asked(law: LawChoice, pressures: Any = BENT, **changes: Any) -> Question:
    design = design_of(three_circles(), pressures=LEVELS, **changes)
    return Question.of("small", design, law, pressures)


def test_it_is_a_family_at_a_resolution() -> None:
    assert (FELUPE.family, FELUPE.resolution) == ("felupe", "2 layers, size 9")


@pytest.mark.parametrize(
    ("law", "why"),
    [
        (PredictionOptions(), "mixed"),
        (PredictionOptions(poisson_ratio=0.47), "mixed"),
        (PredictionOptions(law="gent", poisson_ratio=0.3), "not for gent"),
        (PredictionOptions(poisson_ratio=0.3, wound=Wound.CHAMBERS), "without thread"),
    ],
)
def test_laws_that_it_is_not_asked_for_are_refused_in_a_sentence(law: LawChoice, why: str) -> None:
    reason = FELUPE.refuses(asked(law))
    assert reason is not None
    assert reason.startswith("FElupe is asked for ")
    assert why in reason


def test_what_has_no_solid_is_refused_as_ours_refuses_it() -> None:
    loaded = Question.of(*named_design("gravity"), CheckOptions())
    assert "has loads" in str(FELUPE.refuses(loaded))
    assert FELUPE.refuses(loaded) == OURS.refuses(loaded)


def test_without_felupe_it_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    for found in (None, object()):
        monkeypatch.setattr("femcheck.models.felupe.find_spec", lambda name, found=found: found)
        reasons = {FELUPE.refuses(asked(law)) for law in (RIGID, COMPRESSIBLE)}
        assert reasons == {"FElupe is not installed" if found is None else None}


@pytest.mark.parametrize("law", [compressible(), RigidSection(300.0, 2500.0)])
def test_forces_and_tangent_are_ours_at_any_state_and_pressure(law: Law) -> None:
    """Far from equilibrium, with another pressure in each supply: the caps' part shows.

    FElupe has the force of the pressure where we have the derivative of the enclosed volume. The
    rims of the walls, where the two differ, lie in the plate and cancel with the caps.
    """
    pytest.importorskip("felupe")
    body = body_of("hex27", 3000)
    ours, theirs = actuator(body, law), FelupeEquilibrium(body, law)
    state, pressures = bent(body), np.array([400.0, -300.0, 800.0])
    forces, others = (problem.forces(state, pressures) for problem in (ours, theirs))
    scale = np.abs(forces.reduced[:-6]).max()
    assert others.reduced[:-6] == pytest.approx(forces.reduced[:-6], rel=0, abs=1e-11 * scale)
    assert others.reduced[-6:] == pytest.approx(forces.reduced[-6:], rel=1e-9)
    gradients = [problem.volume_gradient(state, pressures) for problem in (ours, theirs)]
    assert gradients[1] == pytest.approx(gradients[0], rel=1e-9, abs=1e-6)
    tangent = ours.tangent(state, pressures, forces).whole()
    difference = abs(theirs.tangent(state, pressures, others).whole() - tangent)
    assert difference.max() < 1e-10 * abs(tangent).max()
    plain = ours.tangent(state, np.zeros(3), ours.forces(state, np.zeros(3))).whole()
    of_pressure = abs(tangent - plain)[:-6, :-6].max()
    assert difference[:-6, :-6].max() < 1e-6 * of_pressure


@pytest.mark.parametrize("law", [RIGID, COMPRESSIBLE], ids=["rigid", "neo"])
def test_tips_are_those_of_our_hexahedra(law: LawChoice, monkeypatch: pytest.MonkeyPatch) -> None:
    """The whole way from a question to tips, on the same mesh, which ours was solved on before.

    Ten seconds and more buy two penalties each, as the chart asks for them.
    """
    pytest.importorskip("felupe")
    assembled = []

    def noted(law: Law) -> Any:
        assembled.append(law)
        return material(law)

    material = felupe._material
    monkeypatch.setattr(felupe, "_material", noted)
    ours = OURS.reply(asked(law))
    assert not assembled
    theirs = FELUPE.reply(asked(law))
    assert {one.name for one in assembled} == {law.law}
    assert theirs.is_whole, str(theirs.ended)
    assert np.linalg.norm(theirs.tips[0] - [0, 0, 100]) > 0.5
    assert theirs.away(ours.tips).max() < 1e-6
    assert (theirs.unknowns, theirs.size) == (ours.unknowns, ours.size)


def test_what_is_not_found_has_a_reason() -> None:
    pytest.importorskip("felupe")
    hurried = replace(COMPRESSIBLE, seconds=1e-9)
    reply = FELUPE.reply(asked(hurried, np.array([[0.0, 0.0, 0.0], [20.0, 0.0, 0.0]])))
    assert reply.found.tolist() == [True, False]
    assert np.isnan(reply.tips[1]).all()
    assert reply.endings[1] == Ended(Status.TIME_OUT, 0.0)
