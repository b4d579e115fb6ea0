"""`beamopt show`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from rich.style import Style
from rich.text import Text

from beamopt.base.errors import InputError
from beamopt.cli.findings import say_findings
from beamopt.cli.progress import console
from beamopt.plot.figures import design_figure, design_title
from beamopt.plot.section import OUTSIDE, section_pixels
from beamopt.plot.style import TYPE_COLOURS, save_figure
from beamopt.scene.design import Design
from beamopt.scene.named import is_scene, named_design
from beamopt.scene.scene import load_scene
from beamopt.section.cross_section import CrossSection
from beamopt.storage.writing import check_replaceable
from beamopt.target.target import Target, read_target

__all__ = ["show_command"]

MADE_BY = "beamopt show"
ENDINGS = (".png", ".svg", ".pdf")
WIDTH = 56  # characters of the picture in the terminal
SYMBOLS = "·123 "


def show_command(source: str, out: Path | None, *, force: bool = False) -> None:
    """Draw a design, or the best design of a run over its target."""
    path = Path(source)
    figure_path = out or Path(f"{path.resolve().stem}.png")
    if figure_path.suffix.lower() not in ENDINGS:
        raise InputError("--out", "", str(figure_path), f"must end in {', '.join(ENDINGS)}")
    check_replaceable(figure_path, MADE_BY, MADE_BY, force=force)
    name, design = named_design(source)
    target = _target(path, design) if path.is_dir() and not is_scene(source) else None
    figure = design_figure(design, target, design_title(design) or name)
    save_figure(figure, figure_path, made_by=MADE_BY)
    console.print(_terminal_picture(design.section))
    legend = Text("material ", style="dim")
    for supply, colour in enumerate(TYPE_COLOURS[1:], 1):
        legend.append(f" ■ supply {supply}", style=colour)
    console.print(legend)
    console.print(f"figure: {figure_path}", soft_wrap=True, markup=False)
    say_findings(design)


def _target(run: Path, design: Design) -> Target | None:
    """What a run was asked for, if it says so."""
    table, scene = run / "target.csv", run / "scene.toml"
    if scene.exists():
        asked = load_scene(scene)
        if asked.target.paths or asked.target.kind == "points":
            return asked.load_target()
    if not table.exists():
        return None
    straight = design.climb.model.straight_length is not None
    return read_target(table, design.pressures, design.actuator.length, straight=straight)


def _terminal_picture(section: CrossSection) -> Text:
    """The section in half-height blocks; with digits where the terminal has no colour."""
    types = section_pixels(section, min(WIDTH, console.width // 2 * 2))
    seen = np.flatnonzero((types != OUTSIDE).any(axis=1))
    types = types[seen[0] // 2 * 2 : seen[-1] // 2 * 2 + 2]  # a sector leaves rows empty
    if console.color_system is None:
        rows = types[::2]
        return Text("\n".join("".join(SYMBOLS[kind] for kind in row).rstrip() for row in rows))
    picture = Text()
    for upper, lower in zip(types[::2], types[1::2], strict=True):
        for above, below in np.column_stack([upper, lower]).tolist():
            picture.append(*_block(above, below))
        picture.append("\n")
    return picture


def _block(above: int, below: int) -> tuple[str, Style | None]:
    """Two pixels above each other as one character."""
    if above == below == OUTSIDE:
        return " ", None
    if above == OUTSIDE:
        return "▄", Style(color=TYPE_COLOURS[below])
    if below == OUTSIDE:
        return "▀", Style(color=TYPE_COLOURS[above])
    return "▀", Style(color=TYPE_COLOURS[above], bgcolor=TYPE_COLOURS[below])
