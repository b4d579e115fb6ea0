"""`python -m tests.validation.faulty MODULE OLD NEW TIMES PROGRAM ARGUMENT…`: a run with one fault.

PROGRAM is femcheck or pytest.

The text of a module is changed as it is imported; files stay as they are, so that compiled kernels
are found. A fault therefore never stands in a kernel.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from pathlib import Path
from types import CodeType, ModuleType

NOT_THERE = 3
"""Exit code where the text to be changed is not in the module, or not so many times."""


class Faulty(SourceFileLoader):
    """Loads a module with some text in place of other text."""

    def __init__(self, name: str, path: str, old: str, new: str) -> None:
        super().__init__(name, path)
        self.old, self.new = old, new

    def get_code(self, fullname: str) -> CodeType:
        text = Path(self.path).read_text(encoding="utf-8").replace(self.old, self.new)
        return self.source_to_code(text.encode(), self.path)


class Finder(MetaPathFinder):
    """Finds one module, to be loaded with its fault."""

    def __init__(self, name: str, old: str, new: str) -> None:
        self.name, self.old, self.new = name, old, new

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname != self.name:
            return None
        spec = PathFinder.find_spec(fullname, path, target)
        assert spec is not None
        assert spec.origin is not None
        spec.loader = Faulty(fullname, spec.origin, self.old, self.new)
        return spec


def main() -> None:
    module, old, new, times = sys.argv[1:5]
    root = Path(__file__).resolve().parents[2]
    source = root.joinpath(*module.split(".")).with_suffix(".py")
    if old and source.read_text(encoding="utf-8").count(old) != int(times):
        print(f"{source}: not {times} times: {old!r}", file=sys.stderr)
        sys.exit(NOT_THERE)
    if old:
        sys.meta_path.insert(0, Finder(module, old, new))
    program, sys.argv[1:] = sys.argv[5], sys.argv[6:]
    if program == "pytest":
        import pytest

        sys.exit(pytest.main())
    from femcheck.cli import main as femcheck

    femcheck()


if __name__ == "__main__":
    main()
