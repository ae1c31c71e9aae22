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
    from drivesizer.prediction.predict import completed
    from drivesizer.prediction.predict import predict as predicted
    from drivesizer.results.prediction import Conditions

    given = Conditions(
        voltage=_above_zero("voltage", voltage, "voltage"),
        ambient=_read("ambient", ambient, "temperature"),
        load=_not_below_zero("load", load, "torque"),
        hold=_not_below_zero("hold", hold, "torque"),
        inertia=_not_below_zero("inertia", inertia, "inertia"),
        duration=_duration(minutes),
        warm=_read("warm", warm, "temperature"),
        resistance=_not_below_zero("resistance", resistance, "resistance"),
    )
    form = _form(figure)
    sold, gear, drive = _set(open_named(catalogs), motor, gearhead, controller, given.voltage)
    given = completed(given, sold, gear)
    with working("predicting"):
        found = predicted(sold, gear, drive, given)
    _answered(found, json, _drawn(found, figure, form))


def _answered(found: Prediction, json: bool, drawn: dict[Path, bytes]) -> None:
    """Print the answer, and write its figure: none where the answer cannot be given, but to a reader who has enough."""
    from drivesizer.files.writing import write_files

    try:
        _say(found, json)
        sys.stdout.flush()
    except (BrokenPipeError, SystemExit):  # rich makes the second of the first
        write_files(drawn)
        raise
    for path in write_files(drawn):
        typer.echo(f"{path} written", err=True)


def _drawn(found: Prediction, figure: Path | None, form: Any) -> dict[Path, bytes]:
    if figure is None:
        return {}
    from drivesizer.output.report.figures.cycle import bench

    return {figure: bench(found)(form)}


def _say(found: Prediction, json: bool) -> None:
    if json:
        from drivesizer.output.json import behaviour as json_prediction
        from drivesizer.output.json import documents as json_documents

        typer.echo(json_documents.as_text(json_prediction.prediction(found)))
        return
    from drivesizer.output.terminal import prediction as terminal_prediction

    terminal_prediction.predicted(found)
    print_notes(found.warnings)


def _read(option: str, text: str | None, kind: str) -> float:
    """An option in SI; NaN where it is not given."""
    from drivesizer.units import to_si

    try:
        return nan if text is None else to_si(text, kind)
    except InputError as error:
        raise InputError(f"--{option}: {error}") from None


def _not_below_zero(option: str, text: str | None, kind: str) -> float:
    value = _read(option, text, kind)
    if value < 0.0:
        raise InputError(f"--{option}: {quoted(text or '')} is below 0; expected 0 or more")
    return value


def _above_zero(option: str, text: str | None, kind: str) -> float:
    if (value := _read(option, text, kind)) <= 0.0:
        raise InputError(f"--{option}: {quoted(text or '')} is not above 0; expected e.g. 24 V")
    return value


def _duration(minutes: float) -> float:
    if not 0.0 < minutes <= _LONGEST:
        raise InputError(f"--minutes: {minutes:g} is out of range; expected above 0, at most {_LONGEST:g}, e.g. 60")
    return 60.0 * minutes


def _form(figure: Path | None) -> Any:
    """The form that a file's name says; refuses a place that cannot be written."""
    if figure is None:
        return None
    from drivesizer.files.writing import ready

    if figure.suffix.lower() not in _FORMS:
        raise InputError(f"{quoted(figure.name)} does not say which kind of figure; expected {' or '.join(_FORMS)}")
    ready(figure)
    return figure.suffix.lower().removeprefix(".")


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
