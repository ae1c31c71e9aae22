"""One drive against every limit, sample by sample: the column code of the search with samples as columns.

The search has many drives over one load cycle, here is one drive over many: figures of its parts times factors, the
spec's figures as columns, the load cycle of each sample. Encoder and controller are those of the nominal drive, since
they are bought once.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.parts import BeltDrive
from drivesizer.catalog.tables import Table
from drivesizer.catalog.tolerances import Class
from drivesizer.catalog.view.mounted import OWN, STEPPER, has_steppers
from drivesizer.physics import thermal
from drivesizer.physics.at_voltage import Winding, operating_point
from drivesizer.physics.drive_train import back_emf_constant, friction, gear_loss
from drivesizer.physics.figures import Figures
from drivesizer.physics.motor_demand import Demands, demands
from drivesizer.physics.power_stage import with_stage_losses
from drivesizer.physics.stepper import amplitude, copper_loss, idle_loss
from drivesizer.physics.winding import Heat, Parts, Stress, heat, housing_loss, stress
from drivesizer.results.check_columns import CheckColumn, fits, worst_case
from drivesizer.results.drive_set import DriveParts
from drivesizer.search.columns import limits, steppers
from drivesizer.search.columns.brakes import brake_limits, is_listed
from drivesizer.search.columns.candidates import Rows
from drivesizer.search.columns.limits_over_time import Pair, exact, least, waveform_limits
from drivesizer.search.columns.offers import unknown_where_doubtful
from drivesizer.search.columns.shaft_limits import loads_on_gearheads, loads_on_motors
from drivesizer.search.columns.stages import felt
from drivesizer.search.columns.steppers import Draw, Frictionless, PullOut
from drivesizer.search.uncertainty.sampled_battery import AtSamples, Feeding, battery_limits
from drivesizer.search.uncertainty.uncertain_figures import holding
from drivesizer.spec.mounting import controller_needed, loss_at_flange
from drivesizer.spec.robot import RobotSpec

Array = NDArray[np.float64]
Made = TypeVar("Made")
_WHOLE = ("ratio", "inertia", "no_load_current", "friction_torque", "viscous_friction")  # never as a single figure
_MOST_MADE = 64  # parts, and limits of parts, that a block holds: some MB at most each
_ERROR = 1e-2  # of what a change within a segment does to the winding; the search has 0.1 %


class SetRows(NamedTuple):
    """The parts of a drive, as rows of the catalogue's tables; -1 where there is none."""

    motor: int
    gearhead: int
    encoder: int
    controller: int
    belt: float
    brake: int = -1


class Block(NamedTuple):
    """Some of the samples, ready for any drive: a load case each."""

    size: int
    specs: tuple[Any, ...]  # with columns
    ats: tuple[Mapping[float, AtSamples], ...]  # by belt ratio
    feeds: tuple[tuple[Feeding, tuple[int, ...]], ...]  # batteries, each with the cases that draw from it
    factors: Mapping[Class, Array]  # of the catalogue's figures
    given: Mapping[tuple[str, str], str]  # the spec's own classes, before any other
    belts: Mapping[float, BeltDrive | None]  # by ratio, where they are out of the catalogues
    made: dict[tuple[Any, ...], Any]  # of parts that were looked at: many drives have the same

    def factors_of(self, catalog: Catalog, part: str, row: int) -> dict[str, Array]:
        """Factors of the figures of a part that are sampled, by figure."""
        own = self.once(lambda: holding(catalog, self.given, part, row), "classes", part, row)
        return {one.figure: self.factors[one] for one in own if one in self.factors}

    def once(self, make: Callable[[], Made], *name: Any) -> Made:
        """A figure made of some parts, the first time that its name is used; of the last ones it stays."""
        if name not in self.made:
            if len(self.made) >= _MOST_MADE:
                self.made.clear()
            self.made[name] = make()
        found: Made = self.made[name]
        return found


# -- Figures of parts times the factors of their tolerances, of samples as of one drive.


