"""One set at a supply: figures of its motor and gear over samples, and its steady points.

Torques with ``_out`` are at the output. A gear that drives has the efficiency e of its printed torque, one that is
driven the same e; a gearhead's own friction without load counts where it is printed.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.at_voltage import Winding, operating_point
from drivesizer.physics.drive_train import ELECTRONICS, motor_and_gears
from drivesizer.physics.power_stage import Feed, power_stage
from drivesizer.physics.stress import housing_loss
from drivesizer.physics.thermal import TwoBodies, resistance_25, resistance_at, two_bodies
from drivesizer.prediction.sampled_parts import Figures, SampledParts
from drivesizer.results.prediction import Conditions

__all__ = ["HeldAtRest", "SetAtVoltage", "at_rest", "hottest_phase", "set_at_voltage"]

Array = NDArray[np.float64]
_LIMITED = 0.9  # of V/R: a printed stall current below this is a controller's
_HALF_STEP = np.pi / 6.0  # rad, electrical: farther away another phase carries most


class SetAtVoltage(NamedTuple):
    """Columns over samples; the first row is nominal."""

    motor: Figures
    voltage: Array  # V, that reaches the leads of the winding
    duty: Array  # share of the supply's voltage at full command
    leads: Array  # ohm, in series with the winding
    feed: Feed | None  # of the controller; None without one
    most_current: Array  # A, of the controller; infinite without one
    R_25: Array
    k_t: Array
    k_e: Array
    coulomb: Array  # N*m at the motor, of motor and gear without load
    viscous: Array  # N*m*s/rad
    ratio: Array
    efficiency: Array
    inertia: Array  # kg*m^2, of rotor and gear at the motor
    bodies: TwoBodies
    losses: tuple[Array, Array]  # at the housing, per speed and per square of it

    def winding(self, temperature: Any) -> Winding:
        """Electrical side with the winding at a temperature [K], leads included."""
        R = np.asarray(resistance_at(self.R_25, temperature) + self.leads)
        return Winding(R, self.motor["inductance"], self.k_t, self.k_e)

    def stall_current(self, temperature: Any) -> Array:
        """Current at standstill and full voltage [A]."""
        return np.asarray(np.minimum(self.voltage / self.winding(temperature).R, self.most_current))

    def source_power(self, source: float, resistance: float, current: Array) -> Array:
        """Power out of the source at full command [W], by ``physics.power_stage``: duty, losses, standby power."""
        at_bus = self.duty * current
        if self.feed is None:
            return source * at_bus
        stage, sagged = self.feed.stage, source - resistance * at_bus
        drop = source - self.voltage / self.duty
        return np.asarray(source * (at_bus + ((stage.loss - self.duty * drop) * current + stage.standby) / sagged))

    def motor_torque(self, torque_out: Any) -> Array:
        """Torque at the motor that drives one at the output, dry friction included [N*m]; none needs no efficiency."""
        driving = 0.0 if np.all(torque_out == 0.0) else torque_out / (self.ratio * self.efficiency)
        return np.asarray(driving + self.coulomb)

    def running(self, torque_out: Any, temperature: Any) -> tuple[Array, Array]:
        """Speed of the motor [rad/s] and current [A] under a torque at the output; stalled where that is too much."""
        winding = self.winding(temperature)
        speed, current = operating_point(winding, self.voltage, self.motor_torque(torque_out), self.viscous)
        stuck = (speed <= 0.0) | (current > self.most_current)
        return np.where(stuck, 0.0, speed), np.where(stuck, self.stall_current(temperature), current)


class HeldAtRest(NamedTuple):
    """A torque that is held at rest."""

    current: Array  # A
    bodies: TwoBodies  # of the hottest phase


def set_at_voltage(parts: SampledParts, given: Conditions) -> SetAtVoltage:
    """A set at a supply.

    Parameters
    ----------
    parts
        Its figures over samples.
    given
        Voltage and resistance of the supply.

    Returns
    -------
    SetAtVoltage
        Columns over samples.
    """
    motor, gearhead, controller = parts.motor, parts.gearhead, parts.controller
    whole = np.ones(len(motor["part"]))
    own = motor_and_gears(motor, gearhead)
    duty = whole if controller is None else controller["max_duty"]
    voltage, feed = given.voltage * whole, None
    if controller is not None:
        feed = Feed(power_stage(controller, given.voltage), given.voltage, given.resistance, 1)
        voltage = feed.usable
    return SetAtVoltage(
        motor=motor,
        voltage=voltage,
        duty=duty,
        leads=duty**2 * given.resistance,
        feed=feed,
        most_current=_most_current(motor, controller, whole),
        R_25=np.asarray(resistance_25(motor)),
        k_t=own.k_t,
        k_e=motor["back_emf_constant"],
        coulomb=own.coulomb + own.idle,
        viscous=own.viscous,
        ratio=own.ratio,
        efficiency=own.efficiency,
        inertia=own.inertia,
        bodies=two_bodies(motor),
        losses=housing_loss(motor, whole),
    )


def _most_current(motor: Figures, controller: Figures | None, whole: Array) -> Array:
    """Largest current of the controller; of one inside an actuator its stall's, where the winding would take more."""
    if controller is not None:
        return np.asarray(controller["peak_current"], float)
    stall, own = motor["stall_current"][0], motor["nominal_voltage"][0] / motor["resistance"][0]
    inside = motor["commutation"][0] == ELECTRONICS
    return np.asarray((stall if inside and stall < _LIMITED * own else np.inf) * whole)


