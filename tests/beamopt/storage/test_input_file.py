"""One reader of the files of a user: regular files of a bounded size and a bounded depth."""

from __future__ import annotations

import os
import socket
import time
from pathlib import Path

import pytest

from beamopt import load_design, load_scene
from beamopt.base.errors import InputError
from beamopt.scene.overrides import overridden
from beamopt.storage.input_file import (
    MOST_BYTES,
    MOST_DEPTH,
    MOST_KEY_PARTS,
    MOST_TOML,
    check_regular,
    parse_toml,
    read_bytes,
    read_json,
    read_text,
)
from beamopt.storage.number_table import read_table


def sparse(path: Path, size: int) -> Path:
    """A file of `size` bytes that takes no room on disk."""
    with path.open("wb") as stream:
        stream.truncate(size)
    return path


def readers(path: Path) -> list[object]:
    return [
        lambda: read_text(path),
        lambda: read_json(path),
        lambda: read_table(path, {"x": "mm"}),
        lambda: load_design(path),
        lambda: load_scene(path),
    ]


@pytest.mark.parametrize("reader", range(5))
def test_a_pipe_is_refused_without_waiting(tmp_path: Path, reader: int) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(InputError) as caught:
        readers(tmp_path / "pipe")[reader]()  # type: ignore[operator]
    assert caught.value.where == str(tmp_path / "pipe")
    assert "named pipe" in caught.value.allowed


