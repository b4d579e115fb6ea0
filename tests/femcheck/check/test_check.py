"""A check from end to end: what it finds, and what its files say."""

import csv
import json
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import femcheck.solved.picture
from beamopt.base.arrays import FloatArray
from beamopt.target.workspace import node_index
from femcheck.check.checked import Checked
from femcheck.check.tables import verdict
from femcheck.continuation.outcome import Status
from femcheck.continuation.pressure_tree import all_nodes
from femcheck.material.rigid_section import RigidSection
from femcheck.solved.case import Case, Solid, solve_case
from femcheck.solved.subject import Subject
from tests.femcheck.check.small import LEVELS

Done = tuple[Checked, Path]
DEMANDED = (
    "law,c,nu,mesh,p1,p2,p3,beam_x,beam_y,beam_z,solid_x,solid_y,solid_z,difference_mm,status"
)


def rows_of(file: Path) -> list[dict[str, str]]:
    with file.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def scene_of(checked: Checked) -> tuple[Subject, Solid, FloatArray, FloatArray, str]:
    """What is drawn of a check: its solid with the larger penalty at full pressure."""
    stage = next(one for one in checked.stages if one.name == "standard-c10000")
    state = checked.results[stage.name, (2, 0, 1)].outcome.state
    assert state is not None
    pressures = checked.subject.pressures[node_index(2, 0, 1)]
    return checked.subject, stage.solid, state.x, pressures, "as the tests drew it"


def test_it_holds(done: Done) -> None:
    checked, _ = done
    assert checked.holds
    assert checked.failure is None
    assert verdict(checked).startswith("agrees: worst 0.")
    assert len(checked.results) == 4 * 27
    assert all(result.status is Status.CONVERGED for result in checked.results.values())


def test_a_verdict_that_mesh_or_penalty_could_turn_over_is_uncertain(done: Done) -> None:
    """What was asked moves through the worst share: only near it does the mesh have a say."""
    checked, folder = done
    compared = checked.comparison
    assert compared is not None
    assert 0 < compared.left < 1e-2
    expected = (compared.discretisation + compared.penalty_error) / np.maximum(
        compared.displacement, 1e-2 * compared.displacement.max()
    )
    assert compared.left == pytest.approx(np.nanmax(expected[compared.is_loaded]))
    for off, certain in ((-1.01, True), (-0.99, False), (0.99, False), (1.01, True)):
        agree = compared.worst + off * compared.left
        if agree > 0:
            asked = replace(checked, options=replace(checked.options, agree=agree))
            assert asked.certain is certain
            assert ("uncertain" in verdict(asked)) is not certain
    assert checked.certain
    said = json.loads((folder / "summary.json").read_text())
    assert said["verdict"]["certain"] is True
    left = said["difference"]["worst_left_of_displacement"]
    assert left == pytest.approx(compared.left, abs=1e-6)


def test_a_case_without_an_answer_on_the_coarse_mesh_leaves_a_verdict_uncertain(
    done: Done,
) -> None:
    """What the mesh leaves of it is not known, however well all others are."""
    compared = done[0].comparison
    assert compared is not None
    coarse = compared.solid("coarse", np.inf)
    tips = coarse.tips.copy()
    tips[node_index(2, 0, 1)] = np.nan
    solids = tuple(replace(one, tips=tips) if one is coarse else one for one in compared.solids)
    checked = replace(done[0], comparison=replace(compared, solids=solids))
    assert checked.comparison is not None
    assert checked.comparison.unanswered == 0
    assert np.isnan(checked.comparison.left)
    assert not checked.certain


def test_of_an_element_without_a_known_order_all_that_the_mesh_changes_counts(
    quick: Done,
) -> None:
    compared = quick[0].comparison
    assert compared is not None
    assert compared.order is None
    coarse, moved = compared.solid("coarse", np.inf), np.maximum(compared.displacement, 1e-9)
    change = np.linalg.norm(compared.final.tips - coarse.tips, axis=1) / moved
    assert compared.left >= np.nanmax(change[compared.is_loaded]) > 0
    assert quick[0].certain  # it is off by far more than both meshes differ by
    assert not quick[0].holds


