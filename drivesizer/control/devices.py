"""Gains and limits in a controller's own units: the table of controllers, what is written, and what it stands for."""

from __future__ import annotations

import math
import re
from functools import cache
from importlib import resources
from typing import Any, NamedTuple

import numpy as np
import yaml

from drivesizer.control.drive_train import DriveTrain, drive_train
from drivesizer.control.gains import feedforward
from drivesizer.control.loop_design import edges_of
from drivesizer.control.validation import Cascade, ControllerGain, Gains, Stepping, Validation
from drivesizer.errors import InputError, nearest, quoted
from drivesizer.spec.drive import Control, CurrentLoop, PositionLoop, VelocityLoop

_PHASE = math.sqrt(3.0) / 2.0  # torque constant per amplitude of a phase's current, over that of block commutation
_WORDS = ("form", "line", "after", "load", "first", "source", "note", "root", "match")  # empty where not given
_OF_POSITION = frozenset({"K_pos", "kp", "ki", "kd", "position"})
_OF_LOOPS = frozenset({"K_i", "K_ii", "K_v", "K_vi", "A_p", "A_i", "K_pos", "kp", "ki", "kd", "b", "J", "M_c", "T_n"})
_UNKNOWN = {
    "p": "pole pairs", "counts": "counts of an encoder", "I_max": "peak current", "I_cont": "nominal current",
    "L": "inductance", "R": "resistance",
}  # fmt: skip


class Parameter(NamedTuple):
    """A parameter of a controller, and the figures of which it is made."""

    name: str
    expression: str
    unit: str
    rounding: str  # float, whole, or N decimals
    carries: str  # the gain that hangs on it; empty: none
    confidence: str  # quoted, secondary or recalled
    meaning: str

    @property
    def decimals(self) -> int:
        """Digits behind the point of one that is no float."""
        return 0 if self.rounding == "whole" else int(self.rounding.split()[0])


class Device(NamedTuple):
    """A controller's parameters, the structure of its loops, and the form in which it takes them."""

    name: str
    title: str
    structure: str  # cascade, speed (without a position loop), pid, voltage
    phase: bool  # whether its amperes are the amplitude of a phase's current
    rates: tuple[float, float, float]  # Hz, of the current, velocity and position loops
    parameters: tuple[Parameter, ...]
    words: dict[str, str]  # form, load, first, source ...


class Written(NamedTuple):
    """A parameter as it is written."""

    parameter: Parameter
    exact: float
    value: float  # after rounding

    @property
    def text(self) -> str:
        """The value as it stands in the file."""
        if self.parameter.rounding == "float":
            return repr(float(f"{self.value:.8g}")).removesuffix(".0")
        return f"{self.value:.{self.parameter.decimals}f}"


@cache
def devices() -> dict[str, Device]:
    """All controllers of the table, by name."""
    text = (resources.files("drivesizer.control") / "devices.yaml").read_text(encoding="utf-8")
    found = {}
    for entry in yaml.safe_load(text):
        rows = (line.split("|") for line in entry["parameters"].strip().splitlines())
        parameters = tuple(Parameter(*(cell.strip() for cell in cells)) for cells in rows)
        words = {name: str(entry.get(name, "")) for name in _WORDS}
        phase, (current, velocity, position) = entry["amperes"] == "phase", map(float, entry["rates"])
        rates = (current, velocity, position)
        found[entry["name"]] = Device(
            entry["name"], entry["title"], entry["structure"], phase, rates, parameters, words
        )
    return found


def _known(controller: str) -> Device | None:
    """The controller of that family and part, where the table has it."""
    found = (one for one in devices().values() if one.words["match"])
    return next((one for one in found if re.search(one.words["match"], controller, re.IGNORECASE)), None)


def device_of(name: str | None, controller: str) -> Device:
    """The controller that is named, or the one that the drive has.

    Parameters
    ----------
    name
        Of the table; None: by the drive's controller.
    controller
        Family and part of the drive's controller.

    Returns
    -------
    Device

    Raises
    ------
    InputError
        When the table has none of that name, or none for the drive's controller.

    Examples
    --------
    >>> device_of(None, "EPOS4 Compact 50/5").name
    'epos4'
    """
    if name is not None:
        if name not in devices():
            raise InputError(f"--device: {quoted(name)} is not known{nearest(name, devices())}; "
                             f"expected {', '.join(devices())}")  # fmt: skip
        return devices()[name]
    if found := _known(controller):
        return found
    raise InputError(f"--device: nothing is known of {quoted(controller or 'no controller')}; expected one of "
                     f"{', '.join(devices())}")  # fmt: skip


