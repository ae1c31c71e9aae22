r"""The loops of a drive as models of python-control: their analysis, and gains designed until margins are met.

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

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import control
import numpy as np
from numpy.typing import NDArray
from scipy.linalg import schur

from drivesizer.catalog import EDGES
from drivesizer.control.drive_train import DriveTrain, Mode, Regime, drive_train, modes
from drivesizer.control.gains import COMPUTING, RESONANCE_SHARE, SPREAD, design, design_cascade, margin_of
from drivesizer.control.validation import LEAST_PHASE_MARGIN, Bode, Cascade, Gains, Loop, Loops, Rates, rates
from drivesizer.errors import InputError
from drivesizer.physics.belt import resonance as two_masses
from drivesizer.physics.counted_speed import MOST_PERIODS, Counts, answer
from drivesizer.results.drive_set import DriveParts
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

System = Any  # a control.StateSpace, which carries no types
OUTPUTS = "current", "speed", "load_speed", "voltage", "angle"  # of the plant; angle: where it is wanted
_SPEED = OUTPUTS.index("speed")


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
    through, adder = _gain([[1.0]], controller.dt), _gain([[1.0, 1.0]], controller.dt)
    return control.append(late * adder * control.append(controller, through), through)


def _measured(motor: System, periods: int, *, angle: bool = False) -> System:
    """A sampled motor whose last state is its angle, with one output more: its speed as it is measured."""
    n, h = (motor.nstates, motor.dt) if angle else (motor.nstates - 1, motor.dt)
    A, B, C = motor.A[:n, :n], motor.B[:n], motor.C[:, :n]
    if not periods:
        return control.ss(A, B, np.vstack([C, C[_SPEED]]), np.vstack([motor.D, motor.D[_SPEED]]), h)
    last = np.eye(1, motor.nstates, motor.nstates - 1)[0]
    mean = (motor.A[-1] - last)[:n] / h  # speed over the period, by the growth of the angle
    growth = control.ss(A, B, np.vstack([C, mean]), np.vstack([motor.D, motor.B[-1] / h]), h)
    counts = control.ss(np.eye(periods, k=-1), np.eye(periods, 1), np.full((1, periods), 1.0 / periods), 0.0, h)
    return control.append(_gain(np.eye(len(C)), h), counts) * growth


def _lifted(fast: System, steps: int, fast_inputs: Sequence[int] = (), *, fine: bool = False) -> System:
    """A sampled system at the rate of a number of its steps [2]; exact."""
    slow_inputs = [k for k in range(fast.ninputs) if k not in fast_inputs]
    powers = [np.eye(fast.nstates)]
    for _ in range(steps):
        powers.append(fast.A @ powers[-1])

    def by_inputs(effect: list[np.ndarray]) -> np.ndarray:
        """Effects of the inputs of each step, side by side, those of the held ones added up."""
        return np.hstack([np.sum(effect, axis=0)[:, slow_inputs], *(matrix[:, [*fast_inputs]] for matrix in effect)])

    B = by_inputs([powers[steps - 1 - j] @ fast.B for j in range(steps)])
    none, output_steps = np.zeros(fast.D.shape), range(steps if fine else 1)
    D = [
        by_inputs([fast.C @ powers[i - 1 - j] @ fast.B if j < i else fast.D if j == i else none for j in range(steps)])
        for i in output_steps
    ]
    return control.ss(
        powers[steps], B, np.vstack([fast.C @ powers[i] for i in output_steps]), np.vstack(D), fast.dt * steps
    )


def voltage_open_loop(train: DriveTrain, mode: Mode, gains: Gains) -> System:
    """Open velocity loop that acts on the voltage, as figure 3 of the paper has it: PID, DC motor, encoder."""
    motor = _sampled_motor(train, mode, gains.period)[: len(OUTPUTS) - 1, :]
    controller = pid(gains.kp, gains.ki, gains.period, gains.kd, gains.filter_time)
    return _measured(motor, gains.counted_over) * _answered(controller)


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
    plant = _measured(lifted, cascade.counted_over, angle=angle)
    kd, filter_time = cascade.velocity_kd, cascade.filter_time
    controller = pid(cascade.velocity_kp, cascade.velocity_ki, cascade.velocity_period, kd, filter_time)
    return plant * _answered(controller, cascade.computing)


def position_open_loop(train: DriveTrain, mode: Mode, cascade: Cascade, *, fine: bool = False) -> System:
    """Open position loop around the closed velocity loop."""
    opened, n = velocity_open_loop(train, mode, cascade, angle=True, fine=fine), cascade.velocity_steps
    loop = closed(opened, [*[0.0] * (opened.noutputs - 1), 1.0])
    added = np.array([[1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]])  # to the speed reference
    slow = _lifted(loop * added, n, (1, 2, 3), fine=fine)
    rest = _gain(np.eye(3 * n), slow.dt)
    late = _answered(pid(cascade.position_kp, 0.0, slow.dt), cascade.computing)[0, 0]
    outputs = np.vstack([np.eye(slow.noutputs), np.eye(1, slow.noutputs, OUTPUTS.index("angle"))])
    return _gain(outputs, slow.dt) * slow * control.append(late, rest)


def resonance(train: DriveTrain, mode: Mode) -> tuple[float, float]:
    """Frequencies of the anti-resonance and the resonance of motor and load, undamped [Hz]."""
    frequencies = two_masses(train.stiffness, train.load_inertia, mode.inertia / train.motor_inertia)
    return float(frequencies.anti_resonance), float(frequencies.resonance)


# -- Linear analysis of a sampled loop: poles, margins, bandwidth, step response, Bode data.
#
# The loops are systems of python-control, which closes them and gives poles, gain at rest
# and step response. Both directions of power are analysed; a loop's record is that of the direction nearer to
# instability, its margins and bandwidth the least of both. Margins and bandwidth are roots on the frequency response
# itself, on a grid that is finer around every pole near the unit circle: ``control.stability_margins`` makes
# polynomials of a state space, which are ill-conditioned for slow loops.
#
# .. [1] K. J. Åström, T. Hägglund, *PID Controllers: Theory, Design, and Tuning*, 2nd ed., ISA 1995, ch. 4: margins,
#    maximum sensitivity.


Array = NDArray[np.float64]
_Values = NDArray[np.complex128]
_POINTS = 1500
_DECADES = 6.0  # below the Nyquist frequency
_MOST_SAMPLES = 20_000  # of a step response
_PARTS, _TIMES = 50, 3  # a step of the grid, which is 1 %, down to 1e-7; the rest of it is straight
_SETTLED = 0.02  # of the final value
_DIRECTIONS = {"driving": Regime.FORWARD_DRIVING, "braking": Regime.FORWARD_BRAKING}


def analyse(train: DriveTrain, controller: Cascade | Gains) -> Loops:
    """The loops of a controller around a drive train, rigid or with an elastic shaft.

    Parameters
    ----------
    train, controller
        The drive train, rigid or elastic, and its controller; feedforward is left out.

    Returns
    -------
    Loops
        From the inside out.
    """
    loops: dict[str, Any] = {name: _worse(name, opened) for name, opened in opened_loops(train, controller).items()}
    if not train.flexible:
        return Loops(**loops, rigid_bandwidth=loops["velocity"].bandwidth)
    # braking, the load's inertia counts less: that resonance is the lower one
    low, high = resonance(train, modes(train)[Regime.FORWARD_BRAKING])
    rigid = _worse("velocity", opened_loops(replace(train, stiffness=math.inf), controller)["velocity"])
    return Loops(**loops, anti_resonance=low, resonance=high, rigid_bandwidth=rigid.bandwidth)


def opened_loops(train: DriveTrain, controller: Cascade | Gains) -> dict[str, dict[str, System]]:
    """The open loops of a controller by name and direction of power."""
    all_modes, names = modes(train), ("velocity", "position")[: 2 if controller.velocity_steps else 1]
    outer = {
        name: {
            direction: open_loop(name, train, all_modes[regime], controller)
            for direction, regime in _DIRECTIONS.items()
        }
        for name in names
    }
    return ({"current": {"": current_open_loop(train, controller)}} if isinstance(controller, Cascade) else {}) | outer


def open_loop(name: str, train: DriveTrain, mode: Mode, controller: Cascade | Gains) -> System:
    """The open velocity or position loop of a controller."""
    if isinstance(controller, Gains):
        return from_error(voltage_open_loop(train, mode, controller))
    if name == "position":
        return from_error(position_open_loop(train, mode, controller), "angle")
    return from_error(velocity_open_loop(train, mode, controller))


def _worse(name: str, opened: Mapping[str, System]) -> Loop:
    """Of driving and braking the loop nearer to instability, with the least margins and bandwidth of both."""
    loops = [loop_of(name, system, direction) for direction, system in opened.items()]
    unstable = [loop for loop in loops if not loop.stable]
    if unstable:  # it has no margins, whatever the other direction's are
        return max(unstable, key=lambda loop: loop.pole_radius)
    worst = max(loops, key=lambda loop: loop.sensitivity)
    least: dict[str, Any] = {
        figure: min((f for loop in loops if math.isfinite(f := getattr(loop, figure))), default=math.nan)
        for figure in ("gain_margin", "phase_margin", "bandwidth")
    }
    return replace(worst, **least)


class _Response:
    """A loop with unit feedback: the closed one's poles, and both responses on a grid and between its points."""

    def __init__(self, opened: System) -> None:
        last = [*[0.0] * (opened.noutputs - 1), 1.0]
        self.whole = closed(opened[:, 0], last)[0, 0]  # from the reference to the first output
        self.poles = tuple(complex(p) for p in self.whole.poles())
        self.radius = max((abs(p) for p in self.poles), default=0.0)
        self.final = float(np.real(self.whole.dcgain(warn_infinite=False)))
        self.values = frequency_response(opened)
        # up to the Nyquist frequency [rad/s], finer around the poles that ring, and not on the pole itself
        nyquist = math.pi / opened.dt
        even, around = np.geomspace(nyquist * 10.0**-_DECADES, nyquist, _POINTS), np.geomspace(1e-7, 0.1, 40)
        rings = [abs(np.angle(p)) / opened.dt for p in (*self.poles, *opened.poles()) if p.imag > 0.0 and abs(p) > 0.5]
        grid = np.unique(np.concatenate([even, *(w * (1.0 + sign * around) for w in rings for sign in (-1.0, 1.0))]))
        self.w = grid[(grid >= even[0]) & (grid <= nyquist)]

    def opening(self, w: Array) -> _Values:
        """The open loop."""
        return np.asarray(self.values(w)[-1])

    def closing(self, w: Array) -> _Values:
        """The closed one."""
        response = self.values(w)
        return np.asarray(response[0] / (1.0 + response[-1]))

    def crossings(
        self, response: Callable[[Array], _Values], figure: Callable[[_Values], Array]
    ) -> list[tuple[float, complex]]:
        """Angular frequency [rad/s] and response wherever a figure of a response changes sign, to 1e-12.

        Of equal parts of a step of the grid the one that has it, again and again: of all steps at once, for the
        response of a long delay has a hundred such places.
        """
        sampled = figure(response(self.w))
        below = sampled < 0.0  # a figure that is 0 on the grid counts with those above: its crossing is found once
        before = np.flatnonzero(below[:-1] != below[1:])
        if not len(before):
            return []
        ends, values = self.w[np.stack([before, before + 1])], sampled[np.stack([before, before + 1])]
        for _ in range(_TIMES):
            places = np.linspace(ends[0], ends[1], _PARTS + 1)
            inside = figure(response(places[1:-1].ravel())).reshape(_PARTS - 1, -1)
            levels = np.concatenate([values[:1], inside, values[1:]])
            after = np.argmax((levels < 0.0) != (levels[0] < 0.0), axis=0)
            rows = np.stack([after - 1, after])
            ends, values = np.take_along_axis(places, rows, 0), np.take_along_axis(levels, rows, 0)
        at = ends[0] - values[0] * (ends[1] - ends[0]) / (values[1] - values[0])
        return [*zip(at.tolist(), response(at).tolist(), strict=True)]

    def phase_margin(self) -> tuple[float, float]:
        """Phase margin [rad] and its crossover [Hz]; NaN: the gain never is 1."""
        phases = [
            (math.pi - abs(math.remainder(math.atan2(z.imag, z.real), 2.0 * math.pi)), at / (2.0 * math.pi))
            for at, z in self.crossings(self.opening, lambda z: np.abs(z) - 1.0)
        ]
        return min(phases, default=(math.nan, math.nan))

    def bandwidth(self) -> float:
        """Frequency at which the closed loop first is 3 dB below its value at rest [Hz]; NaN: nowhere."""
        level = abs(self.final) / math.sqrt(2.0)
        if not (math.isfinite(level) and level > 0.0 and abs(self.closing(self.w[:1])[0]) > level):
            return math.nan
        crossings = self.crossings(self.closing, lambda z: np.abs(z) - level)
        return crossings[0][0] / (2.0 * math.pi) if crossings else math.nan


