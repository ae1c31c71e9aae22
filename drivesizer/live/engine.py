"""The process behind the page: it keeps catalogues in memory, does one job after another, and sends pieces."""

from __future__ import annotations

import json
import multiprocessing
import os
import shutil
import signal
import sys
import tempfile
import threading
import warnings
from collections.abc import Iterable, Iterator
from contextlib import suppress
from functools import partial
from importlib import import_module
from multiprocessing.connection import Connection
from typing import Any

from drivesizer.errors import DrivesizerError, InputError, printable
from drivesizer.live.held import EngineMemory, Piece, StoppedError, take_over

__all__ = ["INSIDE", "JOBS", "OWN", "done", "run"]

_FAULT = "a fault of drivesizer itself"
_MEMORY = 4 << 30  # bytes that the process may take: some six times what a sizing with all its reports needs

OWN = "own catalogues"  # in place of a job: the user's, by name, from now on

# name of a job: module with a function of that name, which yields pieces
JOBS = {
    "answer": "answer", "sweep": "answer", "rejected": "answer", "compare": "answer",
    "loop": "answer", "report": "answer", "export": "answer", "document": "answer",
    "catalogues": "catalogue", "parts": "catalogue", "part": "catalogue", "beside": "catalogue",
    "choose": "catalogue",
}  # fmt: skip
INSIDE = {"check": "catalogue"}  # jobs of the server alone


def done(held: EngineMemory, job: str, request: Piece) -> Iterator[Piece]:
    """Pieces of the answer to a request; what is wrong with it is a piece as well."""
    try:
        yield from getattr(import_module(f"drivesizer.live.{(JOBS | INSIDE)[job]}"), job)(held, request)
    except InputError as error:
        yield _wrong(error.lines)
    except DrivesizerError as error:
        yield _wrong([str(error)])
    except StoppedError:
        raise
    except MemoryError:
        held.sized.clear()
        yield _wrong(["more memory is needed than there is"])
    except Exception as error:  # whatever it is, the page goes on, and the terminal has it
        yield _fault(error)


def _wrong(lines: Iterable[str]) -> Piece:
    return {"kind": "wrong", "lines": list(lines)}


def _fault(error: Exception) -> Piece:
    found = printable(f"{type(error).__name__}: {error}"[:300])
    print(f"drivesizer: {_FAULT} ({found}); please report it", file=sys.stderr, flush=True)
    return _wrong([f"{_FAULT} ({found}); please report it"])


def _line(piece: Piece) -> bytes:
    try:
        return json.dumps(piece, allow_nan=False, ensure_ascii=False).encode() + b"\n"
    except (TypeError, ValueError) as error:  # it has what JSON does not
        return _line(_fault(error))


def run(pipe: Connection, unwanted: Any, file: str, spec: str | None, first: bool, folder: str) -> None:
    """Do jobs until the pipe is closed: the whole life of the process."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"  # before numpy
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the server, which ends this process
    warnings.filterwarnings("ignore", category=RuntimeWarning)  # a figure beyond all numbers is reported as unknown
    tempfile.tempdir = folder
    threading.Thread(target=_end_with_server, args=(folder,), daemon=True).start()
    _limit_memory()
    held = EngineMemory(file)
    _open(held, spec, first)
    try:
        pipe.send_bytes(b"")
        while True:
            number, job, request = pipe.recv()
            if job == OWN:
                take_over(held, request)
                pipe.send_bytes(b"")
                continue
            held.stopped = partial(_is, unwanted, number)
            with suppress(StoppedError):
                for piece in done(held, job, request):
                    pipe.send_bytes(_line(piece))
            pipe.send_bytes(b"")
    except (EOFError, OSError):  # the server has ended
        shutil.rmtree(folder, ignore_errors=True)


def _is(unwanted: Any, number: int) -> bool:
    return bool(unwanted.value == number)


def _end_with_server(folder: str) -> None:
    """Wait for the end of the server, which may have been killed, and end in the middle of whatever is computed."""
    server = multiprocessing.parent_process()
    if server is not None:
        server.join()
    shutil.rmtree(folder, ignore_errors=True)
    os._exit(0)


def _limit_memory() -> None:
    """Let a spec that needs too much memory end in an error, not in a machine without memory."""
    try:
        import resource
    except ImportError:  # not on every system
        return
    with suppress(ValueError, OSError):  # a lower limit is set already
        resource.setrlimit(resource.RLIMIT_DATA, (_MEMORY, _MEMORY))


def _open(held: EngineMemory, spec: str | None, first: bool) -> None:
    """Size the spec, which warms the engine up; from then on only what it names is read, and shipped catalogues."""
    from drivesizer.files.text import restrict_reading, shipped_folder
    from drivesizer.live.answer import named, whole

    restrict_reading(named(spec, held.name) if spec else [], [shipped_folder("catalogs")])
    with suppress(DrivesizerError, MemoryError):  # the page says what is wrong when it shows the file
        if spec is not None and first:
            whole(held, spec, brief=True)
