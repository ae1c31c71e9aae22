"""The controller of a drive: its rates and encoder, its gains checked on the sampled loop, linear analysis of that."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any, NamedTuple, TypeVar

import control
import numpy as np
from numpy.typing import NDArray
from scipy.linalg import schur

from drivesizer.catalog import EDGES
from drivesizer.catalog import Controller as ControllerPart
from drivesizer.control.drive_train import DriveTrain, Mode, Regime, drive_train, elastic, modes
from drivesizer.control.gains import RESONANCE_SHARE, SPREAD, CascadeRequirements, design, design_cascade, margin_of
from drivesizer.control.loop_models import (
    System,
    closed,
    current_open_loop,
    from_error,
    position_open_loop,
    resonance,
    velocity_open_loop,
    voltage_open_loop,
)
from drivesizer.control.validation import LEAST_PHASE_MARGIN, Bode, Cascade, Gains, Loop, Loops, rates
from drivesizer.errors import InputError
from drivesizer.physics.counted_speed import MOST_PERIODS, Counts, answer
from drivesizer.results.drive_set import DriveParts
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

__all__ = ["analyse", "designed", "edges_of", "frequency_response", "loop_of", "stated_margin", "train_behind"]


# -- Linear analysis of a sampled loop: poles, margins, bandwidth, step response, Bode data.
#
# The loops are those of ``loop_models``, systems of python-control, which closes them and gives poles, gain at rest
# and step response. Both directions of power are analysed; a loop's record is that of the direction nearer to
# instability, its margins and bandwidth the least of both. Margins and bandwidth are roots on the frequency response
# itself, on a grid that is finer around every pole near the unit circle: ``control.stability_margins`` makes
# polynomials of a state space, which are ill-conditioned for slow loops.
#
# .. [1] K. J. Åström, T. Hägglund, *PID Controllers: Theory, Design, and Tuning*, 2nd ed., ISA 1995, ch. 4: margins,
#    maximum sensitivity.


Array = NDArray[np.float64]
_Values = NDArray[np.complex128]
_Response = Callable[[Array], _Values]  # of angular frequencies [rad/s]
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
    loops = {name: _worse(name, opened) for name, opened in opened_loops(train, controller).items()}
    # braking, the load's inertia counts less: that resonance is the lower one
    found = resonance(train, modes(train)[Regime.FORWARD_BRAKING]) if train.flexible else (math.nan, math.nan)
    rigid = loops["velocity"]
    if train.flexible:
        rigid = _worse("velocity", opened_loops(replace(train, stiffness=math.inf), controller)["velocity"])
    return Loops(**loops, anti_resonance=found[0], resonance=found[1], rigid_bandwidth=rigid.bandwidth)


def opened_loops(train: DriveTrain, controller: Cascade | Gains) -> dict[str, dict[str, System]]:
    """The open loops of a controller by name and direction of power."""

    every = modes(train)

    def both(opened: Callable[..., System], answer: str = "speed") -> dict[str, System]:
        return {name: from_error(opened(train, every[r], controller), answer) for name, r in _DIRECTIONS.items()}

    if isinstance(controller, Gains):
        return {"velocity": both(voltage_open_loop)}
    found = {"current": {"": current_open_loop(train, controller)}, "velocity": both(velocity_open_loop)}
    if controller.position_kp and controller.position_period:
        found["position"] = both(position_open_loop, "angle")
    return found


def _worse(name: str, opened: Mapping[str, System]) -> Loop:
    """Of driving and braking the loop nearer to instability, with the least margins and bandwidth of both."""
    found = [loop_of(name, system, direction) for direction, system in opened.items()]
    unstable = [loop for loop in found if not loop.stable]
    if unstable:  # it has no margins, whatever the other direction's are
        return max(unstable, key=lambda loop: loop.pole_radius)
    worst = max(found, key=lambda loop: loop.sensitivity)
    return replace(
        worst,
        gain_margin=_least(loop.gain_margin for loop in found),
        phase_margin=_least(loop.phase_margin for loop in found),
        bandwidth=_least(loop.bandwidth for loop in found),
    )


def loop_of(name: str, opened: System, direction: str = "") -> Loop:
    """All figures of a loop with unit feedback."""
    own, w, opening, closing = _responses(opened)
    (L, T), whole = (each(w) for each in (opening, closing)), _whole(opened)
    radius = max((abs(p) for p in own), default=0.0)
    stable = radius < 1.0
    none = (math.nan, math.nan)
    gains = _gain_margins(opening, w, L) if stable else none
    phase, crossover = _phase_margin(opening, w, L) if stable else none
    final = float(np.real(whole.dcgain(warn_infinite=False)))
    step = _step(whole, radius) if stable else np.empty(0)
    rise, over, settling = _answer(step, final, opened.dt)
    return Loop(
        name=name,
        direction=direction,
        period=float(opened.dt),
        stable=stable,
        pole_radius=radius,
        poles=own,
        gain_margin=gains[0],
        gain_reduction=gains[1],
        phase_margin=phase,
        crossover=crossover,
        sensitivity=float(np.max(1.0 / np.abs(1.0 + L))),
        bandwidth=_bandwidth(final, closing, w, T) if stable else math.nan,
        rise_time=rise,
        overshoot=over,
        settling_time=settling,
        step=step,
        bode=_bode(w, L, T),
    )


def _whole(opened: System) -> System:
    """The closed loop from the reference to the first output."""
    last = [*[0.0] * (opened.noutputs - 1), 1.0]
    return closed(opened[:, 0], last)[0, 0]


def _responses(opened: System) -> tuple[tuple[complex, ...], Array, _Response, _Response]:
    """Closed loop's poles, a grid of frequencies, and the responses of the open and the closed loop."""
    own = tuple(complex(p) for p in _whole(opened).poles())
    values = frequency_response(opened)

    def closing(w: Array) -> _Values:
        found = values(w)
        return np.asarray(found[0] / (1.0 + found[-1]))

    return own, _grid([*own, *opened.poles()], opened.dt), lambda w: values(w)[-1], closing


