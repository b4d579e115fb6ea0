"""Charts of made-up solids and quick rods: rows, sentences, tables, journals, figures."""

import csv
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from beamopt.base.errors import InputError
from beamopt.base.processes import in_process
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.design import load_design
from beamopt.scene.named import named_design
from beamopt.storage.line_journal import with_digest
from femcheck.chart import campaign as run
from femcheck.chart import lineup
from femcheck.chart.campaign import TimeBudget, run_chart
from femcheck.chart.chart import ACCURACIES, HEADER, Chart, ChartRow, seconds_text
from femcheck.chart.figure import chart_figure
from femcheck.chart.kept import JOURNAL, asked_of, read_chart
from femcheck.chart.lineup import FAMILIES, line_up
from femcheck.chart.measure import Measured, is_final, key_of, made_with, measure, read, written
from femcheck.chart.reference import Limit, Reference
from femcheck.check.options import CheckOptions
from femcheck.continuation.ended import FOUND, Ended, NoReply
from femcheck.continuation.outcome import Status
from femcheck.material.fibre import Thread
from femcheck.models.question import Question
from femcheck.models.reply import Model, Reply
from femcheck.prediction.options import PredictionOptions
from femcheck.solid.winding import Wound
from tests.femcheck.check.small import SIZES
from tests.femcheck.made_up import AT, DESIGN, NEO, RIGID, MadeUp, powers, question_of
from tests.journals import flipped

SOLIDS = ("wedge18", "hex27")
FILES = {
    JOURNAL,
    "chart.csv",
    "cheapest.csv",
    "reading.md",
    "provenance.json",
    "chart.svg",
    "chart.png",
}
ABOUT = {
    "threads": {"OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"},
    "machine": {"processor": "Abacus 9"},
    "versions": {"beamopt": "1.0", "numpy": "2.0", "scikit-fem": "3.0", "scipy": "4.0"},
}


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Coarse rasters, few rods, and no reply asked for twice."""
    monkeypatch.setattr(lineup, "GRIDS", ((16, 60), (32, 120)))
    monkeypatch.setattr(lineup, "RODS", {"modes": (4, 8)})
    monkeypatch.setattr("femcheck.chart.measure.SPENT", 0.0)


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Figures take longer than all the rest."""

    def touch(figure: None, *paths: Path) -> None:
        for path in paths:
            path.write_bytes(b"a figure")

    monkeypatch.setattr(run, "chart_figure", lambda chart: None)
    monkeypatch.setattr(run, "save_figure", touch)


def made(off: Callable[[Any], float] | None = None, **changes: Any) -> MadeUp:
    return MadeUp(off or powers(5.0, 4), **changes)


def charted(question: Question, out: Path, solids: MadeUp, **changes: Any) -> Chart:
    with solids.instead():
        return run_chart(question, out, **({"families": SOLIDS, "pool": in_process} | changes))


def measured(name: str, error: float, seconds: float, rows: int = 3, lost: int = 0) -> Measured:
    tips = np.zeros((rows, 3))
    tips[:, 0] = error
    tips[rows - lost :] = np.nan
    endings = (FOUND,) * (rows - lost) + (Ended(Status.BUCKLED, 3.25),) * lost
    return Measured(name, "1", Reply(tips, endings, 10), seconds, made_with(ABOUT))


def held_against(uncertainty: float, *rows: Measured, lost: int = 0) -> Chart:
    tips = np.zeros((3, 3))
    tips[3 - lost :] = np.nan
    band = np.where(np.isnan(tips[:, 0]), np.nan, uncertainty)
    return Chart.of(question_of(NEO), rows, Reference("wedge18", tips, band))


def test_errors_are_the_largest_of_all_tips() -> None:
    one = measured("a", 0.5, 1.0)
    one.reply.tips[1] = [0, 0.3, 0.4]
    one.reply.tips[2] = [0, 0, -2.0]
    (row,) = held_against(0.1, one).rows
    assert (row.error, row.missing, row.is_whole) == (2.0, 0, True)


