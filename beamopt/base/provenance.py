"""What a result was made with: versions, machine, threads."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

__all__ = ["THREAD_SETTINGS", "provenance", "thread_settings"]

THREAD_SETTINGS = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "NUMBA_NUM_THREADS",
)
PACKAGES = ("beamopt", "numpy", "scipy", "numba", "pydantic", "matplotlib")


def provenance(packages: Iterable[str] = ()) -> dict[str, object]:
    """Versions, machine and thread settings of this process.

    packages : whose versions matter beside those that every result depends on.
    """
    names = (*PACKAGES, *packages)
    return {
        "versions": {"python": platform.python_version()} | {n: _version(n) for n in names},
        "machine": {
            "system": platform.system(),
            "architecture": platform.machine(),
            "processor": _processor(),
            "processors": os.cpu_count(),
        },
        "threads": thread_settings(),
    }


def thread_settings() -> dict[str, str]:
    """The thread settings of this process's numerical libraries."""
    return {name: os.environ.get(name, "not set") for name in THREAD_SETTINGS}


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    named = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return named[0] if named else platform.processor()
