"""``drivesizer design``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from drivesizer.commands import common
from drivesizer.commands.common import DEFAULT, Fields, Processes, Scheduler, Spec, file_option
from drivesizer.errors import InputError, quoted


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
) -> None:
    """Find the best machine with its drive: free figures, limits, a front; what holds it and what may be rounded."""
    from drivesizer.study.workers import one_thread_each

    with one_thread_each():  # before NumPy is loaded
        from drivesizer.codesign.answer import answer
        from drivesizer.codesign.task import read_task
        from drivesizer.files.writing import write_files
        from drivesizer.files.yaml_source import read
        from drivesizer.output.terminal import render
        from drivesizer.output.terminal.tables import console

        source = common.with_fields(read(spec), fields or [])
        fronts = [one.strip() for one in pareto.split(",")] if pareto else None
        task = read_task(source, free=_spaces(free or []), minimise=minimise, subject_to=subject_to, pareto=fronts)
        kept = f"{folder}: what was sized is kept, and the same command resumes" if folder else "nothing is kept"
        with common.stoppable(f"stopped; {kept}"), common.progress("machines") as advance:
            found = answer(task, processes=processes, folder=folder, fresh=fresh, scheduler=scheduler, progress=advance)
    render.blocks(console(), found.blocks())
    if output and found.best:
        write_files({output: found.filled(rounded=rounded).encode()})
        typer.echo(f"\n{output}")
    raise typer.Exit(0 if found.best else 1)


def _spaces(words: list[str]) -> dict[str, Any]:
    """Free figures of the command line: a range, with steps or without, or a list."""
    from drivesizer.files.yaml_source import YamlSource

    found: dict[str, Any] = {}
    for word in words:
        name, sign, value = word.partition("=")
        if not sign or not value.strip():
            expected = "expected e.g. load.wheel_diameter='120 mm .. 250 mm step 10 mm', or 'load.driven_wheels=[2, 4]'"
            raise InputError(f"--free: {quoted(word)} is no field with its range; {expected}")
        text, _, step = value.partition(" step ")
        free = YamlSource(text.strip(), f"--free {name.strip()}").data
        found[name.strip()] = {"free": free} | ({"step": step.strip()} if step else {})
    return found