def test_missing_tips_make_a_row_not_whole() -> None:
    """Those that the reference has; what it has not nobody needs."""
    (row,) = held_against(0.1, measured("a", 0.5, 1.0, lost=1)).rows
    assert (row.error, row.missing, row.is_whole) == (0.5, 1, False)
    (row,) = held_against(0.1, measured("a", 0.5, 1.0, lost=1), lost=1).rows
    assert (row.missing, row.is_whole) == (0, True)
    (row,) = held_against(0.1, measured("a", 0.5, 1.0), lost=1).rows
    assert (row.error, row.is_whole) == (0.5, True)
    (row,) = held_against(0.1, measured("a", 0.5, 1.0, lost=3)).rows
    assert np.isnan(row.error)
    assert not row.is_whole


def test_without_a_reference_nothing_is_told() -> None:
    chart = Chart.of(question_of(NEO), [measured("a", 0.0, 1.0)], None)
    assert np.isnan(chart.rows[0].error)
    assert chart.rows[0].missing == 3
    assert chart.uncertainty == np.inf
    assert chart.cheapest(1.0) is None
    said = list(chart.sentences())
    assert said[1] == "No family of elements was solved finely enough to extrapolate from."
    assert said[-3:] == [f"Within {a:g} mm: the reference does not tell." for a in ACCURACIES]


def test_who_is_cheapest() -> None:
    rows = (
        measured("a", 0.05, 3.0),
        measured("b", 0.5, 1.0),
        measured("c", 0.001, 0.1, lost=1),
        measured("a", 0.005, 9.0),
    )
    chart = held_against(0.02, *rows)
    assert [chart.cheapest(a) and chart.cheapest(a).measured for a in (1.0, 0.1)] == [  # type: ignore[union-attr]
        rows[1],
        rows[0],
    ]
    of_family = chart.cheapest(1.0, "a")
    assert of_family is not None
    assert of_family.measured is rows[0]
    assert chart.cheapest(1e-3) is None
    nearer = chart.cheapest(0.06)  # 0.05 is not within it where the truth is at the band's end
    assert nearer is not None
    assert nearer.measured is rows[3]
    assert chart.cheapest(1.0, "c") is None
    said = list(chart.sentences())
    assert said[1] == "Reference: wedge18, ± 0.02 mm."
    assert said[2] == "What follows stands on the reference alone: no other family confirms it."
    assert said[-3] == "Within 1 mm: b 1 in 1 s (error 0.5 mm)."
    assert said[-2] == "Within 0.1 mm: a 1 in 3 s (error 0.05 mm)."
    assert said[-1] == "Within 0.01 mm: the reference does not tell."
    assert list(held_against(1e-6, rows[1]).sentences())[-2] == "Within 0.1 mm: none of them."


def test_the_cheapest_solid_is_named_beside_a_cheaper_rod() -> None:
    rod, solid = measured("beam", 0.05, 0.001), measured("wedge18", 0.05, 3.0)
    rod = replace(rod, reply=replace(rod.reply, unknowns=0))
    said = list(held_against(0.02, solid, rod).sentences())
    assert said[-2] == (
        "Within 0.1 mm: beam 1 in 1 ms (error 0.05 mm); of the solids wedge18 1 in 3 s "
        "(error 0.05 mm)."
    )


@pytest.mark.parametrize(
    ("apart", "words"),
    [
        ([0.0, 0.05, 0.1], "within 0.1 mm of it, bands together 0.3 mm: agrees."),
        ([0.0, 0.25, 0.28], "within 0.25 mm of it, bands together 0.12 mm: DISAGREES."),
        ([np.nan] * 3, "hex27 has no tip in common with it."),
        ([np.nan, 0.01, np.nan], "within 0.01 mm of it, bands together 0.12 mm: agrees."),
    ],
)  # fmt: skip
def test_families_are_held_against_each_other(apart: list[float], words: str) -> None:
    """Of two that disagree, the combination is said that shows it."""
    tips = np.zeros((3, 3))
    tips[:, 1] = apart
    tips[np.isnan(apart)] = np.nan
    band = np.where(np.isnan(apart), np.nan, [0.1, 0.1, 0.28])
    other = Limit("hex27", tips, band)
    reference = Reference("wedge18", np.zeros((3, 3)), np.full(3, 0.02), others=(other,))
    chart = Chart.of(question_of(NEO), [measured("a", 0.0, 1.0)], reference)
    assert list(chart.sentences())[2].endswith(words)


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.0012, "1.2 ms"), (1.0, "1 s"), (119.0, "119 s"), (120.0, "2 min"), (5400, "90 min")],
)
def test_times_for_people(seconds: float, text: str) -> None:
    assert seconds_text(seconds) == text


