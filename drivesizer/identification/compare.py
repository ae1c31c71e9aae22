"""A machine's log beside its sizing: checks by what was measured, and the figure of the spec behind the difference.

The motor's torque by its current, :math:`k_t i`, is held against what the spec requires along the measured motion:
inertia, friction, the load by direction, gears. Each figure of the load is varied alone until that fits best; the share
of the squared difference that it takes away says how well it explains the log.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from math import isnan, nan
from typing import Any, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.drive_train import drive_train
from drivesizer.control.validation import Validation
from drivesizer.errors import InputError, quoted
from drivesizer.files.fields import Quantity
from drivesizer.files.yaml_source import Edit, YamlOverlay, edited
from drivesizer.identification.identify import at_motor, log_findings, of_drive
from drivesizer.identification.log import Log
from drivesizer.load_cases.platform import motion_of, remaining_torque
from drivesizer.physics.motion_curves import local_parabola
from drivesizer.results.check_columns import at_most
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.identification import Compared, Comparison, Explanation, Trace
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import KINDS, from_si

Array = NDArray[np.float64]
Columns = Mapping[str, Array]

# kinds of figures of a load that may explain a torque, with a first step from nothing on [SI]
_KINDS = {"dimensionless": 1e-3, "force": 0.1, "torque": 1e-3, "mass": 1e-2, "inertia": 1e-6}
_EXPLAINS, _MOST = 0.1, 4  # share of the difference from which on a figure is listed; how many
_STEP, _ROUNDS = 0.01, 4  # of a figure, for its slope
_FAST = 0.03  # of the top speed, above which friction has its direction
_SMOOTHED = 25.0  # samples
_WARM = 2.0  # time constants of the housing
_NOTHING = 0.03  # of the torque: a difference that is none


def _mean(columns: Columns, of: Array) -> float:
    """Mean over time of a column whose rows may be apart unevenly."""
    time = columns["time"]
    return float(np.trapezoid(of, time) / (time[-1] - time[0]))


def _largest(name: str) -> Callable[[Columns], float]:
    return lambda columns: float(np.abs(columns[name]).max())


_MEASURED: dict[str, tuple[str, Callable[[Columns], float]]] = {  # check -> column that it needs, and what of it
    "supply_voltage": ("voltage", _largest("voltage")),
    "controller_peak_current": ("current", _largest("current")),
    "controller_continuous_current": ("current", lambda c: _mean(c, c["current"] ** 2) ** 0.5),
    "motor_nominal_current": ("current", lambda c: _mean(c, c["current"] ** 2) ** 0.5),
    "winding_temperature": ("winding", lambda c: float(c["winding"].max())),
    "motor_speed": ("speed", _largest("speed")),
    "encoder_speed": ("speed", _largest("speed")),
    "gearhead_intermittent_speed": ("speed", _largest("speed")),
    "gearhead_intermittent_torque": ("gearhead_torque", _largest("gearhead_torque")),
    "tracking_error": ("error", _largest("error")),
}


class Moves(NamedTuple):
    """Moments of a log at which the motor moves: speed, acceleration, and torque by its current, smoothed alike."""

    time: Array
    speed: Array
    acceleration: Array
    torque: Array
    moving: NDArray[np.bool_]  # fast enough for friction to have its direction


def compare(log: Log, proof: Validation) -> Comparison:
    """Hold a log against the sizing of its machine."""
    spec, drive = proof.spec, proof.drive_set
    of = of_drive(spec, drive)
    columns = at_motor(log, of)
    if "error" not in columns and {"reference", "load_speed"} <= set(columns):
        columns["error"] = columns["reference"] - columns["load_speed"]
    checks = tuple(_compared(proof, columns))
    if not checks:
        have = ", ".join(log.heads.values())
        raise InputError(f"{log.name}: {quoted(have)}; expected the motor's current, voltage or speed")
    remarks = [*log.remarks, *_left_out(proof, columns)]
    difference, torque, time = nan, nan, np.zeros(0)
    traces, explanations = tuple[Trace, ...](), tuple[Explanation, ...]()
    if {"current", "speed"} <= set(columns):
        moves = _moves(log, columns, of.figures["k_t"])
        required, explanations = explained(spec, drive, moves)
        moving, time = moves.moving, moves.time
        if moving.any():
            off = required - moves.torque
            difference, torque = (float(np.sqrt((x[moving] ** 2).mean())) for x in (off, moves.torque))
        if explanations and explanations[0].share < 0.5:
            remarks.append("no figure of the load explains most of the difference by itself")
        traces = (
            Trace("motor torque", "torque", "mN*m", moves.torque, np.where(moving, required, nan)),
            Trace("motor speed", "rotary_speed", "rpm", moves.speed, moves.speed),
        )
    else:
        remarks.append("the current or the speed was not logged: what explains the difference is unknown")
    return Comparison(
        log=log.name, label=drive.label, over=proof.over, checks=checks, explanations=explanations,
        difference=difference, torque=torque, findings=tuple(log_findings(log, pulled=True)), remarks=tuple(remarks),
        time=time, traces=traces,
    )  # fmt: skip


def _compared(proof: Validation, columns: Columns) -> Iterator[Compared]:
    ambient = proof.spec.environment.ambient
    for check in proof.checks:
        needs, of = _MEASURED.get(check.name, ("", None))
        if of is None or needs not in columns or isnan(check.limit):
            continue
        measured = of(columns)
        zero = ambient if check.name == "winding_temperature" else 0.0
        measured_check = at_most(check.name, measured, check.limit, zero=zero, needed=check.needed).at(
            (), "closed loop"
        )
        left, status = measured_check.margin, measured_check.status
        if check.name == "winding_temperature" and status == "pass" and not _is_long(proof, columns):
            left, status = nan, "unknown"
        yield Compared(check.name, check.title, check.kind, check.unit, check.demand, measured, check.limit,
                       check.margin, left, status)  # fmt: skip


def _is_long(proof: Validation, columns: Columns) -> bool:
    """Whether a log lasts until the housing is warm."""
    lasts = float(columns["time"][-1] - columns["time"][0])
    return lasts > _WARM * float(proof.drive_set.motor.motor_time_constant)


def _left_out(proof: Validation, columns: Columns) -> Iterator[str]:
    without = [c.title for c in proof.checks if c.name in _MEASURED and _MEASURED[c.name][0] not in columns]
    if without:
        yield f"not in the log: {', '.join(without)}"
    if "winding" in columns:
        short = "" if _is_long(proof, columns) else ", of a log too short for the housing to be warm"
        yield f"the promised winding temperature is that of the periodic steady state; the log's is its highest{short}"


def _moves(log: Log, columns: Columns, k_t: float) -> Moves:
    time = columns["time"]
    parts = []
    for move in log.moves:
        t = time[move]
        if len(t) < 5:
            continue
        window = _SMOOTHED * float(np.median(np.diff(t)))
        w, dw = local_parabola(t, columns["speed"][move], window)
        i = local_parabola(t, columns["current"][move], window)[0]
        parts.append(np.array([t, w, dw, k_t * i]))
    if not parts:
        raise InputError(f"{log.name}: no move of 5 rows or more; expected one without gaps")
    t, w, dw, torque = np.concatenate(parts, axis=1)
    return Moves(t, w, dw, torque, np.abs(w) > _FAST * np.abs(w).max())


def required_torque(spec: RobotSpec, drive: DriveSet, moves: Moves) -> Array:
    """Torque of the motor [N*m] that a spec requires along a measured motion, friction and gears included."""
    train, _ = drive_train(spec, drive, 1e-3)
    left, more = remaining_torque(spec, motion_of(spec), train.load), np.zeros_like(moves.time)
    if len(left):
        more = np.interp((moves.time - moves.time[0]) % left[-1, 0], left[:, 0], left[:, 1])
    against = train.at_motor(np.sign(moves.speed), more, moves.acceleration)
    return np.asarray(train.motor_inertia * moves.acceleration + against + train.viscous * moves.speed)


def explained(spec: RobotSpec, drive: DriveSet, moves: Moves) -> tuple[Array, tuple[Explanation, ...]]:
    """The torque that a spec requires, and the figures of its load that would explain what the log needs instead."""
    first, explanations = required_torque(spec, drive, moves), list[Explanation]()
    moving = moves.moving

    def left(of: Array) -> float:
        return float(((of - moves.torque)[moving] ** 2).sum())

    if not moving.any() or left(first) < _NOTHING**2 * float((moves.torque[moving] ** 2).sum()):
        return first, ()
    for name, quantity in _figures_of(spec.load):
        x = start = float(getattr(spec.load, name) or 0.0)
        required, best = first, left(first)
        for _ in range(_ROUNDS):
            step = _STEP * abs(x) or _KINDS[quantity.kind]
            try:
                slope = (required_torque(_with(spec, name, x + step), drive, moves) - required) / step
                power = float((slope[moving] ** 2).sum())
                if not power > 0.0:
                    break
                estimate = x - float((slope * (required - moves.torque))[moving].sum()) / power
                estimate = min(max(estimate, quantity.least, quantity.above + 1e-3 * abs(start)), quantity.most)
                required = required_torque(_with(spec, name, estimate), drive, moves)
            except InputError:  # a figure with which the load cannot follow its motion
                break
            if not left(required) < best:
                break
            x, best = estimate, left(required)
        share = 1.0 - best / left(first)
        if share > _EXPLAINS:
            entered = (spec.entered.get("load") or {}).get(name)
            before = _as_entered(start, quantity.kind, None) if entered is None else str(entered)
            explanations.append(Explanation(f"load.{name}", before, _as_entered(x, quantity.kind, entered), share))
    return first, tuple(sorted(explanations, key=lambda explanation: -explanation.share)[:_MOST])


def _with(spec: RobotSpec, name: str, value: float) -> RobotSpec:
    return spec.model_copy(update={"load": spec.load.model_copy(update={name: value})})


def _figures_of(load: Any) -> Iterator[tuple[str, Quantity]]:
    """Figures of a load by name, with what they are."""
    for name, field in type(load).model_fields.items():
        parts = [*field.metadata, *(m for part in get_args(field.annotation) for m in get_args(part))]
        quantity = next((part for part in parts if isinstance(part, Quantity)), None)
        if quantity is not None and quantity.kind in _KINDS and isinstance(getattr(load, name), float):
            yield name, quantity


def _as_entered(value: float, kind: str, entered: Any) -> str:
    """A figure as a spec has it, in the unit in which it was entered."""
    unit = re.sub(r"^[\s\d.+\-eE]*", "", str(entered)) if entered is not None else ""
    if kind == "dimensionless":
        return f"{100.0 * value:.4g} %" if unit == "%" else f"{value:.4g}"
    unit = unit or KINDS[kind].si
    return f"{float(from_si(value, unit, kind)):.4g} {unit}"


def corrected(spec: RobotSpec, explanation: Explanation) -> bytes:
    """The spec's text with the figure that explains its log; all else, comments too, as it was."""
    source = spec.source
    above = source.at if isinstance(source, YamlOverlay) else ()
    place = (*above, *explanation.field.split("."))
    plain = re.fullmatch(r"[\d.e+-]+", explanation.explains)
    value: Any = float(explanation.explains) if plain else explanation.explains
    return edited(source.text, [Edit(place, value)], source.name).encode()
