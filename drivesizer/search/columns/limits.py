"""The demands of a load cycle against every limit of the candidates' catalogue figures, as columns.

In stages, the cheap ones first: what concerns the load alone, a gearhead alone, a motor alone, the moving pair, its
current. What needs the current of each moment, or how warm the winding then is, is in ``limits_over_time``. Limits are
those of the catalogues; no factor of the paper enters, the spec's ``margins`` do. A missing figure makes its check
*unknown*.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from drivesizer.catalog.parts import BeltDrive
from drivesizer.physics.belt import LEAST_IN_MESH, resonance
from drivesizer.physics.cycle_at_gearhead import DIRECTION, SPEED, AtGearhead
from drivesizer.physics.drive_train import drive_inertia
from drivesizer.physics.figures import Array, Columns, Figures, Mask, Range
from drivesizer.physics.load_cycle import OwnLimit
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.thermal import resistance_25, steady_winding_temperature
from drivesizer.physics.winding import Heat, Parts, Stress
from drivesizer.results.check_columns import CheckColumn, at_least, at_most, worst_case
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.ratings import (
    ASSUMED,
    ambient_range,
    continuous_speed_limit,
    controller_current,
    electrical_speed_limit,
    lasting_limit,
    motor_speed_limit,
    nominal_current_limit,
    nominal_torque_limit,
    short_limit,
    supply_voltage_limit,
)
from drivesizer.search.columns.brakes import brake_inertia, brake_limits, counting_limits, own_figure
from drivesizer.search.columns.shaft_limits import THRUST, life_of_gearheads, shock_limits
from drivesizer.spec.drive import ASSUMABLE, BeltStage
from drivesizer.spec.mounting import controller_needed, motor_needed, rise_needed
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.sections import required_life

_LIFE = "screw_life"  # a limit of the load whose demand is a need of the spec
_BY_TORQUE = "no power is printed: limited by torque and speed alone, assumed"
_NO_SHORT = "the limit at least: none for a short time is printed"
_OF_SPEED = ("screw_critical_speed", "screw_dn", "belt_speed")


def worst_of_all(cases: Iterable[Sequence[CheckColumn]]) -> list[CheckColumn]:
    """The worst load case of each check, of those of each case."""
    by_name: dict[str, list[tuple[int, CheckColumn]]] = {}
    for number, checks in enumerate(cases):
        for check in checks:
            by_name.setdefault(check.name, []).append((number, check))
    return [worst_case(same) for same in by_name.values()]


def unknown_where_doubtful(checks: list[CheckColumn], known: Mask) -> list[CheckColumn]:
    """The checks; with an unknown inertia those that hang on it may fail but not pass."""
    if known.all():
        return checks
    return [c.where_known(known) if CHECKS["physics"][c.name].on_inertia else c for c in checks]


def load_limits(spec: RobotSpec, cycle: AtGearhead, drive: BeltDrive | None = None) -> list[CheckColumn]:
    """Limits of the load and of the belt, the same for all candidates."""
    own = [check for own in cycle.load_cycle.own if (check := own_limit(spec, own)) is not None]
    checks = that_apply(spec, own)
    return checks + _belt_limits(spec, spec.belt, cycle, drive) if spec.belt else checks


# of what lasts: a motion that is run once from cold is held against the limits for a short time, and by its heat
_LASTING = frozenset({
    "gearhead_continuous_torque", "gearhead_continuous_speed", "gearhead_continuous_power", "gearhead_life",
    "screw_life",
})  # fmt: skip


def that_apply(spec: RobotSpec, checks: list[CheckColumn]) -> list[CheckColumn]:
    """The checks of a load case: without those of what lasts, where it is run once."""
    return [check for check in checks if check.name not in _LASTING] if spec.once else checks


def own_limit(spec: RobotSpec, own: OwnLimit) -> CheckColumn | None:
    """A limit of the load itself with the margin that the spec requires of its kind."""
    if own.name == THRUST:
        return None
    if own.name == _LIFE:
        required = required_life(spec.needs.life, "screw")
        return None if required is None else at_most(own.name, required, own.limit)
    needed = spec.margins.speed if own.name in _OF_SPEED else spec.margins.torque
    return at_most(own.name, own.demand, own.limit, needed=needed, time=np.array(own.time))


def _belt_limits(spec: RobotSpec, belt: BeltStage, cycle: AtGearhead, drive: BeltDrive | None) -> list[CheckColumn]:
    """Limits of the belt of this ratio, as far as its pulleys are known."""
    checks, diameter = [], drive.driven_diameter if drive else belt.pulley_diameter
    if spec.gear_before_belt:  # the load cycle brings them: it is that before the gear
        diameter = None
    if diameter is not None and belt.max_tension is not None:
        pull = cycle.load_torque / (diameter / 2)
        checks.append(at_most("belt_tension", pull, belt.max_tension, needed=spec.margins.torque))
    if diameter is not None and belt.max_speed is not None:
        fast = cycle.base.peak_speed * diameter / 2
        checks.append(at_most("belt_speed", fast, belt.max_speed, needed=spec.margins.speed))
    if drive is not None:  # passed by selection: the smallest pulleys with enough teeth are taken
        in_mesh = drive.teeth_in_mesh
        checks.append(at_least("belt_teeth_in_mesh", LEAST_IN_MESH, in_mesh, by_choice=True))
    return checks


def lost_at_load(spec: RobotSpec, backlash: Array, belt: Array) -> Array:
    """Backlash of gearheads, and of a gear of fixed ratio, as the load has it [rad]."""
    lost: Array = backlash / belt
    if spec.gear is None:
        return lost
    own = np.nan if spec.gear.backlash is None else spec.gear.backlash
    return lost / spec.gear.ratio + own / (belt if spec.gear_before_belt else 1.0)


def gearhead_limits(spec: RobotSpec, cycle: AtGearhead, gearhead: Figures) -> list[CheckColumn]:
    """Limits of the gearhead, whatever motor drives it; loads of its shaft are in ``shaft_limits``."""
    i, ambient = gearhead["ratio"], spec.environment.ambient
    torque, speed = spec.margins.torque, spec.margins.speed
    checks = [
        at_most("gearhead_continuous_torque", cycle.rms_torque,
                lasting_limit(gearhead["continuous_torque"], gearhead["intermittent_torque"]), needed=torque),
        at_most("gearhead_intermittent_torque", cycle.peak_torque,
                short_limit(gearhead["intermittent_torque"], gearhead["continuous_torque"]), needed=torque,
                undecided=_NO_SHORT),
        continuous_speed_limit(gearhead, cycle.mean_speed, cycle.sustained_speed, i, speed),
        at_most("gearhead_intermittent_speed", cycle.peak_speed * i,
                short_limit(gearhead["intermittent_input_speed"], gearhead["continuous_input_speed"]), needed=speed,
                undecided=_NO_SHORT),
        _power_limit("continuous_power", cycle.mean_power, gearhead, torque),
        _power_limit("intermittent_power", cycle.peak_power, gearhead, torque),
        ambient_range("gearhead_temperature_range", ambient, gearhead["temperature_min"], gearhead["temperature_max"],
                 waived="ambient_range" in spec.select.assume),
    ]  # fmt: skip
    needs = spec.needs
    if needs.backlash_at_load is not None:
        lost = lost_at_load(spec, gearhead["backlash"], cycle.belt)
        checks.append(waived(spec, at_most("backlash_at_load", lost, needs.backlash_at_load)))
    if needs.shock_torque is not None:
        checks += shock_limits(spec, needs.shock_torque, cycle, gearhead)
    required = required_life(needs.life, "gearhead")
    if required is not None:
        checks.append(at_most("gearhead_life", required, life_of_gearheads(cycle, gearhead)))
    return that_apply(spec, checks)


def _power_limit(figure: str, power: Array, gearhead: Figures, needed: float) -> CheckColumn:
    """A power of a gearhead against its limit; most makers print none beside those of torque and speed."""
    limit, rated = gearhead[figure], gearhead["continuous_torque"] + gearhead["continuous_input_speed"]
    column = at_most(f"gearhead_{figure}", power, limit, needed=needed)
    return column.assuming(np.isnan(limit) & ~np.isnan(rated), _BY_TORQUE)


def motor_limits(spec: RobotSpec, motor: Figures) -> list[CheckColumn]:
    """Limits of the motor, whatever it drives."""
    waived, (least, most) = "ambient_range" in spec.select.assume, (motor["ambient_min"], motor["ambient_max"])
    ambient = ambient_range("motor_temperature_range", spec.environment.ambient, least, most, waived=waived)
    return [ambient, *supply_voltage_limit(motor, spec.supply.highest)]


def waived(spec: RobotSpec, column: CheckColumn) -> CheckColumn:
    """A check that passes where its figure is missing, if the spec assumes so."""
    if not any(column.name in ASSUMABLE[name] for name in spec.select.assume):
        return column
    missing = ~(column.passed | column.failed) & np.isnan(column.limit + column.demand)
    return column.assuming(missing, ASSUMED)


def size_limits(spec: RobotSpec, motor: Figures, gearhead: Figures, brake: Figures | None = None) -> list[CheckColumn]:
    """Dimensions, mass and price, where the spec limits them."""
    needs = spec.needs
    sums = {name: motor[name] + gearhead[name] for name in ("length", "mass", "price") if getattr(needs, name)}
    counted = "motor and gearhead alone"
    if brake is not None:
        own, counted = {"length": "added_length", "mass": "mass", "price": "price"}, "motor, gearhead and brake alone"
        sums = {name: value + own_figure(brake, own[name]) for name, value in sums.items()}
    checks = [at_most(name, value, getattr(needs, name), note=counted) for name, value in sums.items()]
    if needs.diameter:
        checks.append(at_most("diameter", np.maximum(motor["diameter"], gearhead["diameter"]), needs.diameter))
    return checks


def moving_limits(
    spec: RobotSpec,
    cycle: AtGearhead,
    demand: Demands,
    heating: Heat | None,
    parts: Parts,
    listed: Mask,
    with_friction: Columns,
) -> list[CheckColumn]:
    """Limits of a combination in motion that the moments decide.

    ``heating``: None of a stepper, of which no heat is computed. ``listed``: whether the brake goes with the motor.
    ``with_friction``: the motor by whose friction a load is held.
    """
    checks = [] if heating is None else _lasting_limits(spec, cycle, demand, heating, parts.motor)
    checks += inertia_limits(spec, cycle, demand, parts)
    if parts.brake is not None:
        checks += brake_limits(spec, cycle, parts._replace(motor=with_friction), demand, listed)
    return unknown_where_doubtful(checks, demand.complete)


def _lasting_limits(
    spec: RobotSpec, cycle: AtGearhead, demand: Demands, heating: Heat, motor: Figures
) -> list[CheckColumn]:
    """Ratings of a motor that lasts; that of its winding by the mean of its heat, which is no more than its peak."""
    ambient = spec.environment.ambient
    torque, speed = motor_needed(spec), spec.margins.speed
    mean = cycle.moment(DIRECTION, SPEED) * demand.total_ratio
    rated = [
        nominal_current_limit(demand.rms_current, motor, ambient, torque),
        *nominal_torque_limit(demand.rms_torque, mean, motor, ambient, torque),
    ]
    if spec.once:
        rated = [_of_one_run(check, heating, motor) for check in rated]
    checks = [
        motor_speed_limit(demand.peak_speed, motor, speed),
        *rated,
        winding_limit(spec, heating.winding, motor),
    ]
    if not cycle.acts[SPEED] and not spec.once:  # the hottest phase, were none of its heat led to the others
        R_th1, R_th2 = motor["thermal_resistance_winding"], motor["thermal_resistance_housing"]
        hottest = steady_winding_temperature(ambient, resistance_25(motor), _UNEVEN * R_th1, R_th2, demand.rms_current)
        limit = np.where(motor["kind"] == "brushed", np.inf, motor["max_winding_temperature"])
        checks.append(at_most("hottest_phase", np.asarray(hottest), limit, zero=ambient, needed=rise_needed(spec),
                             advice=True, note=_UNEVEN_NOTE))  # fmt: skip
    return checks


def _of_one_run(check: CheckColumn, heating: Heat, motor: Figures) -> CheckColumn:
    """A continuous rating where a motion is run once from cold: no limit where its heat is known, else none to fail."""
    figures = ("max_winding_temperature", "winding_time_constant", "motor_time_constant")
    known = ~np.isnan(heating.winding + sum(motor[name] for name in figures))
    limit = np.where(known, np.inf, check.limit)
    return check._replace(limit=limit, passed=check.passed | known, failed=np.zeros_like(check.failed))


def winding_limit(spec: RobotSpec, winding: Array | Range, motor: Figures, time: Range | None = None) -> CheckColumn:
    """A winding temperature against the permitted one, and when it is met."""
    permitted = motor["max_winding_temperature"]
    unknown = np.isnan(permitted)
    limit = Range(permitted, np.where(unknown, _HOTTEST, permitted) if np.any(unknown) else permitted)
    return at_most(
        "winding_temperature", winding, limit, zero=spec.environment.ambient, needed=rise_needed(spec), time=time,
        basis=_NO_WINDING,
    )  # fmt: skip


_HOTTEST = 523.15  # K, thermal class 250 of IEC 60085, the highest
_NO_WINDING = "at most: no insulation has a higher thermal class"
_UNEVEN = 2.0  # largest loss of a phase at rest over the mean of three, by the rotor's angle
_UNEVEN_NOTE = "at rest the hottest phase of a brushless motor has 1.5 to 2 times the mean heat: informational"


def inertia_limits(spec: RobotSpec, cycle: AtGearhead, demand: Demands, parts: Parts) -> list[CheckColumn]:
    """Inertia ratio and first resonance, which hang on no current: motor and load on the belt's stiffness."""
    needs, checks = spec.needs, []
    total = demand.total_ratio * cycle.belt
    own = drive_inertia(parts.motor, parts.gearhead, parts.encoder, brake_inertia(parts, cycle.belt)) * total**2
    if needs.inertia_ratio is not None:
        checks.append(at_most("inertia_ratio", cycle.load_cycle.inertia / own, needs.inertia_ratio))
    if needs.resonance is not None:
        first = resonance(spec.belt_stiffness, cycle.load_cycle.inertia, 1 + cycle.load_cycle.inertia / own)
        checks.append(at_least("first_resonance", needs.resonance, first.resonance))
    return checks


