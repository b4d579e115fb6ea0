"""Texts that files of earlier versions held where a status belongs; for reading those files only.

They are fixed: nothing that is written today has them, and rewording a status changes none of them.
"""

from __future__ import annotations

__all__ = ["OLD_STOP_REASONS"]

OLD_STOP_REASONS = {
    "all generations done": "GENERATIONS",
    "the evaluations allowed are used up": "EVALUATIONS",
    "the time allowed is used up": "SECONDS",
    "no lower L for as many generations as allowed": "STALL",
    "the loss asked for is reached": "LOSS",
    "no candidate could be judged": "NOTHING",
    "interrupted; --resume goes on": "INTERRUPTED",
}
"""Names of `StopReason` by the "status" of a run's summary.json."""
