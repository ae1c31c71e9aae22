"""The gains of a servo cascade: those that are given are kept, the rest is designed around them by named rules.

From the inside out: current loop, velocity loop, position loop, feedforward; the rules and their sources are those of
``cascade_rules``.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np

from drivesizer.control.cascade import Cascade, Rates
from drivesizer.control.cascade_rules import (
    FILTER,
    LATE,
    SOURCES,
    SPREAD,
    current_lag,
    feedforward,
    magnitude_optimum,
    most_bandwidth,
    natural_frequency,
    pole_placement,
    position_gain,
    spread_of,
    symmetrical_optimum,
)
from drivesizer.control.drive_train import DriveTrain, Regime, modes
from drivesizer.errors import InputError
from drivesizer.physics.counted_speed import Counts, lags, most_gain, shortest
from drivesizer.units import show

__all__ = ["CascadeRequirements", "design_cascade"]

_DAMPING = math.sqrt(0.5)
_LARGEST_GAIN = 1e9  # with it, rounding errors would be amperes


@dataclass(frozen=True, slots=True, kw_only=True)
class CascadeRequirements:
    """Gains and requirements that the user gives; the rest is designed. Units as in :class:`Cascade`."""

    current_kp: float | None = None
    current_ki: float | None = None
    velocity_kp: float | None = None
    velocity_ki: float | None = None
    velocity_kd: float | None = None
    filter_time: float | None = None
    position_kp: float | None = None
    feedforward_velocity: float | None = None
    feedforward_friction: float | None = None
    feedforward_acceleration: float | None = None
    bandwidth: float | None = None  # Hz, of the velocity loop: pole placement
    damping: float | None = None  # of the poles that are placed
    phase_margin: float | None = None  # rad, of the velocity loop: symmetrical optimum
    position: bool = False  # whether there is a position loop


def design_cascade(
    train: DriveTrain,
    every: Rates,
    wanted: CascadeRequirements,
    *,
    where: Callable[[str], str] = "control.{}".format,
    counts: Counts | None = None,
    slower: float = 1.0,
) -> tuple[Cascade, list[str]]:
    """All gains of a cascade: those that are given, and the rest designed around them.

    Velocity loop: pole placement where a bandwidth or a damping is given, else the symmetrical optimum.
    """
    _look(wanted, where)
    current, current_rule = _current(train, every, wanted, where)
    lag = current_lag(train, *current, every.current) + LATE * every.velocity
    over, lag = _late(train, lag, every.velocity, wanted, counts)
    velocity, velocity_rule = _velocity(train, lag * slower, wanted, where)
    outer, outer_rule = _position(train, lag + LATE * every.position, velocity, wanted)
    rules = [rule for rule in (current_rule, velocity_rule, outer_rule) if rule]
    kd = wanted.velocity_kd or 0.0
    fed = dict(zip(("acceleration", "velocity", "friction"), feedforward(train), strict=True))
    given = {f"feedforward_{name}": getattr(wanted, f"feedforward_{name}") for name in fed}
    found = Cascade(
        current_kp=current[0],
        current_ki=current[1],
        velocity_kp=velocity[0],
        velocity_ki=velocity[1],
        velocity_kd=kd,
        filter_time=_filter_time(wanted, velocity[0], every.velocity) if kd else 0.0,
        position_kp=outer,
        **{name: fed[name.removeprefix("feedforward_")] if gain is None else gain for name, gain in given.items()},
        current_period=every.current,
        velocity_period=every.velocity,
        position_period=every.position if outer else 0.0,
        counted_over=over,
        rule="; ".join(rules),
        source="; ".join(source for name, source in SOURCES.items() if any(name in rule for rule in rules)),
    )
    return found, ["gains are designed for the inertia of driving; braking, the gears' losses make it less"]


def _look(wanted: CascadeRequirements, where: Callable[[str], str]) -> None:
    """Refuse what is no gain, and figures that exclude or lack each other."""
    for f in fields(wanted):
        value = getattr(wanted, f.name)
        if value is not None and not 0.0 <= value <= _LARGEST_GAIN:
            raise InputError(f"{where(f.name)}: {value:g} is no use; expected 0 to {_LARGEST_GAIN:g}")
    if wanted.phase_margin is not None and not 0.0 < wanted.phase_margin < math.pi / 2:
        raise InputError(f"{where('phase_margin')}: expected more than 0° and less than 90°")
    gains = [name for name in ("velocity_kp", "velocity_ki") if getattr(wanted, name) is not None]
    for name, others in (("bandwidth", gains), ("phase_margin", gains), ("damping", gains if len(gains) > 1 else [])):
        if getattr(wanted, name) is not None and others:
            raise InputError(f"{where(name)}: {others[0]} is given too, and settles it; expected one of them")
    if wanted.phase_margin is not None and (wanted.bandwidth is not None or wanted.damping is not None):
        raise InputError(f"{where('phase_margin')}: expected either it, or bandwidth and damping: they are two rules")
    if wanted.damping is not None and wanted.bandwidth is None and not gains:
        raise InputError(
            f"{where('damping')}: it belongs to bandwidth, velocity_kp or velocity_ki; expected one of them"
        )
    if wanted.filter_time is not None and not wanted.velocity_kd:
        raise InputError(f"{where('filter_time')}: it belongs to velocity_kd; expected both")
    for name in ("bandwidth", "damping"):
        if getattr(wanted, name) == 0.0:
            raise InputError(f"{where(name)}: 0 is no use; expected more")


def _current(
    train: DriveTrain, every: Rates, wanted: CascadeRequirements, where: Callable[[str], str]
) -> tuple[tuple[float, float], str]:
    """Gains of the current loop and their rule: around one that is given, the other cancels the winding's lag."""
    kp, ki = wanted.current_kp, wanted.current_ki
    if kp == 0.0 and not ki:
        raise InputError(f"{where('current_kp')}: without it and current_ki no current flows; expected one of them")
    if kp is not None and ki is not None:
        return (kp, ki), "current: given"
    if kp is None and ki is None:
        gains = magnitude_optimum(train.resistance, train.inductance, LATE * every.current)
        return gains, "current: magnitude optimum"
    cancels = "the reset time is the winding's, as in the magnitude optimum"
    if kp is not None:
        return (kp, kp * train.resistance / train.inductance), f"current: kp given, {cancels}"
    assert ki is not None
    return (ki * train.inductance / train.resistance, ki), f"current: ki given, {cancels}"


