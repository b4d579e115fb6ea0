"""gmsh that hangs, crashes or writes nonsense: a failure that says which, soon, nothing left."""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from femcheck.mesh.geo import SectionSizes, geo_script, least_triangles
from femcheck.mesh.gmsh_section import Mesher, MeshFailure, MeshProblem
from tests.femcheck import sections

FOUND = shutil.which("gmsh")
GMSH = [FOUND] if FOUND else [sys.executable, str(Path(sys.executable).with_name("gmsh"))]
OUTLINE = sections.three_chambers(0.5)


def stand_in(folder: Path, script: str) -> str:
    """An executable in gmsh's place; $out is the file that it was asked to write."""
    file = folder / "gmsh-stand-in"
    find = 'while [ $# -gt 1 ]; do [ "$1" = "-o" ] && out="$2"; shift; done\n'
    file.write_text(f"#!/bin/sh\n{find}{script}\n")
    file.chmod(0o755)
    return str(file)


def failure_of(command: str, seconds: float = 20.0) -> MeshFailure:
    began = time.perf_counter()
    result = Mesher(command, seconds).mesh(OUTLINE, SectionSizes())
    assert isinstance(result, MeshFailure)
    assert time.perf_counter() - began < 15  # far below what the stand-in sleeps
    assert str(result).startswith(result.problem.value)
    assert "\n" not in str(result)
    return result


@pytest.mark.parametrize(
    ("script", "said"),
    [
        ("echo Error: no such field; exit 3", "exit code 3 Error: no such field"),
        ("kill -SEGV $$", "SIGSEGV"),
        ("kill -KILL $$", "SIGKILL"),
    ],
)
def test_crashed(tmp_path: Path, script: str, said: str) -> None:
    failure = failure_of(stand_in(tmp_path, script))
    assert failure.problem is MeshProblem.CRASHED
    assert failure.detail == said


MSH = "$MeshFormat\\n4.1 0 8\\n$EndMeshFormat\\n"


@pytest.mark.parametrize(
    "script",
    [
        "exit 0",
        ': > "$out"',
        'echo rubbish > "$out"',
        f"printf '{MSH}' > \"$out\"",
        f"printf '{MSH}$Nodes\\n1 4 1' > \"$out\"",
        'head -c 4000 /dev/urandom > "$out"',
        'mkdir "$out"',
    ],
    ids=["nothing", "empty", "text", "no nodes", "cut off", "noise", "a folder"],
)
def test_no_mesh(tmp_path: Path, script: str, capfd: pytest.CaptureFixture[str]) -> None:
    assert failure_of(stand_in(tmp_path, script)).problem is MeshProblem.NO_MESH
    assert capfd.readouterr().out.strip() == ""


def test_a_mesh_file_with_bytes_changed(tmp_path: Path) -> None:
    """Whatever stands in it: a failure, or the right mesh where the change did not matter."""
    script, whole = tmp_path / "section.geo", tmp_path / "whole.msh"
    script.write_text(geo_script(OUTLINE, SectionSizes()))
    subprocess.run([*GMSH, "-2", "-v", "1", "-format", "msh41", "-o", whole, script], check=True)
    good, rng, problems = whole.read_bytes(), np.random.default_rng(1), []
    command = stand_in(tmp_path, f'cp {tmp_path}/changed.msh "$out"')
    for case in range(80):
        changed = bytearray(good)
        if case % 2:  # one digit for another, anywhere
            digits = np.flatnonzero(
                np.isin(np.frombuffer(good, dtype=np.uint8), list(b"0123456789"))
            )
            changed[rng.choice(digits)] = rng.choice(list(b"0123456789"))
        else:
            for place in rng.integers(400, size=3):
                changed[place] = rng.choice(list(b"0123456789 -$.aE\n\xff"))
        kept = changed[: rng.integers(len(good))] if case % 8 == 2 else changed
        (tmp_path / "changed.msh").write_bytes(kept)
        result = Mesher(command).mesh(OUTLINE, SectionSizes())
        if isinstance(result, MeshFailure):
            problems.append(result.problem)
        else:
            assert result.areas.sum() == pytest.approx(OUTLINE.moments.area, rel=1e-6)
    assert {MeshProblem.NO_MESH, MeshProblem.WRONG} <= set(problems)


def test_hangs_with_a_child_and_ignores_signals(tmp_path: Path) -> None:
    note = tmp_path / "pids"
    script = f"""trap '' TERM INT HUP
sh -c "trap '' TERM INT HUP; echo \\$\\$ >> {note}; sleep 60; sleep 60" &
echo $$ >> {note}
sleep 60; sleep 60"""
    failure = failure_of(stand_in(tmp_path, script), 1.0)
    assert failure == MeshFailure(MeshProblem.HUNG, "1 s")
    numbers = [int(line) for line in note.read_text().split()]
    assert len(numbers) == 2
    deadline = time.monotonic() + 10
    while any(map(_runs, numbers)) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not any(map(_runs, numbers))


def _runs(number: int) -> bool:
    """Whether a process is there and is more than an entry that nobody has collected."""
    try:
        os.kill(number, 0)
        state = Path(f"/proc/{number}/stat")
        return not state.exists() or state.read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_another_mesh_than_was_asked_for(tmp_path: Path) -> None:
    """A mesh that can be read, of something else: a smaller section."""
    script = tmp_path / "other.geo"
    script.write_text(geo_script(sections.thin_wall(0.5), SectionSizes()))
    program = " ".join(GMSH)
    other = stand_in(tmp_path, f'exec {program} -2 -v 1 -format msh41 -o "$out" {script}')
    failure = failure_of(other)
    assert failure.problem is MeshProblem.WRONG
    assert "outline" in failure.detail


def test_not_installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert failure_of("no-such-gmsh") == MeshFailure(MeshProblem.NO_GMSH, "no-such-gmsh")
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    failure = Mesher().mesh(OUTLINE, SectionSizes())
    assert failure == MeshFailure(MeshProblem.NO_GMSH, "pip install gmsh")


def test_not_executable(tmp_path: Path) -> None:
    """Something that carries the right to run and can not: its interpreter is missing."""
    file = tmp_path / "gmsh"
    file.write_text("#!/no/such/interpreter\n")
    file.chmod(0o755)
    assert failure_of(str(file)).problem is MeshProblem.CRASHED


def test_a_mesh_beyond_the_memory_is_not_begun(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    least = least_triangles(OUTLINE, SectionSizes())
    section = Mesher().mesh(OUTLINE, SectionSizes())
    assert not isinstance(section, MeshFailure)
    assert least <= len(section.triangles) < 20 * least
    monkeypatch.setattr("femcheck.mesh.gmsh_section.MOST_TRIANGLES", least - 1)
    failure = failure_of(stand_in(tmp_path, f"touch {tmp_path}/begun"))
    assert failure.problem is MeshProblem.TOO_FINE
    assert not (tmp_path / "begun").exists()
