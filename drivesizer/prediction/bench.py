"""A set at the bench by its part numbers and by conditions as one types them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from math import isnan, nan
from pathlib import Path

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.catalog.query import PartRow, find, open_catalogs
from drivesizer.errors import FieldError, InputError, quoted
from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.of_machine import load_cases
from drivesizer.prediction.machine import machine_of
from drivesizer.prediction.predict import completed, predict
from drivesizer.results.prediction import Conditions, Prediction
from drivesizer.spec.robot import RobotSpec, load_spec
from drivesizer.units import to_si

_LONGEST = 10_080.0  # minutes: a week
_ROOM = 298.15  # K
_KINDS = {
    "voltage": "voltage", "resistance": "resistance", "ambient": "temperature", "load": "torque", "hold": "torque",
    "inertia": "inertia", "warm": "temperature",
}  # fmt: skip


def predict_set(
    motor: str,
    gearhead: str | None = None,
    controller: str | None = None,
    *,
    catalogs: Iterable[str] = (),
    voltage: str | None = None,
    resistance: str | None = None,
    ambient: str | None = None,
    load: str | None = None,
    hold: str | None = None,
    inertia: str | None = None,
    minutes: float = 60.0,
    warm: str | None = None,
    spec: str | Path | None = None,
) -> Prediction:
    """Predict what is measured of a motor, or of an actuator, at the bench.

    Parameters
    ----------
    motor, gearhead, controller
        Part numbers; without a gearhead the motor alone, without a controller on the bare supply.
    catalogs
        Names of catalogues or paths of files; all that ship where none is given.
    voltage, resistance
        Of the supply, the first that of the motor where not given, the second with leads: usual ones where not given.
    ambient, warm
        Temperatures: around the motor, 25 degC where not given, and at a warm start, where not given the housing's
        after long nominal work.
    load, hold
        Torques at the output: against which it runs, by default the continuous one; and which it holds at rest.
    inertia
        Of what is mounted at the output; nothing where not given.
    minutes
        How long it runs at the load, and holds [min].
    spec
        Path of a robot.yaml whose machine gives voltage, resistance, ambient, inertia and both torques where these are
        not given: the largest at which its load moves steadily, and the largest that holds it.

    Returns
    -------
    Prediction
        Figures, each with its median and further percentiles of the spread [SI].

    Raises
    ------
    InputError
        When a part is in no catalogue, or a figure cannot be read.

    Examples
    --------
    >>> found = predict_set("118752", voltage="24 V", resistance="0 ohm", catalogs=["maxon"])
    >>> round(next(one for one in found.figures if one.name == "stall_torque").band.nominal, 2)
    0.24
    """
    if not 0.0 < minutes <= _LONGEST:
        expected = f"expected above 0, at most {_LONGEST:g}, e.g. 60"
        raise FieldError(("minutes",), f"minutes: {minutes:g} is out of range; {expected}")
    texts = {"voltage": voltage, "resistance": resistance, "ambient": ambient, "load": load, "hold": hold,
             "inertia": inertia, "warm": warm}  # fmt: skip
    read = {name: _read(name, text) for name, text in texts.items()}
    robot = None if spec is None else load_spec(spec)
    usual = {"ambient": _ROOM, "inertia": 0.0} if robot is None else of_machine(robot)
    conditions = Conditions(**read, duration=60.0 * minutes)
    conditions = conditions._replace(**{name: value for name, value in usual.items() if isnan(read[name])})
    shelf = open_catalogs(catalogs)
    sold = _part(shelf, motor, ("motors", "actuators"), "motor or actuator")
    if not isnan(conditions.voltage):  # else that of the row
        counts = sold.table.at_voltage(conditions.voltage)
        sold = replace(sold, row=next(row for row in sold.table.called(motor) if counts[row]))
    if sold.section == "actuators" and gearhead is not None:
        raise FieldError(
            ("gearhead",), f"gearhead: {quoted(motor)} is an actuator with its gear inside; leave the option out"
        )
    first = {sold.catalogue: shelf[sold.catalogue]} | shelf  # goes before others that have the same number
    gear = None if gearhead is None else _part(first, gearhead, ("gearheads",), "gearhead")
    drive = None if controller is None else _part(first, controller, ("controllers",), "controller")
    return predict(sold, gear, drive, completed(conditions, sold, gear), None if robot is None else machine_of(robot))


def of_machine(spec: RobotSpec) -> dict[str, float]:
    """Conditions at the output of a machine's gearhead, by name."""
    if len(spec.belt_ratios) > 1:
        raise FieldError(("spec",), f"spec: {spec.name} has a belt of several ratios; name one in transmission.ratios")
    belt, e = spec.belt_ratios[0], spec.belt_efficiency
    cycles = [load_cycle(case) for _, _, case in load_cases(spec)]
    moving, resting, inertia = 0.0, 0.0, 0.0
    for cycle in cycles:
        J = float(np.nan_to_num(cycle.inertia))
        steady, way = cycle.torque - J * cycle.acceleration, np.sign(cycle.speed)
        moving, inertia = max(moving, float((steady * way).max())), max(inertia, J)
        still = np.abs(steady[(cycle.speed == 0.0).all(axis=1)])
        resting = max(resting, float(still.max(initial=0.0)), float(np.nan_to_num(cycle.holding_torque)))
    return {
        "voltage": spec.supply.nominal, "resistance": nan if spec.supply.resistance is None else spec.supply.resistance,
        "ambient": spec.environment.ambient, "load": moving / (belt * e), "hold": resting / belt,
        "inertia": inertia / (belt**2 * e),
    }  # fmt: skip


def _read(name: str, text: str | None) -> float:
    """A condition in SI, but for temperatures not below 0, a voltage above it; NaN where it is not given."""
    kind = _KINDS[name]
    try:
        value = nan if text is None else to_si(text, kind)
    except InputError as error:
        raise FieldError((name,), f"{name}: {error}") from None
    if kind == "voltage" and value <= 0.0:
        raise FieldError((name,), f"{name}: {quoted(text or '')} is not above 0; expected e.g. 24 V")
    if kind != "temperature" and value < 0.0:
        raise FieldError((name,), f"{name}: {quoted(text or '')} is below 0; expected 0 or more")
    return value


_BARE = {  # what is no part number: pattern, what it is, and how it becomes a part
    "gearhead": (r"\d+(\.\d+)?(\s*:\s*1)?", "a ratio", "columns: [part, ratio], e.g. rows: [[G9, 9]] below gearheads"),
    "motor or actuator": (r"\d+(\.\d+)?\s*(kv|rpm/v)", "a speed constant",
      "columns: [part, speed_constant (rpm/V), resistance (ohm)], e.g. rows: [[M270, 270, 0.06]] below motors"),
}  # fmt: skip


def _part(shelf: Mapping[str, Catalog], part: str, sections: tuple[str, ...], what: str) -> PartRow:
    pattern, kind, row = _BARE.get(what, ("", "", ""))
    bare = pattern and re.fullmatch(pattern, part.strip().lower())  # many makers' part numbers are digits as well
    message = f"{quoted(part)} is {kind} and no part: give it in a catalogue file of your own, {row}"
    try:
        hits = find(shelf, part)
    except InputError:
        if bare:
            raise InputError(message) from None
        raise
    hit = next((hit for hit in hits if hit.section in sections), None)
    if hit is None and bare:
        raise InputError(message)
    if hit is None:
        raise InputError(f"{quoted(part)} is no {what} but in {hits[0].section}")
    return hit
