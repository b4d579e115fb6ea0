"""Every kind of file that is read, damaged in every way: one line and exit code 2."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.hostile.cases import Case, Server, check, check_codes
from tests.hostile.damages import CONTENTS, NUMBERS, PLACES, copied

ALL = {**CONTENTS, **NUMBERS, **PLACES}
FEW = ("empty", "utf-16", "first nan", "folder", "pipe", "huge")
SOME = (*CONTENTS, "first nan", "first list", "last 1e999", "last text", *PLACES)
"""Numbers of each kind, where the others would each take a second of drawing."""

TIPS = ["--pressures", "1,2,3"]
RESUMED = ["--out", "run", "--resume", *(f"--set={key}" for key in ("search.generations=1",))]

# command, files, the damaged one of them
READ: dict[str, tuple[str, str, tuple[str, ...], str, tuple[str, ...]]] = {}


def reads(line: str, damaged: str, *files: str, damages: tuple[str, ...] = tuple(ALL)) -> None:
    program, _, rest = line.partition(" ")
    READ[f"{line} ({damaged})"] = (program, rest, files, damaged, damages)


reads("beamopt rung section.toml", "section.toml", "section.toml", "drawn.json")
reads("beamopt rung segments.toml", "drawn.json", "segments.toml", "drawn.json")
reads("beamopt tips drawn.json", "drawn.json", "drawn.json")
reads("beamopt optimize section.toml --out out", "drawn.json", "section.toml", "drawn.json")
reads("beamopt optimize workspace.toml --out out", "table.csv", "workspace.toml", "table.csv")
reads("beamopt optimize points.toml --out out", "points.csv", "points.toml", "points.csv")
reads("beamopt bound table.csv", "table.csv", "table.csv")
reads("beamopt reach drawn.json path.csv", "path.csv", "drawn.json", "path.csv")
OPTIMIZE = (
    "beamopt optimize random-section --out run --resume --set search.generations=1 "
    "--set search.population=4 --set section.feature_points=6"
)
reads(OPTIMIZE, "run/journal.jsonl", "run")
reads(OPTIMIZE, "run/scene.toml", "run")
reads("beamopt tips run", "run/best.json", "run")
reads("beamopt show run", "run/target.csv", "run")
reads("beamopt show run", "run/scene.toml", "run")
FRONT = OPTIMIZE.replace("optimize", "pareto").replace("--out run", "--out front")
reads(f"{FRONT} --objectives L,ratio --population 4", "front/journal.jsonl", "front")
reads(
    "beamopt study --out study --resume --iterations 1 --no-refine --target random-section "
    "--set search.generations=1",
    "study/study.json",
    "study",
)
reads("beamopt stability --out map --samples 1 --workers 1 --resume", "map/journal.jsonl", "map")
reads("femcheck run sealed.json --out out", "sealed.json", "sealed.json")
CHECK = "femcheck run sealed.json --out asked --resume"
reads(CHECK, "asked/check.json", "sealed.json", "asked")
reads(CHECK, "asked/design.json", "sealed.json", "asked")
reads("femcheck chart disc.json --out chart --resume", "chart/journal.jsonl", "disc.json", "chart")
reads("femcheck stability --redraw --out solids", "solids/journal.jsonl", "solids")
REGRESS = "femcheck regress gravity --baseline baseline --meshes meshes"
reads(REGRESS, "baseline/gravity.json", "baseline", "meshes")
# the question of a check is not what its report reads
reads("femcheck report check --out out.html", "check/check.json", "check", damages=("empty",))
for table in ("summary.json", "design.json", "compare.csv", "table.csv"):
    reads("femcheck report check --out out.html", f"check/{table}", "check", damages=FEW)
for table in ("timing.csv", "provenance.json"):
    reads("femcheck report check --out out.html", f"check/{table}", "check", damages=FEW)
PREDICTION = "femcheck report prediction --out out.html"
reads(PREDICTION, "prediction/paths.svg", "prediction", damages=SOME)
reads(PREDICTION, "prediction/summary.json", "prediction", damages=SOME)
reads(PREDICTION, "prediction/limits.csv", "prediction", damages=SOME)
reads("femcheck report figures --out out.html", "figures/chart.svg", "figures")
reads("femcheck report figures --out out.html", "figures/chart.csv", "figures")
reads("femcheck report figures --out out.html", "figures/reading.md", "figures", damages=FEW)
reads("femcheck report figures --out out.html", "figures/provenance.json", "figures")
reads("femcheck report run --out out.html", "run/summary.json", "run")
reads("femcheck report run --out out.html", "run/history.csv", "run")
for command in ("show", "export", "rung", "refine"):
    reads(f"beamopt {command} drawn.json", "drawn.json", "drawn.json", damages=FEW)
for command in ("optimize", "pareto --objectives L,ratio", "chart", "bound"):
    # an empty scene is one of defaults, whose chart is long work
    damages = tuple(one for one in FEW if (command, one) != ("chart", "empty"))
    reads(f"beamopt {command} section.toml", "section.toml", "section.toml", damages=damages)
for command in ("chart", "run --accuracy 1mm"):
    reads(f"femcheck {command} sealed.json", "sealed.json", "sealed.json", damages=FEW)

BEGINS = (
    ("map/journal.jsonl", ("empty", "half", "missing")),
    ("chart/journal.jsonl", ("empty",)),
    ("asked/design.json", ("missing", "dangling link", "loop of links")),
    ("baseline/gravity.json", ("first minus",)),
)
"""Damages after which a command begins, or goes on with, work that takes long, and may."""


def damages_of(name: str) -> tuple[str, ...]:
    """Damages of a file after which the command ends soon."""
    *_, damaged, damages = READ[name]
    begins = [some for file, some in BEGINS if file == damaged]
    return tuple(one for one in damages if not any(one in some for some in begins))


@pytest.mark.parametrize("name", READ)
def test_damaged_files(name: str, assets: Path, server: Server, tmp_path: Path) -> None:
    """A folder for each damage; the file is missing where it has nothing to be damaged so."""
    program, line, files, damaged, _ = READ[name]
    damages = damages_of(name)

    def make(folder: Path) -> None:
        for damage in damages:
            here = folder / damage
            here.mkdir()
            copied(assets, *files)(here)
            try:
                ALL[damage](here / damaged)
            except (IndexError, UnicodeDecodeError):
                (here / damaged).unlink()

    lines = [[program, *line.split()]] * len(damages)
    case = Case(lines, make, (0, 1, 2, 3), places=damages)
    check_codes(name, check(case, server, tmp_path))
