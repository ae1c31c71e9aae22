"""Gains by named rules: of the servo cascade, and of the velocity loop that acts on the voltage; warnings."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

import numpy as np

from drivesizer.control.drive_train import DriveTrain, Mode, Regime, modes
from drivesizer.control.validation import LEAST_PHASE_MARGIN, Cascade, Gains, Loop, Loops, Rates
from drivesizer.errors import InputError
from drivesizer.loads.course import Profile
from drivesizer.physics.counted_speed import COUNT_SHARE, Counts, lags, most_gain, shortest, speed_quantum
from drivesizer.spec.drive import Control, VelocityLoop
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

# -- Gains of the velocity loop that acts on the voltage: those of the spec, or PI gains by the SIMC rule [1].
#
# The rule works on the speed response of the motor with its reflected load, friction that grows with speed left out.
# A counted speed is late by half its counting time, and one count may be answered with a tenth of the available
# voltage: of all counting times the one with the fastest closed loop is taken.
#
# .. [1] S. Skogestad, "Simple analytic rules for model reduction and PID controller tuning", J. Process Control 13
# (2003) 291-309: the half rule, the PI settings, and tau_c = theta for tight control. .. [2] K. J. Åström, T.
# Hägglund, *PID Controllers: Theory, Design, and Tuning*, 2nd ed., ISA, 1995, ch. 3: filter of the derivative.


RULE = "SIMC PI"
SOURCE = "S. Skogestad, J. Process Control 13 (2003) 291-309"
FROM_SPEC = "given in the spec"
COMPUTING = 1.0  # control periods between a measurement and the voltage that answers it
_HOLDING = 0.5  # control periods by which a held voltage is late on average
_FILTER = 10.0  # derivative time over its filter's, 8 to 20 by [2], and by [5] of the cascade
_LARGEST_GAIN = 1e9  # V per unit: with it, rounding errors of the speed would be volts


def effective_delay(train: DriveTrain, mode: Mode, period: float) -> tuple[float, float]:
    r"""Lag and delay of the first-order model of the speed response.

    .. math:: \frac{w}{u} = \frac{1/k_e}{(T_1 s + 1)(T_2 s + 1)} \approx \frac{1/k_e}{\tau_1 s + 1} e^{-\theta s},
              \quad \tau_1 = T_1 + T_2 / 2, \quad \theta = T_2 / 2 + 1.5\,T_s

    Notes
    -----
    :math:`T_1 + T_2 = R J/(k_t k_e)` and :math:`T_1 T_2 = (T_1 + T_2) L/R`; where they are complex (a light rotor
    behind a large inductance) their real part is taken. Half rule: [1].
    """
    mechanical = train.resistance * mode.inertia / (train.torque_constant * train.back_emf_constant)
    electrical = train.inductance / train.resistance
    spread = math.sqrt(max(0.0, 1.0 - 4.0 * electrical / mechanical))
    slow = mechanical / 2 * (1.0 + spread)
    fast = mechanical - slow
    return slow + fast / 2, fast / 2 + (COMPUTING + _HOLDING) * period


def design(
    spec: RobotSpec, train: DriveTrain, period: float, counts: Counts | None = None, slower: float = 1.0
) -> Gains:
    """Gains of the voltage PI: given by the spec, or by the SIMC rule.

    The time constant of the closed loop is that of a given bandwidth, else the least by delay and noise, for every time
    of counting; a need that cannot be met fails its check.
    """
    c = spec.control
    if c.kp is not None:
        for name, gain in (("kp", c.kp), ("ki", c.ki), ("kd", c.kd)):
            if gain > _LARGEST_GAIN:
                where, most = spec.where(("control", name)), f"{_LARGEST_GAIN:g}"
                raise InputError(f"{where}: {gain:g} is no gain of a real controller; expected at most {most}")
        filter_time = max(period, c.kd / c.kp / _FILTER) if c.kp and c.kd else period if c.kd else 0.0
        over = max(counts.periods, 1) if counts else 0
        return Gains(kp=c.kp, ki=c.ki, kd=c.kd, filter_time=filter_time, period=period, counted_over=over,
                     rule=FROM_SPEC, source="", **_ahead(c, train))  # fmt: skip
    all_modes, (periods, late) = modes(train), lags(counts, period)
    tau_1, theta = effective_delay(train, all_modes[Regime.FORWARD_DRIVING], period)
    lightest, _ = effective_delay(train, all_modes[Regime.FORWARD_BRAKING], period)
    delay = theta + late
    # braking, the gears' losses help and the loop is faster: even there tau_c is no shorter than the delay
    least = tight = tau_1 / lightest * 2.0 * delay - delay
    if counts is not None:
        least = np.maximum(tight, train.back_emf_constant * tau_1 / most_gain(counts, periods, period) - delay)
    tau_c = float(least.min())
    if c.bandwidth is not None:
        tau_c, shortest_by_delay = 1.0 / (2.0 * math.pi * c.bandwidth), float(tight.min())
        if tau_c < shortest_by_delay:
            bandwidth = show(c.bandwidth, "Hz", "frequency")
            highest = show(1.0 / (2.0 * math.pi * shortest_by_delay), "Hz", "frequency", 3)
            raise InputError(
                f"{spec.where(('control', 'bandwidth'))}: {bandwidth} is faster than the delay of the loop allows; "
                f"expected at most {highest}"
            )
    elif spec.needs.bandwidth is not None:
        tau_c = max(tau_c, 1.0 / (2.0 * math.pi * spec.needs.bandwidth))
    tau_c *= slower
    # at a bandwidth that is given, counts may be too noisy: then they are taken as long as the delay allows
    n = shortest(least, tau_c) if tau_c >= least.min() else int(np.flatnonzero(tight <= tau_c)[-1])
    theta += float(late[n])
    kp, tau_i = train.back_emf_constant * tau_1 / (tau_c + theta), min(tau_1, 4.0 * (tau_c + theta))
    rule = f"{RULE}, tau_c = {show(tau_c, 'ms', 'time', 3)}{' (tight)' if tau_c == least.min() else ''}"
    return Gains(
        kp=kp, ki=kp / tau_i, kd=0.0, filter_time=0.0, period=period, counted_over=int(periods[n]), rule=rule,
        source=SOURCE, **_ahead(c, train),
    )  # fmt: skip


def _ahead(c: Control, train: DriveTrain) -> dict[str, float]:
    """Feedforward of the voltage for the currents that are given: of a controller that has it, else none."""
    own = c.feedforward
    if own.velocity is None or own.friction is None or own.acceleration is None:
        return {}
    return {
        "feedforward_velocity": train.back_emf_constant + train.resistance * own.velocity,
        "feedforward_friction": train.resistance * own.friction,
        "feedforward_acceleration": train.resistance * own.acceleration,
    }


def position_on_voltage(train: DriveTrain, period: float) -> float:
    r"""Gain of a position loop that acts on the voltage [V/rad], with no velocity loop inside: magnitude optimum [1].

    .. math:: k_p = \frac{k_e}{2 (\tau_1 + \theta)}

    Of an integral behind the lag and the delay of :func:`effective_delay`: damping 0.707, phase margin 65 deg.
    """
    lag, delay = effective_delay(train, modes(train)[Regime.FORWARD_DRIVING], period)
    return train.back_emf_constant / (2.0 * (lag + delay))


# -- Gains of the servo cascade by named rules, from the inside out.
#
# The winding is a lag :math:`L/R`; the delay of a held voltage, computing included, is the small lag
# :math:`T_{\sigma i} = 1.5\,T_i`. The magnitude optimum [1]_ makes of it a current loop with the lag
# :math:`2\,T_{\sigma i}` and damping 0.707; the back-EMF is a disturbance. The velocity loop sees the inertia behind
# :math:`T_{\sigma w} = R/k_{i,i} + 1.5\,T_w`, the position loop sees the velocity loop.
# Symbols: J inertia at the motor [kg*m^2], k_t torque constant [N*m/A], T period [s].
#
# .. [1] C. Kessler, "Über die Vorausberechnung optimal abgestimmter Regelkreise, Teil III", Regelungstechnik 3
# (1955) 40-49. .. [2] C. Kessler, "Das symmetrische Optimum", Regelungstechnik 6 (1958) 395-400, 432-436. .. [3] D.
# Schröder, *Elektrische Antriebe - Regelung von Antriebssystemen*, Springer: both optima, cascade control. .. [4] W.
# Leonhard, *Control of Electrical Drives*, 3rd ed., Springer 2001: cascade, symmetrical optimum, position loop. ..
# [5] K. J. Åström, T. Hägglund, *PID Controllers: Theory, Design, and Tuning*, 2nd ed., ISA 1995: pole placement,
# phase margins, filter of the derivative.


LATE = COMPUTING + _HOLDING  # periods: computing, and the half by which a held value is late on average
SPREAD = 2.0  # a of the symmetrical optimum [2]: phase margin 36.9 deg
SOURCES = {
    "magnitude optimum": "C. Kessler, Regelungstechnik 3 (1955) 40-49",
    "symmetrical optimum": "C. Kessler, Regelungstechnik 6 (1958) 395-400",
    "pole placement": "K. J. Åström, T. Hägglund, PID Controllers, ISA 1995",
    "aperiodic": "W. Leonhard, Control of Electrical Drives, Springer 2001",
}


def magnitude_optimum(resistance: float, inductance: float, lag: float) -> tuple[float, float]:
    r"""Current PI gains by the magnitude optimum [1]_ [3]_.

    .. math:: k_p = \frac{L}{2 T_\sigma}, \quad k_i = \frac{R}{2 T_\sigma}
              \quad\Rightarrow\quad \frac{i}{i^*} = \frac{1}{1 + 2 T_\sigma s + 2 T_\sigma^2 s^2}
    """
    return inductance / (2.0 * lag), resistance / (2.0 * lag)


def spread_of(phase_margin: float) -> float:
    r"""The spread a of the symmetrical optimum that has a phase margin [rad] [3]_.

    .. math:: \varphi = \arctan a - \arctan (1/a) \quad\Leftrightarrow\quad a = \frac{1 + \sin\varphi}{\cos\varphi}

    >>> round(spread_of(math.atan(0.75)), 12)
    2.0
    """
    return (1.0 + math.sin(phase_margin)) / math.cos(phase_margin)


def margin_of(a: float) -> float:
    """The phase margin [rad] that the symmetrical optimum has with a spread, the inverse of :func:`spread_of`."""
    return math.atan(a) - math.atan(1.0 / a)


def symmetrical_optimum(inertia: float, torque_constant: float, lag: float, a: float = SPREAD) -> tuple[float, float]:
    r"""Velocity PI gains by the symmetrical optimum [2]_ [3]_ [4]_.

    .. math:: k_p = \frac{J}{k_t\, a\, T_\sigma}, \quad k_i = \frac{k_p}{a^2 T_\sigma}
    """
    kp = inertia / (torque_constant * a * lag)
    return kp, kp / (a * a * lag)


def natural_frequency(bandwidth: float, damping: float) -> float:
    r"""Natural frequency [rad/s] of the poles of a PI loop around an inertia, for a -3 dB bandwidth [Hz].

    Of :math:`(2 D\omega_0 s + \omega_0^2)/(s^2 + 2 D\omega_0 s + \omega_0^2)`:

    .. math:: \omega_b = \omega_0 \sqrt{1 + 2D^2 + \sqrt{(1 + 2D^2)^2 + 1}}
    """
    b = 1.0 + 2.0 * damping**2
    return 2.0 * math.pi * bandwidth / math.sqrt(b + math.hypot(b, 1.0))


def pole_placement(
    inertia: float, torque_constant: float, natural_frequency: float, damping: float, viscous: float = 0.0
) -> tuple[float, float]:
    r"""Velocity PI gains by pole placement [5]_.

    .. math:: k_p = \frac{2 D \omega_0 J - b}{k_t}, \quad k_i = \frac{\omega_0^2 J}{k_t}
    """
    kp = (2.0 * damping * natural_frequency * inertia - viscous) / torque_constant
    return kp, natural_frequency**2 * inertia / torque_constant


def most_bandwidth(lag: float, damping: float, lightest: float = 1.0) -> float:
    r"""Largest -3 dB bandwidth [Hz] with a phase margin of 30 deg behind a dead time; NaN where there is none.

    With :math:`\rho` the share of the inertia that is left (driven by the load, the gears' losses help):

    .. math:: x = \left(\frac{\omega_c}{\omega_0}\right)^2 = \frac{2D^2 + \sqrt{4D^4 + \rho^2}}{\rho^2}, \quad
              \varphi = \arctan(2 D \sqrt{x}) - \omega_0 \sqrt{x}\, T_\sigma
    """
    x = math.sqrt(2.0 * damping**2 + math.hypot(2.0 * damping**2, lightest)) / lightest
    left = math.atan(2.0 * damping * x) - LEAST_PHASE_MARGIN
    return left / (x * lag) / natural_frequency(1.0, damping) if left > 0.0 else math.nan


def feedforward(train: DriveTrain) -> tuple[float, float, float]:
    """Feedforward gains of the current, driving: acceleration, viscous friction, Coulomb friction."""
    all_modes, k_t = modes(train), train.torque_constant
    forward, backward = all_modes[Regime.FORWARD_DRIVING], all_modes[Regime.BACKWARD_DRIVING]
    return forward.inertia / k_t, train.viscous / k_t, (forward.drag - backward.drag) / 2.0 / k_t


# -- The gains of a servo cascade: those that are given are kept, the rest is designed around them by named rules.
#
# From the inside out: current loop, velocity loop, position loop, feedforward; the rules and their sources are those
# of ``cascade_rules``.


_DAMPING = math.sqrt(0.5)


Where = Callable[[tuple[str, ...]], str]  # a field of the spec as messages name it


def design_cascade(
    train: DriveTrain,
    periods: Rates,
    control: Control,
    *,
    where: Where = ".".join,
    counts: Counts | None = None,
    slower: float = 1.0,
) -> tuple[Cascade, list[str]]:
    """All gains of a cascade: those that are given, and the rest designed around them.

    Velocity loop: pole placement where a bandwidth or a damping is given, else the symmetrical optimum.
    """
    _refuse(control, where)
    own, place = control.velocity, control.position
    current_kp, current_ki, current_rule = _current(train, periods, control, where)
    # lag of the closed current loop: twice the small lag for the magnitude optimum [3]
    lag = train.resistance / current_ki if current_ki > 0.0 else (
        train.inductance / (train.resistance + current_kp) + LATE * periods.current
    )  # fmt: skip
    bandwidth, late = None if own.bandwidth is None else own.bandwidth / slower, control.computing + _HOLDING
    over, lag = _late(train, lag + late * periods.velocity, periods.velocity, own, bandwidth, counts)
    kp, ki, velocity_rule = _velocity(train, lag * slower, own, bandwidth, where)
    outer, outer_rule = place.kp if place else None, "position: given"
    if outer is None:
        outer = _position_gain(train, lag + late * periods.position, kp, ki) if place and (kp or ki) else 0.0
        outer_rule = "position: aperiodic"
    rules = [current_rule, velocity_rule, *([outer_rule] if outer else [])]
    kd, filter_time = own.kd or 0.0, own.filter_time
    if filter_time is None:  # a tenth of the derivative time, a period at least
        filter_time = max(periods.velocity, kd / kp / _FILTER) if kp else periods.velocity
    ahead = control.feedforward
    acceleration, velocity, friction = feedforward(train)
    cascade = Cascade(
        current_kp=current_kp,
        current_ki=current_ki,
        velocity_kp=kp,
        velocity_ki=ki,
        velocity_kd=kd,
        filter_time=filter_time if kd else 0.0,
        position_kp=outer,
        feedforward_acceleration=acceleration if ahead.acceleration is None else ahead.acceleration,
        feedforward_velocity=velocity if ahead.velocity is None else ahead.velocity,
        feedforward_friction=friction if ahead.friction is None else ahead.friction,
        computing=control.computing,
        planned_speed=place is None or place.planned_speed,
        current_period=periods.current,
        velocity_period=periods.velocity,
        position_period=periods.position if outer else 0.0,
        counted_over=over,
        rule="; ".join(rules),
        source="; ".join(source for name, source in SOURCES.items() if any(name in rule for rule in rules)),
    )
    return cascade, ["gains are designed for the inertia of driving; braking, the gears' losses make it less"]


def _refuse(control: Control, where: Where) -> None:
    """Refuse what is no gain, and figures of the velocity loop that exclude or lack each other."""
    for section in ("current", "velocity", "position", "feedforward"):
        figures = getattr(control, section)
        for name, value in figures.model_dump().items() if figures else ():
            if value is not None and not 0.0 <= value <= _LARGEST_GAIN:  # a yes or no is within
                what = where(("control", section, name))
                raise InputError(f"{what}: {value:g} is no use; expected 0 to {_LARGEST_GAIN:g}")
    own = control.velocity
    gains = [f"velocity_{name}" for name in ("kp", "ki") if getattr(own, name) is not None]
    margin, several = own.phase_margin, own.bandwidth is not None or own.damping is not None
    excluded_by = {"bandwidth": gains, "phase_margin": gains, "damping": gains if len(gains) > 1 else []}
    wrong = [
        ("phase_margin", margin is not None and not 0.0 < margin < math.pi / 2,
         "expected more than 0° and less than 90°"),
        *((name, bool(others) and getattr(own, name) is not None,
           f"{others[0] if others else ''} is given too, and settles it; expected one of them")
          for name, others in excluded_by.items()),
        ("phase_margin", margin is not None and several,
         "expected either it, or bandwidth and damping: they are two rules"),
        ("damping", own.damping is not None and own.bandwidth is None and not gains,
         "it belongs to bandwidth, velocity_kp or velocity_ki; expected one of them"),
        ("filter_time", own.filter_time is not None and not own.kd, "it belongs to velocity_kd; expected both"),
        ("bandwidth", own.bandwidth == 0.0, "0 is no use; expected more"),
        ("damping", own.damping == 0.0, "0 is no use; expected more"),
    ]  # fmt: skip
    for name, is_wrong, why in wrong:
        if is_wrong:
            raise InputError(f"{where(('control', 'velocity', name))}: {why}")


def _current(train: DriveTrain, periods: Rates, control: Control, where: Where) -> tuple[float, float, str]:
    """Gains of the current loop and their rule: around one that is given, the other cancels the winding's lag."""
    kp, ki = control.current.kp, control.current.ki
    if kp == 0.0 and not ki:
        what = where(("control", "current", "kp"))
        raise InputError(f"{what}: without it and current_ki no current flows; expected one of them")
    if kp is not None and ki is not None:
        return kp, ki, "current: given"
    cancels = "the reset time is the winding's, as in the magnitude optimum"
    if kp is not None:
        return kp, kp * train.resistance / train.inductance, f"current: kp given, {cancels}"
    if ki is not None:
        return ki * train.inductance / train.resistance, ki, f"current: ki given, {cancels}"
    gains = magnitude_optimum(train.resistance, train.inductance, LATE * periods.current)
    return *gains, "current: magnitude optimum"


def _late(
    train: DriveTrain, lag: float, period: float, own: VelocityLoop, bandwidth: float | None, counts: Counts | None
) -> tuple[int, float]:
    """Periods over which counts are taken, and the total lag of the velocity loop [s].

    The symmetrical optimum is as fast as the lag or the answer to one count allows; for a bandwidth that is given,
    counts are taken as long as its gain needs. Gains that are given are kept, with counts of one period.
    """
    periods, late = lags(counts, period)
    total_lag = lag + late
    if counts is None or counts.periods:
        return int(periods[0]), float(total_lag[0])
    most = most_gain(counts, periods, period)
    if own.kp is not None or own.ki is not None:
        return 1, float(total_lag[0])
    inertia = modes(train)[Regime.FORWARD_DRIVING].inertia
    if bandwidth is not None:
        damping = own.damping or _DAMPING
        w = natural_frequency(bandwidth, damping)
        kp, _ = pole_placement(inertia, train.torque_constant, w, damping, train.viscous)
        lightest = modes(train)[Regime.FORWARD_BRAKING].inertia / inertia
        within = total_lag * bandwidth <= most_bandwidth(1.0, damping, lightest)
        # the first that is quiet; else as long as the delay allows, and one where it allows none
        quiet, last = np.flatnonzero(within & (kp <= most)), np.flatnonzero(within)
        n = int(quiet[0]) if len(quiet) else int(last[-1]) if len(last) else 0
        return int(periods[n]), float(total_lag[n])
    a = SPREAD if own.phase_margin is None else spread_of(own.phase_margin)
    least = np.maximum(total_lag, inertia / (train.torque_constant * a * most))
    n = shortest(least, float(least.min()))
    return int(periods[n]), float(least[n])


def _velocity(
    train: DriveTrain, lag: float, own: VelocityLoop, bandwidth: float | None, where: Where
) -> tuple[float, float, str]:
    """Gains of the velocity loop and their rule; in each, one gain that is given sets the other."""
    kp, ki, k_t, all_modes = own.kp, own.ki, train.torque_constant, modes(train)
    J = all_modes[Regime.FORWARD_DRIVING].inertia
    if kp is not None and ki is not None:
        return kp, ki, "velocity: given"
    if bandwidth is None and own.damping is None:
        if kp == 0.0 or ki == 0.0:  # P or I alone is what was meant
            return kp or 0.0, ki or 0.0, "velocity: given"
        a = SPREAD if own.phase_margin is None else spread_of(own.phase_margin)
        if kp is not None:
            a = J / (k_t * kp * lag)
        elif ki is not None:
            a = math.cbrt(J / (k_t * ki * lag * lag))
        if a <= 1.0:
            name, most = ("kp", J / (k_t * lag)) if kp else ("ki", J / (k_t * lag * lag))
            raise InputError(
                f"{where(('control', 'velocity', name))}: with {getattr(own, name):.4g} no reset time makes the loop "
                f"stable; expected less than {most:.4g}, or velocity_kp and velocity_ki together"
            )
        designed, rule = symmetrical_optimum(J, k_t, lag, a), f"velocity: symmetrical optimum, a = {a:.3g}"
    else:
        damping = own.damping or _DAMPING
        if kp is not None:
            w = (k_t * kp + train.viscous) / (2.0 * damping * J)
        elif ki is not None:
            w = math.sqrt(k_t * ki / J)
        else:
            assert bandwidth is not None
            what = "control", "velocity"
            most = most_bandwidth(lag, damping, all_modes[Regime.FORWARD_BRAKING].inertia / J)
            if math.isnan(most):
                raise InputError(
                    f"{where((*what, 'damping'))}: {damping:.3g} leaves a phase margin below 30° at any bandwidth"
                )
            if bandwidth > most:
                raise InputError(
                    f"{where((*what, 'bandwidth'))}: {show(bandwidth, 'Hz', 'frequency')} is faster than the delay of "
                    "the loop allows at 30° of phase margin; expected at most "
                    f"{show(math.floor(most * 10) / 10, 'Hz', 'frequency')}"
                )
            w = natural_frequency(bandwidth, damping)
        designed = pole_placement(J, k_t, w, damping, train.viscous)
        if designed[0] < 0.0:
            field = where(("control", "velocity", "bandwidth"))
            raise InputError(f"{field}: the friction alone makes the drive faster than that; expected more")
        rule = f"velocity: pole placement, {show(w, 'rad/s', 'rotary_speed', 3)}, damping {damping:.3g}"
    return designed[0] if kp is None else kp, designed[1] if ki is None else ki, rule


def _position_gain(train: DriveTrain, lag: float, kp: float, ki: float) -> float:
    """Gain of a position loop [1/s] whose poles are both real and equal [4]_, around a velocity loop.

    That is late by its reset time, or its inertia's lag, and a lag beside [s].
    """
    inertia = modes(train)[Regime.FORWARD_DRIVING].inertia
    late = kp / ki if kp and ki else inertia / (train.torque_constant * kp) if kp else lag
    return 1.0 / (4.0 * (late + lag))


# -- Warnings about a loop in words, each with the figure that would be right.
#
# .. [1] K. J. Åström, T. Hägglund, *PID Controllers: Theory, Design, and Tuning*, 2nd ed., ISA 1995, ch. 4: margins.
# .. [2] G. Ellis, *Control System Design Guide*, 4th ed., Elsevier 2012, ch. 16: resonance and the loop's bandwidth.


RESONANCE_SHARE = 0.2  # a bandwidth above a fifth of the resonance is near it [2]
_RISE = math.log(9.0) / (2.0 * math.pi)  # bandwidth times rise time (10-90 %) of a first-order lag, 0.35


def loop_warnings(loops: Iterable[Loop], profile: Profile | None = None) -> list[str]:
    """Warnings about loops that are unstable, ring, or are slower than a profile requires."""
    ramp = shortest_ramp(profile) if profile else math.nan
    warnings = []
    for loop in loops:
        where = f"the {loop.name} loop" + (f", {loop.direction}," if loop.direction else "")
        if not loop.stable:
            warnings.append(
                f"{where} is unstable with these gains: largest pole {loop.pole_radius:.4g}, stable inside 1"
            )
        elif loop.phase_margin < LEAST_PHASE_MARGIN:
            margin, least = (f"{math.degrees(figure):.3g}°" for figure in (loop.phase_margin, LEAST_PHASE_MARGIN))
            warnings.append(f"{where} rings: phase margin {margin}, expected {least} at least")
        if loop.stable and loop.bandwidth < _RISE / ramp:
            has, needs = (show(f, "Hz", "frequency", 3) for f in (loop.bandwidth, _RISE / ramp))
            warnings.append(
                f"the {loop.name} loop is slower than the profile: bandwidth {has}, and the "
                f"shortest ramp, {show(ramp, 's', 'time', 3)}, needs {needs}"
            )
    return warnings


def shortest_ramp(profile: Profile) -> float:
    """Shortest time in which a profile goes from one constant or extreme speed to the next [s]; NaN: none.

    Successive straight pieces in one direction are one ramp, so that the rounded ramp of an S-curve counts whole.
    """
    ramps: list[float] = []
    sign = 0.0
    for t0, t1, v0, v1 in profile.pieces():
        before, sign = sign, math.copysign(1.0, v1 - v0) if v1 != v0 else 0.0
        if sign and sign == before:
            ramps[-1] += t1 - t0
        elif sign:
            ramps.append(t1 - t0)
    return min(ramps, default=math.nan)


def resonance_warning(loops: Loops, stiffness: float) -> list[str]:
    """Warning where the bandwidth that the gains have on a stiff shaft reaches the resonance [2]."""
    rigid, most = loops.rigid_bandwidth, RESONANCE_SHARE * loops.resonance
    if not rigid > most:
        return []
    inside = "within" if rigid >= loops.anti_resonance else "near"
    stiffer = stiffness * (rigid / most) ** 2  # a frequency goes with the root of the stiffness
    bandwidth, low, high, share = (
        show(figure, "Hz", "frequency", 3) for figure in (rigid, loops.anti_resonance, loops.resonance, most)
    )
    return [
        f"the load swings against the motor {inside} the bandwidth of {bandwidth} that the velocity loop has with "
        f"a stiff shaft: anti-resonance at {low}, resonance at {high}; "
        f"expected a bandwidth below a fifth of that, {share}, or a stiffness above {stiffer:.3g} N·m/rad"
    ]


def resolution_warning(lines: float, time: float, kp: float, peak: float, kind: str = "current") -> list[str]:
    """Warning where one encoder count is answered with much of the controller's range."""
    quantum = speed_quantum(lines, time)
    if not quantum * kp > COUNT_SHARE * peak:  # unknown too
        return []
    answer, most = (show(figure, "A" if kind == "current" else "V", kind, 3) for figure in (quantum * kp, peak))
    return [
        f"one encoder count over {show(time, 'ms', 'time', 3)} is {show(quantum, 'rpm', 'rotary_speed', 3)}, answered "
        f"with {answer} of {most}: expected {COUNT_SHARE:.0%} at most, by more encoder lines, less gain, or counts "
        "over a longer time"
    ]
