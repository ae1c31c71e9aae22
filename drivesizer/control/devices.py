"""Gains and limits in a controller's own units: the table of controllers, what is written, and what it stands for."""

from __future__ import annotations

import math
import re
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import newton

from drivesizer.control.drive_train import DriveTrain, drive_train, mechanics
from drivesizer.control.gains import feedforward, position_on_voltage
from drivesizer.control.loop_design import edges_of
from drivesizer.control.validation import Cascade, ControllerGain, Gains, Stepping, Validation
from drivesizer.errors import InputError, nearest, quoted
from drivesizer.files.arithmetic import own_value
from drivesizer.files.text import listed
from drivesizer.files.yaml_source import shipped_data
from drivesizer.results.drive_set import DriveSet
from drivesizer.spec.drive import Control, CurrentLoop, Feedforward, PositionLoop, VelocityLoop
from drivesizer.spec.robot import RobotSpec

_PHASE = math.sqrt(3.0) / 2.0  # torque constant per amplitude of a phase's current, over that of block commutation
_OF_POSITION = frozenset({"K_pos", "kp", "ki", "kd"})
_ROWS = [(head, *cells, "")[:4] for head, cells in listed("drivesizer.control", "figures.txt")]
_OF_LOOPS = {name for head, name, *_ in _ROWS if head == "loops"}
_SI = {name: unit for _, name, unit, _ in _ROWS}
_UNKNOWN = {name: words or name for _, name, _, words in _ROWS}
_FUNCTIONS = {"pi": math.pi, "sqrt": math.sqrt, "log2": math.log2, "round": round, "min": min, "max": max}


class Parameter(NamedTuple):
    """A parameter of a controller, and the figures of which it is made."""

    name: str
    expression: str
    unit: str
    rounding: str  # float, whole, or N decimals
    carries: str  # the figure that hangs on it; position: only where there is a position loop
    range: str  # of its values; empty: any
    confidence: str  # quoted, secondary or recalled
    meaning: str

    @property
    def figure(self) -> str:
        """The figure that it stands for; empty where there is none."""
        return self.carries.removesuffix("position").rstrip(", ")

    @property
    def decimals(self) -> int:
        """Digits behind the point of one that is no float."""
        return 0 if self.rounding == "whole" else int(self.rounding.split()[0])

    @property
    def ends(self) -> tuple[float, float]:
        """The least and the largest value."""
        low, _, high = self.range.partition(" .. ")
        return float(low or -math.inf), float(high or math.inf)

    def at(self, values: Mapping[str, float]) -> float:
        """Its exact value; infinite where it divides by zero."""
        try:
            return float(own_value(self.expression, {**_FUNCTIONS, **values}))
        except ZeroDivisionError:
            return math.inf

    def figure_at(self, value: float, values: Mapping[str, float]) -> float:
        """The figure for which a value stands, where all others are as they are."""
        exact, figure = self.at(values), values.get(self.figure, math.nan)
        if not figure or math.isnan(figure) or math.isclose(value, exact, rel_tol=1e-14):
            return figure
        factor = newton(
            lambda share: self.at({**values, self.figure: figure * share}) - value, 1.0, tol=1e-12, disp=False
        )
        return figure * float(factor)


class Device(NamedTuple):
    """A controller's parameters, the structure of its loops, and the form in which it takes them."""

    name: str
    title: str
    structure: str  # see the head of the table
    phase: bool  # whether its amperes are the amplitude of a phase's current
    rates: tuple[float, float, float]  # Hz, of the current, velocity and position loops
    settings: dict[str, tuple[float, str]]  # figures of the user's board: what is taken (NaN: nothing), and of what
    parameters: tuple[Parameter, ...]
    words: dict[str, str]  # form, load, first, source ...; empty where not given

    @property
    def figures(self) -> set[str]:
        """Figures that its parameters are made of."""
        return set().union(*(_names(row.expression) for row in self.parameters))


