"""Segments in files: each file is read once, and the segments of a segment's file are not."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import beamopt
from beamopt.base.errors import InputError
from beamopt.scene import design as module
from beamopt.scene.design import read_design

SCENE = beamopt.load_scene("random-section", ["grid.radial=8", "grid.angular=24"])
DESIGN = SCENE.design_of(SCENE.random_points(np.random.default_rng(0)))


def write(file: Path, *names: str) -> None:
    """A design with a segment of its own and one of each file."""
    data: dict[str, Any] = json.loads(DESIGN.json())
    share = 1 / (1 + len(names))
    segments = [{"share": share}, *({"share": share, "file": name} for name in names)]
    data["rod"] = {"segments": segments}
    file.write_text(json.dumps(data))


@pytest.fixture
def reads(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the design files that were read."""
    found: list[str] = []

    def noted(file: Path) -> beamopt.Design:
        found.append(file.name)
        return read_design(file)

    monkeypatch.setattr(module, "read_design", noted)
    return found


def test_a_tower_of_files_is_read_one_deep(tmp_path: Path, reads: list[str]) -> None:
    for level in range(13):
        write(tmp_path / f"{level}.json", *[f"{level + 1}.json"] * 3)
    design = beamopt.load_design(tmp_path / "0.json")
    assert reads == ["0.json", "1.json"]
    assert len(design.rod.segments) == 4
    assert all("rod" not in (one.section or {}) for one in design.rod.segments)
    assert len(design.loaded_rod.pieces) == 4


def test_a_design_that_names_itself_is_its_section(tmp_path: Path, reads: list[str]) -> None:
    write(tmp_path / "a.json", "a.json")
    design = beamopt.load_design(tmp_path / "a.json")
    assert reads == ["a.json", "a.json"]
    plain = json.loads(DESIGN.json())
    del plain["notes"]
    assert design.rod.segments[1].section == plain
    (tmp_path / "b.json").write_text(design.json())
    assert beamopt.load_design(tmp_path / "b.json") == design


def test_sections_too_long_to_be_held_in_one_file_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path / "a.json", "b.json", "b.json", "b.json")
    write(tmp_path / "b.json")
    size = len(DESIGN.json())
    monkeypatch.setattr(module, "MOST_INLINE", int(2.5 * size))
    with pytest.raises(InputError) as caught:
        beamopt.load_design(tmp_path / "a.json")
    assert (caught.value.key, caught.value.value) == ("rod.segments[3]", "b.json")
    monkeypatch.setattr(module, "MOST_INLINE", int(3.5 * size))
    assert beamopt.load_design(tmp_path / "a.json").rod.segments[3].section is not None
