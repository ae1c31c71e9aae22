"""Shared by the commands: options, reading the spec, progress, notes, drives in closed loop."""

from __future__ import annotations

import re
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import replace
from functools import partial
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drivesizer.errors import DrivesizerError, InputError, NoLoopError, UnknownCatalogError, quoted

if TYPE_CHECKING:
    from drivesizer.control.validation import Validation
    from drivesizer.files.yaml_source import YamlSource
    from drivesizer.output.document import records as doc
    from drivesizer.results.drive_set import DriveSet
    from drivesizer.results.machine import MachineSizing
    from drivesizer.spec.machine import MachineSpec
    from drivesizer.spec.robot import RobotSpec


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
    """An option that takes a whole number, as typer has it."""
    return typer.Option(option, parser=_whole(option, example, low, high), metavar=metavar, help=meaning)


def number_option(option: str, example: float, *, meaning: str) -> Any:
    """An option that takes a number, of which what computes with it knows the range."""

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
Processes = Annotated[int, whole_option("--processes", 2, 0, 1024, meaning="Processes; 0 is one for each core.")]
Scheduler = Annotated[
    str | None, typer.Option(metavar="ADDRESS", help="A Dask scheduler whose workers compute instead.")
]
Fields = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="FIELD=VALUE", help="Another value of a field, e.g. load.mass=400kg; repeatable."),
]
DriveOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="MOTOR/GEARHEAD",
        help="A drive, e.g. 118752/406764, or lift=...; else the best. Or a field, load.mass=400kg.",
    ),
]  # fmt: skip
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
STOPPED = 130  # exit status after Ctrl-C, as shells have it
_PATIENCE = 1.0  # s, after which progress is shown


class NothingFitsError(DrivesizerError):
    """The input is valid and no drive meets all limits: exit status 1."""


def fields_and_drives(words: list[str] | None) -> tuple[list[str], list[str]]:
    """Values of ``--set`` for fields of the spec, and those for drives, which may be of an axis."""
    from drivesizer.spec.machine import MachineFields
    from drivesizer.spec.robot import RobotSpec

    fields, drives = list[str](), list[str]()
    for word in words or ():
        name, sign, value = word.partition("=")
        known = re.split(r"[.[]", name)[0].strip() in RobotSpec.model_fields.keys() | MachineFields.model_fields.keys()
        of_drive = "/" in value and "." not in name
        (fields if sign and known and not of_drive else drives).append(word)
    return fields, drives


def with_fields(source: YamlSource, words: list[str]) -> YamlSource:
    """A spec's text with other values in some of its fields."""
    from drivesizer.files.yaml_source import Edit, YamlSource, edited
    from drivesizer.study.figures import path_of, unknown_field

    edits, axes = [], source.data.get("axes") if isinstance(source.data, dict) else None
    for word in words:
        name, sign, value = word.partition("=")
        path = path_of(name.strip(), axes if isinstance(axes, dict) else ())
        if not sign or path is None:
            raise InputError(f"--set: {quoted(word)} is no field with its value; expected e.g. load.mass=400kg")
        indexed = isinstance(source.data, dict) and any(isinstance(step, int) for step in path)
        if indexed and (wrong := unknown_field(source, path)):  # of any other the reader knows more to say
            raise InputError(f"--set: {name.strip()}: {wrong}")
        edits.append(Edit(path, YamlSource(value.strip(), f"--set {name.strip()}").data, text=True))
    return YamlSource(edited(source.text, edits, source.name), source.name)


def load(
    path: Path, more: list[str] | None = None, axis: str | None = None, words: list[str] | None = None
) -> MachineSpec:
    """A machine, of which a plain spec is one axis; catalogues are added, whose paths count from the current folder."""
    from drivesizer.catalog import path_of, shipped
    from drivesizer.multi_axis import alone
    from drivesizer.spec.machine import is_machine, load_any

    if path == DEFAULT and not path.exists():
        raise InputError("robot.yaml: there is no such file here; `drivesizer init` writes one to start from")
    # once: a pipe has nothing more to read
    machine = load_any(path, (lambda source: with_fields(source, words)) if words else None)
    try:  # a file by its whole path, which is not beside the spec
        names = [name if name in ("all", *shipped()) else str(path_of(name).absolute()) for name in more or ()]
    except UnknownCatalogError as error:
        raise InputError(f"--catalog: {error}") from None

    def with_more(spec: RobotSpec) -> RobotSpec:
        select = spec.select.model_copy(update={"catalogs": list(dict.fromkeys([*spec.select.catalogs, *names]))})
        return spec.model_copy(update={"select": select})

    if axis is not None and not is_machine(machine.source):
        raise InputError(f"--axis: {path} has no axes; leave it out")
    machine = machine.changed(with_more) if names else machine
    return machine if axis is None else alone(machine, axis)


