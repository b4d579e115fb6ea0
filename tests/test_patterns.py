"""Regular expressions of the product, whose time grows with the length of a text and no faster."""

import ast
import importlib
import pkgutil
import re
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

import pytest

import beamopt
import femcheck
from beamopt.base.errors import InputError
from beamopt.storage.input_file import parse_toml
from beamopt.storage.writing import csv_text
from femcheck.report.markdown import to_html
from tests.test_architecture import MODULES, name_of

LENGTH = 100_000  # letters: with its square a pattern takes minutes
SECONDS = 2.0  # of processor time; linear ones take some milliseconds


def patterns() -> dict[str, re.Pattern[str]]:
    """All that stand in modules, by the names of the modules and their own."""
    found = {}
    for package in (beamopt, femcheck):
        for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if module.name != "femcheck.regression.pytest_plugin":
                values = vars(importlib.import_module(module.name))
                found |= {
                    f"{module.name}.{name}": value
                    for name, value in values.items()
                    if isinstance(value, re.Pattern)
                }
    return found


PATTERNS = patterns()
SEARCHED = {
    "beamopt.export.step.PRODUCT",
    "beamopt.export.step.SOLID",
    "beamopt.storage.input_file.TOML_TOKEN",
}
"""Those that are looked for in a text; all others are held against its beginning, or all of it."""
UNITS = (
    *("a", "1", " ", "\n", ".", "-", "+", "'", '"', "\\", "*", "`", "|", "#", "{", "(", "=", ":"),
    *("1.", "e1", ".1", "**", " *", '"""', "'''", '\\"""\n', "\\'''\n", '"a"', "--- ", "---|"),
    *(":-", " |", "PRODUCT('", "PRODUCT('a',", "BREP_WITH_VOIDS(", ',"digest":"0123456789abcdef"'),
    *("[a]", "a.", "# \n", "front-1", ".1.tmp", "beamopt-1-", "'=", "é", "\u2028"),
)
HEADS = (
    *("", '"""', "'''", "+", "|", "{a", ".a.", "** ", "# ", "."),
    *("PRODUCT('", "beamopt-", "front-"),
)
TAILS = ("", "x", "\\")


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Raise TimeoutError after some processor time: a pattern at work listens to signals."""

    def late(number: int, frame: FrameType | None) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGVTALRM, late)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)


def hostile_texts() -> Iterator[str]:
    for unit in UNITS:
        body = unit * (LENGTH // len(unit))
        for head in HEADS:
            for tail in TAILS:
                yield head + body + tail


def test_there_are_patterns() -> None:
    assert len(PATTERNS) >= 11


@pytest.mark.parametrize("name", PATTERNS)
def test_a_pattern(name: str) -> None:
    pattern = PATTERNS[name]
    for text in hostile_texts():
        try:
            with limited(SECONDS):
                pattern.match(text)
                pattern.fullmatch(text)
                if name in SEARCHED:
                    pattern.findall(text)
        except TimeoutError:
            pytest.fail(f"{pattern.pattern} on {text[:30]!r} … {text[-3:]!r}")


@pytest.mark.parametrize("file", MODULES, ids=name_of)
def test_patterns_stand_in_modules(file: Path) -> None:
    """`re` compiles and nothing else, and what is searched for is tested as such."""
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            owner = node.value.id
            assert owner != "re" or node.attr in ("compile", "DOTALL", "MULTILINE")
            if f"{name_of(file)}.{owner}" in PATTERNS and node.attr not in ("match", "fullmatch"):
                assert f"{name_of(file)}.{owner}" in SEARCHED


def test_long_texts_are_read_soon() -> None:
    """A million of what made a pattern go back and forth."""
    with limited(10 * SECONDS):
        with pytest.raises(InputError):
            parse_toml('"""' + '\\"""\n' * 200_000 + "\\", "text")
        assert "<table" not in to_html("| a |\n|" + " " * 1_000_000 + "x")
        assert csv_text("a", [["+" + "1" * 1_000_000 + "x"]]).startswith("a\n'+11")


def test_the_line_below_a_head_makes_a_table() -> None:
    for rule in ("| --- | ---: |", "|---|:---:|", "--- | ---"):
        assert "<table" in to_html(f"| a | b |\n{rule}\n| 1 | 2 |")
    for rule in ("| --- |", "| a |", "||", "| --- x |", "---", "| --- | --- | --- |", ""):
        assert "<table" not in to_html(f"| a | b |\n{rule}\n| 1 | 2 |")
