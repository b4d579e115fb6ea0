"""`python -m tests.faults [NAME …]`: seeded faults, each caught by one quick test file.

Without names all are put in, one after the other, and reports/validation/faults.csv says which test
failed first. Exit code 1: a fault that no test of its file notices.
"""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from beamopt.storage.writing import csv_text, write_atomic

__all__ = ["FAULTS", "Fault", "with_fault"]

ROOT = Path(__file__).resolve().parents[1]
TABLE = ROOT / "reports" / "validation" / "faults.csv"
HEADER = "fault,module,test_file,first_test_that_fails,verdict"
NOT_CAUGHT = "not caught"
QUIETLY = ("-q", "-x", "-rf", "-p", "no:cacheprovider", "--assert=plain")
"""Without pytest's own import of the plugin's package, which would load it without the fault."""


@dataclass(frozen=True)
class Fault:
    """One wrong line.

    module : where. old, new : its text before and after. caught_by : a test file that fails then.
    rung : the lowest one that `femcheck regress` finds moved; "" where it is asked nothing.
    designs : that it looks at; all that are held if there are none.
    times : how often the text stands in the module.
    """

    name: str
    module: str
    old: str
    new: str
    caught_by: str
    rung: str = ""
    designs: tuple[str, ...] = ()
    times: int = 1