def at_rest(one: SetAtVoltage, parts: SampledParts, torque_out: Any) -> HeldAtRest:
    r"""Current that holds a torque at rest, and the hottest phase as winding.

    Friction carries any part between :math:`M e / i - M_f` (it helps) and :math:`M / (i e) + M_f` (it has just been
    overcome): uniform between the two over the samples, M/i in the nominal row.

    Parameters
    ----------
    one
        The set.
    parts
        Its figures, with further uniform ones.
    torque_out
        At the output [N*m].

    Returns
    -------
    HeldAtRest
        Current [A] and bodies of heat.
    """
    helped = np.maximum(torque_out * one.efficiency / one.ratio - one.coulomb, 0.0)
    overcome = one.motor_torque(torque_out)
    torque = helped + parts.free[:, 0] * (overcome - helped)
    torque[0] = np.where(np.isnan(torque[0]), np.nan, torque_out / one.ratio[0])
    return HeldAtRest(torque / one.k_t, hottest_phase(one, parts))


def hottest_phase(one: SetAtVoltage, parts: SampledParts) -> TwoBodies:
    """Bodies of heat with the phase that carries most as the winding: more of the loss than of the mass.

    A brushless motor at rest heats its phases unequally: by the rotor's angle the hottest has 1.5 to 2 times the mean
    loss (three sinusoidal currents). Of what is above the mean its neighbours lead away any part, which varies over
    the samples: in a measured RI50 the same spot warmed at 1, 0.8 and 0.6 of a rate with the rotor at three angles.

    Parameters
    ----------
    one
        The set.
    parts
        Its figures, with uniform ones for the rotor's angle and for what its neighbours lead away.

    Returns
    -------
    TwoBodies
        Those of the set for a brushed motor.
    """
    if one.motor["kind"][0] != "brushless":
        return one.bodies
    alone = 2.0 * np.cos(_HALF_STEP * parts.free[:, 1]) ** 2
    more = 1.0 + (alone - 1.0) * parts.free[:, 2]
    return TwoBodies(R_25=one.bodies.R_25, R_th1=one.bodies.R_th1 * more, R_th2=one.bodies.R_th2,
                     tau_w=one.bodies.tau_w, tau_h=one.bodies.tau_h)  # fmt: skip
