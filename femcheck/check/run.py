"""Checking a design: outline, meshes, 27 combinations on every solid, comparison, files."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path

import femcheck.picture as picture
from beamopt.study.pool import processes
from femcheck.check.case import CaseResult, Solid
from femcheck.check.checked import Checked
from femcheck.check.comparison import compare
from femcheck.check.folder import CheckFolder
from femcheck.check.kept import read_case, write_case
from femcheck.check.options import CheckOptions
from femcheck.check.schedule import Key, Schedule, solve_all
from femcheck.check.stage import Stage, layers_for
from femcheck.check.subject import Subject, geometry_steps
from femcheck.continuation.outcome import Status
from femcheck.continuation.shape import Shapes
from femcheck.material.rigid_section import RigidSection
from femcheck.mesh.extrusion import stations
from femcheck.mesh.gmsh_section import MeshFailure, MeshProblem
from femcheck.mesh.quality import quality_of
from femcheck.mesh.section_mesh import SectionMesh

__all__ = ["check_design"]

AGAIN = (Status.STOPPED, Status.TIME_OUT)  # a check that goes on tries these once more
COARSER = 1.6  # sizes of the coarse section mesh over those of the standard one

Progress = Callable[[int, int, str], None]
Pool = Callable[[int], AbstractContextManager[Executor]]


def check_design(
    subject: Subject,
    out: Path,
    options: CheckOptions,
    *,
    workers: int = 1,
    resume: bool = False,
    progress: Progress | None = None,
    pool: Pool = processes,
) -> Checked:
    """Solve the solid of a design at its 27 pressures and compare its tips with the beam's.

    Parameters
    ----------
    out : folder for tables, meshes and figures.
    workers : cases at once; the result does not depend on it.
    resume : go on with what is in `out`.
    progress : called with how many cases are done, how many there are, and what was last.
    pool : makes an executor of that many workers.

    Raises
    ------
    InputError : `out` holds something else, or can not be written.
    """
    folder = CheckFolder.open(out, subject, options, resume=resume)
    sections = _sections(subject, options)
    if isinstance(sections, MeshFailure):
        checked = Checked(subject, options, sections, None, None, None, (), {})
        folder.write(checked)
        return checked
    stages = _stages(subject, options, *sections)
    schedule = Schedule(stages, subject.design.pressures, options.seconds)
    _take_kept(folder.cases, schedule)
    total = len(schedule.keys)
    digests = {stage.name: stage.solid.digest for stage in stages}

    def keep(key: Key, result: CaseResult) -> None:
        write_case(folder.cases, key, result, digests[key[0]])
        if progress is not None:
            progress(len(schedule.results), total, f"{key[0]} {result.status.value}")

    if progress is not None:
        progress(len(schedule.results), total, "starting")
    solve_all(schedule, lambda: pool(workers), workers, keep)
    compared = compare(subject, stages, schedule.results)
    geometry = geometry_steps(subject, sections[0])
    quality = quality_of(subject.outline, sections[0])
    checked = Checked(subject, options, None, compared, geometry, quality, stages, schedule.results)
    folder.write(checked)
    picture.draw(folder.path, checked)
    return checked


def _take_kept(folder: Path, schedule: Schedule) -> None:
    """Put the cases that were solved before among the results."""
    for stage in schedule.stages:
        shapes = Shapes(stage.solid.body())
        for key in (key for key in schedule.keys if key[0] == stage.name):
            known = read_case(folder, key, shapes, stage.solid.digest)
            if known is not None and known.status not in AGAIN:
                schedule.results[key] = known


def _sections(
    subject: Subject, options: CheckOptions
) -> tuple[SectionMesh, SectionMesh] | MeshFailure:
    """The standard and the coarse section mesh."""
    fatal = subject.fatal
    if fatal is not None:
        return MeshFailure(MeshProblem.FATAL, str(fatal))
    standard = options.mesher.mesh(subject.outline, options.sizes)
    if isinstance(standard, MeshFailure):
        return standard
    sizes = replace(options.sizes, factor=COARSER * options.sizes.factor)
    coarse = options.mesher.mesh(subject.outline, sizes)
    return coarse if isinstance(coarse, MeshFailure) else (standard, coarse)


def _stages(
    subject: Subject, options: CheckOptions, standard: SectionMesh, coarse: SectionMesh
) -> tuple[Stage, ...]:
    """The standard mesh with both penalties, the second led by the first; then the coarse one."""
    length = subject.design.actuator.length
    slenderness = length / subject.design.grid.outer_radius
    layers = options.layers or layers_for(subject.largest_turn, slenderness)
    fewer = max(layers - max(layers // 3, 1), 1)
    stages: list[Stage] = []
    for mesh, section, count in (("standard", standard, layers), ("coarse", coarse, fewer)):
        heights = stations(length, count, options.grading)
        before = None
        for c in options.penalties:
            law = RigidSection(subject.design.actuator.youngs_modulus, c)
            name = f"{mesh}-c{c:g}"
            solid = Solid(name, section, heights, options.element, law, options.solver)
            stages.append(Stage(solid, mesh, c, before))
            before = name
    return tuple(stages)
