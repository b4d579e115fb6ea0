"""Scenes with loads, segments and rest shapes: the rung they need, and what is judged on it."""

import json
import math
import pickle
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from beamopt.base.errors import InputError, NoEquilibriumError
from beamopt.cli.application import run
from beamopt.judge.judge import Judge, JudgeStatus
from beamopt.outline.saint_venant import outline_saint_venant
from beamopt.rod.ladder import Rung
from beamopt.rod.status import RodStatus
from beamopt.scene.actuator import Loading, RodRules
from beamopt.scene.design import Design, load_design, section_values
from beamopt.scene.scene import Scene, load_scene
from beamopt.scene.toml_text import scene_text
from beamopt.search.optimize import optimize
from beamopt.search.run_summary import summary
from beamopt.section.saint_venant import section_saint_venant
from beamopt.target.workspace import loss
from tests.validation.resume import content

QUICK = ["search.generations=2", "search.population=6", "target.seed=3"]
RUNGS = {
    "gravity": Rung.LOADED,
    "hand-drawn-section": Rung.ARC,
    "hand-drawn-workspace": Rung.ARC,
    "pairs": Rung.ARC,
    "pre-curved": Rung.LOADED,
    "random-section": Rung.ARC,
    "sealed-section": Rung.ARC,
    "spiral": Rung.ARC,
    "tool-at-the-tip": Rung.LOADED,
    "two-segments": Rung.CHAIN,
    "upright-column": Rung.LOADED,
}
SCENES = Path(__file__).parents[3] / "beamopt/scenes"


def design_with(loads: dict[str, object], rod: dict[str, object] | None = None) -> Design:
    plain = load_design(SCENES / "hand_drawn_section.json")
    changed = plain.model_dump(by_alias=True, exclude_none=True) | {"loads": loads}
    return Design.model_validate(changed | ({"rod": rod} if rod else {}))


def test_a_sealed_design_twists_as_its_outline() -> None:
    """A design whose raster has 4 % less I_T and its shear centre 2.3 mm elsewhere."""
    plain = load_design(Path(__file__).parents[2] / "data/sealed_designs/search_1.json")
    data = plain.model_dump(by_alias=True, exclude_none=True)
    rod = {"twist": "saint-venant", "rung": "loaded"}
    design = Design.model_validate(data | {"loads": {"line_force": [2.0, 0.0, 0.0]}, "rod": rod})
    nu = design.loaded_rod.poissons_ratio
    found, expected = design.values.saint_venant, outline_saint_venant(design.outline, nu)
    raster = section_saint_venant(design.section.grid, design.section.labels, nu)
    segment = section_values(data, nu).saint_venant
    for one in (found, segment):
        assert one is not None
        assert one.torsion_constant == expected.torsion_constant
        np.testing.assert_array_equal(one.shear_centre, expected.shear_centre)
        np.testing.assert_array_equal(one.shear_area, expected.shear_area)
    assert raster.torsion_constant < 0.97 * expected.torsion_constant
    assert np.hypot(*(raster.shear_centre - expected.shear_centre)) > 1.5
    of_raster = replace(design.values, saint_venant=raster)
    tips = design.climb.model.tips(of_raster, np.array([[100.0, 0.0, 0.0]])).positions
    away = design.tips(np.array([[100.0, 0.0, 0.0]])) - tips
    assert np.linalg.norm(away) > 0.02  # mm; what the tips are of is seen


@pytest.mark.parametrize(("name", "rung"), RUNGS.items())
def test_a_scene_climbs_to_the_rung_it_needs(name: str, rung: Rung) -> None:
    climb = load_scene(name).climb
    assert climb.model.rung is rung
    assert ("exact" in climb.reason) == (rung is not Rung.LOADED)


def test_a_scene_without_loads_is_bit_for_bit_the_arc() -> None:
    """Whatever the keys of loads say that comes to nothing."""
    plain = load_scene("random-section", QUICK)
    nothing = ["loads.mount_z=[1.0,0.0,0.0]", "loads.mount_x=[0.0,1.0,0.0]", "loads.gravity=3.7"]
    same = load_scene("random-section", [*QUICK, *nothing, "loads.tool_at=[0.0,0.0,9.0]"])
    target = plain.load_target()
    np.testing.assert_array_equal(target.workspace.tips, same.load_target().workspace.tips)
    points = [plain.random_points(np.random.default_rng([k])) for k in range(6)]
    assert Judge.of_scene(plain, target)(points) == Judge.of_scene(same, target)(points)
    design = plain.design_of(points[0])
    assert "loads" not in design.json()
    assert "rod" not in design.json()