def load_chosen(
    path: Path, words: list[str] | None, more: list[str] | None, axis: str | None
) -> tuple[MachineSpec, list[str]]:
    """A machine with the fields that ``--set`` gives, and the drives that it names."""
    fields, drives = fields_and_drives(words)
    return load(path, more, axis, fields), drives


def one_drive(
    path: Path, words: list[str] | None, more: list[str] | None, axis: str | None, why: str
) -> tuple[RobotSpec, DriveSet]:
    """The spec and the drive of a single axis, named or the best; of several the one that is wanted must be named."""
    machine, drives = load_chosen(path, words, more, axis)
    if machine.is_several:
        raise InputError(f"--axis: expected one of {', '.join(axis.name for axis in machine.axes)}; {why}")
    return with_drives(machine, drives)[0][0][1:]


def load_axis(
    path: Path, more: list[str] | None = None, axis: str | None = None, words: list[str] | None = None
) -> RobotSpec:
    """Read the spec of a single axis, as :func:`load`; a machine of several is refused without one that is wanted."""
    machine = load(path, more, axis, words)
    if not machine.is_several:
        return machine.axes[0].spec
    names = [axis.name for axis in machine.axes] + (["a joint of its robot"] if machine.robot else [])
    raise InputError(f"{path}: a machine of several axes; expected --axis, one of {', '.join(names)}")


def sized(
    machine: MachineSpec, top: int, objective: str | None = None, sampling: tuple[Any, ...] = (),
    pareto: str | None = None, choices: int = 0,
) -> MachineSizing:  # fmt: skip
    """Size all axes of a machine."""
    from drivesizer.multi_axis import size_machine
    from drivesizer.search.ranking import objective_of
    from drivesizer.search.uncertainty.options import sampling_of

    rank, front = None if objective is None else objective_of(objective), _pareto(pareto)
    with progress() as advance:
        return size_machine(
            machine, top=top, objective=rank, pareto=front, progress=advance, choices=choices,
            sampling=lambda spec: sampling_of(spec, *sampling),
        )  # fmt: skip


def _pareto(text: str | None) -> tuple[str, ...]:
    """The objectives of a Pareto front."""
    from drivesizer.spec.drive import OBJECTIVES

    names = tuple(name.strip() for name in text.split(",")) if text else ()
    wrong = [name for name in names if name not in OBJECTIVES]
    if wrong:
        raise InputError(f"--pareto: {quoted(wrong[0])} is not known; expected {', '.join(OBJECTIVES)}")
    if text is not None and len(set(names)) < 2:
        raise InputError(f"--pareto: {quoted(text)} names one objective; expected several, e.g. mass,price,energy")
    return tuple(dict.fromkeys(names))


def with_drives(
    machine: MachineSpec, words: list[str] | None, top: int = 1
) -> tuple[list[tuple[str, RobotSpec, DriveSet]], MachineSizing | None]:
    """Name, spec and drive of each axis, by ``--set`` or the best; and the sizing, None where nothing was searched."""
    several = machine.is_several
    if words and not several:
        if len(words) > 1:
            raise InputError(f"--set: {quoted(words[1])} is a second drive of one axis; expected one")
        return [("", machine.axes[0].spec, _named(machine.axes[0].spec, words[0]))], None
    parts_by_axis = {}
    for text in words or ():
        axis, _, parts = text.partition("=")
        if not parts:
            expected = "expected AXIS=MOTOR/GEARHEAD, e.g. lift=118752/406764"
            raise InputError(f"--set: {quoted(text)} names no axis; {expected}")
        parts_by_axis[axis] = parts
    result = sized(machine, top)
    for name in parts_by_axis:
        result.axis(name)
    axes, drives = [], []
    for axis_sizing in result.axes:
        name, sizing = axis_sizing.name, axis_sizing.result
        if name in parts_by_axis:
            sizing = replace(sizing, sets=(_named(axis_sizing.spec, parts_by_axis[name]),))
        if not sizing.sets:
            text = "no drive meets all limits; `drivesizer size` shows the closest rejected"
            raise NothingFitsError(f"{name}: {text}" if several else f"{text}, --set names one to validate")
        axes.append(replace(axis_sizing, result=sizing))
        drives.append((name if several else "", axis_sizing.spec, sizing.sets[0]))
    return drives, replace(result, axes=tuple(axes))


