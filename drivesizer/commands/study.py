"""``drivesizer study`` and ``drivesizer design``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from drivesizer.commands import common
from drivesizer.commands.common import DEFAULT, Fields, Processes, Scheduler, Spec, file_argument, file_option
from drivesizer.errors import InputError, quoted
from drivesizer.output.words import number_of

_ORDER = ("pass", "open", "unknown", "fail", "error")


def study(
    path: Annotated[Path, file_argument(metavar="STUDY.YAML", help="The study; study.yaml by default.")] = Path(
        "study.yaml"
    ),
    folder: Annotated[
        Path | None,
        file_option("--output", "-o", metavar="FOLDER", help="Folder of the results; else here, named as the study."),
    ] = None,
    processes: Processes = 0,
    scheduler: Scheduler = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Begin anew; results that are there are lost.")] = False,
    chunks: Annotated[
        bool, typer.Option("--chunks", help="Workers write the rows, as Parquet: FOLDER/chunks is the table.")
    ] = False,
    over: Annotated[str | None, typer.Option("--map", metavar="A,B", help="The two fields that maps are over.")] = None,
    maps: Annotated[bool, typer.Option("--maps/--no-maps", help="Whether maps are drawn.")] = True,
    report: common.Report = None,
) -> None:
    """Size every variant of a spec: tables and maps; the same command resumes after an interruption."""
    from drivesizer.study.run import one_thread_each

    common.accept_reports(report)
    target = Path(path.stem) if folder is None else folder
    names = tuple(name.strip() for name in over.split(",")) if over else ()
    with one_thread_each():  # before NumPy is loaded
        from drivesizer.study.plan import read_study
        from drivesizer.study.run import carry_out

        plan = read_study(path)
        message = f"{target}: stopped; results so far are kept, and the same command resumes"
        with common.stoppable(message), common.progress("variants", 0.0) as advance:
            outcome = carry_out(
                plan, target, processes=processes, scheduler=scheduler, fresh=fresh, maps=names if maps else None,
                chunks=chunks, progress=advance,
            )  # fmt: skip
    status = ", ".join(f"{outcome.variants[name]} {name}" for name in _ORDER if outcome.variants[name])
    variants, drives = number_of(outcome.variants.total(), "variant"), number_of(outcome.examined, "drive")
    typer.echo(f"{variants}: {status}; {drives} examined")
    for written in outcome.written:
        typer.echo(written)
    if report:
        from drivesizer.output.report import write_document
        from drivesizer.study.document import document_of

        for file in write_document(document_of(outcome), report):
            typer.echo(file)
    common.print_notes(tuple(outcome.notes))
    raise typer.Exit(0 if any(outcome.variants[name] for name in ("pass", "open", "unknown")) else 1)


def design(
    spec: Spec = DEFAULT,
    output: Annotated[
        Path | None, file_option("--output", "-o", help="Write the spec with the best figures to this file.")
    ] = None,
    rounded: Annotated[bool, typer.Option("--rounded", help="Write the rounded figures instead.")] = False,
    free: Annotated[
        list[str] | None,
        typer.Option(metavar="FIELD=RANGE", help="A free figure: load.mass='9 kg .. 12 kg step 1 kg'; repeatable."),
    ] = None,
    minimise: Annotated[
        str | None, typer.Option(metavar="EXPRESSION", help="In place of the spec's: mass, price.")
    ] = None,
    subject_to: Annotated[
        list[str] | None, typer.Option(metavar="LIMIT", help="A limit, e.g. 'autonomy >= 3 h'; repeatable.")
    ] = None,
    pareto: Annotated[str | None, typer.Option(metavar="A,B", help="Figures of a front, e.g. mass,energy.")] = None,
    folder: Annotated[
        Path | None, file_option("--folder", metavar="FOLDER", help="Keep all machines here; the same command resumes.")
    ] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Begin anew in that folder.")] = False,
    processes: Processes = 0,
    scheduler: Scheduler = None,
    fields: Fields = None,
    report: common.Report = None,
) -> None:
    """Find the best machine with its drive: free figures, limits, a front; what holds it and what may be rounded."""
    from drivesizer.study.run import one_thread_each

    common.accept_reports(report)
    with one_thread_each():  # before NumPy is loaded
        from drivesizer.codesign.answer import answer
        from drivesizer.codesign.task import read_task
        from drivesizer.files.writing import write_files
        from drivesizer.files.yaml_source import read
        from drivesizer.output.document import records as doc

        source = common.with_fields(read(spec), fields or [])
        fronts = [name.strip() for name in pareto.split(",")] if pareto else None
        task = read_task(source, free=_spaces(free or []), minimise=minimise, subject_to=subject_to, pareto=fronts)
        message = f"{folder}: what was sized is kept, and the same command resumes" if folder else "nothing is kept"
        with common.stoppable(f"stopped; {message}"), common.progress("machines") as advance:
            result = answer(
                task, processes=processes, folder=folder, fresh=fresh, scheduler=scheduler, progress=advance
            )
    sections = [doc.section("design", "The best machine", result.blocks())]
    common.present(doc.Document(name=source.name, subject="design", headed=False, sections=sections), report)
    if output and result.best:
        write_files({output: result.filled(rounded=rounded).encode()})
        typer.echo(f"\n{output}")
    raise typer.Exit(0 if result.best else 1)


def _spaces(words: list[str]) -> dict[str, Any]:
    """Free figures of the command line: a range, with steps or without, or a list."""
    from drivesizer.files.yaml_source import YamlSource

    spaces: dict[str, Any] = {}
    for word in words:
        name, sign, value = word.partition("=")
        if not sign or not value.strip():
            expected = "expected e.g. load.wheel_diameter='120 mm .. 250 mm step 10 mm', or 'load.driven_wheels=[2, 4]'"
            raise InputError(f"--free: {quoted(word)} is no field with its range; {expected}")
        text, _, step = value.partition(" step ")
        free = YamlSource(text.strip(), f"--free {name.strip()}").data
        spaces[name.strip()] = {"free": free} | ({"step": step.strip()} if step else {})
    return spaces
