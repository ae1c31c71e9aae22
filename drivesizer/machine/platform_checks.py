"""A machine's mass, room, footing and grip against their limits. Margins are made in ``checks``.

Where a figure is not given that a check needs, such as the height of the centre of mass, the check is unknown and says
which.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import cos, inf, nan, tan
from typing import Any, NamedTuple

import numpy as np

from drivesizer.errors import InputError
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.machine.mass_budget import MassBudget, mass_budget
from drivesizer.platform.contact_loads import Ground, contact_loads
from drivesizer.platform.dynamics import Dynamics
from drivesizer.platform.envelope import corner_width, turning_circle, width_at
from drivesizer.platform.grip import grip_acceleration, grip_slope, translations, worst_friction
from drivesizer.platform.passages import Clearance, clearances
from drivesizer.platform.stability import carrying, support_polygon, used_footing
from drivesizer.platform.stability_along import Moment, least_margin_share, least_share
from drivesizer.platform.trajectory import Trajectory
from drivesizer.results.check_columns import CheckColumn, at_most, fits, over_band
from drivesizer.results.mass import MassRow
from drivesizer.results.sizing import Check
from drivesizer.spec.platform import Budget, PassageSection, Platform
from drivesizer.units import show

__all__ = [
    "PlatformOnFloor",
    "envelope_checks",
    "grip_checks",
    "machine_mass",
    "mass_checks",
    "mass_columns",
    "stability_checks",
]


class PlatformOnFloor(NamedTuple):
    """A platform on its floor, as the checks below take it; ``d`` is that of ``platform_of(section, load)``."""

    section: Platform
    load: WheeledVehicle
    d: Dynamics
    gravity: float  # m/s^2
    needed: float = 0.0  # margin that the spec requires of traction
    trajectory: Trajectory | None = None
    gains: float | None = None  # m/s^2, largest acceleration of its motion, where the limits do not say

    @property
    def faster(self) -> float | None:
        """Largest acceleration that it is held against, in any direction [m/s^2]."""
        return self.section.limits.acceleration or self.gains

    @property
    def ground(self) -> Ground:
        """The floor along the trajectory."""
        return Ground(slope=self.load.slope, uphill=self.section.uphill, gravity=self.gravity)

    @property
    def steepest(self) -> float:
        """The slope, in any orientation of the platform [rad]."""
        return abs(self.load.slope)

    @property
    def upright(self) -> bool:
        """Whether its contacts can keep it upright at all."""
        try:
            return bool(support_polygon(self.d.platform))
        except InputError:
            return False

    @property
    def directions(self) -> tuple[float | None, ...]:
        """Directions in which it gains speed [rad]; None is any."""
        angles = translations(self.d)
        return (None,) if len(angles) > 2 else tuple(float(a) for a in angles)


def _noted(columns: Sequence[CheckColumn], case: str = "") -> tuple[Check, ...]:
    return tuple(c.at((), "budget", cases=(case,)) for c in columns)


def _unknown(column: CheckColumn, note: str) -> CheckColumn:
    """The check as one that may fail but not pass."""
    return replace(column, passed=column.passed & False, note="" if column.failed else note)


# --- mass -------------------------------------------------------------------------------------------------------------


def machine_mass(
    budget: Budget, drive: Sequence[MassRow], *, platform: Platform | None = None, battery: float | None = None
) -> MassBudget:
    """The mass budget of a machine with given rows of its drives."""
    carried = [(item.name if item.number == 1 else f"{item.number} x {item.name}", item.mass * item.number)
               for item in budget.others]  # fmt: skip
    carried += [(payload.name, payload.mass) for payload in (platform.payloads if platform else ())]
    return mass_budget(drive, structure=budget.structure, battery=battery, others=carried, limit=budget.mass)


def mass_checks(found: MassBudget, sized_for: float | None = None) -> tuple[Check, ...]:
    """The known mass against the limit, and against the mass that the drive is sized for."""
    low, high = found.ends
    middle, *ends = (
        mass_columns(np.array([mass]), bool(found.unknown), found.limit, sized_for) for mass in (found.known, low, high)
    )
    if found.estimated:
        one = np.array([0])
        middle = [over_band(mid, pair, one) for mid, *pair in zip(middle, *ends, strict=True)]
    return tuple(_mass_check(found, column) for column in middle)


def _mass_check(found: MassBudget, column: CheckColumn) -> Check:
    """One limit of the mass; where estimated masses decide, from where on and how probable it is that it holds."""
    check = column.at(0, "budget")
    if check.status == "unknown":
        return replace(check, note=f"unknown: {', '.join(dict.fromkeys(found.unknown))}")
    if check.status != "open":
        return check
    parts = ", ".join(dict.fromkeys(found.estimated))
    room = show(check.limit / (1.0 + check.needed) - (found.known - found.guessed), check.unit, "mass", 2)
    return replace(check, probability=found.probability(check.limit),
                   note=f"passes where {parts}, which are estimated, have at most {room} together")  # fmt: skip


def mass_columns(known: Any, lacking: Any, limit: float | None, sized_for: float | None) -> list[CheckColumn]:
    """The known mass against the limits, as columns."""
    limits = {"mass": nan if limit is None else limit, "mass_sized_for": nan if sized_for is None else sized_for}
    columns = [at_most(name, known, most) for name, most in limits.items() if most == most]
    return [replace(column, passed=column.passed & ~np.asarray(lacking, bool)) for column in columns]


# --- room -------------------------------------------------------------------------------------------------------------


def envelope_checks(section: Platform, trajectory: Trajectory | None = None) -> tuple[Check, ...]:
    """Every passage, in the order of the spec; the passage's name is the check's case."""
    placed = [p for p in section.passages if p.x is not None]
    clearance_at = {}
    if trajectory is not None and section.size is not None:
        records = tuple(p.record for p in placed)
        clearance_at = {c.passage: c for c in clearances(trajectory, section.size.record, records)}
    found: list[Check] = []
    for passage in section.passages:
        columns = [*_passage(section, passage), *_along(passage, clearance_at.get(passage.name))]
        found += _noted(columns, passage.name)
    return tuple(found)


def _passage(section: Platform, passage: PassageSection) -> Iterator[CheckColumn]:
    assert section.size is not None
    size, opening = section.size.record, passage.width
    taken = width_at(size, passage.heading_error, passage.aside)
    yield at_most("passage_width", taken, opening)
    if passage.height is not None:
        yield at_most("passage_height", size.height, passage.height)
    if passage.turns:
        yield at_most("passage_turning", turning_circle(size) + 2.0 * passage.aside, opening)
    if passage.corner is not None:
        room = corner_width(size.length, opening, passage.corner)
        yield at_most("passage_corner", size.width, room)


def _along(passage: PassageSection, clearance: Clearance | None) -> Iterator[CheckColumn]:
    """Width that is taken to both sides alike; one that hits a jamb takes more than there is."""
    if clearance is not None:
        note = f"nearest to the {clearance.side} jamb" if clearance.side else "the trajectory does not lead through it"
        taken = passage.width - 2.0 * clearance.least
        time = np.asarray(clearance.time)
        yield at_most("passage_clearance", taken, passage.width, note=note, time=time)


# --- footing ----------------------------------------------------------------------------------------------------------

_NO_HEIGHT = "unknown: height of the centre of mass"
_NO_CASTERS = "unknown: what keeps it upright, its contacts lie on one line"
_NO_FRICTION = "unknown: friction_coefficient"


def stability_checks(s: PlatformOnFloor) -> tuple[Check, ...]:
    """Whether every wheel stays on the floor, at the limits of the motion on the load's slope, and along a trajectory.

    Acceleration and slope may point anywhere that the wheels allow, and are held together against what both may be at
    the same ratio.
    """
    if not s.upright:
        return _noted([replace(fits("centre_of_mass", False, False), note=_NO_CASTERS)])
    at_rest = contact_loads(s.d.platform, ground=Ground(gravity=s.gravity))
    found = [fits("centre_of_mass", bool(carrying(at_rest).all()), True), _limit(s, "lift_off"), _limit(s, "tipping")]
    if s.trajectory is not None:
        found.append(_off(s, "wheel_unloading", least_share(s.d.platform, s.trajectory, s.ground)))
        found.append(_off(s, "tipping_motion", least_margin_share(s.d.platform, s.trajectory, s.ground)))
    return _noted(found)


def _limit(s: PlatformOnFloor, name: str) -> CheckColumn:
    """The acceleration of the limits and that of the slope, worst in their directions."""
    gains, falls = (s.faster or 0.0) / cos(s.steepest), s.gravity * tan(s.steepest)
    required = gains + falls
    if not s.section.height_known:
        return at_most(name, required or nan, nan, note=_NO_HEIGHT)
    used = max(
        used_footing(s.d.platform, ((gains, direction), (falls, None)), tips=name == "tipping", gravity=s.gravity)
        for direction in s.directions
    )
    return at_most(name, required, required / used if used else inf)


def _off(s: PlatformOnFloor, name: str, least: Moment) -> CheckColumn:
    """Largest loss of load or margin over the motion, as a share."""
    if not s.section.height_known:
        return at_most(name, nan, 1.0, note=_NO_HEIGHT)
    time = np.asarray(least.time)
    return at_most(name, 1.0 - least.value, 1.0, time=time, note=_contact(s, least.contact))


def _contact(s: PlatformOnFloor, number: int) -> str:
    wheels = len(s.d.platform.wheels)
    return f"wheel {number}" if number <= wheels else f"caster {number - wheels}"


# --- grip -------------------------------------------------------------------------------------------------------------


def grip_checks(s: PlatformOnFloor) -> tuple[Check, ...]:
    """Whether the floor transmits what the driven wheels must put on it: on the slope, gaining speed, on the path.

    Without the height of the centre of mass a check may fail, but does not pass.
    """
    lacking = _NO_FRICTION if s.load.friction_coefficient is None else "" if s.upright else _NO_CASTERS
    columns = list(_grip(s, nan if lacking else float(s.load.friction_coefficient or 0.0)))
    if lacking:
        return _noted([replace(column, note=lacking) for column in columns])
    return _noted(columns if s.section.height_known else [_unknown(column, _NO_HEIGHT) for column in columns])


def _grip(s: PlatformOnFloor, friction: float) -> Iterator[CheckColumn]:
    known, faster = friction == friction, s.faster
    if s.steepest:
        limit = grip_slope(s.d, friction) if known else nan
        yield at_most("grip_slope", s.steepest, limit, needed=s.needed)
    if faster is not None:
        limits = [
            grip_acceleration(s.d, friction, direction, slope=s.steepest, gravity=s.gravity)
            for direction in s.directions * known
        ]
        yield at_most("grip_acceleration", faster, min(limits, default=nan), needed=s.needed)
    if s.trajectory is not None:
        worst = worst_friction(s.d, s.trajectory, s.ground)
        note, time = _contact(s, worst.contact), np.asarray(worst.time)
        yield at_most("grip_motion", worst.value, friction, needed=s.needed, note=note, time=time)
