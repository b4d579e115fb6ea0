"""What a check found."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from beamopt.base.brief import Brief
from beamopt.storage.writing import csv_text
from femcheck.check.comparison import Comparison
from femcheck.check.options import CheckOptions
from femcheck.check.schedule import Key
from femcheck.check.stage import Stage
from femcheck.mesh.gmsh_section import MeshFailure
from femcheck.mesh.quality import Quality
from femcheck.solved.case import CaseResult
from femcheck.solved.cells import COMPARE, both, cells, plain
from femcheck.solved.subject import GeometrySteps, Subject

if TYPE_CHECKING:
    from pandas import DataFrame

__all__ = ["Checked", "compare_csv"]


@dataclass(frozen=True, eq=False)
class Checked:
    """What a check found.

    failure : why there is no solid; what follows is then None or empty.

    Examples
    --------
    >>> import femcheck
    >>> from pathlib import Path
    >>> import beamopt
    >>> drawn = beamopt.load_design(str(beamopt.load_scene("gravity").target.file))
    >>> subject = femcheck.sealed_copy("round", drawn, 1.0)
    >>> without = femcheck.CheckOptions(mesher=femcheck.Mesher("no-such-gmsh"))
    >>> checked: femcheck.Checked = femcheck.check_design(subject, Path("checked"), without)
    >>> checked.holds, checked.failure
    (False, <MeshFailure NO_GMSH: 'no-such-gmsh'>)
    """

    subject: Subject
    options: CheckOptions
    failure: MeshFailure | None
    comparison: Comparison | None
    geometry: GeometrySteps | None
    quality: Quality | None
    stages: tuple[Stage, ...]
    results: dict[Key, CaseResult]

    def __repr__(self) -> str:
        name = Brief(self.subject.name)
        if self.comparison is None:
            return f"<Checked {name}: {Brief(str(self.failure))}>"
        ended = "holds" if self.holds else "does not hold"
        return f"<Checked {name}: {ended}, {self.comparison!r}>"

    def to_frame(self) -> DataFrame:
        """Tips of every solid beside the beam's (`compare.csv`), as a data frame (needs pandas)."""
        from beamopt.storage.frames import frame_of

        return frame_of(compare_csv(self))

    @property
    def certain(self) -> bool:
        """True if what mesh and penalty leave is too small to turn the verdict over."""
        compared = self.comparison
        if compared is None or compared.unanswered:
            return False
        return not compared.moves or abs(compared.worst - self.options.agree) > compared.left

    @property
    def holds(self) -> bool:
        """Whether every loaded case has an answer and agrees."""
        compared = self.comparison
        return (
            compared is not None
            and compared.moves
            and compared.unanswered == 0
            and compared.worst <= self.options.agree
        )


def compare_csv(checked: Checked) -> str:
    """27 rows for every solid, computed (c finite) and extrapolated (c infinite)."""
    compared = checked.comparison
    rows = () if compared is None else _compare_rows(compared, checked.options.law)
    return csv_text(COMPARE, rows)


def _compare_rows(compared: Comparison, law: str) -> Iterator[tuple[object, ...]]:
    subject = compared.subject
    length = subject.design.actuator.length
    beam, displacement = subject.beam_tips, compared.displacement
    for solid in compared.solids:
        difference = np.linalg.norm(solid.tips - beam, axis=1)
        for row, pressures in enumerate(subject.pressures.tolist()):
            moved = displacement[row]
            yield (
                law,
                plain(solid.penalty),
                0.0,  # the law has no Poisson coupling
                solid.mesh,
                *map(plain, pressures),
                *cells(beam[row]),
                *cells(solid.tips[row]),
                *cells([difference[row], difference[row] / length]),
                *cells([difference[row] / moved if moved > 0 else math.nan]),
                *cells(solid.volume_ratios[row]),
                *both(solid.statuses[row]),
            )
