"""Load cycles of a platform's wheels: a vehicle's own, Newton's laws with the forces on the floor, work and energy."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from platform_limits import BOTH, DRIVING, TURNING
from platform_vehicles import LOPSIDED, VEHICLE
from platforms import ALPHA, INERTIA, LENGTH, MASS, RADIUS, WHEEL, car, differential, mecanum, omni_three
from refusals import refusal

from drivesizer.files.yaml_source import YamlSource
from drivesizer.load_cases import load_cycle
from drivesizer.loads.course import Profile
from drivesizer.physics.load_cycle import integral
from drivesizer.platform.dynamics import (
    Ground,
    contact_loads,
    dynamics,
    energy,
    motion,
    wheel_torques,
)  # fmt: skip
from drivesizer.platform.kinematics import Caster, Platform
from drivesizer.platform.planner import Limits, Waypoint, plan
from drivesizer.platform.stability import effective_inertia, floor_forces, wheel_cycles
from drivesizer.platform.trajectory import Trajectory
from drivesizer.spec.robot import read_spec

G = 9.80665
LEVER = LENGTH * (math.cos(ALPHA) + math.sin(ALPHA))
START = Waypoint(x=0.0, y=0.0, heading=0.0)
RAMP = Limits(speed=1.5, acceleration=0.75, **TURNING)


def moved(x, y, degrees=0.0, limits=RAMP, pause=1.0):
    return plan([START, Waypoint(x=x, y=y, heading=math.radians(degrees), pause=pause)], limits)


def along(profile, direction=(1.0, 0.0, 0.0)):
    """A profile's motion in one direction of the posture, from the origin."""
    time, speed = np.array(profile.time), np.array(profile.speed)
    h, v = np.diff(time), np.stack([speed[:-1], speed[1:]], axis=1)
    rate = np.diff(v, axis=1) / h[:, None] if profile.acceleration is None else None
    a = np.repeat(rate, 2, axis=1) if rate is not None else np.stack(
        [profile.acceleration[:-1], profile.acceleration[1:]], axis=1)  # fmt: skip
    way = np.cumsum(h * v.mean(axis=1))
    s = np.stack([np.concatenate([[0.0], way[:-1]]), way], axis=1)
    u = np.reshape(direction, (3, 1, 1))
    return Trajectory(h, u * s, u * v, u * a)


def assert_same(cycle, known, size=1e-12):
    for name in ("duration", "speed", "acceleration", "torque"):
        ours, theirs = getattr(cycle, name), getattr(known, name)
        assert ours.shape == theirs.shape, name
        assert ours == pytest.approx(theirs, rel=size, abs=size * np.abs(theirs).max()), name


# --- against a vehicle's load cycle -----------------------------------------------------------------------------------


@pytest.mark.parametrize("resistance", [0.02, 0.0])
@pytest.mark.parametrize("degrees", [0.0, 4.0, -7.0])
def test_a_planned_way_straight_on_is_a_vehicles_load_cycle(degrees, resistance):
    """The same cycle from waypoints and limits as from the sizing part's trapezoid: 1.5 m/s after 2 s, 7.5 m."""
    text = (VEHICLE % degrees).replace("rolling_resistance: 0.02", f"rolling_resistance: {resistance}")
    known = load_cycle(read_spec(YamlSource(text, "x.yaml")))
    d = dynamics(mecanum(rolling_resistance=resistance, rotor_inertia=0.05))
    found = wheel_cycles(d, moved(7.5, 0.0), Ground(slope=math.radians(degrees)))
    assert [c.name for c in found] == ["wheel 1", "wheel 2", "wheel 3", "wheel 4"]
    for cycle in found:
        assert_same(cycle, known)
        assert cycle.inertia == pytest.approx(known.inertia, rel=1e-12)
        assert cycle.radius == known.radius


def test_a_piece_in_which_it_turns_round_is_cut_there():
    """From 1.5 m/s to -0.6 m/s in one piece: what resists changes sides in it, at 1.5 / 2.1 of it."""
    turning = Profile("x", (0.0, 2.0, 5.0, 7.0, 9.0), (0.0, 1.5, 1.5, -0.6, 0.0))
    known = load_cycle(read_spec(YamlSource(VEHICLE % 0.0, "x.yaml")), turning)
    (cycle, *_) = wheel_cycles(dynamics(mecanum(rolling_resistance=0.02)), along(turning))
    assert_same(cycle, known)
    assert cycle.duration[2] == pytest.approx(2.0 * 1.5 / 2.1)
    assert cycle.speed[2, 1] == 0.0
    jump = cycle.torque[3, 0] - cycle.torque[2, 1]
    assert jump == pytest.approx(-2 * 0.02 * MASS * G * RADIUS / 4)


