"""Everything that is predicted of a set at the bench, as one record."""

from __future__ import annotations

from collections.abc import Iterable
from math import isnan, nan
from typing import Any

import numpy as np

from drivesizer.catalog.query import PartRow
from drivesizer.files.text import listed
from drivesizer.kernel.warming import State
from drivesizer.machine.part_curves import warm_housing
from drivesizer.physics.at_voltage import coast_down_time, step_peak_current, step_time
from drivesizer.physics.drive_train import friction
from drivesizer.physics.figures import Array
from drivesizer.physics.thermal import resistance_at
from drivesizer.prediction.machine import Machine, started, swung
from drivesizer.prediction.set_at_voltage import (
    Heating,
    SampledParts,
    SetAtVoltage,
    hold_current,
    hottest_phase,
    in_the_long_run,
    over_time,
    sampled_parts,
    set_at_voltage,
    time_to_limit,
)
from drivesizer.results.check_kinds import figure_words
from drivesizer.results.drive_set import EstimatedFigure
from drivesizer.results.prediction import HOTTEST, Band, Conditions, Movement, Predicted, Prediction, WarmingCourse
from drivesizer.units import show

_POWER = 9  # of two: samples
_MOMENTS = 121  # over the duration
_POINTS = 41  # of the line of speed over torque
_STAGE_AT_WORST = 0.9, 1.0  # duty, and voltage drop [V], of controllers that print neither
_DECIDES = 0.25  # share of a figure from which on it is said that it decides
_LEADS_LAW = "assumed: 0.03 to 0.35 V at the nominal current, both of 0.3 to 1.5 m of copper at 3 to 6.5 A/mm²"
_PER_CENT = (0.05, 0.5, 0.95)


_FIGURES = (*listed("drivesizer.prediction", "figures.txt"),)
_KINDS, _PARTS = (
    {cells[0]: cells[1].split() for head, cells in _FIGURES if head == section} for section in ("kinds", "parts")
)
_CONDITIONS = {"voltage": ("voltage", "--voltage"), "load": ("load", "--load"), "warm": ("warm", "--warm")}


def completed(conditions: Conditions, motor: PartRow, gearhead: PartRow | None) -> Conditions:
    """Conditions with those that are not given: the motor's nominal voltage, the set's continuous torque."""
    torque = motor["nominal_torque"]
    if gearhead is not None:
        own = torque * gearhead["ratio"] * gearhead["efficiency"]
        torque = float(np.fmin(own, gearhead["continuous_torque"]))
    load = torque if isnan(conditions.load) else conditions.load
    voltage = motor["nominal_voltage"] if isnan(conditions.voltage) else conditions.voltage
    return conditions._replace(voltage=voltage, load=load, hold=load if isnan(conditions.hold) else conditions.hold)


def predict(
    motor: PartRow, gearhead: PartRow | None, controller: PartRow | None, conditions: Conditions,
    machine: Machine | None = None, *, warming: bool = True,
) -> Prediction:  # fmt: skip
    """Predict what is measured of a set at the bench, temperatures and times to the limit where these are wanted."""
    parts = sampled_parts(motor, gearhead, controller, _POWER)
    with np.errstate(all="ignore"):
        drive_set = set_at_voltage(parts, conditions)
        if isnan(conditions.warm):  # the housing's after long work at the nominal point
            conditions = conditions._replace(
                warm=warm_housing({n: x[0] for n, x in drive_set.motor.items()}, conditions.ambient)
            )
        columns, courses = _mechanical(drive_set, conditions), list[WarmingCourse]()
        holding_current = hold_current(drive_set, parts, conditions.hold)
        columns |= {
            "hold_current": holding_current,
            "hold_heat": resistance_at(drive_set.bodies.R_25, conditions.ambient) * holding_current**2,
        }
        movements = list[Movement]()
        if machine is not None:
            for name, motion in (("start", started), ("swing", swung)):
                figures, run = motion(drive_set, machine, conditions.ambient)
                columns |= figures
                if run is not None:
                    bands = (_band(column) for column in (run.angle, run.speed, run.current))
                    movements.append(Movement(name, machine.axis, run.time, *bands))
        heated = _heated(drive_set, parts, conditions, holding_current) if warming else {}
        for name, heating in heated.items():
            more, ways = _thermal(name, heating, drive_set, conditions)
            columns, courses = columns | more, [*courses, *ways]
        torque, speed = _line(drive_set, columns["stall_torque"], conditions)
    hits = {
        "actuator" if motor.section == "actuators" else "motor": motor,
        "gearhead": gearhead,
        "controller": controller,
    }
    bought = {role: hit for role, hit in hits.items() if hit is not None}
    called = []  # family, reduction and number of each part
    for hit in bought.values():
        reduction = f" {hit['reduction']}" if hit.section in ("gearheads", "actuators") and hit["reduction"] else ""
        called.append(("" if hit["family"] == hit.part else f"{hit['family']} ") + hit.part + reduction)
    return Prediction(
        parts={role: hit.part for role, hit in bought.items()},
        label=" + ".join(called),
        digests={name: digest for hit in bought.values() for name, digest in hit.catalog.digests.items()},
        conditions=conditions,
        figures=tuple(_figures(columns, parts, conditions, machine)),
        torque=torque,
        speed=speed,
        courses=tuple(courses),
        movements=tuple(movements),
        limit=float(drive_set.motor["max_winding_temperature"][0]),
        estimates=(*parts.estimates, *_leads(drive_set, conditions)),
        tolerances=tuple((c.title, c.text, c.why) for c in parts.classes),
        assumptions=tuple(_assumptions(drive_set, parts, conditions)),
        warnings=tuple(_warnings(motor, gearhead, controller, conditions, columns)),
        samples=1 << _POWER,
    )