class Written(NamedTuple):
    """A parameter as it is written."""

    parameter: Parameter
    exact: float
    value: float  # after rounding
    si: float = math.nan  # the figure that it carries, after rounding
    rotary: bool = False  # of units that are given of a linear axis or of a rotary one

    @property
    def text(self) -> str:
        """The value as it stands in the file."""
        if self.parameter.rounding == "float":
            return str(np.float32(self.value)).removesuffix(".0")
        return f"{self.value:.{self.parameter.decimals}f}"

    @property
    def in_si(self) -> str:
        """The figure in SI that the written value is; empty where it is none."""
        if math.isnan(self.si):
            return ""
        unit = _SI[self.parameter.figure].split(" or ")[-self.rotary]
        return f"{self.parameter.figure} = {self.si:.6g} {unit}".rstrip()

    @property
    def unit(self) -> str:
        """The controller's unit."""
        return self.parameter.unit.split(" or ")[-self.rotary]


class Writing(NamedTuple):
    """Parameters that are written into a controller, and those that are not."""

    rows: list[Written]
    left_out: list[str]  # with the reason
    refused: list[str]  # gains of the loops that it cannot express


@cache
def devices() -> dict[str, Device]:
    """All controllers of the table, by name."""
    table = {}
    for entry in shipped_data("drivesizer.control", "devices.yaml"):
        rows = (line.split("|") for line in entry["parameters"].strip().splitlines())
        parameters = tuple(Parameter(*(cell.strip() for cell in cells)) for cells in rows)
        words = defaultdict(str, {name: str(value) for name, value in entry.items()})
        current, velocity, position = map(float, entry.get("rates", (0.0, 0.0, 0.0)))
        settings = {}
        for setting in filter(None, entry.get("settings", "").split("; ")):
            name, value, what = re.split(r" = | ", setting, maxsplit=2)
            settings[name] = math.nan if value == "?" else float(value), what
        table[entry["name"]] = Device(
            entry["name"], entry["title"], entry["structure"], entry.get("amperes") == "phase",
            (current, velocity, position), settings, parameters, words,
        )  # fmt: skip
    return table


def known(controller: str) -> Device | None:
    """The controller of that family and part, where the table has it."""
    members = (device for device in devices().values() if device.words["match"])
    return next((device for device in members if re.search(device.words["match"], controller, re.IGNORECASE)), None)


def device_of(name: str | None, controller: str, firmware: str | None = None) -> Device:
    """The controller that is named, or the one that the drive has.

    >>> device_of(None, "EPOS4 Compact 50/5").name
    'epos4'
    >>> device_of("moteus", "", firmware="0x0109").name
    'moteus-old'
    """
    table = devices()
    device = table.get(name) if name else known(controller)
    family = device.words["family"] if device else name or ""
    members = [member for member in table.values() if family and member.words["family"] == family]
    if firmware is None and device:
        return device
    if members:
        versions = ", ".join(
            f"{member.words['firmware'].replace(' .. ', ' to below ')} ({member.name})" for member in members
        )
        if firmware is None:
            raise InputError(f"--device: of {quoted(family)} the firmware decides; expected --firmware, {versions}")
        version = _version(firmware)
        for member in members:
            low, high = map(_version, member.words["firmware"].split(" .. "))
            if low <= version < high:
                return member
        raise InputError(f"--firmware: {quoted(firmware)} is not known of {family}; expected {versions}")
    if device:
        raise InputError(f"--firmware: it decides nothing of {device.title}; leave it out")
    if name is not None:
        raise InputError(f"--device: {quoted(name)} is not known{nearest(name, table)}; expected {', '.join(table)}")
    raise InputError(f"--device: nothing is known of {quoted(controller or 'no controller')}; expected one of "
                     f"{', '.join(table)}")  # fmt: skip


def _version(text: str) -> tuple[int, ...]:
    """A version as numbers.

    >>> _version("0.5.6"), _version("0x010e")
    ((0, 5, 6), (270,))
    """
    try:
        return tuple(int(part, 16 if part.lower().startswith("0x") else 10) for part in text.split("."))
    except ValueError:
        raise InputError(f"--firmware: {quoted(text)} is no version; expected e.g. 0.5.6 or 0x010e") from None


