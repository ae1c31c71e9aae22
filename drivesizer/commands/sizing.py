"""``drivesizer size``, ``report`` and ``explain``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from drivesizer.commands.common import (
    DEFAULT,
    TOP,
    Json,
    More,
    OfAxis,
    Profile,
    Spec,
    Top,
    file_option,
    load_whole,
    number_option,
    print_notes,
    progress,
    proven,
    simulating,
    whole_option,
    working,
)
from drivesizer.commands.setup import interactive, start_by_questions
from drivesizer.errors import InputError, quoted

__all__ = ["explain", "report", "size"]

Objective = Annotated[
    str | None, typer.Option(help="mass, price, energy ... or several with weights, e.g. mass=2,price=1.")
]
Pareto = Annotated[str | None, typer.Option(metavar="NAMES", help="Also the Pareto front, e.g. of mass,price,energy.")]
Confidence = Annotated[
    float | None,
    number_option(
        "--confidence", 0.95, meaning="Only drives of which no check fails with this probability, e.g. 0.95."
    ),
]
Samples = Annotated[
    int | None, whole_option("--samples", 2000, meaning="Samples of each drive's tolerances; else the spec's.")
]
Seed = Annotated[
    int | None, whole_option("--seed", 1, meaning="Seed of the samples: the same seed gives the same figures.")
]
LoopSamples = Annotated[
    int | None,
    whole_option(
        "--loop-samples", 64, meaning="Samples in closed loop, of the best drives; 64 with a confidence, else 0."
    ),
]
Processes = Annotated[int, whole_option("--processes", 2, 1, 64, meaning="Processes that share the sampling.")]
_CHOICES = 200  # drives of a page, to choose from by weights


def size(
    spec: Spec = DEFAULT,
    top: Top = TOP,
    objective: Objective = None,
    pareto: Pareto = None,
    confidence: Confidence = None,
    samples: Samples = None,
    seed: Seed = None,
    loop_samples: LoopSamples = None,
    processes: Processes = 1,
    json: Json = False,
    csv: Annotated[Path | None, file_option(help="Also write the drives to this CSV file.")] = None,
    pdf: Annotated[Path | None, file_option(help="Also write the report to this PDF file.")] = None,
    checks: Annotated[bool, typer.Option("--checks", help="Also every check, and the operating figures.")] = False,
    derivation: Annotated[bool, typer.Option("--derivation", help="Also the requirements.")] = False,
    beside: Annotated[bool, typer.Option("--paper", help="Also the same drive by the other method.")] = False,
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="All of that, the next best, and why the others fail.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Only the drive, no alternatives, no notes.")] = False,
    axis: OfAxis = None,
    catalogs: More = None,
) -> None:
    """Find the drive: parts list, verdict, tightest checks, alternatives."""
    from drivesizer.output.report import accept, write, write_sets

    if spec == DEFAULT and not spec.exists() and not json and interactive():
        start_by_questions(spec)
    robot = load_whole(spec, catalogs, axis)
    accept([pdf] if pdf else [], tables=[csv] if csv else [])
    if hasattr(robot, "axes"):
        from drivesizer.commands.machine import size_machine_axes

        given = {"--pareto": pareto, "--paper": beside, "--derivation": derivation}
        sampling = confidence, samples, seed, processes, loop_samples
        shown = checks or verbose
        raise typer.Exit(size_machine_axes(robot, spec, csv, pdf, given, top, objective, sampling, shown, quiet, json))
    result = _sized(robot, top, objective, pareto, (confidence, samples, seed, processes, loop_samples))
    if csv:
        write_sets(result, csv)
    if pdf:
        with working("writing the report"):
            write(*proven(result), [pdf])
    if json:
        from drivesizer.output.json import documents as json_documents

        typer.echo(json_documents.as_text(json_documents.sizing(result)))
    else:
        from drivesizer.output.terminal import sizing as terminal

        chosen = {"checks": checks, "derivation": derivation, "paper": beside}
        chosen["ranking"] = top != TOP
        details = terminal.DETAILS if verbose else frozenset(name for name, wanted in chosen.items() if wanted)
        terminal.sizing(result, details=details, spec="" if spec == DEFAULT else str(spec), quiet=quiet)
        print_notes(() if quiet else result.warnings)
    raise typer.Exit(0 if result.sets else 1)


def _sized(
    robot: Any, top: int, objective: str | None, pareto: str | None, sampling: tuple[Any, ...], choices: int = 0
) -> Any:
    """The sizing by the options of ``size`` and ``report``; ``sampling`` are those of the samples."""
    from drivesizer.search.ranking import objective_of
    from drivesizer.search.uncertainty.options import sampling_of
    from drivesizer.sizing import size as sized

    samples, rank = sampling_of(robot, *sampling), None if objective is None else objective_of(objective)
    front = _pareto(pareto)
    with progress() as advance:
        return sized(
            robot, top=top, objective=rank, pareto=front, progress=advance, sampling=samples, choices=choices
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


def report(
    output: Annotated[
        list[Path], file_option("--output", "-o", help="A file to write; may be repeated. Its suffix gives its kind.")
    ],
    spec: Spec = DEFAULT,
    top: Top = 10,
    profile: Profile = None,
    objective: Objective = None,
    pareto: Pareto = None,
    drawings: Annotated[
        Path | None, file_option("--figures", metavar="FOLDER", help="Also every figure, as SVG and as PNG.")
    ] = None,
    confidence: Confidence = None,
    samples: Samples = None,
    seed: Seed = None,
    loop_samples: LoopSamples = None,
    processes: Processes = 1,
    paper: Annotated[str, typer.Option(help="Sheets of the PDF: a4 or us-letter.")] = "a4",
    date: Annotated[str | None, typer.Option(metavar="TEXT", help="Date that the PDF and the page carry.")] = None,
    axis: OfAxis = None,
    catalogs: More = None,
) -> None:
    """Write the report: .pdf, .html, .xlsx, .csv or .json, several at once."""
    from drivesizer.output.report import accept, write, write_figures

    robot = load_whole(spec, catalogs, axis)
    accept(output)
    if hasattr(robot, "axes"):
        from drivesizer.commands.machine import report_machine

        given, sampling = {"--pareto": pareto}, (confidence, samples, seed, processes, loop_samples)
        raise typer.Exit(report_machine(robot, output, given, top, objective, sampling, profile, drawings, paper, date))
    choices = _CHOICES if any(path.suffix.lower() == ".html" for path in output) else 0
    result = _sized(robot, top, objective, pareto, (confidence, samples, seed, processes, loop_samples), choices)
    with simulating("simulating the drive in closed loop"):
        result, proof = proven(result, profile)
    with working("writing the report"):
        written = write(result, proof, output, paper=paper, date=date)
        if drawings:
            written += write_figures(result, proof, drawings)
    for path in written:
        typer.echo(path)
    raise typer.Exit(0 if result.sets else 1)


def explain(
    motor: Annotated[str, typer.Option(help="Part number of the motor, or of an actuator.")],
    gearhead: Annotated[str, typer.Option(help="Part number of the gearhead; `direct` is none.")] = "",
    spec: Spec = DEFAULT,
    samples: Samples = None,
    seed: Seed = None,
    loop_samples: LoopSamples = None,
    json: Json = False,
    axis: OfAxis = None,
    catalogs: More = None,
) -> None:
    """Show why one combination of motor and gearhead passes or fails, check by check."""
    from drivesizer.search.uncertainty.options import sampling_of
    from drivesizer.sizing import explained, load_parts

    robot = load_whole(spec, catalogs, axis)
    if hasattr(robot, "axes"):
        from drivesizer.commands.machine import explain_axes

        raise typer.Exit(explain_axes(robot, motor, gearhead, (samples, seed, loop_samples), json))
    sampling = sampling_of(robot, samples=samples, seed=seed, loop=loop_samples)
    catalog = load_parts(robot)
    with working("examining the drive"):
        found = explained(robot, motor, gearhead, catalog=catalog, sampling=sampling)
    if json:
        from drivesizer.output.json import documents as json_documents

        typer.echo(json_documents.as_text(json_documents.explanation(found)))
    else:
        from drivesizer.output.terminal import sizing as terminal

        terminal.explained(found, catalog)
        print_notes(found.warnings)
    raise typer.Exit(0 if any(s.status != "fail" for s in found.sets) else 1)
