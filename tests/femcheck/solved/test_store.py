"""Results on disk: read as they were written, or not at all, and then the file is named."""

import hashlib
import logging
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from femcheck.continuation.outcome import Statistics, Status
from femcheck.solved.store import MARK, read_solved, write_solved

VALUES = {"x": np.array([[0.125, -1e300], [np.nan, 3.0]]), "reached": 0.5}
STATES = {"there": [True, False], "volumes": np.arange(3.0)}
SPENT = Statistics(3, 7, 1.0, 0.5, 0.25, 0.125)


def write(file: Path) -> None:
    write_solved(file, "a question", Status.CONVERGED, VALUES, SPENT, STATES)


def read(file: Path, digest: str = "a question") -> Any:
    return read_solved(file, digest, plain)


def plain(status: Status, spent: Statistics, arrays: Any) -> tuple[Any, ...]:
    return status, spent, {name: arrays[name].tolist() for name in arrays.files}


def test_every_changed_byte_is_noticed(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """Its digits are among them; where the mark alone is damaged the arrays are whole."""
    file = tmp_path / "a.npz"
    write(file)
    whole = file.read_bytes()
    mark = range(whole.rindex(MARK), whole.rindex(MARK) + len(MARK))
    expected = repr(read(file))
    assert "CONVERGED" in expected
    for place, byte in enumerate(whole):
        file.write_bytes(whole[:place] + bytes([byte ^ 1]) + whole[place + 1 :])
        caplog.clear()
        with caplog.at_level(logging.WARNING):
            found = read(file)
        if place in mark:
            assert repr(found) == expected
        else:
            assert found is None
            assert str(file) in caplog.text


def test_a_file_of_an_earlier_version_is_read(tmp_path: Path) -> None:
    """It has the arrays alone; their order and types are as they were, to the byte."""
    earlier: dict[str, Any] = {
        "digest": np.array("a question"),
        "status": np.array("CONVERGED"),
        **{name: np.array(value) for name, value in VALUES.items()},
        "counts": np.array([3, 7]),
        "seconds": np.array([1.0, 0.5, 0.25, 0.125]),
        **{name: np.array(value) for name, value in STATES.items()},
    }
    write(tmp_path / "a.npz")
    np.savez(tmp_path / "old.npz", **earlier)
    old, new = (read(tmp_path / name) for name in ("old.npz", "a.npz"))
    assert repr(old) == repr(new)
    assert (new[0], new[1]) == (Status.CONVERGED, SPENT)
    before = (tmp_path / "old.npz").read_bytes()
    digest = hashlib.blake2b(before, digest_size=16).hexdigest().encode()
    assert (tmp_path / "a.npz").read_bytes() == before + MARK + digest


def test_another_question_has_no_result(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """Neither is it damaged, nor is a file that is not there."""
    write(tmp_path / "a.npz")
    assert read(tmp_path / "a.npz", "another") is None
    assert read(tmp_path / "none.npz") is None
    assert caplog.text == ""
