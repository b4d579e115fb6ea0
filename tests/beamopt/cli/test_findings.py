"""What is wrong with a section, or has no effect in it: one truth for every command."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from beamopt.base.errors import InputError
from beamopt.cli.application import run
from beamopt.outline.drawn import outside, too_thin
from beamopt.outline.faults import FaultKind, Severity, summaries
from beamopt.scene.design import Design, load_design
from beamopt.scene.drawn_chambers import DrawnChamber
from beamopt.scene.seal_keys import Seal
from beamopt.section.drawing import RingPiece
from beamopt.section.grid import PolarGrid
from femcheck.cli.application import run as run_femcheck
from tests.beamopt.export.samples import drawn, random_section

SEALED = Seal(skin=1.0, wall=0.9, rounding=0.5, smallest_chamber=3.0)
ROUND = [
    {"supply": k + 1, "center": [17.5 * np.cos(a), 17.5 * np.sin(a)], "radius": 4.5}
    for k, a in enumerate(np.radians([0.0, 120.0, 240.0]).tolist())
]


def kinds(design: Design) -> list[FaultKind]:
    return [fault.status for fault in design.findings]


def found(design: Design, kind: FaultKind) -> Any:
    (one,) = [fault for fault in design.findings if fault.status is kind]
    return one


@pytest.mark.parametrize(
    ("chamber", "grid"),
    [
        ({"center": [40.0, 0.0], "radius": 4.0}, {}),
        ({"center": [25.0 + 4.0, 0.0], "radius": 4.0}, {}),  # touches the surface from outside
        ({"center": [0.0, 0.0], "radius": 10.0}, {}),  # in the hole
        ({"r": [25.0, 30.0], "phi": [0.0, 360.0]}, {}),
        ({"r": [3.0, 10.0], "phi": [0.0, 80.0], "corner": 1.0}, {}),
        ({"r": [13.0, 22.0], "phi": [180.0, 350.0]}, {"start": 0.0, "stop": 180.0}),
        ({"center": [0.0, -17.5], "radius": 4.0}, {"start": 0.0, "stop": 180.0}),
    ],
)
@pytest.mark.parametrize("seal", [Seal(), SEALED])
def test_a_chamber_outside_is_refused(
    chamber: dict[str, Any], grid: dict[str, float], seal: Seal, tmp_path: Path
) -> None:
    sound = drawn([ROUND[0]], seal, **grid)
    data = json.loads(sound.json())
    data["drawing"].append({"supply": 2, **chamber})
    file = tmp_path / "design.json"
    file.write_text(json.dumps(data))
    with pytest.raises(InputError) as caught:
        load_design(file)
    assert caught.value.key == "drawing[1]"
    assert str(file) in str(caught.value)


@pytest.mark.parametrize(
    "chamber",
    [
        {"r": [14.0, 14.0005], "phi": [0.0, 90.0]},
        {"r": [14.0, 18.0], "phi": [0.0, 0.001]},
        {"center": [17.5, 0.0], "radius": 4e-4},
    ],
)
def test_a_chamber_that_is_only_thin_is_not_said_to_be_outside(
    chamber: dict[str, Any], tmp_path: Path
) -> None:
    grid, thin = PolarGrid(), DrawnChamber.model_validate({"supply": 2, **chamber}).build()
    beyond = RingPiece(1, (25.0, 30.0), (0.0, 80.0))
    assert too_thin([beyond, thin], grid) == [1]
    assert outside([beyond], grid) == [0]
    data = json.loads(drawn([ROUND[0]], Seal()).json())
    data["drawing"].append({"supply": 2, **chamber})
    file = tmp_path / "design.json"
    file.write_text(json.dumps(data))
    with pytest.raises(InputError) as caught:
        load_design(file)
    assert caught.value.key == "drawing[1]"
    assert "0.001 mm" in caught.value.allowed


def test_a_thin_chamber_that_can_be_told_from_its_arcs() -> None:
    wide = [{"supply": 1, "r": [14.0, 14.0 + 1.1e-3], "phi": [0.0, 90.0]}]
    assert drawn(wide, Seal()).outline.chambers_of(1)


@pytest.mark.parametrize("seal", [Seal(), SEALED])
def test_a_chamber_that_a_surface_cuts_is_told_with_its_place(seal: Seal) -> None:
    design = drawn([*ROUND[1:], {"supply": 1, "center": [23.0, 0.0], "radius": 4.0}], seal)
    cut = found(design, FaultKind.CUT)
    assert (cut.drawn, cut.supplies, cut.severity) == (2, (1,), Severity.NOTICE)
    assert np.hypot(*cut.place) == pytest.approx(25.0, abs=0.01)
    assert abs(cut.place[1]) < 1e-6
    x = (25**2 - 4**2 + 23**2) / (2 * 23)  # of the two points where the circles cross
    half, turn = np.arccos((x - 23) / 4), np.arccos(x / 25)
    inside = 25**2 * (turn - np.sin(2 * turn) / 2) + 16 * (np.pi - half + np.sin(2 * half) / 2)
    assert cut.value == pytest.approx(16 * np.pi - inside, rel=1e-4)
    assert (FaultKind.UNSEALED in kinds(design)) is (not seal.rules.sealed)


@pytest.mark.parametrize("seal", [Seal(), SEALED])
def test_a_hidden_chamber_is_told(seal: Seal) -> None:
    design = drawn([{"supply": 3, "center": [17.0, 0.0], "radius": 2.0}, *ROUND], seal)
    assert found(design, FaultKind.HIDDEN).drawn == 0
    assert kinds(drawn(ROUND, seal)) == []


def test_a_chamber_that_comes_to_nothing_is_told() -> None:
    """Filled by the seal, or between the centroids of the raster's elements."""
    small = {"supply": 1, "center": [17.45, 9.1], "radius": 0.02}
    assert found(drawn([*ROUND, small], Seal()), FaultKind.LOST).drawn == 3
    assert found(drawn([*ROUND, small], SEALED), FaultKind.LOST).drawn == 3
    assert found(drawn([*ROUND, small | {"radius": 0.8}], SEALED), FaultKind.LOST).drawn == 3
    assert kinds(drawn([*ROUND, small | {"radius": 0.8}], Seal())) == []