def loop_of(name: str, opened: System, direction: str = "") -> Loop:
    """All figures of a loop with unit feedback."""
    seen, figures = _Response(opened), dict[str, Any]()
    L, T, stable = seen.opening(seen.w), seen.closing(seen.w), seen.radius < 1.0
    if stable:
        real = [z.real for _, z in seen.crossings(seen.opening, lambda z: z.imag)]
        real.append(float(L[-1].real))  # at the Nyquist frequency the response is real
        factors = [-1.0 / x for x in real if x < 0.0]
        figures["gain_margin"] = min((f for f in factors if f > 1.0), default=math.nan)
        figures["gain_reduction"] = max((f for f in factors if f < 1.0), default=math.nan)
        figures["phase_margin"], figures["crossover"] = seen.phase_margin()
        figures["bandwidth"] = seen.bandwidth()
        # until the slowest pole has decayed to 1e-4, or the most samples
        samples = 100 + math.ceil(math.log(1e-4) / math.log(min(max(seen.radius, 0.1), 1.0 - 1e-9)))
        time = np.arange(min(samples, _MOST_SAMPLES)) * opened.dt
        figures["step"] = np.asarray(control.step_response(seen.whole, time).outputs)
        figures |= _answer(figures["step"], seen.final, opened.dt)
    return Loop(
        name=name,
        direction=direction,
        period=float(opened.dt),
        stable=stable,
        pole_radius=seen.radius,
        poles=seen.poles,
        sensitivity=float(np.max(1.0 / np.abs(1.0 + L))),
        bode=Bode(
            frequency=seen.w / (2.0 * math.pi),
            open_magnitude=np.abs(L),
            open_phase=np.unwrap(np.angle(L)),
            closed_magnitude=np.abs(T),
            closed_phase=np.unwrap(np.angle(T)),
        ),
        **figures,
    )