# --- work and energy --------------------------------------------------------------------------------------------------

CURVES = [
    START,
    Waypoint(x=2.0, y=1.0, heading=4.0),
    Waypoint(x=-1.0, y=0.5, heading=-2.0, pause=1.0),
    Waypoint(x=0.0, y=0.0, heading=0.5),
]
ROLLING = replace(
    LOPSIDED,
    y=-0.02,
    height=0.2,
    casters=(Caster(x=0.3, y=0.2, rolling_resistance=0.015),),
    wheels=tuple(
        replace(w, rotor_inertia=0.0, rolling_resistance=0.01 * (1 + i), roller_resistance=0.02, friction=0.03)
        for i, w in enumerate(LOPSIDED.wheels)
    ),
)


def lost(p, m):
    """Power that resists at wheels, rollers and casters, wheel by wheel [W], shape (n, 2)."""
    load, total = contact_loads(p), 0.0
    assert load.min() > 5.0
    for w, N in zip(p.wheels, load, strict=False):
        phi = w.heading + w.roller_angle
        pulled = m.eta[0] * math.cos(phi) + m.eta[1] * math.sin(phi)
        pulled = pulled + m.eta[2] * (w.x * math.sin(phi) - w.y * math.cos(phi))
        speed = pulled / (w.radius * math.cos(w.roller_angle))
        across = -(m.eta[0] - w.y * m.eta[2]) * math.sin(phi) + (m.eta[1] + w.x * m.eta[2]) * math.cos(phi)
        roller = across + w.radius * math.sin(w.roller_angle) * speed
        total = total + (w.rolling_resistance * N * w.radius + w.friction) * np.abs(speed)
        total = total + w.roller_resistance * N * np.abs(roller)
    for c, N in zip(p.casters, load[len(p.wheels) :], strict=True):
        total = total + c.rolling_resistance * N * np.hypot(m.eta[0] - c.y * m.eta[2], m.eta[1] + c.x * m.eta[2])
    return total


@pytest.mark.parametrize("share", [0.2, 0.5, 0.8, 1.0])
def test_work_of_the_wheels_is_kinetic_energy_and_what_resists(share):
    """Over a way with curves, stopped anywhere: the sum of the wheels' work, no torque known."""
    t = plan(CURVES, Limits(**DRIVING, **TURNING, jerk=2.0))
    n = int(share * len(t.duration))
    part = Trajectory(t.duration[:n], t.posture[:, :n], t.velocity[:, :n], t.acceleration[:, :n])
    d = dynamics(ROLLING)
    work = sum(integral(c.duration, c.torque, c.speed) for c in wheel_cycles(d, part))
    m = motion(d, part)
    heat = float(m.duration @ lost(ROLLING, m).mean(axis=1))
    assert heat > 1.0
    assert work == pytest.approx(energy(d, m.eta[:, -1, 1]) + heat, rel=1e-4)


def test_on_a_slope_the_work_is_what_it_climbs():
    p, ground = replace(LOPSIDED, height=0.2), Ground(slope=0.1, uphill=0.7)
    t = plan(CURVES, BOTH)
    x, y, theta = t.posture[:, [0, -1], [0, 1]]
    x, y = x + p.x * np.cos(theta) - p.y * np.sin(theta), y + p.x * np.sin(theta) + p.y * np.cos(theta)
    climbed = math.sin(0.1) * (x * math.cos(0.7) + y * math.sin(0.7))
    cycles = wheel_cycles(dynamics(p), t, ground)
    work = sum(integral(c.duration, c.torque, c.speed) for c in cycles)
    assert work == pytest.approx(MASS * G * (climbed[1] - climbed[0]), abs=2e-3)


# --- the floor --------------------------------------------------------------------------------------------------------


def forces_on_the_floor(d, m):
    """Their size at each driven wheel [N]."""
    forces = floor_forces(d, m)
    return np.hypot(*forces)[list(d.kinematics.driven)]


