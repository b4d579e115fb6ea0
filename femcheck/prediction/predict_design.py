"""Predicting a design: meshes, a path along every ray, tables, figures."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np

import femcheck.solved.picture as picture
from beamopt.base.arrays import FloatArray
from beamopt.base.processes import processes
from beamopt.plot.style import save_figure
from beamopt.storage.campaign import Campaign, Pool, Progress
from femcheck.continuation.outcome import Status
from femcheck.material.law import Law
from femcheck.mesh.gmsh_section import MeshFailure
from femcheck.mesh.quality import quality_of
from femcheck.prediction.figures import axis_figure, paths_figure
from femcheck.prediction.kept import ray_file, read_ray, write_ray
from femcheck.prediction.options import PredictionOptions
from femcheck.prediction.prediction import Prediction
from femcheck.prediction.ray_trace import RayResult
from femcheck.prediction.rays import rays_of
from femcheck.prediction.tables import tables_of
from femcheck.prediction.work import RayKey, RayWork
from femcheck.solved.case import Solid
from femcheck.solved.folder import CheckFolder
from femcheck.solved.meshes import heights_of, section_meshes
from femcheck.solved.subject import Subject

__all__ = ["predict_design"]

FIGURES = ("paths", "axis")


def predict_design(
    subject: Subject,
    out: Path,
    options: PredictionOptions,
    *,
    workers: int = 1,
    resume: bool = False,
    progress: Progress | None = None,
    pool: Pool = processes,
) -> Prediction:
    """Follow a design of a real material to its 27 pressure combinations, or to where it ends.

    Parameters
    ----------
    out : folder for tables, meshes and figures.
    workers : rays at once; the result does not depend on it.
    resume : go on with what is in `out`.
    progress : called with how many rays are done, how many there are, and what was last.
    pool : makes an executor of that many workers.

    Raises
    ------
    InputError : `out` holds something else, or the material contradicts the design's moduli.

    Examples
    --------
    >>> import femcheck
    >>> from pathlib import Path
    >>> import beamopt
    >>> drawn = beamopt.load_design(str(beamopt.load_scene("gravity").target.file))
    >>> subject = femcheck.sealed_copy("round", drawn, 1.0)
    >>> low = subject.design.model_copy(update={"pressures": (0.0, 1.0, 2.0)})
    >>> quick = femcheck.PredictionOptions(
    ...     poisson_ratio=0.4, layers=2, element="tet4", sizes=femcheck.SectionSizes(factor=9.0)
    ... )
    >>> found = femcheck.predict_design(femcheck.Subject("low", low), Path("predicted"), quick)
    >>> found.unanswered
    0
    """
    law = options.law_for(subject.design.actuator)
    with CheckFolder.open(out, subject, options.question, resume=resume) as folder:
        found = _predicted(subject, folder, options, law, Campaign(workers, pool, progress))
        _write(folder, found)
    return found


def _predicted(
    subject: Subject,
    folder: CheckFolder,
    options: PredictionOptions,
    law: Law,
    campaign: Campaign,
) -> Prediction:
    """Follow what was not followed yet."""
    sections = section_meshes(subject, options)
    if isinstance(sections, MeshFailure):
        return Prediction(subject, options, law, sections, None, {}, (), (), {})
    wound = None if options.wound is None else (options.wound, options.thread)
    heights = heights_of(subject, options)
    solids = {
        mesh: Solid(mesh, section, heights[mesh], options.element, law, options.solver, wound)
        for mesh, section in zip(("standard", "coarse"), sections, strict=True)
    }
    rays, places = rays_of(subject.pressures)
    work = RayWork(solids, rays, options.limits)

    def store(key: RayKey, result: RayResult) -> None:
        write_ray(_file(folder, work, key), result, _digest(solids[key[0]], work, key))

    def text(key: RayKey, result: RayResult) -> str:
        return f"{key[0]}, {rays[key[1]].text}: {result.status.value}"

    def follow() -> Prediction:
        _take_kept(folder, work)
        campaign.solve(work, store, text)
        results = dict(work.results)
        return Prediction(
            subject, options, law, None, quality, solids, tuple(rays), tuple(places), results
        )

    quality = quality_of(subject.outline, sections[0])
    found = follow()
    # no verdict is to stand on one mesh alone
    work.asked = {n for n in found.decisive if not found.result(n).status.is_interrupted}
    return follow()


def _take_kept(folder: CheckFolder, work: RayWork) -> None:
    """Put the rays that were followed before among the results."""
    for key in (key for key in work.keys if key not in work.results):
        kept = read_ray(_file(folder, work, key), _digest(work.solids[key[0]], work, key))
        if kept is not None and kept.is_final(work.limits):
            work.results[key] = kept


def _file(folder: CheckFolder, work: RayWork, key: RayKey) -> Path:
    return ray_file(folder.cases, key[0], work.rays[key[1]].name)


def _digest(solid: Solid, work: RayWork, key: RayKey) -> str:
    """Tells one question from another: mesh, law, winding, ray and its stops."""
    said = f"{solid.digest} {solid.law!r} {work.rays[key[1]]!r}"
    return hashlib.blake2b(said.encode(), digest_size=16).hexdigest()


def _answered(found: Prediction) -> dict[str, FloatArray]:
    """Positions of the nodes at every combination that has an answer, named as a check does."""
    answers = {
        "-".join(f"{value:g}" for value in pressures): found.answer(row)
        for row, pressures in enumerate(found.subject.pressures.tolist())
    }
    return {name: answer.x for name, answer in answers.items() if answer is not None}


def _write(folder: CheckFolder, found: Prediction) -> None:
    """Tables, meshes, figures, and a picture of the last stable shape of what ends first."""
    folder.write(tables_of(found))
    if not found.has_answers or not found.rays:
        folder.without_answer()
        return
    for name, draw in zip(FIGURES, (paths_figure, axis_figure), strict=True):
        ends = [folder.path / f"{name}.{ending}" for ending in ("png", "svg")]
        save_figure(draw(found), *ends)
    lasts = {n: found.result(n).last for n in range(len(found.rays))}
    states = {f"last-{found.rays[n].name}": last.x for n, last in lasts.items() if last}
    folder.write_meshes(found.solids["standard"], states | _answered(found))
    ended = found.first_to_end
    shown = 0 if ended is None else ended
    last = lasts[shown]
    if last is not None and last.load > 0:
        ray, result = found.rays[shown], found.result(shown)
        pressures = last.load * np.array(ray.direction)
        said = f"{found.options.law}, chambers grow to {found.growth(shown):.2g} times"
        if result.status is not Status.CONVERGED:
            said += f"; {result.status.value} at {result.critical:.3g} kPa"
        picture.draw(folder.path, found.subject, found.solids["standard"], last.x, pressures, said)
