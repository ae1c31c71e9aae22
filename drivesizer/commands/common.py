"""Shared by the commands: options, reading the spec, progress, notes, drives in closed loop."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import replace
from functools import partial
from math import inf
from pathlib import Path
from typing import Annotated, Any

import typer

from drivesizer.errors import DrivesizerError, InputError, NoLoopError, UnknownCatalogError, quoted

__all__ = [
    "DEFAULT", "TOP", "Chosen", "Json", "More", "NothingFitsError", "OfAxis", "Profile", "Spec", "Top", "file_argument",
    "file_option", "load", "load_whole", "number_option", "print_notes", "progress", "proven", "proven_axes",
    "simulating", "whole_option", "working",
]  # fmt: skip


# -- Options and arguments of which typer would refuse a value in words of its own: numbers, and files.
#
# What is wrong with a number is said with its option, its range and an example; what is wrong with a file where it
# is read or written.


# typer looks whether a file may be read, also where it is one to write
file_option = partial(typer.Option, readable=False)
file_argument = partial(typer.Argument, readable=False)


class NumberError(DrivesizerError):
    """A number that an option does not take; no ValueError, which typer would say in words of its own."""


def whole_option(
    option: str, example: int, low: float = -inf, high: float = inf, *, meaning: str, metavar: str = "<int>"
) -> Any:
    """An option that takes a whole number, as typer has it.

    Parameters
    ----------
    option, meaning, metavar
        Its name, ``--top``, its line of the help, and what stands there for the number.
    example
        A number that it takes.
    low, high
        Smallest and largest that it takes; infinite where there is none, or where what computes with it knows them.

    Returns
    -------
    typer.Option
        For the annotation of a command's parameter.
    """
    return typer.Option(option, parser=_whole(option, example, low, high), metavar=metavar, help=meaning)


def number_option(option: str, example: float, *, meaning: str) -> Any:
    """An option that takes a number, of which what computes with it knows the range.

    Parameters
    ----------
    option, example, meaning
        As of :func:`whole_option`.

    Returns
    -------
    typer.Option
        For the annotation of a command's parameter.
    """

    def read(text: object) -> float:
        try:
            return float(str(text))
        except ValueError:
            raise NumberError(f"{option}: {quoted(text)} is not a number; expected e.g. {example:g}") from None

    return typer.Option(option, parser=read, metavar="<float>", help=meaning)


def _whole(option: str, example: int, low: float, high: float) -> Callable[[object], int]:
    """Reader of the number, also of a default.

    >>> _whole("--top", 3, 1, 1000)("x")
    Traceback (most recent call last):
    drivesizer.commands.common.NumberError: --top: "x" is not a whole number; expected 1 to 1000, e.g. 3
    """
    limits = f"{low:.0f} or more, " if high == inf else f"{low:.0f} to {high:.0f}, "
    expected = f"expected {limits if low > -inf else ''}e.g. {example}"

    def read(text: object) -> int:
        try:
            value = int(str(text))
        except ValueError:
            raise NumberError(f"{option}: {quoted(text)} is not a whole number; {expected}") from None
        if not low <= value <= high:
            raise NumberError(f"{option}: {quoted(text)} is out of range; {expected}")
        return value

    return read


# -- Shared by the commands: options, reading the spec, progress and notes.


Spec = Annotated[Path, file_argument(metavar="ROBOT.YAML", help="The spec; robot.yaml by default.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document and nothing else.")]
Top = Annotated[int, whole_option("--top", 3, 1, 1000, meaning="How many drives to show, at most 1000.")]
Chosen = Annotated[
    str | None, typer.Option("--set", metavar="MOTOR/GEARHEAD", help="A drive, e.g. 118752/406764; else the best.")
]
More = Annotated[
    list[str] | None,
    typer.Option("--catalog", metavar="NAME_OR_FILE", help="A catalogue beside the spec's, e.g. my_parts.yaml or all."),
]
DEFAULT = Path("robot.yaml")
TOP = 5  # drives of a sizing without --top
OfAxis = Annotated[str | None, typer.Option("--axis", metavar="NAME", help="An axis of a machine; else all of them.")]
Profile = Annotated[
    str | None,
    typer.Option(help="trapezoid, s-curve, or a CSV file of time and speed; alone, or without it, the spec's own."),
]
_PATIENCE = 1.0  # s, after which progress is shown


class NothingFitsError(DrivesizerError):
    """The input is valid and no drive meets all limits: exit status 1."""


def load(path: Path, more: list[str] | None = None, axis: str | None = None) -> Any:
    """Read the spec of a single axis and add catalogues; their paths are relative to the current folder.

    Parameters
    ----------
    path
        The spec, or a machine.
    more
        Further catalogues, by name or file.
    axis
        Of a machine: the one that is wanted, with the drives that ride on it, which are sized for that.

    Returns
    -------
    RobotSpec
        The spec.
    """
    return _single(_read(path, more), path, axis)


def _single(found: Any, path: Path, axis: str | None) -> Any:
    """The spec of a single axis, out of what a file has."""
    if not hasattr(found, "axes"):
        if axis is not None:
            raise InputError(f"--axis: {path} has no axes; leave it out")
        return found
    if axis is None and found.is_several:
        names = [one.name for one in found.axes] + (["a joint of its robot"] if found.robot else [])
        raise InputError(f"{path}: a machine of several axes; expected --axis, one of {', '.join(names)}")
    from drivesizer.multi_axis.sizing import laden

    return laden(found, found.axes[0].name if axis is None else axis)


def load_whole(path: Path, more: list[str] | None = None, axis: str | None = None) -> Any:
    """Read a spec, or a machine of several axes, and add catalogues.

    Parameters
    ----------
    path, more, axis
        As of ``load``; without an axis all of them.

    Returns
    -------
    RobotSpec or MachineSpec
        The latter of several axes.
    """
    found = _read(path, more)  # once: a pipe has nothing more to read
    return found if axis is None and getattr(found, "is_several", False) else _single(found, path, axis)


def _read(path: Path, more: list[str] | None) -> Any:
    """The file, and further catalogues in all its axes."""
    from drivesizer.spec.any_spec import load_any

    if path == DEFAULT and not path.exists():
        raise InputError("robot.yaml: there is no such file here; `drivesizer init` writes one to start from")
    spec: Any = load_any(path)
    if not more:
        return spec
    names = [_catalogue(name) for name in more]

    def with_more(one: Any) -> Any:
        select = one.select.model_copy(update={"catalogs": list(dict.fromkeys([*one.select.catalogs, *names]))})
        return one.model_copy(update={"select": select})

    if hasattr(spec, "axes"):
        return spec.changed(with_more)
    return with_more(spec)


def _catalogue(name: str) -> str:
    """Catalogue that an option names, for the spec: a file by its whole path, which is not beside the spec."""
    from drivesizer.catalog import path_of, shipped

    if name in ("all", *shipped()):
        return name
    try:
        return str(path_of(name).absolute())
    except UnknownCatalogError as error:
        raise InputError(f"--catalog: {error}") from None


def print_notes(messages: tuple[str, ...]) -> None:
    """Print notes to stderr, a line each."""
    for message in messages:
        typer.echo(f"note: {message}", err=True)


@contextmanager
def progress() -> Iterator[Callable[[int, int], None]]:
    """Progress bar on stderr for a search of more than a second."""
    bar: Any = None
    started, looked = time.monotonic(), False

    def advance(done: int, total: int) -> None:
        nonlocal bar, looked
        if not looked and time.monotonic() - started > _PATIENCE:
            from rich.console import Console
            from rich.progress import Progress

            looked, console = True, Console(stderr=True)
            if console.is_terminal and not console.is_dumb_terminal:
                bar = Progress(console=console, transient=True)
                bar.add_task("drives examined", total=total)
                bar.start()
        if bar is not None:
            bar.update(bar.task_ids[0], completed=done)

    try:
        yield advance
    finally:
        if bar is not None:
            bar.stop()


def simulating(on: str) -> AbstractContextManager[None]:
    """Status line of a simulation; one whose machine code is not at hand says that it is made first.

    Parameters
    ----------
    on
        The work, such as ``simulating the drive in closed loop``.

    Returns
    -------
    context manager
        Of :func:`working`.
    """
    from drivesizer.control.engine import is_compiled

    return working(on if is_compiled() else f"{on}; translating the simulation to machine code first, once, some 10 s")


@contextmanager
def working(on: str) -> Iterator[None]:
    """Status line on stderr after a second; nothing where stderr is no terminal."""
    if not sys.stderr.isatty():
        yield
        return
    from rich.console import Console

    console = Console(stderr=True)
    if console.is_dumb_terminal:  # which cannot take a line back
        yield
        return
    line = console.status(f"{on} ...")
    late = threading.Timer(_PATIENCE, line.start)
    late.start()
    try:
        yield
    finally:
        late.cancel()
        late.join()
        line.stop()


# -- The recommended drives of a sizing in closed loop, each in its hardest load case, or why they cannot be.


def proven(result: Any, profile: str | None = None, axis: str = "") -> tuple[Any, Any]:
    """A sizing and its best drive in closed loop; a note and a warning of the sizing where it cannot be simulated.

    Parameters
    ----------
    result
        The sizing.
    profile
        As of ``drivesizer validate``.
    axis
        Name of the axis in its machine, for the note.

    Returns
    -------
    tuple
        The sizing, and the Validation; None where no drive passes or a figure is unknown that the simulation needs.
    """
    from drivesizer.simulate import hardest_case, validate, with_remedies

    if not result.sets:
        return result, None
    best = result.sets[0]
    try:
        proof = validate(result.spec, best, profile=profile, load_case=hardest_case(result.spec, best))
        return result, with_remedies(proof, result.spec, result.sets, profile=profile)
    except NoLoopError as error:
        reason = f"not simulated in {'open' if best.steps else 'closed'} loop: {error}"
        print_notes((f"{axis}: {reason}" if axis else str(error),))
        return replace(result, warnings=(*result.warnings, reason)), None


def proven_axes(sizing: Any, profile: str | None = None) -> tuple[Any, dict[str, Any]]:
    """A machine and the best drive of every axis in closed loop, with the drives that ride on it in its load.

    Parameters
    ----------
    sizing
        The machine.
    profile
        As of :func:`proven`, for every axis.

    Returns
    -------
    tuple
        The MachineSizing, and the Validation of each axis that has one, by the axis' name.

    Raises
    ------
    InputError
        As ``validate``, with the name of the axis.
    """
    axes, proofs = [], {}
    for one in sizing.axes:
        with simulating(f"simulating {one.name} in closed loop"):
            try:
                result, proof = proven(one.result, profile, one.name)
            except InputError as error:
                raise InputError(f"{one.name}: {error}") from None
        axes.append(replace(one, result=result))
        if proof is not None:
            proofs[one.name] = proof
    return replace(sizing, axes=tuple(axes)), proofs