def _mechanical(drive_set: SetAtVoltage, conditions: Conditions) -> dict[str, Array]:
    """Figures with the winding at ambient temperature."""
    ambient, winding = conditions.ambient, drive_set.winding(conditions.ambient)
    free, idle = drive_set.running(0.0, ambient)
    stall = drive_set.stall_current(ambient)
    torque = (
        np.maximum(drive_set.drive.k_t * stall - drive_set.coulomb, 0.0)
        * drive_set.drive.ratio
        * drive_set.drive.efficiency
    )
    torque = np.minimum(torque, drive_set.most_torque)
    speed, current = drive_set.running(conditions.load, ambient)
    power = conditions.load * speed / drive_set.drive.ratio
    drawn = drive_set.source_power(conditions.voltage, np.nan_to_num(conditions.resistance), current)
    e = drive_set.drive.efficiency if conditions.inertia else 1.0  # that of the gear has no say without a load
    driving = drive_set.drive.inertia + conditions.inertia / (drive_set.drive.ratio**2 * e)
    driven = drive_set.drive.inertia + conditions.inertia * e / drive_set.drive.ratio**2
    stepped = (winding, drive_set.voltage, drive_set.coulomb, drive_set.drive.viscous, driving)
    coasted = (driven, drive_set.coulomb, drive_set.drive.viscous, free)
    return {
        "free_speed": free / drive_set.drive.ratio,
        "no_load_current": idle,
        "stall_torque": torque,
        "stall_current": stall,
        "load_speed": speed / drive_set.drive.ratio,
        "load_current": current,
        "load_power": power,
        "load_electrical_power": drawn,
        "load_efficiency": power / drawn,
        "step_time_63": step_time(*stepped, share=1.0 - np.exp(-1.0), limit=drive_set.most_current),
        "step_time_95": step_time(*stepped, share=0.95, limit=drive_set.most_current),
        "step_peak_current": step_peak_current(
            winding, drive_set.voltage, drive_set.coulomb, driving, drive_set.most_current
        ),
        "coast_time_half": coast_down_time(*coasted, free / 2.0),
        "coast_time": coast_down_time(*coasted),
    }


def _heated(
    drive_set: SetAtVoltage, parts: SampledParts, conditions: Conditions, holding_current: Array
) -> dict[str, Heating]:
    """The set stalled, holding and working, as bodies that warm up."""

    def working(winding: Array) -> tuple[Array, Array]:
        speed, current = drive_set.running(conditions.load, winding)
        return current, drive_set.losses[0] * speed + np.where(speed > 0.0, drive_set.losses[1] * speed**2, 0.0)

    still, phase = np.zeros_like(holding_current), hottest_phase(drive_set, parts)
    return {
        "stall": Heating(phase, conditions.ambient, lambda winding: (drive_set.stall_current(winding), still)),
        "hold": Heating(phase, conditions.ambient, lambda _: (holding_current, still)),
        "work": Heating(drive_set.bodies, conditions.ambient, working),
    }


