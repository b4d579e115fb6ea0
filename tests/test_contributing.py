"""What CONTRIBUTING.md, CITATION.cff and CHANGELOG.md say is so."""

import re
import tomllib
from pathlib import Path

import pytest

from tests.test_architecture import LEVELS, PACKAGES

ROOT = Path(__file__).resolve().parents[1]
SECTIONS = {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security", "Figures that moved"}
GUIDE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")


def test_the_levels_are_those_that_are_tested() -> None:
    rows = re.findall(r"^\| (\d+) \| (.*) \| (.*) \|$", GUIDE, re.MULTILINE)
    listed = {
        f"{package}.{name}": int(level)
        for level, *cells in rows
        for package, cell in zip(PACKAGES, cells, strict=True)
        for name in filter(None, cell.split(", "))
    }
    assert listed == LEVELS


@pytest.mark.parametrize("path", sorted(set(re.findall(r"`([\w./]+/[\w.]*)`", GUIDE))))
def test_files_that_it_names_are_there(path: str) -> None:
    assert (ROOT / path).exists() or "NAME" in path


@pytest.mark.parametrize("command", sorted(set(re.findall(r"sh run (\w+)", GUIDE))))
def test_commands_that_it_names_are_there(command: str) -> None:
    assert f"\n  {command})" in (ROOT / "run").read_text(encoding="utf-8")


def test_citation_and_changelog_have_the_version() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    cited = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\nversion: {project['version']}\n" in cited
    assert f"\nlicense: {project['license']}\n" in cited
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    released = r"^## \[(\d+\.\d+\.\d+)\] - (?:Unreleased|\d{4}-\d\d-\d\d)$"
    assert re.findall(released, changes, re.MULTILINE)[0] == project["version"]
    assert len(re.findall(r"^## ", changes, re.MULTILINE)) == len(
        re.findall(released, changes, re.MULTILINE)
    )
    assert set(re.findall(r"^### (.*)$", changes, re.MULTILINE)) <= SECTIONS