# -- The loops of a controller as the section ``control``: in its structure, at its rates, with what it has a place for.


def loops_of(device: Device, spec: RobotSpec, drive: DriveSet) -> Control:
    """The loops of a controller: those that the spec requires, refused where it cannot express them."""
    own = spec.control
    if (device.structure == "steps") != drive.steps:
        which, other = ("servo motors", "is one that steps") if drive.steps else ("steppers", "runs in a closed loop")
        raise InputError(f"--device: {device.title} drives {which}; {drive.motor_name} {other}")
    if drive.steps:
        return own
    if device.phase and drive.motor.kind == "brushed":
        raise InputError(f"--device: {device.title} drives brushless motors; {drive.motor_name} is brushed")
    on_voltage, has = device.structure in {"voltage", "servo"}, device.figures
    _refuse_foreign(device, spec, on_voltage=on_voltage)
    rate = own.rate if own.rate and device.words["own_rate"] else device.rates[1]
    train = drive_train(spec, drive, 1.0 / rate)[0]
    if on_voltage:
        loops: dict[str, Any] = {"rate": rate, "structure": "voltage_pid", "position": None}
        if {"b", "J", "M_c"} & has:
            ahead = dict(zip(("acceleration", "velocity", "friction"), feedforward(train), strict=True))
            loops["feedforward"] = Feedforward(
                **{name: ahead[name] * (figure in has) for name, figure in _AHEAD.items()}
            )
        if device.structure == "servo":
            loops |= {"kp": 0.0, "ki": own.ki or position_on_voltage(train, 1.0 / rate), "at_rest": "hold"}
        if own.structure == "cascade" and own.velocity.bandwidth is not None:
            loops["bandwidth"] = own.velocity.bandwidth
        return (own if own.structure == "voltage_pid" else Control()).model_copy(update=loops)
    terms, position = own.feedforward, None if device.structure == "speed" else own.position
    if device.structure == "pid" and position is None:
        position = PositionLoop()
    if position and device.words["planned_speed"]:
        position = position.model_copy(update={"planned_speed": False})
    none = {name: 0.0 for name, figure in _AHEAD.items() if figure not in has}
    loops = {"structure": "cascade", "position": position, "rate": rate, "feedforward": terms.model_copy(update=none),
            "computing": int(not device.words["prompt"])}  # fmt: skip
    if own.structure == "voltage_pid" and own.bandwidth is not None:  # which is required of that structure too
        loops |= {"velocity": VelocityLoop().model_copy(update={"bandwidth": own.bandwidth}), "bandwidth": None}
    return own.model_copy(update=loops)


_AHEAD = {"velocity": "b", "friction": "M_c", "acceleration": "J"}  # fields of the feed-forward, and their figures


def _refuse_foreign(device: Device, spec: RobotSpec, *, on_voltage: bool) -> None:
    """Refuse gains of a spec for which a controller has no place."""
    own, has = spec.control, device.figures
    terms = own.feedforward
    of_cascade = own.current != CurrentLoop() or own.velocity.kp is not None or own.velocity.ki is not None
    wrong = [
        ("kp", own.kp is not None and not on_voltage,
         "it has current and velocity loops; expected structure: cascade"),
        ("structure", on_voltage and of_cascade, "its loop acts on the voltage; expected voltage_pid"),
        ("position", own.position and (device.structure == "speed" or (device.structure == "voltage"
         and not device.words["position"])), "it has no position loop here"),
        ("position.kp", own.position and own.position.kp and on_voltage, "its gain follows from the loop's bandwidth"),
        ("kp", device.structure == "servo" and own.kp, "its position loop has P alone; expected kp: 0 and ki, the gain "
         "of the position"),
        ("kd", on_voltage and own.kd, "it has no place for it"),
        ("velocity.kd", own.velocity.kd, "it has no place for it"),
        ("current.ki", own.current.ki and own.current.kp and "K_i" in has and not {"K_ii", "T_i"} & has,
         "it makes its own of kp, resistance and inductance"),
        *((f"feedforward.{name}", getattr(terms, name) and figure not in has, "it has no place for it")
          for name, figure in _AHEAD.items()),
    ]  # fmt: skip
    for name, is_wrong, why in wrong:
        if is_wrong:
            place = spec.where(("control", *name.split(".")))
            raise InputError(f"{place}: {device.title} cannot express it: {why}")


