"""A prediction from end to end: what it finds, and what its files say."""

import csv
import json
from collections import Counter
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import femcheck.solved.picture
from femcheck.continuation.outcome import Status
from femcheck.prediction.prediction import Prediction
from femcheck.prediction.two_meshes import GROWTH, MARGIN
from femcheck.prediction.verdict import advice, verdict
from tests.femcheck.prediction.small import LEVELS, SOFT

Done = tuple[Prediction, Path]
HEADER = (
    "law,c,nu,mesh,p1,p2,p3,beam_x,beam_y,beam_z,solid_x,solid_y,solid_z,difference_mm,"
    "difference_of_length,difference_of_displacement,volume_ratio_1,volume_ratio_2,volume_ratio_3,"
    "status"
)
Rows = list[dict[str, str]]


def rows_of(file: Path) -> Rows:
    with file.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def numbers(row: dict[str, str], *names: str) -> np.ndarray:
    return np.array([float(row[name] or "nan") for name in names])


def direction(row: dict[str, str]) -> tuple[float, ...]:
    return tuple(numbers(row, "d1", "d2", "d3").tolist())


def test_every_ray_balloons(limited: Done) -> None:
    found, _ = limited
    assert len(found.rays) == 19
    assert {one.status for one in found.results.values()} == {Status.LIMIT_POINT}
    for (_, number), result in found.results.items():
        ray = found.rays[number]
        assert 20 < result.critical < 40
        assert [answer is not None for answer in result.answers] == [
            stop < result.critical for stop in ray.stops
        ]
        assert result.last is not None
        assert result.last.load <= result.critical


def test_statuses_answer_for_each_combination(limited: Done) -> None:
    """Seven have no pressure above 20 kPa; the others are beyond the limit of their ray."""
    found, _ = limited
    for row, pressures in enumerate(found.subject.pressures):
        within = pressures.max() <= 20
        assert found.status(row) is (Status.CONVERGED if within else Status.LIMIT_POINT)
        assert np.isnan(found.tips[row]).any() != within
        assert np.isnan(found.ended_at(row)) == within
    assert found.unanswered == 19
    assert not found.is_loaded[0]
    np.testing.assert_array_equal(found.tips[0], [0, 0, 100])


def test_the_box_is_the_smallest_critical_pressure(limited: Done) -> None:
    found, folder = limited
    ends = [found.result(number).critical for number in range(len(found.rays))]
    assert max(ends) > min(ends) + 1
    assert found.first_to_end == int(np.argmin(ends))
    assert found.stable_box == min(one.critical for one in found.results.values()) == min(ends)
    said = json.loads((folder / "summary.json").read_text())
    assert said["stable_box_kpa"] == pytest.approx(min(ends), abs=1e-6)


def test_two_coarse_meshes_do_not_agree_and_that_is_said(limited: Done) -> None:
    """Of two layers and of one: limits are 9 to 15 % apart, and more than 10 % is uncertain."""
    found, folder = limited
    assert not found.certain
    assert len(found.compared) == 4
    ratios = [ends.ratio for ends in found.compared]
    for ends in found.compared:
        standard, coarse = ends.loads
        assert coarse > standard
        assert ends.ratio == pytest.approx(coarse / standard)
        assert 1.05 < ends.ratio < 1.3
    said = json.loads((folder / "summary.json").read_text())
    assert said["verdict"]["certain"] is False
    assert said["meshes"]["largest_ratio"] == pytest.approx(max(ratios), abs=1e-6)
    assert [one["ratio"] for one in said["limits"]] == pytest.approx(ratios, abs=1e-6)
    limits = rows_of(folder / "limits.csv")
    assert Counter(row["meshes"] for row in limits if row["mesh"] == "coarse") == Counter(
        ends.agreement.name for ends in found.compared
    )
    for row in limits:
        same = [one for one in limits if direction(one) == direction(row)]
        other = [one["ends_at_kpa"] for one in same if one["mesh"] != row["mesh"]]
        assert row["on_the_other_mesh_kpa"] == (other[0] if other else "")


