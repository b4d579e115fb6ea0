"""Seeded faults: `femcheck regress` fails with each of them, and names the rung that is wrong."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from femcheck.regression.held import LADDER
from tests.validation.check import Check, Row

__all__ = ["FAULTS", "Fault", "checks", "regress"]

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Fault:
    """One wrong line.

    module : where. old, new : its text before and after. rung : the lowest one that is then wrong.
    designs : that are looked at; all that are held if there are none.
    times : how often the text stands in the module.
    """

    name: str
    module: str
    old: str
    new: str
    rung: str
    designs: tuple[str, ...] = ()
    times: int = 1


FAULTS = (
    Fault(
        "a sign in the response",
        "beamopt.rod.response",
        "bend_2 = (-i12 * sy - i11 * sx)",
        "bend_2 = (-i12 * sy + i11 * sx)",
        "response",
    ),
    Fault(
        "transposed inertia",
        "beamopt.section.moments",
        "np.stack([ixx, -ixy], -1), np.stack([-ixy, iyy], -1)",
        "np.stack([iyy, -ixy], -1), np.stack([-ixy, ixx], -1)",
        "section",
    ),
    Fault(
        "linear elements in place of quadratic ones",
        "femcheck.solid.elements",
        'ElementChoice("wedge18", _wedge18, 18, _quadrangles, 2, 4.0, 6, "ElementWedge1", True)',
        'ElementChoice("wedge18", _tetrahedra("ElementTetP1", 1), 4, _triangles, 1, 4.0, 4, '
        '"ElementTetP1", True)',
        "solid, rigid-section",
    ),
    Fault(
        "a winding forgotten",
        "femcheck.solved.case",
        "winding = wind(body, *self.wound) if self.wound else None",
        "winding = None",
        "solid, wound",
    ),
    Fault(
        "a load's frame transposed",
        "beamopt.scene.actuator",
        "to_base = self.mount.T",
        "to_base = self.mount",
        "loads",
    ),
    Fault(
        "a swapped supply",
        "beamopt.rod.response",
        '"...ij,nj->...ni", self.matrix, pressures)',
        '"...ij,nj->...ni", self.matrix, pressures[:, [1, 0, 2]])',
        "raster",
        ("hand_drawn_section", "gravity"),
    ),
    Fault(
        "a wall off by one",
        "beamopt.section.walls",
        "else wall_elements // 2",
        "else wall_elements // 2 + 1",
        "section",
        ("random-section",),
    ),
    Fault(
        "a wrong cap area",
        "femcheck.solid.body",
        "return self.extrusion.section.moments.chamber_areas",
        "return 1.02 * self.extrusion.section.moments.chamber_areas",
        "solid at rest",
        ("round_chambers-sealed",),
    ),
    Fault(
        "the sign of I_xy",
        "beamopt.section.moments",
        "np.stack([ixx, -ixy], -1), np.stack([-ixy, iyy], -1)",
        "np.stack([ixx, ixy], -1), np.stack([ixy, iyy], -1)",
        "section",
        ("sealed_section",),
    ),
    Fault(
        "E and G confused",
        "beamopt.rod.law",
        "bending[:2, :2] = youngs_modulus * moments.second_moments",
        "bending[:2, :2] = shear_modulus * moments.second_moments",
        "rod under load",
        ("gravity",),
    ),
    Fault(
        "the sign of the shear centre",
        "beamopt.rod.law",
        "coupling[2, :2] = -shear_centre[1], shear_centre[0]",
        "coupling[2, :2] = shear_centre[1], -shear_centre[0]",
        "rod under load",
        ("gravity", "tool-at-the-tip"),
    ),
    Fault(
        "the tip's centroid forgotten",
        "beamopt.rod.ladder",
        "np.asarray(position + rotation @ self._beside(section)[-1])",
        "np.asarray(position + 0 * (rotation @ self._beside(section)[-1]))",
        "chain of segments",
        ("two-segments",),
    ),
    Fault(
        "a segment's turn with the wrong sign",
        "beamopt.rod.ladder",
        "np.sin(piece.turned)\n            rest[:, k, :3] = self.curvature",
        "np.sin(-piece.turned)\n            rest[:, k, :3] = self.curvature",
        "chain of segments",
        ("two-segments",),
    ),
    Fault(
        "the tip of the solid from another origin",
        "femcheck.models.solid",
        "else state.tip - self.centroid",
        "else state.tip",
        "solid, rigid-section",
        ("sealed_section",),
    ),
    Fault(
        "a wrong μ",
        "femcheck.material.isotropic",
        "return self.youngs_modulus / (2 * (1 + self.poisson_ratio))",
        "return self.youngs_modulus / 2",
        "solid, compressible",
        ("round_chambers-sealed",),
    ),
    Fault(
        "the pressure's sign on one wall",
        "femcheck.solid.equilibrium",
        "scale = -pressures[body.wall_supply - 1]",
        "scale = -pressures[body.wall_supply - 1] * (1 - 2 * (body.wall_supply == 1))",
        "solid, rigid-section",
        ("round_chambers-sealed",),
        times=2,
    ),
    Fault(
        "only the last chamber of a supply counts",
        "beamopt.outline.outline",
        "raw[chamber.supply] += chamber.integrals",
        "raw[chamber.supply] = chamber.integrals",
        "outline",
        ("random-section-sealed",),
    ),
)
"""The first five on all that is held."""

REDUCED = ("a segment's turn with the wrong sign", "a load's frame transposed")
WHERE = ("--baseline", "reports/baseline", "--meshes", "meshes")
CHEAP = ("two-segments", "gravity")


def regress(fault: Fault | None, designs: tuple[str, ...]) -> tuple[int, str]:
    """Exit code of `femcheck regress` with a fault, or without one; the lowest rung that moved.

    Raises
    ------
    RuntimeError : the text of the fault is not in its module any more.
    """
    text = ("", "", "", "0")
    if fault is not None:
        text = (fault.module, fault.old, fault.new, str(fault.times))
    command = [sys.executable, "-m", "tests.validation.faulty", *text, "regress"]
    done = subprocess.run(
        [*command, *designs, *WHERE, "--workers", "1"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode not in (0, 1):
        raise RuntimeError(done.stderr.strip())
    _, named, said = done.stdout.partition("lowest rung that moved: ")
    longest_first = sorted(LADDER, key=len, reverse=True)
    return done.returncode, next(r for r in longest_first if said.startswith(r)) if named else ""


def checks(full: bool) -> list[Check]:
    """Reduced: two faults that are seen without a solid."""
    chosen = [one for one in FAULTS if full or one.name in REDUCED]
    clean = Check("no fault", partial(_clean_rows, () if full else CHEAP))
    return [clean, *(Check(one.name, partial(_rows, one, full)) for one in chosen)]


def _clean_rows(designs: tuple[str, ...]) -> Iterator[Row]:
    code, rung = regress(None, designs)
    yield Row(f"no fault: exit code{rung}", "the tree as it is", 0, code, 0)


def _rows(fault: Fault, full: bool) -> Iterator[Row]:
    code, rung = regress(fault, fault.designs if full or fault.designs else CHEAP)
    source = f"{fault.module}: {fault.new.splitlines()[0]}"
    yield Row(f"{fault.name}: exit code", source, 1, code, 0)
    said = f"{fault.name}: place on the ladder of the rung named ({rung or 'none'})"
    yield Row(said, fault.rung, LADDER.index(fault.rung), _index(rung), 0)


def _index(rung: str) -> int:
    return LADDER.index(rung) if rung else -1