def margin_and_bandwidth(opened: System) -> tuple[float, float]:
    """Phase margin [rad] and bandwidth [Hz] alone: NaN of an unstable loop, infinite where the gain never reaches 1."""
    seen = _Response(opened)
    if seen.radius >= 1.0:
        return math.nan, math.nan
    phase, _ = seen.phase_margin()
    return math.inf if math.isnan(phase) else phase, seen.bandwidth()


def frequency_response(system: System) -> Callable[[Array], _Values]:
    r"""The transfer functions from the first input on the unit circle; no number at a pole.

    .. math:: C (z I - A)^{-1} B + D

    by the Schur form of A (A. J. Laub, IEEE Trans. Autom. Control 26 (1981) 407-408), for all frequencies at once:
    python-control takes them one by one, 50 times as long.
    """
    n = system.nstates
    U, Z = schur(system.A, output="complex") if n else (np.zeros((0, 0), complex),) * 2
    b, C = Z.conj().T @ system.B[:, 0], system.C @ Z

    def response(w: Array) -> _Values:
        z, x = np.exp(1j * w * system.dt), np.zeros((n, len(w)), complex)
        with np.errstate(all="ignore"):
            for k in reversed(range(n)):
                x[k] = (b[k] + np.einsum("j,jw->w", U[k, k + 1 :], x[k + 1 :])) / (z - U[k, k])
            return np.asarray(np.einsum("yj,jw->yw", C, x) + system.D[:, :1])

    return response


