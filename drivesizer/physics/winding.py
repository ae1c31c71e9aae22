"""Heat and electrical stress of windings over a load cycle: losses, current, voltage, behind one belt or many."""

from __future__ import annotations

from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from drivesizer.physics.cycle_at_gearhead import DIRECTION, SPEED, AtGearhead, Peak
from drivesizer.physics.drive_train import nominal_friction
from drivesizer.physics.figures import Array, Columns, Figure, Figures, once_per_part
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.thermal import (
    rated_ambient,
    resistance_25,
    resistance_at,
    steady_winding,
    steady_winding_temperature,
    two_bodies,
)

# -- Heat and electrical stress of motors over a load cycle, on columns: losses, warm resistance, current, voltage.


class Parts(NamedTuple):
    """Figures of the candidates' parts by field name: columns, NaN where there is no such part."""

    motor: Columns
    gearhead: Columns
    encoder: Columns
    controller: Any  # None where none is chosen yet
    brake: Columns | None = None  # None where no drive has one

    def on(self, rows: Any) -> Parts:
        """The parts of some of the candidates: by a mask, numbers or a slice."""
        return Parts._make(None if part is None else part.on(rows) for part in self)


class Heat(NamedTuple):
    """Losses of a motor beside its copper, and its mean temperature in the long run."""

    friction: Array  # loss at the housing per speed of the gearhead's output [W s/rad]
    iron: Array  # and per square of it [W s^2/rad^2]
    mean: Array  # W, over the cycle
    winding: Array  # K, steady mean; infinite when it runs away


class Stress(NamedTuple):
    """Largest torque and current, and largest voltage while the winding is cold."""

    torque: Array  # N*m
    current: Peak  # A
    cold_voltage: Peak  # V, winding at the ambient's temperature


def housing_loss(motor: Figures, ratio: Array) -> tuple[Array, Array]:
    r"""Losses of friction and iron at the housing, per speed of the gearhead's output and per square of it.

    Brushed: the friction, :math:`(M_c + b w) |w|`. Brushless: friction and iron together, a loss P_N that with the
    copper's warms the winding to its permitted temperature at the catalogue's nominal point in the ambient of that
    rating; not below 0. Over the speed it goes as the friction does:

    .. math:: P = P_N \frac{(M_c + b w) w}{(M_c + b w_N) w_N}

    With unknown friction it goes as the square of the speed. Where a figure of that point is unknown: the friction.

    Parameters
    ----------
    motor
        Figures of the motors by field name: columns.
    ratio
        Of the gearhead [1]: a column.

    Returns
    -------
    tuple of arrays
        Loss per speed [W*s/rad] and per square of it [W*s^2/rad^2].
    """
    rubs, lost, coulomb, viscous, left, w_N = _nominal_loss(motor)
    scale = np.where(rubs, 1.0, lost)
    rubbing, growing = scale * coulomb * ratio, scale * viscous * ratio**2
    if (shapeless := ~rubs & ~np.isfinite(lost)).any():
        rubbing = np.where(shapeless, 0.0, rubbing)
        growing = np.where(shapeless, np.maximum(left, 0.0) * (ratio / w_N) ** 2, growing)
    return rubbing, growing


@once_per_part
def _nominal_loss(motor: Figures) -> tuple[Any, ...]:
    """Of each motor: whether only friction counts, loss per loss by friction, friction, loss [W] and speed of it."""
    brushed = motor["kind"] == "brushed"
    rise = motor["max_winding_temperature"] - rated_ambient(motor)
    R_th2 = motor["thermal_resistance_housing"]
    hot = resistance_at(resistance_25(motor), motor["max_winding_temperature"])
    copper = hot * motor["nominal_current"] ** 2
    left = (rise - (motor["thermal_resistance_winding"] + R_th2) * copper) / R_th2
    coulomb, viscous = nominal_friction(motor)
    w_N = motor["nominal_speed"]
    with np.errstate(divide="ignore", invalid="ignore"):
        lost = np.maximum(left, 0.0) / ((coulomb + viscous * w_N) * w_N)  # per loss by friction
    return brushed | np.isnan(left + w_N), lost, coulomb, viscous, left, w_N


def heat(
    ambient: Figure,
    cycle: AtGearhead,
    demands: Demands,
    motor: Figures,
    losses: tuple[Array, Array] | None = None,
    from_gearhead: Array | float = 0.0,
) -> Heat:
    """Losses at the housing, and mean temperature of the winding in the long run.

    Parameters
    ----------
    ambient
        Temperature around the motors [K].
    cycle
        The load cycle at the gearhead's output.
    demands
        Required torque and current of each candidate.
    motor
        Figures of the motors by field name: columns.
    losses
        What ``housing_loss`` gives, where it is at hand.
    from_gearhead
        Loss of the gearhead that heats the housing, per speed of its output [W*s/rad].

    Returns
    -------
    Heat
        Columns over candidates.
    """
    rubbing, iron = losses or housing_loss(motor, demands.total_ratio)
    if not cycle.acts[SPEED]:  # no friction at rest
        rubbing, iron = np.zeros_like(rubbing), np.zeros_like(iron)
    elif np.any(from_gearhead):  # NaN too
        rubbing = rubbing + from_gearhead
    mean = rubbing * cycle.moment(DIRECTION, SPEED) + iron * cycle.moment(SPEED, SPEED)
    least = np.where(demands.complete, mean, np.nan_to_num(mean))  # of an unknown friction
    winding = steady_winding(motor, ambient, demands.rms_current, least)
    return Heat(rubbing, iron, mean, np.asarray(winding))