def frequency_response(system: System) -> _Response:
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


def margin_and_bandwidth(opened: System) -> tuple[float, float]:
    """Phase margin [rad] and bandwidth [Hz] alone: NaN of an unstable loop, infinite where the gain never reaches 1."""
    own, w, opening, closing = _responses(opened)
    if max((abs(p) for p in own), default=0.0) >= 1.0:
        return math.nan, math.nan
    phase, _ = _phase_margin(opening, w, opening(w))
    final = float(np.real(_whole(opened).dcgain(warn_infinite=False)))
    return math.inf if math.isnan(phase) else phase, _bandwidth(final, closing, w, closing(w))


def _least(figures: Iterable[float]) -> float:
    return min((f for f in figures if math.isfinite(f)), default=math.nan)


def _grid(poles: Iterable[complex], period: float) -> Array:
    """Angular frequencies up to the Nyquist frequency [rad/s], finer around the poles that ring."""
    nyquist = math.pi / period
    even = np.geomspace(nyquist * 10.0**-_DECADES, nyquist, _POINTS)
    around = np.geomspace(1e-7, 0.1, 40)  # and not on the pole itself
    rings = [abs(np.angle(p)) / period for p in poles if p.imag > 0.0 and abs(p) > 0.5]
    near = [w * (1.0 + sign * around) for w in rings for sign in (-1.0, 1.0)]
    every: Array = np.unique(np.concatenate([even, *near]))
    inside: Array = every[(every >= even[0]) & (every <= nyquist)]
    return inside


def _crossings(
    response: _Response, w: Array, sampled: Array, figure: Callable[[_Values], Array]
) -> list[tuple[float, complex]]:
    """Angular frequency [rad/s] and response wherever a figure of the response changes sign."""
    below = sampled < 0.0  # a figure that is 0 on the grid counts with those above: its crossing is found once
    before = np.flatnonzero(below[:-1] != below[1:])
    if not len(before):
        return []
    steps = np.stack([before, before + 1])
    found = _roots(lambda x: figure(response(x)), w[steps], sampled[steps])
    return [*zip(found.tolist(), response(found).tolist(), strict=True)]