def _thermal(
    name: str, heating: Heating, drive_set: SetAtVoltage, conditions: Conditions
) -> tuple[dict[str, Array], list[WarmingCourse]]:
    """Temperatures and times to the limit of one way of heating; nothing where a thermal figure is unknown."""
    if not heating.known:
        return {}, []
    limit = drive_set.motor["max_winding_temperature"]
    warmths = {"cold": conditions.ambient, "warm": conditions.warm}
    starts = {at: State(T, T) for at, T in warmths.items() if not isnan(T)}
    columns: dict[str, Array] = {}
    if not np.isnan(limit).any():
        columns |= {f"{name}_time_{at}": time_to_limit(heating, start, limit) for at, start in starts.items()}
    if name == "stall":
        return columns, []
    columns[f"{name}_winding_settled"] = np.minimum(in_the_long_run(heating)[0], HOTTEST)
    times, courses = np.linspace(0.0, conditions.duration, _MOMENTS), []
    for at, start in starts.items():
        winding, housing = (np.minimum(T, HOTTEST) for T in over_time(heating, start, times))
        ends = {f"{name}_winding_{at}": winding[-1], f"{name}_housing_{at}": housing[-1]}
        columns |= ends
        if at == "cold":
            columns |= {f"{name}_winding": winding[-1], f"{name}_housing": housing[-1]}
            if name == "work":
                columns["work_speed"] = drive_set.running(conditions.load, winding[-1])[0] / drive_set.drive.ratio
        title = f"{'holding' if name == 'hold' else 'at the load'}, from {at}"
        courses.append(WarmingCourse(f"{name}_from_{at}", title, times, _band(winding), _band(housing)))
    return columns, courses


def _line(drive_set: SetAtVoltage, stall: Array, conditions: Conditions) -> tuple[Array, Band]:
    """Speed over torque at the output, winding at ambient temperature."""
    torque = np.linspace(0.0, float(np.nan_to_num(stall).max()), _POINTS)
    speed = np.array([drive_set.running(x, conditions.ambient)[0] / drive_set.drive.ratio for x in torque])
    return torque, _band(speed)


def _band(values: Array) -> Band:
    """Percentiles over the last axis, of which the median is the nominal value; NaN where one is unknown."""
    known = ~np.isnan(values).any(axis=-1)
    ends = np.quantile(np.nan_to_num(values[..., 1:], posinf=np.inf), _PER_CENT, axis=-1, method="inverted_cdf")
    p5, p50, p95 = (np.where(known, x, np.nan)[()] for x in ends)
    return Band(p50, p5, p50, p95)


def _figures(
    columns: dict[str, Array], parts: SampledParts, conditions: Conditions, machine: Machine | None
) -> Iterable[Predicted]:
    """Predicted figures in the order of their declaration."""
    unknown, limit = np.full(2, np.nan), parts.motor["max_winding_temperature"]
    absent = {"start": machine is None, "swing": machine is None or isnan(machine.steepest)}
    for group, cells in _FIGURES:
        if group in ("kinds", "parts") or absent.get(group):
            continue
        name, title, kind, unit, needs = cells
        values = columns.get(name, unknown)
        band = Band(*(float(x) for x in _band(values)))
        never = float(np.isinf(values[1:]).mean()) if not isnan(band.nominal) else nan
        above = values[1:] > limit[1:] if "winding" in name else np.full(1, nan)
        over = nan if isnan(band.nominal) or np.isnan(limit).any() else float(above.mean())
        lacking = () if not isnan(band.nominal) else tuple(dict.fromkeys(_missing(needs, parts, conditions)))
        yield Predicted(name, group, title, kind, unit, band, never, over, lacking)


