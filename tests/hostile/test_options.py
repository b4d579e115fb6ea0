"""Every option and argument of every command, given what nobody means."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import typer

from beamopt.cli.application import app as beamopt
from femcheck.cli.application import app as femcheck
from tests.hostile.cases import CODES, Case, Server, check, check_codes
from tests.hostile.damages import copied
from tests.hostile.test_files import READ

VALUES = (
    *("nan", "inf", "-inf", "-1", "1e999", "1e-300", "9" * 400, "9" * 5000, "0x10", "1,2,3"),
    *("", " ", "\n", "a\nb", "\udcff", "é\u202e😀", "a" * 10_000, "=", "a=", "=1", "a.b=nan"),
    *("../beside", "../beside/best.json", "file/below", "/dev/null", "/dev/zero", "--", "-"),
    *("$(touch x)", "%s%n", "[/]", "[red]", "$\\frac$", "{0}", "'", '"', "\\", "*"),
)

# a line that ends soon whatever else is given: its folder is a file, or there is nothing to do
LINES: dict[str, str] = {
    "beamopt optimize": "random-section --out file",
    "beamopt refine": "drawn.json --scene section.toml --out file",
    "beamopt study": "--out file",
    "beamopt pareto": "random-section --objectives L,ratio --out file",
    "beamopt tips": "drawn.json",
    "beamopt reach": "drawn.json path.csv",
    "beamopt show": "drawn.json --out shown.svg",
    "beamopt export": "drawn.json --out file",
    "beamopt bound": "table.csv --out file",
    "beamopt chart": "section.toml --out file",
    "beamopt stability": "--out file",
    "beamopt rung": "section.toml",
    "beamopt scenes": "",
    "beamopt init": "section.toml",
    "femcheck run": "sealed.json --gmsh false --workers 1 --out file",
    "femcheck chart": "sealed.json --out file",
    "femcheck laws": "",
    "femcheck report": "figures --out out.html --force",
    "femcheck stability": "--out file",
    "femcheck baseline": "sealed.json --out file --meshes meshes",
    "femcheck regress": "gravity --baseline nowhere --meshes nowhere",
}
FILES = ("drawn.json", "sealed.json", "section.toml", "path.csv", "table.csv", "figures")

OUTS = ("../beside", "../beside/best.json", "file/below", "/dev/null", "/dev/zero", "a" * 10_000)
"""Folders that can not be taken; any other one would be, and the command would begin to work."""

CHEAP = ("beamopt tips", "beamopt reach", "beamopt show", "beamopt rung", "femcheck report")
"""Commands that end soon with whatever folder or file they write."""


def parameters() -> list[tuple[str, str, int | None]]:
    """Command, name, and place among its arguments or None, of all options that take a value."""
    found: list[tuple[str, str, int | None]] = []
    for program, app in (("beamopt", beamopt), ("femcheck", femcheck)):
        group: Any = typer.main.get_command(app)
        for name, command in group.commands.items():
            options = [one for one in command.params if one.param_type_name == "option"]
            arguments = [one for one in command.params if one.param_type_name == "argument"]
            line = f"{program} {name}"
            taking = [one for one in options if not one.is_flag and one.name != "help"]
            found += [(line, one.opts[0], None) for one in taking]
            found += [(line, one.name, place) for place, one in enumerate(arguments)]
    return found


def test_every_command_has_a_line() -> None:
    assert {line for line, _, _ in parameters()} <= LINES.keys()


def test_every_row_of_codes_is_a_case() -> None:
    options = {f"{line} {name}" for line, name, _ in parameters()}
    assert CODES.keys() == {"case", *options, *READ}


def lines_of(command: str, parameter: str, place: int | None) -> list[list[str]]:
    """The usual line of the command with each value, of an option or of an argument."""
    program, name = command.split()
    usual = LINES[command].split()
    if place is None:
        values = OUTS if parameter == "--out" and command not in CHEAP else VALUES
        return [[program, name, *usual, f"{parameter}={value}"] for value in values]
    count = next((k for k, word in enumerate(usual) if word.startswith("--")), len(usual))
    arguments, options = usual[:count], usual[count:]
    return [
        [program, name, *options, "--", *arguments[:place], value, *arguments[place + 1 :]]
        for value in VALUES
    ]


@pytest.mark.parametrize(
    ("command", "parameter", "place"),
    parameters(),
    ids=[f"{command} {parameter}" for command, parameter, _ in parameters()],
)
def test_an_option(
    command: str,
    parameter: str,
    place: int | None,
    assets: Path,
    server: Server,
    tmp_path: Path,
) -> None:
    def make(folder: Path) -> None:
        copied(assets, *FILES)(folder)
        (folder / "file").write_text("of somebody")
        (folder / "meshes").mkdir()

    case = Case(lines_of(command, parameter, place), make, (0, 1, 2, 3))
    check_codes(f"{command} {parameter}", check(case, server, tmp_path))
