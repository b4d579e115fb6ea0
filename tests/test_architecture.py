"""The house rules, held by a test: which way imports go, and what is loaded when."""

import ast
import importlib
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[1]
MODULES = sorted((ROOT / "beamopt").rglob("*.py")) + sorted((ROOT / "femcheck").rglob("*.py"))

FLOORS = [
    [
        "beamopt.arrays",
        "beamopt.brief",
        "beamopt.public_names",
        "beamopt.errors",
        "beamopt.lost_workers",
        "beamopt.input_file",
        "beamopt.files",
        "beamopt.frames",
        "beamopt.compiled",
        "beamopt.bundled",
        "beamopt.provenance",
        "beamopt.old_wordings",
    ],
    [
        "beamopt.model",
        "beamopt.free_values",
        "beamopt.table",
        "beamopt.folder",
        "beamopt.file_lock",
        "beamopt.scratch",
        "beamopt.line_journal",
        "beamopt.streams",
        "beamopt.timing",
    ],
    ["beamopt.section"],
    ["beamopt.seal", "beamopt.making"],
    ["beamopt.outline"],
    ["beamopt.rod"],
    ["beamopt.workspace", "beamopt.aim", "beamopt.reach"],
    [
        "beamopt.chambers",
        "beamopt.grid_keys",
        "beamopt.actuator",
        "beamopt.climb",
        "beamopt.answers",
        "beamopt.target",
        "beamopt.pairs",
        "beamopt.trajectory",
        "beamopt.target_choice",
        "beamopt.search_settings",
        "beamopt.generation_size",
        "beamopt.judge",
    ],
    ["beamopt.design_keys", "beamopt.design", "beamopt.segment_files", "beamopt.overrides"],
    ["beamopt.scene", "beamopt.scene_text", "beamopt.kept_scene", "beamopt.named"],
    ["beamopt.bound"],
    ["beamopt.chart.comparators"],
    ["beamopt.refine"],
    ["beamopt.refinement"],
    ["beamopt.evolve"],
    ["beamopt.plot"],
    ["beamopt.export"],
    ["beamopt.result", "beamopt.result_tables"],
    [
        "beamopt.run_folder",
        "beamopt.run_summary",
        "beamopt.bound_folder",
        "beamopt.refinement_folder",
    ],
    ["beamopt.optimisation"],
    ["beamopt.study", "beamopt.chart", "beamopt.pareto"],
    ["beamopt.cli"],
    ["femcheck.mesh", "femcheck.material"],
    ["femcheck.assembly"],
    ["femcheck.solid"],
    ["femcheck.continuation"],
    ["femcheck.check", "femcheck.picture"],
    ["femcheck.prediction"],
    ["femcheck.models"],
    ["femcheck.chart"],
    ["femcheck.accuracy", "femcheck.stability", "femcheck.regression"],
    ["femcheck.report"],
    ["femcheck.cli"],
    ["femcheck"],
]
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


def name_of(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def floor_of(module: str) -> int:
    return next(
        k
        for k, floor in enumerate(FLOORS)
        if any(module == part or module.startswith(part + ".") for part in floor)
    )


def imports(path: Path, top_level_only: bool) -> set[str]:
    tree = ast.parse(path.read_text())
    nodes = tree.body if top_level_only else list(ast.walk(tree))
    names: set[str] = set()
    for node in nodes:
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names.add(node.module)
    return names


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_imports_go_down(path: Path) -> None:
    module = name_of(path)
    if module in ("beamopt", "femcheck"):
        return  # a package's face names everything
    for imported in imports(path, top_level_only=False):
        if imported.startswith(("beamopt.", "femcheck")):
            assert floor_of(imported) <= floor_of(module), f"{module} imports {imported}"


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_heavy_libraries_are_imported_where_they_are_used(path: Path) -> None:
    if name_of(path).startswith("beamopt"):
        top = {name.partition(".")[0] for name in imports(path, top_level_only=True)}
        assert not top & HEAVY


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_rooms_are_small_and_named(path: Path) -> None:
    assert len(path.read_text().splitlines()) <= 300
    assert path.stem not in {"utils", "util", "helpers", "common", "misc"}


@pytest.mark.parametrize("package", ["beamopt", "femcheck"])
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


def test_no_circles() -> None:
    """A module's imports, followed as far as they go, never lead back to it."""
    graph = {name_of(path): imports(path, top_level_only=True) for path in MODULES}

    def reached(start: str) -> set[str]:
        seen: set[str] = set()
        waiting = list(graph[start])
        while waiting:
            name = waiting.pop()
            if name in graph and name not in seen and name != "beamopt":
                seen.add(name)
                waiting += graph[name]
        return seen

    assert [name for name in graph if name != "beamopt" and name in reached(name)] == []


def test_the_optimiser_runs_without_the_mesh_libraries() -> None:
    code = (
        "import sys; [sys.modules.__setitem__(n, None) for n in "
        "('gmsh', 'skfem', 'pyvista', 'meshio', 'vtk', 'pypardiso', 'femcheck')];"
        "import beamopt; s = beamopt.load_scene('random-section', ['search.generations=1']);"
        "print(beamopt.optimize(s).evaluations)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "38"