# -- Figures that parameters are made of.


def gain_figures(gains: Cascade | Gains, train: DriveTrain, *, phase: bool) -> dict[str, float]:
    """The figures of a controller's loops, in SI and in its own amperes."""
    scale, half = (_PHASE, 0.5) if phase else (1.0, 1.0)
    k_t, k = train.torque_constant, train.torque_constant * scale
    figures = {"R": train.resistance * half, "L": train.inductance * half, "k": k, "k_e": train.back_emf_constant}
    if isinstance(gains, Cascade):
        figures |= {
            "K_i": gains.current_kp * half, "K_ii": gains.current_ki * half, "K_v": gains.velocity_kp * k_t,
            "K_vi": gains.velocity_ki * k_t, "K_pos": gains.position_kp, "J": gains.feedforward_acceleration * k_t,
            "b": gains.feedforward_velocity * k_t, "M_c": gains.feedforward_friction * k_t,
        }  # fmt: skip
        figures["T_i"] = figures["K_i"] / figures["K_ii"] if figures["K_ii"] else math.inf
    else:
        per_volt = k_t / train.resistance
        acceleration, velocity, friction = feedforward(train)
        figures |= {
            "volt_p": gains.kp, "volt_i": gains.ki, "K_v": gains.kp * per_volt, "K_vi": gains.ki * per_volt,
            "K_pos": 0.0, "J": acceleration * k_t, "b": velocity * k_t, "M_c": friction * k_t,
        }  # fmt: skip
    figures |= {
        "A_p": figures["K_v"] / k,
        "A_i": figures["K_vi"] / k,
        "T_w": gains.counted_over * gains.velocity_period,
    }
    figures["T_n"] = figures["K_v"] / figures["K_vi"] if figures["K_vi"] else math.inf
    place = figures["K_pos"]
    return figures | {
        "kd": figures["K_v"],
        "kp": figures["K_v"] * place + figures["K_vi"],
        "ki": figures["K_vi"] * place,
    }


def figures(proof: Validation, device: Device, settings: Mapping[str, float]) -> dict[str, float]:
    """The figures that parameters are made of: of the loops, the parts, the motion that was simulated, the board."""
    gains, drive = proof.gains, proof.drive_set
    values = {name: value for name, (value, _) in device.settings.items()} | dict(settings)
    speed, steps = proof.series["speed_reference"], np.diff(proof.series["time"])
    top, ramps = np.abs(speed).max(), np.abs(np.diff(speed)[steps > 0.0] / steps[steps > 0.0]).max(initial=0.0)
    turns = mechanics(proof.spec, drive)[0].motor_per_speed  # rad of the motor per m, or rad, of the load
    values |= {"v": float(top), "a": float(ramps), "omega": float(top * turns), "alpha": float(ramps * turns)}
    if isinstance(gains, Stepping):
        amperes = drive.motor.nominal_current / math.sqrt(2.0)
        idle = proof.spec.control.idle_current
        return values | {
            "turn": 2.0 * math.pi / turns, "mm": 1e3 if proof.spec.load.shaft_axis == "linear" else 180.0 / math.pi,
            "full": 4.0 * drive.motor.pole_pairs, "microsteps": gains.microsteps, "I_rms": amperes,
            "I_hold": amperes * (1.0 if idle is None else idle), "rate": gains.pulse_rate,
        }  # fmt: skip
    train, motor = drive_train(proof.spec, drive, gains.velocity_period)[0], drive.motor
    scale = _PHASE if device.phase else 1.0
    peaks = [drive.controller.peak_current if drive.controller else math.nan, motor.peak_torque / train.torque_constant,
             motor.stall_current]  # fmt: skip
    most = min((peak for peak in peaks if not math.isnan(peak)), default=math.nan)
    return values | gain_figures(gains, train, phase=device.phase) | {
        "i": train.gear_ratio, "p": motor.pole_pairs, "V": proof.spec.supply.nominal,
        "counts": float(edges_of(proof.spec, drive)) or math.nan, "I_max": most / scale,
        "I_cont": motor.nominal_current / scale, "M_max": most * train.torque_constant,
        "tau_w": motor.winding_time_constant,
    }  # fmt: skip


