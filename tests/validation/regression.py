"""Seeded faults: `femcheck regress` fails with each of them, and names the rung that is wrong."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from femcheck.regression.held import LADDER
from tests.faults import FAULTS, Fault, with_fault
from tests.validation.check import Check, Row

__all__ = ["checks", "regress"]

REDUCED = ("a segment's turn with the wrong sign", "a load's frame transposed")
WHERE = ("--baseline", "reports/baseline", "--meshes", "meshes")
CHEAP = ("two-segments", "gravity")


def regress(fault: Fault | None, designs: tuple[str, ...]) -> tuple[int, str]:
    """Exit code of `femcheck regress` with a fault, or without one; the lowest rung that moved."""
    done = with_fault(fault, "femcheck", "regress", *designs, *WHERE, "--workers", "1")
    _, named, said = done.stdout.partition("lowest rung that moved: ")
    longest_first = sorted(LADDER, key=len, reverse=True)
    return done.returncode, next(r for r in longest_first if said.startswith(r)) if named else ""


def checks(full: bool) -> list[Check]:
    """Reduced: two faults that are seen without a solid."""
    chosen = [one for one in FAULTS if one.rung and (full or one.name in REDUCED)]
    clean = Check("no fault", partial(_clean_rows, () if full else CHEAP))
    return [clean, *(Check(one.name, partial(_rows, one, full)) for one in chosen)]


def _clean_rows(designs: tuple[str, ...]) -> Iterator[Row]:
    code, rung = regress(None, designs)
    yield Row(f"no fault: exit code{rung}", "the tree as it is", 0, code, 0)


def _rows(fault: Fault, full: bool) -> Iterator[Row]:
    code, rung = regress(fault, fault.designs if full or fault.designs else CHEAP)
    source = f"{fault.module}: {fault.new.splitlines()[0]}"
    yield Row(f"{fault.name}: exit code", source, 1, code, 0)
    said = f"{fault.name}: place on the ladder of the rung named ({rung or 'none'})"
    yield Row(said, fault.rung, LADDER.index(fault.rung), _index(rung), 0)


def _index(rung: str) -> int:
    return LADDER.index(rung) if rung else -1
