"""The append-only journal of a search with several objectives: scores, a line a generation."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from beamopt.base.errors import InputError
from beamopt.judge.judge import JudgeStatus, Verdict
from beamopt.pareto.scores import Score
from beamopt.pareto.search import FrontSearch
from beamopt.scene.scene import Scene
from beamopt.section.feature_points import FeaturePoints
from beamopt.storage.input_file import read_bytes
from beamopt.storage.line_journal import LineJournal

__all__ = ["FrontJournal"]

NO_MATTER = {"stop", "refine", "description"}  # parts of a scene that change nothing here


class FrontJournal:
    """A journal of scores, open for going on; genotypes follow from the scene.

    last_generation : that the last line of the file was of when it was opened; -1 without any.

    Raises
    ------
    InputError : what is there is a journal of another question, or damaged.
    """

    def __init__(
        self, path: Path, scene: Scene, objectives: Sequence[str], population: int
    ) -> None:
        kept = scene.model_dump(mode="json", by_alias=True, exclude=NO_MATTER)
        del kept["search"]["generations"], kept["search"]["population"]
        kept["target"] |= {"file": None, "paths": []}  # wherever they are, what they hold counts
        asked = {
            "schema": "beamopt-pareto/1",
            "objectives": list(objectives),
            "population": population,
            "scene": kept,
            "target": _digest(scene),
        }
        self.path = path
        self._lines = LineJournal(path, asked, "search for a front")
        self.last_generation = len(self._lines.entries) - 1

    def replay(self, search: FrontSearch) -> Iterator[list[Score]]:
        """The scores on record, each generation checked against what `search` asks for now."""
        entries = list(self._lines.entries)
        self._lines.entries.clear()  # a long search's would fill the memory
        for number, entry in enumerate(entries, 2):
            asked, judged = search.ask(), entry.get("judged")
            if entry.get("generation") != search.generation or not isinstance(judged, list):
                raise self._other(number)
            if len(judged) != len(asked):
                raise self._other(number)
            pairs = zip(asked, judged, strict=True)
            scores = [_score(written, points) for points, written in pairs]
            known = [score for score in scores if score is not None]
            if len(known) < len(scores):
                raise self._other(number)
            yield known

    def write(self, search: FrontSearch, scores: Sequence[Score]) -> None:
        """Append the scores of what `search` asks for; call it before telling them."""
        pairs = zip(search.ask(), scores, strict=True)
        judged = [_entry(points, score) for points, score in pairs]
        self._lines.add({"generation": search.generation, "judged": judged}, keep=False)

    def _other(self, number: int) -> InputError:
        said = (
            "not what this search judged there; the journal was changed, or made by another version"
        )
        return InputError(self._lines.path, f"line {number}", None, said)


def _digest(scene: Scene) -> str:
    """Of what the target's files hold."""
    state = hashlib.blake2b(digest_size=8)
    for file in scene.target.files:
        state.update(read_bytes(Path(file)))
    return state.hexdigest()


def _entry(points: FeaturePoints, score: Score) -> list[Any]:
    """Digest, L, K, R, ratio, mass, chambers; for what is not judged digest, status, too many."""
    verdict = score.verdict
    if not score.judged:
        return [points.digest, verdict.status.name, score.too_many]
    losses = verdict.L, verdict.K, verdict.R
    return [points.digest, *losses, score.ratio, score.mass, list(score.chambers)]


def _score(written: object, points: FeaturePoints) -> Score | None:
    """A score as `_entry` writes it; None for anything else."""
    match written:
        case [digest, str(name), int(many)] if digest == points.digest:
            if (
                name not in JudgeStatus.__members__
                or JudgeStatus[name] is JudgeStatus.JUDGED
                or many < 0
            ):
                return None
            failed = Verdict(math.inf, math.inf, JudgeStatus[name])
            return Score(failed, math.inf, math.inf, (0, 0, 0), many)
        case [digest, *numbers, [int(a), int(b), int(c)]] if digest == points.digest:
            losses = [one for one in numbers if isinstance(one, float) and 0 <= one < math.inf]
            if len(numbers) != 5 or len(losses) != 5 or min(a, b, c) < 0:
                return None
            L, K, R, ratio, mass = losses
            return Score(Verdict(L, K, R=R), ratio, mass, (a, b, c), 0)
    return None