def _late(
    train: DriveTrain, lag: float, period: float, wanted: CascadeRequirements, counts: Counts | None
) -> tuple[int, float]:
    """Periods over which counts are taken, and the total lag of the velocity loop [s].

    The symmetrical optimum is as fast as the lag or the answer to one count allows; for a bandwidth that is given,
    counts are taken as long as its gain needs. Gains that are given are kept, with counts of one period.
    """
    periods, late = lags(counts, period)
    every = lag + late
    if counts is None or counts.periods:
        return int(periods[0]), float(every[0])
    most = most_gain(counts, periods, period)
    if _pair(wanted) != (None, None):
        return 1, float(every[0])
    inertia = modes(train)[Regime.FORWARD_DRIVING].inertia
    if wanted.bandwidth is not None:
        w = natural_frequency(wanted.bandwidth, wanted.damping or _DAMPING)
        kp, _ = pole_placement(inertia, train.torque_constant, w, wanted.damping or _DAMPING, train.viscous)
        lightest = modes(train)[Regime.FORWARD_BRAKING].inertia / inertia
        within = every * wanted.bandwidth <= most_bandwidth(1.0, wanted.damping or _DAMPING, lightest)
        # the first that is quiet; else as long as the delay allows, and one where it allows none
        quiet, last = np.flatnonzero(within & (kp <= most)), np.flatnonzero(within)
        n = int(quiet[0]) if len(quiet) else int(last[-1]) if len(last) else 0
        return int(periods[n]), float(every[n])
    a = SPREAD if wanted.phase_margin is None else spread_of(wanted.phase_margin)
    least = np.maximum(every, inertia / (train.torque_constant * a * most))
    n = shortest(least, float(least.min()))
    return int(periods[n]), float(least[n])