def motor_times(motor: Figures, factors: Mapping[str, Any]) -> dict[str, Any]:
    """Figures of a motor times the factors of their classes; heat capacities are not sampled.

    Torque and voltage constant have one factor: both deviate with the magnets' flux. Their difference, by saturation
    and losses, belongs to the type and is no tolerance of the single motor.
    """
    rubs, cooling, k = (factors.get(name, 1.0) for name in ("friction", "thermal_resistance", "torque_constant"))
    times = {
        "resistance": factors.get("resistance", 1.0), "torque_constant": k,
        "rotor_inertia": factors.get("rotor_inertia", 1.0),
        "no_load_current": rubs / k, "friction_torque": rubs, "viscous_friction": rubs,
        "thermal_resistance_winding": cooling, "thermal_resistance_housing": cooling,
        "winding_time_constant": cooling, "motor_time_constant": cooling,
    }  # fmt: skip
    found = {name: motor[name] * factor for name, factor in times.items()}
    return found | {"back_emf_constant": back_emf_constant(motor) * k} | with_dry_share(motor, factors)


def with_dry_share(motor: Figures, factors: Mapping[str, Any]) -> dict[str, Any]:
    """Friction of a motor whose dry share is sampled: at any speed, and per speed; nothing where it is not."""
    if "dry_friction" not in factors:
        return {}
    coulomb, viscous = friction(motor, factors["dry_friction"])
    factor = factors.get("friction", 1.0)
    return {"friction_torque": coulomb * factor, "viscous_friction": viscous * factor}


def stepper_times(motor: Figures, factors: Mapping[str, Any]) -> dict[str, Any]:
    """Figures of a stepper times their factors, with the current that its driver really gives."""
    current = factors.get("phase_current", 1.0)
    times = {name: factors.get(name, 1.0) for name in ("resistance", "inductance", "rotor_inertia", "start_speed")}
    times |= {"nominal_current": current, "holding_torque": factors.get("holding_torque", 1.0) * current}
    return {name: motor[name] * factor for name, factor in times.items()}


def gearhead_times(gearhead: Figures, factors: Mapping[str, Any]) -> dict[str, Any]:
    """Figures of a gearhead times their factors: that of its losses is of losses per transmitted torque, 1/e - 1."""
    found = {}
    if (losses := factors.get("efficiency")) is not None:
        found["efficiency"] = 1.0 / (1.0 + (1.0 / gearhead["efficiency"] - 1.0) * losses)
        found["no_load_torque"] = gearhead["no_load_torque"] * losses
    if "inertia" in factors:
        found["inertia"] = gearhead["inertia"] * factors["inertia"]
    return found


def _sampled(table: Table[Any], row: int, count: int, changed: Mapping[str, Array] | None = None) -> Rows:
    """Figures of a part over samples: a column where it is sampled, else a single one."""
    part = Rows(table, np.array([row]))
    part.taken |= {name: np.repeat(part[name], count) for name in _WHOLE if name in table.columns} | {**(changed or {})}
    return part


class _Drive(NamedTuple):
    """A drive over samples."""

    parts: Parts
    printed: Rows  # its motor as the catalogue has it
    factors: Mapping[str, Array]  # of its motor's figures; of a stepper its driver's as well
    pull_out: PullOut | None  # of a stepper
    highest: Array  # V, that the maker of a stepper permits; NaN none
    listed: NDArray[np.bool_]  # its brake goes with its motor


