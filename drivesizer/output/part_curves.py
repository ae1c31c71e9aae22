"""Speed over torque of a motor or an actuator's output as curves with names, and how pull-out torque was measured."""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan, nan
from typing import Any, NamedTuple

import numpy as np

from drivesizer.catalog import columns_of
from drivesizer.catalog.parts import PullOuts
from drivesizer.catalog.query import Hit
from drivesizer.machine.part_curves import continuous_curve, line
from drivesizer.output.words import figure
from drivesizer.physics.thermal import data_temperature, rated_ambient
from drivesizer.units import show

_READ = 3.0  # times the nominal torque, the end of the axis; a large motor's stall is at 40 times


class Curve(NamedTuple):
    """Points over torque [N*m] of speed [rad/s]."""

    kind: str  # line, continuous, peak, or nominal, a single point
    name: str
    torque: Sequence[float]
    speed: Sequence[float]


def reach_of(hit: Hit) -> float:
    """End of the torque axis [N*m]: stall, or less where stall is far beyond the nominal torque; NaN unknown."""
    ends, continuous = line(hit), continuous_curve(hit)[0]
    nominal = hit["nominal_torque"]
    if isnan(nominal):
        own = 0.0 if isnan(hit["no_load_current"]) else hit["no_load_current"]
        nominal = hit["torque_constant"] * (hit["nominal_current"] - own)
    cut = ends.torque * (1.0 - min(hit["max_speed"] / ends.speed, 1.0))  # where the line starts, at the top speed
    wanted = [x for x in (_READ * nominal, _READ * max(continuous, default=nan), 2.0 * cut) if x > 0.0]
    return min([*([max(wanted)] if wanted else []), *([] if isnan(ends.torque) else [ends.torque])], default=nan)


def speed_torque(hit: Hit) -> list[Curve]:
    """The line, the continuous region, peak and nominal torque, as far as known; nothing without a line or region."""
    ends, reach = line(hit), reach_of(hit)
    found = [] if isnan(ends.torque) else [_line(hit, ends, reach)]
    torque, speed = continuous_curve(hit)
    if torque:
        around = show(float(rated_ambient(hit)), "degC", "temperature")
        found.append(Curve("continuous", f"continuous, at {around} around the motor", torque, speed))
    if not found:
        return []
    peak = hit["peak_torque"]
    if peak <= reach:
        tallest = max(max(one.speed) for one in found)
        found.append(Curve("peak", "peak torque, for a short time", [peak, peak], [0.0, tallest]))
    return [*found, *_nominal(hit, ends)]


def _line(hit: Hit, ends: Any, reach: float) -> Curve:
    schema, top = columns_of(hit.section), hit["max_speed"]

    def shown(name: str) -> str:
        return figure(hit[name], schema[name])

    start = min(ends.speed, top) if top > 0.0 else ends.speed
    at = "nominal voltage" if isnan(hit["nominal_voltage"]) else shown("nominal_voltage")
    name = f"at {at}, winding at {show(float(data_temperature(hit)), 'degC', 'temperature')}"
    name += ", computed from R, k_t and the no-load speed" if ends.computed else ""
    name += f"; cut at the permitted {shown('max_speed')}" if start < ends.speed else ""
    stall = figure(ends.torque, schema["stall_torque"])
    name += f"; stall, {stall}, is beyond the chart" if ends.torque > reach else ""
    return Curve("line", name, [0.0, ends.torque * (1.0 - start / ends.speed), ends.torque], [start, start, 0.0])


def _nominal(hit: Hit, ends: Any) -> list[Curve]:
    """The nominal point; on the line where its speed is unknown."""
    torque, speed = hit["nominal_torque"], hit["nominal_speed"]
    name = "nominal torque, on the line" if isnan(speed) else "nominal point"
    speed = ends.speed * (1.0 - torque / ends.torque) if isnan(speed) else speed
    return [] if isnan(torque + speed) else [Curve("nominal", name, [torque], [speed])]


def pull_out_conditions(curve: PullOuts) -> str:
    """Supply voltage, current and driver with which a curve was measured."""
    amps = float(curve.current[0])
    with_ = [show(float(curve.voltage[0]), "V", "voltage")]
    with_ += [] if np.isnan(amps) else [f"{show(amps, 'A', 'current')} amplitude"]
    with_ += [str(curve.driver[0])] if curve.driver[0] else []
    return ", ".join(with_)