def _answer(step: Array, final: float, period: float) -> dict[str, float]:
    """Rise time [s], overshoot and settling time [s] of a step; NaN where a level is not reached.

    Between samples a level is met by a straight line; python-control's ``step_info`` has whole samples.
    """
    if not (math.isfinite(final) and abs(final) > 1e-9):
        return {}
    y = step / final
    outside = np.flatnonzero(np.abs(y - 1.0) > _SETTLED)
    settled = int(outside[-1]) + 1 if len(outside) else 0

    def reached(level: float) -> float:  # samples
        n = int(np.argmax(y >= level))
        if y[n] < level:
            return math.nan
        return n - float((y[n] - level) / (y[n] - y[n - 1])) if n else 0.0

    rise, settling = (reached(0.9) - reached(0.1)) * period, settled * period if settled < len(y) else math.nan
    return {"rise_time": rise, "overshoot": max(float(y.max()) - 1.0, 0.0), "settling_time": settling}


# -- Designed gains checked on the sampled loop: made slower until every required margin is met, or refused.
#
# The rules of ``gains`` place a bandwidth by lags and delays. The result is
# checked on the loop itself, sampled, delayed, with its counted speed, in both directions of power: the phase
# margin, and with an elastic shaft the distance to the resonance [1]. In the backlash the motor turns alone, as on a
# shaft of no stiffness; any stiffness between none and that in contact may describe it [2], and both ends must hold.
#
# .. [1] G. Ellis, *Control System Design Guide*, 4th ed., Elsevier 2012, ch. 16: resonance and the loop's bandwidth.
# .. [2] M. Nordin, P.-O. Gutman, "Controlling mechanical systems with backlash - a survey", Automatica 38 (2002)
#    1633-1649: describing functions.


