"""What a check found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from beamopt.base.brief import Brief
from femcheck.check.comparison import Comparison
from femcheck.check.options import CheckOptions
from femcheck.check.schedule import Key
from femcheck.check.stage import Stage
from femcheck.mesh.gmsh_section import MeshFailure
from femcheck.mesh.quality import Quality
from femcheck.solved.case import CaseResult
from femcheck.solved.subject import GeometrySteps, Subject

if TYPE_CHECKING:
    from pandas import DataFrame

__all__ = ["Checked"]


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
        from femcheck.check.tables import compare_csv

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
