"""Parts of one drive over samples, a stepper or another: figures of the catalogue times their factors."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.parts import BeltDrive, PullOuts
from drivesizer.catalog.tables import Table
from drivesizer.catalog.tolerances import Class
from drivesizer.catalog.view.mounted import OWN, STEPPER, has_steppers
from drivesizer.machine.part_curves import available_torque
from drivesizer.physics.cycle_at_gearhead import ACCELERATION
from drivesizer.physics.drive_train import back_emf_constant, friction
from drivesizer.physics.motor_demand import Demands, demands
from drivesizer.physics.power_stage import with_stage_losses
from drivesizer.physics.stepper import amplitude, copper_loss, electrical_energy, idle_loss
from drivesizer.physics.thermal import rated_ambient, resistance_25, steady_winding_temperature
from drivesizer.physics.winding import Parts
from drivesizer.results.check_columns import CheckColumn, at_most
from drivesizer.results.drive_set import DriveParts
from drivesizer.search.columns.brakes import brake_limits
from drivesizer.search.columns.limits import motor_limits, unpowered_limits
from drivesizer.search.columns.offers import unknown_where_doubtful
from drivesizer.search.columns.stages import felt
from drivesizer.search.columns.steppers import (
    LEVELS,
    Frictionless,
    driver_limits,
    resolution_limits,
    start_limits,
    supply_limits,
)
from drivesizer.search.uncertainty.sampled_battery import AtSamples, Draw, Feeding
from drivesizer.search.uncertainty.uncertain_figures import holding
from drivesizer.spec.mounting import controller_needed
from drivesizer.spec.robot import RobotSpec

__all__ = [
    "Block", "PartFigures", "SampledStepper", "SetRows", "deviating_drive", "motor_factors", "parts_of",
    "stepper_checks", "stepper_figures", "with_dry_share", "with_losses",
]  # fmt: skip


# -- Figures of one part over samples: a column where it is sampled, else a single one.


Array = NDArray[np.float64]
WHOLE = ("ratio", "inertia", "no_load_current", "friction_torque", "viscous_friction")  # never as a single figure


class PartFigures:
    """The figures of a part over samples: a column where it is sampled, else a single one."""

    def __init__(self, table: Table[Any], row: int, count: int, changed: Mapping[str, NDArray[Any]]) -> None:
        self.table, self.row, self.count = table, row, count
        self.taken: dict[str, NDArray[Any]] = dict(changed)

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self.taken:
            self.taken[name] = self.nominal(name, self.count if name in WHOLE else 1)
        return self.taken[name]

    def nominal(self, name: str, count: int = 1) -> NDArray[Any]:
        """Figure as the catalogue prints it."""
        column: NDArray[Any] = self.table[name]
        if self.row < 0:
            return np.full(count, np.nan if column.dtype.kind == "f" else "")
        return np.full(count, column[self.row])


# -- One stepper against its limits, sample by sample: pull-out torque, start, steps, and what it draws.
#
# The search looks at points of one load cycle that no other exceeds in torque and speed; here each sample has a
# cycle of its own. The pull-out torque falls with the speed, so the ends of a segment decide where its larger torque
# is at the faster one. Between the ends of the others, the same levels of speed are looked at as in the search.


_LEVEL = 1e-9  # of the largest acceleration of a cycle, up to which its speed is constant: fits are not exact
_TORQUE = ("pull_out_share", "holding_torque", "nominal_current", "resistance", "inductance", "pole_pairs", STEPPER)


class SampledStepper(NamedTuple):
    """A drive with a stepper: its parts over samples, and what they do not say."""

    parts: Parts
    factor: Any  # of the pull-out torque
    curves: PullOuts  # printed
    highest: float  # V, that the motor's maker permits; NaN none
    listed: bool  # its brake goes with it


def stepper_motor(catalog: Catalog, row: int, count: int, factors: Mapping[str, Any]) -> PartFigures:
    """A stepper's figures, each times its factor, with the current that its driver really gives."""
    printed = PartFigures(catalog.motors, row, count, {}).nominal
    current = factors.get("phase_current", 1.0)
    times = {name: factors.get(name, 1.0) for name in ("resistance", "inductance", "rotor_inertia", "start_speed")}
    times |= {"nominal_current": current, "holding_torque": factors.get("holding_torque", 1.0) * current}
    changed = {name: printed(name) * factor for name, factor in times.items() if np.ndim(factor)}
    return PartFigures(catalog.motors, row, count, {**changed, STEPPER: printed(STEPPER, count)})


