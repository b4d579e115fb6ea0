"""Why a search ended."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum

from beamopt.scene.scene import Scene
from beamopt.search.algorithm import GeneticAlgorithm
from beamopt.search.history import GenerationNumbers

__all__ = ["StopReason", "why_stop"]


class StopReason(Enum):
    """End of a search; the value is the text shown to people.

    Examples
    --------
    >>> import beamopt
    >>> beamopt.StopReason.SECONDS.goes_on
    True
    """

    GENERATIONS = "all generations done"
    EVALUATIONS = "the evaluations allowed are used up"
    SECONDS = "the time allowed is used up"
    STALL = "no lower L for as many generations as allowed"
    LOSS = "the loss asked for is reached"
    NOTHING = "no candidate could be judged"
    INTERRUPTED = "interrupted; --resume goes on"

    @property
    def goes_on(self) -> bool:
        """True if the search is not over: the same command with --resume continues it."""
        return self in (StopReason.INTERRUPTED, StopReason.SECONDS)


def why_stop(
    scene: Scene, search: GeneticAlgorithm, history: Sequence[GenerationNumbers], seconds: float
) -> StopReason | None:
    """The reason to stop after the last generation in `history`, or None to go on.

    seconds : time that judging anew has taken so far.
    """
    stop, last = scene.stop, history[-1]
    if stop.loss is not None and stop.loss >= last.ever_loss + last.ever_rule_loss:
        return StopReason.LOSS
    if last.generation >= scene.search.generations:
        return StopReason.GENERATIONS
    if stop.evaluations is not None:
        after = last.evaluations + search.next_evaluations
        if after > stop.evaluations:
            return StopReason.EVALUATIONS
    if stop.stall is not None and last.generation >= stop.stall:
        before = history[-1 - stop.stall]
        if before.ever_loss + before.ever_rule_loss <= last.ever_loss + last.ever_rule_loss:
            return StopReason.STALL
    if stop.seconds is not None and seconds > stop.seconds:
        return StopReason.SECONDS
    return None