def loops_of(device: Device, own: Control) -> Control:
    """The loops of a controller as the section ``control``: those that the spec requires, in its structure."""
    if device.structure == "voltage":
        given = own if own.structure == "voltage_pid" else Control()
        return given.model_copy(update={"rate": device.rates[1]})
    position = own.position if own.position or device.structure == "speed" else None
    if device.structure == "pid" and position is None:
        position = PositionLoop()
    update = {"structure": "cascade", "position": None if device.structure == "speed" else position}
    kept = own if own.structure == "cascade" else Control(structure="cascade")
    return kept.model_copy(update=update | {"rate": device.rates[1]})


def gain_figures(gains: Cascade | Gains, train: DriveTrain, *, phase: bool) -> dict[str, float]:
    """The figures of a controller's loops, in SI and in its own amperes."""
    scale, half = (_PHASE, 0.5) if phase else (1.0, 1.0)
    k_t, k = train.torque_constant, train.torque_constant * scale
    found = {"R": train.resistance * half, "L": train.inductance * half, "k": k, "k_e": train.back_emf_constant}
    if isinstance(gains, Cascade):
        found |= {
            "K_i": gains.current_kp * half, "K_ii": gains.current_ki * half, "K_v": gains.velocity_kp * k_t,
            "K_vi": gains.velocity_ki * k_t, "K_pos": gains.position_kp, "J": gains.feedforward_acceleration * k_t,
            "b": gains.feedforward_velocity * k_t, "M_c": gains.feedforward_friction * k_t,
        }  # fmt: skip
    else:
        per_volt = k_t / train.resistance
        acceleration, velocity, friction = feedforward(train)
        found |= {
            "volt_p": gains.kp, "volt_i": gains.ki, "K_v": gains.kp * per_volt, "K_vi": gains.ki * per_volt,
            "K_pos": 0.0,
            "J": acceleration * k_t, "b": velocity * k_t, "M_c": friction * k_t,
        }  # fmt: skip
    found |= {"A_p": found["K_v"] / k, "A_i": found["K_vi"] / k}
    found["T_n"] = found["K_v"] / found["K_vi"] if found["K_vi"] else math.inf
    place = found["K_pos"]
    return found | {"kd": found["K_v"], "kp": found["K_v"] * place + found["K_vi"], "ki": found["K_vi"] * place}


def figures(proof: Validation, device: Device) -> dict[str, float]:
    """The figures that parameters are made of: of the loops, the parts and the motion that was simulated."""
    gains, one = proof.gains, proof.drive_set
    if isinstance(gains, Stepping):
        raise InputError("--device: a stepper's driver has no gains; expected a drive with a closed loop")
    if device.phase and one.motor.kind == "brushed":
        raise InputError(f"--device: {device.title} drives brushless motors; {one.motor_name} is brushed")
    train, motor = drive_train(proof.spec, one, gains.velocity_period)[0], one.motor
    scale = _PHASE if device.phase else 1.0
    moved, turned = (np.abs(proof.series[name]).max() for name in ("speed", "motor_speed"))
    demand, steps = proof.series["speed_reference"] * (turned / moved), np.diff(proof.series["time"])
    ramps = np.abs(np.diff(demand)[steps > 0.0] / steps[steps > 0.0]).max(initial=0.0)
    peaks = [one.controller.peak_current if one.controller else math.nan, motor.peak_torque / train.torque_constant,
             motor.stall_current]  # fmt: skip
    most = min((peak for peak in peaks if not math.isnan(peak)), default=math.nan)
    return gain_figures(gains, train, phase=device.phase) | {
        "i": train.gear_ratio, "p": motor.pole_pairs, "V": proof.spec.supply.nominal,
        "counts": float(edges_of(proof.spec, one)) or math.nan, "omega": float(np.abs(demand).max()),
        "alpha": float(ramps), "I_max": most / scale, "I_cont": motor.nominal_current / scale,
        "M_max": most * train.torque_constant,
    }  # fmt: skip


def written(device: Device, values: dict[str, float]) -> tuple[list[Written], list[str]]:
    """Every parameter with its value as it is written; and those that are not written, with the reason."""
    found, reasons = list[Written](), dict[str, list[str]]()
    for parameter in device.parameters:
        one = _written(parameter, device, values)
        if isinstance(one, str):
            reasons.setdefault(one, []).append(parameter.name)
        else:
            found.append(one)
    return found, [f"{', '.join(names)}: {reason}" for reason, names in reasons.items()]