def electrical_limits(
    spec: RobotSpec, cycle: AtGearhead, demand: Demands, stresses: Stress, parts: Parts
) -> list[CheckColumn]:
    """Limits of motor, controller and encoder by current and speed.

    The motor's torque is held against its permitted peak, where the maker limits it beside heat and speed; else
    against its torque at stall, where the winding's figures are unknown by which the voltage limits it.
    """
    motor, controller, needed = parts.motor, parts.controller, spec.margins.torque
    lasting, printed = controller_current(controller, spec.environment.ambient), controller["continuous_current"]
    stall = motor["stall_torque"] * np.fmax(spec.supply.highest / motor["nominal_voltage"], 1.0)
    of_stall = np.isnan(motor["resistance"] * motor["torque_constant"]) & ~np.isnan(stall)
    peak = np.where(np.isnan(motor["peak_torque"]), np.where(of_stall, stall, np.inf), motor["peak_torque"])
    time = stresses.current.time
    checks = [
        at_most("motor_peak_torque", stresses.torque, peak, needed=needed, time=time),
        at_most("controller_continuous_current", demand.rms_current,
                Range(lasting, lasting if lasting is printed else np.fmin(lasting, printed)),
                needed=controller_needed(spec)),
        at_most("controller_peak_current", stresses.current.value, most_current(spec, controller), needed=needed,
                time=time),
        *counting_limits(spec, cycle.belt, demand, parts),
        electrical_speed_limit(
            "controller_speed", electrical_speed(demand, motor), motor["kind"], controller, spec.margins.speed
        ),
    ]  # fmt: skip
    return unknown_where_doubtful(checks, demand.complete)


def most_current(spec: RobotSpec, controller: Figures) -> Array | Range:
    """Largest current of controllers [A]; of one whose own is unknown at most what it is set to."""
    own, limit = controller["peak_current"], spec.power_stage.motor_current
    return own if limit is None else Range(own, np.fmin(own, limit))


def electrical_speed(demand: Demands, motor: Figures) -> Array:
    """Speed times pole pairs, where the controller commutates; 0 of a brushed motor, which does so itself."""
    turns = (motor["kind"] != "brushed") & (demand.peak_speed != 0.0)
    return np.where(turns, demand.peak_speed * motor["pole_pairs"], 0.0)
