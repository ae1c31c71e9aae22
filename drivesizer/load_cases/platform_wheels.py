"""A platform on its trajectory as load cases: one for each driven wheel, wheels with equal load cycles as one.

A drive is sized for all of them: for the worst wheel. What the supply and the battery give is shared by all wheels; the
checks of the supply take every wheel as the one of the case, the battery's add up what each draws.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from drivesizer.errors import InputError
from drivesizer.files.csv_columns import path_from_spec
from drivesizer.load_cases.platform_record import platform_of
from drivesizer.load_cases.wheel import wheel_load
from drivesizer.loads.wheeled_vehicle import WheeledVehicle, wheel_friction
from drivesizer.physics.load_cycle import Ends, LoadCycle, OwnLimit, rms
from drivesizer.platform.contact_loads import Ground, contact_loads
from drivesizer.platform.dynamics import Dynamics, dynamics, own_rolling
from drivesizer.platform.planner import Limits, Waypoint, plan
from drivesizer.platform.track import read_track
from drivesizer.platform.trajectory import Trajectory
from drivesizer.platform.wheel_cycles import wheel_cycles
from drivesizer.spec.motions import Track, Waypoints
from drivesizer.spec.robot import AS_SPECIFIED, RobotSpec

__all__ = ["cycles_of", "dynamics_of", "floor_friction", "ground_of", "limits_of", "trajectory_of", "wheels"]

_SAME = 1e-9  # of the largest figure


def trajectory_of(spec: RobotSpec) -> Trajectory | None:
    """The trajectory of the platform; None where the spec's motion is none."""
    motion = spec.motion
    if isinstance(motion, Track):
        path = path_from_spec(spec.file, motion.trajectory, spec.where(("motion", "trajectory")))
        return read_track(path, limits_of(spec), motion.smoothing, spec.where(("motion", "smoothing")))
    if isinstance(motion, Waypoints):
        limits = limits_of(spec)
        if limits is None:
            where = spec.where(("platform", "limits"))
            raise InputError(f"{where}: expected speed and acceleration to plan the waypoints with, e.g. speed: 1 m/s")
        points = [Waypoint(x=p.x, y=p.y, heading=p.heading, pause=p.pause) for p in motion.waypoints]
        with _located(spec, "motion", "waypoints"):
            return plan(points, limits)
    return None


@contextmanager
def _located(spec: RobotSpec, *path: str | int) -> Iterator[None]:
    """Say of what is wrong inside where the spec has it."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{spec.where(path)}: {str(error).removeprefix(f'{path[-1]}: ')}") from None


def limits_of(spec: RobotSpec) -> Limits | None:
    """Limits of the platform's motion; None where speed or acceleration is not given."""
    given = spec.platform.limits if spec.platform else None
    if given is None or given.speed is None or given.acceleration is None:
        return None
    with _located(spec, "platform", "limits"):
        return Limits(**{name: getattr(given, name) for name in type(given).model_fields})


def dynamics_of(spec: RobotSpec, rotor_inertia: float = 0.0) -> Dynamics:
    """Kinematics and dynamics of a spec's platform."""
    assert spec.platform is not None and isinstance(spec.load, WheeledVehicle)
    with _located(spec, "platform"):
        return dynamics(platform_of(spec.platform, spec.load, rotor_inertia))


def ground_of(spec: RobotSpec) -> Ground:
    """The floor that a spec's platform stands on."""
    assert spec.platform is not None and isinstance(spec.load, WheeledVehicle)
    return Ground(slope=spec.load.slope, uphill=spec.platform.uphill, gravity=spec.environment.gravity)


def floor_friction(spec: RobotSpec, force: float) -> float:
    """Force that friction transmits at a driven wheel of a vehicle straight on, of a platform at its worst [N]."""
    load, section, g = spec.load, spec.platform, spec.environment.gravity
    assert isinstance(load, WheeledVehicle)
    if section is None:
        return wheel_friction(load, g)
    if load.friction_coefficient is None or not section.height_known:
        return math.nan
    p = platform_of(section, load)
    gains = np.array([1.0, -1.0]) * load.driven_wheels * force / p.mass - g * math.sin(load.slope)
    ground = Ground(slope=load.slope, gravity=g)
    carried = contact_loads(p, 0.0, ground, (gains, 0.0 * gains))[: len(p.wheels)].min(axis=1)
    held = [n * math.cos(w.roller_angle) for n, w in zip(carried, p.wheels, strict=True) if w.drive == "motor"]
    return load.friction_coefficient * max(float(min(held)), 0.0)