def test_a_small_load_needs_no_climb() -> None:
    """A light actuator's weight moves no tip by 0.1 mm, but by more than a tighter tolerance."""
    light = load_scene("tool-at-the-tip", ["loads.density=5.0", "loads.tool_mass=0.1"])
    assert light.climb.model.rung is Rung.ARC
    assert "at most" in light.climb.reason
    strict = load_scene(
        "tool-at-the-tip", ["loads.density=5.0", "loads.tool_mass=0.1", "rod.tolerance=1e-6"]
    )
    assert strict.climb.model.rung is Rung.LOADED


@pytest.mark.parametrize("rung", ["arc", "chain", "loaded"])
def test_any_rung_can_be_forced(rung: str) -> None:
    scene = load_scene("gravity", [f'rod.rung="{rung}"', 'rod.twist="stiff"'])
    assert scene.climb.model.rung.value == rung
    assert scene.climb.reason.startswith("asked for")
    assert ("loaded would be exact" in scene.climb.reason) == (rung != "loaded")
    tips = scene.load_target().workspace.tips
    assert tips[0, 0] == pytest.approx(0, abs=1e-9) or rung == "loaded"


@pytest.mark.parametrize("name", ["gravity", "two-segments", "pre-curved"])
@pytest.mark.parametrize("rung", ["arc", "chain", "loaded"])
@pytest.mark.parametrize("twist", ["auto", "stiff", "saint-venant"])
def test_every_rung_and_twist_can_be_forced(name: str, rung: str, twist: str) -> None:
    scene = load_scene(name, [f'rod.rung="{rung}"', f'rod.twist="{twist}"'])
    assert np.isfinite(scene.load_target().workspace.tips).all()
    assert scene.climb.model.twists == (
        rung == "loaded" and twist != "stiff" and scene.loads.loads.any
    )


def test_a_follower_force_does_not_hold_a_column_up() -> None:
    """Loads without a potential are judged by eigenvalues: next to nothing changes no status."""
    heavy = {"density": 12_000.0}
    plain = load_design(SCENES / "stiff_column.json")
    data = plain.model_dump(by_alias=True, exclude_none=True)
    for loads in (heavy, heavy | {"follower_force": [0.0, 0.0, 1e-3]}):
        design = Design.model_validate(data | {"loads": loads})
        solved = design.solve(np.zeros((1, 3)))
        assert solved.status == (RodStatus.BUCKLED,)


def test_a_segment_file_is_found_beside_the_design(tmp_path: Path) -> None:
    """And refused where nobody read it."""
    (tmp_path / "other.json").write_bytes((SCENES / "round_chambers.json").read_bytes())
    segments = [{"share": 0.5}, {"share": 0.5, "file": "other.json"}]
    with pytest.raises(InputError, match="read by load_scene and load_design"):
        _ = design_with({}, {"segments": segments}).workspace
    data = design_with({}).model_dump(by_alias=True, exclude_none=True)
    (tmp_path / "a.json").write_text(json.dumps(data | {"rod": {"segments": segments}}))
    design = load_design(tmp_path / "a.json")
    assert design.climb.model.rung is Rung.CHAIN
    assert load_design(design.save(tmp_path / "b.json")).rod == design.rod
    (tmp_path / "other.json").unlink()
    with pytest.raises(InputError, match=r"other\.json"):
        load_design(tmp_path / "a.json")


def test_a_search_says_what_its_rung_leaves_out() -> None:
    light = ["loads.density=5.0", "loads.tool_mass=0.1"]
    result = optimize(load_scene("tool-at-the-tip", [*light, *QUICK[:2]]))
    assert result.neglected is not None
    assert 0 < result.neglected < 0.1
    assert summary(result)["rod"]["neglected_loads_move_mm"] == result.neglected
    assert "rod" not in summary(optimize(load_scene("hand-drawn-section", QUICK[:2])))


def test_no_equilibrium_survives_a_process() -> None:
    error = NoEquilibriumError((0.0, 50.0, 0.0), RodStatus.BUCKLED)
    assert str(pickle.loads(pickle.dumps(error))) == str(error)