def test_what_is_advised_is_stable_on_both_meshes_and_grows_little(limited: Done) -> None:
    found, folder = limited
    box = found.safe_box
    assert 0 < box.pressure <= found.stable_box / MARGIN
    for (_, number), result in found.results.items():
        supplies = found.rays[number].supplies
        loads, volumes = result.track[:, 0], result.track[:, 1:4]
        before = loads <= box.pressure
        before[int(np.argmax(loads)) :] = False
        grown = volumes[before] / volumes[0]
        assert all(grown[:, supply - 1].max() <= GROWTH + 1e-9 for supply in supplies)
    said = json.loads((folder / "summary.json").read_text())["safe_box"]
    assert said["kpa"] == pytest.approx(box.pressure, abs=1e-6)


def test_it_does_not_hold_and_says_why(limited: Done) -> None:
    found, _ = limited
    assert not found.holds
    assert found.first_to_end is not None
    text, way_out = verdict(found), advice(found)
    assert text.startswith(f"unreinforced, this section balloons at {found.stable_box:.3g} kPa (")
    assert "(all supplies alike" in text
    assert "19 of 26 combinations have no stable answer" in text
    assert "the beam's workspace at 40 kPa exists in part only" in text
    assert way_out is not None
    assert way_out.startswith("stay below ")
    said = float(way_out.split()[2])
    assert 0.99 * found.safe_box.pressure < said <= found.safe_box.pressure  # never rounded up
    assert way_out.endswith("; or wind every chamber (--law wound shows what that does)")


def test_low_pressures_have_every_answer(calm: Done) -> None:
    found, folder = calm
    assert {one.status for one in found.results.values()} == {Status.CONVERGED}
    assert found.unanswered == 0
    assert found.first_to_end is None
    assert found.stable_box == found.largest == 2
    assert found.holds
    assert advice(found) is None
    text = verdict(found)
    assert text.startswith("unreinforced, up to 2 kPa all 26 combinations have a stable answer; ")
    assert "the beam holds: its tips are off by" in text
    rows = rows_of(folder / "compare.csv")
    assert {row["status"] for row in rows} == {"converged"}
    assert {row["ends_at_kpa"] for row in rows} == {""}
    said = json.loads((folder / "summary.json").read_text())
    assert said["verdict"]["holds"] is True
    assert said["verdict"]["advice"] is None
    # plain silicone answers with P²: the beam overestimates more the less the pressure is
    assert found.median > 0.9


def test_worst_and_median_are_those_of_the_rows(calm: Done) -> None:
    found, folder = calm
    rows = [row for row in rows_of(folder / "compare.csv") if row["mesh"] == "standard"]
    shares = [numbers(row, "difference_of_displacement")[0] for row in rows]
    assert np.isnan(shares[0])  # rest
    assert np.nanmin(shares) < np.nanmedian(shares) < np.nanmax(shares)
    assert found.worst == pytest.approx(np.nanmax(shares), abs=1e-6)
    assert found.median == pytest.approx(np.nanmedian(shares), abs=1e-6)


def test_the_header_that_was_promised(limited: Done) -> None:
    _, folder = limited
    header = (folder / "compare.csv").read_text(encoding="utf-8").splitlines()[0]
    assert header.startswith(HEADER + ",")


