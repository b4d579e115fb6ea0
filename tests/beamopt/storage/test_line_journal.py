"""Journals of lines: what a kill leaves, and what is somebody else's."""

import ast
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.base.errors import InputError
from beamopt.storage.line_journal import LineJournal, with_digest, without_digest
from tests.test_architecture import MODULES, name_of

ASKED = {"schema": "test/1", "n": (1, 2), "text": "höhe\u2028\x85"}
ENTRIES: list[dict[str, Any]] = [{"a": 1.5}, {"b": "zwei\u2028\x0b\nrows"}, {"c": [None, 0.1]}]


def journal(path: Path) -> LineJournal:
    return LineJournal(path, ASKED, "test")


def filled(path: Path) -> bytes:
    one = journal(path)
    for entry in ENTRIES:
        one.add(entry)
    return path.read_bytes()


def test_entries_come_back(tmp_path: Path) -> None:
    """Whatever they hold: line ends within texts end no line."""
    before = filled(tmp_path / "j")
    again = journal(tmp_path / "j")
    assert again.entries == ENTRIES
    assert (tmp_path / "j").read_bytes() == before
    assert before.count(b"\n") == 1 + len(ENTRIES)


@given(st.data())
def test_a_kill_at_any_byte_loses_a_line_at_most(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    """What was whole stays; going on ends in the same file."""
    path = tmp_path_factory.mktemp("journal") / "j"
    whole = filled(path)
    cut = data.draw(st.integers(0, len(whole)))
    path.write_bytes(whole[:cut])
    again = journal(path)
    kept = max(whole[:cut].count(b"\n") - 1, 0)
    assert again.entries == ENTRIES[:kept]
    for entry in ENTRIES[kept:]:
        again.add(entry)
    assert path.read_bytes() == whole


@pytest.mark.parametrize("line", [b"{\n", b"\n", b"[1]\n", b"3\n", b"\xff\xfe\n", b'{"a": 1} x\n'])
def test_damage_is_said_and_left_alone(tmp_path: Path, line: bytes) -> None:
    path = tmp_path / "j"
    whole = filled(path)
    for damaged in (whole + line, whole + line + b'{"d": 1}\n'):
        path.write_bytes(damaged)
        with pytest.raises(InputError, match="no journal of a test"):
            journal(path)
        assert path.read_bytes() == damaged


def test_every_changed_digit_is_noticed(tmp_path: Path) -> None:
    """In the first line as in the others, the digests included; the line is named."""
    path = tmp_path / "j"
    whole = filled(path)
    places = [place for place, byte in enumerate(whole) if 48 <= byte < 58]
    assert len(places) > 40
    for place in places:
        path.write_bytes(
            whole[:place] + bytes([48 + (whole[place] - 47) % 10]) + whole[place + 1 :]
        )
        for asked in (ASKED, None):
            with pytest.raises(InputError) as caught:
                LineJournal(path, asked, "test")
            line = whole[:place].count(b"\n") + 1
            assert (caught.value.where, caught.value.key) == (str(path), f"line {line}")


@given(st.dictionaries(st.text(), st.none() | st.floats() | st.text(), min_size=1))
def test_a_digest_is_of_what_was_written(entry: dict[str, Any]) -> None:
    text = json.dumps(entry)
    assert without_digest(with_digest(text)) == text
    assert "digest" in json.loads(with_digest(text))


def test_a_journal_of_an_earlier_version_is_gone_on_with(tmp_path: Path) -> None:
    """As it was written: without digests."""
    path = tmp_path / "j"
    old = "".join(json.dumps(one) + "\n" for one in (ASKED, *ENTRIES))
    path.write_text(old)
    again = journal(path)
    assert again.entries == ENTRIES
    again.add({"d": 1})
    assert path.read_text() == old + '{"d": 1}\n'
    assert journal(path).entries == [*ENTRIES, {"d": 1}]


def test_lines_of_two_versions_are_no_journal(tmp_path: Path) -> None:
    path = tmp_path / "j"
    whole = filled(path).decode()
    old = "".join(json.dumps(one) + "\n" for one in (ASKED, *ENTRIES))
    for mixed in (whole + old.splitlines()[1] + "\n", old + whole.splitlines()[1] + "\n"):
        path.write_text(mixed)
        with pytest.raises(InputError, match="line 5"):
            journal(path)


@pytest.mark.parametrize("head", [{}, [], ASKED | {"n": [1, 3]}, ASKED | {"more": 1}])
def test_another_question_is_refused(tmp_path: Path, head: object) -> None:
    path = tmp_path / "j"
    path.write_text(json.dumps(head) + "\n")
    before = path.read_bytes()
    said = "the test there is of another question" if isinstance(head, dict) else "line 1"
    with pytest.raises(InputError, match=said):
        journal(path)
    assert path.read_bytes() == before


def test_an_empty_file_is_a_new_journal(tmp_path: Path) -> None:
    (tmp_path / "j").write_bytes(b"")
    assert journal(tmp_path / "j").entries == []
    assert (tmp_path / "j").read_bytes().endswith(b"}\n")


@pytest.mark.parametrize("text", ["my notes", '{"schema": "mine"', "{"])
def test_a_foreign_line_without_an_end_is_left_alone(tmp_path: Path, text: str) -> None:
    """Unless it is how the journal itself begins."""
    path = tmp_path / "j"
    path.write_text(text)
    if text == "{":
        assert journal(path).entries == []
        return
    with pytest.raises(InputError, match="line 1"):
        journal(path)
    assert path.read_text() == text


@pytest.mark.parametrize("there", [True, False], ids=["link", "dangling"])
def test_a_journal_is_not_followed_through_a_link(tmp_path: Path, *, there: bool) -> None:
    other, path = tmp_path / "other", tmp_path / "j"
    if there:
        filled(other)
    before = other.read_bytes() if there else None
    path.symlink_to(other)
    with pytest.raises(InputError, match="is a link"):
        journal(path)
    assert (other.read_bytes() if there else None) == before
    assert other.exists() is there


def test_reading_a_journal_changes_nothing(tmp_path: Path) -> None:
    """It may be that of a process that is writing half a line now."""
    path = tmp_path / "j"
    whole = filled(path)[:-5]
    path.write_bytes(whole)
    assert LineJournal(path, None, "test").entries == ENTRIES[:-1]
    assert path.read_bytes() == whole


def test_numbers_that_json_does_not_have(tmp_path: Path) -> None:
    """Strict readers take every line, and NaN and infinities come back."""

    def refused(name: str) -> None:
        raise ValueError(name)

    path = tmp_path / "journal.jsonl"
    entry = {"a": [math.nan, 1.0], "b": {"c": (math.inf, -math.inf)}, "d": np.float64("nan")}
    one = LineJournal(path, {"most": math.inf}, "test")
    one.add(entry)
    for line in path.read_text().splitlines():
        json.loads(line, parse_constant=refused)
    again = LineJournal(path, {"most": math.inf}, "test")
    (read,) = again.read(dict)
    assert repr(read) == "{'a': [nan, 1.0], 'b': {'c': [inf, -inf]}, 'd': nan}"
    assert again.asked == {"most": math.inf}


@pytest.mark.parametrize("value", ["[]", "null", '"x"', '{"not finite": "nan"}'])
def test_what_stands_for_no_number(value: str, tmp_path: Path) -> None:
    path = tmp_path / "journal.jsonl"
    text = with_digest('{"a": {"not finite": ' + value + "}}") + "\n"
    journal(path)
    path.write_text(path.read_text() + text)
    with pytest.raises(InputError) as caught:
        journal(path)
    assert caught.value.key == "line 2"


@pytest.mark.parametrize("file", MODULES, ids=name_of)
def test_json_is_written_without_nan(file: Path) -> None:
    """`json.dumps` writes NaN, which strict readers refuse, unless it is forbidden to."""
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Call) and ast.unparse(node.func) in ("json.dumps", "json.dump"):
            assert "allow_nan=False" in [ast.unparse(one) for one in node.keywords], node.lineno
