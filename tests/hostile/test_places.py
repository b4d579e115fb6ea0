"""Streams, disks, names and environments that are not as usual."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.hostile.cases import Case, Server, check
from tests.hostile.damages import copied
from tests.hostile.programs import MAIN
from tests.hostile.test_options import FILES, LINES

SOON = {
    "beamopt tips drawn.json": 0,
    "beamopt tips drawn.json --csv": 0,
    "beamopt show drawn.json --out shown.svg": 0,
    "beamopt reach drawn.json path.csv": 1,
    "beamopt rung section.toml": 0,
    "beamopt scenes": 0,
    "beamopt init new.toml": 0,
    "beamopt --help": 0,
    "beamopt optimize section.toml --out out": 0,
    "beamopt export drawn.json --format svg --out parts": 0,
    "femcheck laws": 0,
    "femcheck report figures --out out.html": 0,
    "femcheck --version": 0,
}
"""Commands that end soon, with their exit codes."""

STREAMS = {
    "no output": {"1": "closed"},
    "no errors": {"2": "closed"},
    "neither": {"1": "closed", "2": "closed"},
    "nobody reads": {"1": "pipe"},
}


@pytest.mark.parametrize("streams", STREAMS)
@pytest.mark.parametrize("line", SOON)
def test_streams(line: str, streams: str, assets: Path, server: Server, tmp_path: Path) -> None:
    settings = {"streams": STREAMS[streams]}
    code = 0 if streams == "nobody reads" else SOON[line]
    case = Case([line.split()], copied(assets, *FILES), (code, SOON[line]), settings)
    check(case, server, tmp_path)


@pytest.mark.parametrize("command", LINES)
def test_misuse_without_streams(command: str, assets: Path, server: Server, tmp_path: Path) -> None:
    case = Case(
        [[*command.split(), "--no-such-option"]],
        copied(assets, *FILES),
        settings={"streams": STREAMS["neither"]},
    )
    check(case, server, tmp_path)


def test_a_full_output(assets: Path, server: Server, tmp_path: Path) -> None:
    settings = {"streams": {"1": "/dev/full"}}
    lines = [line.split() for line in ("beamopt scenes", "beamopt tips drawn.json --csv")]
    check(Case(lines, copied(assets, *FILES), (3,), settings), server, tmp_path)
    assert (tmp_path / "0.stderr").read_text().startswith("beamopt: standard output: ")


FULL = {
    "beamopt show drawn.json --out shown.svg": "shown.svg",
    "beamopt init new.toml": "new.toml",
    "beamopt optimize section.toml --out out": "out/",
    "beamopt export drawn.json --format svg --out parts": "parts/",
    "femcheck report figures --out out.html": "out.html",
    "femcheck run sealed.json --gmsh false --out out": "out/",
}


@pytest.mark.parametrize("line", FULL)
def test_a_full_disk(line: str, assets: Path, server: Server, tmp_path: Path) -> None:
    """A limit on the size of files stands for it: 200 bytes, the first of which are written."""
    case = Case([line.split()], copied(assets, *FILES), (3,), {"file_size": 200})
    check(case, server, tmp_path)
    said = [
        one
        for one in (tmp_path / "0.stderr").read_text().splitlines()
        if not one.startswith("note: ")
    ]
    assert len(said) == 1
    assert FULL[line] in said[0]
    assert not [one for one in (tmp_path / "here").rglob("*") if one.name.endswith(".tmp")]


NAMES = (
    "\udcff\udcfe",
    "é\u202e😀",
    "a\nb",
    "[red]",
    "$\\frac$",
    "-x",
    "a b'c\"",
    "%s",
    "\x01\x1b[31m",
)


@pytest.mark.parametrize("name", NAMES, ids=ascii)
def test_names(name: str, assets: Path, server: Server, tmp_path: Path) -> None:
    """Files and folders of any name are taken, in figures, tables and reports too."""

    def make(folder: Path) -> None:
        copied(assets, *FILES, "run")(folder)
        (folder / "drawn.json").rename(folder / f"{name}.json")
        (folder / "figures").rename(folder / f"{name} figures")
        (folder / "run").rename(folder / f"{name} run")
        scene = (folder / "section.toml").read_text()
        (folder / f"{name}.toml").write_text(scene.replace("drawn.json", "sealed.json"))

    lines = [
        ["beamopt", "tips", "--", f"{name}.json"],
        ["beamopt", "show", "--out", f"./{name}.svg", "--", f"{name}.json"],
        ["beamopt", "show", "--out", "run.png", "--", f"{name} run"],
        ["beamopt", "rung", "--", f"{name}.toml"],
        ["beamopt", "optimize", "--out", f"./{name} out", "--", f"{name}.toml"],
        [
            "beamopt",
            "export",
            "--format",
            "svg,dxf",
            "--out",
            f"{name} parts",
            "--",
            f"{name}.json",
        ],
        ["femcheck", "report", "--out", "out.html", "--", f"{name} figures", f"{name} run"],
        ["femcheck", "run", "--gmsh=false", "--seal=1", f"--out=./{name} x", "--", f"{name}.json"],
    ]
    check(Case(lines, make, (0, 1, 2, 3)), server, tmp_path)
    codes = [(tmp_path / f"{number}.code").read_text() for number in range(len(lines))]
    assert codes == ["0"] * (len(lines) - 1) + ["3"]


ENVIRONMENTS = {
    "no home": {"HOME": "/dev/null/home", "XDG_CACHE_HOME": ""},
    "ASCII": {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONIOENCODING": "ascii"},
    "plain": {"TERM": "dumb", "NO_COLOR": "1", "COLUMNS": "1", "LINES": "1"},
    "no temporary folder": {"TMPDIR": "/nowhere", "TMP": "/nowhere", "TEMP": "/nowhere"},
    "no path": {"PATH": ""},
    "cache in a file": {"NUMBA_CACHE_DIR": "/dev/null/cache"},
}


@pytest.mark.parametrize("name", ENVIRONMENTS)
def test_environments(name: str, assets: Path, tmp_path: Path) -> None:
    """In processes of their own, which read them when they start."""
    lines = ["beamopt scenes", "beamopt rung section.toml"]
    copied(assets, *FILES)(tmp_path)
    for line in lines if name != "cache in a file" else lines[:1]:
        program, *arguments = line.split()
        done = subprocess.run(
            [sys.executable, "-c", MAIN[program], *arguments],
            cwd=tmp_path,
            env={**os.environ, **ENVIRONMENTS[name]},
            capture_output=True,
            timeout=60,
        )
        assert done.returncode == 0, done
        assert b"Traceback" not in done.stderr + done.stdout