def _roots(figure: Callable[[Array], Array], ends: Array, values: Array) -> Array:
    """Places at which a figure changes sign, to 1e-12: of equal parts the one that has it, again and again.

    Of all steps of a grid at once, for the response of a long delay has a hundred such places; ends and values there
    have shape (2, steps).
    """
    for _ in range(_TIMES):
        places = np.linspace(ends[0], ends[1], _PARTS + 1)
        inside = figure(places[1:-1].ravel()).reshape(_PARTS - 1, -1)
        found = np.concatenate([values[:1], inside, values[1:]])
        after = np.argmax((found < 0.0) != (found[0] < 0.0), axis=0)
        rows = np.stack([after - 1, after])
        ends, values = np.take_along_axis(places, rows, 0), np.take_along_axis(found, rows, 0)
    found_at: Array = ends[0] - values[0] * (ends[1] - ends[0]) / (values[1] - values[0])
    return found_at


def _gain_margins(response: _Response, w: Array, L: _Values) -> tuple[float, float]:
    """Gain margin up and down [factors]; NaN: none."""
    real = [z.real for _, z in _crossings(response, w, L.imag, lambda z: z.imag)]
    real.append(float(L[-1].real))  # at the Nyquist frequency the response is real
    factors = [-1.0 / x for x in real if x < 0.0]
    return min((f for f in factors if f > 1.0), default=math.nan), max(
        (f for f in factors if f < 1.0), default=math.nan
    )


def _phase_margin(response: _Response, w: Array, L: _Values) -> tuple[float, float]:
    """Phase margin in either sense [rad], and its frequency [Hz]; NaN: none."""
    phases = [
        (abs(math.remainder(math.pi + math.atan2(z.imag, z.real), 2.0 * math.pi)), at / (2.0 * math.pi))
        for at, z in _crossings(response, w, np.abs(L) - 1.0, lambda z: np.abs(z) - 1.0)
    ]
    return min(phases, default=(math.nan, math.nan))


def _bandwidth(final: float, closing: _Response, w: Array, T: _Values) -> float:
    """Frequency at which the closed loop first is 3 dB below its value at rest [Hz]; NaN: nowhere."""
    level = abs(final) / math.sqrt(2.0)
    if not (math.isfinite(level) and level > 0.0):
        return math.nan
    above = np.abs(T) - level
    found = _crossings(closing, w, above, lambda z: np.abs(z) - level)
    return found[0][0] / (2.0 * math.pi) if found and above[0] > 0.0 else math.nan


def _step(whole: System, radius: float) -> Array:
    """Step response of a stable loop, until its slowest pole has decayed to 1e-4, or to the most samples."""
    samples = 100 + math.ceil(math.log(1e-4) / math.log(min(max(radius, 0.1), 1.0 - 1e-9)))
    time = np.arange(min(samples, _MOST_SAMPLES)) * whole.dt
    return np.asarray(control.step_response(whole, time).outputs)


def _answer(step: Array, final: float, period: float) -> tuple[float, float, float]:
    """Rise time [s], overshoot and settling time [s] of a step; NaN where a level is not reached."""
    if not len(step) or not (math.isfinite(final) and abs(final) > 1e-9):
        return (math.nan,) * 3
    y = step / final
    outside = np.flatnonzero(np.abs(y - 1.0) > _SETTLED)
    settled = int(outside[-1]) + 1 if len(outside) else 0
    rise = _reached(y, 0.9) - _reached(y, 0.1)
    return rise * period, max(float(y.max()) - 1.0, 0.0), settled * period if settled < len(y) else math.nan


def _reached(y: Array, level: float) -> float:
    """Sample at which a response first reaches a level, linearly interpolated; NaN: never."""
    above = np.flatnonzero(y >= level)
    if not len(above):
        return math.nan
    n = int(above[0])
    return n - float((y[n] - level) / (y[n] - y[n - 1])) if n else 0.0


def _bode(w: Array, L: _Values, closed: _Values) -> Bode:
    return Bode(
        frequency=w / (2.0 * math.pi),
        open_magnitude=np.abs(L),
        open_phase=np.unwrap(np.angle(L)),
        closed_magnitude=np.abs(closed),
        closed_phase=np.unwrap(np.angle(closed)),
    )


