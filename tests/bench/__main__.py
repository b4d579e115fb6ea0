"""`python -m tests.bench [NAME …]`: measure, print, write reports/bench/NAME.csv."""

from __future__ import annotations

import sys

from tests.bench import evaluation, rods, search, solid, study
from tests.bench.measured import report

BENCHES = {
    "evaluation": evaluation.measure,
    "study": study.measure,
    "solid": solid.measure,
    "rods": rods.measure,
    "search": search.measure,
}


def main() -> int:
    names = sys.argv[1:] or list(BENCHES)
    unknown = [name for name in names if name not in BENCHES]
    if unknown:
        print(f"bench: no benchmark {unknown[0]!r}; one of: {', '.join(BENCHES)}", file=sys.stderr)
        return 2
    for name in names:
        report(name, BENCHES[name]())
    return 0


if __name__ == "__main__":
    sys.exit(main())
