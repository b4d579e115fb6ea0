"""What the solid check will stand on loads on this machine; a bare one lacks libraries for it."""

import subprocess
import sys

import pytest

PROBES = {
    "gmsh": "import gmsh; gmsh.initialize(); print(gmsh.option.getString('General.Version'))",
    "pyvista": (
        "import pyvista; p = pyvista.Plotter(off_screen=True, window_size=(64, 64));"
        "p.add_mesh(pyvista.Sphere(), color='red'); print(p.screenshot(return_img=True).max())"
    ),
    "scikit-fem": "import skfem; print(skfem.MeshHex().nelements)",
    "meshio": "import meshio; print(meshio.__version__)",
}


@pytest.mark.parametrize("name", list(PROBES))
def test_loads(name: str) -> None:
    # in a process of its own: a missing library ends in a crash, not an exception
    done = subprocess.run([sys.executable, "-c", PROBES[name]], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-500:]