def stepper_checks(spec: Any, at: AtSamples, one: SampledStepper) -> tuple[list[CheckColumn], Draw]:
    """The checks of one load case, and the energy that its drives draw."""
    parts, required = one.parts, _required(at, one.parts)
    found = [_pull_out(spec, at, required, one), *_start(spec, at, required, one)]
    found += resolution_limits(spec, at, required, parts)
    found += unpowered_limits(spec, at, required, None, parts)  # type: ignore[arg-type]  # of a stepper no heat is known
    if parts.brake is not None:
        found += brake_limits(spec, at, parts, required, np.array([one.listed]))
    draw, ambient = _drawn(spec, at, required, parts), spec.environment.ambient
    rated = parts.motor.nominal("nominal_current")  # a driver's limits are of what it is set to
    return [
        *unknown_where_doubtful(found, required.complete),
        *driver_limits(rated, parts.controller, controller_needed(spec, 0.0), ambient),
        *motor_limits(spec, parts.motor),
        *supply_limits(spec, draw.returned, draw.peak, parts, np.array([one.highest])),
    ], Draw(*(x * spec.load.alike for x in draw))


def _required(at: AtSamples, parts: Parts) -> Demands:
    return demands(at, Frictionless(parts.motor), parts.gearhead, parts.encoder, felt(at, parts))


# --- torque ----------------------------------------------------------------------------------------------------------


class _Ends(NamedTuple):
    """A load cycle at the motor's shaft, at both ends of each segment: (segments, 2, samples)."""

    torque: Array  # N*m, signed
    speed: Array  # rad/s, unsigned
    limit: Array  # N*m
    time: Array  # s


class _Worst(NamedTuple):
    """The worst moment of each sample."""

    share: Array
    torque: Array
    limit: Array
    time: Array


def _available(one: SampledStepper, rows: Any, speed: Array, voltage: Any) -> Array:
    """Pull-out torque at speeds of some samples, shape (rows, points) [N*m]."""
    count = one.parts.motor.count
    motor = {name: np.broadcast_to(one.parts.motor[name], count)[rows] for name in _TORQUE}
    factor = np.broadcast_to(one.factor, count)[rows]
    volts = voltage if np.ndim(voltage) == 0 else np.broadcast_to(voltage, count)[rows]
    found: Array = available_torque(motor, one.curves, speed, volts) * factor[:, None]
    return found


def _pull_out(spec: Any, at: AtSamples, required: Demands, one: SampledStepper) -> CheckColumn:
    """The torque against the pull-out torque at its speed, at each sample's worst moment."""
    ends = _at_ends(spec, at, required, one)
    worst = _worst_end(ends, spec.margins.pull_out)
    segment, row = _open(ends, worst.share)
    if len(row):
        between = _between(spec, ends, segment, row, one)
        worst = _Worst(*_worse(worst, between, row, 1.0 / spec.margins.pull_out))
    return at_most("pull_out_torque", worst.torque, worst.limit, needed=spec.margins.pull_out - 1.0, time=worst.time)


def _at_ends(spec: Any, at: AtSamples, required: Demands, one: SampledStepper) -> _Ends:
    torque = at.line(required.coefficients)
    speed = np.abs(np.broadcast_to(at.speeds, torque.shape)) * required.total_ratio
    count = torque.shape[-1]
    limit = _available(one, slice(None), speed.reshape(-1, count).T, spec.supply.lowest).T.reshape(torque.shape)
    return _Ends(torque, speed, limit, np.broadcast_to(at.base.time, torque.shape))


