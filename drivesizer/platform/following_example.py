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
from drivesizer.platform.misjudged import EXACT, Misjudged
from drivesizer.platform.route import route
from drivesizer.platform.slip import Contact
from drivesizer.platform.trajectory import Trajectory
from drivesizer.platform.wheels import Payload, Platform, table_wheel

__all__ = ["ASSUMED", "CASES", "FLOOR", "MEASURED", "OFF", "Case", "paper_robot", "paper_route", "run"]

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

ASSUMED: tuple[tuple[str, str], ...] = (
    ("inertia of the platform", "2.34 kg·m², a plate of 707 mm × 350 mm"),
    ("height of the centre of mass", "0.1 m"),
    ("inertia of a wheel", "2.85e-3 kg·m², a cylinder of rubber and aluminium"),
    ("inertia of rotor and gearhead at the wheel", "3.4e-3 kg·m², 142 g·cm² behind 1:15.4"),
    ("rolling resistance of wheels, and of rollers", "0.02 and 0.02 of the load"),
    ("grip", "0.6 of the load; slip stiffness 15 times the load, of the order of tyres (Pacejka), and 1 mm/s at rest"),
    ("path", "91.8 m, straights and arcs of 3 m, 1 m/s, 0.5 m/s² at both ends, heading turned by 1.5, -2 and 1 rad"),
    ("controllers", "speed loops of 1 ms, 8 N·m at most; a pose every 50 ms where it is fed back"),
    ("radii", "0.5 % larger than believed, the one in front at the right 0.1 mm more"),
    ("places of the wheels", "1 % farther out than believed"),
    ("payload that the model does not know", "5 kg, 0.2 m before the middle and 0.3 m up"),
    ("rolling resistance", "0.025 instead of 0.02"),
    ("motor in front at the left", "5 % weak"),
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


@cache
def paper_route() -> Trajectory:
    """Some 90 m of straights and arcs, with three changes of heading."""
    arc = 3.0 * math.pi / 2.0
    legs = [(20.0, 0.0), (arc, 1 / 3.0), (15.0, 0.0), (arc, -1 / 3.0), (20.0, 0.0), (2.0 * arc, 1 / 3.0), (18.0, 0.0)]
    turns = [(4.0, 12.0, 1.5), (30.0, 42.0, -2.0), (70.0, 78.0, 1.0)]
    return route(legs, speed=1.0, acceleration=0.5, turns=turns)


def run(case: Case) -> Followed:
    """Drive the path in one way.

    Parameters
    ----------
    case
        Which.
    """
    d = dynamics(paper_robot())
    speeds = speed_loop(d, limit=8.0, integral=case.integral)
    poses = pose_loop(d, speeds) if case.poses else None
    off = EXACT if case.exact else OFF
    return follow(paper_route(), d.platform, model=case.model, misjudged=off, contact=FLOOR, speeds=speeds, poses=poses)
