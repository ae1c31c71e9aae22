"""``drivesizer study``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drivesizer.commands.common import (
    Processes,
    Scheduler,
    file_argument,
    file_option,
    print_notes,
    progress,
    stoppable,
)
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
    over: Annotated[str | None, typer.Option("--map", metavar="A,B", help="The two fields that maps are over.")] = None,
    maps: Annotated[bool, typer.Option("--maps/--no-maps", help="Whether maps are drawn.")] = True,
) -> None:
    """Size every variant of a spec: tables and maps; the same command resumes after an interruption."""
    from drivesizer.study.workers import one_thread_each

    target = Path(path.stem) if folder is None else folder
    names = tuple(name.strip() for name in over.split(",")) if over else ()
    with one_thread_each():  # before NumPy is loaded
        from drivesizer.study.plan import read_study
        from drivesizer.study.run import carry_out

        plan = read_study(path)
        kept = f"{target}: stopped; results so far are kept, and the same command resumes"
        with stoppable(kept), progress("variants", 0.0) as advance:
            found = carry_out(
                plan, target, processes=processes, scheduler=scheduler, fresh=fresh, maps=names if maps else None,
                progress=advance,
            )  # fmt: skip
    status = ", ".join(f"{found.variants[name]} {name}" for name in _ORDER if found.variants[name])
    variants, drives = number_of(found.variants.total(), "variant"), number_of(found.examined, "drive")
    typer.echo(f"{variants}: {status}; {drives} examined")
    for written in found.written:
        typer.echo(written)
    print_notes(tuple(found.notes))
    raise typer.Exit(0 if any(found.variants[name] for name in ("pass", "open", "unknown")) else 1)
