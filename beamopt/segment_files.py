"""Segments whose sections stand in design files."""

from __future__ import annotations

import json
from pathlib import Path

from beamopt.actuator import RodRules
from beamopt.design import load_design

__all__ = ["with_sections"]


def with_sections(rules: RodRules, folder: Path) -> RodRules:
    """The rules with whole designs in place of their files' names: they stand on their own."""
    segments = []
    for one in rules.segments:
        if one.file is not None:
            section = json.loads(load_design(folder / one.file).json())
            del section["notes"]
            one = one.model_copy(update={"file": None, "section": section})
        segments.append(one)
    return rules.model_copy(update={"segments": tuple(segments)})