_SLOWEST = 2.0**12  # factor beyond which no slower loop is tried
_CLOSE = 1.01  # to which factor the slower loop is sought


def tuned(
    make: Callable[[float], Gains | Cascade], train: DriveTrain, margin: float
) -> tuple[Gains | Cascade, float, str]:
    """The fastest controller around a drive train with a phase margin [rad], the factor by which it is slower, and why.

    Slower than its design rule, which misses a margin.
    """
    controller = make(1.0)
    why = flaw(controller, train, margin)
    if not why:
        return controller, 1.0, ""
    low = high = 1.0
    while flaw(make(high), train, margin):
        low, high = high, 2.0 * high
        if high > _SLOWEST:
            raise InputError(f"control: gains designed by rule miss their margins, however slow: {why}")
    while high / low > _CLOSE:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if flaw(make(middle), train, margin) else (low, middle)
    return make(high), high, why


def flaw(controller: Gains | Cascade, train: DriveTrain, least: float) -> str:
    """The first margin that a loop misses, in words."""
    for name, opened in _checked(controller, train):
        margin, bandwidth = margin_and_bandwidth(opened)
        if math.isnan(margin):
            return f"the {name} is unstable"
        if margin < least:
            has, wants = (f"{math.degrees(angle):.3g}°" for angle in (margin, least))
            return f"the {name} has {has} of phase margin, less than {wants}"
        if "stiff" in name:
            most = RESONANCE_SHARE * resonance(train, modes(train)[Regime.FORWARD_BRAKING])[1]
            if bandwidth > most:
                hertz, share = (show(f, "Hz", "frequency", 3) for f in (bandwidth, most))
                return f"the {name} has a bandwidth of {hertz}, above {share}, a fifth of the resonance"
    return ""


def _checked(controller: Gains | Cascade, train: DriveTrain) -> Iterator[tuple[str, System]]:
    """The loops to be checked, with their names."""
    all_modes, rigid = modes(train), replace(train, stiffness=math.inf)
    for direction, regime in _DIRECTIONS.items():
        if train.flexible:
            stiff = open_loop("velocity", rigid, all_modes[regime], controller)
            yield f"velocity loop with a stiff shaft, {direction},", stiff
        yield f"velocity loop, {direction},", open_loop("velocity", train, all_modes[regime], controller)
        if controller.velocity_steps:
            yield f"position loop, {direction},", open_loop("position", train, all_modes[regime], controller)
    if train.flexible and train.gap:
        alone = open_loop("velocity", rigid, Mode(inertia=train.motor_inertia, drag=train.friction), controller)
        yield "velocity loop of the motor alone, in the backlash,", alone


# -- The controller of a drive: its rates and its encoder, gains by rule, checked on the sampled loop.
#
# Rates are those of the spec, else the catalogue's. Speed is that of the encoder's counts where the drive has an
# encoder whose lines are known.


_PERIOD = 1e-3  # s, of a velocity loop on the voltage, where the controller's is unknown


