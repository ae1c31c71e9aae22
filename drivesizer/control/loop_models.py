r"""The DC motor with its load and the controllers around it, as models of python-control.

The motor's states are current and speed, [1]; behind an elastic shaft the load's speed and the twist follow:

.. math:: L \dot i = u - R i - k_e w, \quad J \dot w = k_t i - b w - m

It is sampled with the voltage held over a period; each controller takes one of its own periods to compute. The current
loop of a cascade is closed at its own rate; because the velocity loop holds its demand over n current periods, n of its
steps make exactly one of the velocity loop, and the same again from the velocity to the position loop [2]. Only the
limits, the friction's sign and the counts' steps are left out. A counted speed is the mean over the last n periods.

Every open loop has the inputs error, feedforward and load torque, and the outputs of ``OUTPUTS``, the last of which is
what is fed back.

Symbols: i current [A], w motor speed [rad/s], u voltage [V], m load torque at the motor [N*m], e efficiency, K total
ratio [1].

.. [1] P. C. Krause, O. Wasynczuk, S. D. Sudhoff, *Analysis of Electric Machinery*: the permanent-magnet DC machine.
.. [2] K. J. Åström, B. Wittenmark, *Computer-Controlled Systems*, 3rd ed., Prentice Hall 1997, ch. 2: sampled systems.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import control
import numpy as np

from drivesizer.control.drive_train import DriveTrain, Mode
from drivesizer.control.gains import COMPUTING
from drivesizer.control.validation import Cascade, Gains
from drivesizer.physics.belt import resonance as two_masses

System = Any  # a control.StateSpace, which carries no types
OUTPUTS = "current", "speed", "load_speed", "voltage", "angle"  # of the plant; angle: where it is wanted
_SPEED, _ANGLE = 1, 4


def dc_motor(train: DriveTrain, mode: Mode, *, angle: bool = False) -> System:
    """The DC motor with its gears and load in continuous time, linear about a moving point.

    With an elastic shaft the states are i, w, the load's speed and the twist as at the motor.
    """
    R, L, k_e, k_t, b = (train.resistance, train.inductance, train.back_emf_constant, train.torque_constant,
                         train.viscous)  # fmt: skip
    A = np.array([[-R / L, -k_e / L], [k_t / mode.inertia, -b / mode.inertia]])
    B = np.array([[1 / L, 0.0], [0.0, -1.0 / mode.inertia]])
    if train.flexible:
        J_M, J_L = train.motor_inertia, mode.inertia - train.motor_inertia
        share = J_L / train.load_inertia  # 1/(e K^2) or e/K^2: a stiffness goes to the motor as an inertia does
        c, d = train.stiffness * share, train.damping * share
        A = np.array([
            [-R / L, -k_e / L, 0.0, 0.0],
            [k_t / J_M, -(d + b) / J_M, d / J_M, -c / J_M],
            [0.0, d / J_L, -d / J_L, c / J_L],
            [0.0, 1.0, -1.0, 0.0],
        ])  # fmt: skip
        B = np.array([[1.0 / L, 0.0], [0.0, 0.0], [0.0, -1.0 / J_L], [0.0, 0.0]])
    n = len(A)
    C = np.vstack([np.eye(2, n), np.eye(1, n, n - 2 if train.flexible else 1), np.zeros((1, n))])
    if angle:
        A = np.block([[A, np.zeros((n, 1))], [np.eye(1, n, 1), 0.0]])
        B, C = np.vstack([B, np.zeros(2)]), np.block([[C, np.zeros((4, 1))], [np.zeros(n), 1.0]])
    D = np.zeros((len(C), 2))
    D[3, 0] = 1.0
    return control.ss(A, B, C, D)


@lru_cache(maxsize=16)  # gains are tried around one motor
def _sampled_motor(train: DriveTrain, mode: Mode, period: float) -> System:
    """The motor with its angle, its voltage and load torque held over each period."""
    return dc_motor(train, mode, angle=True).sample(period)


def pid(kp: float, ki: float, period: float, kd: float = 0.0, filter_time: float = 0.0) -> System:
    r"""A sampled PID with a filtered derivative, by backward differences.

    .. math:: k_p + k_i h \frac{z}{z - 1} + k_d \frac{z - 1}{(T_f + h) z - T_f}
    """
    whole = _gain([[kp]], period)
    if ki:
        whole += control.ss(control.tf([ki * period, 0.0], [1.0, -1.0], period))
    if kd:
        whole += control.ss(control.tf([kd, -kd], [filter_time + period, -filter_time], period))
    return whole


def closed(opened: System, fed_back: Sequence[float]) -> System:
    """The loop closed around an open one: its first input becomes the reference."""
    row = np.zeros((opened.ninputs, opened.noutputs))
    row[0, : len(fed_back)] = fed_back
    return control.feedback(opened, control.ss([], [], [], row, opened.dt))


def from_error(opened: System, answer: str = "speed") -> System:
    """An open loop without its other inputs and outputs."""
    return opened[[OUTPUTS.index(answer), opened.noutputs - 1], 0]


def _gain(values: Sequence[Sequence[float]] | np.ndarray, period: float) -> System:
    return control.ss([], [], [], values, period)


def _answered(controller: System, computing: float = COMPUTING) -> System:
    """From error, feedforward and load torque to demand and load torque: the controller computes for a period."""
    late = control.ss(0.0, 1.0, 1.0, 0.0, controller.dt) if computing else _gain([[1.0]], controller.dt)
    one, both = _gain([[1.0]], controller.dt), _gain([[1.0, 1.0]], controller.dt)
    return control.append(late * both * control.append(controller, one), one)


def _measured(held: System, periods: int, *, angle: bool = False) -> System:
    """A sampled motor whose last state is its angle, with one output more: its speed as it is measured."""
    n, h = (held.nstates, held.dt) if angle else (held.nstates - 1, held.dt)
    A, B, C = held.A[:n, :n], held.B[:n], held.C[:, :n]
    if not periods:
        return control.ss(A, B, np.vstack([C, C[_SPEED]]), np.vstack([held.D, held.D[_SPEED]]), h)
    last = np.eye(1, held.nstates, held.nstates - 1)[0]
    mean = (held.A[-1] - last)[:n] / h  # speed over the period, by the growth of the angle
    growth = control.ss(A, B, np.vstack([C, mean]), np.vstack([held.D, held.B[-1] / h]), h)
    counts = control.ss(np.eye(periods, k=-1), np.eye(periods, 1), np.full((1, periods), 1.0 / periods), 0.0, h)
    return control.append(_gain(np.eye(len(C)), h), counts) * growth


def _lifted(fast: System, steps: int, each: Sequence[int] = (), *, fine: bool = False) -> System:
    """A sampled system at the rate of a number of its steps [2]; exact."""
    held = [k for k in range(fast.ninputs) if k not in each]
    powers = [np.eye(fast.nstates)]
    for _ in range(steps):
        powers.append(fast.A @ powers[-1])

    def by_inputs(effect: list[np.ndarray]) -> np.ndarray:
        """Effects of the inputs of each step, side by side, those of the held ones added up."""
        return np.hstack([np.sum(effect, axis=0)[:, held], *(one[:, [*each]] for one in effect)])

    B = by_inputs([powers[steps - 1 - j] @ fast.B for j in range(steps)])
    none, shown = np.zeros(fast.D.shape), range(steps if fine else 1)
    D = [
        by_inputs([fast.C @ powers[i - 1 - j] @ fast.B if j < i else fast.D if j == i else none for j in range(steps)])
        for i in shown
    ]
    return control.ss(powers[steps], B, np.vstack([fast.C @ powers[i] for i in shown]), np.vstack(D), fast.dt * steps)


def voltage_open_loop(train: DriveTrain, mode: Mode, gains: Gains) -> System:
    """Open velocity loop that acts on the voltage, as figure 3 of the paper has it: PID, DC motor, encoder."""
    held = _sampled_motor(train, mode, gains.period)[: len(OUTPUTS) - 1, :]
    controller = pid(gains.kp, gains.ki, gains.period, gains.kd, gains.filter_time)
    return _measured(held, gains.counted_over) * _answered(controller)


def current_open_loop(train: DriveTrain, cascade: Cascade) -> System:
    """Open current loop with the rotor held: the back-EMF is a disturbance, as in the design."""
    R, L, period = train.resistance, train.inductance, cascade.current_period
    winding = control.ss(-R / L, 1.0 / L, 1.0, 0.0).sample(period)
    controller = _answered(pid(cascade.current_kp, cascade.current_ki, period))
    return winding * controller[0, 0]


def velocity_open_loop(
    train: DriveTrain, mode: Mode, cascade: Cascade, *, angle: bool = False, fine: bool = False
) -> System:
    """Open velocity loop around the closed current loop."""
    # the current loop from its demand and load torque, at the velocity loop's rate; back-EMF and all
    inner = _answered(pid(cascade.current_kp, cascade.current_ki, cascade.current_period))
    current = closed(_sampled_motor(train, mode, cascade.current_period) * inner, [1.0])
    lifted = _lifted(current[:, [0, 2]], cascade.current_steps, fine=fine)
    held = _measured(lifted, cascade.counted_over, angle=angle)
    kd, filter_time = cascade.velocity_kd, cascade.filter_time
    controller = pid(cascade.velocity_kp, cascade.velocity_ki, cascade.velocity_period, kd, filter_time)
    return held * _answered(controller, cascade.computing)


def position_open_loop(train: DriveTrain, mode: Mode, cascade: Cascade, *, fine: bool = False) -> System:
    """Open position loop around the closed velocity loop."""
    opened, n = velocity_open_loop(train, mode, cascade, angle=True, fine=fine), cascade.velocity_steps
    loop = closed(opened, [*[0.0] * (opened.noutputs - 1), 1.0])
    added = np.array([[1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]])  # to the speed reference
    slow = _lifted(loop * added, n, (1, 2, 3), fine=fine)
    rest = _gain(np.eye(3 * n), slow.dt)
    late = _answered(pid(cascade.position_kp, 0.0, slow.dt), cascade.computing)[0, 0]
    shown = np.vstack([np.eye(slow.noutputs), np.eye(1, slow.noutputs, OUTPUTS.index("angle"))])
    return _gain(shown, slow.dt) * slow * control.append(late, rest)


def resonance(train: DriveTrain, mode: Mode) -> tuple[float, float]:
    """Frequencies of the anti-resonance and the resonance of motor and load, undamped [Hz]."""
    found = two_masses(train.stiffness, train.load_inertia, mode.inertia / train.motor_inertia)
    return float(found.anti_resonance), float(found.resonance)
