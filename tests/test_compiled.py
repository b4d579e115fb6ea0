"""Kernels on disk belong to the sources as they are now."""

import shutil
import subprocess
import sys
from pathlib import Path

import beamopt

INNER = """
from beamopt.compiled import compiled

@compiled
def inner(x: float) -> float:
    return x + 1
"""
OUTER = """
from beamopt.compiled import compiled
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
    package = tmp_path / "beamopt"
    source = Path(str(beamopt.__file__)).parent
    (package / "section").mkdir(parents=True)
    for name in ("__init__.py", "compiled.py", "section/__init__.py"):
        shutil.copy(source / name, package / name)
    (package / "section" / "inner.py").write_text(INNER)
    (package / "section" / "outer.py").write_text(OUTER)
    assert result(tmp_path) == 20
    kept = list((package / "__pycache__").glob("kernels-*"))
    assert len(kept) == 1
    assert result(tmp_path) == 20
    assert list((package / "__pycache__").glob("kernels-*")) == kept
    (package / "section" / "inner.py").write_text(INNER.replace("x + 1", "x + 2"))
    assert result(tmp_path) == 30