# -- Designed gains checked on the sampled loop: made slower until every required margin is met, or refused.
#
# The rules of ``voltage_loop_design`` and ``cascade_design`` place a bandwidth by lags and delays. The result is
# checked on the loop itself, sampled, delayed, with its counted speed, in both directions of power: the phase
# margin, and with an elastic shaft the distance to the resonance [1]. In the backlash the motor turns alone, as on a
# shaft of no stiffness; any stiffness between none and that in contact may describe it [2], and both ends must hold.
#
# .. [1] G. Ellis, *Control System Design Guide*, 4th ed., Elsevier 2012, ch. 16: resonance and the loop's bandwidth.
# .. [2] M. Nordin, P.-O. Gutman, "Controlling mechanical systems with backlash - a survey", Automatica 38 (2002)
#    1633-1649: describing functions.


Controller = TypeVar("Controller", Gains, Cascade)

_SLOWEST = 2.0**12  # factor beyond which no slower loop is tried
_CLOSE = 1.01  # to which factor the slower loop is sought


class Required(NamedTuple):
    """A drive train, and the margins that designed gains must meet around it."""

    train: DriveTrain
    margin: float  # rad, of phase, at least


class Tuned(NamedTuple):
    """Factor by which a loop is slower than its design rule, and why."""

    slower: float
    why: str


def tuned(make: Callable[[float], Controller], required: Required) -> tuple[Controller, Tuned]:
    """The fastest controller that meets the required margins."""
    found = make(1.0)
    why = flaw(found, required)
    if not why:
        return found, Tuned(1.0, "")
    low = high = 1.0
    while flaw(make(high), required):
        low, high = high, 2.0 * high
        if high > _SLOWEST:
            raise InputError(f"control: gains designed by rule miss their margins, however slow: {why}")
    while high / low > _CLOSE:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if flaw(make(middle), required) else (low, middle)
    return make(high), Tuned(high, why)


def flaw(controller: Gains | Cascade, required: Required) -> str:
    """The first margin that a loop misses, in words."""
    for name, opened in _opened(controller, required):
        margin, bandwidth = margin_and_bandwidth(opened)
        if math.isnan(margin):
            return f"the {name} is unstable"
        if margin < required.margin:
            return f"the {name} has {math.degrees(margin):.3g}° of phase margin, less than {_degrees(required.margin)}"
        if "stiff" in name and bandwidth > (most := RESONANCE_SHARE * _resonance(required)):
            hertz, share = (show(f, "Hz", "frequency", 3) for f in (bandwidth, most))
            return f"the {name} has a bandwidth of {hertz}, above {share}, a fifth of the resonance"
    return ""


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.3g}°"


def _resonance(required: Required) -> float:
    return resonance(required.train, modes(required.train)[Regime.FORWARD_BRAKING])[1]


def _opened(controller: Gains | Cascade, required: Required) -> Iterator[tuple[str, System]]:
    """The loops to be checked, with their names."""
    train = required.train
    every, rigid = modes(train), replace(train, stiffness=math.inf)
    directions = {"driving": every[Regime.FORWARD_DRIVING], "braking": every[Regime.FORWARD_BRAKING]}
    for direction, mode in directions.items():
        if train.flexible:
            yield f"velocity loop with a stiff shaft, {direction},", _velocity(controller, rigid, mode)
        yield f"velocity loop, {direction},", _velocity(controller, train, mode)
        if isinstance(controller, Cascade) and controller.position_kp and controller.position_period:
            yield f"position loop, {direction},", from_error(position_open_loop(train, mode, controller), "angle")
    if train.flexible and train.gap:
        alone = Mode(regime=Regime.FORWARD_DRIVING, inertia=train.motor_inertia, drag=train.friction)
        yield "velocity loop of the motor alone, in the backlash,", _velocity(controller, rigid, alone)


def _velocity(controller: Gains | Cascade, train: DriveTrain, mode: Mode) -> System:
    if isinstance(controller, Gains):
        return from_error(voltage_open_loop(train, mode, controller))
    return from_error(velocity_open_loop(train, mode, controller))


# -- The controller of a drive: its rates and its encoder, gains by rule, checked on the sampled loop.
#
# Rates are those of the spec, else the catalogue's. Speed is that of the encoder's counts where the drive has an
# encoder whose lines are known.


