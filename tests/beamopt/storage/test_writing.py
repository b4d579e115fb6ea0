import csv
import errno
import io
import json
import os
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from beamopt.base.errors import InputError
from beamopt.storage.writing import (
    cell_text,
    check_replaceable,
    csv_text,
    json_text,
    write_atomic,
    write_changed,
)


def test_a_file_is_replaced_whole(tmp_path: Path) -> None:
    path = tmp_path / "file.txt"
    write_atomic(path, "old")
    inode = path.stat().st_ino
    write_atomic(path, b"new")
    assert path.read_bytes() == b"new"
    assert path.stat().st_ino != inode  # another file in its place: never half of both
    assert [item.name for item in tmp_path.iterdir()] == ["file.txt"]


def test_a_write_that_fails_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "file.txt"
    write_atomic(path, "old")

    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, "no space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="no space"):
        write_atomic(path, "new" * 1000)
    assert path.read_text() == "old"
    assert [item.name for item in tmp_path.iterdir()] == ["file.txt"]


@given(st.lists(st.floats(allow_nan=False), max_size=5))
def test_floats_survive_tables_and_json(values: list[float]) -> None:
    text = csv_text("a", [[value] for value in values])
    read = [float(line) for line in text.splitlines()[1:]]
    np.testing.assert_array_equal(read, values)
    finite = [value for value in values if np.isfinite(value)]
    assert json.loads(json_text({"v": finite}))["v"] == finite


def test_cells_with_commas_are_quoted() -> None:
    text = csv_text("a,b", [["one, two", None]])
    assert list(csv.reader(io.StringIO(text))) == [["a", "b"], ["one, two", ""]]


FORMULAS = st.from_regex(r"\A'{0,2}[=+\-@\t\r].{0,5}\Z")


@given(st.lists(st.one_of(st.text(), FORMULAS), min_size=1, max_size=3))
@example(
    [
        "=1+1",
        "-1.5",
        "-1.5e-3",
        "-x",
        "'-x",
        "+",
        "\t=1",
        "\r",
        "@a",
        "'",
        "-\N{ARABIC-INDIC DIGIT ONE}",
    ]
)
def test_no_text_of_a_table_is_a_formula(texts: list[str]) -> None:
    """And it is read back as it was; numbers stay numbers."""
    header = ",".join(f"c{k}" for k in range(len(texts)))
    written = csv_text(header, [texts])
    ((_, read)) = csv.reader(io.StringIO(written, newline=""))
    for text, cell in zip(texts, read, strict=True):
        assert cell_text(cell) == text
        if cell and cell[0] in "=+-@\t\r":
            assert cell == text
            assert np.isfinite(float(cell)) or "e" in cell.lower()


def test_a_negative_number_stays_one() -> None:
    assert csv_text("a,b,c,d", [[-1.5, -2, "-1.5", "+3e-4"]]) == "a,b,c,d\n-1.5,-2,-1.5,+3e-4\n"


def test_tables_are_written_in_one_place() -> None:
    root = Path(__file__).resolve().parents[3]
    modules = [*(root / "beamopt").rglob("*.py"), *(root / "femcheck").rglob("*.py")]
    writers = [path.name for path in modules if re.search(r"csv\.\w*[wW]riter", path.read_text())]
    assert writers == ["writing.py"]


def test_json_keeps_lists_of_numbers_on_one_line() -> None:
    value = {"x": [1.5, 2.0], "parts": [{"r": [1, 2]}, {"r": []}], "empty": {}}
    text = json_text(value)
    assert ' "x": [1.5, 2.0],\n' in text
    assert json.loads(text) == value
    with pytest.raises(ValueError, match="JSON"):
        json_text({"x": float("nan")})


@given(st.text(st.characters(codec=None)))
def test_any_text_survives_json(text: str) -> None:
    """Escaped or not: control characters, emojis, halves of a surrogate pair, and escapes."""
    for escaped in (True, False):
        written = json_text({text: [text]}, escaped=escaped).encode()
        assert json.loads(written) == {text: [text]}
    assert "mm³" in json_text({"unit": "mm³"}, escaped=False)


@pytest.mark.parametrize("write", [write_atomic, write_changed])
@pytest.mark.parametrize("there", [True, False], ids=["link", "dangling"])
def test_nothing_is_written_through_a_link(
    tmp_path: Path, write: Callable[[Path, str], object], *, there: bool
) -> None:
    other, link = tmp_path / "other", tmp_path / "link"
    if there:
        other.write_text("mine")
    link.symlink_to(other)
    with pytest.raises(InputError, match="is a link"):
        write(link, "new")
    assert link.is_symlink()
    assert (other.read_text() if there else None) == ("mine" if there else None)
    assert {item.name for item in tmp_path.iterdir()} == {"link"} | ({"other"} if there else set())


def test_a_temporary_name_that_is_taken_by_a_link_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "other").write_text("mine")
    (tmp_path / f".file.{os.getpid()}.tmp").symlink_to(tmp_path / "other")
    write_atomic(tmp_path / "file", "new")
    assert (tmp_path / "other").read_text() == "mine"
    assert (tmp_path / "file").read_text() == "new"
    assert {item.name for item in tmp_path.iterdir()} == {"file", "other"}


@pytest.mark.parametrize("place", ["beginning", "end", "middle"])
def test_a_file_that_says_who_made_it_is_replaceable(tmp_path: Path, place: str) -> None:
    path, rest = tmp_path / "file", "x" * 100_000
    check_replaceable(path, "made by us", "us")
    text = {"beginning": "made by us" + rest, "end": rest + "made by us", "middle": rest}[place]
    path.write_text(text)
    if place == "middle":
        with pytest.raises(InputError, match="--force"):
            check_replaceable(path, "made by us", "us")
    else:
        check_replaceable(path, "made by us", "us")
    check_replaceable(path, "made by us", "us", force=True)


def test_what_is_no_file_is_never_replaceable(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to(tmp_path / "nothing")
    for name in ("folder", "pipe", "link"):
        with pytest.raises(InputError) as caught:
            check_replaceable(tmp_path / name, "us", "us", force=True)
        assert caught.value.where == str(tmp_path / name)
