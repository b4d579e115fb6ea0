"""The commands and their options; what they do is imported when they run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from beamopt.cli.endings import finish
from beamopt.cli.options import Resume, Workers, new_program

__all__ = ["app", "run"]

app = new_program(
    "beamopt", "Find the cross-section of a soft pneumatic actuator for a target workspace."
)

SceneName = Annotated[str, typer.Argument(help="Scene file, or the name of a bundled scene.")]
DesignName = Annotated[
    str,
    typer.Argument(
        metavar="DESIGN|RUN|SCENE", help="Design file, run folder, or scene: its target's section."
    ),
]
Seed = Annotated[int | None, typer.Option(min=0, help="Seed; replaces the scene's.")]
Overrides = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Replace a key, as search.generations=20."),
]


@app.command()
def optimize(
    scene: SceneName,
    out: Annotated[
        Path | None, typer.Option(help="Run folder; runs/SCENE-SEED if left out.")
    ] = None,
    seed: Seed = None,
    workers: Workers = 1,
    resume: Resume = False,
    refine: Annotated[
        bool, typer.Option("--refine", help="Refine the best design in the end.")
    ] = False,
    overrides: Overrides = None,
) -> None:
    """Search for the section whose workspace is nearest to the scene's target."""
    from beamopt.cli.optimize import optimize_command

    finish = ["refine.finish=true"] if refine else []
    optimize_command(scene, out, seed, workers, resume, [*(overrides or []), *finish])


@app.command()
def refine(
    subject: Annotated[
        Path, typer.Argument(metavar="RUN|DESIGN|SCENE", help="Run folder, design file, or scene.")
    ],
    scene: Annotated[str | None, typer.Option(help="For a design file: target and rules.")] = None,
    out: Annotated[Path | None, typer.Option(help="For a design file; NAME-refined.")] = None,
    overrides: Overrides = None,
) -> None:
    """Anneal a design's types and move its points until its loss is as low as that gets."""
    from beamopt.cli.refine import refine_command

    refine_command(subject, scene, out, overrides or [])


@app.command()
def study(
    out: Annotated[Path, typer.Option(help="Folder of the study.")],
    iterations: Annotated[int, typer.Option(min=1, max=1000, help="Runs of each kind.")] = 4,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the first iteration.")] = 0,
    workers: Workers = 1,
    resume: Resume = False,
    target: Annotated[
        list[str] | None, typer.Option(help="Bundled scene, repeated; the paper's three.")
    ] = None,
    refine: Annotated[bool, typer.Option(help="Refine the best design of each.")] = True,
    overrides: Overrides = None,
) -> None:
    """Repeat the paper's table: three targets, four methods, several initial populations."""
    from beamopt.cli.study import study_command
    from beamopt.study.plan import TARGETS, Plan

    targets = tuple(target or TARGETS)
    plan = Plan(iterations, seed, tuple(overrides or []), targets, refine)
    study_command(out, plan, workers, resume)


@app.command()
def pareto(
    scene: SceneName,
    objectives: Annotated[
        str, typer.Option(metavar="L,…", help="L and one or more of ratio, mass, chambers.")
    ],
    out: Annotated[
        Path | None, typer.Option(help="Folder; fronts/SCENE-OBJECTIVES-SEED if left out.")
    ] = None,
    seed: Seed = None,
    generations: Annotated[
        int | None, typer.Option(min=0, max=1_000_000, help="Replaces the scene's.")
    ] = None,
    population: Annotated[int, typer.Option(min=4, max=10_000, help="Of a generation.")] = 100,
    workers: Workers = 1,
    resume: Resume = False,
    overrides: Overrides = None,
) -> None:
    """Search for designs of which none is better than another in all of several objectives."""
    from beamopt.cli.pareto import pareto_command

    replaced = {"search.seed": seed, "search.generations": generations}
    own = [f"{key}={value}" for key, value in replaced.items() if value is not None]
    pareto_command(scene, objectives, out, [*(overrides or []), *own], population, workers, resume)


@app.command()
def tips(
    design: DesignName,
    pressures: Annotated[
        list[str] | None,
        typer.Option(metavar="P1,P2,P3", help="One combination in kPa; repeat for more."),
    ] = None,
    as_csv: Annotated[bool, typer.Option("--csv", help="Print p1,p2,p3,x,y,z with all digits.")] = (
        False
    ),
) -> None:
    """Print a design's tips in mm, at its 27 pressure combinations or at given ones."""
    from beamopt.cli.tips import tips_command

    tips_command(design, pressures or [], as_csv)


