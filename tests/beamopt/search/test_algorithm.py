import numpy as np
import pytest

from beamopt.judge.judge import Judge, JudgeStatus, Verdict
from beamopt.scene.scene import Scene, load_scene
from beamopt.search.algorithm import CandidateKind, GeneticAlgorithm


def made_up(search: GeneticAlgorithm, rng: np.random.Generator) -> list[Verdict]:
    """Verdicts from nowhere: the algorithm must not care where they come from."""
    return [Verdict(float(L), float(K)) for L, K in rng.uniform(1, 9, (len(search.ask()), 2))]


def test_a_run_judges_as_many_sections_as_the_papers() -> None:
    search, rng = GeneticAlgorithm(Scene()), np.random.default_rng(0)
    sizes = []
    record = None
    while record is None or record.index < 100:
        sizes.append(len(search.ask()))
        record = search.tell(made_up(search, rng)) or record
    assert sizes == [20] + [16, 2] * 100
    assert record.evaluations == 20 + 100 * (16 + 2)


def test_asking_twice_gives_the_same() -> None:
    search = GeneticAlgorithm(Scene())
    assert [p.digest for p in search.ask()] == [p.digest for p in search.ask()]


def test_selection_keeps_the_lowest_total_loss_of_parents_and_offspring() -> None:
    search = GeneticAlgorithm(load_scene("random-section", ["search.mutation_probability=0"]))
    rng = np.random.default_rng(1)
    totals = []
    for _ in range(2):
        verdicts = made_up(search, rng)
        totals += [verdict.T for verdict in verdicts]
        record = search.tell(verdicts)
    assert record is not None
    assert [one.verdict.T for one in record.population] == sorted(totals)[:20]


def test_mutants_replace_even_the_best_but_it_is_remembered() -> None:
    search = GeneticAlgorithm(load_scene("random-section", ["search.mutation_probability=1"]))
    rng = np.random.default_rng(2)
    search.tell([Verdict(0.5, 0.0), *made_up(search, rng)[1:]])
    search.tell(made_up(search, rng))
    assert search.stage is CandidateKind.MUTANTS
    assert len(search.ask()) == 20
    record = search.tell(made_up(search, rng))
    assert record is not None
    assert record.best.verdict.L > 0.5
    assert record.best_ever.verdict.L == 0.5


def test_the_metric_is_the_lowest_L_not_the_lowest_T() -> None:
    search = GeneticAlgorithm(Scene())
    verdicts = [Verdict(5.0, 1.0)] * 18 + [Verdict(1.0, 100.0), Verdict(4.0, 0.0)]
    record = search.tell(verdicts)
    assert record is not None
    assert record.best.verdict == Verdict(1.0, 100.0)


def test_failures_are_selected_last() -> None:
    search = GeneticAlgorithm(Scene())
    failed = Verdict(np.inf, np.inf, JudgeStatus.NO_MATERIAL)
    search.tell([failed] * 10 + [Verdict(1.0, 1.0)] * 10)
    search.tell([Verdict(2.0, 2.0)] * 16)
    record = search.tell([Verdict(3.0, 3.0)] * 2)
    assert record is not None
    assert failed not in [one.verdict for one in record.population]


def test_the_wrong_number_of_verdicts_is_refused() -> None:
    with pytest.raises(ValueError, match="1 verdicts for 20 candidates"):
        GeneticAlgorithm(Scene()).tell([Verdict(1.0, 1.0)])


def test_initial_populations_follow_from_the_seed_alone() -> None:
    def initial(name: str, *overrides: str) -> list[str]:
        return [p.digest for p in GeneticAlgorithm(load_scene(name, overrides)).ask()]

    base = initial("random-section")
    assert base == initial("hand-drawn-workspace", "search.recombination=range")
    assert base != initial("random-section", "search.seed=1")
    assert len(set(base)) == 20


@pytest.mark.parametrize("methods", [("fixed", "direct"), ("range", "weighted")])
def test_the_loss_falls(methods: tuple[str, str]) -> None:
    overrides = [f"search.recombination={methods[0]}", f"search.mutation={methods[1]}"]
    scene = load_scene("hand-drawn-section", overrides)
    search, judge = GeneticAlgorithm(scene), Judge.of_scene(scene, scene.load_target())
    records = []
    while len(records) < 41:
        record = search.tell(judge(search.ask()))
        records += [record] if record is not None else []
    assert records[-1].best.verdict.L < 0.3 * records[0].best.verdict.L