def _written(parameter: Parameter, device: Device, values: dict[str, float]) -> Written | str:
    """A parameter as it is written, or the reason why it is not."""
    if parameter.carries in _OF_POSITION and device.structure != "pid" and not values["K_pos"]:
        return "no position loop; control: {position: {}} in the spec adds it"
    names = sorted(_names(parameter.expression) & values.keys())
    if unknown := [_UNKNOWN.get(name, name) for name in names if math.isnan(values[name])]:
        return f"unknown {', '.join(unknown)}"
    exact = float(eval(parameter.expression, {"__builtins__": {}},  # noqa: S307  of this table
                       {**values, "pi": math.pi, "sqrt": math.sqrt}))  # fmt: skip
    if not math.isfinite(exact):
        return "the loop has no such part"
    value = float(np.float32(exact)) if parameter.rounding == "float" else round(exact, parameter.decimals)
    if value == 0.0 and exact != 0.0:
        return f"{exact:.3g} {parameter.unit} is less than the controller can express"
    return Written(parameter, exact, value)


def controller_gains(
    cascade: Cascade, train: DriveTrain, controller: str
) -> tuple[tuple[ControllerGain, ...], list[str]]:
    """The gains of a cascade in the units of a controller that is known, and those for which it has no place."""
    device = _known(controller)
    if device is None or device.structure != "cascade":
        return (), []
    values = gain_figures(cascade, train, phase=device.phase)
    of_gains = [row for row in device.parameters if not _names(row.expression) - values.keys() - {"pi", "sqrt"}
                and _names(row.expression) & _OF_LOOPS]  # fmt: skip
    rows, _ = written(device._replace(parameters=tuple(of_gains)), values)
    found = tuple(
        ControllerGain(place=row.parameter.name, name=row.parameter.meaning, unit=row.parameter.unit,
                       value=int(row.value) if row.parameter.rounding == "whole" else row.value)
        for row in rows
    )  # fmt: skip
    used = set().union(*(_names(row.expression) for row in device.parameters))
    lacking = [what for what, name, gain in (("velocity kd", "", cascade.velocity_kd),
               ("feedforward friction", "M_c", cascade.feedforward_friction)) if gain and name not in used]  # fmt: skip
    return found, [f"{device.title} has no place for {what}" for what in lacking]


def _names(expression: str) -> set[str]:
    return set(re.findall(r"(?<![\w.])[A-Za-z_]\w*", expression))


def as_written(device: Device, rows: list[Written], proof: Validation) -> Control:
    """The section ``control`` of what stands in the controller: its loops with the gains after rounding."""
    gains = proof.gains
    share = {row.parameter.carries: row.value / row.exact for row in rows if row.parameter.carries and row.exact}
    if isinstance(gains, Gains):
        kp, ki = gains.kp * share.get("K_v", 1.0), gains.ki * share.get("K_vi", 1.0)
        return proof.spec.control.model_copy(update={"kp": kp, "ki": ki, "kd": 0.0, "bandwidth": None})
    assert isinstance(gains, Cascade)
    over = gains.counted_over * gains.velocity_period or None
    current_kp = gains.current_kp * share.get("K_i", 1.0)
    current_ki = gains.current_ki * share.get("K_ii", share.get("K_i", 1.0))
    if "T_i" in share:
        current_ki = current_kp / (gains.current_kp / gains.current_ki * share["T_i"])
    kp, ki = gains.velocity_kp * share.get("K_v", 1.0), gains.velocity_ki * share.get("K_vi", 1.0)
    if "T_n" in share or "1/T_n" in share:
        ki = kp * gains.velocity_ki / gains.velocity_kp * share.get("1/T_n", 1.0) / share.get("T_n", 1.0)
    outer = gains.position_kp * share.get("K_pos", 1.0)
    if device.structure == "pid" and outer:  # back from one PID to the cascade that it is
        d, p, i = (gain * share.get(name, 1.0) for name, gain in
                   (("kd", kp), ("kp", kp * outer + ki), ("ki", ki * outer)))  # fmt: skip
        root = math.sqrt(max(0.0, p * p - 4.0 * i * d))
        fast, slow = (p + root) / (2.0 * d), (p - root) / (2.0 * d)
        inner = min((fast, slow), key=lambda one: abs(one - ki / kp))
        kp, ki, outer = d, d * inner, fast + slow - inner
    found: dict[str, Any] = {
        "current": CurrentLoop(kp=current_kp, ki=current_ki), "velocity": VelocityLoop(kp=kp, ki=ki),
        "position": PositionLoop(kp=outer) if outer else None, "count_time": over,
    }  # fmt: skip
    return proof.spec.control.model_copy(update=found)
