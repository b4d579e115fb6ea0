"""The levels of folders, which library is loaded when, and one meaning for the name of a class."""

import ast
import importlib
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("beamopt", "femcheck")
MODULES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))

LEVELS = {
    "beamopt.base": 1,
    "beamopt.section": 2,
    "beamopt.storage": 2,
    "beamopt.outline": 3,
    "beamopt.rod": 3,
    "beamopt.target": 3,
    "beamopt.reach": 4,
    "beamopt.scene": 4,
    "beamopt.comparators": 5,
    "beamopt.judge": 5,
    "beamopt.plot": 5,
    "beamopt.bound": 6,
    "beamopt.chart": 6,
    "beamopt.export": 6,
    "beamopt.refine": 6,
    "beamopt.rod_map": 6,
    "beamopt.search": 7,
    "beamopt.pareto": 8,
    "beamopt.study": 8,
    "beamopt.cli": 9,
    "femcheck.assembly": 1,
    "femcheck.material": 1,
    "femcheck.mesh": 1,
    "femcheck.solid": 2,
    "femcheck.continuation": 3,
    "femcheck.solved": 4,
    "femcheck.check": 5,
    "femcheck.prediction": 5,
    "femcheck.models": 6,
    "femcheck.report": 6,
    "femcheck.stability": 6,
    "femcheck.chart": 7,
    "femcheck.accuracy": 8,
    "femcheck.regression": 9,
    "femcheck.cli": 10,
}
"""A folder imports folders of lower levels; all of femcheck stands above all of beamopt."""

AT_ROOT = {"__init__.py", "__init__.pyi", "__main__.py", "py.typed"}
DATA = {"scenes"}
MOST_LEVELS, MOST_LINES, MOST_LINKS = 10, 500, 150
HEAVY = {
    "gmsh",
    "skfem",
    "pyvista",
    "meshio",
    "femcheck",
    "matplotlib",
    "pypardiso",
    "ezdxf",
    "pymoo",
    "cma",
}
SAYS_NOTHING = {"utils", "util", "helpers", "common", "misc", "run"}


def name_of(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def folder_of(module: str) -> str:
    """The folder that has a level; the package for what stands at its root."""
    parts = module.split(".")
    has_folder = len(parts) > 2 or (ROOT / parts[0] / parts[-1]).is_dir()
    return ".".join(parts[:2]) if has_folder else parts[0]


def imports(path: Path, top_level_only: bool) -> Iterator[str]:
    """Dotted names that a module imports; modules among them only where there is one."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in tree.body if top_level_only else ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            assert node.level == 0, f"{path}: relative import"
            modules = (f"{node.module}.{alias.name}" for alias in node.names)
            yield from (name if is_module(name) else node.module for name in modules)


def is_module(name: str) -> bool:
    path = ROOT.joinpath(*name.split("."))
    return path.with_suffix(".py").exists() or (path / "__init__.py").exists()


@cache
def graph() -> dict[str, set[str]]:
    """Every module of both packages, and those that it imports, inside functions too."""
    return {
        name_of(path): {name for name in imports(path, False) if name.split(".")[0] in PACKAGES}
        for path in MODULES
    }


def links() -> dict[tuple[str, str], str]:
    """Pairs of folders of which the first imports the second, each with an example."""
    return {
        (folder_of(module), folder_of(imported)): f"{module} imports {imported}"
        for module, found in graph().items()
        for imported in found
        if folder_of(module) != folder_of(imported)
    }


def reached(start: str) -> set[str]:
    """Modules that a module's imports lead to."""
    seen: set[str] = set()
    waiting = list(graph()[start])
    while waiting:
        name = waiting.pop()
        if name not in seen:
            seen.add(name)
            waiting += graph().get(name, ())
    return seen


def test_imports_go_down() -> None:
    """From a folder to lower ones; never up, to a folder of the same level, or in a circle."""
    assert {folder_of(module) for module in graph()} == {*LEVELS, *PACKAGES}
    assert max(LEVELS.values()) <= MOST_LEVELS
    for (upper, lower), said in links().items():
        if upper in PACKAGES:  # its face and its command line
            continue
        assert lower in LEVELS, said
        above = {"beamopt": 0, "femcheck": MOST_LEVELS}
        levels = [above[one.split(".")[0]] + LEVELS[one] for one in (upper, lower)]
        assert levels[0] > levels[1], said
    assert [module for module in graph() if module in reached(module)] == []


def test_modules_are_small_and_found_in_folders() -> None:
    """Libraries that take long to load are imported in functions; folders are tied by few links."""
    for path in MODULES:
        if name_of(path).startswith("beamopt"):
            top = {name.partition(".")[0] for name in imports(path, top_level_only=True)}
            assert not top & HEAVY, path
        assert len(path.read_text(encoding="utf-8").splitlines()) <= MOST_LINES, path
        assert path.stem not in SAYS_NOTHING, path
    for package in PACKAGES:
        entries = {one.name for one in (ROOT / package).iterdir()} - {"__pycache__"}
        folders = {name.split(".")[1] for name in LEVELS if name.startswith(package + ".")}
        assert entries - DATA == AT_ROOT | folders
    between = {pair for pair in links() if not {*pair} & {*PACKAGES}}
    checks = {pair for pair in between if pair[0].startswith("femcheck")}
    as_one = {("femcheck", lower) for _, lower in checks if lower.startswith("beamopt")}
    assert len(between - checks | as_one) <= MOST_LINKS
    assert len(checks) <= MOST_LINKS


def test_a_class_name_has_one_meaning() -> None:
    """In both packages; a name that begins with an underscore is its module's alone."""
    homes: dict[str, list[str]] = {}
    for path in MODULES:
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                homes.setdefault(node.name, []).append(name_of(path))
    assert {name: found for name, found in homes.items() if len(found) > 1} == {}


@pytest.mark.parametrize("package", PACKAGES)
def test_every_public_name_is_there_whatever_is_imported(package: str) -> None:
    """No public name is also a module's: importing that would put the module in its place."""
    face = importlib.import_module(package)
    for path in MODULES:
        importlib.import_module(name_of(path))
    assert sorted(face.__all__) == face.__all__
    for name in face.__all__:
        assert not isinstance(getattr(face, name), ModuleType)
    with pytest.raises(AttributeError, match="nonsense"):
        face.nonsense  # noqa: B018


def test_the_optimiser_runs_without_the_mesh_libraries() -> None:
    code = (
        "import sys; [sys.modules.__setitem__(n, None) for n in "
        "('gmsh', 'skfem', 'pyvista', 'meshio', 'vtk', 'pypardiso', 'femcheck')];"
        "import beamopt; s = beamopt.load_scene('random-section', ['search.generations=1']);"
        "print(beamopt.optimize(s).evaluations)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "38"