def test_what_a_chart_leaves(tmp_path: Path) -> None:
    """All files; a row a model, with its error from the truth that was made up."""
    chart = charted(question_of(NEO), tmp_path / "c", made())
    assert {path.name for path in (tmp_path / "c").iterdir()} == FILES
    text = (tmp_path / "c" / "chart.csv").read_text()
    assert text.splitlines()[0] == HEADER
    rows = list(csv.DictReader(text.splitlines()))
    assert [row["family"] for row in rows] == ["wedge18"] * 6 + ["hex27"] * 3
    assert {(row["found"], row["of"], row["ended"]) for row in rows} == {("3", "3", FOUND.key)}
    layers = [3, 4, 6, 8, 12, 4, 2, 3, 4]
    errors = [5.0 * n**-4 for n in layers]
    np.testing.assert_allclose([float(row["error_mm"]) for row in rows], errors, rtol=1e-6)
    assert [float(row["cpu_seconds"]) for row in rows] == layers
    assert [int(row["unknowns"]) for row in rows] == [1000 * n for n in layers]
    assert rows[0]["size"] == "3 made-up layers"
    cheapest = list(csv.DictReader((tmp_path / "c" / "cheapest.csv").read_text().splitlines()))
    assert [row["accuracy_mm"] for row in cheapest[:9]] == ["1.0"] * 9
    first = next(row for row in cheapest if row["accuracy_mm"] == "0.1")
    assert first["resolution"].startswith("3 ")
    assert (tmp_path / "c" / "reading.md").read_text().splitlines() == [
        f"- {line}" for line in chart.sentences()
    ]
    about = json.loads((tmp_path / "c" / "provenance.json").read_text())
    assert about["workers"] == 1
    assert about["law"] == NEO.title
    assert about["measured_with"] == chart.made_with
    assert about["versions"]
    assert about["machine"]["processor"]


@pytest.mark.usefixtures("undrawn")
def test_accuracies_below_the_band_are_in_no_table(tmp_path: Path) -> None:
    charted(question_of(NEO), tmp_path / "c", made(powers(5.0, 1.5)))
    chart = read_chart(tmp_path / "c")
    assert 0.01 < chart.uncertainty < 1.0
    rows = list(csv.DictReader((tmp_path / "c" / "cheapest.csv").read_text().splitlines()))
    told = {float(row["accuracy_mm"]) for row in rows}
    assert told == {a for a in ACCURACIES if a >= chart.uncertainty and chart.within(a)}
    assert 0.01 not in told


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize(
    "law",
    [
        RIGID,
        CheckOptions(penalties=(10.0, 30.0), sizes=SIZES, grading=2.0, layers=5),
        NEO,
        PredictionOptions(
            law="gent",
            poisson_ratio=0.4,
            constants={"Jm": 12.0},
            wound=Wound.OUTER,
            thread=Thread(2e4, 0.01),
            element="tet10",
        ),
    ],
    ids=["rigid", "own rigid", "neo-hookean", "wound gent"],
)
def test_a_chart_is_read_back(tmp_path: Path, law: Any) -> None:
    """The same question, rows and reference; reading changes no file."""
    chart = charted(question_of(law), tmp_path / "c", made())
    before = (tmp_path / "c" / JOURNAL).read_bytes()
    again = read_chart(tmp_path / "c")
    assert asked_of(again.question) == asked_of(chart.question)
    assert again.question.law.question == law.question
    np.testing.assert_array_equal(again.question.pressures, AT)
    assert [(r.measured.family, r.measured.resolution, r.error, r.missing) for r in again.rows] == [
        (r.measured.family, r.measured.resolution, r.error, r.missing) for r in chart.rows
    ]
    assert list(again.sentences()) == list(chart.sentences())
    assert again.uncertainty == chart.uncertainty
    assert (tmp_path / "c" / JOURNAL).read_bytes() == before


