"""A platform in numbers, for all outputs: kinematics, dynamics, the speed that its drives permit by direction."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drivesizer.errors import InputError
from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.platform import dynamics_of, ground_of, trajectory_of
from drivesizer.machine.platform_budget import PermittedSpeeds
from drivesizer.physics.load_cycle import end_times
from drivesizer.platform import robot_figures
from drivesizer.platform.dynamics import Dynamics, motion, wheel_torques
from drivesizer.platform.equations import PLATFORM, Array, MatrixEquation, text
from drivesizer.platform.robot_figures import Instant, Numbers
from drivesizer.results.drive_set import DriveSet
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import label, show

# -- The instant of a platform's motion at which a wheel has its largest torque.


_SAME = 1e-9  # of the largest torque


class HardestInstant(NamedTuple):
    """A platform where one of its wheels has its largest torque."""

    dynamics: Dynamics
    instant: Instant
    time: float  # s, from the start of the motion
    wheel: int  # from 1
    case: str  # name of the load case; empty where there is one


def hardest_instant(spec: RobotSpec, rotor_inertia: float = 0.0) -> HardestInstant:
    """A platform at the instant of its motion, in the first load case, at which a wheel has its largest torque."""
    name, case = spec.load_cases[0]
    d, trajectory = dynamics_of(case, rotor_inertia), trajectory_of(case)
    if trajectory is None:
        cycle = load_cycle(case)
        at = _largest(cycle.torque, cycle.speed)
        eta, eta_dot = (np.array([cycle.radius * course[at], 0.0, 0.0]) for course in (cycle.speed, cycle.acceleration))
        ground = replace(ground_of(case), uphill=0.0)  # its slope is along its path
        turned = cycle.duration * cycle.speed.mean(axis=1)  # rad, of each segment; its speed is a straight line
        turned[at[0]] *= at[1]  # at its start or at its end
        posture = np.array([cycle.radius * turned[: at[0] + 1].sum(), 0.0, 0.0])
        straight = Instant(posture, eta, eta_dot, ground)
        return HardestInstant(d, straight, float(cycle.time[at]), d.kinematics.driven[0] + 1, name)
    seen = motion(d, trajectory, ground_of(case))
    torque = wheel_torques(d, seen)
    wheel, piece, end = _largest(torque, np.hypot(*seen.eta[:2])[None])
    place, time = (slice(None), piece, end), float(end_times(seen.duration)[piece, end])
    posture = np.array([*trajectory.at(time)[:2], seen.theta[piece, end]])
    instant = Instant(posture, seen.eta[place], seen.eta_dot[place], ground_of(case), seen.towards[place])
    return HardestInstant(d, instant, time, d.kinematics.driven[wheel] + 1, name)


def _largest(torque: Array, speed: Array) -> tuple[int, ...]:
    """Place of the largest torque; of several alike that at the highest speed."""
    size = np.abs(torque)
    fastest = np.where(size >= (1.0 - _SAME) * size.max(), np.abs(speed), -1.0)
    return tuple(int(i) for i in np.unravel_index(fastest.argmax(), size.shape))


# -- Tables of a platform, for terminal and reports: the speed that its drives permit in each direction.


FOLLOWING = "Path following: largest deviations"
SPEEDS = "Highest steady speed by direction, counterclockwise from ahead"


def failed_motors_text(speeds: PermittedSpeeds) -> str:
    """Motors that drive where no further one fails: ``all motors``, or without the failed ones."""
    return f"without {', '.join(map(str, speeds.failed))}" if speeds.failed else "all motors"


def speed_remarks(speeds: PermittedSpeeds) -> Iterator[str]:
    """Directions in which a speed is not permitted, and assumptions of the table, as sentences."""
    required, count = speeds.required, len(speeds.direction)
    slow = {failed: int((speed < (required or 0.0)).sum()) for failed, speed in speeds.speed.items()}
    if required is not None and any(slow.values()):
        words = f"not permitted in {slow[0]} of {count}" if slow[0] else f"permitted in all {count}"
        less = f", without a motor {'' if slow[0] else 'not '}in up to {max(slow.values())}" if len(slow) > 1 else ""
        yield f"{show(required, 'm/s', 'speed', 3)}, as in the spec, is {words} directions{less}."
    yield (
        "At constant speed for long, at the lowest supply voltage: what is left for gaining speed is not in it, and "
        "neither are supply and battery."
    )
    by = dict.fromkeys(name for names in speeds.limit.values() for name in names if name)
    never = "; 0 m/s: not for long at any speed" * any((speed == 0.0).any() for speed in speeds.speed.values())
    yield f"Limited by {_listed(by)}{never}." if by else "No limit is known."
    if len(speeds.speed) > 1 or speeds.failed:
        yield "Without: the motor of that wheel has failed, and neither it nor its gearhead resists."
    if speeds.estimated:
        yield f"Estimated, at the middle of its band: {_listed(speeds.estimated)}."
    if speeds.unknown:
        yield f"Unknown and not looked at: {_listed(speeds.unknown)}."


def _listed(titles: Iterable[str]) -> str:
    return "; ".join(f"{title[0].lower()}{title[1:]}" for title in titles)


# -- Kinematics and dynamics of a spec's platform in numbers, as every output prints them.


class PlatformNumbers(NamedTuple):
    """The tables of a platform, and sentences on what they are of."""

    rotors: str
    moment: str
    wheels: Numbers
    mobility: Numbers
    matrices: list[Numbers]
    at_instant: tuple[Numbers, Numbers]  # course, forces


def platform_numbers(spec: RobotSpec, drive: DriveSet | None) -> PlatformNumbers:
    """Tables of a platform."""
    at = hardest_instant(spec, drive.rotors_at_load if drive else 0.0)
    d = at.dynamics
    wheels, mobility = robot_figures.wheel_table(d), robot_figures.mobility(d)
    at_instant = robot_figures.robot_at_instant(d, at.instant)
    return PlatformNumbers(_rotors(drive), _moment(at), wheels, mobility, robot_figures.matrices(d), at_instant)


class EquationNumbers(NamedTuple):
    """An equation with the numbers of a platform: its name, sentences on what they are of, then result and terms."""

    of: str
    remarks: list[str]
    tables: list[Numbers]


def equation_of(declared: MatrixEquation, spec: RobotSpec, drive: DriveSet | None, turning: bool) -> EquationNumbers:
    """An equation of the platform with the numbers of a spec."""
    at = hardest_instant(spec, drive.rotors_at_load if drive else 0.0)
    eta = 0.3 * at.dynamics.kinematics.motions.sum(axis=1)  # a motion with something of each that the wheels allow
    other = Instant(np.array([1.0, 2.0, 0.5]), eta, 2.0 * eta)
    try:
        tables, others = (robot_figures.numbers_of(declared, robot_figures.figures(at.dynamics, instant))
                          for instant in (at.instant, other))  # fmt: skip
    except InputError as error:
        raise InputError(f"{spec.where(('platform',))}: {error}") from None
    moves = any((table.values != other.values).any() for table, other in zip(tables, others, strict=True))
    remarks = [_moment(at)] if moves else []
    return EquationNumbers(spec.name, [*remarks, *([_rotors(drive)] if turning else [])], tables)


def _rotors(drive: DriveSet | None) -> str:
    of = f"with motor and gearhead of {drive.label}" if drive else "without rotors, as there is no drive"
    return f"Inertias of the wheels are {of}."


def _moment(at: HardestInstant) -> str:
    when = f"{at.time:.4g} s{f' of load case {at.case}' if at.case else ''}"
    return f"What changes with the motion is that at {when}, where wheel {at.wheel} has its largest torque."


def formula(numbers: Numbers) -> str:
    """The equation that a table is the result of, as text; empty where it is of none."""
    if not numbers.equations:
        return ""
    declared = PLATFORM[numbers.equations[0]]
    return f"{declared.symbol} = {text(declared.computed)}"


class Printed(NamedTuple):
    """A table as text: the unit of all its entries where they share one, heads, and cells by row."""

    unit: str
    heads: tuple[str, ...]
    cells: list[tuple[str, ...]]


def printed(numbers: Numbers, *, above: bool = True) -> Printed:
    """A table with each unit once: above it, else at the head of its column, else in its cells."""
    columns = list(zip(*numbers.values.tolist(), strict=True)), list(zip(*numbers.units, strict=True))
    shared = [{u for v, u in zip(*column, strict=True) if v} for column in zip(*columns, strict=True)]
    of_all = set().union(*shared)
    if above and len(of_all) <= 1:
        unit, heads, apart = next(iter(of_all), ""), numbers.columns, [True] * len(shared)
    else:
        unit, apart = "", [len(units) <= 1 for units in shared]
        heads = tuple(f"{head} {f'({label(*units)})' if alike and label(*units or ('1',)) else ''}".strip()
                      for head, units, alike in zip(numbers.columns, shared, apart, strict=True))  # fmt: skip
    cells = [
        tuple(cell(v, "1" if alone else u) for v, u, alone in zip(values, units, apart, strict=True))
        for values, units in zip(numbers.values.tolist(), numbers.units, strict=True)
    ]
    return Printed(label(unit), heads, cells)


def cell(value: float, unit: str) -> str:
    """An entry with its unit, to four digits.

    Examples
    --------
    >>> cell(0.0, "kg*m"), cell(47.204, "kg")
    ('0', '47.2 kg')
    """
    return f"{value:.4g} {label(unit)}".rstrip() if value else "0"
