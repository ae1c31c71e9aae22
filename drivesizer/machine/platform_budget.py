"""Mass, clearance, stability and grip of a machine with one drive.

Checks are made in ``platform_checks``; here they are put together with the figures that have no limit, and what was
assumed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import nan

import numpy as np

from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.platform_record import platform_assumptions
from drivesizer.load_cases.platform_wheels import dynamics_of, trajectory_of
from drivesizer.load_cases.requirement_checks import requirement_checks
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.machine.mass_budget import MassBudget
from drivesizer.machine.platform_checks import (
    PlatformOnFloor,
    envelope_checks,
    grip_checks,
    mass_checks,
    stability_checks,
)
from drivesizer.platform.envelope import heading_tolerance, heading_tolerance_driving, turning_circle
from drivesizer.platform.grip import grip_acceleration, grip_slope
from drivesizer.platform.stability import lift_off_acceleration, lift_off_slope, tipping_edges, tipping_slope
from drivesizer.platform.stability_along import least_load, least_margin
from drivesizer.results.check import worst_of_cases
from drivesizer.results.sizing import Check, Figure, Status, verdict
from drivesizer.spec.platform import Platform
from drivesizer.spec.robot import RobotSpec

__all__ = ["MechanicalBudget", "mass_part", "platform_part", "worst_case_budget"]


@dataclass(frozen=True, slots=True, kw_only=True)
class MechanicalBudget:
    """Mass, room, footing and grip of a machine with one drive."""

    mass: MassBudget | None  # None without a budget section
    status: Status
    checks: tuple[Check, ...]
    figures: tuple[Figure, ...]
    assumptions: tuple[str, ...]


def mass_part(mass: MassBudget, sized_for: float | None = None) -> MechanicalBudget:
    """Mass of a machine against its limits."""
    checks = mass_checks(mass, sized_for)
    assumptions, figures = _excluding_mass(mass), tuple(_mass_checks(mass))
    return MechanicalBudget(mass=mass, status=verdict(checks), checks=checks, figures=figures, assumptions=assumptions)


def worst_case_budget(spec: RobotSpec) -> MechanicalBudget:
    """Requirements of a machine, and room, footing and grip of its platform."""
    checks = requirement_checks(spec, spec.requirements) if spec.requirements else ()
    if spec.platform is None:
        return MechanicalBudget(mass=None, status=verdict(checks), checks=checks, figures=(), assumptions=())
    found = [(name, platform_part(_floor_budget(case, spec.margins.torque))) for name, case in spec.load_cases]
    checks += worst_of_cases([(name, part.checks) for name, part in found])
    return replace(found[0][1], checks=checks, status=verdict(checks))


def _floor_budget(case: RobotSpec, needed: float) -> PlatformOnFloor:
    assert case.platform is not None and isinstance(case.load, WheeledVehicle)
    trajectory, gains = trajectory_of(case), None
    if trajectory is None:
        cycle = load_cycle(case)
        gains = cycle.radius * float(np.abs(cycle.acceleration).max())
    return PlatformOnFloor(
        case.platform, case.load, dynamics_of(case), case.environment.gravity, needed, trajectory, gains
    )


def platform_part(s: PlatformOnFloor) -> MechanicalBudget:
    """Room, footing and grip of a platform, whatever drives it."""
    checks = envelope_checks(s.section, s.trajectory) + stability_checks(s) + grip_checks(s)
    figures = (*_envelope_checks(s.section), *_footing_checks(s), *_grip_checks(s))
    assumptions = platform_assumptions(s.section, s.load) + _assumptions(s)
    return MechanicalBudget(mass=None, status=verdict(checks), checks=checks, figures=figures, assumptions=assumptions)


def _excluding_mass(mass: MassBudget) -> tuple[str, ...]:
    if not mass.unknown:
        return ()
    return (f"The machine's mass is without {', '.join(dict.fromkeys(mass.unknown))}: unknown.",)


def _assumptions(s: PlatformOnFloor) -> tuple[str, ...]:
    """Assumptions of footing and grip."""
    return (
        "Wheels and casters are equally stiff on a stiff frame.",
        "The motors share torque by least squares, not as would suit the floor best.",
        *(
            ()
            if s.load.friction_coefficient is None
            else ("Friction is the same in all directions, at rest and slow.",)
        ),
    )


# --- figures that have no limit ---------------------------------------------------------------------------------------


def _figure(name: str, title: str, value: float, kind: str, unit: str, time: float | None = None) -> Figure:
    return Figure(name=name, title=title, value=value, kind=kind, unit=unit, at_time=time)


def _mass_checks(mass: MassBudget) -> Iterator[Figure]:
    counted = "known or estimated" if mass.estimated else "known"
    yield _figure("mass_known", f"Mass, sum of what is {counted}", mass.known, "mass", "kg")
    if mass.limit == mass.limit:
        yield _figure("mass_left", "Mass left of what is allowed", mass.left, "mass", "kg")


def _envelope_checks(section: Platform) -> Iterator[Figure]:
    if section.size is None:
        return
    size = section.size.record
    yield _figure("turning_circle", "Turning circle, diameter", turning_circle(size), "length", "mm")
    for p in section.passages:
        held = heading_tolerance(size, p.width, p.aside)
        driving = heading_tolerance_driving(size, p.width, p.depth, p.aside)
        yield _figure("heading_held", f"Heading error in {p.name}, held", held, "angle", "deg")
        yield _figure("heading_driving", f"Heading error in {p.name}, driving along it", driving, "angle", "deg")


def _footing_checks(s: PlatformOnFloor) -> Iterator[Figure]:
    p = s.d.platform
    if not s.upright:
        return
    known = s.section.height_known
    edge = tipping_edges(p)[0]
    braking = min(lift_off_acceleration(p, direction, s.gravity) for direction in s.directions)
    yield _figure("tipping_distance", "Centre of mass from the nearest tipping edge", edge.distance, "length", "mm")
    yield _figure("lift_off_slope", "Slope that lifts a wheel", lift_off_slope(p) if known else nan, "angle", "deg")
    yield _figure("tipping_slope", "Slope that tips it over", tipping_slope(p) if known else nan, "angle", "deg")
    value = braking if known else nan
    yield _figure("lift_off_acceleration", "Braking that lifts a wheel", value, "acceleration", "m/s^2")
    if s.trajectory is not None and known:
        load, margin = (f(p, s.trajectory, s.ground) for f in (least_load, least_margin))
        yield _figure("wheel_load", "Least load of a wheel on the path", load.value, "force", "N", load.time)
        yield _figure("tipping_margin", "Least way to the tipping edge", margin.value, "length", "mm", margin.time)


def _grip_checks(s: PlatformOnFloor) -> Iterator[Figure]:
    if s.load.friction_coefficient is None or not s.upright:
        return
    friction, known = s.load.friction_coefficient, s.section.height_known
    slope = grip_slope(s.d, friction) if known else nan
    faster = (
        min(grip_acceleration(s.d, friction, direction, gravity=s.gravity) for direction in s.directions)
        if known
        else nan
    )
    yield _figure("grip_slope", "Slope that the floor's grip holds, worst direction", slope, "angle", "deg")
    yield _figure(
        "grip_acceleration",
        "Acceleration that the floor transmits, level, worst direction",
        faster,
        "acceleration",
        "m/s^2",
    )