def test_columns_and_rows(done: Done) -> None:
    _, folder = done
    rows = rows_of(folder / "compare.csv")
    assert set(DEMANDED.split(",")) <= set(rows[0])
    solids = Counter((row["mesh"], row["c"]) for row in rows)
    expected = {(mesh, c) for mesh in ("standard", "coarse") for c in ("2500", "10000", "inf")}
    assert solids == dict.fromkeys(expected, 27)
    combinations = {tuple(float(row[f"p{k}"]) for k in (1, 2, 3)) for row in rows}
    assert combinations == {(a, b, c) for a in LEVELS for b in LEVELS for c in LEVELS}
    assert {row["law"] for row in rows} == {"rigid-section"}
    assert {row["status"] for row in rows} == {"converged"}
    for row in rows:
        beam, solid = (
            np.array([float(row[f"{who}_{axis}"]) for axis in "xyz"]) for who in ("beam", "solid")
        )
        off = np.linalg.norm(solid - beam)
        assert float(row["difference_mm"]) == pytest.approx(off, abs=2e-6)
        at_rest = not any(float(row[f"p{k}"]) for k in (1, 2, 3))
        assert (row["difference_of_displacement"] == "") == at_rest
    assert len(rows_of(folder / "table.csv")) == 27


def test_beam_columns_are_the_design_s_own_tips(done: Done) -> None:
    """On this outline; the same order of pressures as a workspace has."""
    checked, folder = done
    subject = checked.subject
    rows = [row for row in rows_of(folder / "compare.csv") if row["c"] == "inf"][:27]
    at = np.array([[float(row[f"p{k}"]) for k in (1, 2, 3)] for row in rows])
    np.testing.assert_array_equal(at, subject.design.workspace.pressures)
    tips = np.array([[float(row[f"beam_{axis}"]) for axis in "xyz"] for row in rows])
    np.testing.assert_allclose(tips, subject.beam_tips, atol=1e-6)
    # the raster and this coarse outline are views of one section
    assert np.abs(tips - subject.design.workspace.tips).max() < 1.0


def test_difference_falls_as_the_penalty_rises(done: Done) -> None:
    """As 1/c over three decades, and what is extrapolated from two of them is the limit."""
    checked, _ = done
    compared = checked.comparison
    assert compared is not None
    solid = next(stage for stage in checked.stages if stage.name == "standard-c10000").solid
    node = (2, 0, 1)
    row = node_index(*node)
    pressures = checked.subject.pressures[row]
    centroid = np.append(solid.section.moments.centroid, 0.0)
    limit, off = compared.final.tips[row], {}
    for c in (100.0, 400.0, 1600.0):
        soft = replace(solid, law=RigidSection(300.0, c))
        state = solve_case(Case(soft, pressures, None, None)).outcome.state
        assert state is not None
        off[c] = np.linalg.norm(state.tip - centroid - limit)
    for c in (2500.0, 10000.0):
        off[c] = np.linalg.norm(compared.solid("standard", c).tips[row] - limit)
    for c, distance in off.items():
        assert c * distance == pytest.approx(10000 * off[10000.0], rel=0.05)
    loaded = compared.is_loaded
    assert compared.penalty_error[loaded].max() < 1e-3
    assert compared.worst < 1e-3
    assert 0 < compared.median <= compared.worst
    assert compared.unanswered == 0


def test_finer_layers_are_nearer(done: Done) -> None:
    compared = done[0].comparison
    assert compared is not None
    beam, loaded = compared.subject.beam_tips, compared.is_loaded
    off = {
        mesh: np.linalg.norm(compared.solid(mesh, np.inf).tips - beam, axis=1)[loaded].max()
        for mesh in ("coarse", "standard")
    }
    assert off["standard"] < off["coarse"] / 4
    assert compared.refinement == 2
    # the estimate is of the size of what is really left
    assert off["standard"] / 10 < compared.discretisation.max() < 10 * off["standard"]


