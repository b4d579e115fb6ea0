"""Solids as STEP, through the OpenCASCADE kernel that gmsh brings."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from beamopt.base.errors import InputError
from beamopt.export.bodies import ExtrudedFace
from beamopt.export.faces import Contour
from beamopt.storage.scratch import scratch_folder

__all__ = ["NEEDS", "is_installed", "require", "step_text"]

SECONDS = 300.0  # time limit of the kernel
VOLUME_TOLERANCE = 1e-6  # of a solid's volume, between the kernel's and the contours'
KERNEL = Path(__file__).with_name("kernel.py")
SOLID = re.compile(r"(MANIFOLD_SOLID_BREP|BREP_WITH_VOIDS)\(''")
PRODUCT = re.compile(r"PRODUCT\('[^']*',\s*'[^']*'")
DATE = "2000-01-01T00:00:00"  # a file's bytes depend on what is in it alone
NEEDS = {
    "step": ("gmsh", "needs gmsh: pip install 'beamopt[fem]'"),
    "dxf": ("ezdxf", "needs ezdxf: pip install 'beamopt[export]'"),
}
"""By format: the package that it is made with, and what to say where that is missing."""


def require(form: str) -> None:
    """Check that the package of a format is there.

    Raises
    ------
    InputError : it is not installed; says what to install.
    """
    package, said = NEEDS[form]
    if not is_installed(package):
        raise InputError("--format", "", form, f"{said}, or leave {form} out of --format")


def is_installed(package: str) -> bool:
    """Whether a package can be imported, without importing it."""
    try:
        return find_spec(package) is not None
    except ValueError:  # an entry without a specification, as a blocked import has it
        return False


def step_text(solids: Sequence[ExtrudedFace], title: str, seconds: float = SECONDS) -> str:
    """A STEP file (AP214, mm) of solids named as they are, the same bytes for the same solids.

    The kernel runs in a process of its own: it prints, and it may hang or crash. What it built is
    measured, and refused if a volume is not that of the contours.

    Raises
    ------
    InputError : gmsh is not installed, fails, or does not end within `seconds`.
    """
    require("step")
    with scratch_folder() as folder:
        file = folder / "solids.step"
        volumes = _run([_plain(solid) for solid in solids], file, seconds)
        for solid, volume in zip(solids, volumes, strict=True):
            if abs(volume - solid.volume) > VOLUME_TOLERANCE * solid.volume:
                said = f"gmsh made {volume:.6g} mm³ of {solid.volume:.6g}; leave step out"
                raise InputError("step", solid.name, None, said)
        text = file.read_text(encoding="latin-1")
    return _named(text, [solid.name for solid in solids], title)


def _plain(solid: ExtrudedFace) -> dict[str, Any]:
    return {
        "low": solid.low,
        "high": solid.high,
        "contours": [_plain_contour(contour) for contour in solid.contours],
        "cavities": [_plain(cavity) for cavity in solid.cavities],
    }


def _plain_contour(contour: Contour) -> dict[str, Any]:
    """A contour counter-clockwise, as the kernel wants those of holes, too."""
    points = contour.points if contour.area > 0 else contour.points[::-1]
    return {"points": points.tolist(), "radius": contour.radius}


def _run(solids: list[dict[str, Any]], file: Path, seconds: float) -> list[float]:
    try:
        done = subprocess.run(
            # without the script's folder on its path, whose modules' names are common ones
            [sys.executable, "-P", str(KERNEL), str(file)],
            input=json.dumps(solids, allow_nan=False),
            capture_output=True,
            text=True,
            errors="replace",
            timeout=seconds,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise InputError("step", "gmsh", None, f"did not end within {seconds:g} s") from None
    if done.returncode != 0 or not file.exists():
        said = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
        raise InputError("step", "gmsh", None, f"{said}; leave step out of --format")
    return [float(volume) for volume in json.loads(done.stdout.strip().splitlines()[-1])]


def _named(text: str, names: Sequence[str], title: str) -> str:
    """The kernel's text with our names, and without its clock and its counters."""
    header = (
        f"FILE_NAME({_quoted(title)},'{DATE}',(''),(''),'beamopt','beamopt','');\n"
        "FILE_DESCRIPTION(('lengths in mm'),'2;1');"
    )
    before, _, _ = text.partition("FILE_NAME(")
    _, _, description = text.partition("FILE_DESCRIPTION(")
    _, _, after = description.partition(");")
    text = before + header + after
    found = len(SOLID.findall(text))
    if found != len(names):
        said = f"gmsh wrote {found} solids instead of {len(names)}; leave step out of --format"
        raise InputError("step", "", None, said)
    products = iter([title, *names] if len(names) > 1 else [title])
    text = PRODUCT.sub(lambda _: _product(products), text)
    solids = iter(names)
    return SOLID.sub(lambda solid: f"{solid[1]}({_quoted(next(solids))}", text)


def _product(names: Iterator[str]) -> str:
    name = _quoted(next(names, "part"))
    return f"PRODUCT({name},{name}"


def _quoted(text: str) -> str:
    r"""Text as STEP has it: an apostrophe doubled, \X2\....\X0\ for what is beyond ASCII."""

    def escaped(character: str) -> str:
        if character in "'\\":
            return character * 2
        if " " <= character <= "~":
            return character
        return rf"\X2\{character.encode('utf-16-be', 'replace').hex().upper()}\X0" + "\\"

    return "'" + "".join(map(escaped, text)) + "'"
