"""The plant of the closed loop: motor, gearhead, belt and a share of the load, as linear modes discretised exactly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from enum import IntEnum
from math import inf, isfinite, isnan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, NoLoopError
from drivesizer.load_cases.platform import AtShaft, at_shaft
from drivesizer.loads.course import Profile
from drivesizer.physics.drive_train import commutation, through_gears
from drivesizer.physics.thermal import resistance_25
from drivesizer.results.drive_set import DriveParts
from drivesizer.results.ratings import unstated_temperature
from drivesizer.spec.robot import RobotSpec

# -- The plant of the closed loop: motor, gearhead, belt and one motor's share of the load.
#
# Rigid, it is linear between the reversals of speed and of power, with five linear modes: at rest, and driving or
# braking in either direction. The paper's speed reserve, bearing and oversize factors are no physics and are not
# included.
#
# Convention: forward is positive at the motor, the shaft and the load; torque at the shaft is positive when it
# resists forward motion. Symbols: i current [A], w motor speed [rad/s], u voltage [V], K total ratio [1].


_NO_INDUCTANCE = 1e-3  # electrical time constant in control periods, where the inductance is unknown: none to speak of
_FASTEST = 1e9  # rad/s at the motor: beyond any machine, and small enough that squares stay finite
_NEEDED = {"motor": ("resistance", "torque_constant", "rotor_inertia"), "gearhead": ("ratio", "efficiency")}


class Regime(IntEnum):
    """The linear modes of a rigid drive train, by direction of motion and of power."""

    AT_REST = 0
    FORWARD_DRIVING = 1
    FORWARD_BRAKING = 2
    BACKWARD_DRIVING = 3
    BACKWARD_BRAKING = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class Mechanics:
    """The rotor of one motor, its gears and its share of the load, SI."""

    friction: float = 0.0  # N*m at the motor, Coulomb: the motor's and the idle gearhead's
    motor_inertia: float  # kg*m^2 at the motor shaft: rotor, encoder, gearhead input
    gear_ratio: float = 1.0
    gear_efficiency: float = 1.0  # in either direction of power
    belt_ratio: float = 1.0
    belt_efficiency: float = 1.0
    load_inertia: float = 0.0  # kg*m^2 at the driven shaft
    radius: float = 1.0  # m, travel of the load per angle of the driven shaft; 1 where it turns with it
    forward_torque: float = 0.0  # N*m at the driven shaft, resistance when the load moves forward
    backward_torque: float = 0.0  # N*m at the driven shaft, the same when it moves backward
    rest_torque: float = 0.0  # N*m at the driven shaft, weight alone

    @property
    def load(self) -> AtShaft:
        """The load at the driven shaft, as it was taken."""
        torques = self.forward_torque, self.backward_torque, self.rest_torque
        return AtShaft(self.load_inertia, self.radius, *torques)

    @property
    def ratio(self) -> float:
        """Total ratio K, motor turns per turn of the driven shaft."""
        return self.gear_ratio * self.belt_ratio

    @property
    def efficiency(self) -> float:
        """Efficiency of gearhead and belt together."""
        return self.gear_efficiency * self.belt_efficiency

    @property
    def shares(self) -> tuple[float, float]:
        """Torque at the motor per torque at the driven shaft, where it drives the load and where the load drives it."""
        return through_gears(self.ratio, self.efficiency)

    @property
    def motor_per_speed(self) -> float:
        """Motor speed per speed of the load, K/r [rad/m, or 1]."""
        return self.ratio / self.radius

    def at_motor(self, direction: Any, more: Any, acceleration: Any = 0.0) -> Any:
        """Torque at the motor [N*m] against friction and load, by the direction of motion and that of power.

        With a further torque at the driven shaft, and an acceleration of the motor [rad/s^2].
        """
        torque = self.load_inertia * acceleration / self.ratio + self.load.along(direction) + more
        driving, braking = self.shares
        share = np.where(torque * direction > 0.0, driving, braking)
        return self.friction * direction + torque * np.where(direction == 0.0, 1.0 / self.ratio, share)


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveTrain(Mechanics):
    """One motor as a DC motor, its gears and its share of the load, SI; rigid unless a stiffness is given.

    Stiffness, damping and backlash are those of the driven shaft, behind the gears; seen at the motor shaft a
    stiffness is smaller by K^2.
    """

    resistance: float  # ohm, winding at 25 degC
    inductance: float  # H
    torque_constant: float  # N*m/A
    back_emf_constant: float  # V*s/rad
    viscous: float = 0.0  # N*m*s/rad at the motor
    commutation: float = 0.0  # V*s/(A*rad), that it takes of the voltage
    stiffness: float = inf  # N*m/rad of the driven shaft; infinite: rigid
    damping: float = 0.0  # N*m*s/rad of the driven shaft
    gap: float = 0.0  # rad of backlash at the driven shaft, from contact to contact

    @property
    def flexible(self) -> bool:
        """Whether motor and load are two masses on an elastic shaft."""
        return self.stiffness < inf


class Mode(NamedTuple):
    """A regime in numbers: J dw/dt = k_t i - b w - drag."""

    inertia: float  # kg*m^2 at the motor, infinite at rest
    drag: float  # N*m at the motor: friction and resistance


def modes(train: DriveTrain) -> tuple[Mode, ...]:
    """The five modes of a rigid drive train in the order of :class:`Regime`; at rest, friction balances the motor."""
    modes = [Mode(inf, 0.0)]
    for friction, resistance in ((train.friction, train.forward_torque), (-train.friction, train.backward_torque)):
        for share in train.shares:
            inertia = train.motor_inertia + train.load_inertia * share / train.ratio
            modes.append(Mode(inertia, friction + resistance * share))
    return tuple(modes)


def mechanics(spec: RobotSpec, drive_set: DriveParts) -> tuple[Mechanics, list[str]]:
    """Rotor, gears and load of a drive; inertias and a friction that are unknown are 0, and named."""
    own, shaft = drive_set.at_motor, at_shaft(spec)
    coulomb = 0.0 if drive_set.steps else own.coulomb  # a stepper's is in its pull-out torque
    inertias = {"brake": drive_set.brake_inertia, "gearhead": drive_set.gearhead.inertia}
    inertias |= {"encoder": drive_set.encoder.inertia} if drive_set.encoder else {}
    unknown = [f"inertia of the {part}" for part, inertia in inertias.items() if isnan(inertia)]
    unknown += ["friction of the motor"] * isnan(coulomb) + ["inertia of the load"] * isnan(shaft.inertia)
    rigid = Mechanics(
        friction=(0.0 if isnan(coulomb) else coulomb) + own.idle,
        motor_inertia=drive_set.inertia(unknown=0.0),
        gear_ratio=own.ratio,
        gear_efficiency=own.efficiency,
        belt_ratio=drive_set.belt_ratio,
        belt_efficiency=drive_set.belt_efficiency,
        load_inertia=0.0 if isnan(shaft.inertia) else shaft.inertia,
        radius=shaft.radius,
        forward_torque=shaft.forward_torque,
        backward_torque=shaft.backward_torque,
        rest_torque=shaft.rest_torque,
    )
    return rigid, [f"the {what} is unknown and taken as 0" for what in unknown]


def drive_train(spec: RobotSpec, drive_set: DriveParts, period: float) -> tuple[DriveTrain, list[str]]:
    """The rigid drive train of a spec and a drive, with the assumptions made."""
    motor, own = drive_set.motor, drive_set.at_motor
    if drive_set.steps:
        raise NoLoopError(f"motor {motor.part} is a stepper, which runs open-loop: it has no closed loop")
    require(drive_set, _NEEDED, "no closed loop without")
    rigid, unknown = mechanics(spec, drive_set)
    assumptions = [*unstated_temperature([motor.part] if isnan(motor.data_temperature) else []), *unknown]
    if isnan(own.viscous):
        assumptions.append("the viscous friction of the motor is unknown and taken as 0")
    resistance, inductance = float(resistance_25(motor)), motor.inductance
    if not inductance > 0.0:  # NaN too
        assumptions.append("the motor's inductance is unknown: the current follows the voltage at once")
        inductance = _NO_INDUCTANCE * period * resistance
    train = DriveTrain(
        **{f.name: getattr(rigid, f.name) for f in fields(rigid)},
        resistance=resistance,
        inductance=inductance,
        torque_constant=own.k_t,
        back_emf_constant=own.k_e,
        viscous=0.0 if isnan(own.viscous) else own.viscous,
        commutation=float(commutation(motor)),
    )
    if not all(isfinite(getattr(train, f.name)) for f in fields(train) if f.name != "stiffness"):
        raise InputError("the load's figures leave the range of numbers that can be computed with")
    return train, assumptions


def within_reach(train: Mechanics, profile: Profile) -> None:
    """Refuse a profile that is faster than any machine."""
    if not profile.top_speed * train.motor_per_speed <= _FASTEST:
        at_motor = profile.top_speed * train.motor_per_speed
        raise InputError(f"profile {profile.name}: {at_motor:.3g} rad/s is no speed that a motor can be turned to")


def require(drive_set: DriveParts, needed: Mapping[str, Sequence[str]], consequence: str) -> None:
    """Refuse a drive without figures that nothing can be simulated without."""
    for name, figures in needed.items():
        part = getattr(drive_set, name)
        missing = [figure.replace("_", " ") for figure in figures if not part[figure] > 0.0]
        if missing:
            raise NoLoopError(f"{name} {part.part}: {', '.join(missing)} not in the catalogue; {consequence}")


# -- A drive train as linear modes, discretised exactly for a voltage held over a step.
#
# Two plants: a rigid one (states i, w), and two masses with an elastic shaft between them (i, w, twist, v). Between
# changes of mode - a mass stops or starts, the power reverses, the shaft crosses its backlash - each is linear:
#
# .. math:: L \dot i = u - R i - k_e w, \quad J_m \dot w = k i - b_m w + m - s\,T, \quad
#           \dot\varphi = w / K - v, \quad J_l \dot v = T - l, \quad T = c\,\delta + d\,\dot\varphi
#
# with the share s = 1/(K e) of the shaft's torque T where the motor drives the load and e/K where the load drives
# the motor. The rigid plant is the same with v = w/K. **Stiffness, damping, backlash and twist are those of the
# driven shaft** (behind the gears, at the load); seen at the motor shaft a stiffness is smaller by K^2. Convention:
# forward is positive everywhere; a load torque is positive when it resists forward motion. Symbols: i current [A], w
# motor speed [rad/s], v speed of the load [rad/s], u voltage [V], m friction torque at the motor [N*m], l load
# torque [N*m], q charge [A*s], x motor angle [rad], K total ratio [1], e efficiency [1].


Array = NDArray[np.float64]

LEVELS = 11  # steps of a period, its half ... its 1024th part: a change of mode is met to that
_ORDER = 14  # of the series: (1/2)^15/15! is 2e-17
_NORM = 0.5  # of the matrix times the step, up to which the series is used


def columns(trains: Sequence[DriveTrain]) -> dict[str, Array]:
    """Drive trains as columns, by the names of their figures; total ratio, efficiency and shares among them."""
    names = [*(f.name for f in fields(DriveTrain)), "ratio", "efficiency"]
    figures = {name: np.array([getattr(train, name) for train in trains], float) for name in names}
    return figures | {"shares": np.array([train.shares for train in trains]).T}


def generators(machine: dict[str, Array], resistance: Array) -> Array:
    """Matrices G of dx/dt = G x in each mode, the inputs among the states (u, m constant, l a ramp)."""
    two = machine["stiffness"][0] < inf
    K, k, driven, zero = machine["ratio"], machine["torque_constant"], machine["load_inertia"], 0.0 * machine["ratio"]
    shares, L = machine["shares"], machine["inductance"][:, None]  # driving and braking
    count, u = (12, 6) if two else (3, 4)
    G = np.zeros((*resistance.shape, count, u + 4, u + 4))
    G[..., 0, 0] = (-resistance / L)[..., None]  # what all modes have: current, charge, angle, and the load's ramp
    G[..., 0, 1] = (-machine["back_emf_constant"][:, None] / L)[..., None]
    G[..., 0, u] = (1.0 / L)[..., None]
    G[..., u - 2, 0] = G[..., u - 1, 1] = G[..., u + 2, u + 3] = 1.0
    if not two:
        for mode, share in enumerate(shares, 1):
            J = machine["motor_inertia"] + driven * share / K
            row = (k, -machine["viscous"], zero, zero, zero, 1.0 + zero, -share, zero)
            G[:, :, mode, 1, :] = (np.array(row) / J).T[:, None, :]
        return G
    twist = np.array([zero, 1.0 / K, zero, zero - 1.0])  # of i, w, twist, v: the twist's rate
    G[..., 2, :4] = twist.T[:, None, None, :]
    shaft = machine["damping"] * twist + np.array([zero, zero, machine["stiffness"], zero])
    J_m = machine["motor_inertia"]
    for mode in range(count):
        torque = shaft * (mode // 4 > 0)  # in contact
        if mode & 1:
            own = np.array([k, -machine["viscous"], zero, zero]) - shares[mode // 8] * torque
            G[:, :, mode, 1, :4] = (own / J_m).T[:, None, :]
            G[:, :, mode, 1, 7] = (1.0 / J_m)[:, None]
        if mode & 2:
            G[:, :, mode, 3, :4] = (torque / driven).T[:, None, :]
            G[:, :, mode, 3, 8] = (-1.0 / driven)[:, None]
    return G


def discretised(machine: dict[str, Array], resistance: Array, period: Array) -> Array:
    """Exact discrete matrices of every mode, for a whole period and its halves down to the 1024th part.

    Notes
    -----
    Scaling and squaring of the exponential less one, F(2h) = 2 F + F^2: the digits of a slow state's small change
    are not lost beside 1 (C. Moler, C. Van Loan, SIAM Rev. 45 (2003) 3, method 3). All matrices of a batch are computed
    at once; ``scipy.linalg.expm`` loops over them, 11 exponentials per mode and node of temperature, and takes some
    hundred times as long (0.8 s instead of 1 ms for one rigid drive train). Against 60 digits both are right to 1e-15
    for a rigid drive train; where the inductance is unknown expm is closer, 1e-13 against 2e-12.
    """
    G = generators(machine, resistance)
    states = G.shape[-1] - 6
    small = np.ldexp(period, 1 - LEVELS)[:, None, None, None, None]
    # halvings of a step after which the series converges fast, in states scaled to equal energy
    J, driven = machine["motor_inertia"], machine["load_inertia"]
    scale = np.sqrt([machine["inductance"], J, machine["stiffness"], driven][:states])
    if states == 2:
        scale[1] = np.sqrt(J + driven * machine["efficiency"] / machine["ratio"] ** 2)
    scaled = np.abs(G[..., :states, :states] * small)
    scaled *= scale.T[:, None, None, :, None] / scale.T[:, None, None, None, :]
    norm = float(scaled.sum(axis=-1).max())
    squarings = max(0, int(np.ceil(np.log2(norm / _NORM)))) if 0.0 < norm < inf else 0
    A, identity = G * (small / 2.0**squarings), np.eye(states + 6)
    P = identity + A / _ORDER
    for k in range(_ORDER - 1, 1, -1):
        P = identity + A @ P / k
    F: Array = A @ P
    for _ in range(squarings):
        F = 2.0 * F + F @ F
    matrices = np.empty((*G.shape[:3], LEVELS, states + 2, states + 4))
    places = [*range(states), *range(states + 2, states + 6)]
    for level in range(LEVELS):
        matrices[..., level, :, :] = F[..., : states + 2, places]
        for state in range(states):
            matrices[..., level, state, state] += 1.0
        F = 2.0 * F + F @ F
    return matrices