def test_forces_on_the_floor_are_newtons():
    """Along the rollers' axes they make the acceleration of the centre of mass and the moment about it."""
    p = replace(LOPSIDED, height=0.2, wheels=tuple(replace(w, rolling_resistance=0.02) for w in LOPSIDED.wheels))
    d, t = dynamics(p), plan(CURVES, BOTH)
    m = motion(d, t)
    size = forces_on_the_floor(d, m)
    torque = wheel_torques(d, m, rotors=False)
    rest = contact_loads(p)[:, None, None]
    gain = np.einsum("ij,jkl->ikl", d.kinematics.E, m.eta_dot)
    turning = np.sign(np.einsum("ij,jkl->ikl", d.kinematics.E, m.eta).mean(axis=2, keepdims=True))
    f = (torque - 0.02 * gain - 0.02 * rest * RADIUS * turning) / (RADIUS * math.cos(math.pi / 4))
    still = np.abs(m.eta).max(axis=(0, 2)) == 0.0
    assert size[:, ~still] == pytest.approx(np.abs(f)[:, ~still], abs=1e-6)
    fx = fy = moment = 0.0
    for w, pull in zip(p.wheels, f, strict=True):
        angle = w.heading + w.roller_angle
        fx, fy = fx + pull * math.cos(angle), fy + pull * math.sin(angle)
        moment = moment + pull * ((w.x - p.x) * math.sin(angle) - (w.y - p.y) * math.cos(angle))
    theta = m.theta
    offset = p.x * np.cos(theta) - p.y * np.sin(theta), p.x * np.sin(theta) + p.y * np.cos(theta)
    turn, spin = m.eta[2], m.eta_dot[2]
    world = t_acceleration(t, m)
    ax = world[0] - spin * offset[1] - turn**2 * offset[0]
    ay = world[1] + spin * offset[0] - turn**2 * offset[1]
    assert fx * np.cos(theta) - fy * np.sin(theta) == pytest.approx(MASS * ax, abs=2e-2)
    assert fx * np.sin(theta) + fy * np.cos(theta) == pytest.approx(MASS * ay, abs=2e-2)
    assert moment == pytest.approx(INERTIA * spin, abs=2e-3)


def t_acceleration(t, m):
    """Of the reference point in the world, where the motion's pieces are [m/s^2]."""
    edges = np.cumsum(m.duration)
    moment = np.stack([edges - m.duration, edges], axis=1)
    i = np.searchsorted(t.time[:, 1], moment.mean(axis=1))
    share = ((moment - t.time[i, :1]) / t.duration[i, None]).clip(0.0, 1.0)
    return t.acceleration[:, i, :1] * (1 - share) + t.acceleration[:, i, 1:] * share


def test_a_differential_drive_in_a_curve_grips_sideways_too():
    """10 m/s² towards the middle at 2 m/s on 0.4 m: 30 kg · 10 m/s², half of it at each wheel; torques are 0."""
    for c in wheel_cycles(dynamics(differential()), on_a_circle(0.4, 2.0), friction=0.7):
        (grip,) = c.own
        assert grip.demand == pytest.approx(150.0)
        assert grip.limit == pytest.approx(0.7 * 15.0 * G)
        assert np.abs(c.torque).max() < 1e-9


def test_grip_is_judged_where_it_is_least_beside_the_load():
    """Braking from 1.5 m/s at 3 m/s², the centre of mass 0.4 m high: the rear carries little, and slips first."""
    height, base = 0.4, 2 * LENGTH * math.cos(ALPHA)
    p = replace(mecanum(), height=height)
    t = moved(4.0, 0.0, limits=Limits(speed=1.5, acceleration=3.0))
    shift = MASS * 3.0 * height / base / 2
    for i, c in enumerate(wheel_cycles(dynamics(p), t, friction=0.6)):
        (grip,) = c.own
        assert grip.demand == pytest.approx(MASS * 3.0 / 4 * math.sqrt(2))  # along the roller's axis: 1 / cos 45°
        assert grip.limit == pytest.approx(0.6 * (MASS * G / 4 - shift))
        slowing = t.total - 1.0 - 0.5
        assert grip.time == pytest.approx(0.0 if i in (0, 1) else slowing)  # wheels 3 and 4 are the rear
    unknown = wheel_cycles(dynamics(p), t)[0].own[0]
    assert math.isnan(unknown.limit) and unknown.demand == pytest.approx(47.73, abs=0.01)


def test_a_wheel_that_lifts_off_grips_nothing():
    p = replace(mecanum(), height=1.5)
    way = moved(4.0, 0.0, limits=Limits(speed=1.5, acceleration=4.0))
    (grip,) = wheel_cycles(dynamics(p), way, friction=0.6)[0].own
    assert grip.limit == 0.0 < grip.demand


def on_a_circle(radius, speed, angle=1.0, pieces=40):
    """At an even speed along a circle, looking along it; acceleration is towards the middle only."""
    phi, turning = np.linspace(0.0, angle, pieces + 1), speed / radius
    posture = np.array([radius * np.sin(phi), radius * (1 - np.cos(phi)), phi])
    velocity = np.array([speed * np.cos(phi), speed * np.sin(phi), np.full_like(phi, turning)])
    gain = speed * turning * np.array([-np.sin(phi), np.cos(phi), np.zeros_like(phi)])
    ends = (np.stack([c[:, :-1], c[:, 1:]], axis=2) for c in (posture, velocity, gain))
    return Trajectory(np.full(pieces, angle / turning / pieces), *ends)