def test_27_standard_rows_matched_by_pressure(limited: Done) -> None:
    """Beam and solid of one row are at one row's pressures; each number is what was computed."""
    found, folder = limited
    rows = rows_of(folder / "compare.csv")
    standard = [row for row in rows if row["mesh"] == "standard"]
    assert len(standard) == 27
    at = {tuple(numbers(row, "p1", "p2", "p3").tolist()): row for row in standard}
    assert set(at) == {(a, b, c) for a in LEVELS for b in LEVELS for c in LEVELS}
    for index, pressures in enumerate(found.subject.pressures):
        row = at[tuple(pressures.tolist())]
        assert (row["law"], row["c"], row["nu"]) == ("neo-hookean", "", "0.5")
        beam = numbers(row, "beam_x", "beam_y", "beam_z")
        solid = numbers(row, "solid_x", "solid_y", "solid_z")
        np.testing.assert_allclose(beam, found.subject.beam_tips[index], atol=1e-6)
        np.testing.assert_allclose(solid, found.tips[index], atol=1e-6)
        assert row["status"] == found.status(index).value
        off, of_length, share = numbers(
            row, "difference_mm", "difference_of_length", "difference_of_displacement"
        )
        if row["status"] != "converged":
            assert np.isnan([off, of_length, share]).all()
            critical = numbers(row, "ends_at_kpa")[0]
            assert critical == pytest.approx(found.ended_at(index), abs=1e-6)
            assert critical < pressures.max()
            assert row["largest_stretch"] == row["volume_ratio_1"] == ""
            continue
        assert row["ends_at_kpa"] == ""
        assert off == pytest.approx(np.linalg.norm(solid - beam), abs=2e-6)
        assert of_length == pytest.approx(off / 100, abs=1e-6)
        if pressures.any():
            moved = np.linalg.norm(beam - [0, 0, 100])
            assert share == pytest.approx(off / moved, rel=1e-4)
            assert numbers(row, "largest_stretch")[0] > 1


def test_the_solid_s_tip_is_the_state_s_at_those_pressures(limited: Done) -> None:
    """A ray's stops are not mixed up: forces on the solid at its tip's state are in balance."""
    from femcheck.solved.case import workshop

    found, folder = limited
    row = next(
        row
        for row in rows_of(folder / "compare.csv")
        if (row["mesh"], row["p1"], row["p2"], row["p3"]) == ("standard", "20", "0", "20")
    )
    index = found.subject.pressures.tolist().index([20.0, 0.0, 20.0])
    answer = found.answer(index)
    assert answer is not None
    solid = found.solids["standard"]
    problem = workshop(solid).problem
    # nodes of the tip face lie around the tip as the section's do around its centroid
    body = problem.body
    flat = body.nodes[body.tip, :2] - solid.section.moments.centroid
    away = np.linalg.norm(answer.x[body.tip] - answer.tip, axis=1)
    np.testing.assert_allclose(away, np.linalg.norm(flat, axis=1), atol=1e-9)
    # and supplies 1 and 3 are the ones that have grown
    ratios = numbers(row, "volume_ratio_1", "volume_ratio_2", "volume_ratio_3")
    rest = solid.section.moments.chamber_areas * 100
    np.testing.assert_allclose(ratios, answer.volumes / rest, atol=1e-6)
    assert min(ratios[0], ratios[2]) > 1.5 > 1.1 > ratios[1]


def test_the_coarse_mesh_has_rows_of_its_own(limited: Done) -> None:
    """Of the principal rays alone: rest, and 20 and 40 kPa in each and in all alike."""
    found, folder = limited
    rows = [row for row in rows_of(folder / "compare.csv") if row["mesh"] == "coarse"]
    assert len(rows) == 1 + 4 * 2
    combinations = found.subject.pressures.tolist()
    for row in rows:
        index = combinations.index(numbers(row, "p1", "p2", "p3").tolist())
        solid = numbers(row, "solid_x", "solid_y", "solid_z")
        np.testing.assert_allclose(solid, found.tips_on("coarse")[index], atol=1e-6)
        if found.is_loaded[index] and row["status"] == "converged":
            # two layers and one differ by more than rounding and less than the answer
            apart = np.linalg.norm(solid - found.tips[index])
            assert 1e-3 < apart < 0.5 * np.linalg.norm(found.tips[index] - [0, 0, 100])
            assert found.discretisation[index] == pytest.approx(apart, abs=2e-6)


