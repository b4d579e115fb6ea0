"""`femcheck report`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from beamopt.base.errors import InputError
from beamopt.cli.progress import console
from beamopt.storage.writing import check_replaceable, write_atomic

__all__ = ["report_command"]

ENDINGS = (".html", ".htm")
LARGE = 8.0  # MB: above that mail servers and phones make trouble


def report_command(runs: Sequence[Path], out: Path, title: str, *, force: bool) -> None:
    """Write the report of folders to `out`, and say how large it is.

    Raises
    ------
    InputError : `out` is no name for a page, or a file that is no report and `force` is off; a
        folder that no report is made of, or a damaged file in one.
    """
    from femcheck.report.page import MARK, report_page

    if out.suffix.lower() not in ENDINGS:
        raise InputError("--out", "", out.name, "must end in .html")
    check_replaceable(out, MARK, "femcheck report", force=force)
    page = report_page(runs, title).encode("utf-8", "backslashreplace")  # names of any bytes
    write_atomic(out, page)
    size = len(page) / 1e6
    console.print(f"{out}  {size:.2f} MB", soft_wrap=True, markup=False, highlight=False)
    if size > LARGE:
        said = f"above {LARGE:g} MB: slow to open, may be too large to send; take fewer folders"
        console.print(f"note: {said}", soft_wrap=True, markup=False, highlight=False)
