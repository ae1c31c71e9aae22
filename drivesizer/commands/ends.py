"""End of a command: every failure becomes one line on stderr and an exit status.

An error of the user's is printed as it is. Anything else is reported as a fault of the program, with the way to see
where it arose.
"""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Callable
from pathlib import Path

import typer

from drivesizer.commands.common import NothingFitsError
from drivesizer.errors import DrivesizerError, InputError, printable, reason_of

__all__ = ["FAULT", "STOPPED", "TRACEBACK", "ended"]

FAULT = 70  # exit status where the program itself is at fault, as in sysexits.h
STOPPED = 130  # and after Ctrl-C, as shells have it
_REFUSING = ("strict", "surrogateescape")  # of characters that the encoding lacks; the second in the locale C
TRACEBACK = "DRIVESIZER_TRACEBACK"  # set in the environment: a fault shows where it arose


def ended(command: Callable[[], int | None]) -> int:
    """Run a command; its exit status, after the one line that a failure ends in."""
    _opened()
    try:
        status = command() or 0
        sys.stdout.flush()  # what cannot be written shows here, and not when Python ends
    except BaseException as error:
        if os.environ.get(TRACEBACK):
            import traceback

            traceback.print_exc()
        message, status = _reported(error)
        for line in error.lines if isinstance(error, InputError) else [message]:
            _say(line)
        _forget_output()
    return status


def _reported(error: BaseException) -> tuple[str, int]:
    """Message and exit status of a failure; no message where the reader is gone or the user stopped the command."""
    if isinstance(error, NothingFitsError):
        return str(error), 1
    if isinstance(error, DrivesizerError):
        return str(error), 2
    if isinstance(error, KeyboardInterrupt | typer.Abort):
        return "", STOPPED
    if isinstance(error, BrokenPipeError | SystemExit):  # typer makes the second of the first: our reader went away
        return "", 0
    if isinstance(error, MemoryError):
        return "more memory is needed than there is", 2
    if isinstance(error, OSError):
        what = f"{error.filename}: cannot be read or written" if error.filename else "the output cannot be written"
        return f"{what} ({reason_of(error)})", 2
    found = f"{type(error).__name__}: {error}"[:300]
    return f"a fault of drivesizer itself ({found}); please report it; {TRACEBACK}=1 shows where it arose", FAULT


def _opened() -> None:
    """Have streams to write to that take every character, also where a shell closed them (``>&-``)."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, Path(os.devnull).open("w"))  # noqa: SIM115  until the process ends
        elif getattr(getattr(sys, name), "errors", "") in _REFUSING and hasattr(getattr(sys, name), "reconfigure"):
            getattr(sys, name).reconfigure(errors="backslashreplace")


def _say(message: str) -> None:
    if message:
        with contextlib.suppress(OSError):  # no message can be written
            print(f"drivesizer: {printable(' '.join(message.split()))}", file=sys.stderr, flush=True)


def _forget_output() -> None:
    """Let what is not written yet go nowhere, so that Python does not try again as it ends."""
    try:
        sys.stdout.flush()
    except (OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)
