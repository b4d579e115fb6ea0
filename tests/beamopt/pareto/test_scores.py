"""Which objectives there are, and which of many designs none beats."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError
from beamopt.pareto.scores import chosen_objectives, nondominated

FEW = st.integers(0, 6).map(float)  # few enough for ties


def beats(one: FloatArray, other: FloatArray) -> bool:
    return bool((one <= other).all() and (one < other).any())


@given(
    st.integers(2, 4).flatmap(
        lambda m: arrays(np.float64, st.tuples(st.integers(1, 30), st.just(m)), elements=FEW)
    )
)
def test_nondominated_is_what_comparing_all_pairs_gives(values: FloatArray) -> None:
    expected = [
        k
        for k, one in enumerate(values)
        if not any(beats(other, one) for other in values)
        and not any((values[m] == one).all() for m in range(k))
    ]
    assert nondominated(values) == expected


@pytest.mark.parametrize(
    "text", ["L", "mass", "mass,L", "L,L", "L,weight", "", "L,mass,mass", "L,mass,"]
)
def test_objectives_that_are_none(text: str) -> None:
    with pytest.raises(InputError, match="L and one or more of ratio, mass, chambers"):
        chosen_objectives(text)


def test_objectives() -> None:
    assert chosen_objectives("L, mass") == ("L", "mass")
    assert chosen_objectives("L,ratio,chambers") == ("L", "ratio", "chambers")