def content(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.usefixtures("undrawn")
def test_a_chart_goes_on_and_ends_in_the_same_files(tmp_path: Path) -> None:
    """Cut after any line, or in the middle of one; nothing that is kept is asked again."""
    whole = made()
    charted(question_of(NEO), tmp_path / "whole", whole)
    lines = (tmp_path / "whole" / JOURNAL).read_bytes().splitlines(keepends=True)
    for kept, torn in ((len(lines), b""), (4, b""), (4, lines[4][:40]), (1, lines[1][:-1])):
        folder = tmp_path / f"{kept}-{len(torn)}"
        folder.mkdir()
        (folder / JOURNAL).write_bytes(b"".join(lines[:kept]) + torn)
        again = made()
        charted(question_of(NEO), folder, again, resume=True)
        assert len(again.asked) == len(lines) - kept
        assert content(folder) == content(tmp_path / "whole")


def test_all_models_there_are_drawn_again_without_asking(tmp_path: Path) -> None:
    """One command makes table and figure of what is committed."""
    question = question_of(NEO)
    charted(question, tmp_path / "c", made())
    before = content(tmp_path / "c")
    for path in (tmp_path / "c").iterdir():
        if path.name != JOURNAL:
            path.unlink()
    again = made()
    charted(question, tmp_path / "c", again, resume=True)
    assert again.asked == []
    assert content(tmp_path / "c") == before


@pytest.mark.usefixtures("undrawn")
def test_another_question_is_refused(tmp_path: Path) -> None:
    charted(question_of(NEO), tmp_path / "c", made())
    before = content(tmp_path / "c")
    others = (
        question_of(RIGID),
        question_of(NEO, AT + 1),
        question_of(replace(NEO, poisson_ratio=0.4)),
        replace(question_of(NEO), name="other"),
    )
    for other in others:
        with pytest.raises(InputError, match="of another question"):
            charted(other, tmp_path / "c", made(), resume=True)
    with pytest.raises(InputError, match="--resume goes on"):
        charted(question_of(NEO), tmp_path / "c", made())
    assert content(tmp_path / "c") == before


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize(
    "damage",
    [
        b"no json\n",
        b"{}\n",
        b"[1]\n",
        b'{"model": "x", "tips": [[1]], "reasons": []}\n',
        b'{"model": "x", "family": "x", "resolution": "", "seconds": 1, "unknowns": 0, '
        b'"size": "", "tips": [["a", 1, 2]], "reasons": ["converged"]}\n',
        b'{"model": "x", "family": "x", "resolution": "", "seconds": 1, "unknowns": 0, '
        b'"size": "", "tips": [[0, 1, 2]], "reasons": []}\n',
        b'{"model": "x", "family": "x", "resolution": "", "seconds": 1, "unknowns": 0, '
        b'"size": "", "tips": [[0, 1, 2]], "reasons": ["a text of nobody"]}\n',
        b'{"model": "x", "family": "x", "resolution": "", "seconds": 1, "unknowns": 0, '
        b'"size": "", "tips": [[0, 1, 2]], "endings": [["solid.NOBODY", null, ""]]}\n',
        b"\xff\xfe\n",
    ],
)
def test_a_damaged_journal_is_one_line(tmp_path: Path, damage: bytes) -> None:
    charted(question_of(NEO), tmp_path / "c", made(), families=["hex27"])
    path = tmp_path / "c" / JOURNAL
    whole = path.read_bytes()
    written = with_digest(damage.decode("latin-1").rstrip("\n")).encode("latin-1") + b"\n"
    for line in (damage, written):  # changed afterwards, or by a program that is not ours
        path.write_bytes(whole + line)
        said = f"line {whole.count(10) + 1}: no journal of a chart"
        with pytest.raises(InputError, match=said):
            charted(question_of(NEO), tmp_path / "c", made(), resume=True)
        with pytest.raises(InputError, match=said):
            read_chart(tmp_path / "c")


def test_every_changed_digit_is_noticed(tmp_path: Path) -> None:
    """Those of the design in the first line are among them."""
    charted(question_of(NEO), tmp_path / "c", made(), families=["hex27"])
    path = tmp_path / "c" / JOURNAL
    first_two = b"".join(path.read_bytes().splitlines(keepends=True)[:2])
    for damaged in flipped(first_two):
        path.write_bytes(damaged)
        with pytest.raises(InputError, match=r"line [12]: no journal of a chart"):
            read_chart(tmp_path / "c")


@pytest.mark.parametrize("head", [b"", b"{}\n", b"[]\n", b"\xff\n", b'{"schema": "other/1"}\n'])
def test_what_is_no_chart(tmp_path: Path, head: bytes) -> None:
    with pytest.raises(InputError, match="no journal of a chart"):
        read_chart(tmp_path)
    (tmp_path / JOURNAL).write_bytes(head)
    with pytest.raises(InputError, match="no journal of a chart"):
        read_chart(tmp_path)


@pytest.mark.usefixtures("undrawn")
def test_models_too_dear_are_left_out_until_there_is_more_time(tmp_path: Path) -> None:
    """A series stops where the next one is expected to take too long; with more time it goes on.

    What differs from a cheap model in one respect costs what that one does, or as much more as
    its triangles are smaller.
    """
    question = question_of(NEO)
    first = made(seconds=lambda model: 10.0 * model.layers)
    chart = charted(question, tmp_path / "c", first, budget=TimeBudget(80.0), families=["wedge18"])
    assert [model.layers for model in first.asked] == [3, 4, 6]
    late = [row for row in chart.rows if not np.isfinite(row.measured.seconds)]
    assert len(late) == 3
    assert {row.measured.reply.ended.status for row in late} == {NoReply.TOO_DEAR}
    rows = list(csv.DictReader((tmp_path / "c" / "chart.csv").read_text().splitlines()))
    assert (rows[-1]["error_mm"], rows[-1]["cpu_seconds"], rows[-1]["found"]) == ("", "", "0")
    again = read_chart(tmp_path / "c")
    np.testing.assert_array_equal(
        [row.error for row in again.rows], [row.error for row in chart.rows[:3]]
    )
    assert again.uncertainty == chart.uncertainty
    second = made(seconds=lambda model: 10.0 * model.layers)
    whole = charted(
        question, tmp_path / "c", second, budget=TimeBudget(1e4), resume=True, families=["wedge18"]
    )
    assert [(model.layers, model.size) for model in second.asked] == [(8, 2), (12, 2), (4, 0.5)]
    assert all(row.is_whole for row in whole.rows)


@pytest.mark.usefixtures("undrawn")
def test_no_model_is_left_out_for_its_time_unless_that_is_asked_for(tmp_path: Path) -> None:
    """However long models take, as on a machine that is busy, the chart has all of them."""
    slow = made(seconds=lambda model: 1e7 * model.layers**3)
    chart = charted(question_of(NEO), tmp_path / "slow", slow, families=["wedge18"])
    quick = made()
    same = charted(question_of(NEO), tmp_path / "quick", quick, families=["wedge18"])
    assert slow.asked == quick.asked
    np.testing.assert_array_equal(
        [row.error for row in chart.rows], [row.error for row in same.rows]
    )


@pytest.mark.usefixtures("undrawn")
def test_a_correction_is_asked_though_the_finest_is_too_dear(tmp_path: Path) -> None:
    """Stiffer penalties at four layers take what four layers take."""
    solids = made(seconds=lambda model: 10.0 * model.layers)
    charted(
        question_of(RIGID), tmp_path / "c", solids, budget=TimeBudget(70.0), families=["wedge18"]
    )
    stiffer = [model for model in solids.asked if model.penalties[0] > 9000]
    assert [model.layers for model in stiffer] == [4]
    assert max(model.layers for model in solids.asked) == 6


@pytest.mark.usefixtures("undrawn")
def test_two_workers_make_the_same_table(tmp_path: Path) -> None:
    question = question_of(RIGID)
    charted(question, tmp_path / "1", made(), workers=1)
    charted(question, tmp_path / "2", made(), workers=2)
    for name in ("chart.csv", "cheapest.csv", "reading.md"):
        assert (tmp_path / "1" / name).read_bytes() == (tmp_path / "2" / name).read_bytes()
    said = [json.loads((tmp_path / n / "provenance.json").read_text())["workers"] for n in "12"]
    assert said == [1, 2]


@pytest.mark.usefixtures("undrawn")
def test_processes_make_the_same_tips(tmp_path: Path) -> None:
    """Of rods and rasters, in a process of their own."""
    question, families = question_of(RIGID), ["raster", "beam", "rod, modes"]
    here = run_chart(question, tmp_path / "1", families=families, pool=in_process)
    there = run_chart(question, tmp_path / "2", families=families, workers=1)
    assert [row.error for row in here.rows] == [row.error for row in there.rows]
    assert [row.measured.resolution for row in there.rows] == ["16×60", "32×120", "", "4", "8"]
    assert all(row.is_whole and row.measured.seconds > 0 for row in there.rows)


@pytest.mark.usefixtures("undrawn")
def test_progress_counts_what_was_asked_for(tmp_path: Path) -> None:
    """Not what the journal has of other families."""
    seen: list[tuple[int, int, str]] = []
    question = question_of(NEO)
    charted(question, tmp_path / "c", made())
    charted(
        question,
        tmp_path / "c",
        made(),
        families=["hex27"],
        resume=True,
        progress=lambda *said: seen.append(said),
    )
    assert seen == [(3, 3, "starting")]


def test_families_are_asked_by_name(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--family: 'hex8': one of raster, beam"):
        line_up(question_of(), ["hex8"])
    with pytest.raises(InputError, match="none of them can be asked"):
        run_chart(question_of(NEO), tmp_path / "c", families=["tet4"])
    assert not (tmp_path / "c").exists()


def test_who_is_in_a_line_up() -> None:
    """Everyone under the beam's law; no locking pair of the incompressible; rods under loads."""
    names = {series.family for series in line_up(question_of(RIGID))}
    assert names >= set(FAMILIES) - {"felupe"} - {f"rod, {n}" for n in FAMILIES} - {
        name for name in FAMILIES if name.startswith("rod, ") and name != "rod, modes"
    }
    assert "tet4" not in {series.family for series in line_up(question_of(NEO))}
    loaded = Question.of(*named_design("gravity"), CheckOptions())
    assert {series.family for series in line_up(loaded)} == {"raster", "beam", "rod, modes"}
    for question in (question_of(RIGID), question_of(NEO)):
        for series in line_up(question):
            names_of = [key_of(model) for model in series.all]
            assert len(set(names_of)) == len(names_of)
            assert all(model.family == series.family for model in series.all)
            layers = [getattr(model, "layers", 0) for model in series.models]
            assert layers == sorted(layers)
            for extra in (series.sized, series.stiffer):
                assert extra is None or extra.layers in layers


def test_replies_are_written_and_read() -> None:
    """With the tips that are not there."""
    tips = np.array([[0.1, -0.0, 1e-300], [np.nan] * 3])
    endings = FOUND, Ended(Status.BUCKLED, 10 / 3, "somewhere")
    one = Measured("a", "b", Reply(tips, endings, 7, "many"), 1.5)
    line = json.loads(json.dumps(written(one)))
    again = read(line)
    np.testing.assert_array_equal(again.reply.tips, tips)
    assert (again.family, again.resolution, again.seconds) == ("a", "b", 1.5)
    assert again.reply.endings == endings
    assert again.reply.unknowns == 7
    assert line["model"] == "a b"


@pytest.mark.parametrize("status", Status)
def test_what_was_cut_short_is_asked_again(status: Status) -> None:
    """By a clock or a dead process, or at a work limit where a larger one is asked for now."""
    reply = Reply(AT, (FOUND, Ended(status, 3.0), FOUND))
    measured = read(json.loads(json.dumps(written(Measured("a", "b", reply, 1.0, "", 50)))))
    cut = {Status.TIME_OUT, Status.STOPPED}
    assert is_final(measured, 50) is (status not in cut)
    assert is_final(measured, 51) is (status not in {*cut, Status.WORK_LIMIT})


def test_a_quick_reply_is_asked_for_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first one may have loaded a library: the least of the others counts."""
    monkeypatch.setattr("femcheck.chart.measure.SPENT", 0.5)
    times = iter([0.4, 0.03, 0.02, 0.09, 9.0])

    class Loads:
        family, resolution = "a", "b"
        spent = 0.0

        def refuses(self, question: Question) -> str | None:
            return None

        def reply(self, question: Question, workers: int = 0) -> Reply:
            self.spent += next(times)
            return Reply(AT, (FOUND,) * 3)

    model: Model = Loads()
    monkeypatch.setattr("femcheck.chart.measure.cpu_seconds", lambda: model.spent)  # type: ignore[attr-defined]
    assert measure(question_of(), model).seconds == pytest.approx(0.02)
    times = iter([0.6, 0.1])
    assert measure(question_of(), model).seconds == pytest.approx(0.6)


def test_the_figure_says_with_what_it_was_made() -> None:
    assert made_with(ABOUT) == "1 thread a model; Abacus 9; beamopt 1.0, numpy 2.0, scikit-fem 3.0"
    several = ABOUT | {"threads": {"A": "2", "B": "1"}}
    assert made_with(several).startswith("threads: 1, 2 a model; ")
    rows = (
        measured("wedge18", 0.05, 3.0),
        measured("wedge18", 0.5, 1.0),
        measured("unheard of", 1e-9, 0.1),
        measured("tet4", 2.0, 0.1, lost=1),
        measured("tet10", 2.0, np.nan, lost=3),
    )
    figure = chart_figure(held_against(0.02, *rows))
    said = " ".join(text.get_text() for text in figure.texts)
    assert "Abacus 9" in said
    assert "1 thread" in said
    above, below = figure.axes
    drawn = {line.get_label(): line.get_xydata() for line in above.get_lines()}
    np.testing.assert_array_equal(drawn["wedge18"], [[3.0, 0.05], [1.0, 0.5]])
    np.testing.assert_array_equal(drawn["unheard of"], [[0.1, 1e-5]])
    assert any(text.get_text() == "unheard of 1: 100 ms" for text in below.texts)
    assert any(text.get_text() == "the reference does not tell" for text in below.texts)


def test_a_figure_without_a_tip_is_a_figure() -> None:
    rows = [measured("tet10", 2.0, np.nan, lost=3) for _ in range(2)]
    figure = chart_figure(Chart.of(question_of(NEO), rows, None))
    assert len(figure.axes) == 2
    figure.draw_without_rendering()


@pytest.mark.usefixtures("undrawn")
def test_the_sealed_scene_at_one_pressure(tmp_path: Path) -> None:
    """One combination is a question too, of a bundled design and without any solid."""
    design = load_design(bundled_scenes()["sealed-section"].with_name("sealed_section.json"))
    question = Question.of("sealed", design, RIGID, np.array([[50.0, 0, 0]]))
    chart = run_chart(question, tmp_path / "c", families=["beam", "raster"], pool=in_process)
    row = chart.cheapest(0.01)
    assert isinstance(row, ChartRow)
    assert row.measured.family == "beam"
    assert "1 tips" in next(iter(chart.sentences()))


@pytest.mark.usefixtures("undrawn")
def test_no_pressure_at_all(tmp_path: Path) -> None:
    """Everybody is right, and the closed form says so."""
    chart = charted(question_of(RIGID, np.zeros((2, 3))), tmp_path / "c", made(lambda model: 0.0))
    assert all(row.error == 0 for row in chart.rows)
    assert DESIGN.actuator.length == chart.reference.tips[0, 2]  # type: ignore[union-attr]