def _named(spec: RobotSpec, text: str) -> DriveSet:
    """The drive of these parts that passes best, with any belt of the spec."""
    from drivesizer.results.check import GRAVEST
    from drivesizer.sizing import explain

    parts = [part.strip() for part in text.split("/")]
    if len(parts) > 2 or not all(parts):
        raise InputError(f"--set: {quoted(text)} is not MOTOR/GEARHEAD or ACTUATOR; expected e.g. 118752/406764")
    return min(explain(spec, *parts), key=lambda drive: (GRAVEST[::-1].index(drive.status), drive.rank))


def print_json(document: Any) -> None:
    """Print a document as JSON, and nothing else."""
    from drivesizer.output.json.documents import as_text

    typer.echo(as_text(document))


Report = Annotated[
    list[Path] | None,
    file_option("--report", metavar="FILE", help="Also as report.pdf, .html or .xlsx; may be repeated."),
]


def accept_reports(paths: Sequence[Path] | None) -> None:
    """Refuse reports that cannot be written, before time is spent on what goes into them."""
    if paths:
        from drivesizer.output.report import MEDIA, accept

        accept(paths, known=MEDIA)


def present(document: doc.Document, reports: Sequence[Path] | None = None) -> None:
    """Print a document, and write it to the files that are wanted."""
    from drivesizer.output.terminal import render

    written = []
    if reports:
        from drivesizer.output.report import write_document

        written = write_document(document, reports)
    render.document(document)
    print_written(written)


def show_blocks(blocks: Iterable[doc.Block]) -> None:
    """Print blocks of a document."""
    from drivesizer.output.terminal import render
    from drivesizer.output.terminal.tables import console

    render.blocks(console(), blocks)


def print_written(paths: Iterable[Path]) -> None:
    """Name the files that were written beside the answer, on stderr."""
    for path in paths:
        typer.echo(f"{path} written", err=True)


def print_notes(messages: Iterable[str], axis: str = "") -> None:
    """Print notes to stderr, a line each, of one axis or of the whole."""
    for message in messages:
        typer.echo(f"note: {axis}: {message}" if axis else f"note: {message}", err=True)


def print_notes_of_axes(notes_by_axis: Mapping[str, Iterable[str]]) -> None:
    """Print the notes of each axis; one that several axes have is a line that names them, or none where all have it."""
    axes: dict[str, list[str]] = {}
    for name, notes in notes_by_axis.items():
        for note in notes:
            axes.setdefault(note, []).append(name)
    for note, names in axes.items():
        print_notes([note], ", ".join(names) if len(names) < len(notes_by_axis) else "")


@contextmanager
def progress(of: str = "drives examined", after: float = _PATIENCE) -> Iterator[Callable[[int, int], None]]:
    """Progress bar on stderr with the remaining time, after some time [s]; earlier runs do not count for the speed."""
    bar: Any = None
    started, late = time.monotonic(), False

    def advance(done: int, total: int) -> None:
        nonlocal bar, late
        if not late and time.monotonic() - started >= after:
            from rich import progress as rich
            from rich.console import Console

            late, console = True, Console(stderr=True)
            if console.is_terminal and not console.is_dumb_terminal:
                bar = rich.Progress(
                    rich.TextColumn(of), rich.BarColumn(), rich.MofNCompleteColumn(), rich.TimeRemainingColumn(),
                    console=console, transient=True, speed_estimate_period=600.0,
                )  # fmt: skip
                bar.add_task(of, total=total, completed=done)
                bar.start()
        if bar is not None:
            bar.update(bar.task_ids[0], total=total, completed=done)

    try:
        yield advance
    finally:
        if bar is not None:
            bar.stop()


