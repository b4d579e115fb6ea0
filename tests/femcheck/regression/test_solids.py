"""Solids that are held: on a kept mesh, with tolerances from two numbers of layers."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import femcheck.models.solid
import femcheck.regression.solids
import femcheck.solved.case
from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError
from femcheck.continuation.ended import FOUND, Ended
from femcheck.continuation.outcome import Status
from femcheck.material.rigid_section import RigidSection
from femcheck.mesh.gmsh_section import MeshFailure, MeshProblem
from femcheck.models.question import Question
from femcheck.models.reply import Reply
from femcheck.regression.baseline import read_baseline
from femcheck.regression.held import Held
from femcheck.regression.held_design import HeldDesign, design_digest, find_design
from femcheck.regression.kept_mesh import KeptMesher, mesh_digest, read_kept, write_section
from femcheck.regression.measure import MeasuredPart, parts_of
from femcheck.regression.moved import compare
from femcheck.regression.regression import ContradictionError, regress, update_baseline
from femcheck.regression.solids import LAWS, held_limit, held_solid
from femcheck.solid.body import Body
from tests.femcheck.regression.small import CIRCLES, saved

RUNGS = frozenset(
    {"outline", "kept mesh", "beam on kept mesh", "gmsh", "solid at rest", "solid, rigid-section"}
)

LATE = Ended(Status.TIME_OUT, 3.0)


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Some seconds: two meshes, and one solid on two numbers of layers."""
    folder = tmp_path_factory.mktemp("kept")
    update_baseline(sealed(folder), folder / "baselines")
    return folder


def sealed(folder: Path) -> HeldDesign:
    file = saved(folder, "disc", sealed=True)
    return replace(find_design(str(file), folder / "baselines"), rungs=RUNGS)


def lowest(folder: Path) -> str:
    """The lowest rung that moved; "" where none did."""
    here = folder / "baselines"
    found = regress([str(folder / "disc.json")], here, here).lowest
    return "" if found is None else found.held.rung


def held(folder: Path, rung: str, quantity: str) -> Held:
    baseline = read_baseline(folder / "baselines" / "disc.json")
    return next(e.held for e in baseline.held if (e.rung, e.quantity) == (rung, quantity))


def test_a_solid_holds_within_what_its_layers_leave(kept: Path) -> None:
    assert lowest(kept) == ""
    tips, beam = held(kept, "solid, rigid-section", "tips"), held(kept, "beam on kept mesh", "tips")
    assert "from 2 and 3 layers, order 4" in tips.source
    for row, tip in tips.rows.items():
        assert isinstance(tip, tuple)
        moved = math.dist(tip, (0.0, 0.0, 60.0))
        assert 0 < tips.tolerance < 1e-3 * moved
        assert math.dist(tip, beam.rows[row]) <= tips.tolerance  # type: ignore[arg-type]