# -- Parameters as they are written, and what stands in the controller then.


def written(device: Device, values: Mapping[str, float]) -> Writing:
    """Every parameter with its value as it is written; and those that are not written, with the reason."""
    writing, known = Writing([], [], []), dict(values)
    reasons = dict[str, list[str]]()
    for parameter in device.parameters:
        row = _written(parameter, known)
        if isinstance(row, Written):
            writing.rows.append(row)
            known[parameter.name] = row.value
        elif row.startswith("="):
            line = f"{parameter.name}, {re.split('[;:]', parameter.meaning)[0]}, would be {row.removeprefix('= ')}"
            (writing.refused if parameter.figure in _OF_LOOPS else writing.left_out).append(line)
        else:
            reasons.setdefault(row, []).append(parameter.name)
    writing.left_out.extend(f"{', '.join(names)}: {reason}" for reason, names in reasons.items())
    return writing


def _written(parameter: Parameter, values: dict[str, float]) -> Written | str:
    """A parameter as it is written, or the reason why it is not; that of a value with the value."""
    of_position = parameter.carries.endswith("position") or parameter.figure in _OF_POSITION
    if of_position and not values["K_pos"]:
        return "no position loop; control: {position: {}} in the spec adds it"
    names = sorted(_names(parameter.expression) & values.keys())
    if unknown := [_UNKNOWN.get(name, name) for name in names if math.isnan(values[name])]:
        return f"unknown {', '.join(unknown)}"
    exact = parameter.at(values)
    if not math.isfinite(exact):
        return "the loop has no need of it"
    value = float(np.float32(exact)) if parameter.rounding == "float" else round(exact, parameter.decimals)
    text = f"= {exact:.4g} {parameter.unit}".rstrip()
    if value == 0.0 and abs(exact) > 1e-30 and not parameter.expression.startswith("8 - log2"):
        return f"{text}, less than the controller can express"
    low, high = parameter.ends
    if not low <= value <= high:
        return f"{text}, and it takes {low:.10g} to {high:.10g}"
    si = parameter.figure_at(value, values) if parameter.figure else math.nan
    return Written(parameter, exact, value, si, rotary=values.get("mm", 1e3) != 1e3)


def read_back(rows: list[Written]) -> dict[str, float]:
    """The figures in SI for which written values stand; of several parameters the first counts."""
    return {row.parameter.figure: row.si for row in reversed(rows) if not math.isnan(row.si)}


def controller_gains(
    cascade: Cascade, train: DriveTrain, device: Device
) -> tuple[tuple[ControllerGain, ...], list[str]]:
    """The gains of a cascade in the units of a controller, and those for which it has no place."""
    if device.structure in {"voltage", "servo", "steps"}:
        return (), []
    values = gain_figures(cascade, train, phase=device.phase)
    of_gains = [row for row in device.parameters if not _names(row.expression) - values.keys() - _FUNCTIONS.keys()
                and row.figure in {*_OF_LOOPS, "b", "J", "M_c"}]  # fmt: skip
    rows = written(device._replace(parameters=tuple(of_gains)), values).rows
    if not rows:
        return (), []
    gains = tuple(
        ControllerGain(place=row.parameter.name, name=row.parameter.meaning, unit=row.parameter.unit,
                       value=int(row.value) if row.parameter.rounding == "whole" else row.value)
        for row in rows
    )  # fmt: skip
    lacking = {"velocity kd": cascade.velocity_kd}
    lacking |= {"feedforward friction": cascade.feedforward_friction} if "M_c" not in device.figures else {}
    return gains, [f"{device.title} has no place for {what}" for what, gain in lacking.items() if gain]


def _names(expression: str) -> set[str]:
    """Figures and functions of an expression."""
    return set(re.findall(r"(?<![\w.])[A-Za-z_]\w*", expression)) - {"if", "else", "or"}


