"""The order of the 27 combinations, and what each is predicted from."""

import numpy as np
import pytest

from femcheck.continuation.pressure_tree import Node, all_nodes, ancestors, prediction

LEVELS = (5.0, 20.0, 70.0)


def predicted(node: Node, values: dict[Node, float], slopes: tuple[float, float, float]) -> float:
    return sum(
        factor * (slopes[source - 1] if isinstance(source, int) else values[source])
        for factor, source in prediction(node, LEVELS)
    )


def test_every_combination_once_and_parents_first() -> None:
    nodes = all_nodes()
    assert len(set(nodes)) == len(nodes) == 27
    assert {index for node in nodes for index in node} == {0, 1, 2}
    place = {node: k for k, node in enumerate(nodes)}
    for node in nodes:
        sources = [source for _, source in prediction(node, LEVELS)]
        parents = [source for source in sources if not isinstance(source, int)]
        assert all(place[parent] < place[node] for parent in parents)
        assert all(sum(parent) < sum(node) for parent in parents)
        assert all(place[one] < place[node] for one in ancestors(node))
        assert bool(parents) == any(node)


def test_ancestors_lead_to_the_first_node() -> None:
    for node in all_nodes():
        way = list(ancestors(node))
        assert len(way) == sum(node)
        assert not way or way[-1] == (0, 0, 0)


@pytest.mark.parametrize("node", [n for n in all_nodes() if np.count_nonzero(n) >= 2])
def test_exact_for_sums_of_functions_of_one_pressure(node: Node) -> None:
    parts = np.random.default_rng(3).normal(size=(3, 3))
    values = {n: float(sum(parts[axis, n[axis]] for axis in range(3))) for n in all_nodes()}
    assert predicted(node, values, (0, 0, 0)) == pytest.approx(values[node], abs=1e-12)


@pytest.mark.parametrize("node", all_nodes())
def test_exact_for_linear_functions(node: Node) -> None:
    slopes = (0.3, -1.1, 0.7)
    values = {
        n: float(sum(slope * LEVELS[index] for slope, index in zip(slopes, n, strict=True)))
        for n in all_nodes()
    }
    assert predicted(node, values, slopes) == pytest.approx(values[node], abs=1e-12)