FAULTS = (
    Fault(
        "a sign in the response",
        "beamopt.rod.response",
        "bend_2 = (-i12 * sy - i11 * sx)",
        "bend_2 = (-i12 * sy + i11 * sx)",
        "tests/beamopt/rod/test_response.py",
        rung="response",
    ),
    Fault(
        "transposed inertia",
        "beamopt.section.moments",
        "np.stack([ixx, -ixy], -1), np.stack([-ixy, iyy], -1)",
        "np.stack([iyy, -ixy], -1), np.stack([-ixy, ixx], -1)",
        "tests/beamopt/section/test_moments.py",
        rung="section",
    ),
    Fault(
        "linear elements in place of quadratic ones",
        "femcheck.solid.elements",
        'ElementChoice("wedge18", _wedge18, 18, _quadrangles, 2, 4.0, 6, "ElementWedge1", True)',
        'ElementChoice("wedge18", _tetrahedra("ElementTetP1", 1), 4, _triangles, 1, 4.0, 4, '
        '"ElementTetP1", True)',
        "tests/femcheck/solved/test_case.py",
        rung="solid, rigid-section",
    ),
    Fault(
        "a winding forgotten",
        "femcheck.solved.case",
        "winding = wind(body, *self.wound) if self.wound else None",
        "winding = None",
        "tests/femcheck/solved/test_case.py",
        rung="solid, wound",
    ),
    Fault(
        "a load's frame transposed",
        "beamopt.scene.actuator",
        "to_base = self.mount.T",
        "to_base = self.mount",
        "tests/beamopt/scene/test_actuator.py",
        rung="loads",
    ),
    Fault(
        "a swapped supply",
        "beamopt.rod.response",
        '"...ij,nj->...ni", self.matrix, pressures)',
        '"...ij,nj->...ni", self.matrix, pressures[:, [1, 0, 2]])',
        "tests/beamopt/rod/test_response.py",
        rung="raster",
        designs=(
            "hand_drawn_section",
            "gravity",
        ),
    ),
    Fault(
        "a wall off by one",
        "beamopt.section.walls",
        "else wall_elements // 2",
        "else wall_elements // 2 + 1",
        "tests/beamopt/section/test_walls.py",
        rung="section",
        designs=("random-section",),
    ),
    Fault(
        "a wrong cap area",
        "femcheck.solid.body",
        "return self.extrusion.section.moments.chamber_areas",
        "return 1.02 * self.extrusion.section.moments.chamber_areas",
        "tests/femcheck/solid/test_equilibrium.py",
        rung="solid at rest",
        designs=("round_chambers-sealed",),
    ),
    Fault(
        "the sign of I_xy",
        "beamopt.section.moments",
        "np.stack([ixx, -ixy], -1), np.stack([-ixy, iyy], -1)",
        "np.stack([ixx, ixy], -1), np.stack([ixy, iyy], -1)",
        "tests/beamopt/section/test_moments.py",
        rung="section",
        designs=("sealed_section",),
    ),
    Fault(
        "E and G confused",
        "beamopt.rod.law",
        "bending[:2, :2] = youngs_modulus * moments.second_moments",
        "bending[:2, :2] = shear_modulus * moments.second_moments",
        "tests/beamopt/rod/test_law.py",
        rung="rod under load",
        designs=("gravity",),
    ),
    Fault(
        "the sign of the shear centre",
        "beamopt.rod.law",
        "coupling[2, :2] = -shear_centre[1], shear_centre[0]",
        "coupling[2, :2] = shear_centre[1], -shear_centre[0]",
        "tests/beamopt/rod/test_law.py",
        rung="rod under load",
        designs=(
            "gravity",
            "tool-at-the-tip",
        ),
    ),
    Fault(
        "the tip's centroid forgotten",
        "beamopt.rod.ladder",
        "np.asarray(position + rotation @ self._beside(section)[-1])",
        "np.asarray(position + 0 * (rotation @ self._beside(section)[-1]))",
        "tests/beamopt/scene/test_loaded_scenes.py",
        rung="chain of segments",
        designs=("two-segments",),
    ),
    Fault(
        "a segment's turn with the wrong sign",
        "beamopt.rod.ladder",
        "np.sin(piece.turned)\n            rest[:, k, :3] = self.curvature",
        "np.sin(-piece.turned)\n            rest[:, k, :3] = self.curvature",
        "tests/beamopt/scene/test_loaded_scenes.py",
        rung="chain of segments",
        designs=("two-segments",),
    ),
    Fault(
        "the tip of the solid from another origin",
        "femcheck.models.solid",
        "else state.tip - self.centroid",
        "else state.tip",
        "tests/femcheck/models/test_solid.py",
        rung="solid, rigid-section",
        designs=("sealed_section",),
    ),
    Fault(
        "a wrong μ",
        "femcheck.material.isotropic",
        "return self.youngs_modulus / (2 * (1 + self.poisson_ratio))",
        "return self.youngs_modulus / 2",
        "tests/femcheck/material/test_isotropic.py",
        rung="solid, compressible",
        designs=("round_chambers-sealed",),
    ),
    Fault(
        "the pressure's sign on one wall",
        "femcheck.solid.equilibrium",
        "scale = -pressures[body.wall_supply - 1]",
        "scale = -pressures[body.wall_supply - 1] * (1 - 2 * (body.wall_supply == 1))",
        "tests/femcheck/solid/test_equilibrium.py",
        rung="solid, rigid-section",
        designs=("round_chambers-sealed",),
        times=2,
    ),
    Fault(
        "only the last chamber of a supply counts",
        "beamopt.outline.outline",
        "raw[chamber.supply] += chamber.integrals",
        "raw[chamber.supply] = chamber.integrals",
        "tests/beamopt/outline/test_build.py",
        rung="outline",
        designs=("random-section-sealed",),
    ),
    Fault(
        "one stream of random numbers for all individuals",
        "beamopt.base.random_streams",
        "key = (int(purpose), generation, index)",
        "key = (int(purpose), generation, 0)",
        "tests/beamopt/search/test_algorithm.py",
    ),
    Fault(
        "a digest that is not compared",
        "beamopt.storage.line_journal",
        "if _digest(text) != found[2]:",
        "if False:",
        "tests/beamopt/storage/test_line_journal.py",
    ),
    Fault(
        "the weights of tips forgotten",
        "beamopt.target.aim",
        "parts = self.weights[:, None] * (tips - self.tips) ** 2",
        "parts = (tips - self.tips) ** 2",
        "tests/beamopt/target/test_point_table.py",
    ),
    Fault(
        "the best start of another point",
        "beamopt.reach.inverse",
        "(rows * count + best)[better]",
        "(rows + best)[better]",
        "tests/beamopt/reach/test_arc_inverse.py",
    ),
    Fault(
        "a tolerance of collocation a thousandfold",
        "beamopt.comparators.collocation",
        "self.tolerance = 10.0**-resolution",
        "self.tolerance = 10.0 ** (3 - resolution)",
        "tests/beamopt/comparators/test_known.py",
    ),
    Fault(
        "the second objective with the wrong sign",
        "beamopt.judge.judge",
        "return self.L + self.K + self.R",
        "return self.L - self.K + self.R",
        "tests/beamopt/judge/test_judge.py",
    ),
    Fault(
        "errors of nothing drawn",
        "beamopt.plot.error_chart",
        "shown = np.isfinite(line.errors) & (line.errors > SMALLEST)",
        "shown = np.isfinite(line.errors)",
        "tests/beamopt/plot/test_charts.py",
    ),
    Fault(
        "a rest curvature with the wrong sign",
        "beamopt.bound.wanted",
        "strains[:, 1:] += self.curvature",
        "strains[:, 1:] -= self.curvature",
        "tests/beamopt/bound/test_response.py",
    ),
    Fault(
        "the smallest error in place of the largest",
        "beamopt.chart.measure",
        "return float(known.max()) if known.size else np.nan",
        "return float(known.min()) if known.size else np.nan",
        "tests/beamopt/chart/test_chart.py",
    ),
    Fault(
        "normals that point inwards",
        "beamopt.export.stl",
        'records["normal"] = np.divide(normal, size',
        'records["normal"] = np.divide(-normal, size',
        "tests/beamopt/export/test_solids.py",
    ),
    Fault(
        "an image's slope turned the wrong way",
        "beamopt.refine.orbits",
        'np.einsum("gd...,dc->gc..."',
        'np.einsum("gd...,cd->gc..."',
        "tests/beamopt/refine/test_orbits.py",
    ),
    Fault(
        "tips compared as a share of nothing but the length",
        "beamopt.rod_map.verdict",
        "max(length, float(np.linalg.norm(other)))",
        "length",
        "tests/beamopt/rod_map/test_stability.py",
    ),
    Fault(
        "no way round the ring",
        "beamopt.search.recombination",
        "away = np.minimum(away, 2 * np.pi - away)",
        "away = np.maximum(away, 0.0)",
        "tests/beamopt/search/test_recombination.py",
    ),
    Fault(
        "one better objective beats",
        "beamopt.pareto.scores",
        "(values[m] <= values[k]).all()",
        "(values[m] <= values[k]).any()",
        "tests/beamopt/pareto/test_scores.py",
    ),
    Fault(
        "the best run by another loss",
        "beamopt.study.table",
        "by_loss = sorted(mine, key=lambda one: one.final.L)",
        "by_loss = sorted(mine, key=lambda one: -one.final.L)",
        "tests/beamopt/study/test_study.py",
    ),
    Fault(
        "a lost case outweighs a verdict",
        "beamopt.cli.exit_codes",
        "if ExitCode.DOES_NOT_HOLD in found:",
        "if found == {ExitCode.DOES_NOT_HOLD}:",
        "tests/femcheck/cli/test_verdicts.py",
    ),
    Fault(
        "the plate's diagonal counted twice",
        "femcheck.assembly.reduction",
        "half + half.T - diagonal + plate",
        "half + half.T + plate",
        "tests/femcheck/solid/test_equilibrium.py",
    ),
    Fault(
        "layers graded the wrong way",
        "femcheck.mesh.extrusion",
        "thickness = grading ** (from_end / most)",
        "thickness = grading ** (-from_end / most)",
        "tests/femcheck/mesh/test_section.py",
    ),
    Fault(
        "a predictor that adds the corner",
        "femcheck.continuation.pressure_tree",
        "(-1.0, both)]",
        "(1.0, both)]",
        "tests/femcheck/continuation/test_pressure_tree.py",
    ),
    Fault(
        "extrapolation towards the softer solid",
        "femcheck.check.comparison",
        "tips = high.tips + ratio * (high.tips - low.tips)",
        "tips = high.tips - ratio * (high.tips - low.tips)",
        "tests/femcheck/check/test_check.py",
    ),
    Fault(
        "limits and losses confused",
        "femcheck.prediction.verdict",
        "said = _answered(found) if found.unanswered == 0 else _unanswered(found)",
        "said = _answered(found)",
        "tests/femcheck/prediction/test_verdict.py",
    ),
    Fault(
        "positions rounded down",
        "femcheck.report.packing",
        "steps = np.rint((points - np.array(self.offset)) / self.step)",
        "steps = np.floor((points - np.array(self.offset)) / self.step)",
        "tests/femcheck/report/test_shapes.py",
    ),
    Fault(
        "a crossing on the wrong side",
        "femcheck.stability.validity",
        "a @ a - radius**2",
        "a @ a + radius**2",
        "tests/femcheck/stability/test_validity.py",
    ),
    Fault(
        "an order one too high",
        "femcheck.chart.reference",
        "limit = tips + change / (finer**order - 1)",
        "limit = tips + change / (finer ** (order + 1) - 1)",
        "tests/femcheck/chart/test_reference.py",
    ),
    Fault(
        "errors scaled by the square of the turn",
        "femcheck.accuracy.knowledge",
        "return max(length * turn**4, 1e-3)",
        "return max(length * turn**2, 1e-3)",
        "tests/femcheck/accuracy/test_knowledge.py",
    ),
    Fault(
        "a missing number has not moved",
        "femcheck.regression.moved",
        "return math.inf if math.isnan(distance) else distance",
        "return 0.0 if math.isnan(distance) else distance",
        "tests/femcheck/regression/test_moved.py",
    ),
    Fault(
        "an answer not reached holds",
        "femcheck.cli.verdicts",
        "return ExitCode.NOT_COMPUTED if unknown else ExitCode.HOLDS",
        "return ExitCode.HOLDS",
        "tests/femcheck/cli/test_verdicts.py",
    ),
)
"""The first five are looked for on all that is held."""