def test_limits(limited: Done) -> None:
    found, folder = limited
    rows = rows_of(folder / "limits.csv")
    assert Counter(row["mesh"] for row in rows) == {"standard": 19, "coarse": 4}
    by_ray = {ray.direction: number for number, ray in enumerate(found.rays)}
    for row in rows:
        result = found.results[row["mesh"], by_ray[direction(row)]]  # type: ignore[index]
        assert row["status"] == "limit point"
        ends, stable = numbers(row, "ends_at_kpa", "stable_up_to_kpa")
        assert ends == pytest.approx(result.critical, abs=1e-6)
        assert 0.9 * ends < stable <= ends
        ratios = numbers(row, "volume_ratio_1", "volume_ratio_2", "volume_ratio_3")
        assert ratios[int(np.argmax(direction(row)))] > 2  # a balloon
        assert numbers(row, "largest_stretch")[0] > 1.5
        share = numbers(row, "mode_share")[0]
        assert np.isnan(share) or share > 0.05  # a balloon is no crease
        assert int(row["points"]) == len(result.track)
        assert int(row["iterations"]) > int(row["points"])


def test_paths_rise_to_the_limit_and_then_fall(limited: Done) -> None:
    _, folder = limited
    ends = {
        (row["mesh"], direction(row)): float(row["ends_at_kpa"])
        for row in rows_of(folder / "limits.csv")
    }
    paths: dict[tuple[str, tuple[float, ...]], Rows] = {}
    for row in rows_of(folder / "paths.csv"):
        paths.setdefault((row["mesh"], direction(row)), []).append(row)
    assert set(paths) == set(ends)
    for key, points in paths.items():
        loads = [float(row["load"]) for row in points]
        top = int(np.argmax(loads))
        assert loads[0] == 0
        assert 0 < top < len(loads) - 1
        assert all(after > before for before, after in pairwise(loads[: top + 1]))
        assert all(after < before for before, after in pairwise(loads[top:]))
        # to the cubic between the points about the top
        assert max(loads) == pytest.approx(ends[key], rel=0.01)
        assert max(loads) <= ends[key] + 1e-6
        volumes = [
            numbers(row, "volume_1", "volume_2", "volume_3") @ np.array(key[1]) for row in points
        ]
        assert all(after > before for before, after in pairwise(volumes))
        unstable = [row["unstable"] for row in points]
        if "" not in unstable:  # without inertia nobody counts
            first = next(n for n, row in enumerate(points) if row["unstable"] != "0")
            assert first in (top, top + 1)
            assert unstable[first] == "1"
            assert "0" not in unstable[first:]


def test_axis_has_the_beam_s_strains_beside_the_solid_s(limited: Done) -> None:
    found, folder = limited
    rows = rows_of(folder / "axis.csv")
    seen: dict[tuple[float, ...], int] = Counter(direction(row) for row in rows)
    # four intervals between the five planes of nodes of two layers
    assert seen == {ray.direction: 4 for ray in found.rays}
    for row in rows:
        number = next(n for n, ray in enumerate(found.rays) if ray.direction == direction(row))
        last = found.result(number).last
        assert last is not None
        pressures = last.load * np.array([direction(row)])
        beam = found.subject.response.strains(pressures)[0]
        shown = numbers(row, "beam_extension", "beam_curvature_x", "beam_curvature_y")
        np.testing.assert_allclose(shown, beam, atol=1e-9)
        z = numbers(row, "z")[0]
        solid = next(line for line in last.axis if abs(line[0] - z) < 1e-6)
        shown = numbers(row, "extension", "curvature_x", "curvature_y")
        np.testing.assert_allclose(shown, solid[1:], atol=1e-9)
        assert float(row["load_kpa"]) == pytest.approx(last.load, abs=1e-6)


def test_summary(limited: Done) -> None:
    found, folder = limited
    text = (folder / "summary.json").read_text(encoding="utf-8")
    said = json.loads(text)
    for word in ("seconds", "duration", "date", "host", str(folder)):
        assert word not in text
    assert said["verdict"]["kind"] == "prediction"
    assert said["verdict"]["holds"] is False
    assert said["verdict"]["text"] == verdict(found)
    assert said["verdict"]["advice"] == advice(found)
    assert "incompressible" in said["material"]["energy"]
    constants = {one["name"]: one["value"] for one in said["material"]["constants"]}
    assert constants["E"] == SOFT
    assert constants["μ"] == pytest.approx(SOFT / 3)
    assert said["actuator"] == {"length_mm": 100, "slenderness": pytest.approx(100 / 30, abs=1e-6)}
    assert [one["of"] for one in said["limits"]] == [
        *(f"supply {k} alone" for k in (1, 2, 3)),
        "all supplies alike",
    ]
    for number, one in enumerate(said["limits"]):
        coarse = found.results["coarse", number].critical
        assert one["on_the_coarse_mesh_kpa"] == pytest.approx(coarse, abs=1e-6)
        assert one["ends_at_kpa"] == pytest.approx(found.result(number).critical, abs=1e-6)
    assert said["difference"]["cases"] == 26
    assert said["difference"]["without_answer"] == 19
    assert [(solid["mesh"], solid["rays"]) for solid in said["solids"]] == [
        ("standard", 19),
        ("coarse", 4),
    ]
    assert {solid["form"] for solid in said["solids"]} == {"mixed"}


