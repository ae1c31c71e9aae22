"""The process behind the page: it keeps catalogues in memory, does one job after another, and sends pieces."""

from __future__ import annotations

import json
import os
import signal
import sys
import warnings
from collections.abc import Iterator
from functools import partial
from importlib import import_module
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from drivesizer.errors import DrivesizerError, InputError, printable
from drivesizer.live.held import Held, Piece, StoppedError, take_over

__all__ = ["INSIDE", "JOBS", "OWN", "done", "run"]

_FAULT = "a fault of drivesizer itself"

OWN = "own catalogues"  # in place of a job: the user's, by name, from now on

# name of a job: module with a function of that name, which yields pieces
JOBS = {
    "answer": "answer", "sweep": "sweep", "rejected": "sweep", "compare": "compare",
    "loop": "files", "report": "files", "export": "files", "document": "files",
}  # fmt: skip
INSIDE = {"check": "own_catalogues"}  # jobs of the server alone


def done(held: Held, job: str, request: Piece) -> Iterator[Piece]:
    """Pieces of the answer to a request; what is wrong with it is a piece as well.

    Parameters
    ----------
    held
        What the process keeps.
    job
        One of ``JOBS`` or ``INSIDE``.
    request
        What the page sent.

    Yields
    ------
    Piece
        ``kind`` says what it is; ``wrong`` has the lines that the command line would print.
    """
    try:
        yield from getattr(import_module(f"drivesizer.live.{(JOBS | INSIDE)[job]}"), job)(held, request)
    except InputError as error:
        yield {"kind": "wrong", "lines": list(error.lines)}
    except DrivesizerError as error:
        yield {"kind": "wrong", "lines": [str(error)]}
    except StoppedError:
        raise
    except MemoryError:
        yield {"kind": "wrong", "lines": ["more memory is needed than there is"]}
    except Exception as error:  # whatever it is, the page goes on, and the terminal has it
        found = printable(f"{type(error).__name__}: {error}"[:300])
        print(f"drivesizer: {_FAULT} ({found}); please report it", file=sys.stderr, flush=True)
        yield {"kind": "wrong", "lines": [f"{_FAULT} ({found}); please report it"]}


def run(pipe: Connection, wanted: Any, name: str, again: bool) -> None:
    """Do jobs until the pipe is closed: the whole life of the process.

    Parameters
    ----------
    pipe
        Takes ``(number, job, request)``, gives ``number, piece`` as bytes; an empty piece ends a job.
    wanted
        Shared number of the job that is still wanted.
    name
        The file of the page.
    again
        Whether an earlier process ended: nothing is computed before the first request.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the server, which closes the pipe
    warnings.filterwarnings("ignore", category=RuntimeWarning)  # a figure beyond all numbers is reported as unknown
    held = Held(name)
    _opened(held, again)
    while True:
        try:
            number, job, request = pipe.recv()
        except (EOFError, OSError):
            return
        if job == OWN:
            take_over(held, request)
            continue
        held.stopped = partial(_unwanted, wanted, number)
        _sent(pipe, number, done(held, job, request))


def _unwanted(wanted: Any, number: int) -> bool:
    return bool(wanted.value != number)


def _sent(pipe: Connection, number: int, pieces: Iterator[Piece]) -> None:
    try:
        for piece in pieces:
            pipe.send_bytes(_framed(number, json.dumps(piece, allow_nan=False, ensure_ascii=False).encode()))
    except StoppedError:
        pass
    pipe.send_bytes(_framed(number, b""))


def _framed(number: int, body: bytes) -> bytes:
    return number.to_bytes(8, "big") + body


def _opened(held: Held, again: bool) -> None:
    """Read what the file names, which warms the engine up; nothing else of this machine is read from then on."""
    from drivesizer.files.cache import folder
    from drivesizer.files.shipped import shipped_folder
    from drivesizer.files.text import read_no_others
    from drivesizer.live.reading import whole

    path = Path(held.name)
    try:
        if path.is_file():
            whole(held, path.read_text(encoding="utf-8"), first=not again)
    except (DrivesizerError, OSError, ValueError):
        pass  # the page says what is wrong when it shows the file
    package = Path(__file__).resolve().parents[1]
    read_no_others([package, shipped_folder("catalogs"), folder()])
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