def _velocity(
    train: DriveTrain, lag: float, wanted: CascadeRequirements, where: Callable[[str], str]
) -> tuple[tuple[float, float], str]:
    """Gains of the velocity loop and their rule."""
    kp, ki = wanted.velocity_kp, wanted.velocity_ki
    if kp is not None and ki is not None:
        return (kp, ki), "velocity: given"
    if wanted.bandwidth is None and wanted.damping is None:
        return _symmetrical(train, lag, wanted, where)
    every, k_t = modes(train), train.torque_constant
    J, damping = every[Regime.FORWARD_DRIVING].inertia, wanted.damping or _DAMPING
    if kp is not None:
        w = (k_t * kp + train.viscous) / (2.0 * damping * J)
    elif ki is not None:
        w = math.sqrt(k_t * ki / J)
    else:
        assert wanted.bandwidth is not None
        most = most_bandwidth(lag, damping, every[Regime.FORWARD_BRAKING].inertia / J)
        _reachable(wanted.bandwidth, most, damping, where)
        w = natural_frequency(wanted.bandwidth, damping)
    placed = pole_placement(J, k_t, w, damping, train.viscous)
    if placed[0] < 0.0:
        raise InputError(f"{where('bandwidth')}: the friction alone makes the drive faster than that; expected more")
    gains = (placed[0] if kp is None else kp, placed[1] if ki is None else ki)
    return gains, f"velocity: pole placement, {show(w, 'rad/s', 'rotary_speed', 3)}, damping {damping:.3g}"


def _reachable(bandwidth: float, most: float, damping: float, where: Callable[[str], str]) -> None:
    """Refuse a bandwidth or damping that the delay of the loop does not allow."""
    if math.isnan(most):
        raise InputError(f"{where('damping')}: {damping:.3g} leaves a phase margin below 30° at any bandwidth")
    if bandwidth > most:
        raise InputError(
            f"{where('bandwidth')}: {show(bandwidth, 'Hz', 'frequency')} is faster than the delay of the loop allows "
            f"at 30° of phase margin; expected at most {show(math.floor(most * 10) / 10, 'Hz', 'frequency')}"
        )


def _symmetrical(
    train: DriveTrain, lag: float, wanted: CascadeRequirements, where: Callable[[str], str]
) -> tuple[tuple[float, float], str]:
    """The symmetrical optimum; one gain that is given sets the spread, and with it the other."""
    J, k_t, kp, ki = modes(train)[Regime.FORWARD_DRIVING].inertia, train.torque_constant, *_pair(wanted)
    if kp == 0.0 or ki == 0.0:  # P or I alone is what was meant
        return (kp or 0.0, ki or 0.0), "velocity: given"
    a = SPREAD if wanted.phase_margin is None else spread_of(wanted.phase_margin)
    if kp is not None:
        a = J / (k_t * kp * lag)
    elif ki is not None:
        a = math.cbrt(J / (k_t * ki * lag * lag))
    if a <= 1.0:
        name, most = ("velocity_kp", J / (k_t * lag)) if kp else ("velocity_ki", J / (k_t * lag * lag))
        raise InputError(
            f"{where(name)}: with {getattr(wanted, name):.4g} no reset time makes the loop stable; expected less than "
            f"{most:.4g}, or velocity_kp and velocity_ki together"
        )
    designed = symmetrical_optimum(J, k_t, lag, a)
    gains = (designed[0] if kp is None else kp, designed[1] if ki is None else ki)
    return gains, f"velocity: symmetrical optimum, a = {a:.3g}"


def _pair(wanted: CascadeRequirements) -> tuple[float | None, float | None]:
    return wanted.velocity_kp, wanted.velocity_ki


def _position(
    train: DriveTrain, lag: float, velocity: tuple[float, float], wanted: CascadeRequirements
) -> tuple[float, str]:
    """Gain of the position loop and its rule; the velocity loop is late by its reset time, or its inertia's lag."""
    if wanted.position_kp is not None:
        return wanted.position_kp, "position: given" if wanted.position_kp else ""
    kp, ki = velocity
    if not wanted.position or not (kp or ki):
        return 0.0, ""
    inertia = modes(train)[Regime.FORWARD_DRIVING].inertia
    late = kp / ki if kp and ki else inertia / (train.torque_constant * kp) if kp else lag
    return position_gain(late + lag), "position: aperiodic"


def _filter_time(wanted: CascadeRequirements, kp: float, period: float) -> float:
    """Filter of the derivative [s]: as given, else a tenth of the derivative time, a period at least."""
    if wanted.filter_time is not None:
        return wanted.filter_time
    assert wanted.velocity_kd is not None
    return max(period, wanted.velocity_kd / kp / FILTER) if kp else period
