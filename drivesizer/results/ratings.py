"""Demands against makers' ratings, by the rules of what each rating means; the same for search and closed loop."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Unpack

import numpy as np

from drivesizer.catalog.parts import Controller, Motor
from drivesizer.physics.drive_train import back_emf_constant
from drivesizer.physics.figures import Alike, Array, Figures, Mask, Range, once_per_part
from drivesizer.physics.thermal import current_derating, derating_at_most, rated_ambient
from drivesizer.results.check_columns import CheckColumn, Options, at_most
from drivesizer.results.drive_set import DriveParts, DriveSet
from drivesizer.spec.mounting import rise_left
from drivesizer.spec.sections import Environment, Supply

_USUAL = (273.15, 313.15)  # K, 0 and 40 degC: ambients of IEC 60034-1 where nothing else is stated
ASSUMED = "assumed, by select.assume"
ASSUMED_AMBIENT = "assumed: 0 to 40 °C of IEC 60034-1, as the maker states no range"
_EXTRA_LOW = 75.0  # V, direct, up to which nobody need test insulation: Directive 2014/35/EU, article 1
# a winding for mains of 200 V, 283 V rectified, runs at 240 V + 10 %, 373 V: 1.32; for 400 V it is another
_CLASS = 1.5
_BY_RULE = "by a rule, as its maker prints no highest voltage: 1.5 times the nominal one, or 75 V where that is more"
_OF_A_CLASS = "assumed: its winding is that for this supply, as its maker prints no voltage"
_COIL = 0.1  # share of its voltage: 24 V +- 10 % (Bosch Rexroth MSK, project planning, 10.10; Siemens SINAMICS S120)
_CONTROL = 24.0  # V, of the control supply that machines have beside that of their drives: IEC 61131-2
OWN_SUPPLY = "assumed: it is fed with the voltage that its coil needs, from a supply of its own where that is another"
_HIGHER = "no such voltage is known of the machine, and it must be made out of a lower one: supply.brakes"
_COLDER = "at most: the permitted winding temperature is unknown"
_COOLER = "at most: thermal figures are unknown"
_COOLED = "unknown: thermal figures by which its mounting, cooler than the printed one, raises the rating"
_IDLE = 1.3  # times the permissible speed, which no no-load speed exceeds
_BY_IDLE = "no permissible speed is printed: assumed at least that at nominal load, or without load / 1.3"
COMMUTATED = 2617.9938779914944  # rad/s, 25 000 rpm of speed times pole pairs
_BY_COMMUTATION = "no electrical speed is printed: assumed at least 25 000 rpm, as none that prints it has less"
_BY_THE_MEAN = ("Apex Dynamics", "Harmonic Drive", "Wittenstein")  # makers that limit the mean input speed


def continuous_speed_limit(
    gearhead: Figures, mean_speed: Alike, sustained_speed: Alike, ratio: Alike, needed: float = 0.0
) -> CheckColumn:
    """The lasting speed at a gearhead's input against its continuous one, by the rule of its maker."""
    speed = np.where(_limits_mean_speed(gearhead), mean_speed, sustained_speed)
    limit = lasting_limit(gearhead["continuous_input_speed"], gearhead["intermittent_input_speed"])
    return at_most("gearhead_continuous_speed", speed * ratio, limit, needed=needed)


def lasting_limit(lasting: Alike, short: Alike) -> Range:
    """Both ends of a continuous limit: where it is unknown at most that for a short time."""
    unknown = np.isnan(lasting)
    most: Alike = np.where(unknown, short, lasting) if np.any(unknown) else lasting
    return Range(lasting, most)


def short_limit(short: Alike, lasting: Alike) -> Range:
    """Both ends of a limit for a short time: where it is unknown at least the continuous one."""
    unknown = np.isnan(short)
    least: Alike = np.where(unknown, lasting, short) if np.any(unknown) else short
    return Range(least, short)


@once_per_part
def _limits_mean_speed(gearhead: Figures) -> Mask:
    """Whether the maker limits the mean input speed."""
    return np.isin(gearhead["manufacturer"], _BY_THE_MEAN)