def with_fault(fault: Fault | None, *command: str) -> subprocess.CompletedProcess[str]:
    """Run `pytest …` or `femcheck …` with a fault, or without one.

    Raises
    ------
    RuntimeError : the text of the fault is not in its module any more.
    """
    text = ("", "", "", "0")
    if fault is not None:
        text = (fault.module, fault.old, fault.new, str(fault.times))
    done = subprocess.run(
        [sys.executable, "-m", "tests.validation.faulty", *text, *command],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{done.stdout[-2000:]}{done.stderr.strip()}")
    return done


def first_failure(fault: Fault) -> str:
    """The first test of the fault's file that fails with it; NOT_CAUGHT where all pass."""
    done = with_fault(fault, "pytest", *QUIETLY, fault.caught_by)
    failed = re.search(r"^FAILED \S+?::(\w+)", done.stdout, re.MULTILINE)
    return failed[1] if done.returncode == 1 and failed else NOT_CAUGHT


def main(names: list[str]) -> int:
    unknown = set(names) - {one.name for one in FAULTS}
    if unknown:
        print(f"faults: no fault {unknown.pop()!r}", file=sys.stderr)
        return 2
    rows = []
    for fault in (one for one in FAULTS if not names or one.name in names):
        test = first_failure(fault)
        verdict = "fails" if test == NOT_CAUGHT else "holds"
        rows.append((fault.name, fault.module, fault.caught_by, test, verdict))
        print(f"{fault.name}: {test}", flush=True)
    if not names:
        write_atomic(TABLE, csv_text(HEADER, rows))
    caught = sum(row[-1] == "holds" for row in rows)
    print(f"{caught} of {len(rows)} faults are caught")
    return int(caught < len(rows))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