def test_chambers_grow_under_pressure(done: Done) -> None:
    _, folder = done
    rows = [row for row in rows_of(folder / "compare.csv") if row["c"] == "10000"]
    for row in rows:
        for k in (1, 2, 3):
            ratio = float(row[f"volume_ratio_{k}"])
            alone = all(float(row[f"p{other}"]) == 0 for other in (1, 2, 3) if other != k)
            if float(row[f"p{k}"]) > 0 and alone:
                assert 1.001 < ratio < 1.5
            if row["p1"] == row["p2"] == row["p3"] == "0":
                assert ratio == pytest.approx(1, abs=1e-6)


def test_summary(done: Done) -> None:
    checked, folder = done
    said = json.loads((folder / "summary.json").read_text())
    assert said["verdict"]["holds"] is True
    assert said["verdict"]["text"] == verdict(checked)
    assert said["section"]["chambers"] == [1, 1, 1]
    assert said["difference"]["cases"] == 26
    assert said["difference"]["without_answer"] == 0
    assert [solid["converged"] for solid in said["solids"]] == [27] * 4
    assert [solid["layers"] for solid in said["solids"]] == [2, 2, 1, 1]
    assert said["geometry_steps_mm"]["outline_to_mesh"] < 1e-6
    assert "seconds" not in json.dumps(said)


def test_files(done: Done) -> None:
    _, folder = done
    assert {file.name for file in folder.iterdir()} == {
        "check.json",
        "design.json",
        "compare.csv",
        "table.csv",
        "summary.json",
        "timing.csv",
        "provenance.json",
        "mesh.msh",
        "mesh.vtu",
        "cases",
        "deformed",
    }
    assert len(list((folder / "cases").iterdir())) == 4 * 27
    assert len(list((folder / "deformed").iterdir())) == 27


def test_deformed_files_are_the_equilibria(done: Done) -> None:
    import pyvista

    checked, folder = done
    read = pyvista.read(folder / "deformed" / "40-0-20.vtu")
    warped = read.warp_by_vector("displacement_mm")
    assert warped.compute_cell_sizes()["Volume"].min() > 0
    stage = next(one for one in checked.stages if one.name == "standard-c10000")
    state = checked.results[stage.name, (2, 0, 1)].outcome.state
    assert state is not None
    top = warped.points[np.isclose(read.points[:, 2], 100)]
    rest = stage.solid.section
    # corners of the tip face: the plate's motion of the section
    flat = np.column_stack([rest.points - rest.moments.centroid, np.zeros(len(rest.points))])
    expected = state.tip + flat @ state.turn.T
    np.testing.assert_allclose(top[np.lexsort(top.T)], expected[np.lexsort(expected.T)], atol=1e-6)


def test_every_result_is_an_equilibrium(done: Done) -> None:
    checked, _ = done
    for node in all_nodes():
        outcome = checked.results["standard-c10000", node].outcome
        assert outcome.residual < 1.0  # mN, of thousands that the caps carry
        assert outcome.negative_eigenvalues in (0, None)


def test_the_picture(done: Done) -> None:
    """Five seconds in another process, for what people look at first: it is drawn, and coloured."""
    import matplotlib.image

    checked, folder = done
    assert femcheck.solved.picture.draw(folder, *scene_of(checked))
    image = matplotlib.image.imread(folder / "picture.png")
    (folder / "picture.png").unlink()
    assert image.shape[:2] == (1000, 1800)
    colours = np.ptp(image[..., :3], axis=2)
    left, right = (image[:, :900], colours[:, :900]), (image[:, 900:], colours[:, 900:])
    assert (left[1] > 0.2).mean() > 0.001  # walls by supply
    assert (right[0][..., :3].min(axis=2) < 0.9).mean() > 0.01  # a body and its title
    # the whole of a slender body is in view: nothing between it and the lines of text
    for rows in (slice(30, 45), slice(955, 970)):
        assert (right[0][rows, :, :3] > 0.98).all()


def test_a_picture_that_fails_is_only_a_log(
    done: Done, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(femcheck.solved.picture.sys, "executable", "/bin/false")
    assert not femcheck.solved.picture.draw(tmp_path, *scene_of(done[0]))
    assert [file.name for file in tmp_path.iterdir()] == ["picture.log"]