@pytest.mark.parametrize("seal", [Seal(), SEALED])
def test_walls_of_elements_in_a_sealed_section_are_told(seal: Seal) -> None:
    data = json.loads(drawn(ROUND, seal).json()) | {"wall_elements": 4}
    design = Design.model_validate(data)
    if not seal.rules.sealed:
        assert kinds(design) == []
        return
    assert found(design, FaultKind.WALL_ELEMENTS).value == 4
    without = Design.model_validate(data | {"wall_elements": 0})
    np.testing.assert_array_equal(design.section.labels, without.section.labels)


def test_the_outline_is_in_the_findings() -> None:
    for design in (random_section(0, skin=0.0), drawn([*ROUND, ROUND[0] | {"radius": 8.0}])):
        assert design.findings[: len(design.outline.faults)] == design.outline.faults
    assert FaultKind.UNSEALED in kinds(random_section(0, skin=0.0))


def sayings(design: Design) -> list[str]:
    return [f"note: {line}" for line in summaries(design.findings)]


@pytest.fixture
def faulty(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A sealed design with a thin wall, an ignored wall, a hidden and a cut chamber."""
    monkeypatch.chdir(tmp_path)
    chambers = [
        {"supply": 2, "center": [17.0, 0.0], "radius": 2.0},
        *ROUND,
        {"supply": 1, "center": [0.0, 23.0], "radius": 4.0},
    ]
    data = json.loads(drawn(chambers, SEALED).json()) | {"wall_elements": 6}
    path = tmp_path / "faulty.json"
    path.write_text(json.dumps(data))
    return path


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["tips", "faulty.json"], 0),
        (["tips", "faulty.json", "--csv", "--pressures", "1,2,3"], 0),
        (["show", "faulty.json"], 0),
        (["reach", "faulty.json", "path.csv", "--csv", "--tolerance", "1000"], 0),
        (["export", "faulty.json", "--format", "svg"], 0),
        (["rung", "faulty.json"], 0),
        (["bound", "faulty.json"], 0),
    ],
)
def test_every_command_says_the_same(
    arguments: list[str], code: int, faulty: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """On standard error, a line for each kind; a table on standard output stays a table."""
    Path("path.csv").write_text("x,y,z\n0,0,80\n5,0,80\n")
    assert run(arguments) == code
    out, err = capsys.readouterr()
    design = load_design(faulty)
    assert {FaultKind.CUT, FaultKind.HIDDEN, FaultKind.WALL_ELEMENTS} == set(kinds(design))
    said = err.splitlines()
    if "export" in arguments:  # which has more to say of its files
        said = [line for line in said if line in sayings(design)]
    assert said == sayings(design)
    assert "note" not in out
    if "tips" in arguments and "--csv" in arguments:
        assert len(out.splitlines()) == 2


def test_a_search_and_a_refinement_end_with_them(
    faulty: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    few = ["--set=search.generations=1", "--set=refine.rounds=1"]
    assert run(["optimize", "random-section", "--out", "run", few[0]]) == 0
    design = load_design("run/best.json")
    assert sayings(design)
    said = capsys.readouterr().err.splitlines()
    assert [line for line in said if line.startswith("note: ")] == sayings(design)
    assert run(["refine", "run/best.json", "--scene", "random-section", *few]) == 0
    refined = load_design("best-refined/refined.json")
    said = capsys.readouterr().err.splitlines()
    assert [line for line in said if line.startswith("note: ")] == sayings(refined)


def test_a_check_says_them(faulty: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Of a design of which no solid can be made, too; what is open is refused as before."""
    data = json.loads(faulty.read_text())
    ring = {"supply": 1, "r": [15.0, 20.0], "phi": [0.0, 360.0]}
    Path("two.json").write_text(json.dumps(data | {"drawing": [ring]}))
    assert run_femcheck(["run", "two.json", "--out", "checked"]) == 1
    said = capsys.readouterr().err.splitlines()
    assert said == sayings(load_design("two.json"))
    assert any("separate pieces" in line for line in said)
    section = json.loads(Path("checked/summary.json").read_text())["section"]
    assert section["faults"] == [str(fault) for fault in load_design("two.json").findings]


def test_baselines_say_them_of_designs_that_are_named(
    faulty: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """With the design's name where several are named."""
    data = json.loads(faulty.read_text())
    for name in ("open", "other"):  # of which there is no solid to wait for
        Path(f"{name}.json").write_text(json.dumps(data | {"seal": {}}))
    design = load_design("open.json")
    assert FaultKind.HIDDEN in kinds(design)
    here = ["--workers", "1"]
    named = [
        (["baseline", "open.json", "--out", "held", *here], sayings(design)),
        (["regress", "open.json", "--baseline", "held", *here], sayings(design)),
        (["regress", "--baseline", "held", *here], []),
        (
            ["baseline", "open.json", "other.json", "--out", "both", *here],
            [
                f"note: {name}: {line}"
                for name in ("open", "other")
                for line in summaries(design.findings)
            ],
        ),
    ]
    for arguments, expected in named:
        assert run_femcheck(arguments) == 0
        said = capsys.readouterr().err.splitlines()
        assert [line for line in said if line.startswith("note: ")] == expected


def test_a_front_says_them_of_what_it_prints(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    few = ["--population", "12", "--generations", "1", "--objectives", "L,mass"]
    assert run(["pareto", "random-section", *few, "--out", "front"]) == 0
    out, err = capsys.readouterr()
    printed = dict.fromkeys(re.findall(r"\(index (\d+)\)", out))
    expected = [
        f"note: index {k}: {line}"
        for k in printed
        for line in summaries(load_design(f"front/front-{int(k):03d}.json").findings)
    ]
    assert expected
    assert [line for line in err.splitlines() if line.startswith("note: ")] == expected
