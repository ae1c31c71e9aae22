"""The cascade of a servo controller: current PI inside, velocity PI(D) around it, position P around that.

The structure of the EPOS4 class: each loop is sampled at its own rate, the faster one inside; feedforward of velocity
and acceleration goes to the current demand. Angles and speeds are those of the motor shaft.

.. [1] maxon, *EPOS4 Firmware Specification*, objects 0x30A0 to 0x30A2 (6.2.61 to 6.2.63): gains and their units. The
   document itself was not at hand: the units are those that two independent users of the controller give for it, and
   an auto-tuned controller's own figures confirm them (its acceleration feedforward is its inertia over its torque
   constant).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import NamedTuple

from drivesizer.catalog import Controller
from drivesizer.units import show

__all__ = ["LEAST_PHASE_MARGIN", "Cascade", "ControllerGain", "Rates", "controller_gains", "rates"]

LEAST_PHASE_MARGIN = math.radians(30.0)  # below it a loop rings: Åström, Hägglund, PID Controllers, 1995: 30 to 60 deg
_PERIODS = 1e-4, 1e-3, 1e-3  # s: current, velocity and position loop, where the controller's are unknown
_PER_VELOCITY = 10.0  # current periods in a velocity period, where only the latter is known


@dataclass(frozen=True, slots=True, kw_only=True)
class Cascade:
    """Gains and rates of a cascade; a gain of 0 switches its path off."""

    current_kp: float  # V/A
    current_ki: float  # V/(A*s)
    velocity_kp: float  # A/(rad/s)
    velocity_ki: float  # A/rad
    velocity_kd: float = 0.0  # A/(rad/s^2)
    filter_time: float = 0.0  # s, of the derivative
    position_kp: float = 0.0  # 1/s: speed demand per position error
    feedforward_velocity: float = 0.0  # A/(rad/s): viscous friction and iron
    feedforward_friction: float = 0.0  # A, in the direction of the demand
    feedforward_acceleration: float = 0.0  # A/(rad/s^2): the inertia
    current_period: float  # s
    velocity_period: float  # s, a whole multiple of the current loop's
    position_period: float = 0.0  # s, a whole multiple of the velocity loop's; 0: no position loop
    counted_over: int = 0  # velocity periods, over which counts are taken for a speed; 0: it is measured exactly
    rule: str = ""  # how the gains came about
    source: str = ""

    @property
    def current_steps(self) -> int:
        """Periods of the current loop in one of the velocity loop."""
        return round(self.velocity_period / self.current_period)

    @property
    def velocity_steps(self) -> int:
        """Periods of the velocity loop in one of the position loop; 0 without a position loop."""
        return round(self.position_period / self.velocity_period)


class Rates(NamedTuple):
    """Periods of the three loops [s], each a whole multiple of the one before."""

    current: float
    velocity: float
    position: float


def rates(controller: Controller | None, velocity_rate: float | None = None) -> tuple[Rates, list[str]]:
    """The periods of a controller's loops, and the assumptions where the catalogue has none.

    Velocity and position periods are rounded to whole multiples of the loop inside; a period that this changes is
    reported.
    """
    named = {"current": "current_loop", "velocity": "speed_loop", "position": "position_loop"}
    rate = {name: getattr(controller, figure) if controller else math.nan for name, figure in named.items()}
    if velocity_rate:
        position = min(rate["position"], velocity_rate) if rate["position"] > 0.0 else velocity_rate
        rate |= {"velocity": velocity_rate, "position": position}
    known = {name: 1.0 / f if f > 0.0 else math.nan for name, f in rate.items()}
    inner, middle, outer = known.values()
    if not inner > 0.0:
        inner = middle / _PER_VELOCITY if middle > 0.0 else _PERIODS[0]
    if not middle > 0.0:
        middle = max(_PERIODS[1], inner)
    if not outer > 0.0:
        outer = max(_PERIODS[2], middle)
    velocity = inner * max(1, round(middle / inner))
    found = Rates(inner, velocity, velocity * max(1, round(outer / velocity)))
    said = []
    for name, period in found._asdict().items():
        runs = f"runs every {show(period, 'us', 'time', 4)}"
        if math.isnan(known[name]):
            said.append(f"the rate of the controller's {name} loop is unknown: it {runs}")
        elif not math.isclose(period, known[name], rel_tol=1e-9):
            said.append(f"the {name} loop {runs}, a whole multiple of the loop inside")
    return found, said


@dataclass(frozen=True, slots=True, kw_only=True)
class ControllerGain:
    """A gain as it is written into the controller."""

    place: str  # index and subindex of the object
    name: str
    value: int
    unit: str


_Row = tuple[str, str, str, float, Callable[[Cascade], float]]

_EPOS4: tuple[_Row, ...] = (  # object, name, unit, that unit per SI unit, gain in SI
    ("0x30A0:01", "current controller P gain", "µV/A", 1e6, lambda c: c.current_kp),
    ("0x30A0:02", "current controller I gain", "µV/(A·ms)", 1e3, lambda c: c.current_ki),
    ("0x30A2:01", "velocity controller P gain", "µA·s/rad", 1e6, lambda c: c.velocity_kp),
    ("0x30A2:02", "velocity controller I gain", "µA/rad", 1e6, lambda c: c.velocity_ki),
    ("0x30A2:03", "velocity controller FF velocity gain", "µA·s/rad", 1e6, lambda c: c.feedforward_velocity),
    ("0x30A2:04", "velocity controller FF acceleration gain", "µA·s²/rad", 1e6, lambda c: c.feedforward_acceleration),
)
# The EPOS4's position controller is a PID whose output is the current. Where the velocity loop gets the path's velocity
# beside kv e, with e the position error, i = kp (kv e + e') + ki ∫(kv e + e') dt is that PID.
_EPOS4_POSITION: tuple[_Row, ...] = (
    ("0x30A1:01", "position controller P gain", "µA/rad", 1e6, lambda c: c.velocity_kp * c.position_kp + c.velocity_ki),
    ("0x30A1:02", "position controller I gain", "µA/(rad·s)", 1e6, lambda c: c.velocity_ki * c.position_kp),
    ("0x30A1:03", "position controller D gain", "µA·s/rad", 1e6, lambda c: c.velocity_kp),
    ("0x30A1:04", "position controller FF velocity gain", "µA·s/rad", 1e6, lambda c: c.feedforward_velocity),
    ("0x30A1:05", "position controller FF acceleration gain", "µA·s²/rad", 1e6, lambda c: c.feedforward_acceleration),
)
_EPOS4_LACKS = ("velocity_kd", "feedforward_friction")


def controller_gains(cascade: Cascade, controller: str) -> tuple[tuple[ControllerGain, ...], list[str]]:
    """The gains in the units of a controller, and those that it cannot take."""
    if not controller.upper().startswith("EPOS4"):
        return (), []
    rows = _EPOS4 + (_EPOS4_POSITION if cascade.position_kp else ())
    found = tuple(
        ControllerGain(place=place, name=name, value=round(gain(cascade) * per_si), unit=unit)
        for place, name, unit, per_si, gain in rows
    )
    lacking = [f.name for f in fields(cascade) if f.name in _EPOS4_LACKS and getattr(cascade, f.name)]
    return found, [f"the EPOS4 has no place for {name.replace('_', ' ')}" for name in lacking]
