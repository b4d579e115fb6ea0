"""Checking a design: outline, meshes, 27 combinations on every solid, comparison, files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import femcheck.solved.picture as picture
from beamopt.base.processes import processes
from beamopt.storage.campaign import Campaign, Pool, Progress
from femcheck.check.checked import Checked
from femcheck.check.comparison import compare
from femcheck.check.kept import read_case, write_case
from femcheck.check.options import CheckOptions
from femcheck.check.schedule import Key, Schedule
from femcheck.check.stage import Stage
from femcheck.check.tables import tables_of
from femcheck.continuation.shape import Shapes
from femcheck.material.rigid_section import RigidSection
from femcheck.mesh.gmsh_section import MeshFailure
from femcheck.mesh.quality import quality_of
from femcheck.mesh.section_mesh import SectionMesh
from femcheck.solved.case import CaseResult, Solid
from femcheck.solved.folder import CheckFolder
from femcheck.solved.meshes import heights_of, section_meshes
from femcheck.solved.subject import Subject, geometry_steps

__all__ = ["check_design"]


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

    Examples
    --------
    >>> import femcheck
    >>> from pathlib import Path
    >>> import beamopt
    >>> drawn = beamopt.load_design(str(beamopt.load_scene("gravity").target.file))
    >>> subject = femcheck.sealed_copy("round", drawn, 1.0)
    >>> quick = femcheck.CheckOptions(
    ...     layers=2, element="tet4", sizes=femcheck.SectionSizes(factor=9.0)
    ... )
    >>> checked = femcheck.check_design(subject, Path("checked"), quick)
    >>> checked.comparison is not None and checked.comparison.unanswered
    0
    """
    with CheckFolder.open(out, subject, options.question, resume=resume) as folder:
        checked = _checked(subject, folder, options, Campaign(workers, pool, progress))
        _write(folder, checked)
    return checked


def _checked(
    subject: Subject, folder: CheckFolder, options: CheckOptions, campaign: Campaign
) -> Checked:
    """Solve what is not solved yet."""
    sections = section_meshes(subject, options)
    if isinstance(sections, MeshFailure):
        return Checked(subject, options, sections, None, None, None, (), {})
    stages = _stages(subject, options, *sections)
    schedule = Schedule(stages, subject.design.pressures, options.limits)
    _take_kept(folder.cases, schedule)
    digests = {stage.name: stage.solid.digest for stage in stages}

    def store(key: Key, result: CaseResult) -> None:
        write_case(folder.cases, key, result, digests[key[0]])

    campaign.solve(schedule, store, lambda key, result: f"{key[0]} {result.status.value}")
    compared = compare(subject, stages, schedule.results)
    geometry = geometry_steps(subject, sections[0])
    quality = quality_of(subject.outline, sections[0])
    return Checked(subject, options, None, compared, geometry, quality, stages, schedule.results)


def _write(folder: CheckFolder, checked: Checked) -> None:
    """Tables, meshes, and the picture of the case with the largest displacement."""
    folder.write(tables_of(checked))
    compared = checked.comparison
    if compared is None:
        folder.without_answer()
        return
    stage = [one for one in checked.stages if one.mesh == "standard"][-1]
    levels = checked.subject.design.pressures
    states = {
        "-".join(f"{levels[index]:g}" for index in node): result.outcome.state.x
        for (name, node), result in checked.results.items()
        if name == stage.name and result.outcome.state is not None
    }
    folder.write_meshes(stage.solid, states)
    solved = ~np.isnan(compared.solid(stage.mesh, stage.penalty).tips[:, 0]) & compared.is_loaded
    if solved.any():
        row = int(np.argmax(np.where(solved, compared.displacement, -1.0)))
        pressures = compared.subject.pressures[row]
        said = (
            f"tip moves {compared.displacement[row]:.1f} mm, "
            f"beam and solid differ by {compared.difference[row]:.3f} mm"
        )
        shown = states["-".join(f"{value:g}" for value in pressures)]
        picture.draw(folder.path, checked.subject, stage.solid, shown, pressures, said)


def _take_kept(folder: Path, schedule: Schedule) -> None:
    """Put the cases that were solved before among the results.

    What a limit ended is solved again, and with it all that builds on it: it began elsewhere then.
    """
    again: set[Key] = set()
    for stage in schedule.stages:
        shapes = Shapes(stage.solid.body())
        for key in (key for key in schedule.keys if key[0] == stage.name):
            known = read_case(folder, key, shapes, stage.solid.digest)
            is_final = known is None or known.is_final(schedule.limits)
            if not is_final or schedule.builds_on(key, again):
                again.add(key)
            elif known is not None:
                schedule.results[key] = known


def _stages(
    subject: Subject, options: CheckOptions, standard: SectionMesh, coarse: SectionMesh
) -> tuple[Stage, ...]:
    """The standard mesh with both penalties, the second led by the first; then the coarse one."""
    stages: list[Stage] = []
    heights = heights_of(subject, options)
    for mesh, section in (("standard", standard), ("coarse", coarse)):
        before = None
        for c in options.penalties:
            law = RigidSection(subject.design.actuator.youngs_modulus, c)
            name = f"{mesh}-c{c:g}"
            solid = Solid(name, section, heights[mesh], options.element, law, options.solver)
            stages.append(Stage(solid, mesh, c, before))
            before = name
    return tuple(stages)