def _drive(catalog: Catalog, one: SetRows, block: Block) -> _Drive:
    """A drive with the figures of its parts, each times its factor."""
    size, steps, spec = block.size, has_steppers(catalog), block.specs[0]
    printed, factors = _sampled(catalog.motors, one.motor, size), block.factors_of(catalog, "motor", one.motor)
    if steps:
        factors |= block.factors_of(catalog, "controller", one.controller)

    def motor() -> Rows:
        if steps:
            own = {**stepper_times(printed, factors), STEPPER: np.repeat(printed[STEPPER], size)}
            return _sampled(catalog.motors, one.motor, size, own)
        changed = motor_times(printed, factors)
        rated = catalog.estimate_of("motors", one.motor, "max_winding_temperature") is not None  # by nominal current
        if rated and printed["kind"][0] != "brushed":
            changed["max_winding_temperature"] = np.ones(size) * thermal.steady_winding_temperature(
                thermal.rated_ambient(printed), thermal.resistance_25(printed), changed["thermal_resistance_winding"],
                changed["thermal_resistance_housing"], printed["nominal_current"],
            )  # fmt: skip
        return _sampled(catalog.motors, one.motor, size, changed)

    def gearhead() -> Rows:
        bought = _sampled(catalog.gearheads, one.gearhead, size)
        times = block.factors_of(catalog, "gearhead", one.gearhead)
        changed = gearhead_times(bought, times)
        if "peak_torque" in times:
            changed["intermittent_torque"] = bought["intermittent_torque"] * times["peak_torque"]
        return _sampled(catalog.gearheads, one.gearhead, size, changed)

    def controller() -> Rows:
        bought = _sampled(catalog.controllers, one.controller, size)
        if (factor := block.factors_of(catalog, "controller", one.controller).get("losses")) is not None:
            bought.taken |= with_stage_losses(bought, factor, assume=spec.select.estimates == "on")
        return bought

    brake, own = None, dict[str, Array]()
    if spec.wants_brake:  # one that is the spec's own has its tolerances
        if spec.brake is not None and one.brake >= 0 and catalog.brakes["family"][one.brake] == OWN:
            own = {name: x for name, x in spec.brake.figures.items() if np.ndim(x)}
        brake = _sampled(catalog.brakes, one.brake, size, own)
    parts = Parts(
        motor() if steps else block.once(motor, "motor", one.motor),
        block.once(gearhead, "gearhead", one.gearhead),
        block.once(lambda: _sampled(catalog.encoders, one.encoder, size), "encoder", one.encoder),
        block.once(controller, "controller", one.controller),
        brake,
    )
    pull_out = PullOut(parts.motor, catalog.pull_outs, factors.get("pull_out", 1.0)) if steps else None
    highest = catalog.steppers["supply_max"][catalog.motors[STEPPER][[one.motor]]] if steps else np.full(1, np.nan)
    listed = np.array([is_listed(catalog, one.motor, one.brake)])
    return _Drive(parts, printed, factors, pull_out, highest, listed)


def deviating_drive(one: DriveParts, spec: RobotSpec, factors: Mapping[str, Mapping[str, float]]) -> DriveParts:
    """A drive whose figures deviate from those of the catalogue, by part and figure; by 1 where a factor is missing."""

    def varied(part: Any, figures: Mapping[str, Any]) -> Any:
        return replace(part, **{name: float(x) for name, x in figures.items()})

    of_motor, controller = factors["motor"], one.controller
    times = stepper_times(one.motor, {**of_motor, **factors["controller"]}) if one.steps else motor_times(
        one.motor, of_motor
    )  # fmt: skip
    if controller and "losses" in factors["controller"]:
        assume = spec.select.estimates == "on"
        controller = varied(controller, with_stage_losses(controller, factors["controller"]["losses"], assume=assume))
    return replace(
        one, motor=varied(one.motor, times), controller=controller, belt_efficiency=spec.belt_efficiency,
        gearhead=varied(one.gearhead, gearhead_times(one.gearhead, factors["gearhead"])),
    )  # fmt: skip


# -- Every check of a drive over samples.


def checks_of(catalog: Catalog, one: SetRows, block: Block) -> dict[str, CheckColumn]:
    """Every check that samples may change, by name: columns over the samples, the worst of all load cases."""
    found = _drive(catalog, one, block)
    motor, gearhead = found.parts.motor, found.parts.gearhead
    by_name: dict[str, list[tuple[int, CheckColumn]]] = {}
    draws = []

    def geared(spec: Any, at: AtSamples, drive: BeltDrive | None) -> list[CheckColumn]:
        return limits.gearhead_limits(spec, at, gearhead) + loads_on_gearheads(spec, at, drive, gearhead)

    for number, (spec, ats) in enumerate(zip(block.specs, block.ats, strict=True)):
        at, drive = ats[one.belt], block.belts[one.belt]
        of_case = _servo_checks if found.pull_out is None else _stepper_checks
        checks, draw = of_case(spec, at, found, bool(block.feeds))
        if one.controller >= 0 or found.pull_out is None:
            checks.append(_controller_fits(spec, found.parts.controller, one))
        checks += block.once(partial(limits.load_limits, spec, at, drive), "load limits", number, one.belt)
        names = "gearhead limits", number, one.gearhead, one.belt
        checks += block.once(partial(geared, spec, at, drive), *names)
        if spec.shaft:
            checks += loads_on_motors(spec, at, drive, motor, gearhead)
        draws.append(draw)
        for check in checks:
            by_name.setdefault(check.name, []).append((number, check))
    for feeds, numbers in block.feeds:
        first, drawn = numbers[0], [draws[number] for number in numbers]
        for check in battery_limits(block.specs[first], feeds, block.ats[first][one.belt], drawn):
            by_name.setdefault(check.name, []).append((first, check))
    return {name: worst_case(same) for name, same in by_name.items()}


