"""The validation suites in their reduced form."""

import pytest

from tests.validation.check import Check
from tests.validation.suites import SUITES

CHECKS = [(name, check) for name, make in SUITES.items() for check in make(False)]


@pytest.mark.parametrize(("suite", "check"), CHECKS, ids=[f"{s}: {c.name}" for s, c in CHECKS])
def test_holds(suite: str, check: Check) -> None:
    # "resume" takes the longest: it starts the command line again and again, and kills it
    failing = [row.cells for row in check.rows() if not row.holds]
    assert not failing