def stress(ambient: Figure, cycle: AtGearhead, demands: Demands, motor: Figures, leads: Figure = 0.0) -> Stress:
    """Largest current of candidates, and largest voltage while the winding is cold; warm: see ``limits_over_time``.

    Parameters
    ----------
    ambient
        Temperature around the motors [K].
    cycle
        The load cycle at the gearhead's output.
    demands
        Required torque and current of each candidate.
    motor
        Figures of the motors by field name: columns.
    leads
        Resistance that takes of the voltage before the winding (``power_stage.Feed.leads``) [ohm].

    Returns
    -------
    Stress
        Columns over candidates.
    """
    k_t = motor["torque_constant"]
    cold = resistance_at(resistance_25(motor), ambient)
    torque = cycle.peak(demands.coefficients, demands.left_out)
    volts = cycle.peak(_least_volts(demands, k_t, np.asarray(cold)), demands.left_out)
    if np.any(leads):
        more = cycle.peak(volts_of(demands, k_t, np.asarray(cold + leads)), demands.left_out)
        larger = more.value > volts.value
        volts = Peak(np.where(larger, more.value, volts.value), np.where(larger, more.time, volts.time))
    return Stress(torque.value, Peak(torque.value / k_t, torque.time), volts)


def temperature_at_most(ambient: Figure, cycle: AtGearhead, heat: Heat, stress: Stress, motor: Figures) -> Array:
    """Temperature that no winding exceeds: in the long run at the largest current and loss all the time [K].

    Parameters
    ----------
    ambient
        Temperature around the motors [K].
    cycle
        The load cycle at the gearhead's output.
    heat, stress
        Losses and largest current of each candidate.
    motor
        Figures of the motors by field name: columns.

    Returns
    -------
    array
        Temperature of each candidate [K]; infinite at thermal runaway, NaN where a figure is unknown.
    """
    fast = cycle.peak_speed
    loss = heat.friction * fast + heat.iron * fast**2
    return np.asarray(steady_winding(motor, ambient, stress.current.value, loss))


def temperature_of_pulses(ambient: Figure, cycle: AtGearhead, demands: Demands, heat: Heat, motor: Figures) -> Array:
    r"""Temperature that no winding exceeds, were all heat of a cycle of duration t one pulse [K].

    .. math:: T_w \le T_a + (R_{th1} + R_{th2} + t / C_w) R(T_w) I_{rms}^2 + (R_{th2} + t / C_h) P_h

    Parameters
    ----------
    ambient
        Temperature around the motors [K].
    cycle
        The load cycle at the gearhead's output.
    demands, heat
        RMS current and mean losses of each candidate.
    motor
        Figures of the motors by field name: columns.

    Returns
    -------
    array
        Temperature of each candidate [K]; infinite where there is no such bound, or a figure is unknown.

    Notes
    -----
    What a pulse leaves of the rise of the body that it heats falls convexly, so that in a cycle which repeats it is
    nowhere above its mean by more than the pulse over that body's capacity. From cold on it is less. A resistance as at
    the highest temperature makes it no less.
    """
    bodies, total = two_bodies(motor), cycle.load_cycle.total
    with np.errstate(divide="ignore", invalid="ignore"):
        R_th1, losses = bodies.R_th1 + total / bodies.capacity_w, heat.mean * (1.0 + total / bodies.tau_h)
    temperature = steady_winding_temperature(ambient, bodies.R_25, R_th1, bodies.R_th2, demands.rms_current, losses)
    return np.where(bodies.known & ~np.isnan(temperature), temperature, np.inf)


def volts_of(demands: Demands, k_t: Array, resistance: Array) -> Array:
    r"""Coefficients of the motor's voltage from the six functions, :math:`V = R I + k_e K w`.

    Parameters
    ----------
    demands
        Required torque and current of each candidate.
    k_t
        Torque constants [N*m/A].
    resistance
        Of the windings [ohm].

    Returns
    -------
    array
        Coefficients, shape (candidates, 6).
    """
    c = demands.coefficients * (resistance / k_t)[:, None]
    c[:, SPEED] += demands.back_emf * demands.total_ratio
    return c


def _least_volts(demands: Demands, k_t: Array, resistance: Array) -> Array:
    """Those coefficients; of a winding or torque that is not known what its turning alone makes."""
    c = volts_of(demands, k_t, resistance)
    rows = np.isnan(c).any(axis=1)
    c[rows] = 0.0
    c[rows, SPEED] = (demands.back_emf * demands.total_ratio)[rows]
    return c


def belts_of(at: AtGearhead, count: int) -> list[tuple[AtGearhead, slice]]:
    """Candidates that are behind the same belt, one after the other.

    Parameters
    ----------
    at
        The load cycle behind their belts.
    count
        Number of candidates.

    Returns
    -------
    list
        The cycle behind each belt that has any, and their rows.
    """
    if not np.ndim(at.belt):
        return [(at, slice(0, count))]
    edges = [0, *(np.flatnonzero(np.diff(at.belt)) + 1).tolist(), count]
    return [(at.base.behind(float(at.belt[a])), slice(a, b)) for a, b in pairwise(edges) if b > a]
