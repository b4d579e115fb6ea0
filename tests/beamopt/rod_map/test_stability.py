"""The stability map: verdicts on hand-made answers, small maps, journal, bad calls."""

from __future__ import annotations

import csv
import json
from collections import Counter
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError
from beamopt.cli.application import run
from beamopt.plot.stability_map import LOOKS
from beamopt.rod.modes import StrainModes
from beamopt.rod.rod import STRAIGHT, PointLoad, Rod, Segment
from beamopt.rod.solution import RodSolution
from beamopt.rod.status import RodStatus
from beamopt.rod_map.cases import SLENDERNESSES, CaseKind, LoadedSection, RodCase, case_of, sizes_of
from beamopt.rod_map.journal import SCHEMA, line_of, samples_in
from beamopt.rod_map.map_report import ANSWERS, NAMES
from beamopt.rod_map.reading import reading
from beamopt.rod_map.sampling import MethodSample, Sample, solve_sample
from beamopt.rod_map.stability import JOURNAL, run_stability
from beamopt.rod_map.summary import commonest, rates_of
from beamopt.rod_map.truth import compared, true_equilibrium
from beamopt.rod_map.verdict import MethodAnswer, MethodVerdict, Truth, Witness, judged
from beamopt.storage.line_journal import LineJournal
from tests.beamopt.rod.samples import PLANE, plain_law
from tests.clocks import run_away
from tests.journals import flipped
from tests.validation.resume import everything

FOUND, LIMIT_POINT = RodStatus.CONVERGED, RodStatus.LIMIT_POINT
TIP: FloatArray = np.array([0.0, 60.0, 80.0])  # of a rod of length 100
ASIDE: FloatArray = np.array([1.0, 0.0, 0.0])
NOWHERE: FloatArray = np.full(3, np.nan)
FEW = ("modes", "shooting")


@pytest.mark.parametrize(
    ("status", "tip", "seconds", "verdict"),
    [
        (FOUND, TIP + 0.9 * ASIDE, 0.1, MethodVerdict.RIGHT),
        (FOUND, TIP + 4.9 * ASIDE, 0.1, MethodVerdict.INACCURATE),
        (FOUND, TIP + 5.1 * ASIDE, 0.1, MethodVerdict.WRONG_BRANCH),
        (FOUND, TIP, 0.6, MethodVerdict.TOO_SLOW),
        (RodStatus.TOO_SLOW, NOWHERE, 0.4, MethodVerdict.TOO_SLOW),
        (LIMIT_POINT, NOWHERE, 0.1, MethodVerdict.REFUSED_WRONGLY),
    ],
)
def test_verdicts_where_there_is_an_equilibrium(
    status: RodStatus, tip: FloatArray, seconds: float, verdict: MethodVerdict
) -> None:
    truth = Truth(Witness.BOTH, FOUND, TIP, 0.0)
    assert judged(MethodAnswer(status, tip, seconds), truth, 100.0, 0.5)[0] is verdict


@pytest.mark.parametrize(
    ("status", "tip", "verdict"),
    [
        (FOUND, TIP, MethodVerdict.NO_SUCH_TIP),
        (LIMIT_POINT, NOWHERE, MethodVerdict.REFUSED_RIGHTLY),
        (RodStatus.DIVERGED, NOWHERE, MethodVerdict.REFUSED_RIGHTLY),
    ],
)
def test_verdicts_where_there_is_none(
    status: RodStatus, tip: FloatArray, verdict: MethodVerdict
) -> None:
    truth = Truth(Witness.BOTH, LIMIT_POINT, NOWHERE, np.nan)
    assert judged(MethodAnswer(status, tip, 0.1), truth, 100.0, 0.5)[0] is verdict


def test_nobody_is_judged_where_nobody_knows() -> None:
    truth = Truth(Witness.NEITHER, FOUND, TIP, 0.2)
    assert judged(MethodAnswer(FOUND, TIP, 9.0), truth, 100.0, 0.5)[0] is MethodVerdict.UNDECIDED


def test_a_rod_that_is_drawn_out_is_measured_by_its_own_length() -> None:
    far = 10 * TIP
    truth = Truth(Witness.BOTH, FOUND, far, 0.0)
    verdict, distance = judged(MethodAnswer(FOUND, far + 9.0 * ASIDE, 0.1), truth, 100.0, 0.5)
    assert (verdict, distance) == (MethodVerdict.RIGHT, pytest.approx(0.009))


