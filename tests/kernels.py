"""`python -m tests.kernels`: compile the kernels that the tests call, or load those that are kept.

Once, before tests start in several processes, each of which would compile them for itself.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from pathlib import Path

import numba

import beamopt
import femcheck
from beamopt.base.processes import in_process
from beamopt.chart.chart import run_chart
from beamopt.chart.measure import TimeLimits
from femcheck.material.catalogue import MATERIALS
from femcheck.material.differentiate import differences, random_deformations

__all__ = ["compile_all"]

ROOT = Path(__file__).resolve().parents[1]
STAMP = ROOT / "beamopt" / "__pycache__" / "compiled-for"
QUICK = (
    *("search.generations=1", "search.population=4", "refine.flips=200", "refine.rounds=1"),
    *("refine.steps=2", "refine.outline_steps=2"),
)
ONCE = TimeLimits(seconds=0.0)
"""Of a chart: methods are called once, and not measured."""


def compile_all(folder: Path) -> None:
    """Chart, search, refine, bound and solve small things of every kind; files go to `folder`."""
    for name in ("gravity", "two-segments"):
        run_chart(beamopt.load_scene(name), folder / name, limits=ONCE)
    elements = beamopt.load_scene("gravity", [*QUICK, "rod.method=elements"])
    beamopt.optimize(elements)
    for name in ("random-section", "sealed-section", "spiral"):
        scene = beamopt.load_scene(name, QUICK)
        beamopt.refine_design(beamopt.optimize(scene).best, scene)
        beamopt.certificate(scene, scene.load_target())
    drawn = beamopt.load_design(str(beamopt.load_scene("gravity").target.file))
    subject = femcheck.sealed_copy("round", drawn, 1.0)
    sizes = femcheck.SectionSizes(factor=9.0)
    options = femcheck.PredictionOptions(law="wound", layers=2, sizes=sizes, iterations=2)
    femcheck.predict_design(subject, folder / "wound", options, pool=in_process)
    check = femcheck.CheckOptions(layers=2, element="tet4", sizes=sizes, iterations=2)
    femcheck.check_design(subject, folder / "tet4", check, pool=in_process)
    for name in MATERIALS:
        for ratio in (0.4, 0.5):
            law = femcheck.law_by_name(name, 300.0, ratio)
            differences(law, random_deformations(2, seed=0))


def digest() -> str:
    """A digest of the sources that kernels may stand in, and of where they are kept."""
    state = hashlib.blake2b(digest_size=8)
    state.update(f"{numba.__version__} {os.environ.get('NUMBA_CACHE_DIR', '')}".encode())
    for path in sorted((*ROOT.glob("beamopt/**/*.py"), *ROOT.glob("femcheck/**/*.py"))):
        state.update(path.read_bytes())
    return state.hexdigest()


if __name__ == "__main__":
    if not STAMP.exists() or STAMP.read_text() != digest():
        with tempfile.TemporaryDirectory() as place:
            compile_all(Path(place))
        STAMP.parent.mkdir(exist_ok=True)
        STAMP.write_text(digest())
