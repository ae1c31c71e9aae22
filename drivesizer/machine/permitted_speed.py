r"""Fastest steady motion of a platform in each direction, by what its drives permit.

At a constant velocity :math:`v (\cos φ, \sin φ, 0)` in the robot's frame the wheels turn by (32), and their torques
are those of resistances and slope, whatever the speed: so each limit of a drive holds up to one speed. Looked at are
the limits that a motion meets which goes on for long: those of gearhead and motor, the winding's temperature and its
voltage at the lowest supply, the continuous current of the controller. Supply and battery are not.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import nan
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.parts import one_row
from drivesizer.errors import InputError
from drivesizer.load_cases import driven_shaft_cycle
from drivesizer.load_cases.platform_wheels import dynamics_of, ground_of
from drivesizer.physics.cycle_at_gearhead import ACCELERATION, BRAKING, DRIVING, SPEED, at_gearhead
from drivesizer.physics.drive_train import lost_in_gearhead
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.physics.motor_demand import coefficients
from drivesizer.physics.stress import housing_loss
from drivesizer.physics.thermal import resistance_25, resistance_at, steady_winding
from drivesizer.platform.dynamics import Dynamics, wheel_torques
from drivesizer.platform.kinematics import map_columns
from drivesizer.results.check_columns import CheckColumn, at_most
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.drive_set import DriveParts, DriveSet
from drivesizer.results.ratings import continuous_speed_limit, controller_current, nominal_current_limit
from drivesizer.spec.altitude import controller_needed, motor_needed, rise_needed
from drivesizer.spec.robot import RobotSpec

__all__ = ["PermittedSpeeds", "permitted_speeds"]

Array = NDArray[np.float64]
_EVERY = 5  # deg, between directions; a divisor of 15
_SLOW, _FAST = 1e-6, 1e3  # m/s, between which speeds are looked for
_HALVINGS = 32  # to less than a thousandth of a millimetre per second
_ROUNDING = 1e-9  # of what turns or slides


class PermittedSpeeds(NamedTuple):
    """Highest steady speed in each direction, of the platform as it is and with the motor of each wheel failed."""

    direction: NDArray[np.int64]  # deg, in the robot's frame, counterclockwise from ahead
    speed: dict[int, Array]  # m/s, by the failed wheel, 0 for none; NaN: no motion of these wheels, infinite: no limit
    limit: dict[int, list[str]]  # title of the check that a higher speed fails
    unknown: tuple[str, ...]  # titles of checks that are left out, as a figure of them is unknown
    estimated: tuple[str, ...]  # figures of the drive that no data sheet gives, at the middle of their bands
    failed: tuple[int, ...] = ()  # wheels whose motors have failed in all of it
    required: float | None = None  # m/s, in every direction

    def at(self, degrees: int) -> dict[int, tuple[float, str]]:
        """Speed and limit in one of the directions, by the failed wheel."""
        place = degrees // _EVERY
        return {failed: (float(speed[place]), self.limit[failed][place]) for failed, speed in self.speed.items()}


def permitted_speeds(spec: RobotSpec, drive: DriveSet) -> PermittedSpeeds | None:
    """Permitted speeds of a platform in all directions, as it is and with the motor of each driven wheel failed.

    A wheel whose motor has failed turns freely, or is held where the spec has ``blocked``. Its motor and gearhead
    resist nothing.
    """
    if drive.steps:
        return None
    direction = np.arange(0, 360, _EVERY)
    speed, limit, unknown = {}, {}, dict[str, None]()
    for failed in (0, *(place + 1 for place in dynamics_of(spec).kinematics.driven)):
        try:
            d = dynamics_of(_failed(spec, failed))
        except InputError:  # the others do not hold the platform
            continue
        speed[failed], limit[failed], lacking = _fastest(spec, drive, d, np.radians(direction))
        unknown |= dict.fromkeys(lacking)
    estimated = (one.title for one in drive.estimated if one.kind != "mass" and one.part != "encoder")
    assert spec.platform is not None
    wanted = spec.requirements.speed if spec.requirements else None
    return PermittedSpeeds(
        direction, speed, limit, tuple(unknown), tuple(estimated), tuple(spec.platform.failed),
        spec.platform.limits.speed if wanted is None else wanted,
    )  # fmt: skip


def _failed(spec: RobotSpec, wheel: int) -> RobotSpec:
    platform = spec.platform
    assert platform is not None
    return spec.alone(platform=platform.model_copy(update={"failed": [*platform.failed, *[wheel] * bool(wheel)]}))


def _fastest(
    spec: RobotSpec, drive: DriveParts, d: Dynamics, direction: Array
) -> tuple[Array, list[str], Iterator[str]]:
    """Highest speed in each direction, the check that ends it, and checks that are unknown."""
    eta = np.stack([np.cos(direction), np.sin(direction), np.zeros_like(direction)])
    k = d.kinematics
    moves = (np.abs(map_columns(k.held, eta)) <= _ROUNDING).all(axis=0)
    eta = eta[:, moves]
    turns = map_columns(k.E[list(k.driven)], eta)
    turns[np.abs(turns) <= _ROUNDING * np.abs(turns).max(initial=0.0)] = 0.0
    torque = wheel_torques(d, eta, np.zeros_like(eta), ground=ground_of(spec))

    def checks(v: Array) -> list[CheckColumn]:
        return _checks(spec, drive, (turns * v).ravel(), torque.ravel())

    def shortage(v: Array) -> Array:
        """By how much each check falls short, 0 where it passes: shape (checks, wheels, directions)."""
        every = checks(v)
        found = [np.where(every[n].passed, 0.0, 1.0 - np.nan_to_num(every[n].margin)) for n in known]
        return np.array(found).reshape(-1, *turns.shape)

    low = np.full(turns.shape[1], _SLOW)
    first = checks(low)
    turning = turns.ravel() != 0.0  # a wheel at rest meets any limit of speed, known or not
    known = [number for number, check in enumerate(first) if (check.passed | check.failed)[turning].any()]
    held, high = shortage(low).any(axis=(0, 1)), np.full_like(low, _FAST)
    free: NDArray[np.bool_] = np.logical_not(shortage(high).any(axis=(0, 1)))
    for _ in range(_HALVINGS):
        middle = (low + high) / 2.0
        over = shortage(middle).any(axis=(0, 1))
        low, high = np.where(over, low, middle), np.where(over, middle, high)
    worst = shortage(np.where(held, _SLOW, high)).max(axis=1).argmax(axis=0)
    titles = [
        "" if never else CHECKS["physics"][first[known[n]].name].title for n, never in zip(worst, free, strict=True)
    ]
    speed, named = np.full(len(direction), nan), np.full(len(direction), "", dtype=object)
    speed[moves], named[moves] = np.where(free, np.inf, np.where(held, 0.0, low)), titles
    return speed, named.tolist(), (CHECKS["physics"][c.name].title for n, c in enumerate(first) if n not in known)


def _checks(spec: RobotSpec, drive: DriveParts, speed: Array, torque: Array) -> list[CheckColumn]:
    """Limits of a drive in steady motion, as columns over speeds and torques at its wheel."""
    speeds, torques = (np.stack([x, x], axis=1) for x in (speed, torque))
    cycle = LoadCycle("steady motion", np.ones_like(speed), speeds, np.zeros_like(speeds), torques)
    at = at_gearhead(driven_shaft_cycle(spec, cycle), drive.belt_efficiency).behind(drive.belt_ratio)
    motor, gearhead, controller = one_row(drive.motor), one_row(drive.gearhead), one_row(drive.controller)
    own = coefficients(at.acts, motor, gearhead, one_row(drive.encoder), drive.brake_inertia)
    f, ratio, ambient = at.functions[:, 0], drive.gearhead.ratio, spec.environment.ambient
    output, turning = f[:, :ACCELERATION].sum(axis=1), np.abs(f[:, SPEED])  # N*m and rad/s behind the gearhead
    current = f @ np.where(own.left_out, nan, own.torque)[0] / drive.motor.torque_constant
    rubbing, iron = housing_loss(motor, gearhead["ratio"])
    loss = rubbing * turning + iron * turning**2
    if spec.mounting and spec.mounting.gear_loss_share:
        driving, braking = (f[:, which] * f[:, SPEED] for which in (DRIVING, BRAKING))
        loss = loss + spec.mounting.gear_loss_share * lost_in_gearhead(driving, braking, turning * ratio, gearhead)
    R_25 = resistance_25(motor)
    winding = np.asarray(steady_winding(motor, ambient, np.abs(current), loss))
    warm = np.where(np.isnan(winding), motor["max_winding_temperature"], np.fmin(winding, 1e4))
    feed = spec.feed_of(drive.controller, drive.brake)
    volts = np.max([np.abs(current * (resistance_at(R_25, T) + feed.leads) + own.back_emf * f[:, SPEED] * ratio)
                    for T in (ambient, warm)], axis=0)  # fmt: skip
    margins = spec.margins
    return [
        at_most("gearhead_continuous_torque", np.abs(output), gearhead["continuous_torque"], needed=margins.torque),
        continuous_speed_limit(gearhead, turning, turning, ratio, margins.speed),
        at_most("gearhead_continuous_power", np.abs(output) * turning, gearhead["continuous_power"],
                needed=margins.torque),
        at_most("motor_speed", turning * ratio, motor["max_speed"], needed=margins.speed),
        nominal_current_limit(np.abs(current), motor, ambient, motor_needed(spec)),
        at_most("winding_temperature", winding, motor["max_winding_temperature"], zero=ambient,
                needed=rise_needed(spec)),
        at_most("supply_voltage", volts, feed.usable_for(volts), needed=margins.speed),
        at_most("controller_continuous_current", np.abs(current), controller_current(controller, ambient),
                needed=controller_needed(spec)),
    ]  # fmt: skip