@contextmanager
def stoppable(message: str) -> Iterator[None]:
    """Work that Ctrl-C ends with a line on what is kept of it."""
    try:
        yield
    except KeyboardInterrupt:
        typer.echo(f"drivesizer: {message}", err=True)
        raise typer.Exit(STOPPED) from None


def simulating(on: str) -> AbstractContextManager[None]:
    """Status line of a simulation; the first one on a machine says what is made for all that follow."""
    import matplotlib

    from drivesizer.control.engine import is_compiled

    once = [] if is_compiled() else ["translating the simulation to machine code, some 10 s"]
    if not any(Path(matplotlib.get_cachedir()).glob("fontlist-*.json")):  # as python-control loads its figures
        once.append("listing the fonts of this machine, some 2 s")
    return working(f"{on}; first, once: {' and '.join(once)}" if once else on)


def at_a_terminal() -> bool:
    """Whether somebody is there to answer."""
    return sys.stdin.isatty() and sys.stdout.isatty()


def answer(question: str, read: Callable[[str], object]) -> str:
    """Request a text that a reader takes, again until it does; empty where nothing is said."""
    while True:
        text = str(typer.prompt(question, default="", show_default=False)).strip()
        if not text:
            return ""
        try:
            read(text)
        except DrivesizerError as error:
            typer.echo(str(error))
        else:
            return text


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
    timer = threading.Timer(_PATIENCE, line.start)
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        timer.join()
        line.stop()


# -- The recommended drives of a machine in closed loop, each in its hardest load case, or why they cannot be.


def _as_sized(spec: RobotSpec, drive: DriveSet) -> DriveSet:
    """A drive with the checks of ``size`` in a changed spec."""
    from drivesizer.sizing import explain

    same = [other for other in explain(spec, *drive.order_numbers.split("/")) if other.belt_ratio == drive.belt_ratio]
    return min(same, key=lambda other: other.rank, default=drive)


def proven(result: MachineSizing, profile: str | None = None) -> tuple[MachineSizing, dict[str, Validation]]:
    """A machine and the best drive of every axis in closed loop, with the drives that ride on it in its load."""
    axes, proofs, several = [], {}, not result.alone
    for axis in result.axes:
        sizing = axis.result
        axes.append(axis)
        if not sizing.sets:
            continue
        best, name = sizing.sets[0], axis.name if several else ""
        try:
            proofs[axis.name] = in_closed_loop(name, sizing.spec, best, others=sizing.sets[1:], profile=profile)
        except NoLoopError as error:
            reason = f"not simulated in {'open' if best.steps else 'closed'} loop: {error}"
            print_notes([reason if several else str(error)], name)
            axes[-1] = replace(axis, result=replace(sizing, warnings=(*sizing.warnings, reason)))
    return replace(result, axes=tuple(axes)), proofs


def in_closed_loop(
    name: str, spec: RobotSpec, drive: DriveSet, *, others: Sequence[DriveSet] = (),
    profile: str | None = None, case: str | None = None,
) -> Validation:  # fmt: skip
    """A drive in closed loop in its hardest load case, with what helps where it fails."""
    with simulating(f"simulating {name or 'the drive'} in closed loop"):  # whose libraries take a second to load
        from drivesizer.files.yaml_source import YamlOverlay
        from drivesizer.load_cases.of_machine import load_cases
        from drivesizer.simulate import hardest_case, validate, with_remedies
        from drivesizer.sizing import size

        hardest = case if case in [load_case for _, load_case, _ in load_cases(spec)] else hardest_case(spec, drive)
        try:
            proof = validate(spec, drive, profile=profile, load_case=hardest)
            more = others or size(spec, top=3).sets if proof.status == "fail" else ()
            # its fields are entered where they are in the file, where one of several is wanted as well
            own = str(spec.source.at[1]) if isinstance(spec.source, YamlOverlay) else ""
            return with_remedies(proof, spec, more, profile=profile, axis=name or own, sized=_as_sized)
        except NoLoopError:
            raise
        except InputError as error:
            raise (InputError(f"{name}: {error}") if name else error) from None
