"""Power that a machine draws from its battery, its autonomy and range, and their checks.

The drive's power is that of its load cycle, repeated without pause; other consumers count by their share of the time.
The run time is that of the mean power (``battery_pack``); currents and voltage are those of each moment, with every
consumer at its peak at once.

Symbols: P power [W], E voltage at rest [V], I current [A], T time [s].
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isnan, nan
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.errors import InputError
from drivesizer.machine.battery import (
    Load,
    Pack,
    accepted,
    battery_checks,
    capacity_needed,
    pack_of,
    raised_voltage,
    required_autonomy,
    resting_voltage,
    run_time,
    strings_needed,
)
from drivesizer.machine.supply_power import DrivePower
from drivesizer.physics.battery import current_of_power, polarised_voltage, state_of_charge, terminal_voltage
from drivesizer.results.drive_set import Consumption, DriveParts, EnergyBudget, loss_assumptions
from drivesizer.results.sizing import Check, Figure, verdict
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

if TYPE_CHECKING:
    from drivesizer.spec.battery import Battery, Consumer

__all__ = ["budget_of_consumers", "charge_over_mission", "checks_of_battery", "consumers_of", "energy_budget"]

Array = NDArray[np.float64]
_POINTS = 2000  # of the state of charge over a mission


def energy_budget(
    spec: RobotSpec,
    drive_set: DriveParts,
    battery: Battery,
    equipment: Sequence[Consumer],
    catalog: Catalog,
    drive: DrivePower,
) -> EnergyBudget:
    """Consumers, autonomy and checks of a drive in a machine, or in one of its load cases."""
    drawing, assumed = consumers_of(spec, drive_set, drive), tuple(loss_assumptions(spec, drive_set.controller))
    return budget_of_consumers(spec, drawing, battery, equipment, catalog, drive, assumed)


def budget_of_consumers(
    spec: RobotSpec,
    drawing: Sequence[Consumption],
    battery: Battery,
    equipment: Sequence[Consumer],
    catalog: Catalog,
    drive: DrivePower,
    assumed: Sequence[str] = (),
) -> EnergyBudget:
    """Consumers, autonomy and checks of a machine whose drives are known by what they draw."""
    pack = pack_of(battery, catalog)
    others = _equipment_power(spec, equipment)
    load, power = _battery_load(spec, battery, pack, others, drive)
    checks = battery_checks(spec, battery, pack, load)
    wear = float(drive.duration @ (1.0 / run_time(pack, power))) / drive.total  # as in a steady load, moment by moment
    worn = 1.0 / wear if wear > 0.0 else (inf if wear == 0.0 else nan)
    return EnergyBudget(
        battery=pack.name,
        start=pack.start,
        usable=pack.usable,
        consumers=(*drawing, *others),
        duration=drive.duration,
        power=power,
        mean_power=load.mean,
        peak_power=load.peak,
        full_time=load.full,
        autonomy=load.full * pack.available,
        range=load.speed * load.full * pack.available,
        required=load.required,
        status=verdict(checks),
        checks=checks,
        figures=_figures(spec, battery, pack, load, worn * pack.available),
        assumptions=_assumptions(spec, battery, pack, equipment, assumed),
    )


def checks_of_battery(
    spec: RobotSpec, battery: Battery, equipment: Sequence[Consumer], catalog: Catalog, drive: DrivePower
) -> tuple[Check, ...]:
    """The checks alone of ``energy_budget``."""
    pack = pack_of(battery, catalog)
    load, _ = _battery_load(spec, battery, pack, _equipment_power(spec, equipment), drive)
    return battery_checks(spec, battery, pack, load)


# --- consumers -------------------------------------------------------------------------------------------------------


def consumers_of(spec: RobotSpec, drive_set: DriveParts, drive: DrivePower) -> tuple[Consumption, ...]:
    """Lines of a drive in the table of consumers."""
    share, sets, slip = spec.supply.regeneration, spec.load.motors, spec.platform.slip if spec.platform else 0.0
    mean = {name: drive.mean(getattr(drive, name)) for name in _MEANS}
    drawn, returned, peak = mean["motor_drawn"], share * mean["motor_returned"], float(drive.peak.max())
    released = sets * drive_set.released_power * spec.brake_released
    lost = mean["bus_drawn"] - drawn + returned - share * mean["returned"] - released
    assumed = bool(spec.feed_of(drive_set.controller).stage.assumed)
    found: tuple[Consumption, ...] = (
        Consumption("drive", sets, drawn * (1.0 - slip), peak, nan, False),
        Consumption("regenerated energy", sets, -returned, 0.0, nan, False),
        Consumption("losses of the controllers", sets, lost, 0.0, nan, assumed),
    )
    if slip:
        found += (Consumption("slip of the wheels", sets, drawn * slip, 0.0, nan, False),)
    if released:
        found += (Consumption("brakes, released", sets, released, 0.0, nan, False),)
    cables = Consumption("resistance of the supply", 1, mean["resisted"], 0.0, nan, False)
    return found if spec.supply.resistance is None else (*found, cables)


_MEANS = ("bus_drawn", "returned", "resisted", "motor_drawn", "motor_returned")


def _equipment_power(spec: RobotSpec, equipment: Sequence[Consumer]) -> tuple[Consumption, ...]:
    mission = spec.mission.duration if spec.mission else None
    found = []
    for one in equipment:
        try:
            mean, peak = one.drawn(mission)
        except ValueError as error:
            raise InputError(f"equipment: {error}") from None
        found.append(Consumption(one.name, one.number, mean, peak, one.share(mission), one.assumed))
    return tuple(found)


# --- load of the battery --------------------------------------------------------------------------------------------


def _battery_load(
    spec: RobotSpec, battery: Battery, pack: Pack, others: Sequence[Consumption], drive: DrivePower
) -> tuple[Load, Array]:
    """Load of a battery, and mean power from it in each piece [W].

    Lowest is the voltage at the peak, at the end of the time; unknown where no current gives that power. Highest is
    that at the largest return, with the charge of the start and all else switched off. A polarised battery is at rest
    at first, and then comes to what the cycle makes of it: the higher of both counts.
    """
    power = np.asarray(drive.drawn - spec.supply.regeneration * drive.returned + sum(c.mean for c in others))
    mean, peak = drive.mean(power), float(drive.peak.max()) + sum(c.peak for c in others)
    back, speed = accepted(spec) * float(drive.returned_peak.max()), drive.distance / drive.total
    full = float(run_time(pack, mean))
    along = nan if battery.range is None else battery.range / speed
    required = float(np.fmax(required_autonomy(spec, battery), along))
    drawn = pack.available if isnan(required) else required / full
    charge = nan if isnan(drawn) else pack.start - min(drawn, pack.available)
    at_peak, raised = pack.emf(charge), float(resting_voltage(pack, mean))
    if pack.polarisation > 0.0:  # the cycle charges the pair, peak and return come on top
        pair, off = (pack.polarisation, pack.time_constant), np.asarray(drive.drawn - accepted(spec) * drive.returned)
        current = current_of_power(power, at_peak, pack.resistance)
        at_peak = float(np.minimum(*polarised_voltage(drive.duration, current, at_peak, 0.0, *pair)).min())
        current, start = current_of_power(off, raised, pack.resistance), raised
        for rested in (True, False):
            ends = polarised_voltage(drive.duration, current, start, 0.0, *pair, rested=rested)
            raised = max(raised, float(np.maximum(*ends).max()))
    load = Load(
        mean=mean,
        peak=peak,
        rms=float(np.sqrt(drive.mean(power**2))),
        back=back,  # with everything else switched off
        speed=speed,
        full=full,
        required=required,
        charge=charge,
        lowest=float(terminal_voltage(current_of_power(peak, at_peak, pack.resistance), at_peak, pack.resistance)),
        highest=float(raised_voltage(pack, back, raised)),
    )
    return load, power


def _figures(spec: RobotSpec, battery: Battery, pack: Pack, load: Load, worn: float) -> tuple[Figure, ...]:
    mission = spec.mission.duration if spec.mission else nan
    needed = capacity_needed(pack, load.mean, load.required * (1.0 + battery.reserve))
    drawn = nan if load.full == inf else load.mean / pack.mean_voltage * load.full
    lacking = {"mission_energy": isnan(mission), "range": isnan(load.speed)}
    less, charging = load.full - float(run_time(pack, load.mean + 1.0)), nan
    if battery.charger is not None:  # the constant voltage at the end of a charge takes longer
        lasts = load.full * pack.available if isnan(load.required) else load.required
        charged = max(load.mean, 0.0) / pack.mean_voltage * lasts
        charging = float(charged / (battery.charger.current * battery.charger.efficiency))
    lacking |= {"autonomy_per_watt": isnan(less), "charging_time": battery.charger is None}
    lacking |= dict.fromkeys(("charge_left", "capacity_needed", "strings_needed"), isnan(load.required))
    rows = (
        ("mean_power", "Mean power from the battery", load.mean, "power", "W"),
        ("peak_power", "Largest power, all at once", load.peak, "power", "W"),
        ("mission_energy", "Energy of the mission", load.mean * mission, "energy", "W*h"),
        ("rated_energy", "Rated energy of the battery", pack.energy, "energy", "W*h"),
        ("mean_current", "Mean current", load.mean / pack.mean_voltage, "current", "A"),
        ("charge_drawn", "Charge that this load draws in all", drawn, "charge", "A*h"),
        ("autonomy", "Autonomy, of the usable share", load.full * pack.available, "time", "h"),
        ("autonomy_per_watt", "Autonomy that one watt more takes", less * pack.available, "time", "h"),
        ("autonomy_worn", "Autonomy, every moment worn as a steady load", worn, "time", "h"),
        ("range", "Range, at the cycle's mean speed", load.speed * load.full * pack.available, "length", "km"),
        ("charge_left", "Charge left at the end of what is required", load.charge, "dimensionless", "%"),
        ("charging_time", "Charging time, at least, of the charge drawn", charging, "time", "h"),
        ("capacity_needed", "Rated capacity for what is required", needed, "charge", "A*h"),
        ("strings_needed", "Parallel strings for it", strings_needed(pack, needed), "dimensionless", "1"),
        ("battery_mass", "Mass of the battery", pack.mass, "mass", "kg"),
    )
    return tuple(
        Figure(name=n, title=t, value=float(v), kind=k, unit=u) for n, t, v, k, u in rows if not lacking.get(n)
    )


# --- over the mission ------------------------------------------------------------------------------------------------


def charge_over_mission(budget: EnergyBudget, mission: float, most: int = _POINTS) -> tuple[Array, Array]:
    """Charge left over a mission, from that of the start: times [s] and shares [1].

    Drawn and returned charge count alike, against what the battery gives at the mean load: a full one is empty when
    ``full_time`` has passed, and below 0 after that. Of a mission of very many cycles the mean is reported.
    """
    all_of_it = budget.mean_power * budget.full_time
    cycle = float(budget.duration.sum())
    count = int(np.ceil(mission / cycle * (1.0 - 1e-9)))
    if count * len(budget.duration) >= most:
        time = np.linspace(0.0, mission, most)
        return time, state_of_charge(np.diff(time), budget.mean_power, all_of_it, budget.start)
    duration = np.tile(budget.duration, count)
    time = np.concatenate([[0.0], np.cumsum(duration)])
    charge = state_of_charge(duration, np.tile(budget.power, count), all_of_it, budget.start)
    end = np.interp(mission, time, charge)
    inside = time < mission
    return np.append(time[inside], mission), np.append(charge[inside], end)


# --- what was taken for granted --------------------------------------------------------------------------------------


def _assumptions(
    spec: RobotSpec, battery: Battery, pack: Pack, equipment: Sequence[Consumer], assumed: Sequence[str]
) -> tuple[str, ...]:
    unknown = "run time unknown: neither a discharge table nor a Peukert exponent with its rated time is known"
    found = [
        f"run time by {pack.rule}, at the mean power" if pack.rule else unknown,
        f"current of the run time at {show(pack.mean_voltage, 'V', 'voltage')}",
        "the cycle repeats without pause",
    ]
    if battery.rated_time and pack.table is None:
        found.insert(1, f"capacity as rated over {show(battery.rated_time, 'h', 'time')}, as the spec says")
    guessed = [one.name for one in equipment if one.assumed]
    if guessed:
        found.append(f"power of {', '.join(guessed)} assumed")
    found += assumed
    if spec.platform and not spec.platform.slip and any(w.kind == "mecanum" for w in spec.platform.places):
        found.append("slip of the rollers on the floor is not counted: platform.slip")
    if battery.charger:
        found.append("charging at a constant current to the end: with a constant voltage at the end it takes longer")
    if not pack.rests:
        found.append("voltage at rest taken as the nominal one: towards the end of the charge it is less")
    if spec.supply.regeneration == 0.0:
        found.append("no regenerated energy is stored")
    return tuple(found)
