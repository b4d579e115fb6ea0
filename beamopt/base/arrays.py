"""The kinds of arrays that run through the package."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["FloatArray", "IndexArray", "LabelArray"]

FloatArray = NDArray[np.float64]
IndexArray = NDArray[np.int64]
LabelArray = NDArray[np.uint8]
"""Types of elements or feature points: 0 material, 1…3 a supply."""