def test_all_rungs_agree_where_the_arc_is_exact() -> None:
    design = design_with({})
    tips = {
        rung: design.climb.model.on(rung).tips(design.values, design.workspace.pressures).positions
        for rung in Rung
    }
    np.testing.assert_allclose(tips[Rung.CHAIN], tips[Rung.ARC], rtol=0, atol=1e-11)
    np.testing.assert_allclose(tips[Rung.LOADED], tips[Rung.ARC], rtol=0, atol=1e-9)


def test_equal_segments_are_one_actuator() -> None:
    one, pieces = design_with({}), [{"share": 0.3}, {"share": 0.7}]
    two = design_with({}, {"rung": "chain", "segments": pieces})
    np.testing.assert_allclose(two.workspace.tips, one.workspace.tips, rtol=0, atol=1e-11)


def test_a_turned_segment_bends_another_way() -> None:
    """All turned by a quarter: the workspace turns with them, about the first centroid."""
    turned = design_with({}, {"segments": [{"share": 0.5, "turned": 90.0}] * 2})
    x, y, z = design_with({}).workspace.tips.T
    np.testing.assert_allclose(turned.workspace.tips, np.stack([-y, x, z], 1), rtol=0, atol=1e-11)


def test_tips_of_segments_are_material_centroids() -> None:
    """Without pressure the tip of the second section lies beside the axis of the first."""
    scene = load_scene("two-segments")
    design = scene.design_of(scene.random_points(np.random.default_rng([1])))
    other = load_design(SCENES / "round_chambers.json").moments.centroid
    offset = design.workspace.tips[0] - [*(other - design.moments.centroid), 100.0]
    np.testing.assert_allclose(offset, 0, atol=1e-9)


def test_weight_pulls_down_wherever_the_base_is_mounted() -> None:
    """Mounted along the room's x, section x down: the tip sags along section x; and so on."""
    sideways = {"mount_z": [1.0, 0.0, 0.0], "density": 1070.0}
    for mount_x, axis, sign in (
        ([0.0, 0.0, -1.0], 0, 1),
        ([0.0, 0.0, 1.0], 0, -1),
        ([0.0, 1.0, 0.0], 1, -1),
        ([0.0, -1.0, 0.0], 1, 1),
    ):
        tip = design_with(sideways | {"mount_x": mount_x}).workspace.tips[0]
        assert sign * tip[axis] > 2
        assert abs(tip[1 - axis]) < 0.25 * abs(tip[axis])


def test_weight_of_a_hanging_actuator_stretches_it_by_the_rule() -> None:
    """ρ g H²/(2 E): half of its weight, evenly, on E A."""
    tip = design_with({"mount_z": [0.0, 0.0, -1.0], "density": 1070.0}).workspace.tips[0]
    assert tip[2] - 100 == pytest.approx(1070e-9 * 9.81e3 * 100**2 / (2 * 300), rel=1e-3)


def test_a_tool_hangs_where_its_mass_is() -> None:
    """A mass on an arm is a force and its moment."""
    arm, grams = 25.0, 60.0
    force = -grams * 1e-3 * 9.81e3
    mount = {"mount_z": [1.0, 0.0, 0.0], "mount_x": [0.0, 1.0, 0.0]}
    tool = design_with(mount | {"tool_mass": grams, "tool_at": [0.0, 0.0, arm]})
    dead = design_with(mount | {"tip_force": [0.0, 0.0, force], "tool_at": [0.0, 0.0, arm]})
    np.testing.assert_array_equal(tool.workspace.tips, dead.workspace.tips)
    without = design_with(mount | {"tip_force": [0.0, 0.0, force]})
    assert np.linalg.norm(tool.workspace.tips[0] - without.workspace.tips[0]) > 1


@pytest.mark.parametrize("name", ["gravity", "two-segments"])
def test_a_design_gives_the_tips_that_were_judged(name: str, tmp_path: Path) -> None:
    result = optimize(load_scene(name, QUICK[:2]))
    kept = load_design(result.best.save(tmp_path / "best.json"))
    assert kept.climb.model.rung is RUNGS[name]
    np.testing.assert_array_equal(kept.workspace.tips, result.best.workspace.tips)
    assert float(loss(kept.workspace.tips, result.target.workspace.tips)) == result.verdict.L
    np.testing.assert_array_equal(kept.tips(kept.workspace.pressures), kept.workspace.tips)