def _controller_fits(spec: Any, controller: Any, one: SetRows) -> CheckColumn:
    """Whether the chosen controller permits the supply's voltages."""
    lowest, highest = np.asarray(spec.supply.lowest), np.asarray(spec.supply.highest)
    good = (controller["supply_min"] <= lowest) & (controller["supply_max"] >= highest) & (one.controller >= 0)
    known = one.controller < 0 or ~np.isnan(controller["supply_min"] + controller["supply_max"])
    return fits("controller_available", good, known)


class _Loaded(NamedTuple):
    """A drive over the samples of one load case."""

    required: Demands
    warmth: Heat
    peaks: Stress
    over_time: Pair  # bounds of what needs the waveform


def _loaded(spec: Any, at: AtSamples, drive: _Drive, *, energies: bool) -> _Loaded:
    """Demands, heat and waveform of a drive in one load case."""
    parts, ambient = drive.parts, spec.environment.ambient
    required = demands(at, parts.motor, parts.gearhead, parts.encoder, felt(at, parts))
    brushed = drive.printed["kind"][0] == "brushed"
    motor, factor = parts.motor, 1.0 if brushed else drive.factors.get("friction", 1.0)
    if not brushed:  # in the iron by the printed figures, times the factor of friction
        shared = {name: x for name, x in drive.factors.items() if name == "dry_friction"}
        motor = _sampled(drive.printed.table, int(drive.printed.rows[0]), 1, with_dry_share(drive.printed, shared))
    rubbing, iron = housing_loss(motor, required.total_ratio)
    losses = rubbing * factor, iron * factor
    warmth = heat(ambient, at, required, parts.motor, losses, loss_at_flange(spec, at, parts.gearhead))
    leads = spec.feed(parts.controller, parts.brake).leads if spec.resists else 0.0
    peaks = stress(ambient, at, required, parts.motor, leads)
    figures = exact(spec, at, required, warmth, peaks, parts, "all" if energies else "limits", error=_ERROR)
    return _Loaded(required, warmth, peaks, least(figures, required, warmth, peaks))


def _servo_checks(spec: Any, at: AtSamples, drive: _Drive, energies: bool) -> tuple[list[CheckColumn], Draw]:
    """The checks of one load case that hang on a motor with a controller, and the energy that its drives draw."""
    parts, (required, warmth, peaks, over_time) = drive.parts, _loaded(spec, at, drive, energies=energies)
    found = [c for c in limits.moving_limits(spec, at, required, warmth, parts) if c.name != "winding_temperature"]
    if parts.brake is not None:  # friction that holds is printed
        found += brake_limits(spec, at, parts._replace(motor=drive.printed), required, drive.listed)
    found += limits.electrical_limits(spec, at, required, peaks, parts) + waveform_limits(spec, *over_time, parts)
    sets = spec.load.alike if required.complete.all() else np.nan  # lower bounds are not energies
    draw = over_time[0].agreed(over_time[1])
    checks = [*limits.motor_limits(spec, parts.motor), *unknown_where_doubtful(found, required.complete)]
    return checks, Draw(draw.drawn * sets, draw.returned * sets, draw.power * sets)


def _stepper_checks(spec: Any, at: AtSamples, drive: _Drive, _: bool) -> tuple[list[CheckColumn], Draw]:
    """The same of a stepper."""
    parts = drive.parts
    assert drive.pull_out is not None
    required = demands(at, Frictionless(parts.motor), parts.gearhead, parts.encoder, felt(at, parts))
    found = steppers.torque_limits(spec, at, required, parts, drive.pull_out)
    found += limits.inertia_limits(spec, at, required, parts)
    if parts.brake is not None:
        found += brake_limits(spec, at, parts, required, drive.listed)
    draw, rated = steppers.drawn(spec, at, required, parts), drive.printed["nominal_current"]
    needed, ambient = controller_needed(spec, 0.0), spec.environment.ambient
    return [
        *unknown_where_doubtful(found, required.complete),
        *steppers.driver_limits(rated, parts.controller, needed, ambient),  # of what the driver is set to
        *limits.motor_limits(spec, parts.motor),
        *steppers.supply_limits(spec, draw, parts, drive.highest),
    ], Draw(*(x * spec.load.alike for x in draw))