def wheels(name: str, case: RobotSpec) -> Iterator[tuple[str, RobotSpec]]:
    """A load case of a platform as those of its wheels, the one of the largest RMS torque first."""
    if not isinstance(case.motion, Track | Waypoints):
        yield name, case
        return
    d, trajectory = dynamics_of(case), trajectory_of(case)
    assert trajectory is not None and isinstance(case.load, WheeledVehicle)
    cycles, driven = cycles_of(case, d, trajectory), d.kinematics.driven
    rolling = own_rolling(d, contact_loads(d.platform, ground=Ground(gravity=case.environment.gravity)))
    for alike in sorted(_groups(cycles), key=lambda group: -rms(cycles[group[0]].duration, cycles[group[0]].torque)):
        which = _listed([driven[i] + 1 for i in alike])
        cycle = _with_the_worst_limits([cycles[i] for i in alike])
        own = float(rolling[driven[alike[0]]])
        load = wheel_load(cycle, case.load.driven_wheels, alike, trajectory.length, name, own)
        one = case.alone(load=load, motion=None)
        yield (which if name in ("", AS_SPECIFIED) else f"{name}, {which}"), one


def cycles_of(case: RobotSpec, d: Dynamics, trajectory: Trajectory) -> tuple[LoadCycle, ...]:
    """The load cycle of each driven wheel of a platform on its trajectory, with the grip that it needs.

    What takes load off a wheel is a matter of the machine, whatever drives it: see ``budgets``.
    """
    load = case.load
    assert isinstance(load, WheeledVehicle)
    known = case.platform is not None and case.platform.height_known  # else nobody knows what a wheel carries
    friction = load.friction_coefficient if known else None
    with _located(case, "motion"):
        found = wheel_cycles(d, trajectory, ground_of(case), friction=friction)
    return tuple(replace(cycle, own=tuple(own for own in cycle.own if own.name == "traction")) for cycle in found)


def _groups(cycles: Sequence[LoadCycle]) -> list[list[int]]:
    """Wheels with equal load cycles, in either direction of turning."""
    found: list[list[int]] = []
    for i, cycle in enumerate(cycles):
        group = next((g for g in found if _alike(cycles[g[0]], cycle)), None)
        if group is None:
            found.append([i])
        else:
            group.append(i)
    return found


def _alike(a: LoadCycle, b: LoadCycle) -> bool:
    if len(a.duration) != len(b.duration) or not np.allclose(a.duration, b.duration, rtol=_SAME, atol=0.0):
        return False
    return any(
        all(_near(getattr(a, name), sign * getattr(b, name)) for name in ("speed", "torque")) for sign in (1.0, -1.0)
    )


def _near(a: Ends, b: Ends) -> bool:
    return bool(np.abs(a - b).max() <= _SAME * max(np.abs(a).max(), np.abs(b).max()))


def _with_the_worst_limits(cycles: Sequence[LoadCycle]) -> LoadCycle:
    """The first of cycles alike, with each limit of the load where it is tightest."""
    worst = [max(limits, key=_tightness) for limits in zip(*(cycle.own for cycle in cycles), strict=True)]
    return replace(cycles[0], own=tuple(worst))


def _tightness(own: OwnLimit) -> float:
    return own.demand / own.limit if own.limit > 0.0 else np.inf if own.limit <= 0.0 else own.demand


def _listed(numbers: list[int]) -> str:
    """``wheel 2``, ``wheels 1, 3 and 4``."""
    if len(numbers) == 1:
        return f"wheel {numbers[0]}"
    return f"wheels {', '.join(map(str, numbers[:-1]))} and {numbers[-1]}"