def test_a_loaded_search_is_the_same_for_any_workers_and_after_a_stop(tmp_path: Path) -> None:
    scene = load_scene("gravity", QUICK[:2])
    optimize(scene, tmp_path / "whole", figures=False)
    with ThreadPoolExecutor(3) as executor:
        optimize(scene, tmp_path / "parts", figures=False, executor=executor, workers=3)
    short = load_scene("gravity", ["search.generations=1", QUICK[1]])
    optimize(short, tmp_path / "stopped", figures=False)
    again = load_scene(tmp_path / "stopped" / "scene.toml", ["search.generations=2"])
    optimize(again, tmp_path / "stopped", resume=True, figures=False)
    assert content(tmp_path / "whole") == content(tmp_path / "parts")
    assert content(tmp_path / "whole") == content(tmp_path / "stopped")


def test_a_section_that_can_not_carry_itself_is_no_candidate() -> None:
    """Forty times the density buckles every section of the upright column."""
    scene = load_scene("random-section", ["loads.density=30000.0", "actuator.length=330.0"])
    with pytest.raises(InputError, match="the target's section has no tip at 0, 0, 0 kPa: buckled"):
        scene.load_target()
    target = load_scene("upright-column").load_target()
    verdict = Judge.of_scene(scene, target)([scene.random_points(np.random.default_rng([1]))])[0]
    assert verdict.status is JudgeStatus.NO_EQUILIBRIUM
    assert math.isinf(verdict.L)


def test_a_load_too_large_has_a_status_and_no_tip(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    design = design_with({"density": 30_000.0, "gravity": 400.0})
    solved = design.solve(np.array([[0.0, 0.0, 0.0]]))
    assert solved.status == (solved.failure,)
    assert solved.failure in (RodStatus.BUCKLED, RodStatus.CRUSHED)
    assert np.isnan(solved.positions).all()
    with pytest.raises(NoEquilibriumError, match="no tip at 0, 0, 0 kPa"):
        _ = design.workspace
    file = design.save(tmp_path / "heavy.json")
    assert run(["tips", str(file), "--csv", "--pressures", "0,0,0"]) == 1
    said = capsys.readouterr()
    assert said.out == "p1,p2,p3,x,y,z\n"
    assert said.err.startswith("beamopt: no tip at 0, 0, 0 kPa: ")
    assert run(["show", str(file), "--out", str(tmp_path / "a.png")]) == 1
    assert not (tmp_path / "a.png").exists()


@pytest.mark.parametrize("name", list(RUNGS))
def test_a_written_scene_is_the_same_scene(name: str, tmp_path: Path) -> None:
    scene = load_scene(name)
    file = tmp_path / "scene.toml"
    file.write_text(scene_text(scene))
    again = load_scene(file)
    assert (again.rod, again.loads) == (scene.rod, scene.loads)


WRONG = [
    ("rod.segments=[{share=0.5}]", "the shares of rod.segments add to 0.5: must be 1"),
    ('rod.segments=[{share=1.0,file="nowhere.json"}]', "at least one without a file"),
    ("loads.mount_x=[2.0,0.0,0.0]", "mount_z and mount_x must be perpendicular"),
    ("loads.mount_z=[0.0,0.0,0.0]", "must not be zero vectors"),
    ("loads.density=-1.0", "0 … 30000 kg/m³"),
    ('rod.rung="ladder"', "one of auto, arc, chain, loaded"),
    ("rod.twist=3", "auto"),
]


@pytest.mark.parametrize(("override", "said"), WRONG, ids=[one[0] for one in WRONG])
def test_mistakes_are_named(override: str, said: str) -> None:
    with pytest.raises(InputError, match=r".") as caught:
        load_scene("gravity", [override])
    assert said in str(caught.value)


def test_rung_says_what_and_why(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert run(["rung", "two-segments"]) == 0
    said = capsys.readouterr().out
    assert "→ chain" in said
    assert "no loads, sections or rest shape vary: exact" in said
    file = design_with({"density": 1070.0}, {"rung": "loaded"}).save(tmp_path / "a.json")
    assert run(["rung", str(file)]) == 0
    assert run(["rung", str(file), "--set", "loads.density=1000"]) == 2
    assert "asked for" in capsys.readouterr().out


def test_defaults_are_the_papers_actuator() -> None:
    assert not Loading().loads.any
    assert not Scene().rod.segments
    assert RodRules() == Scene().rod
