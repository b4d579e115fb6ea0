"""One thread a process, the longest files first, the same hypothesis examples on every machine."""

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import pytest  # noqa: E402
from hypothesis import HealthCheck, settings  # noqa: E402

LONGEST = (
    "tests/validation/test_reduced.py",
    "tests/hostile/test_files.py",
    "tests/hostile/test_options.py",
    "tests/test_examples.py",
    "tests/test_kills.py",
    "tests/hostile/test_killed_workers.py",
    "tests/femcheck/prediction/test_resume.py",
    "tests/hostile/test_places.py",
    "tests/beamopt/rod_map/test_stability.py",
    "tests/beamopt/study/test_study.py",
)
"""Files of tests that are begun first, so that no process is left alone with one in the end."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    place = {file: k for k, file in enumerate(LONGEST)}
    items.sort(key=lambda item: place.get(item.nodeid.partition("::")[0], len(place)))


settings.register_profile(
    "stable",
    deadline=None,
    derandomize=True,
    max_examples=60,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("stable")