def within_limits(device: Device, proof: Validation, values: Mapping[str, float]) -> Control | None:
    """The loops again with a current loop and a measurement of the speed no faster than the controller has them.

    None: they are within, or given in the spec.
    """
    own, update = proof.spec.control, dict[str, Any]()
    if not isinstance(proof.gains, Cascade):
        return None
    for row in device.parameters:
        high = row.ends[1]
        if row.figure == "K_i" and own.current == CurrentLoop() and row.at(values) > high:
            most = row.figure_at(0.999 * high, values)
            update["current"] = CurrentLoop(kp=proof.gains.current_kp * most / values["K_i"])
    least = float(device.words["count_time"] or 0.0)
    if own.count_time is None and 0.0 < values["T_w"] < least:
        update["count_time"] = least
    return own.model_copy(update=update) if update else None


def with_limit(device: Device, rows: list[Written], drive: DriveSet) -> DriveSet:
    """A drive whose controller limits the current to what is written."""
    limit, known = drive.controller, read_back(rows).get("I_max", math.nan)
    if limit is None or math.isnan(known):
        return drive
    peak = np.fmin(limit.peak_current, known * (_PHASE if device.phase else 1.0))
    return replace(drive, controller=replace(limit, peak_current=float(peak)))


def as_written(device: Device, rows: list[Written], proof: Validation, values: Mapping[str, float]) -> Control:
    """The section ``control`` of what stands in the controller: its loops with the gains after rounding."""
    gains, own = proof.gains, proof.spec.control
    share = {name: si / values[name] for name, si in read_back(rows).items() if values.get(name)}

    def rounded(gain: float, *names: str) -> float:
        return gain * next((share[name] for name in names if name in share), 1.0)

    if isinstance(gains, Stepping):
        return own.model_copy(update={"microsteps": max(1, round(rounded(gains.microsteps, "microsteps")))})
    over = gains.counted_over * gains.velocity_period or None
    if isinstance(gains, Gains):
        update = {"kp": rounded(gains.kp, "volt_p"), "ki": rounded(gains.ki, "volt_i"), "kd": 0.0, "bandwidth": None}
        return own.model_copy(update=update | {"count_time": over})
    current_kp, current_ki = rounded(gains.current_kp, "K_i"), rounded(gains.current_ki, "K_ii", "K_i")
    if "T_i" in share:
        current_ki = current_kp * gains.current_ki / gains.current_kp / share["T_i"]
    kp, ki = rounded(gains.velocity_kp, "K_v", "A_p"), rounded(gains.velocity_ki, "K_vi", "A_i")
    if "T_n" in share:
        ki = kp * gains.velocity_ki / gains.velocity_kp / share["T_n"]
    outer = rounded(gains.position_kp, "K_pos")
    if device.structure in {"pid", "either"} and outer:  # back from one PID to the cascade that it is
        d, p, i = (rounded(gain, name) for name, gain in
                   (("kd", gains.velocity_kp), ("kp", gains.velocity_kp * gains.position_kp + gains.velocity_ki),
                    ("ki", gains.velocity_ki * gains.position_kp)))  # fmt: skip
        root = math.sqrt(max(0.0, p * p - 4.0 * i * d))
        fast, slow = (p + root) / (2.0 * d), (p - root) / (2.0 * d)
        inner = min((fast, slow), key=lambda rate: abs(rate - ki / kp))
        kp, ki, outer = d, d * inner, fast + slow - inner
    loops: dict[str, Any] = {
        "current": CurrentLoop(kp=current_kp, ki=current_ki), "velocity": VelocityLoop(kp=kp, ki=ki),
        "position": PositionLoop(kp=outer, planned_speed=gains.planned_speed) if outer else None, "count_time": over,
        "feedforward": Feedforward(
            velocity=rounded(gains.feedforward_velocity, "b"), friction=rounded(gains.feedforward_friction, "M_c"),
            acceleration=rounded(gains.feedforward_acceleration, "J"),
        ),
    }  # fmt: skip
    return own.model_copy(update=loops)
