"""The memetic operator: what it may judge, that it is the same again, that nothing gets worse."""

from pathlib import Path

import numpy as np
import pytest

from beamopt.base.processes import in_process
from beamopt.judge.judge import Judge
from beamopt.scene.scene import Scene, load_scene
from beamopt.search.algorithm import CandidateKind, GeneticAlgorithm
from beamopt.search.improvement import LITTLE, Improvement
from beamopt.search.optimize import optimize
from tests.validation.resume import content

KEYS = (
    "grid.radial=32",
    "grid.angular=90",
    "search.population=6",
    "search.generations=3",
    "search.improved_share=0.4",
    "section.feature_points=20",
)


def memetic(*more: str) -> Scene:
    return load_scene("random-section", [*KEYS, *more])


def test_the_best_are_improved_after_mutation_and_never_lose_their_place() -> None:
    scene = memetic()
    judge = Judge.of_scene(scene, scene.load_target())
    search = GeneticAlgorithm(scene, Improvement(judge, scene))
    before: list[float] = []
    stages = []
    for _ in range(7):
        stages.append(search.stage)
        if search.stage is CandidateKind.IMPROVED:
            before = sorted(one.verdict.T for one in search._population)
        record = search.tell(judge(search.ask()))
        if stages[-1] is CandidateKind.IMPROVED:
            assert record is not None
            after = sorted(one.verdict.T for one in record.population)
            assert all(a <= b for a, b in zip(after, before, strict=True))
            assert after[0] < before[0]
    assert stages[:4] == [
        CandidateKind.INITIAL,
        CandidateKind.OFFSPRING,
        CandidateKind.MUTANTS,
        CandidateKind.IMPROVED,
    ]


def test_every_section_that_was_judged_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    judged = []
    measured = type(Judge.of_scene(Scene(), Scene().load_target())).measured

    def counted(self, candidates):  # type: ignore[no-untyped-def]
        judged.append(len(candidates))
        return measured(self, candidates)

    monkeypatch.setattr("beamopt.judge.judge.Judge.measured", counted)
    monkeypatch.setattr("beamopt.search.loop._compiling", lambda *search: 0.0)
    result = optimize(memetic())
    assert result.evaluations == sum(judged)


def test_evaluations_of_the_next_generation_are_not_exceeded() -> None:
    scene = memetic()
    judge = Judge.of_scene(scene, scene.load_target())
    search = GeneticAlgorithm(scene, Improvement(judge, scene))
    search.tell(judge(search.ask()))
    before, allowed = search.evaluations, search.next_evaluations
    while search.tell(judge(search.ask())) is None:
        pass
    assert before < search.evaluations <= before + allowed
    assert Improvement(judge, scene).most_evaluations >= 1 + LITTLE.walks + LITTLE.steps


def test_without_a_share_there_is_no_such_stage() -> None:
    plain = optimize(memetic("search.improved_share=0.0"))
    search = GeneticAlgorithm(plain.scene)
    assert search.improvements == 0
    assert plain.evaluations == 6 + 3 * (2 * search.pairs + search.mutants)


@pytest.mark.parametrize("workers", [1, 3])
def test_a_memetic_search_goes_on_to_the_same_bytes(tmp_path: Path, workers: int) -> None:
    scene = memetic("refine.finish=true", "refine.rounds=1", "refine.flips=500")
    optimize(scene, tmp_path / "whole", figures=False)
    cut, calls = tmp_path / "cut", 0

    def stop(record: object) -> None:
        nonlocal calls
        calls += 1
        if calls == 3:
            raise KeyboardInterrupt

    optimize(scene, cut, callback=stop, figures=False)
    assert not (cut / "refined.json").exists()
    journal = cut / "journal.jsonl"
    journal.write_bytes(journal.read_bytes()[:-20])  # a kill in the middle of a line
    with in_process(workers) as executor:
        optimize(scene, cut, resume=True, executor=executor, workers=workers, figures=False)
    assert content(cut) == content(tmp_path / "whole")


def test_an_improvement_depends_on_generation_and_index_alone() -> None:
    scene = memetic()
    judge = Judge.of_scene(scene, scene.load_target())
    improve = Improvement(judge, scene)
    points = scene.random_points(np.random.default_rng(4))
    digests = {
        (generation, index): improve(points, generation, index)[0].digest
        for generation in (1, 2)
        for index in (0, 1)
    }
    assert len(set(digests.values())) > 1  # some find nothing better than what they got
    assert improve(points, 2, 1)[0].digest == digests[2, 1]
