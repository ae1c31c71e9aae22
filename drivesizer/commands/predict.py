"""``drivesizer predict``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from drivesizer.commands.catalog import Names
from drivesizer.commands.common import Json, file_option, number_option, print_json, print_notes, print_written, working
from drivesizer.errors import InputError, quoted

_FORMS = (".svg", ".png")


def predict(
    motor: Annotated[str, typer.Argument(metavar="MOTOR", help="Part number of a motor or an actuator.")],
    gearhead: Annotated[str | None, typer.Option(metavar="PART", help="Its gearhead; else none.")] = None,
    controller: Annotated[
        str | None, typer.Option(metavar="PART", help="Its controller; else the bare supply.")
    ] = None,
    catalogs: Names = None,
    voltage: Annotated[str | None, typer.Option(help="Of the supply; else the motor's nominal one.")] = None,
    resistance: Annotated[str | None, typer.Option(help="Of supply and leads; else none.")] = None,
    ambient: Annotated[str | None, typer.Option(help="Temperature around the motor; else 25 degC.")] = None,
    load: Annotated[str | None, typer.Option(help="Torque at the output; else the continuous torque.")] = None,
    hold: Annotated[str | None, typer.Option(help="Torque held at rest; else the load.")] = None,
    inertia: Annotated[str | None, typer.Option(help="Of what is mounted at the output; else nothing.")] = None,
    minutes: Annotated[
        float, number_option("--minutes", 60.0, meaning="How long it runs at the load, and holds.")
    ] = 60.0,
    warm: Annotated[
        str | None, typer.Option(help="Temperature at a warm start; else the housing's after long nominal work.")
    ] = None,
    spec: Annotated[
        Path | None, typer.Option(metavar="FILE", help="A robot.yaml: its machine gives what is not given here.")
    ] = None,
    json: Json = False,
    figure: Annotated[
        Path | None, file_option(metavar="FILE", help="Also draw line and temperatures: .svg or .png.")
    ] = None,
) -> None:
    """Predict what is measured of a set at the bench: each figure with its 5 to 95 % band."""
    from drivesizer.errors import FieldError
    from drivesizer.files.writing import ready, write_files
    from drivesizer.output.terminal.sizing import at_the_bench
    from drivesizer.prediction.bench import predict_set

    if figure is not None:
        if figure.suffix.lower() not in _FORMS:
            expected = f"expected {' or '.join(_FORMS)}"
            raise InputError(f"{quoted(figure.name)} does not say which kind of figure; {expected}")
        ready(figure)
    try:
        with working("predicting"):
            found = predict_set(
                motor, gearhead, controller, catalogs=catalogs or (), voltage=voltage, resistance=resistance,
                ambient=ambient, load=load, hold=hold, inertia=inertia, minutes=minutes, warm=warm,
                spec=spec,
            )  # fmt: skip
    except FieldError as error:
        raise InputError(f"--{error}") from None
    drawn = {}
    if figure is not None:
        from drivesizer.output.report.figures.cycle import bench

        form: Any = figure.suffix.lower().removeprefix(".")
        drawn = {figure: bench(found)(form)}
    try:  # none of the figure where the answer cannot be given, but to a reader who has enough
        if json:
            print_json(found)
        else:
            at_the_bench(found)
            print_notes(found.warnings)
        sys.stdout.flush()
    except (BrokenPipeError, SystemExit):  # rich makes the second of the first
        write_files(drawn)
        raise
    print_written(write_files(drawn))
