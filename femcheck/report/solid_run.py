"""A check or a prediction, read back from its folder."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError
from beamopt.scene.design import load_design
from beamopt.storage.input_file import read_text
from beamopt.target.workspace import NODES
from femcheck.continuation.ended import Ended
from femcheck.continuation.old_wordings import ended_of
from femcheck.report.content import ReportTable, read_table
from femcheck.report.saved_figure import SavedFigure, read_figures
from femcheck.report.summaries import ProvenanceKeys, SolidSummary, read_keys
from femcheck.solved.subject import LoadedDesignError, Subject

__all__ = ["Combinations", "SolidRun", "read_solid_run"]

AXES = ("x", "y", "z")
SAME = 1e-6  # kPa, between a table's pressures and the design's


@dataclass(frozen=True, eq=False)
class Combinations:
    """27 rows, beam beside solid, in the order of `pressure_grid`.

    length : of the actuator [mm]: where the tip stands without pressure.
    pressures : (27, 3) [kPa]. beam, solid : (27, 3) tips [mm], NaN where the solid has no answer.
    difference : (27,) between them [mm]. share : (27,) of the displacement; both may be NaN.
    volume_ratios : (27, 3) of the chambers to those at rest, or NaN.
    stretch : (27,) largest principal stretch; NaN where the table does not have it.
    texts : (27,) how each ended, as its table says. endings : (27,) the same as statuses; None
    where an older table says what is not known. ends_at : (27,) load at which its path ends [kPa],
    or NaN.
    """

    length: float
    pressures: FloatArray
    beam: FloatArray
    solid: FloatArray
    difference: FloatArray
    share: FloatArray
    volume_ratios: FloatArray
    stretch: FloatArray
    texts: tuple[str, ...]
    endings: tuple[Ended | None, ...]
    ends_at: FloatArray

    @property
    def answered(self) -> NDArray[np.bool_]:
        """(27,) whether the solid has an answer."""
        return np.asarray(~np.isnan(self.solid[:, 0]))

    @property
    def loaded(self) -> NDArray[np.bool_]:
        """(27,) whether any supply has pressure."""
        return np.asarray(self.pressures.any(axis=1))

    @property
    def displacement(self) -> FloatArray:
        """(27,) of the beam's tip [mm]: away from where it stands without pressure."""
        return np.asarray(np.linalg.norm(self.beam - [0.0, 0.0, self.length], axis=1))

    @property
    def solid_displacement(self) -> FloatArray:
        """(27,) of the solid's tip [mm]; NaN without an answer."""
        return np.asarray(np.linalg.norm(self.solid - [0.0, 0.0, self.length], axis=1))

    def ending(self, row: int) -> str:
        """Return the ending of a combination, with its load, for people."""
        ended, at = self.endings[row], float(self.ends_at[row])
        if ended is None or np.isnan(at):
            return self.texts[row]
        return str(replace(ended, load=at))


@dataclass(frozen=True, eq=False)
class SolidRun:
    """A folder of `femcheck run`.

    folder : where it is. summary, provenance : its JSON files.
    subject : the design, its name, its beam.
    combinations : None where there was no solid at all.
    timing, tables : what it cost, and every CSV file. figures : those that stand in the folder.
    design_text : the design file, which tells runs of the same design.
    """

    folder: Path
    summary: SolidSummary
    provenance: ProvenanceKeys
    subject: Subject
    combinations: Combinations | None
    timing: ReportTable
    tables: tuple[ReportTable, ...]
    figures: tuple[SavedFigure, ...]
    design_text: str

    @property
    def is_prediction(self) -> bool:
        """Whether a material was asked about, not the implementation."""
        return self.summary.kind == "prediction"

    @property
    def is_certain(self) -> bool:
        """True if two meshes bear its verdict out; folders that do not say count as such."""
        return self.summary.certain

    @cached_property
    def seconds(self) -> float:
        """Processor time of all cases [s]."""
        whole = [what.endswith(" all") for what in self.timing.column("what")]
        return float(self.timing.numbers("value")[whole].sum())


def read_solid_run(folder: Path) -> SolidRun:
    """Read a check or a prediction.

    Raises
    ------
    InputError : the first file that is missing or damaged, and where.
    """
    summary = read_keys(SolidSummary, folder / "summary.json")
    kind = summary.kind
    subject = _subject(folder, summary.design)
    name = "compare.csv" if kind == "prediction" else "table.csv"
    combinations = None
    if (folder / name).exists() or summary.solids is not None:
        combinations = _combinations(read_table(folder / name), subject, kind == "prediction")
    return SolidRun(
        folder,
        summary,
        read_keys(ProvenanceKeys, folder / "provenance.json"),
        subject,
        combinations,
        read_table(folder / "timing.csv"),
        tuple(read_table(file) for file in sorted(folder.glob("*.csv"))),
        read_figures(folder),
        read_text(folder / "design.json"),
    )


def _subject(folder: Path, name: str) -> Subject:
    file = folder / "design.json"
    try:
        return Subject(name, load_design(file))
    except LoadedDesignError as error:
        raise InputError(file, "", None, str(error)) from None


def _combinations(table: ReportTable, subject: Subject, predicted: bool) -> Combinations:
    if predicted:
        table = table.where("mesh", "standard")
    pressures = table.numbers("p1", "p2", "p3")
    if len(pressures) != NODES:
        said = f"must hold {NODES} combinations (is the file whole?)"
        raise InputError(table.file, "rows", len(pressures), said)
    wrong = np.flatnonzero(~(np.abs(pressures - subject.pressures) <= SAME).all(axis=1))
    if wrong.size:
        at = f"{', '.join(f'{value:g}' for value in subject.pressures[wrong[0]])} kPa"
        place = f"combination {wrong[0] + 1}"
        raise InputError(table.file, place, table.rows[wrong[0]][:3], f"must be at {at}")
    beam = table.numbers(*(f"beam_{axis}" for axis in AXES))
    if np.isnan(beam).any():
        raise InputError(table.file, "beam_x", "", "must be a number in every row")
    solid = table.numbers(*(f"solid_{axis}" for axis in AXES))
    texts, endings = tuple(table.column("status")), _endings(table)
    for row, ended in enumerate(endings):
        if ended is not None and ended.is_found and np.isnan(solid[row]).any():
            raise InputError(table.file, f"combination {row + 1}, solid_x", "", "must be a number")
    difference, share = table.numbers("difference_mm", "difference_of_displacement").T
    names = ("largest_stretch", "ends_at_kpa")
    extra = table.numbers(*names) if predicted else np.full((NODES, 2), np.nan)
    ratios = table.numbers(*(f"volume_ratio_{supply}" for supply in (1, 2, 3)))
    return Combinations(
        subject.design.actuator.length,
        pressures,
        beam,
        solid,
        difference,
        share,
        ratios,
        extra[:, 0],
        texts,
        endings,
        extra[:, 1],
    )


def _endings(table: ReportTable) -> tuple[Ended | None, ...]:
    """Of the column "ended"; an earlier table has texts alone."""
    if "ended" not in table.header:
        return tuple(map(_of_text, table.column("status")))
    endings = []
    for row, key in enumerate(table.column("ended"), 1):
        try:
            endings.append(Ended.of_key(key))
        except ValueError as error:
            raise InputError(table.file, f"combination {row}, ended", key, str(error)) from None
    return tuple(endings)


def _of_text(text: str) -> Ended | None:
    try:
        return ended_of(text)
    except ValueError:
        return None
