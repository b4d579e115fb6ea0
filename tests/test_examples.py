"""The examples in the docstrings of public names: run here, and as a script from the wheel.

The clean environment is a virtual environment that has the wheel's files alone; what the wheel
depends on comes from this environment by a path, so that nothing is downloaded.
"""

import doctest
import inspect
import os
import shutil
import site
import subprocess
import sys
import venv
import zipfile
from collections.abc import Iterable
from pathlib import Path
from textwrap import indent
from types import ModuleType

import pytest
from numba.core.caching import UserProvidedCacheLocator

import beamopt
import femcheck

ROOT = Path(__file__).resolve().parents[1]
NAMES = [(face, name) for face in (beamopt, femcheck) for name in face.__all__]
IDS = [f"{face.__name__}.{name}" for face, name in NAMES]
PARSER = doctest.DocTestParser()


def example_of(face: object, name: str) -> doctest.DocTest:
    public = getattr(face, name)
    return PARSER.get_doctest(inspect.getdoc(public) or "", {}, name, None, None)


@pytest.mark.parametrize(("face", "name"), NAMES, ids=IDS)
def test_every_public_name_shows_its_use(
    face: object, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The example names what it is of, and gives what it shows."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("femcheck.solved.picture.draw", lambda *scene: False)
    example = example_of(face, name)
    assert any(f".{name}" in one.source for one in example.examples)
    runner = doctest.DocTestRunner(verbose=False)
    said: list[str] = []
    runner.run(example, out=said.append)
    assert runner.summarize(verbose=False).failed == 0, "".join(said)


def script() -> str:
    """One program of all examples, a function and a folder each; its workers import it again."""
    parts = ['"""The examples of all public names."""\nimport os\n']
    calls = []
    for (face, name), called in zip(NAMES, IDS, strict=True):
        function = called.replace(".", "_")
        body = "".join(one.source for one in example_of(face, name).examples)
        parts.append(f"\ndef {function}() -> None:\n{indent(body, '    ')}\n")
        calls.append(f"    os.mkdir({function!r})\n    os.chdir({function!r})\n")
        calls.append(f"    {function}()\n    os.chdir(os.pardir)\n")
    return "".join([*parts, '\nif __name__ == "__main__":\n', *calls])


@pytest.fixture(scope="module")
def python(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The interpreter of an environment with the wheel."""
    place = tmp_path_factory.mktemp("wheel")
    source = place / "source"
    kept = shutil.ignore_patterns("__pycache__")
    for package in ("beamopt", "femcheck"):
        shutil.copytree(ROOT / package, source / package, ignore=kept)
    for file in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / file, source)
    build = "from setuptools.build_meta import build_wheel; build_wheel('..')"
    subprocess.run([sys.executable, "-c", build], cwd=source, check=True, capture_output=True)
    venv.create(place / "venv", with_pip=False)
    (packages,) = (place / "venv").glob("lib/python*/site-packages")
    with zipfile.ZipFile(next(place.glob("*.whl"))) as wheel:
        wheel.extractall(packages)
    others = [*site.getsitepackages(), site.getusersitepackages()]
    (packages / "dependencies.pth").write_text("\n".join(others))
    take_kernels(packages)
    return place / "venv" / "bin" / "python"


def take_kernels(packages: Path) -> None:
    """Copy this checkout's compiled kernels to where the same sources in `packages` look for them.

    Numba names a folder of kernels by the path of the modules. Kernels that are not there are
    compiled.
    """
    for room in {path.parent for face in (beamopt, femcheck) for path in modules_of(face)}:
        here, there = (
            UserProvidedCacheLocator.get_suitable_cache_subpath(str(folder / "any.py"))
            for folder in (room, packages / room.relative_to(ROOT))
        )
        for kernels in (ROOT / "beamopt" / "__pycache__").glob(f"kernels-*/{here}"):
            copy = packages / kernels.relative_to(ROOT).with_name(there)
            shutil.copytree(kernels, copy)


def modules_of(face: ModuleType) -> Iterable[Path]:
    return Path(str(face.__file__)).parent.rglob("*.py")


def test_the_script_runs_from_the_wheel(python: Path, tmp_path: Path) -> None:
    """Outside the checkout, by public names alone, and with types that a strict reader accepts."""
    file = tmp_path / "script.py"
    file.write_text(script())
    clean = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    clean["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), clean["PATH"]])  # gmsh
    where = "import beamopt, femcheck; print(beamopt.__file__, femcheck.__file__)"
    asked = [str(python), "-I", "-c", where]
    said = subprocess.run(asked, capture_output=True, text=True, check=True, cwd=tmp_path)
    assert all(str(python.parents[1]) in path for path in said.stdout.split())
    strict = ["--strict", "--python-executable", str(python), str(file)]
    checked = subprocess.run(
        [sys.executable, "-m", "mypy", *strict],
        capture_output=True, text=True, env=clean, cwd=tmp_path,
    )  # fmt: skip
    assert checked.returncode == 0, checked.stdout
    done = subprocess.run(
        [str(python), "-W", "error", str(file)],
        capture_output=True, text=True, env=clean, cwd=tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
