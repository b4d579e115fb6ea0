"""Signals that ask a process to end, taken as Ctrl-C is: a search ends with what it has."""

from __future__ import annotations

import os
import signal
import sys
import threading

from beamopt.base.errors import EndedBySignalError

__all__ = ["INTERRUPTED", "exit_code", "heed_signals", "name_of_end"]

ENDING = {"SIGTERM": "terminated", "SIGHUP": "hung up"}
INTERRUPTED = 130  # exit code of Ctrl-C, as shells have it

AGAIN = 0.05  # s after which a signal that a library's callback swallowed is sent again

_received: list[int] = []


def heed_signals() -> None:
    """Let SIGTERM and SIGHUP end what is under way; one that is ignored, as by nohup, stays so."""
    sys.unraisablehook = _send_again
    for name in ENDING:
        number = getattr(signal, name, None)  # not every system has both
        if number is not None and signal.getsignal(number) == signal.SIG_DFL:
            signal.signal(number, _end)


def _end(number: int, _frame: object) -> None:
    _received.append(number)
    raise EndedBySignalError(number)


def _send_again(lost: sys.UnraisableHookArgs) -> None:
    """Send a signal again that came within a callback from C, which can not raise."""
    if not isinstance(lost.exc_value, KeyboardInterrupt):
        sys.__unraisablehook__(lost)
        return
    number = getattr(lost.exc_value, "number", signal.SIGINT)
    threading.Timer(AGAIN, os.kill, (os.getpid(), number)).start()


def exit_code() -> int:
    """The exit code of a command that was interrupted: 128 and the number of the signal."""
    return 128 + _received[0] if _received else INTERRUPTED


def name_of_end() -> str:
    """The word for how a command was interrupted."""
    return ENDING[signal.Signals(_received[0]).name] if _received else "interrupted"