def designed(
    spec: RobotSpec, drive_set: DriveParts, controller: Gains | Cascade | None = None
) -> tuple[DriveTrain, Gains | Cascade, list[str]]:
    """The drive train of a spec and a drive, the controller designed for it or given, and the assumptions of both."""
    if controller is not None:  # designed before, of this machine or of one like it
        period = controller.period if isinstance(controller, Gains) else controller.current_period
        rigid, assumptions = drive_train(spec, drive_set, period)
        return _with_shaft(spec, drive_set, rigid), controller, assumptions
    c, cascade, device = spec.control, spec.control.structure == "cascade", drive_set.controller
    if cascade:
        periods, assumptions = rates(device, c.rate)
    else:
        rate = c.rate or (device.speed_loop if device else math.nan)
        period = 1.0 / rate if rate > 0.0 else _PERIOD  # NaN too
        periods, assumptions = Rates(period, period, 0.0), []
        if not rate > 0.0:
            assumptions.append(f"the controller's rate is unknown: it runs every {show(_PERIOD, 'ms', 'time')}")
    rigid, assumed = drive_train(spec, drive_set, periods.current)
    train = _with_shaft(spec, drive_set, rigid)
    counts, more = _counts(spec, drive_set, train, periods.velocity)
    assumptions = [*assumptions, *assumed, *more]
    place = ("control", "velocity") if cascade else ("control",)
    own, rules = c.velocity if cascade else c, list[str]()

    def make(slower: float) -> Gains | Cascade:
        if not cascade:
            return design(spec, train, periods.velocity, counts, slower)
        gains, rules[:] = design_cascade(train, periods, c, where=spec.where, counts=counts, slower=slower)
        return gains

    if own.kp is not None or (cascade and own.ki is not None):
        return train, make(1.0), [*assumptions, *rules]
    controller, slower, why = tuned(make, train, stated_margin(spec))
    if why and own.bandwidth is not None:
        most = show(math.floor(10.0 * own.bandwidth / slower) / 10.0, "Hz", "frequency")
        text = show(own.bandwidth, "Hz", "frequency")
        raise InputError(f"{spec.where((*place, 'bandwidth'))}: {text} is too fast: {why}; expected at most {most}")
    assumptions += rules
    if why:
        assumptions.append(f"the loop is {slower:.3g} times slower than its design rule, with which {why}")
    return train, controller, assumptions


def edges_of(spec: RobotSpec, drive_set: DriveParts) -> int:
    """Counts per turn of the motor by which speed is measured."""
    lines = drive_set.encoder.lines if drive_set.encoder else math.nan
    return 0 if spec.control.speed_from == "exact" or math.isnan(lines) else round(EDGES * lines)


def _counts(
    spec: RobotSpec, drive_set: DriveParts, train: DriveTrain, period: float
) -> tuple[Counts | None, list[str]]:
    """Counting of the speed, and the assumptions made; None: it is measured exactly."""
    edges, time = edges_of(spec, drive_set), spec.control.count_time
    if not edges:
        lacks = "the drive has no encoder" if drive_set.encoder is None else "the encoder's resolution is unknown"
        return None, [] if spec.control.speed_from == "exact" else [f"{lacks}: speed is measured exactly"]
    volts = spec.feed_of(drive_set.controller).applied
    peak = drive_set.controller.peak_current if drive_set.controller else math.nan
    amperes = answer(volts, train.resistance, peak, drive_set.motor.nominal_current)
    volts_per_ampere = 1.0 if spec.control.structure == "cascade" else train.resistance
    if time is not None and not 0.5 <= time / period < MOST_PERIODS + 0.5:
        raise InputError(
            f"{spec.where(('control', 'count_time'))}: {show(time, 'ms', 'time')} is no counting time at a period of "
            f"{show(period, 'ms', 'time', 4)}; expected one to {MOST_PERIODS} periods"
        )
    periods = 0 if time is None else round(time / period)  # 0: the best is found
    return Counts(edges, amperes * volts_per_ampere, periods), []


def stated_margin(spec: RobotSpec) -> float:
    """Required phase margin [rad]: that of the symmetrical optimum, else that below which a loop rings."""
    c = spec.control.velocity
    if c.phase_margin is not None:
        return c.phase_margin
    placed = spec.control.structure != "cascade" or {"kp", "ki", "bandwidth", "damping"} & c.model_fields_set
    return LEAST_PHASE_MARGIN if placed else margin_of(SPREAD)


def _with_shaft(spec: RobotSpec, drive_set: DriveParts, train: DriveTrain) -> DriveTrain:
    """The drive train with the elastic shaft that a spec gives; the same one of a rigid model.

    Backlash at the driven shaft is the spec's, else the gearhead's; 0 where neither is known.
    """
    if spec.plant.model == "rigid":
        return train
    where, stiffness = spec.where(("plant", "model")), spec.plant.stiffness or spec.belt_stiffness
    if not stiffness > 0.0:  # NaN too
        raise InputError(f"{where}: two_mass needs plant.stiffness or the belt's, e.g. stiffness: 500 N*m/rad")
    if not train.load_inertia > 0.0:
        raise InputError(f"{where}: two_mass needs an inertia of the load, e.g. inertia: 0.02 kg*m^2")
    damping = 2.0 * spec.plant.damping_ratio * math.sqrt(stiffness * train.load_inertia)
    gap = drive_set.gearhead.backlash / drive_set.belt_ratio if spec.plant.backlash is None else spec.plant.backlash
    return replace(train, stiffness=stiffness, damping=damping, gap=0.0 if math.isnan(gap) else float(gap))
