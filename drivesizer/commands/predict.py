"""``drivesizer predict``."""

from __future__ import annotations

import sys
from dataclasses import replace
from math import isnan, nan
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drivesizer.commands.catalog import Names, open_named
from drivesizer.commands.common import Json, file_option, number_option, print_notes, working
from drivesizer.errors import InputError, quoted

if TYPE_CHECKING:
    from drivesizer.catalog import Catalog
    from drivesizer.catalog.query import Hit
    from drivesizer.results.prediction import Prediction

__all__ = ["predict"]

_LONGEST = 10_080.0  # minutes: a week
_FORMS = (".svg", ".png")


def predict(
    motor: Annotated[str, typer.Argument(metavar="MOTOR", help="Part number of a motor or an actuator.")],
    gearhead: Annotated[str | None, typer.Option(metavar="PART", help="Its gearhead; else none.")] = None,
    controller: Annotated[
        str | None, typer.Option(metavar="PART", help="Its controller; else the bare supply.")
    ] = None,
    catalogs: Names = None,
    voltage: Annotated[str | None, typer.Option(help="Of the supply; else the motor's nominal one.")] = None,
    resistance: Annotated[str, typer.Option(help="Of supply and leads.")] = "0 ohm",
    ambient: Annotated[str, typer.Option(help="Temperature around the motor.")] = "25 degC",
    load: Annotated[str | None, typer.Option(help="Torque at the output; else the continuous torque.")] = None,
    hold: Annotated[str | None, typer.Option(help="Torque held at rest; else the load.")] = None,
    inertia: Annotated[str, typer.Option(help="Of what is mounted at the output.")] = "0 kg*m^2",
    minutes: Annotated[
        float, number_option("--minutes", 60.0, meaning="How long it runs at the load, and holds.")
    ] = 60.0,
    warm: Annotated[
        str | None, typer.Option(help="Temperature at a warm start; else the housing's after long nominal work.")
    ] = None,
    json: Json = False,
    figure: Annotated[
        Path | None, file_option(metavar="FILE", help="Also draw line and temperatures: .svg or .png.")
    ] = None,
) -> None:
    """Predict what is measured of a set at the bench: each figure with its 5 to 95 % band."""
    from drivesizer.files.writing import ready, write_files
    from drivesizer.prediction.predict import completed
    from drivesizer.prediction.predict import predict as predicted
    from drivesizer.results.prediction import Conditions

    if not 0.0 < minutes <= _LONGEST:
        raise InputError(f"--minutes: {minutes:g} is out of range; expected above 0, at most {_LONGEST:g}, e.g. 60")
    given = Conditions(
        voltage=_read("voltage", voltage, "voltage"),
        ambient=_read("ambient", ambient, "temperature"),
        load=_read("load", load, "torque"),
        hold=_read("hold", hold, "torque"),
        inertia=_read("inertia", inertia, "inertia"),
        duration=60.0 * minutes,
        warm=_read("warm", warm, "temperature"),
        resistance=_read("resistance", resistance, "resistance"),
    )
    if figure is not None:
        if figure.suffix.lower() not in _FORMS:
            expected = f"expected {' or '.join(_FORMS)}"
            raise InputError(f"{quoted(figure.name)} does not say which kind of figure; {expected}")
        ready(figure)
    sold, gear, drive = _set(open_named(catalogs), motor, gearhead, controller, given.voltage)
    with working("predicting"):
        found = predicted(sold, gear, drive, completed(given, sold, gear))
    drawn = {}
    if figure is not None:
        from drivesizer.output.report.figures.cycle import bench

        form: Any = figure.suffix.lower().removeprefix(".")
        drawn = {figure: bench(found)(form)}
    try:  # none of the figure where the answer cannot be given, but to a reader who has enough
        _answer(found, json)
        sys.stdout.flush()
    except (BrokenPipeError, SystemExit):  # rich makes the second of the first
        write_files(drawn)
        raise
    for path in write_files(drawn):
        typer.echo(f"{path} written", err=True)


def _answer(found: Prediction, json: bool) -> None:
    if json:
        from drivesizer.output.json import behaviour, documents

        typer.echo(documents.as_text(behaviour.prediction(found)))
        return
    from drivesizer.output.terminal.prediction import predicted

    predicted(found)
    print_notes(found.warnings)


def _read(option: str, text: str | None, kind: str) -> float:
    """An option in SI, but for temperatures not below 0, a voltage above it; NaN where it is not given."""
    from drivesizer.units import to_si

    try:
        value = nan if text is None else to_si(text, kind)
    except InputError as error:
        raise InputError(f"--{option}: {error}") from None
    if kind == "voltage" and value <= 0.0:
        raise InputError(f"--{option}: {quoted(text or '')} is not above 0; expected e.g. 24 V")
    if kind != "temperature" and value < 0.0:
        raise InputError(f"--{option}: {quoted(text or '')} is below 0; expected 0 or more")
    return value


def _set(
    shelf: dict[str, Catalog], motor: str, gearhead: str | None, controller: str | None, volts: float
) -> tuple[Hit, Hit | None, Hit | None]:
    """The parts that are named: the motor's catalogue goes before others that have the same number."""
    sold = _part_found(shelf, motor, ("motors", "actuators"), "motor or actuator")
    if not isnan(volts):  # else that of the row
        counts = sold.table.at_voltage(volts)
        sold = replace(sold, row=next(row for row in sold.table.called(motor) if counts[row]))
    if sold.section == "actuators" and gearhead is not None:
        raise InputError(f"--gearhead: {quoted(motor)} is an actuator with its gear inside; leave the option out")
    first = {sold.catalogue: shelf[sold.catalogue]} | shelf
    gear = _part_found(first, gearhead, ("gearheads",), "gearhead") if gearhead is not None else None
    drive = _part_found(first, controller, ("controllers",), "controller") if controller is not None else None
    return sold, gear, drive


def _part_found(shelf: dict[str, Catalog], part: str, sections: tuple[str, ...], what: str) -> Hit:
    from drivesizer.catalog.query import find

    hits = find(shelf, part)
    for hit in hits:
        if hit.section in sections:
            return hit
    raise InputError(f"{quoted(part)} is no {what} but in {hits[0].section}")