_PERIOD = 1e-3  # s, of a velocity loop on the voltage, where the controller's is unknown


def designed(spec: RobotSpec, drive_set: DriveParts) -> tuple[DriveTrain, Gains | Cascade, list[str]]:
    """The drive train of a spec and a drive, the controller designed for it, and the assumptions of both."""
    if spec.control.structure == "cascade":
        return _cascade(spec, drive_set)
    period, said = _period(spec, drive_set.controller)
    rigid, assumed = drive_train(spec, drive_set, period)
    train = _with_shaft(spec, drive_set, rigid)
    counts, more = _counts(spec, drive_set, train, period)
    said += [*assumed, *more]
    if spec.control.kp is not None:
        return train, design(spec, train, period, counts), said
    gains, slower = tuned(
        lambda factor: design(spec, train, period, counts, factor), Required(train, stated_margin(spec))
    )
    _refuse_slower(spec, ("control", "bandwidth"), spec.control.bandwidth, slower)
    return train, gains, [*said, *_reported(slower)]


def train_behind(spec: RobotSpec, drive_set: DriveParts, controller: Gains | Cascade) -> tuple[DriveTrain, list[str]]:
    """The drive train behind a controller that was designed before, of this machine or of one like it."""
    period = controller.period if isinstance(controller, Gains) else controller.current_period
    rigid, said = drive_train(spec, drive_set, period)
    return _with_shaft(spec, drive_set, rigid), said


def _cascade(spec: RobotSpec, drive_set: DriveParts) -> tuple[DriveTrain, Cascade, list[str]]:
    every, said = rates(drive_set.controller, spec.control.rate)
    rigid, assumed = drive_train(spec, drive_set, every.current)
    train = _with_shaft(spec, drive_set, rigid)
    counts, more = _counts(spec, drive_set, train, every.velocity)
    wanted = _requirements(spec)
    rules: list[str] = []

    def make(slower: float) -> Cascade:
        less = wanted if wanted.bandwidth is None else replace(wanted, bandwidth=wanted.bandwidth / slower)
        found, rules[:] = design_cascade(
            train, every, less, where=lambda field: spec.where(_path(field)), counts=counts, slower=slower
        )
        return found

    if wanted.velocity_kp is not None or wanted.velocity_ki is not None:
        return train, make(1.0), [*said, *assumed, *more, *rules]
    cascade, slower = tuned(make, Required(train, stated_margin(spec)))
    _refuse_slower(spec, ("control", "velocity", "bandwidth"), wanted.bandwidth, slower)
    return train, cascade, [*said, *assumed, *more, *rules, *_reported(slower)]


def _refuse_slower(spec: RobotSpec, path: tuple[str, ...], bandwidth: float | None, slower: Tuned) -> None:
    """Refuse a required bandwidth where the loop must be slower."""
    if bandwidth is not None and slower.why:
        most = show(math.floor(10.0 * bandwidth / slower.slower) / 10.0, "Hz", "frequency")
        required = show(bandwidth, "Hz", "frequency")
        raise InputError(f"{spec.where(path)}: {required} is too fast: {slower.why}; expected at most {most}")


def _reported(slower: Tuned) -> list[str]:
    if not slower.why:
        return []
    return [f"the loop is {slower.slower:.3g} times slower than its design rule, with which {slower.why}"]


# --- rates


def _period(spec: RobotSpec, controller: ControllerPart | None) -> tuple[float, list[str]]:
    """The period of a controller's velocity loop [s]."""
    if spec.control.rate is not None:
        return 1.0 / spec.control.rate, []
    rate = controller.speed_loop if controller else math.nan
    if rate > 0.0:
        return 1.0 / rate, []
    return _PERIOD, [f"the controller's rate is unknown: it runs every {show(_PERIOD, 'ms', 'time')}"]


# --- the encoder


def edges_of(spec: RobotSpec, drive_set: DriveParts) -> int:
    """Counts per turn of the motor by which speed is measured."""
    lines = drive_set.encoder.lines if drive_set.encoder else math.nan
    return 0 if spec.control.speed_from == "exact" or math.isnan(lines) else round(EDGES * lines)


