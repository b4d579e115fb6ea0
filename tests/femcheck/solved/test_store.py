"""Arrays on disk: read as they were written, or not at all, and then the file is named."""

import logging
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from femcheck.solved.store import MARK, read_arrays, write_arrays

ARRAYS = {"x": np.array([[0.125, -1e300], [np.nan, 3.0]]), "status": np.array("CONVERGED")}


def plain(arrays: Any) -> dict[str, list[Any]]:
    return {name: arrays[name].tolist() for name in arrays.files}


def test_every_changed_byte_is_noticed(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """Its digits are among them; where the mark alone is damaged the arrays are whole."""
    file = tmp_path / "a.npz"
    write_arrays(file, ARRAYS)
    whole = file.read_bytes()
    mark = range(whole.rindex(MARK), whole.rindex(MARK) + len(MARK))
    expected = repr(read_arrays(file, plain))
    assert "CONVERGED" in expected
    for place, byte in enumerate(whole):
        file.write_bytes(whole[:place] + bytes([byte ^ 1]) + whole[place + 1 :])
        caplog.clear()
        with caplog.at_level(logging.WARNING):
            read = read_arrays(file, plain)
        if place in mark:
            assert repr(read) == expected
        else:
            assert read is None
            assert str(file) in caplog.text


def test_a_file_of_an_earlier_version_is_read(tmp_path: Path) -> None:
    write_arrays(tmp_path / "a.npz", ARRAYS)
    np.savez(tmp_path / "old.npz", **ARRAYS)  # type: ignore[arg-type]
    old, new = (read_arrays(tmp_path / name, plain) for name in ("old.npz", "a.npz"))
    assert repr(old) == repr(new)


def test_no_file_is_no_damage(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    assert read_arrays(tmp_path / "none.npz", plain) is None
    assert caplog.text == ""
