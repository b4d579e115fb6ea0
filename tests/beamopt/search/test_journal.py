import json
from pathlib import Path

import pytest

from beamopt.base.errors import InputError
from beamopt.scene.scene import Scene, load_scene
from beamopt.search.algorithm import GeneticAlgorithm
from beamopt.search.journal import SearchJournal
from beamopt.search.optimize import optimize
from tests.journals import flipped, rewritten, without_digests

SCENE = load_scene("hand-drawn-section", ["search.generations=4"])


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    folder = tmp_path_factory.mktemp("whole") / "run"
    optimize(SCENE, folder, figures=False)
    return (folder / "journal.jsonl").read_bytes()


def resumed(content: bytes, folder: Path, scene: Scene = SCENE) -> bytes:
    """The journal after going on from `content`."""
    optimize(scene, folder, figures=False)
    (folder / "journal.jsonl").write_bytes(content)
    optimize(scene, folder, resume=True, figures=False)
    return (folder / "journal.jsonl").read_bytes()


def test_one_line_a_batch(whole: bytes) -> None:
    header, *lines = [json.loads(line) for line in whole.splitlines()]
    assert header == {"schema": "beamopt-journal/2"}
    assert [line["stage"] for line in lines] == ["initial"] + ["offspring", "mutants"] * 4
    assert [len(line["judged"]) for line in lines] == [20] + [16, 2] * 4


@pytest.mark.parametrize("cut", [0, 1, 20, 34, 35, 36, 900, 2000, -1, -2, -200])
def test_cut_anywhere_it_ends_in_the_same_bytes(cut: int, whole: bytes, tmp_path: Path) -> None:
    assert resumed(whole[:cut], tmp_path / "run") == whole


def test_only_the_cut_off_line_is_judged_again(whole: bytes, tmp_path: Path) -> None:
    """The verdicts on record are taken as they stand, not made again."""
    lines = whole.splitlines(keepends=True)
    L = json.dumps(json.loads(lines[1])["judged"][3][1])
    lines[1] = rewritten(lines[1].decode(), L, "0.125").encode()
    optimize(SCENE, tmp_path / "run", figures=False)
    (tmp_path / "run" / "journal.jsonl").write_bytes(b"".join(lines[:2]))
    result = optimize(SCENE, tmp_path / "run", resume=True, figures=False)
    assert result.verdict.L == 0.125


def corrupt(whole: bytes, number: int, change: tuple[bytes, bytes]) -> bytes:
    lines = whole.splitlines(keepends=True)
    lines[number - 1] = lines[number - 1].replace(*change, 1)
    return b"".join(lines)


@pytest.mark.parametrize(
    ("number", "change"),
    [
        (1, (b"journal/2", b"journal/7")),
        (1, (b"journal/2", b"journal/1")),
        (2, (b'"generation":0', b'"generation":1')),
        (3, (b"offspring", b"mutants")),
        (3, (b"{", b"")),
        (3, (b'"judged":[[', b'"judged":[')),
        (4, (b'[["', b'[["00')),
        (5, (b'"],', b'",')),
        (5, (b",", b",\xff")),
        (3, (b",", b",-")),
    ],
)
def test_a_changed_line_is_named(number: int, change: tuple[bytes, bytes], whole, tmp_path) -> None:
    changed = corrupt(whole, number, change)
    if changed == whole:
        changed = corrupt(whole, number, (b"]]", b"],[]]"))
    if change[1] == b"journal/1":
        number = 2  # lines of that version have no digests
    with pytest.raises(InputError, match=f"line {number}"):
        resumed(changed, tmp_path / "run")


def test_every_changed_digit_is_noticed(whole: bytes, tmp_path: Path) -> None:
    path, search = tmp_path / "journal.jsonl", GeneticAlgorithm(SCENE)
    header, first = whole.splitlines(keepends=True)[:2]
    damaged = [header + line for line in flipped(first)]
    assert len(damaged) > 500
    for content in damaged:
        path.write_bytes(content)
        journal = SearchJournal(path)
        with pytest.raises(InputError) as caught:
            next(journal.replay(search))
        assert (caught.value.where, caught.value.key) == (str(path), "line 2")
        journal.close()
    path.write_bytes(header + first)
    with SearchJournal(path) as journal:
        assert len(next(journal.replay(search))) == 20


@pytest.mark.parametrize("cut", [500, -1, -200])
def test_a_journal_of_the_first_version_is_gone_on_with(
    cut: int, whole: bytes, tmp_path: Path
) -> None:
    old = without_digests(whole)
    assert resumed(old[:cut], tmp_path / "run") == old


def test_another_seed_is_another_journal(whole: bytes, tmp_path: Path) -> None:
    other = load_scene("hand-drawn-section", ["search.generations=4", "search.seed=1"])
    with pytest.raises(InputError, match="line 2"):
        resumed(whole, tmp_path / "run", other)


@pytest.mark.parametrize(
    "value", ["true", "-5.0", "NaN", "Infinity", "1e999", "null", '"0.1"', "[]"]
)
def test_losses_that_are_none_are_refused(value: str, whole: bytes, tmp_path: Path) -> None:
    lines = whole.decode().splitlines(keepends=True)
    L = lines[-1].partition('"judged":[["')[2].split(",", 2)[1]
    lines[-1] = rewritten(lines[-1], L, value)
    with pytest.raises(InputError, match=f"line {len(lines)}"):
        resumed("".join(lines).encode(), tmp_path / "run")


def test_another_file_is_not_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "journal.jsonl"
    path.write_bytes(b"\x00\x01 something else")
    with pytest.raises(InputError, match="is no journal"):
        SearchJournal(path)
    assert path.read_bytes() == b"\x00\x01 something else"


def test_failures_are_on_record_with_their_reason(tmp_path: Path) -> None:
    keys = ["section.feature_points=1", "section.material_probability=0.5", "search.generations=1"]
    scene = load_scene("hand-drawn-section", keys)
    optimize(scene, tmp_path / "run", figures=False)
    path = tmp_path / "run" / "journal.jsonl"
    whole = path.read_bytes()
    failed = b',null,null,"NO_MATERIAL"]'
    assert failed in whole
    optimize(scene, tmp_path / "run", resume=True, figures=False)
    assert path.read_bytes() == whole
    first = whole.index(failed)
    path.write_bytes(whole[: first - 3] + b'00"' + whole[first:])  # another genotype's
    with pytest.raises(InputError, match="line 2"):
        optimize(scene, tmp_path / "run", resume=True, figures=False)