def test_files(limited: Done) -> None:
    found, folder = limited
    names = {file.name for file in folder.iterdir()}
    assert names == {
        *("check.json", "design.json", "summary.json", "timing.csv", "provenance.json"),
        *("compare.csv", "limits.csv", "paths.csv", "axis.csv"),
        *("paths.png", "paths.svg", "axis.png", "axis.svg"),
        *("mesh.msh", "mesh.vtu", "cases", "deformed"),
    }
    lasts = {f"last-{ray.name}.vtu" for ray in found.rays}
    rows = [row for row in range(27) if found.answer(row) is not None]
    assert rows
    answers = {"-".join(f"{p:g}" for p in found.subject.pressures[row]) for row in rows}
    shapes = {file.name for file in (folder / "deformed").iterdir()}
    assert shapes == lasts | {f"{name}.vtu" for name in answers}
    assert len(list((folder / "cases").iterdir())) == 19 + 4


def test_deformed_files_are_the_last_equilibria(limited: Done) -> None:
    import pyvista

    found, folder = limited
    last = found.result(0).last
    assert last is not None
    read = pyvista.read(folder / "deformed" / "last-100_0_0.vtu").warp_by_vector("displacement_mm")
    shown = found.solids["standard"].shown()
    np.testing.assert_allclose(read.points, last.x[shown.nodes], atol=1e-6)


def test_deformed_files_are_the_answers_too(limited: Done) -> None:
    """Named by their pressures, as a check names them."""
    import pyvista

    found, folder = limited
    row = next(row for row in range(27) if found.answer(row) is not None)
    answer = found.answer(row)
    assert answer is not None
    name = "-".join(f"{pressure:g}" for pressure in found.subject.pressures[row])
    read = pyvista.read(folder / "deformed" / f"{name}.vtu").warp_by_vector("displacement_mm")
    shown = found.solids["standard"].shown()
    np.testing.assert_allclose(read.points, answer.x[shown.nodes], atol=1e-6)


@pytest.mark.parametrize("name", ["paths.png", "axis.png"])
def test_figures_are_images(limited: Done, name: str) -> None:
    import matplotlib.image

    image = matplotlib.image.imread(limited[1] / name)
    assert min(image.shape[:2]) > 400
    assert np.ptp(image[..., :3], axis=2).max() > 0.3  # something coloured was drawn
    svg = (limited[1] / name).with_suffix(".svg").read_text(encoding="utf-8")
    assert "<svg" in svg


def test_the_picture(limited: Done, pictured: list[tuple[Any, ...]], tmp_path: Path) -> None:
    """Five seconds in another process: of the ray that ends first, where it is last stable."""
    import matplotlib.image

    found, _ = limited
    (scene,) = pictured
    folder, subject, solid, x, pressures, said = scene
    assert folder == limited[1]
    assert subject is found.subject
    assert solid is found.solids["standard"]
    assert found.first_to_end is not None
    last = found.result(found.first_to_end).last
    assert last is not None
    assert x is last.x
    np.testing.assert_allclose(pressures, last.load)  # all supplies alike
    assert "limit point at" in said
    assert femcheck.solved.picture.draw(tmp_path, *scene[1:])
    image = matplotlib.image.imread(tmp_path / "picture.png")
    assert (np.ptp(image[..., :3], axis=2) > 0.2).mean() > 0.001
