"""The controller of a drive: its rates and its encoder, gains by rule, checked on the sampled loop.

Rates are those of the spec, else the catalogue's. Speed is that of the encoder's counts where the drive has an encoder
whose lines are known.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from drivesizer.catalog import EDGES, Controller
from drivesizer.control.cascade import LEAST_PHASE_MARGIN, Cascade, rates
from drivesizer.control.cascade_design import CascadeRequirements, design_cascade
from drivesizer.control.cascade_rules import SPREAD, margin_of
from drivesizer.control.drive_train import DriveTrain, drive_train, elastic
from drivesizer.control.loop_tuning import Required, Tuned, tuned
from drivesizer.control.validation import Gains
from drivesizer.control.voltage_loop_design import design
from drivesizer.errors import InputError
from drivesizer.physics.counted_speed import MOST_PERIODS, Counts, answer
from drivesizer.results.drive_set import DriveParts
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

__all__ = ["designed", "edges_of", "stated_margin", "train_behind"]

_PERIOD = 1e-3  # s, of a velocity loop on the voltage, where the controller's is unknown


def designed(spec: RobotSpec, drive_set: DriveParts) -> tuple[DriveTrain, Gains | Cascade, list[str]]:
    """The drive train of a spec and a drive, the controller designed for it, and the assumptions of both."""
    if spec.control.structure == "cascade":
        return _cascade(spec, drive_set)
    period, said = _period(spec, drive_set.controller)
    rigid, assumed = drive_train(spec, drive_set, period)
    train = _with_shaft(spec, drive_set, rigid)
    counts, more = _counts(spec, drive_set, train, period)
    said += [*assumed, *more]
    if spec.control.kp is not None:
        return train, design(spec, train, period, counts), said
    gains, slower = tuned(
        lambda factor: design(spec, train, period, counts, factor), Required(train, stated_margin(spec))
    )
    _refuse_slower(spec, ("control", "bandwidth"), spec.control.bandwidth, slower)
    return train, gains, [*said, *_reported(slower)]


def train_behind(spec: RobotSpec, drive_set: DriveParts, controller: Gains | Cascade) -> tuple[DriveTrain, list[str]]:
    """The drive train behind a controller that was designed before, of this machine or of one like it."""
    period = controller.period if isinstance(controller, Gains) else controller.current_period
    rigid, said = drive_train(spec, drive_set, period)
    return _with_shaft(spec, drive_set, rigid), said


def _cascade(spec: RobotSpec, drive_set: DriveParts) -> tuple[DriveTrain, Cascade, list[str]]:
    every, said = rates(drive_set.controller, spec.control.rate)
    rigid, assumed = drive_train(spec, drive_set, every.current)
    train = _with_shaft(spec, drive_set, rigid)
    counts, more = _counts(spec, drive_set, train, every.velocity)
    wanted = _requirements(spec)
    rules: list[str] = []

    def make(slower: float) -> Cascade:
        less = wanted if wanted.bandwidth is None else replace(wanted, bandwidth=wanted.bandwidth / slower)
        found, rules[:] = design_cascade(
            train, every, less, where=lambda field: spec.where(_path(field)), counts=counts, slower=slower
        )
        return found

    if wanted.velocity_kp is not None or wanted.velocity_ki is not None:
        return train, make(1.0), [*said, *assumed, *more, *rules]
    cascade, slower = tuned(make, Required(train, stated_margin(spec)))
    _refuse_slower(spec, ("control", "velocity", "bandwidth"), wanted.bandwidth, slower)
    return train, cascade, [*said, *assumed, *more, *rules, *_reported(slower)]


def _refuse_slower(spec: RobotSpec, path: tuple[str, ...], bandwidth: float | None, slower: Tuned) -> None:
    """Refuse a required bandwidth where the loop must be slower."""
    if bandwidth is not None and slower.why:
        most = show(math.floor(10.0 * bandwidth / slower.slower) / 10.0, "Hz", "frequency")
        required = show(bandwidth, "Hz", "frequency")
        raise InputError(f"{spec.where(path)}: {required} is too fast: {slower.why}; expected at most {most}")


def _reported(slower: Tuned) -> list[str]:
    if not slower.why:
        return []
    return [f"the loop is {slower.slower:.3g} times slower than its design rule, with which {slower.why}"]


# --- rates


def _period(spec: RobotSpec, controller: Controller | None) -> tuple[float, list[str]]:
    """The period of a controller's velocity loop [s]."""
    if spec.control.rate is not None:
        return 1.0 / spec.control.rate, []
    rate = controller.speed_loop if controller else math.nan
    if rate > 0.0:
        return 1.0 / rate, []
    return _PERIOD, [f"the controller's rate is unknown: it runs every {show(_PERIOD, 'ms', 'time')}"]


