"""Kernels on disk belong to the sources as they are now."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import beamopt

INNER = """
from beamopt.base.compiled import compiled

@compiled
def inner(x: float) -> float:
    return x + 1
"""
OUTER = """
from beamopt.base.compiled import compiled
from beamopt.section.inner import inner

@compiled
def outer(x: float) -> float:
    return 10 * inner(x)
"""


def result(folder: Path) -> float:
    done = subprocess.run(
        [sys.executable, "-c", "from beamopt.section.outer import outer; print(outer(1.0))"],
        cwd=folder,  # comes first on the path
        capture_output=True,
        text=True,
        check=True,
    )
    return float(done.stdout)


def test_a_change_in_a_kernel_reaches_those_that_call_it(tmp_path: Path) -> None:
    """A search must not go on with yesterday's physics because its own file did not change."""
    package = copied(tmp_path)
    assert result(tmp_path) == 20
    kept = list((package / "__pycache__").glob("kernels-*"))
    assert len(kept) == 1
    assert result(tmp_path) == 20
    assert list((package / "__pycache__").glob("kernels-*")) == kept
    (package / "section" / "inner.py").write_text(INNER.replace("x + 1", "x + 2"))
    assert result(tmp_path) == 30


def copied(folder: Path) -> Path:
    """A package of two kernels of its own room, one that calls the other."""
    package = folder / "beamopt"
    source = Path(str(beamopt.__file__)).parent
    for folder in ("base", "section"):
        (package / folder).mkdir(parents=True)
    shutil.copy(source / "base/compiled.py", package / "base")
    for name in ("__init__.py", "base/__init__.py", "section/__init__.py"):
        (package / name).touch()
    (package / "section" / "inner.py").write_text(INNER)
    (package / "section" / "outer.py").write_text(OUTER)
    return package


def ran(folder: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """Both kernels, without byte code, which would go where kernels go."""
    return subprocess.run(
        [sys.executable, "-B", "-c", "from beamopt.section.outer import outer; print(outer(1.0))"],
        cwd=folder,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
    )


def test_kernels_of_a_package_that_can_not_be_written(tmp_path: Path) -> None:
    """A file in the place of the folder: it stops root too."""
    package = copied(tmp_path)
    (package / "__pycache__").write_text("")
    home = tmp_path / "home"
    done = ran(tmp_path, HOME=str(home), XDG_CACHE_HOME="", NUMBA_CACHE_DIR="")
    assert (done.stdout, done.stderr) == ("20.0\n", "")
    assert [*(home / ".cache" / "beamopt").rglob("*.nbi")]


@pytest.mark.parametrize("given", [True, False])
def test_kernels_without_a_cache(given: bool, tmp_path: Path) -> None:
    package = copied(tmp_path)
    (package / "__pycache__").write_text("")
    (tmp_path / "file").write_text("")
    cache = str(tmp_path / "file" / "cache") if given else ""
    home = str(tmp_path if given else tmp_path / "file")
    done = ran(tmp_path, HOME=home, XDG_CACHE_HOME="", NUMBA_CACHE_DIR=cache)
    assert (done.returncode, done.stdout) == (0, "20.0\n")
    assert done.stderr.count("\n") == 1
    assert "NUMBA_CACHE_DIR" in done.stderr