def test_a_wrong_cap_is_seen_at_rest(kept: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def wrong(body: Body) -> FloatArray:
        return body.extrusion.section.moments.chamber_areas * 1.01

    monkeypatch.setattr(Body, "cap_areas", property(wrong))
    monkeypatch.setattr(femcheck.solved.case, "_WORKSHOPS", {})
    assert lowest(kept) == "solid at rest"


def test_a_softer_law_is_seen_in_the_solid(kept: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        femcheck.models.solid, "RigidSection", lambda E, c: RigidSection(0.999 * E, c)
    )
    assert lowest(kept) == "solid, rigid-section"


def test_a_solid_that_is_not_the_beam_is_not_written(
    kept: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        femcheck.models.solid, "RigidSection", lambda E, c: RigidSection(0.99 * E, c)
    )
    before = (kept / "baselines" / "disc.json").read_bytes()
    with pytest.raises(ContradictionError, match="beam on kept mesh and solid, rigid-section"):
        update_baseline(sealed(kept), kept / "baselines")
    assert (kept / "baselines" / "disc.json").read_bytes() == before


def test_gmsh_is_held_to_the_outline(kept: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        femcheck.regression.solids.Mesher, "mesh", lambda *_: MeshFailure(MeshProblem.HUNG, "1 s")
    )
    monkeypatch.setattr(KeptMesher, "mesh", lambda self, *_: self.section)
    assert lowest(kept) == "gmsh"


def test_a_mesh_that_changed_is_no_result_that_moved(kept: Path, tmp_path: Path) -> None:
    for file in (kept / "disc.json", *(kept / "baselines").glob("disc.*")):
        to = tmp_path / file.relative_to(kept)
        to.parent.mkdir(exist_ok=True)
        to.write_bytes(file.read_bytes())
    mesh = tmp_path / "baselines" / "disc.msh"
    mesh.write_bytes(mesh.read_bytes() + b"\n")
    with pytest.raises(InputError, match=r"mesh: .*disc\.msh is not the mesh"):
        lowest(tmp_path)
    mesh.unlink()
    with pytest.raises(InputError, match=r"disc\.msh: missing"):
        lowest(tmp_path)
    mesh.write_text("nothing")
    with pytest.raises(InputError, match=r"disc\.msh: gmsh wrote no mesh"):
        read_kept(mesh)


def test_a_mesh_is_read_as_it_was_written(kept: Path, tmp_path: Path) -> None:
    first = read_kept(kept / "baselines" / "disc.msh")
    write_section(tmp_path / "again.msh", first, design_digest(sealed(kept).design))
    again = read_kept(tmp_path / "again.msh")
    for name in ("points", "triangles", "edges", "supply"):
        assert np.array_equal(getattr(first, name), getattr(again, name))
    assert mesh_digest(tmp_path / "again.msh") == mesh_digest(kept / "baselines" / "disc.msh")


def test_a_mesh_is_made_anew_where_the_design_changed(tmp_path: Path) -> None:
    """And kept where not even its section did, whatever gmsh would make of it today."""

    def update(**changes: object) -> HeldDesign:
        file = saved(tmp_path, "disc", sealed=True, **changes)
        held = replace(find_design(str(file), tmp_path), rungs=frozenset({"kept mesh"}))
        update_baseline(held, tmp_path / "baselines")
        regress([str(file)], tmp_path / "baselines", tmp_path)
        return held

    first = update()
    areas = read_kept(first.mesh).moments.chamber_areas
    kept, seen = mesh_digest(first.mesh), first.mesh.stat().st_mtime_ns
    update(notes={"seen": "today"})
    assert first.mesh.stat().st_mtime_ns == seen
    larger = [CIRCLES[0] | {"radius": 4.0}, *CIRCLES[1:]]
    changed = update(drawing=larger)
    assert mesh_digest(changed.mesh) != kept
    assert read_kept(changed.mesh).moments.chamber_areas[0] > 1.5 * areas[0]


def test_every_run_has_a_mesh_of_its_own(tmp_path: Path) -> None:
    for name in ("x", "y"):
        (tmp_path / name).mkdir()
        saved(tmp_path / name, "best", sealed=True)
    found = {find_design(str(tmp_path / name), tmp_path).mesh.name for name in ("x", "y")}
    assert found == {"x.msh", "y.msh"}


@pytest.mark.parametrize(("law", "order"), [(0, 4), (1, 2), (2, 2), (3, 2)])
def test_tolerances_are_of_the_order_of_the_law(
    kept: Path, law: int, order: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The clamp of a material's solid is felt: its tips converge no faster than with order 2."""

    class MadeUp:
        def __init__(self, layers: int) -> None:
            self.layers = layers

        def reply(self, question: Question) -> Reply:
            count = len(question.pressures)
            return Reply(np.full((count, 3), [0.0, 0.0, self.layers]), count * (FOUND,))

    monkeypatch.setattr(femcheck.regression.solids, "SolidModel", MadeUp)
    tips = next(iter(held_solid(sealed(kept), LAWS[law], estimate=True)))
    assert tips.tolerance == pytest.approx(3 / (1.5**order - 1))
    assert f"order {order};" in tips.source


def test_a_limit_that_came_too_late_has_no_number(
    kept: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Late:
        def __init__(self, layers: int) -> None:
            pass

        def reply(self, question: Question) -> Reply:
            return Reply(np.full((1, 3), np.nan), (LATE,))

    monkeypatch.setattr(femcheck.regression.solids, "SolidModel", Late)
    endings, limits = held_limit(sealed(kept), estimate=False)
    assert set(endings.rows.values()) == set(limits.rows.values()) == {LATE}


def test_a_pressure_that_is_reached_is_an_ending_without_numbers(
    kept: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Tips of another library, or of the last digit, must not move what has no tolerance."""

    class Reached:
        tip = 1 / 3

        def __init__(self, layers: int) -> None:
            pass

        def reply(self, question: Question) -> Reply:
            Reached.tip += 1e-16
            return Reply(np.full((1, 3), Reached.tip), (FOUND,))

    monkeypatch.setattr(femcheck.regression.solids, "SolidModel", Reached)
    before = [one.written() for one in held_limit(sealed(kept), estimate=True)]
    assert set(before[0].rows.values()) == {FOUND}
    now = MeasuredPart(tuple(held_limit(sealed(kept), estimate=False)))
    assert compare("disc", before, now) == []


def test_which_parts_a_design_has(kept: Path) -> None:
    assert parts_of(sealed(kept)) == ["sections", "meshes", "solid, rigid-section"]
    open_one = find_design("hand_drawn_section", kept)
    assert parts_of(open_one) == ["sections", "rods"]
    loaded = saved(kept, "loaded", sealed=True, loads={"density": 1000.0})
    assert parts_of(find_design(str(loaded), kept)) == ["sections", "rods"]


def test_a_design_is_not_written_over(kept: Path) -> None:
    before = (kept / "disc.json").read_bytes()
    with pytest.raises(InputError, match="is the design itself"):
        update_baseline(replace(sealed(kept), rungs=frozenset({"beam"})), kept)
    assert (kept / "disc.json").read_bytes() == before