# --- the encoder


def edges_of(spec: RobotSpec, drive_set: DriveParts) -> int:
    """Counts per turn of the motor by which speed is measured."""
    lines = drive_set.encoder.lines if drive_set.encoder else math.nan
    return 0 if spec.control.speed_from == "exact" or math.isnan(lines) else round(EDGES * lines)


def _counts(
    spec: RobotSpec, drive_set: DriveParts, train: DriveTrain, period: float
) -> tuple[Counts | None, list[str]]:
    """Counting of the speed, and the assumptions made; None: it is measured exactly."""
    edges = edges_of(spec, drive_set)
    if not edges:
        lacks = "the drive has no encoder" if drive_set.encoder is None else "the encoder's resolution is unknown"
        return None, [] if spec.control.speed_from == "exact" else [f"{lacks}: speed is measured exactly"]
    usable = float(spec.feed_of(drive_set.controller).usable)
    volts = spec.supply.lowest if math.isnan(usable) else usable
    peak = drive_set.controller.peak_current if drive_set.controller else math.nan
    amperes = answer(volts, train.resistance, peak, drive_set.motor.nominal_current)
    volts_per_ampere = 1.0 if spec.control.structure == "cascade" else train.resistance
    return Counts(edges, amperes * volts_per_ampere, _periods(spec, period)), []


def _periods(spec: RobotSpec, period: float) -> int:
    """Counting time of the spec in periods; 0: the best is found."""
    time = spec.control.count_time
    if time is None:
        return 0
    if not 0.5 <= time / period < MOST_PERIODS + 0.5:
        raise InputError(
            f"{spec.where(('control', 'count_time'))}: {show(time, 'ms', 'time')} is no counting time at a period of "
            f"{show(period, 'ms', 'time', 4)}; expected one to {MOST_PERIODS} periods"
        )
    return round(time / period)


# --- requirements


def stated_margin(spec: RobotSpec) -> float:
    """Required phase margin [rad]: that of the symmetrical optimum, else that below which a loop rings."""
    c = spec.control.velocity
    if c.phase_margin is not None:
        return c.phase_margin
    placed = spec.control.structure != "cascade" or {"kp", "ki", "bandwidth", "damping"} & c.model_fields_set
    return LEAST_PHASE_MARGIN if placed else margin_of(SPREAD)


def _with_shaft(spec: RobotSpec, drive_set: DriveParts, train: DriveTrain) -> DriveTrain:
    """The drive train with the elastic shaft that a spec gives; the same one of a rigid model."""
    if spec.plant.model == "rigid":
        return train
    where, stiffness = spec.where(("plant", "model")), spec.plant.stiffness or spec.belt_stiffness
    if not stiffness > 0.0:  # NaN too
        raise InputError(f"{where}: two_mass needs plant.stiffness or the belt's, e.g. stiffness: 500 N*m/rad")
    if not train.load_inertia > 0.0:
        raise InputError(f"{where}: two_mass needs an inertia of the load, e.g. inertia: 0.02 kg*m^2")
    damping = 2.0 * spec.plant.damping_ratio * math.sqrt(stiffness * train.load_inertia)
    return elastic(train, stiffness, damping, _gap(spec, drive_set))


def _gap(spec: RobotSpec, drive_set: DriveParts) -> float:
    """Backlash at the driven shaft [rad]: the spec's, else the gearhead's; 0 where neither is known."""
    own = drive_set.gearhead.backlash / drive_set.belt_ratio
    gap = spec.plant.backlash if spec.plant.backlash is not None else own
    return 0.0 if math.isnan(gap) else float(gap)


# --- gains of the spec


def _requirements(spec: RobotSpec) -> CascadeRequirements:
    """Gains and requirements of the cascade that the spec gives."""
    c = spec.control
    given: dict[str, Any] = {f"current_{name}": getattr(c.current, name) for name in ("kp", "ki")}
    given |= {f"velocity_{name}": getattr(c.velocity, name) for name in ("kp", "ki", "kd")}
    given |= {name: getattr(c.velocity, name) for name in ("filter_time", "bandwidth", "damping", "phase_margin")}
    given |= {f"feedforward_{name}": value for name, value in c.feedforward.model_dump().items()}
    return CascadeRequirements(
        position=c.position is not None, position_kp=c.position.kp if c.position else None, **given
    )


def _path(field: str) -> tuple[str, ...]:
    """Path of a field of ``Wanted`` in the spec."""
    section, _, name = field.partition("_")
    if section in ("current", "velocity", "position", "feedforward"):
        return "control", section, name
    return "control", "velocity", field