def controller_current(controller: Figures, ambient: Array | float) -> Alike:
    r"""Continuous current of controllers in an ambient, where their derating is printed.

    .. math:: I = \max(I_N - s (T - T_N), 0) \text{ above } T_N, \quad I = 0 \text{ above } T_{max}

    Examples
    --------
    maxon EPOS2 24/5: 5 A up to 55 degC, from there to 83 degC 0.179 A/K less:

    >>> epos2 = {"continuous_current": 5.0, "full_current_ambient": 328.15, "derating_slope": 0.179,
    ...          "ambient_max": 356.15, "inside": ""}
    >>> [round(float(controller_current(epos2, 273.15 + t)), 3) for t in (55.0, 65.0, 82.0, 84.0)]
    [5.0, 3.21, 0.167, 0.0]
    """
    printed, full = controller["continuous_current"], controller["full_current_ambient"]
    if (unknown := np.isnan(printed)).any():
        printed = np.where(unknown & (controller["inside"] != ""), np.inf, printed)
    hotter, too_hot = ambient > np.asarray(full), ambient > np.asarray(controller["ambient_max"])
    if not (hotter.any() or too_hot.any()):
        return printed
    left = np.maximum(printed - controller["derating_slope"] * (ambient - np.asarray(full)), 0.0)
    derated: Array = np.where(too_hot, 0.0, np.where(hotter, left, printed))
    return np.where(np.isnan(printed), np.nan, derated)


def continuous_currents(motor: Motor, controller: Controller | None, environment: Environment) -> tuple[float, float]:
    """Continuous currents [A] of motor and controller of a drive in their surroundings; NaN unknown."""
    left, ambient = rise_left(environment), environment.ambient
    derating = float(current_derating(ambient, motor.max_winding_temperature, rated_ambient(motor)))
    own = float(controller_current(controller, ambient)) * left if controller else np.nan
    return motor.nominal_current * (derating * np.sqrt(left)), own


def motor_speed_limit(speed: Alike, motor: Figures, needed: float = 0.0) -> CheckColumn:
    """A motor's speed against the permissible one; where none is printed it is at least one that its maker runs it at.

    Of 904 motors that print both none permits less than the no-load speed at nominal voltage over 1.3.
    """
    printed, reached = motor["max_speed"], np.fmax(motor["nominal_speed"], motor["no_load_speed"] / _IDLE)
    return _or_assumed("motor_speed", speed, printed, np.isnan(printed), reached, _BY_IDLE, needed)


def electrical_speed_limit(
    name: str, speed: Alike, kind: Alike, controller: Figures, needed: float = 0.0
) -> CheckColumn:
    """Speed times pole pairs against what a controller commutates; a brushed motor does so itself.

    Where its maker prints none, a controller is taken to reach what the slowest of those do that print it: maxon's
    EPOS2. moteus boards reach 240 000 rpm, an ODrive 3.6 by its makers' forum 35 000.
    """
    printed = np.where(np.asarray(kind) == "brushed", np.inf, controller["max_speed_sine"])
    silent = np.isnan(printed) & (np.asarray(controller["part"]) != "")
    return _or_assumed(name, speed, printed, silent, COMMUTATED, _BY_COMMUTATION, needed)


def _or_assumed(
    name: str, demand: Alike, printed: Alike, silent: Mask, least: Alike, why: str, needed: float
) -> CheckColumn:
    """A demand against the printed limit, or where its maker is silent one that is reached at least, which is shown."""
    reached: Alike = np.where(silent, least, printed)
    column = at_most(name, demand, Range(reached, printed), needed=needed, undecided=why)
    return column.assuming(silent & column.passed, why)


def controller_power_limit(power: Alike, controller: Figures, voltage: float, **more: Unpack[Options]) -> CheckColumn:
    r"""The largest power of a drive against what its controller permits at a supply voltage.

    .. math:: P = P_{max} - (P_{max} - P_{red}) \frac{V - V_{max}}{V_{red} - V_{max}}, \qquad P_{red} \le P \le P_{max}

    Examples
    --------
    moteus r4.11: 900 W up to 30 V, 400 W from 38 V on:

    >>> r4 = {"max_power": 900.0, "max_power_voltage": 30.0, "reduced_power": 400.0, "reduced_power_voltage": 38.0}
    >>> [float(controller_power_limit(500.0, r4, volts).limit) for volts in (24.0, 32.0, 44.0)]
    [900.0, 775.0, 400.0]
    """
    most, low = controller["max_power"], controller["reduced_power"]
    first, last = controller["max_power_voltage"], controller["reduced_power_voltage"]
    share = np.clip((voltage - first) / (last - first), 0.0, 1.0)
    limit = np.where(voltage <= np.asarray(first), most, most - (most - low) * share)
    limit = np.where(np.isnan(most), np.inf, limit)
    return at_most("controller_power", power, Range(limit, np.where(np.isnan(limit), most, limit)), **more)


