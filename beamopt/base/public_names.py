"""Public names of a package, imported when they are first used."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import lazy_loader

__all__ = ["public_names"]


def public_names(
    package: str, file: str
) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Return `__getattr__`, `__dir__` and `__all__` of a package with a stub beside `file`.

    The stub is the only list of the names; type checkers read it too. `__version__` is that of
    the distribution `beamopt`.
    """
    find, listed, names = lazy_loader.attach_stub(package, file)

    def attribute(name: str) -> Any:
        if name == "__version__":
            from importlib.metadata import version

            return version("beamopt")
        return find(name)

    return attribute, lambda: [*listed(), "__version__"], names
