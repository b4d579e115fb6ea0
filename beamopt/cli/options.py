"""What both programs' command lines share: the program with --version, common options."""

from __future__ import annotations

from importlib.metadata import version
from typing import Annotated

import typer

__all__ = ["Resume", "Workers", "new_program"]

Workers = Annotated[int, typer.Option(min=1, max=256, help="Tasks at once.")]
Resume = Annotated[bool, typer.Option("--resume", help="Go on with the results in the folder.")]


def new_program(name: str, about: str) -> typer.Typer:
    """Make a program without commands; its --version is that of the distribution."""

    def show_version(wanted: bool) -> None:
        if wanted:
            typer.echo(f"{name} {version('beamopt')}")
            raise typer.Exit

    app = typer.Typer(
        name=name,
        help=about,
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
    )
    shown = typer.Option(
        "--version", callback=show_version, is_eager=True, help="Print the version."
    )

    def program(version: bool = False) -> None:
        """Take the options before a command."""

    program.__annotations__["version"] = Annotated[bool, shown]
    app.callback(help=about)(program)
    return app
