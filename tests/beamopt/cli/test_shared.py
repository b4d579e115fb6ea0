"""What commands of both programs share: options of one meaning, and lines of progress."""

from typing import Any

import pytest
from typer.main import get_command

from beamopt.cli.application import app as beamopt_app
from beamopt.cli.progress import counted
from femcheck.cli.application import app as femcheck_app


@pytest.mark.parametrize("name", ["--workers", "--resume", "--version"])
def test_an_option_of_one_name_is_one_option(name: str) -> None:
    """The same range and the same words wherever it stands; defaults may differ."""
    found = []
    for app in (beamopt_app, femcheck_app):
        group: Any = get_command(app)
        for command in (group, *group.commands.values()):
            options = [one for one in command.params if name in one.opts]
            found += [(one.help, one.min, one.max) for one in options]
    assert len(found) >= 2
    assert len(set(found)) == 1


def test_without_a_terminal_so_many_lines_are_printed(capsys: pytest.CaptureFixture[str]) -> None:
    with counted("cases", "map", lines=4) as show:
        for done in range(1, 2001):
            show(done, 2000, "[red] text")
    lines = capsys.readouterr().out.splitlines()
    assert [line.split(" cases")[0] for line in lines] == [
        f"{done} of 2,000" for done in ("500", "1,000", "1,500", "2,000")
    ]