def solution(status: RodStatus, tip: FloatArray, factor: float = 1.0) -> RodSolution:
    return RodSolution(
        status=(status,),
        tips=tip[None],
        rotations=np.eye(3)[None],
        factor=np.array([factor]),
        error=np.array([np.nan]),
        iterations=np.array([1]),
        stations=np.array([0.0]),
        centrelines=np.zeros((1, 1, 3)),
    )


def test_two_have_to_agree() -> None:
    here, near, far = (solution(FOUND, TIP + x * ASIDE) for x in (0.0, 0.4, 0.6))
    assert compared(here, near, 100.0).witness is Witness.BOTH
    assert compared(here, far, 100.0).witness is Witness.NEITHER
    assert compared(here, solution(LIMIT_POINT, NOWHERE, 0.9), 100.0).witness is Witness.NEITHER


@pytest.mark.parametrize("index", [3, 4, 5])
def test_the_truth_does_not_depend_on_a_clock(index: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is found by so many iterations, in whatever time a busy machine takes for them."""
    loaded = LoadedSection.of(case_of(0, index))
    wanted = true_equilibrium(loaded.rod, loaded.rest)
    run_away(monkeypatch)
    found = true_equilibrium(loaded.rod, loaded.rest)
    assert (found.witness, found.status) == (wanted.witness, wanted.status)
    np.testing.assert_array_equal(found.tip, wanted.tip)


@pytest.mark.parametrize(
    ("one", "other", "known"),
    [
        ((LIMIT_POINT, 0.50), (LIMIT_POINT, 0.53), True),
        ((LIMIT_POINT, 0.50), (RodStatus.STEPS_TOO_SMALL, 0.53), True),
        ((RodStatus.STEPS_TOO_SMALL, 0.53), (RodStatus.BUCKLED, 0.50), True),
        ((LIMIT_POINT, 0.50), (LIMIT_POINT, 0.60), False),
        ((RodStatus.CRUSHED, 1.0), (RodStatus.CRUSHED, 0.3), True),
        ((RodStatus.STEPS_TOO_SMALL, 0.5), (RodStatus.DIVERGED, 0.5), False),
    ],
)
def test_both_have_to_refuse_at_the_same_load(
    one: tuple[RodStatus, float], other: tuple[RodStatus, float], known: bool
) -> None:
    a, b = (solution(status, NOWHERE, factor) for status, factor in (one, other))
    assert compared(a, b, 100.0).known is known


@pytest.mark.parametrize(("force", "bends"), [(2.0, False), (3.0, True)])
def test_the_truth_of_a_crooked_column(force: float, bends: bool) -> None:
    """Euler: it stands up to F L²/EI = π²/4, and is far out of line beyond."""
    law, rest = plain_law(free=PLANE), STRAIGHT.copy()
    rest[1] = 0.01
    rod = Rod((Segment(1.0, law, rest, end=PointLoad(np.array([0.0, 0.0, -force]))),))
    truth = true_equilibrium(rod, rod.rest[None])
    assert (truth.witness, truth.status) == (Witness.BOTH, FOUND)
    assert bool(truth.tip[0] > 0.5) is bends


def test_cases_fill_kinds_and_sizes_evenly() -> None:
    cases = [case_of(0, index) for index in range(5 * 13 * 9)]
    assert set(Counter((one.kind, one.size) for one in cases).values()) == {9}
    assert len({(one.kind, one.size, one.slenderness) for one in cases}) == len(cases)
    assert {one.slenderness for one in cases} == set(SLENDERNESSES)
    assert (sizes_of(CaseKind.WEIGHT)[0], sizes_of(CaseKind.WEIGHT)[-1]) == (0.01, 1e4)


@pytest.mark.parametrize("kind", list(CaseKind))
def test_sizes_are_dimensionless(kind: CaseKind) -> None:
    """The shorter rod of the same section bends by the same angle, but for shear and stretch."""
    long, longer = (LoadedSection.of(RodCase(0, 3, kind, 1.0, s)) for s in (100.0, 200.0))
    assert longer.rod.length == pytest.approx(2 * long.rod.length)
    turns = [tip_angle(one.rod, one.rest) for one in (long, longer)]
    assert turns[0] == pytest.approx(turns[1], rel=0.05)


def tip_angle(rod: Rod, rest: FloatArray) -> float:
    """[rad] that the tip is turned by."""
    found = StrainModes().solve(rod, rest, 12)
    return float(np.arccos(np.clip((np.trace(found.rotations[0]) - 1) / 2, -1, 1)))


def test_a_sample_is_its_own() -> None:
    """Made again from its number alone."""
    one, same, other = (LoadedSection.of(case_of(0, index)) for index in (5, 5, 70))
    np.testing.assert_array_equal(one.rod.segments[0].law.bending, same.rod.segments[0].law.bending)
    assert np.any(one.rod.segments[0].law.bending != other.rod.segments[0].law.bending)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Sample]]:
    folder = tmp_path_factory.mktemp("stability") / "map"
    return folder, run_stability(folder, 8, methods=FEW)


def without_seconds(path: Path) -> list[list[str]]:
    return [row[:-1] for row in csv.reader(path.read_text().splitlines())]


def test_what_a_map_leaves(made: tuple[Path, list[Sample]]) -> None:
    folder, samples = made
    assert {path.name for path in folder.iterdir()} == set(NAMES)
    assert (folder / "stability.csv").read_text().splitlines()[0] == ANSWERS
    rows = list(csv.DictReader((folder / "stability.csv").read_text().splitlines()))
    assert [(row["seed"], row["method"]) for row in rows] == [
        (str(index), method) for index in range(8) for method in FEW
    ]
    assert {row["judged"] for row in rows} == {MethodVerdict.RIGHT.name}
    assert {row["ended"] for row in rows} <= set(RodStatus.__members__)
    truths = list(csv.DictReader((folder / "truth.csv").read_text().splitlines()))
    assert {row["known_by"] for row in truths} == {Witness.BOTH.name}
    assert {row["ended"] for row in truths} == {RodStatus.CONVERGED.name}
    rates = list(csv.DictReader((folder / "success.csv").read_text().splitlines()))
    assert {row["success"] for row in rates} == {"1.0"}
    assert [row["cases"] for row in rates if row["kind"] == "all"] == ["8", "8"]
    assert (folder / "reading.md").read_text() == reading(samples)
    assert json.loads((folder / "provenance.json").read_text())["samples"] == 8


def test_workers_do_not_count(made: tuple[Path, list[Sample]], tmp_path: Path) -> None:
    folder, _ = made
    run_stability(tmp_path / "map", 8, methods=FEW, workers=2, figures=False)
    for name in ("stability.csv", "success.csv"):
        assert without_seconds(tmp_path / "map" / name) == without_seconds(folder / name)
    name = "truth.csv"
    assert (tmp_path / "map" / name).read_text() == (folder / name).read_text()


def journal_at(path: Path, seed: int = 0) -> LineJournal:
    return LineJournal(path, {"schema": SCHEMA, "seed": seed, "methods": list(FEW)}, "map")


def test_a_map_that_was_cut_short_is_gone_on_with(
    made: tuple[Path, list[Sample]], tmp_path: Path
) -> None:
    """With half a line of a kill; samples that are there are not solved again."""
    folder, samples = made
    there = tmp_path / "map"
    there.mkdir()
    journal = journal_at(there / JOURNAL)
    for sample in samples[2:7]:
        journal.add(line_of(sample))
    with journal.path.open("a") as stream:
        stream.write('{"index": 7, "witn')
    came: list[int] = []
    run_stability(
        there, 8, methods=FEW, resume=True, figures=False,
        callback=lambda sample, done: came.append(sample.case.index),
    )  # fmt: skip
    assert came == [0, 1, 7]
    assert without_seconds(there / "stability.csv") == without_seconds(folder / "stability.csv")
    assert not (there / JOURNAL).exists()


def test_every_changed_digit_is_noticed(made: tuple[Path, list[Sample]], tmp_path: Path) -> None:
    path = tmp_path / JOURNAL
    journal_at(path).add(line_of(made[1][0]))
    for damaged in flipped(path.read_bytes()):
        path.write_bytes(damaged)
        with pytest.raises(InputError, match=r"line [12]"):
            samples_in(journal_at(path))


def test_a_map_never_goes_backwards(made: tuple[Path, list[Sample]], tmp_path: Path) -> None:
    journal = journal_at(tmp_path / JOURNAL)
    for sample in made[1][2:7]:
        journal.add(line_of(sample))
    before = everything(tmp_path)
    with pytest.raises(InputError) as caught:
        run_stability(tmp_path, 6, methods=FEW, resume=True)
    assert (caught.value.where, caught.value.value) == ("--samples", 6)
    assert everything(tmp_path) == before


def test_another_map_is_not_gone_on_with(tmp_path: Path) -> None:
    path = tmp_path / JOURNAL
    journal_at(path, seed=1)
    with pytest.raises(InputError, match="of another question"):
        run_stability(tmp_path, 1, methods=FEW, resume=True)
    path.write_text("nonsense\n")
    with pytest.raises(InputError, match="no journal"):
        run_stability(tmp_path, 1, methods=FEW, resume=True)


def row(verdict: MethodVerdict, seconds: float = 0.1, status: RodStatus = FOUND) -> MethodSample:
    return MethodSample(case_of(0, 0), "modes", 12, verdict, status, np.nan, seconds)


def test_rates_leave_out_what_nobody_knows() -> None:
    worn = RodStatus.STEPS_TOO_SMALL
    rates = rates_of(
        [
            *(
                row(MethodVerdict.RIGHT),
                row(MethodVerdict.REFUSED_RIGHTLY),
                row(MethodVerdict.NO_SUCH_TIP),
            ),
            *(
                row(MethodVerdict.REFUSED_WRONGLY, status=worn),
                row(MethodVerdict.UNDECIDED, np.nan),
            ),
        ]
    )
    assert (rates.cases, rates.decided) == (5, 4)
    assert (rates.success, rates.wrong_tips) == (0.5, 0.25)
    assert rates.reasons == {worn: 1}
    assert rates.seconds == 0.1


def test_a_cell_shows_the_commonest_verdict_and_the_worse_of_equals() -> None:
    right, wrong, open_ = (
        row(one)
        for one in (MethodVerdict.RIGHT, MethodVerdict.WRONG_BRANCH, MethodVerdict.UNDECIDED)
    )
    assert commonest([right, right, wrong]) is MethodVerdict.RIGHT
    assert commonest([right, wrong]) is MethodVerdict.WRONG_BRANCH
    assert commonest([right, open_, open_]) is MethodVerdict.RIGHT
    assert commonest([open_]) is MethodVerdict.UNDECIDED


def test_every_verdict_has_its_look() -> None:
    assert list(LOOKS) == [verdict.name for verdict in MethodVerdict]
    letters = [letter for letter, _, _ in LOOKS.values()]
    assert len(set(letters)) == len(letters)


def test_the_reading_has_the_methods_in_their_order(made: tuple[Path, list[Sample]]) -> None:
    """Modes that are right against shooting that is on the wrong branch."""
    _, samples = made
    spoilt = [
        replace(
            sample,
            rows=(sample.rows[0], replace(sample.rows[1], verdict=MethodVerdict.WRONG_BRANCH)),
        )
        for sample in samples
    ]
    text = reading(spoilt)
    assert " ".join(text.split()).count("modes 1.000, shooting -1.000.") == 1
    assert "First: **modes** (100.0% success" in text
    assert "wrong branch 8" in text


def test_where_nobody_knows_nobody_is_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    nobody = Truth(Witness.NEITHER, FOUND, NOWHERE, np.nan)
    monkeypatch.setattr("beamopt.rod_map.sampling.true_equilibrium", lambda rod, rest: nobody)
    sample = solve_sample(0, 0, ("adaptive", "modes"))
    assert [one.verdict for one in sample.rows] == [MethodVerdict.UNDECIDED] * 2
    assert [one.status for one in sample.rows] == [RodStatus.SKIPPED] * 2


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--samples", "0"], "--samples"),
        (["--workers", "0"], "--workers"),
        (["--seed", "-1"], "--seed"),
        (["--out", "."], "holds files already"),
        (["--out", ".", "--resume"], "nothing to go on with"),
    ],
)
def test_bad_calls_are_one_line(
    arguments: list[str],
    said: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    monkeypatch.chdir(tmp_path)
    assert run(["stability", *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert said in err
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_the_command_prints_rates(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    fewer = partial(run_stability, methods=FEW, figures=False)
    monkeypatch.setattr("beamopt.cli.stability.run_stability", fewer)
    few = ["--samples", "2", "--workers", "1"]
    assert run(["stability", "--out", str(tmp_path / "map"), *few]) == 0
    said = capsys.readouterr().out
    assert "2 random sections under load" in said
    assert "100.0%" in said
