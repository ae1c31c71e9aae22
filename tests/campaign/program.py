"""The program run on an input in this process: by the entry that the command line has, its output captured."""

from __future__ import annotations

import contextlib
import io
import json
import os
import shutil
import signal
import time
import traceback
import warnings
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path
from random import Random
from typing import Any, NamedTuple

import typer
from case import Case, laid
from changes import damaged_bytes

from drivesizer import cli
from drivesizer.cli import ended, parsed
from drivesizer.files import cache, text
from drivesizer.live.engine import EngineMemory, done
from drivesizer.live.requests import REQUESTS, request_of
from drivesizer.study import rows
from drivesizer.study import run as study_run

__all__ = ["HANG", "Ended", "HangError", "ran"]

HANG = 30.0  # s of processor time, from which on an input hangs
_PIECES = 3  # of an answer of the page: behind them figures are drawn


class HangError(BaseException):
    """An input takes longer than anybody waits; no Exception, so that nothing in the program catches it."""


class Ended(NamedTuple):
    """One command as it ended."""

    words: list[str]
    status: int
    out: str
    err: str
    error: BaseException | None  # as it reached the command's end
    leaked: list[str]  # warnings that a user would read
    before: dict[str, bytes]  # the folder's files
    after: dict[str, bytes]
    seconds: float  # of the processor


_PACKAGE = f"{Path(cli.__file__).parent}{os.sep}"
_COMMAND = typer.main.get_command(cli.app)


def ran(case: Case, folder: Path) -> list[Ended]:
    """The commands of an input, each as it ended; none follows one that failed.

    Parameters
    ----------
    case
        The input.
    folder
        Which is emptied before and after.

    Returns
    -------
    list[Ended]
        One for each command that ran.
    """
    _emptied(folder)
    laid(case, folder)
    found: list[Ended] = []
    with contextlib.chdir(folder), _own_folder(folder):
        for words in case.commands:
            found.append(_once(words))
            if found[-1].status:
                break
    _emptied(folder)
    return found


def _once(words: list[str]) -> Ended:
    caught: list[BaseException] = []
    run = INSIDE.get(words[0], _parsed)

    def recorded() -> int | None:
        try:
            return run(words)  # type: ignore[no-any-return, no-untyped-call]
        except BaseException as error:
            caught.append(error)
            raise

    out, err, before = io.StringIO(), io.StringIO(), _files()
    _forgotten()
    start = time.process_time()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), _limited(), _listened() as leaked:
        try:
            status = ended(recorded)
        except BaseException as error:  # the end itself failed
            caught, status = [error], 70
    seconds = time.process_time() - start
    said, error = (out.getvalue(), err.getvalue()), caught[0] if caught else None
    return Ended(words, status, *said, error, leaked, before, _files(), seconds)


def _parsed(words: list[str]) -> int | None:
    return parsed(lambda: _COMMAND(words, prog_name="drivesizer", standalone_mode=False), lambda: cli.app, words)


def _files() -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in sorted(Path().rglob("*")) if path.is_file()}


def _emptied(folder: Path) -> None:
    for path in folder.iterdir():
        shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()


@contextlib.contextmanager
def _own_folder(folder: Path) -> Iterator[None]:
    """A study's variants computed in this process; nothing else is replaced."""
    before = study_run.workers
    study_run.workers = lambda *_: contextlib.nullcontext()  # type: ignore[assignment]
    try:
        yield
    finally:
        study_run.workers = before


def _forgotten() -> None:
    """What a process remembers of files: each command has a process of its own at a terminal."""
    text._read.clear()
    rows._source.cache_clear()
    rows._catalog.cache_clear()


@contextlib.contextmanager
def _limited() -> Iterator[None]:
    def late(*_: Any) -> None:
        raise HangError(f"{HANG:g} s of processor time")

    before = signal.signal(signal.SIGPROF, late)
    signal.setitimer(signal.ITIMER_PROF, HANG)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


@contextlib.contextmanager
def _listened() -> Iterator[list[str]]:
    """Warnings as ``cli.main`` shows them: those of figures beyond all numbers are none."""
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        warnings.filterwarnings("ignore", category=RuntimeWarning)
        leaked: list[str] = []
        yield leaked
    leaked += [f"{w.category.__name__}: {w.message}" for w in heard if not issubclass(w.category, cache.CacheWarning)]


# --- what is no command -----------------------------------------------------------------------------------------------


def _damaged_cache(words: list[str]) -> int:
    """The same answer with compiled files damaged: by bytes, or whole and of another layout."""
    seed, how = json.loads(words[1])
    chance, place = Random(seed), Path("kept")
    with _cache_in(place):
        first = _sized()
        for path in sorted(place.glob("*")):
            body = path.read_bytes()
            if how == "bytes":
                path.write_bytes(damaged_bytes(body, chance))
            else:
                cache.keep(path, damaged_bytes(body[cache._DIGEST :], chance))
        second = _sized()
    shutil.rmtree(place)
    assert first == second, f"{first[:80]} and {second[:80]}"
    return 0


@contextlib.contextmanager
def _cache_in(place: Path) -> Iterator[None]:
    before = os.environ.get("DRIVESIZER_CACHE", "")
    os.environ["DRIVESIZER_CACHE"] = str(place)
    try:
        yield
    finally:
        os.environ["DRIVESIZER_CACHE"] = before


def _sized() -> str:
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.suppress(typer.Exit):
        _COMMAND(["size", "robot.yaml", "--json"], prog_name="drivesizer", standalone_mode=False)
    return said.getvalue()


def _live_request(words: list[str]) -> int:
    """A request of the page: refused as malformed, or answered in pieces that are JSON."""
    request = request_of(REQUESTS[words[1]], Path("request.json").read_bytes())
    held = EngineMemory("robot.yaml")
    for piece in islice(done(held, words[1], request), _PIECES):
        print(
            json.dumps(piece, allow_nan=False)
        )  # a browser reads it: what no terminal may show stands in it as \u0085
    return 0


INSIDE: dict[str, Callable[[list[str]], int]] = {"damaged cache": _damaged_cache, "live request": _live_request}


def origin(error: BaseException) -> str:
    """Where an error arose, as a class of finds: the last line of the program's own, and the error's name."""
    frames = traceback.extract_tb(error.__traceback__)
    last = ([frame for frame in frames if frame.filename.startswith(_PACKAGE)] or frames)[-1]
    place = last.filename.removeprefix(_PACKAGE)
    return f"{place}:{last.lineno} {last.name} {type(error).__name__}"
