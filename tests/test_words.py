"""Texts that go into people's folders: what was measured, and no talk of how it was made."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
MODULES = sorted(
    path for package in ("beamopt", "femcheck") for path in (ROOT / package).rglob("*.py")
)
SHOP_TALK = re.compile(r"\b(prototypes?|ship(s|ped|ping)?|today|yesterday|tomorrow)\b", re.I)


def texts(path: Path) -> Iterator[str]:
    """Every text of a module; docstrings where they are the help of commands."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef)
    docstrings = {
        id(node.body[0].value)
        for node in ast.walk(tree)
        if isinstance(node, documented) and node.body and isinstance(node.body[0], ast.Expr)
    }
    for node in ast.walk(tree):
        is_help = path.name == "application.py" or id(node) not in docstrings
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and is_help:
            yield node.value


def test_no_text_talks_of_its_making() -> None:
    found = [(path.name, text) for path in MODULES for text in texts(path)]
    assert [one for one in found if SHOP_TALK.search(one[1])] == []


@pytest.mark.parametrize("ending", ["html", "js", "css", "toml", "csv"])
def test_no_file_that_is_copied_does(ending: str) -> None:
    packages = (ROOT / "beamopt", ROOT / "femcheck")
    files = [path for package in packages for path in package.rglob(f"*.{ending}")]
    assert [path for path in files if SHOP_TALK.search(path.read_text(encoding="utf-8"))] == []
