"""``drivesizer size``, ``report``, ``explain``, ``quote`` and ``export``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drivesizer.commands import common
from drivesizer.commands.setup import start_by_questions
from drivesizer.errors import InputError

Objective = Annotated[
    str | None, typer.Option(help="mass, price, energy ... or several with weights, e.g. mass=2,price=1.")
]
Pareto = Annotated[str | None, typer.Option(metavar="NAMES", help="Also the Pareto front, e.g. of mass,price,energy.")]
Confidence = Annotated[
    float | None,
    common.number_option(
        "--confidence", 0.95, meaning="Only drives of which no check fails with this probability, e.g. 0.95."
    ),
]
Samples = Annotated[
    int | None, common.whole_option("--samples", 2000, meaning="Samples of each drive's tolerances; else the spec's.")
]
Seed = Annotated[
    int | None, common.whole_option("--seed", 1, meaning="Seed of the samples: the same seed gives the same figures.")
]
LoopSamples = Annotated[
    int | None,
    common.whole_option(
        "--loop-samples", 64, meaning="Samples in closed loop, of the best drives; 64 with a confidence, else 0."
    ),
]
Processes = Annotated[int, common.whole_option("--processes", 2, 1, 64, meaning="Processes that share the sampling.")]
_CHOICES = 200  # drives of a page, to choose from by weights


def size(
    spec: common.Spec = common.DEFAULT,
    top: common.Top = common.TOP,
    objective: Objective = None,
    pareto: Pareto = None,
    confidence: Confidence = None,
    samples: Samples = None,
    seed: Seed = None,
    loop_samples: LoopSamples = None,
    processes: Processes = 1,
    json: common.Json = False,
    csv: Annotated[Path | None, common.file_option(help="Also write the drives to this CSV file.")] = None,
    pdf: Annotated[Path | None, common.file_option(help="Also write the report to this PDF file.")] = None,
    checks: Annotated[bool, typer.Option("--checks", help="Also every check, and the operating figures.")] = False,
    derivation: Annotated[bool, typer.Option("--derivation", help="Also the requirements.")] = False,
    beside: Annotated[bool, typer.Option("--paper", help="Also the same drive by the other method.")] = False,
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="All of that, the next best, and why the others fail.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Only the drive, no alternatives, no notes.")] = False,
    axis: common.OfAxis = None,
    catalogs: common.More = None,
    fields: common.Fields = None,
) -> None:
    """Find the drive: parts list, verdict, tightest checks, alternatives."""
    from drivesizer.output import report as reports
    from drivesizer.output.terminal import sizing as terminal

    if spec == common.DEFAULT and not spec.exists() and not json and common.at_a_terminal():
        start_by_questions(spec)
    robot = common.load(spec, catalogs, axis, fields)
    reports.accept([pdf] if pdf else [], tables=[csv] if csv else [])
    result = common.sized(robot, top, objective, (confidence, samples, seed, processes, loop_samples), pareto)
    sizing, named = result.alone, "" if spec == common.DEFAULT else str(spec)
    if csv:
        reports.write_sets(sizing or result, csv)
    if pdf:
        simulated = common.proven(result)
        with common.working("writing the report"):
            reports.write(*simulated, [pdf])
    if json:
        common.print_json(result)
        raise typer.Exit(int(result.status == "fail"))
    options = {"checks": checks, "derivation": derivation, "paper": beside, "ranking": top != common.TOP}
    details = terminal.DETAILS if verbose else frozenset(name for name, on in options.items() if on)
    if sizing:
        terminal.sizing(sizing, details=details, spec=named, quiet=quiet)
        common.print_notes(() if quiet else sizing.warnings)
    else:
        each_alone = verbose or derivation or beside or pareto
        terminal.machine_sizing(result, spec=named, checks=checks or verbose, quiet=quiet, chapters=not each_alone)
        for axis_sizing in result.axes if each_alone else ():
            typer.echo()  # each has its name above it
            terminal.sizing(axis_sizing.result, details=details, quiet=True)
        common.print_notes_of_axes({} if quiet else {sizing.name: sizing.result.warnings for sizing in result.axes})
    raise typer.Exit(int(result.status == "fail"))


def report(
    output: Annotated[
        list[Path],
        common.file_option("--output", "-o", help="A file to write; may be repeated. Its suffix gives its kind."),
    ],
    spec: common.Spec = common.DEFAULT,
    top: common.Top = 10,
    profile: common.Profile = None,
    objective: Objective = None,
    pareto: Pareto = None,
    drawings: Annotated[
        Path | None, common.file_option("--figures", metavar="FOLDER", help="Also every figure, as SVG and as PNG.")
    ] = None,
    confidence: Confidence = None,
    samples: Samples = None,
    seed: Seed = None,
    loop_samples: LoopSamples = None,
    processes: Processes = 1,
    paper: Annotated[str, typer.Option(help="Sheets of the PDF: a4 or us-letter.")] = "a4",
    date: Annotated[str | None, typer.Option(metavar="TEXT", help="Date that the PDF and the page carry.")] = None,
    axis: common.OfAxis = None,
    catalogs: common.More = None,
    fields: common.Fields = None,
) -> None:
    """Write the report: .pdf, .html, .xlsx, .csv or .json, several at once."""
    from drivesizer.output import report as reports

    robot = common.load(spec, catalogs, axis, fields)
    reports.accept(output)
    choices = _CHOICES if any(path.suffix.lower() == ".html" for path in output) else 0
    how = confidence, samples, seed, processes, loop_samples
    result, proofs = common.proven(common.sized(robot, top, objective, how, pareto, choices), profile)
    with common.working("writing the report"):
        written = reports.write(result, proofs, output, paper=paper, date=date)
        written += reports.write_figures(result, proofs, drawings) if drawings else []
    for path in written:
        typer.echo(path)
    raise typer.Exit(int(result.status == "fail"))


def quote(
    output: Annotated[
        list[Path], common.file_option("--output", "-o", help="quote.csv or quote.xlsx; may be repeated for both.")
    ],
    spec: common.Spec = common.DEFAULT,
    objective: Objective = None,
    axis: common.OfAxis = None,
    catalogs: common.More = None,
    fields: common.Fields = None,
) -> None:
    """Write what to order: numbers, prices with date and seller, totals for each currency, and what is missing."""
    from drivesizer.output import report as reports
    from drivesizer.output.document.axes import content_of
    from drivesizer.output.document.quote import quote_lines
    from drivesizer.output.terminal import sizing as terminal

    robot = common.load(spec, catalogs, axis, fields)
    reports.accept(output, known=(".csv", ".xlsx"), kind="quote")
    result = common.sized(robot, 1, objective)
    if result.status == "fail":
        raise common.NothingFitsError(f"{spec}: no drive meets all limits: there is nothing to order; "
                                      "`drivesizer size` says what fails")  # fmt: skip
    written = reports.write_quote(result, output)
    terminal.quote_in_brief(quote_lines(content_of(result)))
    for path in written:
        typer.echo(path)


def explain(
    motor: Annotated[str, typer.Option(help="Part number of the motor, or of an actuator.")],
    gearhead: Annotated[str, typer.Option(help="Part number of the gearhead; `direct` is none.")] = "",
    spec: common.Spec = common.DEFAULT,
    samples: Samples = None,
    seed: Seed = None,
    loop_samples: LoopSamples = None,
    json: common.Json = False,
    axis: common.OfAxis = None,
    catalogs: common.More = None,
    fields: common.Fields = None,
) -> None:
    """Show why one combination of motor and gearhead passes or fails, check by check."""
    from drivesizer.output.terminal import sizing as terminal
    from drivesizer.search.shortlist import load_parts
    from drivesizer.search.uncertainty.options import sampling_of
    from drivesizer.sizing import explained

    robot, explanations = common.load(spec, catalogs, axis, fields), {}
    axes = {"": robot.axes[0].spec}
    if robot.is_several:  # each has the best drives of the others on it
        axes = {axis_sizing.name: axis_sizing.result.problem.machine for axis_sizing in common.sized(robot, 1).axes}
    for name, axis_spec in axes.items():
        with common.working(f"examining the drive on {name}" if name else "examining the drive"):
            try:
                sampling = sampling_of(axis_spec, samples=samples, seed=seed, loop=loop_samples)
                catalog = load_parts(axis_spec)
                explanations[name] = explained(axis_spec, motor, gearhead, catalog=catalog, sampling=sampling)
            except InputError as error:
                raise (InputError(f"{name}: {error}") if name else error) from None
    if json:
        axis_records = [{"name": name or robot.name, **record._asdict()} for name, record in explanations.items()]
        common.print_json({"axes": axis_records})
    elif alone := explanations.get(""):
        terminal.explained(alone, catalog)
        common.print_notes(alone.warnings)
    else:
        terminal.machine_explained(robot.name, explanations)
    raise typer.Exit(int(all(drive.status == "fail" for pair in explanations.values() for drive in pair.sets)))


def export(
    output: Annotated[Path, common.file_option("--output", "-o", help="The file to write.")],
    form: Annotated[str, typer.Option("--format", metavar="NAME", help="mjcf, urdf, sdf, ros2_control, fmu or json.")],
    spec: common.Spec = common.DEFAULT,
    chosen: common.DriveOption = None,
    axis: common.OfAxis = None,
    wheel: Annotated[
        int | None,
        common.whole_option(
            "--wheel", 1, metavar="N", meaning="Of a platform: the drive of one wheel; else the base with all."
        ),
    ] = None,
    catalogs: common.More = None,
) -> None:
    """Write a drive for a simulator: MuJoCo, URDF, Gazebo, ros2_control, an FMU, or plain JSON.

    A machine of several axes is one file, each axis a joint of its own whose names begin with the axis, but an FMU is
    one of an axis. mjcf, urdf and ros2_control have bodies: the base of a platform with all its wheels, and the links
    of a robot's description with its drives.
    """
    from drivesizer.output import export as exports

    robot, drives = common.load_chosen(spec, chosen, catalogs, axis)
    exports.accept(form, output)
    bodies = exports.FORMATS[form].bodies
    if wheel is not None and robot.is_several:
        raise InputError("--wheel: it is of a single axis; expected --axis beside it")
    if wheel is not None:
        exports.check_wheel(robot.axes[0].spec, wheel)  # before time is spent
    ((_, axis_spec, drive), *_), result = common.with_drives(robot, drives)
    with common.working("designing the controller"):
        if result and not result.alone:
            of = exports.machine_export(result, one_rate=form == "ros2_control", bodies=bodies)
        else:
            of = exports.drive_export(axis_spec, drive, wheel=wheel, bodies=bodies)
        written = exports.write(of, form, output)
    common.print_notes((*of.notes, *of.assumptions))
    for path in written:
        typer.echo(path)
