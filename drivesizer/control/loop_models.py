r"""The loops of a servo cascade as sampled linear systems, exact for held voltages and demands.

Rigid plant: winding and one inertia. Two-mass plant: motor - shaft with a stiffness - load. Each is discretised for a
voltage held over a current period (zero-order hold). The current loop is closed at its own rate; because the velocity
loop holds its demand over n current periods, n of its steps make exactly one of the velocity loop:

.. math:: x_{k+1} = \Phi^n x_k + \Bigl(\sum_{m=0}^{n-1} \Phi^m\Bigr) \Gamma\, r_k

and the same again from the velocity to the position loop. Only the limits are neglected; each loop takes one of its
own periods to compute.

A counted speed is the mean over the last n periods of the velocity loop, by the exact growth of the angle in each.
Loops around it have two outputs, the speed and the counted speed; the second is fed back.

Symbols: i current [A], w motor speed [rad/s], u voltage [V], e efficiency, K total ratio [1].

.. [1] K. J. Åström, B. Wittenmark, *Computer-Controlled Systems*, 3rd ed., Prentice Hall 1997, ch. 2: sampled systems.
"""

from __future__ import annotations

import numpy as np

from drivesizer.control.cascade import Cascade
from drivesizer.control.drive_train import DriveTrain, Mode, matrices
from drivesizer.control.sampled import System, beside, delayed, fed_back, first_order, gain, in_series, sampled
from drivesizer.control.validation import Gains
from drivesizer.control.voltage_loop_design import COMPUTING
from drivesizer.physics.elements.belt import resonance as two_masses

__all__ = ["current_open_loop", "plant", "position_open_loop", "resonance", "velocity_open_loop", "voltage_open_loop"]


def resonance(train: DriveTrain, mode: Mode) -> tuple[float, float]:
    """Frequencies of the anti-resonance and the resonance of motor and load, undamped [Hz].

    Parameters
    ----------
    train, mode
        A drive train with an elastic shaft, and the direction of power: driving, the load's inertia counts 1/(e K^2),
        braking e/K^2.

    Returns
    -------
    tuple
        Anti-resonance, at which the load swings against a motor at rest, and resonance [Hz].
    """
    found = two_masses(train.stiffness, train.load_inertia, mode.inertia / train.motor_inertia)
    return float(found.anti_resonance), float(found.resonance)


def plant(train: DriveTrain, mode: Mode, *, angle: bool = False) -> System:
    """The drive train in continuous time, from voltage to current and motor speed, linearised about a moving point.

    Parameters
    ----------
    train, mode
        The drive train, rigid or elastic, and the direction of power.
    angle
        Whether the motor's angle is a third output.

    Returns
    -------
    System
        States i, w, then with a shaft the load's speed and the twist, both as at the motor, then the angle.
    """
    A, B = matrices(train, mode)
    if train.flexible:
        A, B = _two_masses(train, mode, A)
    C = np.eye(2, len(A))
    if angle:
        n = len(A)
        A = np.block([[A, np.zeros((n, 1))], [np.eye(1, n, 1), np.zeros((1, 1))]])
        B, C = np.vstack([B, [[0.0]]]), np.block([[C, np.zeros((2, 1))], [np.zeros((1, n)), np.ones((1, 1))]])
    return System(A, B, C, np.zeros((len(C), 1)), 0.0)