@app.command()
def reach(
    design: DesignName,
    path: Annotated[
        Path, typer.Argument(metavar="PATH.csv", help="Trajectory: a poly-line x,y,z in mm.")
    ],
    as_csv: Annotated[bool, typer.Option("--csv", help="Print a table with all digits.")] = False,
    tolerance: Annotated[
        float, typer.Option(metavar="MM", help="Within which a point is reached.")
    ] = 0.1,
    step: Annotated[float, typer.Option(metavar="MM", help="Largest distance of points.")] = 5.0,
) -> None:
    """Find the pressures that bring a design's tip along a trajectory; exit code 1 if none do."""
    from beamopt.cli.reach import reach_command

    reach_command(design, path, as_csv, tolerance, step)


@app.command()
def show(
    design: DesignName,
    out: Annotated[
        Path | None,
        typer.Option(help="Figure to write (.png, .svg, .pdf); NAME.png here if left out."),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Write over a file that is no such figure.")
    ] = False,
) -> None:
    """Draw a design's section beside its workspace, and the section in the terminal."""
    from beamopt.cli.show import show_command

    show_command(design, out, force=force)


@app.command()
def export(
    design: DesignName,
    out: Annotated[Path | None, typer.Option(help="Folder; NAME-export here if left out.")] = None,
    formats: Annotated[
        str | None,
        typer.Option("--format", metavar="step,stl,svg,dxf", help="All that it can if left out."),
    ] = None,
    cap: Annotated[
        float, typer.Option(metavar="MM", help="Closed plates at both ends; 0: open.")
    ] = 0.0,
    tolerance: Annotated[
        float | None, typer.Option(metavar="MM", help="Of edges; the design's own if left out.")
    ] = None,
) -> None:
    """Write the body and its mould as STEP and STL, and a 1:1 drawing as SVG and DXF."""
    from beamopt.cli.export import export_command

    export_command(design, out, formats, cap, tolerance)


@app.command()
def bound(
    subject: Annotated[
        str,
        typer.Argument(
            metavar="TARGET|SCENE|RUN", help="Scene, run folder, table (.csv) or design (.json)."
        ),
    ],
    out: Annotated[
        Path | None, typer.Option(help="Folder for numbers, ideal tips and figures.")
    ] = None,
    work: Annotated[
        float | None, typer.Option(help="Most tips to compute [millions]; left out: 500.")
    ] = None,
    overrides: Overrides = None,
) -> None:
    """Say how low the loss L can be at all, whatever the section."""
    from beamopt.cli.bound import bound_command

    bound_command(subject, out, work, overrides or [])


@app.command()
def chart(
    scene: SceneName,
    out: Annotated[
        Path | None, typer.Option(help="Folder of the chart; charts/SCENE if left out.")
    ] = None,
    seed: Annotated[
        int | None, typer.Option(min=0, help="Of a random section instead of the target's.")
    ] = None,
    overrides: Overrides = None,
) -> None:
    """Error against time of all methods for rods under loads, on a scene's 27 tips."""
    from beamopt.cli.chart import chart_command

    chart_command(scene, out, seed, overrides or [])


@app.command()
def stability(
    out: Annotated[Path, typer.Option(help="Folder of the map.")] = Path("stability"),
    samples: Annotated[
        int, typer.Option(min=1, max=1_000_000, help="Random sections under random loads.")
    ] = 1000,
    workers: Workers = 2,
    seed: Annotated[int, typer.Option(min=0, help="Seed of sections and loads.")] = 0,
    resume: Resume = False,
) -> None:
    """Map where each method for rods under loads is right, wrong, or gives up."""
    from beamopt.cli.stability import stability_command

    stability_command(out, samples, workers, seed, resume)


@app.command()
def rung(
    subject: Annotated[
        str, typer.Argument(metavar="SCENE|DESIGN|RUN", help="Scene, design file or run folder.")
    ],
    overrides: Overrides = None,
) -> None:
    """Say how its rod is solved (arc, chain or loaded), and why no lower rung will do."""
    from beamopt.cli.rung import rung_command

    rung_command(subject, overrides or [])


@app.command()
def scenes() -> None:
    """List the bundled scenes."""
    from beamopt.cli.scenes import scenes_command

    scenes_command()


@app.command()
def init(
    file: Annotated[Path, typer.Argument(help="Scene file to write.")],
    scene: Annotated[str | None, typer.Option(help="Bundled scene to start from.")] = None,
) -> None:
    """Write a commented scene file with every key."""
    from beamopt.cli.scenes import init_command

    init_command(file, scene)


def run(arguments: Sequence[str]) -> int:
    """Run one command; returns the exit code."""
    return finish(app, "beamopt", arguments)
