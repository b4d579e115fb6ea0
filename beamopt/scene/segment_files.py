"""Segments whose sections stand in design files."""

from __future__ import annotations

import json
from pathlib import Path

from beamopt.base.errors import InputError
from beamopt.scene.actuator import RodRules
from beamopt.scene.design import Design, read_design

__all__ = ["MOST_INLINE", "with_sections"]

MOST_INLINE = 4 * 2**20
"""Most characters of all sections of segments: a folder that holds the scene has them in it."""


def with_sections(rules: RodRules, folder: Path) -> RodRules:
    """The rules with whole designs in place of their files' names: they stand on their own.

    Of a file the section counts alone: its own segments are neither read nor taken along.

    Raises
    ------
    InputError : a file can not be used, or the sections are too long together.
    """
    segments, left = [], MOST_INLINE
    read: dict[str, str] = {}
    for number, one in enumerate(rules.segments):
        if one.file is not None:
            if one.file not in read:
                read[one.file] = _without_segments(read_design(folder / one.file)).json()
            left -= len(read[one.file])
            if left < 0:
                said = f"sections of at most {MOST_INLINE} characters, all segments together"
                raise InputError("", f"rod.segments[{number}]", one.file, said)
            section = json.loads(read[one.file])
            del section["notes"]
            one = one.model_copy(update={"file": None, "section": section})
        segments.append(one)
    return rules.model_copy(update={"segments": tuple(segments)})


def _without_segments(design: Design) -> Design:
    if not design.rod.segments:
        return design
    return design.model_copy(update={"rod": design.rod.model_copy(update={"segments": ()})})