def nominal_current_limit(
    rms: Array | float, motor: Figures, ambient: Array | float, needed: float = 0.0
) -> CheckColumn:
    """The RMS current against the nominal one in an ambient.

    Where none is printed the nominal torque is the rating, or the permitted winding temperature: no limit then.
    With an unknown permitted temperature the limit has two ends. Colder than the rating it is the nominal current at
    least, and ``derating_at_most`` of it at most; hotter it is the nominal current at most.
    """
    rating = motor["nominal_current"]
    if (unrated := np.isnan(rating)).any():
        otherwise = ~np.isnan(motor["nominal_torque"]) | ~np.isnan(motor["max_winding_temperature"])
        rating = np.where(unrated & otherwise, np.inf, rating)
    return _rated("motor_nominal_current", rms, rating, motor, ambient, needed)


def nominal_torque_limit(
    rms: Array, speed: Array, motor: Figures, ambient: float, needed: float = 0.0
) -> list[CheckColumn]:
    r"""The RMS torque against the nominal one, of motors whose current is not known.

    Where the continuous torque at standstill is printed too, that of the cycle lies between: copper and iron share the
    heat, and the iron's is taken to grow with the speed, which is the most that it can have at part speed.

    .. math:: M^2 = M_0^2 - (M_0^2 - M_N^2) \overline{|\omega|} / \omega_N
    """
    unjudged = np.isnan(motor["torque_constant"] * motor["nominal_current"]) & ~np.isnan(motor["nominal_torque"])
    if not unjudged.any():
        return []
    nominal, still = motor["nominal_torque"], motor["standstill_torque"]
    between = np.sqrt(np.maximum(still**2 - (still**2 - nominal**2) * speed / motor["nominal_speed"], 0.0))
    rating = np.where(unjudged, np.where(np.isnan(between), nominal, between), np.inf)
    return [_rated("motor_nominal_torque", rms, rating, motor, ambient, needed)]


def _rated(
    name: str, rms: Array | float, rating: Alike, motor: Figures, ambient: Array | float, needed: float
) -> CheckColumn:
    """An RMS demand against a thermal rating, in another ambient than that of the rating."""
    T_max, rated, gain = motor["max_winding_temperature"], rated_ambient(motor), motor["mounted_gain"]
    shares = (current_derating, derating_at_most)[: 2 if np.isnan(T_max).any() else 1]
    ends = [np.where(np.isposinf(rating), np.inf, rating * share(ambient, T_max, rated)) for share in shares]
    limit = Range(ends[0], ends[-1])
    if np.isnan(gain).all():
        return at_most(name, rms, limit, needed=needed, basis=_COLDER)
    warmer = (gain == 1.0) & ~np.isposinf(limit.low)  # the printed rating is the most
    limit = Range(np.where(warmer, np.nan, limit.low), np.where(np.isnan(gain), 1.0, gain) * limit.high)
    return at_most(name, rms, limit, needed=needed, basis=_COOLER, undecided=_COOLED)


def unless_printed(column: CheckColumn, figure: str, drive: DriveParts) -> CheckColumn:
    """A check of one drive that fails no limit which the maker of its actuator does not print."""
    estimated = drive.estimated if isinstance(drive, DriveSet) else ()
    most = [estimate.high for estimate in estimated if (estimate.part, estimate.figure) == ("actuator", figure)]
    return column._replace(failed=column.failed & (column.demand > most[0])) if most else column


def ambient_range(name: str, ambient: float, least: Alike, most: Alike, *, waived: bool = False) -> CheckColumn:
    """The ambient within a range: outside of a known end it fails, within both it passes.

    An end that the maker does not state is that of IEC 60034-1, 6.2 and 6.4, at which it passes as an assumption.
    """
    least, most = np.asarray(least), np.asarray(most)
    cold, hot = ambient < least, ambient > most
    known = (ambient >= np.where(np.isnan(least), _USUAL[0], least)) & (
        ambient <= np.where(np.isnan(most), _USUAL[1], most)
    )
    passed = ~(cold | hot) & (known | waived)
    limit = np.where(cold, least, np.where(hot | passed, np.where(np.isnan(most), _USUAL[1], most), np.nan))
    return CheckColumn(
        name=name, demand=np.full(limit.shape, ambient), limit=limit, passed=passed, failed=cold | hot, zero=np.nan,
        on_basis=passed & (np.isnan(least) | np.isnan(most)), basis=ASSUMED if waived else ASSUMED_AMBIENT,
    )  # fmt: skip


