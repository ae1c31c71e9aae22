r"""A drive train as linear modes, discretised exactly for a voltage held over a step.

Two plants: a rigid one (states i, w), and two masses with an elastic shaft between them (i, w, twist, v). Between
changes of mode - a mass stops or starts, the power reverses, the shaft crosses its backlash - each is linear:

.. math:: L \dot i = u - R i - k_e w, \quad J_m \dot w = k i - b_m w + m - s\,T, \quad
          \dot\varphi = w / K - v, \quad J_l \dot v = T - b_l v - l, \quad T = c\,\delta + d\,\dot\varphi

with the share s = 1/(K e) of the shaft's torque T where the motor drives the load and e/K where the load drives the
motor. The rigid plant is the same with v = w/K. **Stiffness, damping, backlash and twist are those of the driven
shaft** (behind the gears, at the load); seen at the motor shaft a stiffness is smaller by K^2.
Convention: forward is positive everywhere; a load torque is positive when it resists forward motion.
Symbols: i current [A], w motor speed [rad/s], v speed of the load [rad/s], u voltage [V], m friction torque at the
motor [N*m], l load torque [N*m], q charge [A*s], x motor angle [rad], K total ratio [1], e efficiency [1].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from math import inf

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.drive_train import DriveTrain

__all__ = ["LEVELS", "columns", "discretised", "generators"]

Array = NDArray[np.float64]

LEVELS = 11  # steps of a period, its half ... its 1024th part: a change of mode is met to that
_ORDER = 14  # of the series: (1/2)^15/15! is 2e-17
_NORM = 0.5  # of the matrix times the step, up to which the series is used


def columns(trains: Sequence[DriveTrain]) -> dict[str, Array]:
    """Drive trains as columns, by the names of their figures; total ratio and efficiency among them."""
    names = [*(f.name for f in fields(DriveTrain)), "ratio", "efficiency"]
    return {name: np.array([getattr(train, name) for train in trains], float) for name in names}


def generators(machine: dict[str, Array], resistance: Array) -> Array:
    """Matrices G of dx/dt = G x in each mode, the inputs among the states (u, m constant, l a ramp)."""
    return _flexible(machine, resistance) if machine["stiffness"][0] < inf else _rigid(machine, resistance)


def _shares(machine: dict[str, Array]) -> tuple[Array, Array]:
    """Share of the driven shaft's torque that the motor feels, driving and braking."""
    return 1.0 / (machine["ratio"] * machine["efficiency"]), machine["efficiency"] / machine["ratio"]


def _winding(G: Array, machine: dict[str, Array], resistance: Array, u: int) -> None:
    """Fill the rows that all modes have: current, charge, angle, and the ramp of the load."""
    L = machine["inductance"][:, None]
    q = u - 2
    G[..., 0, 0] = (-resistance / L)[..., None]
    G[..., 0, 1] = (-machine["back_emf_constant"][:, None] / L)[..., None]
    G[..., 0, u] = (1.0 / L)[..., None]
    G[..., q, 0] = G[..., q + 1, 1] = G[..., u + 2, u + 3] = 1.0


def _rigid(machine: dict[str, Array], resistance: Array) -> Array:
    K, driven = machine["ratio"], machine["load_inertia"]
    G = np.zeros((*resistance.shape, 3, 8, 8))
    _winding(G, machine, resistance, 4)
    for mode, share in enumerate(_shares(machine), 1):
        J = machine["motor_inertia"] + driven * share / K
        drag = machine["viscous"] + share * machine["load_viscous"] / K
        row = (machine["torque_constant"], -drag, 0 * J, 0 * J, 0 * J, 1 + 0 * J, -share, 0 * J)
        G[:, :, mode, 1, :] = (np.array(row) / J).T[:, None, :]
    return G


def _flexible(machine: dict[str, Array], resistance: Array) -> Array:
    G = np.zeros((*resistance.shape, 12, 10, 10))
    _winding(G, machine, resistance, 6)
    K, zero = machine["ratio"], 0.0 * machine["ratio"]
    twist = np.array([zero, 1.0 / K, zero, zero - 1.0])  # of i, w, twist, v: the twist's rate
    G[..., 2, :4] = twist.T[:, None, None, :]
    shaft = machine["damping"] * twist + np.array([zero, zero, machine["stiffness"], zero])
    k, J_m, J_l = machine["torque_constant"], machine["motor_inertia"], machine["load_inertia"]
    for mode in range(12):
        contact, share = mode // 4, _shares(machine)[mode // 8]
        torque = shaft * (contact > 0)
        if mode & 1:
            own = np.array([k, -machine["viscous"], zero, zero]) - share * torque
            G[:, :, mode, 1, :4] = (own / J_m).T[:, None, :]
            G[:, :, mode, 1, 7] = (1.0 / J_m)[:, None]
        if mode & 2:
            own = torque - np.array([zero, zero, zero, machine["load_viscous"]])
            G[:, :, mode, 3, :4] = (own / J_l).T[:, None, :]
            G[:, :, mode, 3, 8] = (-1.0 / J_l)[:, None]
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
    squarings = _squarings(machine, G[..., :states, :states] * small)
    F = _expm1(G * (small / 2.0**squarings), squarings)
    found = np.empty((*G.shape[:3], LEVELS, states + 2, states + 4))
    kept = [*range(states), *range(states + 2, states + 6)]
    for level in range(LEVELS):
        found[..., level, :, :] = F[..., : states + 2, kept]
        for state in range(states):
            found[..., level, state, state] += 1.0
        F = 2.0 * F + F @ F
    return found


def _squarings(machine: dict[str, Array], A: Array) -> int:
    """Halvings of a step after which the series converges fast, in states scaled to equal energy."""
    L, J, K = machine["inductance"], machine["motor_inertia"], machine["ratio"]
    scale = np.array([np.sqrt(L), np.sqrt(J), *_load_scales(machine)][: A.shape[-1]])
    if A.shape[-1] == 2:
        scale[1] = np.sqrt(J + machine["load_inertia"] * machine["efficiency"] / K**2)
    scaled = np.abs(A) * scale.T[:, None, None, :, None] / scale.T[:, None, None, None, :]
    norm = float(scaled.sum(axis=-1).max())
    return max(0, int(np.ceil(np.log2(norm / _NORM)))) if 0.0 < norm < inf else 0


def _load_scales(machine: dict[str, Array]) -> tuple[Array, Array]:
    return np.sqrt(machine["stiffness"]), np.sqrt(machine["load_inertia"])


def _expm1(A: Array, squarings: int) -> Array:
    """Exponential of matrices, less one: a series, then squared."""
    one = np.eye(A.shape[-1])
    P = one + A / _ORDER
    for k in range(_ORDER - 1, 1, -1):
        P = one + A @ P / k
    F: Array = A @ P
    for _ in range(squarings):
        F = 2.0 * F + F @ F
    return F