def test_the_floor_does_not_see_what_turns_the_rotors():
    """Of a car that speeds up in a curve: what is held sideways at its wheels, whatever the rotors."""
    time, bend = np.linspace(0.0, 2.0, 41), math.tan(0.35) / 1.1
    phi, (c, s) = bend * time**2 / 2, (np.cos(bend * time**2 / 2), np.sin(bend * time**2 / 2))
    posture = np.array([s / bend, (1 - c) / bend, phi])
    velocity = time * np.array([c, s, np.full_like(c, bend)])
    gain = np.array([c, s, np.full_like(c, bend)]) + bend * time**2 * np.array([-s, c, 0 * c])
    t = Trajectory(np.diff(time), *(np.stack([a[:, :-1], a[:, 1:]], axis=2) for a in (posture, velocity, gain)))
    for p in (car(1.1, 0.6, 0.35), replace(car(1.1, 0.6, 0.35), x=0.3, y=0.1)):
        heavy = replace(p, wheels=tuple(replace(w, rotor_inertia=0.2) if w.drive == "motor" else w for w in p.wheels))
        forces = []
        for d in (dynamics(p), dynamics(heavy)):
            m = motion(d, t)
            forces.append(forces_on_the_floor(d, m))
        assert forces[1] == pytest.approx(forces[0], rel=1e-9)
        assert forces[0].max() > 1.0


# --- inertia ----------------------------------------------------------------------------------------------------------


def test_the_inertia_of_wheels_together():
    assert effective_inertia(dynamics(mecanum(rotor_inertia=0.3))) == pytest.approx(WHEEL + MASS * RADIUS**2 / 4)
    heavy = replace(mecanum(), inertia=20.0)  # turning is harder than driving: 20 / 0.3735² > 45
    assert effective_inertia(dynamics(heavy)) == pytest.approx(WHEEL + 20.0 * RADIUS**2 / (4 * LEVER**2))
    assert effective_inertia(dynamics(differential(inertia=0.01))) == pytest.approx(0.01 + 30.0 * 0.1**2 / 2)
    three = Platform(wheels=tuple(omni_three(0.05, 0.2)), mass=20.0, inertia=0.4)
    assert effective_inertia(dynamics(three)) == pytest.approx(20.0 * 0.05**2 * 2 / 3)


# --- cuts, rests, refusals --------------------------------------------------------------------------------------------


def test_no_wheel_turns_round_within_a_piece_nor_its_torque():
    d = dynamics(ROLLING)
    t = plan(CURVES, BOTH)
    m = motion(d, t)
    for rows in (d.kinematics.E, d.kinematics.rollers):
        speed = np.einsum("ij,jkl->ikl", rows, m.eta)
        assert (speed[..., 0] * speed[..., 1] > -1e-15).all()
    assert m.duration.sum() == pytest.approx(t.total, rel=1e-12)
    for c in wheel_cycles(d, t):
        assert (c.speed.prod(axis=1) >= 0.0).all() and (c.torque.prod(axis=1) >= 0.0).all()
        assert c.total == pytest.approx(t.total, rel=1e-12)


@pytest.mark.parametrize("heading", np.linspace(-3.0, 3.0, 13).round(2).tolist())
def test_rounding_is_no_turning_round(heading):
    """Along a diagonal of the robot two wheels stand; what is left of their speed cuts no piece."""
    d = dynamics(mecanum(rolling_resistance=0.02))
    way = heading + math.pi / 4
    there = Waypoint(x=3 * math.cos(way), y=3 * math.sin(way), heading=heading)
    t = plan([Waypoint(x=0.0, y=0.0, heading=heading), there], replace(RAMP, jerk=2.0))
    assert len(motion(d, t).duration) == len(t.duration)
    for i in (1, 3):
        assert not wheel_cycles(d, t)[i].speed.any()


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda d, t: wheel_cycles(dynamics(differential()), moved(0.0, 1.0)),
         "trajectory at 1.155 s: it slides wheel 1 by 0.866 m/s"),
        (lambda d, t: wheel_cycles(dynamics(differential()), moved(1.0, 0.0, degrees=90.0)), "trajectory at "),
    ],
)  # fmt: skip
def test_refusals_are_one_line(make, words):
    assert refusal(lambda: make(dynamics(mecanum()), moved(1.0, 0.0))).startswith(words)
