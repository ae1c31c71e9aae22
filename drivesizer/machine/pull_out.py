"""Pull-out torque of steppers out of the catalogue: by their printed curves, else by the model and its share."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.pull_outs import NO_PULL_OUTS, PullOuts
from drivesizer.catalog.view.stepper_view import STEPPER
from drivesizer.physics.figures import Figures
from drivesizer.physics.stepper.pull_out import pull_out_torque, rescaled_torque
from drivesizer.results.drive_set import DriveParts

__all__ = ["available_torque", "curves_of", "torque_of_drive", "torque_of_part"]

Array = NDArray[np.float64]
_FIGURES = ("holding_torque", "nominal_current", "resistance", "inductance", "pole_pairs", "pull_out_share")


def torque_of_part(catalog: Catalog, part: str, speed: Array, voltage: float) -> Array:
    """Pull-out torque of one stepper."""
    row = catalog.motors.rows[part]
    one = catalog.motors.taken(slice(row, row + 1))
    found: Array = available_torque(one, catalog.pull_outs, speed[None], voltage)[0]
    return found


def curves_of(catalog: Catalog, row: int) -> PullOuts:
    """Printed curves of one stepper, as a record of its drive keeps them."""
    if STEPPER not in catalog.motors.columns:
        return NO_PULL_OUTS
    own = catalog.pull_outs.on(catalog.pull_outs.stepper == catalog.motors[STEPPER][row])
    return own._replace(stepper=np.zeros_like(own.stepper))


def torque_of_drive(drive: DriveParts, speed: Array, voltage: float) -> Array:
    """Pull-out torque of the stepper of a drive."""
    one: dict[str, Any] = {name: np.array([getattr(drive.motor, name)]) for name in _FIGURES}
    found: Array = available_torque(one | {STEPPER: np.zeros(1, int)}, drive.pull_outs, speed[None], voltage)[0]
    return found


def available_torque(motor: Figures, curves: PullOuts, speed: Array, voltage: Any) -> Array:
    """Pull-out torque of steppers: by the printed curve where there is one, else the model's times its share.

    Of several curves that of the highest voltage that the supply reaches counts, else that of the lowest.
    """
    figures = {
        name: motor[column][:, None]
        for name, column in (("holding_torque", "holding_torque"), ("phase_current", "nominal_current"),
                             ("resistance", "resistance"), ("inductance", "inductance"), ("teeth", "pole_pairs"))
    }  # fmt: skip
    volts = voltage if np.ndim(voltage) == 0 else voltage[:, None]
    found: Array = motor["pull_out_share"][:, None] * pull_out_torque(speed, volts, **figures)
    if not len(curves.speed):
        return found
    which = _curves_of(curves, voltage, motor[STEPPER])
    rows = np.flatnonzero(which >= 0)
    if len(rows):
        at_speed, at_torque, at_voltage = (column[which[rows]] for column in _as_rows(curves))
        own = voltage if np.ndim(voltage) == 0 else voltage[rows]
        found[rows] = rescaled_torque(speed[rows], own, at_speed, at_torque, at_voltage)
    return found


def _curves_of(curves: PullOuts, voltage: Any, steppers: NDArray[np.int64]) -> NDArray[np.int64]:
    """Number of the curve of each stepper, on a voltage of its own or that of all; -1 where it has none."""
    count = int(steppers.max(initial=0)) + 1
    if np.ndim(voltage) == 0:
        return _curve_of(curves, voltage, count)[steppers]
    reached = np.searchsorted(np.unique(curves.voltage), voltage, side="right")  # between charts the choice is the same
    found = np.full(len(steppers), -1)
    for level in np.unique(reached):
        rows = np.flatnonzero(reached == level)
        found[rows] = _curve_of(curves, float(voltage[rows[0]]), count)[steppers[rows]]
    return found


def _curve_of(curves: PullOuts, voltage: float, count: int) -> NDArray[np.int64]:
    """For each stepper the number of its curve for a supply voltage, -1 where it has none."""
    _, first = np.unique(curves.curve, return_index=True)
    volts = curves.voltage[first]
    nearness = np.where(volts <= voltage, volts, -volts)  # the highest below, else the lowest above
    found = np.full(count, -1)
    for number in np.argsort(nearness, kind="stable").tolist():
        if curves.stepper[first[number]] < count:
            found[curves.stepper[first[number]]] = number
    return found


def _as_rows(curves: PullOuts) -> tuple[Array, Array, Array]:
    """Speeds and torques of the curves, a row each, filled up with the last point; and their voltages."""
    _, first, number = np.unique(curves.curve, return_index=True, return_counts=True)
    place = first[:, None] + np.minimum(np.arange(number.max()), number[:, None] - 1)
    return curves.speed[place], curves.torque[place], curves.voltage[first]
