r"""A drive and its load as a simulator of its own, with Python's library only, as an FMU needs.

.. math:: L \dot i = u - R i - k_e w - X |w| i, \quad
          \left(J_m + s \frac{J_l}{K}\right) \dot w = k i - M_f\,\mathrm{sgn}\,w - b w - s T(\mathrm{sgn}\,w)

with s = 1/(K e) where the motor drives the load and e/K where the load drives the motor; X, what commutation takes,
where the current drives the motor the way that it turns; at rest friction holds. The
resistance follows the winding's temperature, where the thermal figures are known. Steps of a fixed length by the
classical Runge-Kutta rule; where the speed goes through 0 the step is cut there.
Symbols: u voltage [V], i current [A], w motor speed [rad/s], K reduction, e efficiency, T load [N*m].
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from drivesizer.kernel.heat import added, bodies_of, law_of, mean_square, spread

FIGURES = {  # parameters: unit and meaning
    "resistance": ("ohm", "winding at 25 degC"),
    "inductance": ("H", "winding; 0: the current follows the voltage at once"),
    "torque_constant": ("N.m/A", "torque of the motor's magnets by current"),
    "back_emf_constant": ("V.s/rad", "voltage of the turning motor by speed"),
    "commutation": ("V.s/(A.rad)", "of the voltage by current and speed, that commutation of a turning motor takes"),
    "motor_inertia": ("kg.m2", "rotor, encoder and gearhead input"),
    "motor_friction": ("N.m", "dry friction at the motor"),
    "motor_viscous": ("N.m.s/rad", "viscous friction at the motor"),
    "ratio": ("1", "motor turns per turn of the driven shaft"),
    "efficiency": ("1", "of all gears, in either direction of power"),
    "load_inertia": ("kg.m2", "at the driven shaft"),
    "forward_torque": ("N.m", "resistance of the load when it moves forward"),
    "backward_torque": ("N.m", "the same backward: below the forward one by twice the friction"),
    "rest_torque": ("N.m", "of the load without friction: weight"),
    "lever_torque": ("N.m", "of a weight on a lever that lies level; the three above have it at the shaft's angle 0"),
    "lever_angle": ("rad", "of the lever above the level line at the shaft's angle 0"),
    "radius": ("m", "travel of the load per angle of the driven shaft; 1 where it turns with it"),
    "ambient": ("K", "temperature around the motor"),
    "winding_to_housing": ("K/W", "thermal resistance; 0: the winding stays at 25 degC"),
    "housing_to_ambient": ("K/W", "thermal resistance"),
    "winding_capacity": ("J/K", "heat capacity"),
    "housing_capacity": ("J/K", "heat capacity"),
    "housing_loss": ("N.m", "torque whose loss warms the housing"),
    "housing_loss_viscous": ("N.m.s/rad", "the same, by the square of the speed"),
    "most_current": ("A", "beyond it the controller cuts the voltage; 0: no limit"),
}
INPUTS = {
    "voltage": ("V", "at the terminals"),
    "load_torque": ("N.m", "of the load at the driven shaft, beyond friction, inertia and weight"),
}
OUTPUTS = {
    "current": ("A", "in the winding"),
    "motor_speed": ("rad/s", "of the motor"),
    "shaft_angle": ("rad", "of the driven shaft"),
    "shaft_speed": ("rad/s", "of the driven shaft"),
    "load_speed": ("m/s", "of the load; rad/s where it turns with the shaft"),
    "winding_temperature": ("K", "of the winding"),
    "housing_temperature": ("K", "of the housing"),
}
_COPPER, _DATA = 0.0039, 298.15  # 1/K, K: as drivesizer.physics.thermal
_PART = 0.2  # of the shortest time constant: a step
_MOST = 200_000  # steps in a call
_ROUNDS = 40  # of the search for the moment of standstill


class Drive:
    """The machine with its state; figures by the names of ``FIGURES``, SI."""

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> float:
            """One of ``FIGURES``."""

    def __init__(self, figures: dict[str, float]) -> None:
        for name in FIGURES:
            setattr(self, name, float(figures[name]))
        self.voltage = self.load_torque = 0.0
        self.current = self.motor_speed = self.shaft_angle = 0.0
        self.winding_temperature = self.housing_temperature = self.ambient

    @property
    def shaft_speed(self) -> float:
        """Of the driven shaft [rad/s]."""
        return self.motor_speed / self.ratio

    @property
    def load_speed(self) -> float:
        """Of the load [m/s, or rad/s]."""
        return self.shaft_speed * self.radius

    def advance(self, seconds: float) -> None:
        """Simulate with the inputs held."""
        count = min(_MOST, max(1, math.ceil(seconds / (_PART * self._shortest()))))
        for _ in range(count):
            self._step(seconds / count)

    def _hot(self) -> float:
        """Resistance of the winding at its temperature [ohm]."""
        if not self.winding_to_housing > 0.0:
            return self.resistance
        return self.resistance * (1.0 + _COPPER * (self.winding_temperature - _DATA))

    def _shortest(self) -> float:
        """Shortest time constant [s]: electrical, or mechanical with the load's inertia while braking."""
        R, k = self._hot(), self.torque_constant
        inertia = self.motor_inertia + self.load_inertia * self.efficiency / self.ratio**2
        mechanical = R * inertia / (k * self.back_emf_constant + R * self.motor_viscous)
        R += self.commutation * abs(self.motor_speed)
        return min(self.inductance / R, mechanical) if self.inductance > 0.0 else mechanical

    def _step(self, h: float) -> None:
        direction = self._direction()
        i, w, angle = self._stepped(h, direction)
        if w * direction < 0.0:  # it comes to rest within the step: up to there, and the rest from standstill
            share = self._stops(h, direction)
            i, _, angle = self._stepped(share, direction)
            self._settle(i, 0.0, angle, share)
            direction = self._direction()
            i, w, angle = self._stepped(h - share, direction)
            h -= share
            w = w if w * direction >= 0.0 else 0.0
        self._settle(i, w, angle, h)

    def _stops(self, h: float, direction: int) -> float:
        """Time at which the speed reaches 0, by bisection."""
        low, high = 0.0, h
        for _ in range(_ROUNDS):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if self._stepped(middle, direction)[1] * direction < 0.0 else (middle, high)
        return low

    def _direction(self) -> int:
        """Direction of motion for the next step: 1, -1, or 0 where friction holds."""
        w = self.motor_speed
        if w:
            return 1 if w > 0.0 else -1
        for direction in (1, -1):
            if self._acceleration(self._flowing(self.current, 0.0), 0.0, self.shaft_angle, direction) * direction > 0.0:
                return direction
        return 0

    def _flowing(self, i: float, w: float) -> float:
        """The current: of the winding, or what the voltage makes at once where there is no inductance."""
        return i if self.inductance > 0.0 else self._cut((self.voltage - self.back_emf_constant * w) / self._hot())

    def _cut(self, i: float) -> float:
        most = self.most_current
        return min(max(i, -most), most) if most > 0.0 else i

    def _lifted(self, angle: float) -> float:
        """Change of the lever's weight torque since the shaft's angle 0 [N*m]."""
        if not self.lever_torque:
            return 0.0
        return self.lever_torque * (math.cos(self.lever_angle + angle) - math.cos(self.lever_angle))

    def _acceleration(self, i: float, w: float, angle: float, direction: int) -> float:
        """Of the motor [rad/s^2], moving forward (1) or backward (-1)."""
        K, e = self.ratio, self.efficiency
        motor = self.torque_constant * i - self.motor_friction * direction - self.motor_viscous * w
        load = (self.forward_torque if direction > 0 else self.backward_torque) + self.load_torque + self._lifted(angle)
        through = self.load_inertia * motor / K + self.motor_inertia * load  # has the sign of what the gears transmit
        share = (1.0 / e if through * direction > 0.0 else e) / K
        return (motor - share * load) / (self.motor_inertia + share * self.load_inertia / K)

    def _rates(self, i: float, w: float, angle: float, direction: int) -> tuple[float, float]:
        flows, slope = self._cut(self._flowing(i, w)), 0.0
        if self.inductance > 0.0:
            R = self._hot() + (self.commutation * abs(w) if flows * w > 0.0 else 0.0)
            slope = (self.voltage - R * flows - self.back_emf_constant * w) / self.inductance
            if self.most_current > 0.0 and abs(i) >= self.most_current and slope * i > 0.0:
                slope = 0.0  # the controller holds it there
        return slope, self._acceleration(flows, w, angle, direction) if direction else 0.0

    def _stepped(self, h: float, direction: int) -> tuple[float, float, float]:
        """Current, speed and angle of the shaft after a step."""
        i, w = self.current, self.motor_speed if direction else 0.0
        angle, turn = self.shaft_angle, h / self.ratio
        a = self._rates(i, w, angle, direction)
        b = self._rates(i + 0.5 * h * a[0], w + 0.5 * h * a[1], angle + 0.5 * turn * w, direction)
        c = self._rates(i + 0.5 * h * b[0], w + 0.5 * h * b[1], angle + 0.5 * turn * (w + 0.5 * h * a[1]), direction)
        d = self._rates(i + h * c[0], w + h * c[1], angle + turn * (w + 0.5 * h * b[1]), direction)
        di, dw = (h / 6.0 * (a[n] + 2.0 * b[n] + 2.0 * c[n] + d[n]) for n in (0, 1))
        turned = h * w + h * h / 6.0 * (a[1] + b[1] + c[1])
        return i + di, w + dw, angle + turned / self.ratio

    def _settle(self, i: float, w: float, angle: float, h: float) -> None:
        before = self.current
        self.motor_speed, self.shaft_angle = w, angle
        self.current = self._cut(self._flowing(i, w))
        if self.winding_to_housing > 0.0:
            cold = self.resistance * (1.0 + _COPPER * (self.ambient - _DATA))
            thermal = self.winding_to_housing, self.housing_to_ambient, self.winding_capacity, self.housing_capacity
            bodies = bodies_of(cold, _COPPER * self.resistance, *thermal)
            loss = self.housing_loss * abs(w) + self.housing_loss_viscous * w * w
            law = law_of(bodies, mean_square(before, self.current), loss)
            rises = self.winding_temperature - self.ambient, self.housing_temperature - self.ambient
            winding, housing, _ = added(law, spread(law, h), h, *rises)
            self.winding_temperature += winding
            self.housing_temperature += housing