def _shares(torque: Array, limit: Array) -> Array:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(torque == 0.0, 0.0, np.abs(torque) / limit)


def _worst_end(ends: _Ends, factor: float) -> _Worst:
    """The largest share at the ends of segments; an unknown one where none fails."""
    torque, limit, time = (x.reshape(-1, x.shape[-1]) for x in (np.abs(ends.torque), ends.limit, ends.time))
    share = _shares(torque, limit)
    unknown = np.isnan(share)
    known = np.where(unknown, -1.0, share)
    place = known.argmax(axis=0)
    fails = known.max(axis=0) * factor > 1.0
    place = np.where(unknown.any(axis=0) & ~fails, unknown.argmax(axis=0), place)[None]
    taken = (np.take_along_axis(x, place, axis=0)[0] for x in (share, torque, limit, time))
    return _Worst(*taken)


def _open(ends: _Ends, share: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Segments and samples in which a moment within may be worse than the worst end."""
    torque, speed = np.abs(ends.torque), ends.speed
    slower = ((torque[:, 0] > torque[:, 1]) & (speed[:, 0] < speed[:, 1])) | (
        (torque[:, 1] > torque[:, 0]) & (speed[:, 1] < speed[:, 0])
    )
    least = np.where(speed[:, 0] > speed[:, 1], ends.limit[:, 0], ends.limit[:, 1])
    bound = _shares(torque.max(axis=1), least)
    segment, row = np.nonzero(slower & ~(bound <= share))
    return segment, row


def _between(spec: Any, ends: _Ends, segment: NDArray[np.int64], row: NDArray[np.int64], one: SampledStepper) -> _Worst:
    """The largest known share within segments, where their speeds pass a level; a row each."""
    (T0, T1), (w0, w1), (t0, t1) = (np.moveaxis(x[segment, :, row], 1, 0)[:, :, None] for x in
                                    (ends.torque, ends.speed, ends.time))  # fmt: skip
    top = ends.speed.max(axis=(0, 1))[row]
    level = top[:, None] * (np.arange(1, LEVELS) / LEVELS)
    inside = (w0 - level) * (w1 - level) < 0.0
    along = np.where(inside, (level - w0) / (w1 - w0), 0.0)
    torque, time = np.abs(T0 + along * (T1 - T0)), t0 + along * (t1 - t0)
    limit = _available(one, row, np.where(inside, level, w0), spec.supply.lowest)
    share = np.where(inside, np.nan_to_num(_shares(torque, limit), nan=-1.0, posinf=np.inf), -1.0)
    place = share.argmax(axis=1)[:, None]
    return _Worst(*(np.take_along_axis(x, place, axis=1)[:, 0] for x in (share, torque, limit, time)))


def _worse(worst: _Worst, between: _Worst, row: NDArray[np.int64], permitted: float) -> tuple[Array, ...]:
    """The worst moments, in their place what is worse within segments; in place of an unknown one what fails."""
    order = np.argsort(between.share, kind="stable")  # the last one of a sample stays
    order = order[between.share[order] > np.nan_to_num(worst.share[row[order]], nan=permitted)]
    found = tuple(x.copy() for x in worst)
    for column, values in zip(found, between, strict=True):
        column[row[order]] = values[order]
    return found


# --- starting and supply ---------------------------------------------------------------------------------------------


def _start(spec: Any, at: AtSamples, required: Demands, one: SampledStepper) -> list[CheckColumn]:
    """The start without a ramp against the largest torque at constant speed."""
    if spec.needs.start_speed is None:
        return []
    torque, changes = np.abs(at.line(required.coefficients)), np.abs(at.base.functions[ACCELERATION])
    steady = np.broadcast_to(changes <= _LEVEL * changes.max(axis=(0, 1)), torque.shape)
    at_constant = np.where(steady, torque, -1.0).max(axis=(0, 1))
    load = np.where(at_constant < 0.0, torque.max(axis=(0, 1)), at_constant)
    at_rest = _available(one, slice(None), np.zeros((len(load), 1)), spec.supply.lowest)[:, 0]
    return start_limits(spec, at, required, one.parts, (load, at_rest))


def _drawn(spec: Any, at: AtSamples, required: Demands, parts: Parts) -> Draw:
    """Energy and power out of the supply, with the standby power of the driver: of one drive."""
    torque = np.moveaxis(at.line(required.coefficients), -1, 0)
    speed = np.moveaxis(np.broadcast_to(at.speeds, torque.shape[1:] + torque.shape[:1]), -1, 0)
    loss = copper_loss(parts.motor["nominal_current"], parts.motor["resistance"])
    loss = (
        np.broadcast_to(loss, len(torque))[:, None] * idle_loss(np.moveaxis(speed, 0, 2), spec.control.idle_current).T
    )
    total = loss + np.broadcast_to(spec.feed(parts.controller).stage.standby, len(torque))[:, None]
    turning = speed * np.broadcast_to(required.total_ratio, len(torque))[:, None, None]
    drawn, returned, most, _ = electrical_energy(at.load_cycle.duration.T, torque, turning, total)
    return Draw(*(np.where(required.complete, x, np.nan) for x in (drawn, returned, np.maximum(most, 0.0))))


def _heated(spec: Any, at: AtSamples) -> Array:
    """Share of the copper loss in motion that the mean over the cycle is."""
    duration, share = np.atleast_2d(at.load_cycle.duration.T), idle_loss(at.speeds, spec.control.idle_current)
    found: Array = (share.T * duration).sum(axis=1) / duration.sum(axis=1)
    return found


def stepper_figures(spec: Any, at: AtSamples, one: SampledStepper) -> dict[str, Array]:
    """Figures of a stepper in one load case."""
    parts, required = one.parts, _required(at, one.parts)
    torque = np.abs(at.line(required.coefficients)).max(axis=(0, 1))
    fastest = (np.abs(at.speeds).max(axis=(0, 1)) * required.total_ratio)[:, None]
    at_rest, at_speed = (
        _available(one, slice(None), w, spec.supply.lowest)[:, 0] for w in (np.zeros_like(fastest), fastest)
    )
    return {
        "motor_torque": np.where(required.complete, torque, np.nan),
        "pull_out_at_rest": at_rest, "pull_out_at_speed": at_speed,
        "power": _drawn(spec, at, required, parts).peak * spec.load.motors,
        "joule_heat": copper_loss(parts.motor["nominal_current"], parts.motor["resistance"]) * _heated(spec, at),
        "peak_current": amplitude(parts.motor["nominal_current"]),
    }  # fmt: skip


# -- Parts of one drive over samples: figures of the catalogue times their factors, and what a block of samples holds.
#
# Encoder and controller are those of the nominal drive, since they are bought once.


Held = TypeVar("Held")
_HELD = 64  # parts, and limits of parts, that a block holds: some MB at most each


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
    held: dict[tuple[Any, ...], Any]  # of parts that were looked at: many drives have the same

    def factors_of(self, catalog: Catalog, part: str, row: int) -> dict[str, Array]:
        """Factors of the figures of a part that are sampled, by figure."""
        held = self.once(lambda: holding(catalog, self.given, part, row), "classes", part, row)
        return {one.figure: self.factors[one] for one in held if one in self.factors}

    def once(self, make: Callable[[], Held], *name: Any) -> Held:
        """A figure made of some parts, the first time that its name is used; of the last ones it is held."""
        if name not in self.held:
            if len(self.held) >= _HELD:
                self.held.clear()
            self.held[name] = make()
        found: Held = self.held[name]
        return found


def motor_factors(given: Mapping[str, Any]) -> dict[str, Any]:
    """Factors of a motor's figures; heat capacities are not sampled.

    Torque and voltage constant have one factor: both deviate with the magnets' flux. Their difference, by saturation
    and losses, belongs to the type and is no tolerance of the single motor.
    """
    friction, cooling, k = (given.get(name, 1.0) for name in ("friction", "thermal_resistance", "torque_constant"))
    return {
        "resistance": given.get("resistance", 1.0), "torque_constant": k, "back_emf_constant": k,
        "rotor_inertia": given.get("rotor_inertia", 1.0),
        "no_load_current": friction / k, "friction_torque": friction, "viscous_friction": friction,
        "thermal_resistance_winding": cooling, "thermal_resistance_housing": cooling,
        "winding_time_constant": cooling, "motor_time_constant": cooling,
    }  # fmt: skip


def with_dry_share(motor: Any, factors: Mapping[str, Any]) -> dict[str, Any]:
    """Friction of a motor whose dry share is sampled: at any speed, and per speed; nothing where it is not."""
    if "dry_friction" not in factors:
        return {}
    coulomb, viscous = friction(motor, factors["dry_friction"])
    factor = factors.get("friction", 1.0)
    return {"friction_torque": coulomb * factor, "viscous_friction": viscous * factor}


def with_losses(efficiency: Any, factor: Any) -> Any:
    """Efficiency with losses per transmitted torque, 1/e - 1, times a factor; it stays within 0 to 1."""
    return 1.0 / (1.0 + (1.0 / efficiency - 1.0) * factor)


def _motor(catalog: Catalog, row: int, block: Block, factors: Mapping[str, Array]) -> PartFigures:
    """A motor's figures, each times its factor."""
    times = motor_factors(factors)
    bought, whole = PartFigures(catalog.motors, row, block.size, {}), np.ones(block.size)
    printed = bought.nominal
    changed = {
        name: printed(name) * factor * (whole if name in WHOLE else 1.0)
        for name, factor in times.items()
        if np.ndim(factor) or name in WHOLE
    }
    changed["back_emf_constant"] = back_emf_constant(bought) * times["back_emf_constant"]
    changed |= {name: x * whole for name, x in with_dry_share(bought, factors).items()}
    rated = catalog.estimate_of("motors", row, "max_winding_temperature") is not None  # by its nominal current
    if rated and catalog.motors["kind"][row] != "brushed":
        one, other = (changed.get(f"thermal_resistance_{name}", printed(f"thermal_resistance_{name}"))
                      for name in ("winding", "housing"))  # fmt: skip
        changed["max_winding_temperature"] = whole * steady_winding_temperature(
            rated_ambient(bought), resistance_25(bought), one, other, bought["nominal_current"]
        )
    return PartFigures(catalog.motors, row, block.size, changed)


def _gearhead(catalog: Catalog, row: int, block: Block) -> PartFigures:
    """A gearhead's figures, each times its factor."""
    printed = PartFigures(catalog.gearheads, row, block.size, {}).nominal
    changed, factors = {}, block.factors_of(catalog, "gearhead", row)
    if (losses := factors.get("efficiency")) is not None:
        changed["efficiency"] = with_losses(printed("efficiency"), losses)
        changed["no_load_torque"] = printed("no_load_torque") * losses
    for figure, name in (("peak_torque", "intermittent_torque"), ("inertia", "inertia")):
        if figure in factors:
            changed[name] = printed(name) * factors[figure]
    return PartFigures(catalog.gearheads, row, block.size, changed)


def _controller(catalog: Catalog, row: int, block: Block) -> PartFigures:
    """A controller's figures, its losses times their factor."""
    bought = PartFigures(catalog.controllers, row, block.size, {})
    factor = block.factors_of(catalog, "controller", row).get("losses")
    if factor is None:
        return bought
    changed = with_stage_losses(bought, factor, assume=block.specs[0].select.estimates == "on")
    return PartFigures(catalog.controllers, row, block.size, changed)


def _brake(catalog: Catalog, row: int, block: Block) -> PartFigures:
    """A brake's figures; of one that is the spec's own with its tolerances."""
    own, changed = block.specs[0].brake, dict[str, Array]()
    if own is not None and row >= 0 and catalog.brakes["family"][row] == OWN:
        changed = {name: x for name, x in own.figures.items() if np.ndim(x)}
    return PartFigures(catalog.brakes, row, block.size, changed)


def parts_of(catalog: Catalog, one: SetRows, block: Block) -> tuple[Parts, dict[str, Array]]:
    """The parts of a drive over samples, and the factors of its motor; of a stepper its driver's as well."""
    factors = block.factors_of(catalog, "motor", one.motor)
    if has_steppers(catalog):
        factors |= block.factors_of(catalog, "controller", one.controller)
        motor = stepper_motor(catalog, one.motor, block.size, factors)
    else:
        motor = block.once(lambda: _motor(catalog, one.motor, block, factors), "motor", one.motor)
    gearhead = block.once(lambda: _gearhead(catalog, one.gearhead, block), "gearhead", one.gearhead)
    encoder = block.once(lambda: PartFigures(catalog.encoders, one.encoder, block.size, {}), "encoder", one.encoder)
    controller = block.once(lambda: _controller(catalog, one.controller, block), "controller", one.controller)
    brake = _brake(catalog, one.brake, block) if block.specs[0].wants_brake else None
    return Parts(motor, gearhead, encoder, controller, brake), factors


# -- A drive with the figures of one sample.


Factors = Mapping[str, Mapping[str, float]]  # by part, then by figure; 1 where one is missing


def deviating_drive(one: DriveParts, spec: RobotSpec, factors: Factors) -> DriveParts:
    """A drive whose figures deviate from those of the catalogue."""
    of_gearhead = factors["gearhead"]
    losses, gains = (of_gearhead.get(name, 1.0) for name in ("efficiency", "inertia"))
    gearhead = replace(
        one.gearhead, **_times(one.gearhead, {"inertia": gains, "no_load_torque": losses}),
        efficiency=with_losses(one.gearhead.efficiency, losses),
    )  # fmt: skip
    motor = _stepper(one, factors) if one.steps else _motor_of_sample(one, factors["motor"])
    controller = _controller_of_sample(one, spec, factors["controller"])
    return replace(one, motor=motor, gearhead=gearhead, controller=controller, belt_efficiency=spec.belt_efficiency)


def _motor_of_sample(one: DriveParts, factors: Mapping[str, float]) -> Any:
    bought = replace(one.motor, back_emf_constant=float(back_emf_constant(one.motor)))
    varied = _times(bought, motor_factors(factors)) | with_dry_share(bought, factors)
    return replace(bought, **varied)


def _stepper(one: DriveParts, factors: Factors) -> Any:
    """A stepper with the current that its driver really gives."""
    times = {name: factors["motor"].get(name, 1.0) for name in ("resistance", "inductance", "rotor_inertia")}
    times["nominal_current"] = factors["controller"].get("phase_current", 1.0)
    return replace(one.motor, **_times(one.motor, times))


def _controller_of_sample(one: DriveParts, spec: RobotSpec, factors: Mapping[str, float]) -> Any:
    controller, more = one.controller, factors.get("losses")
    if not controller or not more:
        return controller
    stage = with_stage_losses(controller, more, assume=spec.select.estimates == "on")
    volts, efficiency = float(stage["voltage_drop"]), float(stage["max_efficiency"])
    return replace(controller, voltage_drop=volts, max_efficiency=efficiency)


def _times(part: Any, factors: Mapping[str, float]) -> dict[str, Any]:
    return {name: getattr(part, name) * factor for name, factor in factors.items()}
