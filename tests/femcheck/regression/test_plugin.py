"""The fixture in a project of a user's own."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from femcheck.regression.held_design import find_design
from femcheck.regression.regression import update_baseline
from tests.femcheck.regression.small import saved

pytest_plugins = "pytester"

TEST = """
def test_it_stays(hold_design):
    hold_design("small.json"{rungs})
"""


@pytest.fixture(scope="module", autouse=True)
def loaded(tmp_path_factory: pytest.TempPathFactory) -> None:
    """A run within a run forgets what it loads, and numpy can not be loaded twice."""
    folder = tmp_path_factory.mktemp("loaded")
    update_baseline(find_design(str(saved(folder)), folder), folder / "baselines")


@pytest.fixture
def project(pytester: pytest.Pytester) -> Path:
    saved(pytester.path)
    pytester.makepyfile(test_held=TEST.format(rungs=""))
    return pytester.path


def test_written_then_held_then_moved(project: Path, pytester: pytest.Pytester) -> None:
    missing = pytester.runpytest_inprocess()
    missing.assert_outcomes(failed=1)
    missing.stdout.fnmatch_lines(["*small.json: no baseline; pytest --femcheck-update writes it"])
    pytester.runpytest_inprocess("--femcheck-update").assert_outcomes(passed=1)
    pytester.runpytest_inprocess().assert_outcomes(passed=1)
    file = project / "baselines" / "small.json"
    data = json.loads(file.read_text())
    tips = next(one for one in data["held"] if one["rung"] == "beam")
    tips["rows"]["0, 0, 20 kPa"][0] += 0.5
    file.write_text(json.dumps(data))
    moved = pytester.runpytest_inprocess()
    moved.assert_outcomes(failed=1)
    moved.stdout.fnmatch_lines(
        ["1 of * rows moved, the lowest rung first:", "*beam of small: tips at 0, 0, 20 kPa moved*"]
    )


def test_a_design_that_changed_is_said_to_have_changed(
    project: Path, pytester: pytest.Pytester
) -> None:
    pytester.runpytest_inprocess("--femcheck-update").assert_outcomes(passed=1)
    saved(project, pressures=[0, 20, 50])
    done = pytester.runpytest_inprocess()
    done.assert_outcomes(failed=1)
    done.stdout.fnmatch_lines(["*design.digest: small is not the design*--femcheck-update*"])
    pytester.runpytest_inprocess("--femcheck-update").assert_outcomes(passed=1)
    pytester.runpytest_inprocess().assert_outcomes(passed=1)


def test_only_some_rungs(project: Path, pytester: pytest.Pytester) -> None:
    pytester.makepyfile(test_held=TEST.format(rungs=', rungs=["beam"]'))
    pytester.runpytest_inprocess("--femcheck-update").assert_outcomes(passed=1)
    data = json.loads((project / "baselines" / "small.json").read_text())
    assert {one["rung"] for one in data["held"]} == {"beam"}
    pytester.runpytest_inprocess().assert_outcomes(passed=1)
    pytester.makepyfile(test_held=TEST.format(rungs=', rungs=["beams"]'))
    wrong = pytester.runpytest_inprocess()
    wrong.assert_outcomes(failed=1)
    wrong.stdout.fnmatch_lines(["*ValueError: rungs = *'beams'*"])


def test_two_tests_hold_rungs_of_one_design(project: Path, pytester: pytest.Pytester) -> None:
    two = "".join(
        TEST.format(rungs=f", rungs={rungs}").replace("it_stays", f"it_stays_{k}")
        for k, rungs in enumerate((["beam"], ["section", "response"]))
    )
    pytester.makepyfile(test_held=two)
    file = project / "baselines" / "small.json"

    def update() -> list[str]:
        pytester.runpytest_inprocess("--femcheck-update").assert_outcomes(passed=2)
        return list(dict.fromkeys(one["rung"] for one in json.loads(file.read_text())["held"]))

    assert update() == ["section", "response", "beam"]
    before = file.read_bytes()
    update()
    assert file.read_bytes() == before
    pytester.runpytest_inprocess().assert_outcomes(passed=2)
    saved(project, pressures=[0, 20, 50])  # nothing of the old one stays
    assert update() == ["section", "response", "beam"]
    pytester.runpytest_inprocess().assert_outcomes(passed=2)


def test_a_rung_that_the_design_does_not_have(project: Path, pytester: pytest.Pytester) -> None:
    pytester.makepyfile(test_held=TEST.format(rungs=', rungs=["beam", "solid, wound"]'))
    done = pytester.runpytest_inprocess("--femcheck-update")
    done.assert_outcomes(failed=1)
    done.stdout.fnmatch_lines(["*rungs = 'solid, wound'*of this design there is beam*"])
    pytester.makepyfile(test_held=TEST.format(rungs=', rungs=["beam"]'))
    pytester.runpytest_inprocess("--femcheck-update").assert_outcomes(passed=1)
    pytester.makepyfile(test_held=TEST.format(rungs=', rungs=["section"]'))
    done = pytester.runpytest_inprocess()
    done.assert_outcomes(failed=1)
    done.stdout.fnmatch_lines(["*rungs = 'section'*what is held: beam*"])


def test_loading_the_plugin_loads_nothing_else() -> None:
    code = (
        "import sys, femcheck.regression.pytest_plugin;"
        "print([n for n in ('numpy', 'scipy', 'numba', 'pydantic') if n in sys.modules], "
        "sorted(n for n in sys.modules if n.startswith('beamopt')))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[] ['beamopt', 'beamopt.base', 'beamopt.base.public_names']"