def _missing(needs: str, parts: SampledParts, conditions: Conditions) -> Iterable[str]:
    """Names of unknown figures among those that a prediction rests on."""
    figures: dict[str, Any] = {"motor": parts.motor, "gearhead": parts.gearhead, "controller": parts.controller}
    brushless = parts.motor["kind"][0] != "brushed"
    rubs = not np.isnan([x[0] for x in friction(parts.motor)]).any()
    if "moving" in needs and conditions.inertia:  # else there is no load whose torque the gear passes on
        needs += " gear"
    for need in [word for several in needs.split() for word in _KINDS.get(several, [several])]:
        if (need == "iron" and not brushless) or (need == "friction" and rubs):
            continue
        for role, name in (figure.split(".") for figure in _PARTS.get(need, ())):
            if name == "no_load_speed" and not brushless:
                continue
            value = nan if figures[role] is None else figures[role][name][0]
            if figures[role] is not None and (np.isnan(value) or (need == "heat" and not value > 0.0)):
                yield figure_words(role, name, bool(figures[role]["inside"][0]))
        if need in _CONDITIONS and isnan(getattr(conditions, _CONDITIONS[need][0])):
            yield _CONDITIONS[need][1]


def _share_of_idle(drive_set: SetAtVoltage) -> float:
    """Share of a gearhead's friction in all of the free running set, in the first row."""
    free = drive_set.running(0.0, 298.15)[0]
    return float(drive_set.drive.idle[0] / (drive_set.coulomb + drive_set.drive.viscous * free)[0])


def _leads(drive_set: SetAtVoltage, conditions: Conditions) -> Iterable[EstimatedFigure]:
    """Leads that nobody names, with their band."""
    if isnan(conditions.resistance) and drive_set.leads.any():
        value, low, high = (float(x) for x in np.quantile(drive_set.leads[1:], (0.5, 0.05, 0.95)))
        yield EstimatedFigure("supply", "leads", value, low, high, "resistance", "mohm", _LEADS_LAW, "assumed by class")


def _assumptions(drive_set: SetAtVoltage, parts: SampledParts, conditions: Conditions) -> Iterable[str]:
    """Assumptions, as sentences."""
    yield "the winding is at ambient temperature in all but the temperatures and the times to its limit"
    if parts.gearhead["ratio"][0] != 1.0 and not parts.motor["inside"][0]:
        if np.isnan(parts.gearhead["no_load_torque"][0]):
            yield "friction of the gearhead without load is unknown and left out: free running takes more current"
        elif _share_of_idle(drive_set) > _DECIDES:
            yield ("friction of the gearhead without load, which is not printed, decides how it runs freely: "
                   f"{_share_of_idle(drive_set):.0%} of all friction there").replace("%", " %")  # fmt: skip
    if drive_set.motor["kind"][0] == "brushless":
        yield ("at standstill the hottest phase has 1.5 to 2 times the mean loss, by the rotor's angle, and its "
               "neighbours lead away any part of what is above it")  # fmt: skip
    yield "at rest friction and gear loss carry any part of the torque between helping and hindering"
    if parts.controller is not None:
        yield "the power of the supply is before its resistance, with losses and standby power of the controller"
        if np.isnan(parts.controller["standby_current"][0]):
            yield "standby power of the controller not counted: it is not printed"
    if parts.controller is None and not np.isfinite(drive_set.most_current[0]):
        left = _STAGE_AT_WORST[0] * max(1.0 - _STAGE_AT_WORST[1] / conditions.voltage, 0.0)
        yield ("without a controller the winding is connected to the supply: nothing limits the current; one that is "
               f"named takes up to {1.0 - left:.0%} of the voltage".replace("%", " %"))  # fmt: skip
    elif parts.controller is None:
        yield "the controller inside limits the current to the printed stall current"


def _warnings(
    motor: PartRow,
    gearhead: PartRow | None,
    controller: PartRow | None,
    conditions: Conditions,
    columns: dict[str, Array],
) -> Iterable[str]:
    """Warnings to the reader, as sentences."""
    if gearhead is not None and gearhead.catalogue == motor.catalogue:
        pairs = motor.catalog.motor_gearhead
        if not ((pairs.left == motor.row) & (pairs.right == gearhead.row)).any():
            yield f"the catalogue does not list gearhead {gearhead.part} with motor {motor.part}"
    if controller is not None and not controller["supply_min"] <= conditions.voltage <= controller["supply_max"]:
        yield f"{show(conditions.voltage, 'V', 'voltage')} is outside the controller's supply, or that is unknown"
    for name, what in (("stall_current", "stalled"), ("load_current", "at the load"), ("hold_current", "holding")):
        if controller is not None and columns[name][0] > controller["continuous_current"]:
            continuous = show(controller["continuous_current"], "A", "current")
            yield f"{what} the motor takes more than the controller's continuous {continuous}: briefly only"