def _two_masses(train: DriveTrain, mode: Mode, rigid: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """State matrices of motor and load; states i, w, the load's speed and the twist as at the motor."""
    J_M, J_L = train.motor_inertia, mode.inertia - train.motor_inertia
    share = J_L / train.load_inertia  # 1/(e K^2) or e/K^2: a stiffness goes to the motor as an inertia does
    c, d = train.stiffness * share, train.damping * share
    A = np.array(
        [
            [rigid[0, 0], rigid[0, 1], 0.0, 0.0],
            [train.torque_constant / J_M, -(d + train.viscous) / J_M, d / J_M, -c / J_M],
            [0.0, d / J_L, -d / J_L, c / J_L],
            [0.0, 1.0, -1.0, 0.0],
        ]
    )
    return A, np.array([[1.0 / train.inductance], [0.0], [0.0], [0.0]])


def _pid(kp: float, ki: float, period: float, kd: float = 0.0, filter_time: float = 0.0) -> System:
    """A sampled PID with a filtered derivative, one period late for its computation."""
    found = gain(kp, period)
    if ki:
        found = beside(found, first_order(ki * period, 0.0, 1.0, period))
    if kd:
        filtered = filter_time + period
        found = beside(found, first_order(kd / filtered, -kd / filtered, filter_time / filtered, period))
    return in_series(delayed(round(COMPUTING), period), found)


def _lifted(fast: System, steps: int) -> System:
    """A sampled system with its input held over a number of its steps, at the slower rate [1]; exact."""
    n, held = fast.states, fast.B.shape[1]
    many = np.linalg.matrix_power(np.block([[fast.A, fast.B], [np.zeros((held, n)), np.eye(held)]]), steps)
    return System(many[:n, :n], many[:n, n:], fast.C, fast.D, fast.dt * steps)


def _counted(held: System, periods: int, row: int, *, angle: bool = False) -> System:
    """A sampled drive train whose last state is its angle, with two outputs: one of its own, and the counted speed.

    Parameters
    ----------
    held
        The drive train, sampled once in a period of the velocity loop.
    periods
        Over which counts are taken.
    row
        The output that is kept.
    angle
        Whether the angle is kept as a state; a speed needs none, and would get an uncontrollable pole.
    """
    n = held.states if angle else held.states - 1
    grows = (held.A[-1] - np.eye(1, held.states, held.states - 1)[0])[:n] / held.dt
    first, shift = np.eye(periods, 1), np.eye(periods, k=-1)
    A = np.block([[held.A[:n, :n], np.zeros((n, periods))], [first * grows, shift]])
    B = np.vstack([held.B[:n], first * held.B[-1] / held.dt])
    C = np.vstack(
        [np.append(held.C[row, :n], np.zeros(periods)), np.append(np.zeros(n), np.full(periods, 1 / periods))]
    )
    return System(A, B, C, np.zeros((2, 1)), held.dt)


def voltage_open_loop(train: DriveTrain, mode: Mode, gains: Gains) -> System:
    """Open velocity loop that acts on the voltage: from the speed error to the motor's speed.

    Parameters
    ----------
    train, mode
        The drive train, rigid or elastic, and the direction of power.
    gains
        The voltage PID.

    Returns
    -------
    System
        Sampled; with a counted speed two outputs, of which the second is fed back.
    """
    counted = gains.counted_over
    held = sampled(plant(train, mode, angle=counted > 0), gains.period)
    forward = _counted(held, counted, 1) if counted else held.output(1)
    return in_series(forward, _pid(gains.kp, gains.ki, gains.period, gains.kd, gains.filter_time))


def current_open_loop(train: DriveTrain, cascade: Cascade) -> System:
    """Open current loop with the rotor held: the back-EMF is a disturbance, as in the design.

    Parameters
    ----------
    train
        The drive train, with the resistance and inductance of its winding.
    cascade
        The controller.

    Returns
    -------
    System
        Sampled, from the current error to the current.
    """
    R, L, period = train.resistance, train.inductance, cascade.current_period
    winding = System(np.array([[-R / L]]), np.array([[1.0 / L]]), np.eye(1), np.zeros((1, 1)), 0.0)
    return in_series(sampled(winding, period), _pid(cascade.current_kp, cascade.current_ki, period))


def _current_closed(train: DriveTrain, mode: Mode, cascade: Cascade, angle: bool) -> System:
    """From the current demand to current, speed (and angle), at the rate of the velocity loop; back-EMF and all."""
    period = cascade.current_period
    held = sampled(plant(train, mode, angle=angle), period)
    forward = in_series(held, _pid(cascade.current_kp, cascade.current_ki, period))
    return _lifted(fed_back(forward, np.eye(len(forward.C))[0]), cascade.current_steps)


def velocity_open_loop(train: DriveTrain, mode: Mode, cascade: Cascade) -> System:
    """Open velocity loop around the closed current loop: from the speed error to the motor's speed.

    Parameters
    ----------
    train, mode
        The drive train, rigid or elastic, and the direction of power.
    cascade
        The controller.

    Returns
    -------
    System
        Sampled; with a counted speed two outputs, of which the second is fed back.
    """
    counted = cascade.counted_over
    held = _current_closed(train, mode, cascade, angle=counted > 0)
    return in_series(_counted(held, counted, 1) if counted else held.output(1), _velocity_pid(cascade))


def _velocity_pid(cascade: Cascade) -> System:
    kd, filter_time = cascade.velocity_kd, cascade.filter_time
    return _pid(cascade.velocity_kp, cascade.velocity_ki, cascade.velocity_period, kd, filter_time)


def position_open_loop(train: DriveTrain, mode: Mode, cascade: Cascade) -> System:
    """Open position loop around the closed velocity loop: from the position error to the motor's angle.

    Parameters
    ----------
    train, mode
        The drive train, rigid or elastic, and the direction of power.
    cascade
        The controller.

    Returns
    -------
    System
        Sampled at the position loop's period.
    """
    held = _current_closed(train, mode, cascade, angle=True)
    # outputs: angle, and the speed that is fed back
    forward = _counted(held, cascade.counted_over, 2, angle=True) if cascade.counted_over else held.output(2, 1)
    closed = _lifted(fed_back(in_series(forward, _velocity_pid(cascade)), [0.0, 1.0]), cascade.velocity_steps)
    return in_series(closed.output(0), _pid(cascade.position_kp, 0.0, cascade.position_period))
