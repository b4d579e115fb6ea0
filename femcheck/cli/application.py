"""The commands and their options; what they do is imported when they run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from beamopt.cli.endings import finish
from beamopt.cli.options import Resume, Workers, new_program
from femcheck.cli.option_types import (
    Constants,
    Law,
    Nu,
    Seal,
    Slenderness,
    Wind,
    Winding,
)

__all__ = ["app", "run"]

app = new_program("femcheck", "Check a section found with the beam as a solid under pressure.")


@app.command(name="run")
def run_designs(
    designs: Annotated[
        list[str],
        typer.Argument(metavar="DESIGN|RUN|SCENE…", help="Design files, run folders or scenes."),
    ],
    out: Annotated[
        Path | None, typer.Option(help="Folder for the results; checks/NAME if left out.")
    ] = None,
    agree: Annotated[
        str,
        typer.Option(help="Largest difference allowed, as a share of the tip's displacement."),
    ] = "5%",
    law: Law = "rigid-section",
    nu: Nu = None,
    constant: Constants = None,
    wind: Wind = None,
    winding: Winding = None,
    seal: Seal = None,
    slenderness: Slenderness = None,
    workers: Workers = 2,
    layers: Annotated[
        int | None, typer.Option(help="Layers, 2…64; as many as its bending needs if left out.")
    ] = None,
    size: Annotated[
        float, typer.Option(help="Size of the triangles, 0.1…10; below 1 is finer.")
    ] = 1.0,
    element: Annotated[
        str, typer.Option(help="wedge18; hex27, tet10 and tet4 to compare.")
    ] = "wedge18",
    solver: Annotated[str, typer.Option(help="auto, pardiso or superlu.")] = "auto",
    iterations: Annotated[
        int,
        typer.Option(min=1, help="Work limit of one case or ray: Newton's iterations."),
    ] = 2000,
    seconds: Annotated[
        float, typer.Option(metavar="S", help="Clock limit of one case besides; none if left out.")
    ] = math.inf,
    gmsh: Annotated[
        str | None, typer.Option(help="The gmsh executable; found by itself if left out.")
    ] = None,
    gmsh_seconds: Annotated[
        float, typer.Option(metavar="S", help="Clock limit of one mesh, against a gmsh that hangs.")
    ] = 600.0,
    accuracy: Annotated[
        str | None,
        typer.Option(
            metavar="MM",
            help="Tips to 0.1mm, say: rung and mesh are chosen, the error is estimated.",
        ),
    ] = None,
    rung: Annotated[
        str, typer.Option(help="With --accuracy: beam or solid, instead of the cheaper one.")
    ] = "auto",
    budget: Annotated[
        float, typer.Option(metavar="S", help="With --accuracy: processor time of one model.")
    ] = math.inf,
    resume: Resume = False,
) -> None:
    """Mesh designs, load their chambers, and compare the solid's tips with the beam's.

    Ends with 0 if every design agrees, 1 if one does not or has no equilibrium, 3 if cases could
    not be computed.
    """
    from femcheck.cli.request import RunRequest
    from femcheck.cli.run_command import run_command

    run_command(
        RunRequest(
            designs=designs,
            out=out,
            seal=seal,
            agree=agree,
            law=law,
            nu=nu,
            constants=constant or [],
            wind=wind,
            winding=winding,
            slenderness=slenderness,
            workers=workers,
            layers=layers,
            size=size,
            element=element,
            solver=solver,
            iterations=iterations,
            seconds=seconds,
            gmsh=gmsh,
            gmsh_seconds=gmsh_seconds,
            resume=resume,
            accuracy=accuracy,
            rung=rung,
            budget=budget,
        )
    )


@app.command(name="chart")
def chart_models(
    source: Annotated[
        str, typer.Argument(metavar="DESIGN|RUN|SCENE", help="What the tips are asked of.")
    ],
    out: Annotated[
        Path | None, typer.Option(help="Folder for the results; charts/NAME if left out.")
    ] = None,
    law: Law = "rigid-section",
    nu: Nu = None,
    constant: Constants = None,
    wind: Wind = None,
    winding: Winding = None,
    seal: Seal = None,
    slenderness: Slenderness = None,
    levels: Annotated[
        str | None, typer.Option(metavar="A,B,C", help="Pressures [kPa] instead of the design's.")
    ] = None,
    family: Annotated[
        list[str] | None,
        typer.Option(help="raster, beam, wedge18, …; may be given again. All if left out."),
    ] = None,
    seconds: Annotated[
        float, typer.Option(metavar="S", help="Leave out models expected to need more of the CPU.")
    ] = math.inf,
    workers: Workers = 2,
    resume: Resume = False,
) -> None:
    """Chart error against processor time of every model: arcs, rods, solids; who is cheapest."""
    from femcheck.cli.chart import chart_command
    from femcheck.cli.request import RunRequest

    asked = RunRequest(
        [source],
        out,
        law=law,
        nu=nu,
        constants=constant or [],
        wind=wind,
        winding=winding,
        seal=seal,
        slenderness=slenderness,
        budget=seconds,
        workers=workers,
        resume=resume,
    )
    chart_command(asked, levels, family or [])


@app.command(name="laws")
def show_laws() -> None:
    """Print the laws with the sources of their constants, and differentiate each.

    Ends with 1 if a stress or a stiffness is not the derivative that it should be.
    """
    from femcheck.cli.laws import laws_command

    laws_command()


@app.command(name="report")
def write_report(
    runs: Annotated[
        list[Path],
        typer.Argument(
            metavar="RUN…",
            help="Folders of femcheck run and beamopt optimize, charts, maps; or of such folders.",
        ),
    ],
    out: Annotated[Path, typer.Option(metavar="FILE.html", help="The page to write.")],
    title: Annotated[
        str, typer.Option(help="Title of the page; the designs' names if left out.")
    ] = "",
    force: Annotated[
        bool, typer.Option("--force", help="Write over a file that is no report.")
    ] = False,
) -> None:
    """Put results into one page that opens from disk: verdicts, figures, models that turn."""
    from femcheck.cli.report_page import report_command

    report_command(runs, out, title, force=force)


@app.command(name="stability")
def stability_map(
    out: Annotated[Path, typer.Option(help="Folder of the map.")] = Path("stability"),
    axis: Annotated[
        list[str] | None,
        typer.Option(
            help="A panel: wall, nu, slenderness, element, section, tube, wound-slenderness or "
            "wound-wall; may be given again. All if left out."
        ),
    ] = None,
    workers: Workers = 2,
    resume: Resume = False,
    redraw: Annotated[
        bool, typer.Option("--redraw", help="Tables and figure from what is there; solve nothing.")
    ] = False,
) -> None:
    """Map where actuators of silicone have an equilibrium, and where the beam is right."""
    from femcheck.cli.stability import stability_command

    stability_command(out, axis or [], workers, resume=resume, redraw=redraw)


@app.command(name="baseline")
def write_baselines(
    designs: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[DESIGN|RUN|SCENE…]",
            help="Design files, run folders, scenes, or names of the package's; those if left out.",
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder of the baselines.")] = Path("baselines"),
    meshes: Annotated[
        Path | None, typer.Option(help="Folder of small section meshes; that of --out if left out.")
    ] = None,
    workers: Workers = 2,
    force: Annotated[
        bool, typer.Option("--force", help="Write over baselines, and other files in their place.")
    ] = False,
) -> None:
    """Write what every rung says of designs, with tolerances from error estimates."""
    from femcheck.cli.regression import baseline_command

    baseline_command(designs or [], out, meshes or out, workers, force=force)


@app.command(name="regress")
def hold_against_baselines(
    designs: Annotated[
        list[str] | None,
        typer.Argument(metavar="[DESIGN…]", help="Designs; all that have one if left out."),
    ] = None,
    baseline: Annotated[Path, typer.Option(help="Folder of the baselines.")] = Path("baselines"),
    meshes: Annotated[
        Path | None, typer.Option(help="Folder of section meshes; that of --baseline if left out.")
    ] = None,
    workers: Workers = 2,
    out: Annotated[
        Path | None, typer.Option(metavar="FILE.csv", help="Write all that moved.")
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Write over a file that is no such table.")
    ] = False,
) -> None:
    """Compute what baselines hold anew; ends with 1 and a table if anything moved."""
    from femcheck.cli.regression import regress_command

    regress_command(designs or [], baseline, meshes or baseline, workers, out, force=force)


def run(arguments: Sequence[str]) -> int:
    """Run one command; returns the exit code."""
    return finish(app, "femcheck", arguments)
