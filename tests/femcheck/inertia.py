"""Tests that need a solver which counts negative eigenvalues: SuperLU, the fallback, can not."""

import pytest

from femcheck.continuation.direct import Pardiso


def counts() -> bool:
    try:
        Pardiso()
    except ImportError:
        return False
    return True


needs_inertia = pytest.mark.skipif(not counts(), reason="PARDISO is not installed")
