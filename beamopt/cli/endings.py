"""How a command ends: its exit code, and one line for whatever went wrong."""

from __future__ import annotations

from collections.abc import Sequence

import typer

from beamopt.errors import InputError, NoEquilibriumError

__all__ = ["finish"]

INTERRUPTED = 130  # exit code, as shells have it


def finish(app: typer.Typer, program: str, arguments: Sequence[str]) -> int:
    """Run a command; returns the exit code. Bad input is one line on standard error and 2."""
    try:
        code = app(list(arguments), standalone_mode=False)
    except InputError as error:
        return _complain(program, str(error))
    except NoEquilibriumError as error:
        return _complain(program, str(error), 1)
    except (typer.Abort, KeyboardInterrupt):
        return _complain(program, "interrupted", INTERRUPTED)
    except ImportError as error:
        missing = (error.name or str(error)).partition(".")[0]
        return _complain(program, f"{missing} is not installed: pip install 'beamopt[fem]'")
    except BrokenPipeError:
        return 0
    except OSError as error:
        file = error.filename2 or error.filename
        place = f"{file}: " if file else ""
        return _complain(program, f"{place}{(error.strerror or str(error)).lower()}")
    except Exception as error:
        # what the option parser refuses; its exception has no public name that stays
        if hasattr(error, "format_message"):
            said = error.format_message()
            return _complain(program, said) if said else 2  # help was asked for by giving nothing
        raise
    if code == INTERRUPTED:
        return _complain(program, "interrupted", code)
    return code if isinstance(code, int) else 0  # what a command gave typer.Exit


def _complain(program: str, text: str, code: int = 2) -> int:
    typer.echo(f"{program}: " + " ".join(text.split()), err=True)
    return code