def test_devices_folders_and_sockets_are_refused(tmp_path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as one:
        one.bind(str(tmp_path / "s"))
        for path in (Path("/dev/zero"), Path("/dev/null"), tmp_path, tmp_path / "s"):
            with pytest.raises(InputError) as caught:
                read_bytes(path)
            assert "must be a regular file" in caught.value.allowed
            with pytest.raises(InputError):
                check_regular(path)


def test_a_link_to_a_pipe_is_refused_and_one_to_a_file_is_read(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "there").write_bytes(b"x")
    for name in ("pipe", "there"):
        (tmp_path / f"to-{name}").symlink_to(tmp_path / name)
    assert read_bytes(tmp_path / "to-there") == b"x"
    with pytest.raises(InputError):
        read_bytes(tmp_path / "to-pipe")


def test_a_large_file_is_refused_with_its_size_and_the_limit(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        read_text(sparse(tmp_path / "large", 2**40))
    assert (caught.value.key, caught.value.value) == ("size", 2**40)
    assert str(MOST_BYTES) in caught.value.allowed
    assert len(read_bytes(sparse(tmp_path / "just", MOST_BYTES))) == MOST_BYTES
    with pytest.raises(InputError):
        read_bytes(sparse(tmp_path / "above", MOST_BYTES + 1))


def test_a_file_of_no_size_that_has_content_is_read_and_bounded() -> None:
    """Files of /proc say that they are empty."""
    status = Path("/proc/self/status")
    assert status.stat().st_size == 0
    assert read_bytes(status)
    with pytest.raises(InputError):
        read_bytes(status, most=10)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_every_end_of_a_line_is_one(tmp_path: Path, end: str) -> None:
    (tmp_path / "a").write_bytes(f"\ufeffone{end}two".encode())
    assert read_text(tmp_path / "a") == "one\ntwo"


def test_a_doubled_key_among_many_is_found_at_once(tmp_path: Path) -> None:
    keys = ", ".join(f'"k{number}": 0' for number in range(100_000))
    (tmp_path / "a.json").write_text(f'{{{keys}, "k77777": 1, "k5": 1}}')
    started = time.process_time()
    with pytest.raises(InputError) as caught:
        read_json(tmp_path / "a.json")
    assert caught.value.key == "k5"  # the first that stands there twice
    assert time.process_time() - started < 5  # a quadratic search takes minutes


@pytest.mark.parametrize("opening", ["[", '{"a":'])
@pytest.mark.parametrize("depth", [MOST_DEPTH, 500, 100_000])
def test_json_that_is_nested_deep_is_refused(tmp_path: Path, opening: str, depth: int) -> None:
    closing = "]" if opening == "[" else "}"
    (tmp_path / "a.json").write_text('{"notes": ' + opening * depth + "1" + closing * depth + "}")
    with pytest.raises(InputError):
        read_json(tmp_path / "a.json")


def test_json_of_the_deepest_nesting_allowed_is_read(tmp_path: Path) -> None:
    depth = MOST_DEPTH - 1
    (tmp_path / "a.json").write_text('{"notes": ' + "[" * depth + "]" * depth + "}")
    assert "notes" in read_json(tmp_path / "a.json")


def dotted(parts: int, part: str = "a") -> str:
    return ".".join([part] * parts)


@pytest.mark.parametrize(
    "text",
    [
        f"{dotted(MOST_KEY_PARTS + 1)} = 1",
        f"[{dotted(200_000)}]",
        f"[[{dotted(200_000)}]]",
        f"x = {{{dotted(200_000)} = 1}}",
        f"x = [{{{dotted(200_000)} = 1}}]",
        " . ".join(['"a"'] * 200_000) + " = 1",
        ".".join(["'a b'"] * 200_000) + " = 1",
        f'x = """ " """\n{dotted(200_000)} = 1',
        f"# '''\n{dotted(200_000)} = 1",
        f'x = "\\""\n{dotted(200_000)} = 1',
        f"x = '\\'\n{dotted(200_000)} = 1",
        f"x = ''''''\n{dotted(200_000)} = 1",
        f"x = '''a'''''\n{dotted(200_000)} = 1",
        "x = " + "[" * 200_000,
        "x = " + "{a=" * 200_000,
        "x = " + "[" * 200 + "]" * 200,
        '"""\\' * 100_000,
        "'''\n\"" * 100_000,
        "x" * (MOST_TOML + 1),
    ],
    ids=range(19),
)
def test_toml_that_would_take_a_parser_long_is_refused_at_once(text: str) -> None:
    started = time.process_time()
    with pytest.raises(InputError):
        parse_toml(text, "here")
    assert time.process_time() - started < 5


@pytest.mark.parametrize(
    ("text", "value"),
    [
        (f"x = '{'.' * 1000}'", "." * 1000),
        (f'x = "{"." * 1000}\\"{"." * 1000}"', "." * 1000 + '"' + "." * 1000),
        (f'x = """\n{"." * 1000}\n""{"." * 1000}"""', "." * 1000 + '\n""' + "." * 1000),
        (f"x = '''{'.' * 1000}''{'.' * 1000}'''", "." * 1000 + "''" + "." * 1000),
        (f"# {'.' * 1000}\nx = 1 # {'.' * 1000}", 1),
        (f"x = [{', '.join(['0.5'] * 1000)}]", [0.5] * 1000),
        ("x = 1979-05-27", None),
        ("\n".join(f"a.b{number}.c = 0.5" for number in range(1000)) + "\nx = 1", 1),
    ],
)
def test_dots_in_texts_comments_and_numbers_are_no_keys(text: str, value: object) -> None:
    found = parse_toml(text, "here")["x"]
    assert value is None or found == value


def test_the_longest_key_allowed_is_read() -> None:
    found = parse_toml(f"{dotted(MOST_KEY_PARTS)} = 1", "here")
    for _ in range(MOST_KEY_PARTS):
        found = found["a"]
    assert found == 1


@pytest.mark.parametrize("override", [f"{dotted(60_000)}=1", f"{dotted(MOST_KEY_PARTS + 1)}=1"])
def test_an_override_of_very_many_parts_is_refused(override: str) -> None:
    with pytest.raises(InputError) as caught:
        overridden({}, [override])
    assert caught.value.where == "--set"


def test_an_override_whose_value_is_no_toml_that_is_read_is_a_text() -> None:
    text = "{" + dotted(60_000) + "=1}"
    assert overridden({}, [f"name={text}"]) == {"name": text}