def supply_voltage_limit(motor: Figures, volts: Alike) -> list[CheckColumn]:
    """The highest supply voltage against what the insulation of motors permits.

    Where the maker prints a limit it counts. Else a winding is taken to withstand 1.5 times its nominal voltage, and
    75 V in any case; beyond that it is unknown. maxon, for one, specifies motors for extra-low voltage alone, as above
    it tests of each application would be due (support.maxongroup.com, "Small voltage range of DC drives"). Of motors
    without a nominal voltage whose back-EMF is unknown, or above 75 V at their highest speed, the winding is taken to
    be that for the supply.
    """
    printed = motor["max_voltage"]
    silent = np.isnan(printed)
    if silent.all() and np.all(np.asarray(volts) <= _EXTRA_LOW):
        return []
    nominal, k_e = motor["nominal_voltage"], back_emf_constant(motor)
    wound_for = np.where(np.isnan(nominal), k_e * np.fmax(motor["max_speed"], motor["nominal_speed"]), nominal)
    of_class = (
        silent & np.isnan(nominal) & (np.isnan(k_e) | (wound_for > _EXTRA_LOW)) & (np.asarray(volts) > _EXTRA_LOW)
    )
    limit = np.where(silent, np.fmax(_CLASS * wound_for, _EXTRA_LOW), printed)
    limit = np.where(of_class, np.nan, np.where(motor["kind"] == "stepper", np.inf, limit))  # has its own check
    limit = Range(limit, np.where(silent, np.nan, printed))
    column = at_most("motor_supply_voltage", volts, limit, undecided=_BY_RULE, by_choice=True)
    return [column.assuming(of_class, _OF_A_CLASS)]


def coil_voltage(brake: Figures, supply: Supply) -> CheckColumn:
    """Voltage that feeds a brake against that of its coil: ``supply.brakes``, else what it needs.

    Up to the voltage of the machine, or of a usual control supply, that can be had; above both it is unknown.
    """
    coil, brake_supply, there = brake["supply"], supply.brakes, brake["part"] != ""
    volts = np.nan if brake_supply is None else brake_supply
    shared = brake_supply is None or volts == supply.nominal  # of samples each
    low, high = (np.where(shared, end, volts) for end in (supply.lowest, supply.highest))
    least, most = (1.0 - _COIL) * coil, (1.0 + _COIL) * coil
    weak = low < least
    demand, limit = np.where(weak, least, high), np.where(there, np.where(weak, low, most), np.inf)
    apart = there & ~(demand <= limit) & (brake_supply is None)
    at_hand = np.maximum(supply.highest, _CONTROL)
    higher = apart & (least > at_hand)
    demand, limit = np.where(apart, coil, demand), np.where(apart, most, limit)
    ends = Range(np.where(higher, at_hand, limit), np.where(higher, np.nan, limit))
    column = at_most("brake_voltage", demand, ends, by_choice=True, undecided=_HIGHER)
    return column.assuming(apart & ~higher, OWN_SUPPLY)


def unstated_ambient(sets: Iterable[DriveSet]) -> tuple[str, ...]:
    """Assumption for drives of which a maker does not state at which ambient they may run."""
    names = {"motor_temperature_range": "motor", "gearhead_temperature_range": "gearhead"}
    parts = (
        getattr(drive, names[check.name]).part
        for drive in sets
        for check in drive.checks
        if check.name in names and check.note == ASSUMED_AMBIENT
    )
    part_names = ", ".join(dict.fromkeys(parts))
    return (
        (f"no catalogue says at which ambient {part_names} may run: 0 to 40 °C are assumed, of IEC 60034-1",)
        if part_names
        else ()
    )


def unstated_supply(sets: Iterable[DriveSet]) -> tuple[str, ...]:
    """Assumption for controllers inside a motor or actuator of which nobody states at which voltages they work."""
    silent = (drive for drive in sets if drive.actuator is None or np.isnan(drive.actuator.supply_max))
    names = ", ".join(
        dict.fromkeys(drive.controller.inside for drive in silent if drive.controller and drive.controller.inside)
    )
    usual = "0.85 to 1.15 times the nominal voltage are assumed, as of batteries in IEC 60204-1, 4.3.3"
    return (f"no catalogue says at which supply the controller inside {names} works: {usual}",) if names else ()


def unstated_temperature(parts: Iterable[str]) -> tuple[str, ...]:
    """Assumption for motors whose catalogue does not state the temperature of their figures."""
    names = ", ".join(dict.fromkeys(parts))
    return (f"no catalogue says at which temperature the figures of {names} hold: 25 °C is assumed",) if names else ()