def _counts(
    spec: RobotSpec, drive_set: DriveParts, train: DriveTrain, period: float
) -> tuple[Counts | None, list[str]]:
    """Counting of the speed, and the assumptions made; None: it is measured exactly."""
    edges = edges_of(spec, drive_set)
    if not edges:
        lacks = "the drive has no encoder" if drive_set.encoder is None else "the encoder's resolution is unknown"
        return None, [] if spec.control.speed_from == "exact" else [f"{lacks}: speed is measured exactly"]
    usable = float(spec.feed_of(drive_set.controller).usable)
    volts = spec.supply.lowest if math.isnan(usable) else usable
    peak = drive_set.controller.peak_current if drive_set.controller else math.nan
    amperes = answer(volts, train.resistance, peak, drive_set.motor.nominal_current)
    volts_per_ampere = 1.0 if spec.control.structure == "cascade" else train.resistance
    return Counts(edges, amperes * volts_per_ampere, _periods(spec, period)), []


def _periods(spec: RobotSpec, period: float) -> int:
    """Counting time of the spec in periods; 0: the best is found."""
    time = spec.control.count_time
    if time is None:
        return 0
    if not 0.5 <= time / period < MOST_PERIODS + 0.5:
        raise InputError(
            f"{spec.where(('control', 'count_time'))}: {show(time, 'ms', 'time')} is no counting time at a period of "
            f"{show(period, 'ms', 'time', 4)}; expected one to {MOST_PERIODS} periods"
        )
    return round(time / period)


# --- requirements


def stated_margin(spec: RobotSpec) -> float:
    """Required phase margin [rad]: that of the symmetrical optimum, else that below which a loop rings."""
    c = spec.control.velocity
    if c.phase_margin is not None:
        return c.phase_margin
    placed = spec.control.structure != "cascade" or {"kp", "ki", "bandwidth", "damping"} & c.model_fields_set
    return LEAST_PHASE_MARGIN if placed else margin_of(SPREAD)


def _with_shaft(spec: RobotSpec, drive_set: DriveParts, train: DriveTrain) -> DriveTrain:
    """The drive train with the elastic shaft that a spec gives; the same one of a rigid model."""
    if spec.plant.model == "rigid":
        return train
    where, stiffness = spec.where(("plant", "model")), spec.plant.stiffness or spec.belt_stiffness
    if not stiffness > 0.0:  # NaN too
        raise InputError(f"{where}: two_mass needs plant.stiffness or the belt's, e.g. stiffness: 500 N*m/rad")
    if not train.load_inertia > 0.0:
        raise InputError(f"{where}: two_mass needs an inertia of the load, e.g. inertia: 0.02 kg*m^2")
    damping = 2.0 * spec.plant.damping_ratio * math.sqrt(stiffness * train.load_inertia)
    return elastic(train, stiffness, damping, _gap(spec, drive_set))


def _gap(spec: RobotSpec, drive_set: DriveParts) -> float:
    """Backlash at the driven shaft [rad]: the spec's, else the gearhead's; 0 where neither is known."""
    own = drive_set.gearhead.backlash / drive_set.belt_ratio
    gap = spec.plant.backlash if spec.plant.backlash is not None else own
    return 0.0 if math.isnan(gap) else float(gap)


# --- gains of the spec


def _requirements(spec: RobotSpec) -> CascadeRequirements:
    """Gains and requirements of the cascade that the spec gives."""
    c = spec.control
    given: dict[str, Any] = {f"current_{name}": getattr(c.current, name) for name in ("kp", "ki")}
    given |= {f"velocity_{name}": getattr(c.velocity, name) for name in ("kp", "ki", "kd")}
    given |= {name: getattr(c.velocity, name) for name in ("filter_time", "bandwidth", "damping", "phase_margin")}
    given |= {f"feedforward_{name}": value for name, value in c.feedforward.model_dump().items()}
    return CascadeRequirements(
        position=c.position is not None, position_kp=c.position.kp if c.position else None, **given
    )


def _path(field: str) -> tuple[str, ...]:
    """Path of a field of ``Wanted`` in the spec."""
    section, _, name = field.partition("_")
    if section in ("current", "velocity", "position", "feedforward"):
        return "control", section, name
    return "control", "velocity", field
