"""One stepper against its limits, sample by sample: pull-out torque, start, steps, and what it draws.

The search looks at points of one load cycle that no other exceeds in torque and speed; here each sample has a cycle of
its own. The pull-out torque falls with the speed, so the ends of a segment decide where its larger torque is at the
faster one. Between the ends of the others, the same levels of speed are looked at as in the search.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.pull_outs import PullOuts
from drivesizer.catalog.view.stepper_view import STEPPER
from drivesizer.machine.pull_out import available_torque
from drivesizer.physics.cycle_at_gearhead import ACCELERATION
from drivesizer.physics.motor_demand import Demands, demands
from drivesizer.physics.stepper.drawn import copper_loss, electrical_energy, idle_loss
from drivesizer.physics.stepper.pull_out import amplitude
from drivesizer.physics.stress import Parts
from drivesizer.results.check_columns import CheckColumn, at_most
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
from drivesizer.search.uncertainty.part_figures import PartFigures
from drivesizer.search.uncertainty.sampled_battery import Draw
from drivesizer.search.uncertainty.sampled_cycle import AtSamples
from drivesizer.spec.altitude import controller_needed

__all__ = ["SampledStepper", "stepper_checks", "stepper_figures", "stepper_motor"]

Array = NDArray[np.float64]
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
    required = demands(at, Frictionless(parts.motor), parts.gearhead, parts.encoder, felt(at, parts))
    at.keep(required.coefficients)
    return required


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
    columns = electrical_energy(at.load_cycle.duration.T, torque, turning, total)
    return Draw(*(np.where(required.complete, x, np.nan) for x in columns))


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
