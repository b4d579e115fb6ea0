"""How a command ends: its exit code, and one line for whatever went wrong."""

from __future__ import annotations

import contextlib
import errno
import sys
from collections.abc import Sequence
from concurrent.futures import BrokenExecutor

import typer

from beamopt.base.errors import InputError, NoEquilibriumError, NotComputedError
from beamopt.cli.exit_codes import ExitCode
from beamopt.cli.signals import INTERRUPTED, exit_code, name_of_end
from beamopt.rod.status import RodStatus

__all__ = ["finish"]

OF_THE_MACHINE = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS, errno.EIO, errno.ENOMEM}
"""Errors of files that the input is not to blame for: the disk is full, or gives out."""


def finish(app: typer.Typer, program: str, arguments: Sequence[str]) -> int:
    """Run a command; returns the exit code. Bad input is one line on standard error and 2."""
    try:
        code = app(list(arguments), standalone_mode=False)
        sys.stdout.flush()
    except InputError as error:
        return _complain(program, str(error))
    except NoEquilibriumError as error:
        settled = not isinstance(error.status, RodStatus) or error.status.is_settled
        code = ExitCode.DOES_NOT_HOLD if settled else ExitCode.NOT_COMPUTED
        return _complain(program, str(error), code)
    except NotComputedError as error:
        return _complain(program, str(error), ExitCode.NOT_COMPUTED)
    except BrokenExecutor:
        return _complain(program, "a worker ended before its work was done", ExitCode.NOT_COMPUTED)
    except MemoryError:
        return _complain(program, "out of memory", ExitCode.NOT_COMPUTED)
    except (typer.Abort, KeyboardInterrupt):
        return _complain(program, name_of_end(), exit_code())
    except ImportError as error:
        if isinstance(error.__cause__ or error.__context__, KeyboardInterrupt):
            return _complain(program, name_of_end(), exit_code())  # a signal while it loaded
        missing = (error.name or str(error)).partition(".")[0]
        said = f"{missing} is not installed: pip install 'beamopt[fem]'"
        return _complain(program, said, ExitCode.NOT_COMPUTED)
    except BrokenPipeError:  # who reads has enough
        return 0
    except SystemExit as error:  # what typer makes of a pipe that breaks while it writes
        if isinstance(error.__context__, BrokenPipeError):
            return 0
        raise
    except OSError as error:
        # writing to standard output is all that has no file
        file = error.filename2 or error.filename or "standard output"
        said = f"{file}: {(error.strerror or str(error)).lower()}"
        return _complain(
            program,
            said,
            ExitCode.NOT_COMPUTED if error.errno in OF_THE_MACHINE else ExitCode.MISUSE,
        )
    except Exception as error:
        # what the option parser refuses; its exception has no public name that stays
        if hasattr(error, "format_message"):
            said = error.format_message()
            return (
                _complain(program, said) if said else ExitCode.MISUSE
            )  # help was asked for by no words
        raise
    if code == INTERRUPTED:  # what typer makes of Ctrl-C and the like
        return _complain(program, name_of_end(), exit_code())
    return code if isinstance(code, int) else 0  # what a command gave typer.Exit


def _complain(program: str, text: str, code: int = ExitCode.MISUSE) -> int:
    with contextlib.suppress(OSError):  # nobody reads it, as after the terminal was closed
        typer.echo(f"{program}: " + " ".join(text.split()), err=True)
    return code
