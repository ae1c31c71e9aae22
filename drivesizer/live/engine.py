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
import time
import warnings
from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from importlib import import_module
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from drivesizer.errors import DrivesizerError, InputError, printable
from drivesizer.files.text import hand_over, state_of, states
from drivesizer.files.yaml_source import YamlSource, texts_in

Piece = dict[str, Any]
_LOOK = 0.01  # s between looks at newer requests
_SLOW, _REPEAT = 1.0, 0.3  # s after which progress is said, and said again
_MOST_SIZINGS = 4  # sizings: that of the page, and those of which someone wants a file or a comparison


class StoppedError(Exception):
    """A newer request has come: nobody waits for this answer."""


@dataclass(slots=True)
class EngineMemory:
    """Memory of a process of the engine between jobs."""

    name: str  # of the file that the page edits, as messages call it
    stopped: Callable[[], bool] = lambda: False
    sized: OrderedDict[str, Any] = field(default_factory=OrderedDict)  # sizings by their spec's text
    shelf: dict[str, Any] = field(default_factory=dict)  # shipped catalogues by name, each by itself
    own: tuple[str, ...] = ()  # names of the user's catalogues
    say: Callable[[Piece], None] = lambda _: None  # sends a piece beside those of the job
    next: float = 0.0  # s, moment from which progress is said

    def go_on(self, done: int = 0, total: int = 0) -> None:
        """Stop a job of which nobody wants the answer, and say how far it is, from some moment on now and then."""
        if self.stopped():
            raise StoppedError
        if 0 < done < total and time.monotonic() > self.next:
            self.next = time.monotonic() + _REPEAT
            self.say({"kind": "progress", "done": done, "all": total})

    def rest(self, seconds: float) -> None:
        """Wait for a newer request: while a slider moves nobody looks at more than the ranking."""
        for _ in range(round(seconds / _LOOK)):
            self.go_on()
            time.sleep(_LOOK)

    def keep(self, key: str, make: Callable[[], Any]) -> Any:
        """A sizing that was made before of the same files, or is made now."""
        sizing, files = self.sized.get(key, (None, {}))
        if sizing is None or any(state_of(name) != state for name, state in files.items()):
            before = states()
            sizing = make()
            files = states() | before  # of one that changes meanwhile the earlier state
            while len(self.sized) >= _MOST_SIZINGS:
                self.sized.popitem(last=False)
        self.sized[key] = sizing, files
        self.sized.move_to_end(key)
        return sizing


def take_over(memory: EngineMemory, own: Mapping[str, bytes]) -> None:
    """Take the user's catalogues in place of those before, and read them; what was found with these is forgotten."""
    from drivesizer.catalog import load

    hand_over({Path(memory.name).parent / name: content for name, content in own.items()})
    memory.own = tuple(own)
    memory.sized.clear()
    with suppress(DrivesizerError, MemoryError):  # said where it is used
        for name in own:
            load([name], beside=Path(memory.name).parent)


# -- The life of the process: one job after another.


_MEMORY = 4 << 30  # bytes that the process may take: some six times what a sizing with all its reports needs

OWN = "own catalogues"  # in place of a job: the user's, by name, from now on

CATALOGUE = {"catalogues", "parts", "part", "beside", "choose", "check"}  # jobs on catalogues, those beside on a spec


def done(memory: EngineMemory, job: str, request: Piece) -> Iterator[Piece]:
    """Pieces of the answer to a request; what is wrong with it is a piece as well."""
    try:
        module = import_module(f"drivesizer.live.{'catalogue' if job in CATALOGUE else 'answer'}")
        yield from getattr(module, job)(memory, request)
    except InputError as error:
        yield wrong(*error.lines)
    except DrivesizerError as error:
        yield wrong(str(error))
    except StoppedError:
        raise
    except MemoryError:
        memory.sized.clear()
        yield wrong("more memory is needed than there is")
    except Exception as error:  # whatever it is, the page goes on, and the terminal has it
        yield _fault(error)


def wrong(*lines: str) -> Piece:
    """A piece that says what is wrong."""
    return {"kind": "wrong", "lines": [*lines]}


def _fault(error: Exception) -> Piece:
    fault = printable(f"{type(error).__name__}: {error}"[:300])
    message = f"a fault of drivesizer itself ({fault}); please report it"
    print(f"drivesizer: {message}", file=sys.stderr, flush=True)
    return wrong(message)


def line(piece: Piece) -> bytes:
    """A piece as a line of JSON."""
    try:
        return json.dumps(piece, allow_nan=False, ensure_ascii=False).encode() + b"\n"
    except (TypeError, ValueError) as error:  # it has what JSON does not
        return line(_fault(error))


def run(pipe: Connection, unwanted: Any, file: str, spec: str | None, first: bool, folder: str) -> None:
    """Do jobs until the pipe is closed: the whole life of the process."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"  # before numpy
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the server, which ends this process
    warnings.filterwarnings("ignore", category=RuntimeWarning)  # a figure beyond all numbers is reported as unknown
    tempfile.tempdir = folder
    threading.Thread(target=_end_with_server, args=(folder,), daemon=True).start()
    _limit_memory()
    memory = EngineMemory(file)
    _open(memory, spec, first)
    memory.say = lambda piece: pipe.send_bytes(line(piece))
    number, memory.stopped = 0, lambda: bool(unwanted.value == number)  # of the job under way
    try:
        pipe.send_bytes(b"")
        while True:
            number, job, request = pipe.recv()
            if job == OWN:
                take_over(memory, request)
                pipe.send_bytes(b"")
                continue
            memory.next = time.monotonic() + _SLOW
            with suppress(StoppedError):
                for piece in done(memory, job, request):
                    pipe.send_bytes(line(piece))
            pipe.send_bytes(b"")
    except (EOFError, OSError):  # the server has ended
        shutil.rmtree(folder, ignore_errors=True)


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


def _open(memory: EngineMemory, spec: str | None, first: bool) -> None:
    """Size the spec, which warms the engine up; from then on only what it names is read, and shipped catalogues."""
    from drivesizer.files.text import restrict_reading, shipped_folder

    answer, below, named = import_module("drivesizer.live.answer"), Path(memory.name).parent, list[Path]()
    with suppress(InputError):  # each text of a spec may name a file
        named = [below / text for text in texts_in(YamlSource(spec or "", memory.name).data)]
    restrict_reading(named, [shipped_folder("catalogs"), Path(__file__).resolve().parents[1] / "catalog"])
    with suppress(DrivesizerError, MemoryError):  # the page says what is wrong when it shows the file
        if spec is not None and first:
            answer.whole(memory, spec, detail="headline")
