"""`python -m tests.kernels`: compile the kernels that the tests call, or load those that are kept.

Once, before tests start in several processes, each of which would compile them for itself.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import beamopt
import femcheck
from beamopt.chart.chart import run_chart
from beamopt.chart.measure import TimeLimits

__all__ = ["compile_all"]

QUICK = ("search.generations=1", "search.population=4", "refine.flips=200", "refine.rounds=1")


def compile_all(folder: Path) -> None:
    """Search, refine, bound, chart and solve small things of every kind; files go to `folder`."""
    for name in ("random-section", "hand-drawn-workspace", "sealed-section", "spiral"):
        scene = beamopt.load_scene(name, [*QUICK, "refine.steps=2", "refine.outline_steps=2"])
        found = beamopt.optimize(scene)
        beamopt.refine_design(found.best, scene)
        beamopt.certificate(scene, scene.load_target())
    beamopt.find_front(scene, ["L", "mass", "chambers"], population=4)
    once = TimeLimits(repeats=1, spent=0.0)
    for name in ("gravity", "two-segments"):
        scene = beamopt.load_scene(name, ["rod.method=elements"])
        run_chart(scene, folder / name, limits=once)
        beamopt.Judge.of_scene(scene, scene.load_target())([found.best.points])
    drawn = beamopt.load_design(str(beamopt.load_scene("gravity").target.file))
    subject = femcheck.sealed_copy("round", drawn, 1.0)
    sizes = femcheck.SectionSizes(factor=9.0)
    for law in ("wound", "yeoh", "gent", "mooney-rivlin"):
        options = femcheck.PredictionOptions(law=law, layers=2, sizes=sizes, iterations=20)
        femcheck.predict_design(subject, folder / law, options)
    for element in ("tet4", "tet10", "wedge18", "hex27"):
        check = femcheck.CheckOptions(layers=2, element=element, sizes=sizes, iterations=3)
        femcheck.check_design(subject, folder / element, check)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        compile_all(Path(place))
