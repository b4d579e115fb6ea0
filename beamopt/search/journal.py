"""The append-only journal of a search: what was judged, in order, one line a batch.

A journal holds verdicts, not genotypes: those follow from the scene by asking the algorithm again,
and a digest of each says whether they are the same. Every line ends with a digest of the rest of
it, which says whether the verdicts are those that were written; lines of beamopt-journal/1 have
none. A line that a kill cut off is dropped when the search goes on.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import TracebackType

from beamopt.base.errors import InputError
from beamopt.judge.judge import JudgeStatus, Verdict
from beamopt.search.algorithm import GeneticAlgorithm
from beamopt.section.feature_points import FeaturePoints
from beamopt.storage.input_file import check_regular
from beamopt.storage.line_journal import with_digest, without_digest
from beamopt.storage.writing import naming, refuse_link

__all__ = ["SearchJournal"]

HEADER = b'{"schema":"beamopt-journal/2"}\n'
WITHOUT_DIGESTS = b'{"schema":"beamopt-journal/1"}\n'

HEADERS = {HEADER.decode().rstrip(): True, WITHOUT_DIGESTS.decode().rstrip(): False}
"""First lines, and whether the lines after it have digests."""

FAILURES = {status.name for status in JudgeStatus if status is not JudgeStatus.JUDGED}


class SearchJournal:
    """A journal file, open for going on; use it as a context, in a folder that is claimed.

    Raises
    ------
    InputError : the file is no journal of a search, or a link.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        refuse_link(path)
        if path.exists():
            check_regular(path, None)  # opening a pipe would wait; a journal may be of any size
        self._stream = path.open("ab")
        try:
            self._lines = self._whole_lines()
            if not self._lines:
                self._append(HEADER)
            elif self._lines[0] not in HEADERS:
                expected = f"must be {HEADER.decode().rstrip()}"
                raise InputError(path, "line 1", self._lines[0], expected)
            self._digests = not self._lines or HEADERS[self._lines[0]]
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> SearchJournal:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        with naming(self.path):
            os.fsync(self._stream.fileno())
            self.close()

    def close(self) -> None:
        """Let go of the file."""
        self._stream.close()

    def _whole_lines(self) -> list[str]:
        """The lines of the file as it stands, after cutting off a last one that has no end."""
        content = self.path.read_bytes()
        whole = content[: content.rfind(b"\n") + 1]
        if not whole and not any(one.startswith(content) for one in (HEADER, WITHOUT_DIGESTS)):
            raise InputError(self.path, "line 1", None, "is no journal")
        if len(whole) < len(content):
            os.truncate(self.path, len(whole))
        return whole.decode("utf-8", errors="replace").splitlines()

    def replay(self, search: GeneticAlgorithm) -> Iterator[list[Verdict]]:
        """The verdicts on record, each batch checked against what `search` asks for now."""
        for number, line in enumerate(self._lines[1:], 2):
            verdicts = _verdicts(self._undigested(line), search)
            if verdicts is None:
                raise InputError(
                    self.path,
                    f"line {number}",
                    line,
                    f"not what this search judged in generation {search.generation} "
                    f"({search.stage.value}): damaged, changed, or made by another version; "
                    "cut the file off before the line to judge what follows again",
                )
            yield verdicts
        del self._lines[1:-1]  # those of a long search would fill the memory

    @property
    def last_generation(self) -> int:
        """The generation that the last line on record belongs to; 0 without any."""
        record = _decoded(self._undigested(self._lines[-1])) if self._lines[1:] else None
        return int(record["generation"]) if isinstance(record, dict) else 0

    def write(self, search: GeneticAlgorithm, verdicts: Sequence[Verdict]) -> None:
        """Append the verdicts on what `search` asks for; call it before telling them."""
        judged = zip(search.ask(), verdicts, strict=True)
        record: dict[str, object] = {
            "generation": search.generation,
            "stage": search.stage.key,
            "judged": [_entry(points, verdict, search.rules_set) for points, verdict in judged],
        }
        text = json.dumps(record, allow_nan=False, separators=(",", ":"))
        self._append(((with_digest(text) if self._digests else text) + "\n").encode())

    def _undigested(self, line: str) -> str:
        """The text that a line was written with; empty where it is another one now."""
        if not self._digests:
            return line
        try:
            return without_digest(line) or ""
        except ValueError:
            return ""

    def _append(self, line: bytes) -> None:
        with naming(self.path):
            self._stream.write(line)
            self._stream.flush()


def _entry(points: FeaturePoints, verdict: Verdict, with_rules: bool) -> list[object]:
    """Digest, L and K, also R with rules; for what is not judged null, null and the status."""
    if verdict.status is not JudgeStatus.JUDGED:
        return [points.digest, None, None, verdict.status.name]
    return [points.digest, verdict.L, verdict.K] + ([verdict.R] if with_rules else [])


def _decoded(line: str) -> object:
    try:
        return json.loads(line)
    except (ValueError, RecursionError):
        return None


def _verdicts(line: str, search: GeneticAlgorithm) -> list[Verdict] | None:
    """The verdicts in a line; None where it does not belong to what `search` asks for."""
    record = _decoded(line)
    if not isinstance(record, dict) or record.keys() != {"generation", "stage", "judged"}:
        return None
    if (record.get("generation"), record.get("stage")) != (search.generation, search.stage.key):
        return None
    asked, judged = search.ask(), record.get("judged")
    if not isinstance(judged, list) or len(judged) != len(asked):
        return None
    pairs, with_rules = zip(asked, judged, strict=True), search.rules_set
    verdicts = [_verdict(entry, points, with_rules) for points, entry in pairs]
    known = [verdict for verdict in verdicts if verdict is not None]
    return known if len(known) == len(verdicts) else None


def _verdict(entry: object, points: FeaturePoints, with_rules: bool) -> Verdict | None:
    """A verdict as `_entry` writes it; None for anything else."""
    match entry:
        case [digest, float(L), float(K)] if digest == points.digest and not with_rules:
            return _judged(L, K, 0.0)
        case [digest, float(L), float(K), float(R)] if digest == points.digest and with_rules:
            return _judged(L, K, R)
        case [digest, None, None, str(name)] if digest == points.digest and name in FAILURES:
            return Verdict(math.inf, math.inf, JudgeStatus[name])
    return None


def _judged(L: float, K: float, R: float) -> Verdict | None:
    """A verdict of losses that can be some."""
    possible = all(0 <= loss < math.inf for loss in (L, K, R))
    return Verdict(L, K, R=R) if possible else None
