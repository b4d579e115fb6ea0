"""Commands, options, keys and public names are those of the list in tests/data/surface.txt."""

import pytest

from tests.surface import SNAPSHOT, lines


def test_no_name_goes_or_comes_unnoticed() -> None:
    before, now = set(SNAPSHOT.read_text(encoding="utf-8").splitlines()), set(lines())
    gone = [f"gone: {line}" for line in sorted(before - now)]
    new = [f"new: {line}" for line in sorted(now - before)]
    if gone or new:
        advice = "name it in CHANGELOG.md, with its replacement, and run"
        pytest.fail("\n".join([*gone, *new, f"{advice} `python -m tests.surface --write`"]))
