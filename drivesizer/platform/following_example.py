"""The experiment of Appl. Sci. 2021, 11, 6631, section 6, as a simulation: some 90 m with changes of heading.

The paper measured a real robot and gives neither its path, speed, controllers nor what its models were off by. What
stands here is simulated. Only mass and the places and size of the wheels are the paper's; all else is assumed, was
chosen before the first run and left as it was. One figure was chosen with the paper's 5.1° in sight: one radius is
0.1 mm larger than the others, because radii apart by tenths of a per cent would turn the robot by more than 10°.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

from drivesizer.platform.dynamics import dynamics
from drivesizer.platform.following import Followed, Model, follow
from drivesizer.platform.following_control import pose_loop, speed_loop
from drivesizer.platform.misjudged import EXACT, Misjudged, of_each
from drivesizer.platform.route import route
from drivesizer.platform.slip import Contact
from drivesizer.platform.trajectory import Trajectory
from drivesizer.platform.wheels import Payload, Platform, table_wheel

__all__ = ["CASES", "FLOOR", "MEASURED", "OFF", "Case", "assumptions", "paper_robot", "paper_route", "run"]

MEASURED: dict[str, tuple[float, float]] = {  # section 6: largest error in position [m] and heading [rad]
    "kinematic": (2.78, math.radians(5.1)),
    "dynamic": (0.89, math.radians(0.45)),
}

_L, _ALPHA, _RADIUS = 0.27406, math.radians(29.5), 0.0762  # Table 1

FLOOR = Contact(friction=0.6, slip_speed=1e-3, creep=0.04)

OFF = Misjudged(
    radius=(0.005 + 0.1e-3 / _RADIUS, 0.005, 0.005, 0.005),
    lever=0.01,
    payload=Payload(mass=5.0, x=0.2, height=0.3),
    rolling_resistance=0.005,
    motor=(0.0, -0.05, 0.0, 0.0),
)


@dataclass(frozen=True, slots=True)
class Case:
    """One way to drive the path."""

    model: Model
    integral: bool  # speed loops PI, or plain P
    poses: bool  # fed back
    exact: bool  # the model knows the platform


CASES: tuple[Case, ...] = (
    Case("kinematic", True, False, True),
    Case("dynamic", True, False, True),
    Case("kinematic", False, False, True),
    Case("dynamic", False, False, True),
    Case("kinematic", False, False, False),
    Case("dynamic", False, False, False),
    Case("kinematic", True, False, False),
    Case("dynamic", True, False, False),
    Case("kinematic", True, True, False),
    Case("dynamic", True, True, False),
)


@cache
def paper_robot() -> Platform:
    """The robot of Table 1: front right, front left, rear left, rear right."""
    a = _ALPHA
    places, rollers = (-a, a, math.pi - a, math.pi + a), (1, -1, 1, -1)
    wheels = tuple(
        table_wheel(_L, alpha, math.pi / 2 - alpha, side * math.pi / 4, _RADIUS, inertia=2.85e-3, rotor_inertia=3.4e-3,
                    rolling_resistance=0.02, roller_resistance=0.02)
        for alpha, side in zip(places, rollers, strict=True)
    )  # fmt: skip
    return Platform(wheels=wheels, mass=45.0, inertia=2.34, height=0.1)


_ARC = 3.0 * math.pi / 2.0
_LEGS = ((20.0, 0.0), (_ARC, 1 / 3.0), (15.0, 0.0), (_ARC, -1 / 3.0), (20.0, 0.0), (2.0 * _ARC, 1 / 3.0), (18.0, 0.0))
_TURNS = ((4.0, 12.0, 1.5), (30.0, 42.0, -2.0), (70.0, 78.0, 1.0))
_SPEED, _ACCELERATION, _LIMIT = 1.0, 0.5, 8.0  # m/s, m/s^2, N*m at a wheel


@cache
def paper_route() -> Trajectory:
    """Some 90 m of straights and arcs, with three changes of heading."""
    return route(_LEGS, speed=_SPEED, acceleration=_ACCELERATION, turns=_TURNS)


def assumptions() -> tuple[tuple[str, str], ...]:
    """What the simulation rests on beside the paper's figures, as text."""
    p, way = paper_robot(), paper_route()
    w, load, radii = p.wheels[0], OFF.payload, OFF.radius
    assert load is not None and isinstance(radii, tuple)
    apart = (radii[0] - radii[1]) * _RADIUS
    return (
        ("inertia of the platform", f"{p.inertia:g} kg·m², a plate of 707 mm × 350 mm"),
        ("height of the centre of mass", f"{p.height:g} m"),
        ("inertia of a wheel", f"{w.inertia:g} kg·m², a cylinder of rubber and aluminium"),
        ("inertia of rotor and gearhead at the wheel", f"{w.rotor_inertia:g} kg·m², 142 g·cm² behind 1:15.4"),
        ("resistance of wheels, and of rollers", f"{w.rolling_resistance:g} and {w.roller_resistance:g} of the load"),
        ("grip", f"{FLOOR.friction:g} of the load"),
        ("slip stiffness", f"{FLOOR.friction / FLOOR.creep:.3g} times the load, as of tyres; at rest over "
         f"{1e3 * FLOOR.slip_speed:g} mm/s"),
        ("path", f"{sum(length for length, _ in _LEGS):.3g} m in {way.total:.3g} s, straights and arcs of 3 m; heading "
         f"turned by {', '.join(f'{angle:g}' for *_, angle in _TURNS)} rad"),
        ("speed and acceleration", f"{_SPEED:g} m/s and {_ACCELERATION:g} m/s²"),
        ("controllers", f"speed loops of 1 ms with {_LIMIT:g} N·m at most; a pose every 50 ms where it is fed back"),
        ("misjudged: radii", f"{radii[1]:.1%} larger, in front at the right {1e3 * apart:.1f} mm more"),
        ("misjudged: places of the wheels", f"{OFF.lever:.0%} farther out"),
        ("misjudged: payload", f"{load.mass:g} kg, {load.x:g} m before the middle, {load.height:g} m up, not known"),
        ("misjudged: rolling resistance", f"{OFF.rolling_resistance:g} more"),
        ("misjudged: motor in front at the left", f"{abs(min(of_each(OFF.motor, 4, 'motor'))):.0%} weak"),
    )  # fmt: skip


def run(case: Case) -> Followed:
    """Drive the path in one way.

    Parameters
    ----------
    case
        Which.
    """
    d = dynamics(paper_robot())
    speeds = speed_loop(d, limit=_LIMIT, integral=case.integral)
    poses = pose_loop(d, speeds) if case.poses else None
    off = EXACT if case.exact else OFF
    return follow(paper_route(), d.platform, model=case.model, misjudged=off, contact=FLOOR, speeds=speeds, poses=poses)
