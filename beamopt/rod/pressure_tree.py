"""The order of pressures in which each equilibrium begins at that of its neighbours."""

from __future__ import annotations

from functools import cache
from itertools import product

import numpy as np

from beamopt.base.arrays import IndexArray

__all__ = ["parents_on_grid"]


@cache
def parents_on_grid(levels: int = 3) -> IndexArray:
    """(levels³, 3) cases a, b, c of the combinations of three pressures, p3 running fastest.

    A case begins at a + b − c, exact where the shape is linear in two supplies' pressures (or in
    one, two steps down); the second level of a single supply begins at a, the first case from rest
    (−1).
    """
    count = np.array([levels * levels, levels, 1])
    parents = np.full((levels**3, 3), -1, dtype=np.int64)
    for at in product(range(levels), repeat=3):
        place = np.array(at)
        case = int(count @ place)
        risen = [axis for axis in range(3) if at[axis] > 0]
        if not risen:
            continue
        first = count[risen[-1]]
        second = first if len(risen) == 1 else count[risen[-2]]
        parents[case, 0] = case - first
        if len(risen) > 1:
            parents[case] = case - first, case - second, case - first - second
        elif at[risen[0]] > 1:
            parents[case] = case - first, case - first, case - 2 * first
    parents.setflags(write=False)
    return parents