# -- Figures of a drive over the same samples, in each sample of its worst load case.


_LEAST = ("free_speed", "stall_torque", "pull_out_at_rest", "pull_out_at_speed")  # the worst load case has the smallest


def figure_columns(catalog: Catalog, one: SetRows, block: Block) -> dict[str, Array]:
    """Figures of a drive, sample by sample: current, voltage, power, heat, temperature, free speed, stall torque."""
    drive, found = _drive(catalog, one, block), dict[str, Array]()
    for spec, ats in zip(block.specs, block.ats, strict=True):
        of_case = _servo_figures if drive.pull_out is None else _stepper_figures
        for name, column in of_case(spec, ats[one.belt], drive).items():
            values = np.array(np.broadcast_to(column, block.size))
            worse = np.minimum if name in _LEAST else np.maximum
            found[name] = worse(found[name], values) if name in found else values
    return found


@np.errstate(divide="ignore", invalid="ignore")
def _servo_figures(spec: Any, at: AtSamples, drive: _Drive) -> dict[str, Any]:
    """Figures that the load cycle makes, unknown where only a least demand is known; and those at the supply alone."""
    case = _loaded(spec, at, drive, energies=True)
    known, over_time = case.required.complete, case.over_time[0].agreed(case.over_time[1])
    figures = {
        "rms_current": case.required.rms_current, "peak_current": case.peaks.current.value,
        "voltage": over_time.voltage, "power": over_time.power * spec.load.motors,
        "joule_heat": np.where(np.isnan(over_time.winding), np.nan, over_time.copper),  # bounds of it are not kept
        "winding_temperature": over_time.winding,
    }  # fmt: skip
    found = {name: np.where(known, column, np.nan) for name, column in figures.items()}
    motor, gearhead = drive.parts.motor, drive.parts.gearhead
    feed = spec.feed(drive.parts.controller, drive.parts.brake)._replace(voltage=spec.supply.nominal)
    cold = thermal.resistance_at(thermal.resistance_25(motor), spec.environment.ambient)  # winding at the ambient
    cold = cold + (feed.leads if spec.resists else 0.0)
    k_t, (dry, viscous), (efficiency, idle) = motor["torque_constant"], friction(motor), gear_loss(gearhead)
    speed, _ = operating_point(Winding(cold, np.nan, k_t, motor["back_emf_constant"]), feed.usable, dry + idle, viscous)
    stalled = np.fmin(feed.usable / cold, drive.parts.controller["peak_current"])
    ratio = gearhead["ratio"] * at.belt
    held = np.maximum(k_t * stalled - dry - idle, 0.0) * ratio * efficiency * spec.belt_efficiency
    found["free_speed"] = np.maximum(speed, 0.0) / ratio
    found["stall_torque"] = np.where(np.isnan(feed.usable), np.nan, held)
    return found


def _stepper_figures(spec: Any, at: AtSamples, drive: _Drive) -> dict[str, Any]:
    """Figures of a stepper in one load case."""
    parts, pull_out = drive.parts, drive.pull_out
    assert pull_out is not None
    required = demands(at, Frictionless(parts.motor), parts.gearhead, parts.encoder, felt(at, parts))
    torque, speed = (np.abs(x).max(axis=(1, 2)) for x in steppers.ends_of(at, required))
    at_rest, at_speed = (
        pull_out.torque(w[:, None], spec.supply.lowest)[:, 0] for w in (np.zeros_like(speed), speed)
    )  # fmt: skip
    duration = np.atleast_2d(at.load_cycle.duration.T)
    heated = (idle_loss(at.speeds, spec.control.idle_current).T * duration).sum(axis=1) / duration.sum(axis=1)
    return {
        "motor_torque": np.where(required.complete, torque, np.nan),
        "pull_out_at_rest": at_rest, "pull_out_at_speed": at_speed,
        "power": steppers.drawn(spec, at, required, parts).peak * spec.load.motors,
        "joule_heat": copper_loss(parts.motor["nominal_current"], parts.motor["resistance"]) * heated,
        "peak_current": amplitude(parts.motor["nominal_current"]),
    }  # fmt: skip
