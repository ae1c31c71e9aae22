"""Wheels that slip: against SciPy's integrators on Newton's laws, the model without slip, closed forms, energy."""

import math
from dataclasses import replace

import numpy as np
import pytest
from following_paths import drive
from platforms import MASS, RADIUS, WHEEL, acceleration, differential, mecanum, omni_three
from refusals import refusal
from scipy.integrate import solve_ivp

from drivesizer.control.path_following import Contact
from drivesizer.control.path_following.kernel import grip, grip_slope
from drivesizer.platform.dynamics import Ground, contact_loads, dynamics
from drivesizer.platform.kinematics import Caster, Platform, wheel_speeds, without_motor

G = 9.80665
STIFF = Contact(slip_speed=1e-6)


def omni(**more):
    wheels = tuple(replace(w, **({"inertia": 4e-3} | more)) for w in omni_three(0.06, 0.3))
    return Platform(wheels=wheels, mass=25.0, inertia=1.1)


# --- the law ----------------------------------------------------------------------------------------------------------


def test_slope_of_the_grip_is_its_rate_of_change():
    x, h = np.linspace(-4.0, 4.0, 33), 1e-5
    rate = [(grip(a + h) - grip(a - h)) / (2.0 * h) for a in x]
    assert [grip_slope(grip(a)) for a in x] == pytest.approx(rate, abs=1e-9)


def slip_for(contact, force, load, rolling=0.0):
    """Slip speed that passes on a force [m/s]: the law of ``grip``, the other way round."""
    return (contact.slip_speed + contact.creep * rolling) * math.atanh(force / (contact.friction * load))


def test_little_slip_is_in_proportion_and_much_slip_has_the_friction_coefficient():
    assert grip(1e-4) == pytest.approx(1e-4, rel=1e-6) and grip(20.0) == pytest.approx(1.0)


@pytest.mark.parametrize(("slope", "creep"), [(0.01, 0.0), (0.2, 0.0), (0.2, 0.05)])
def test_slip_of_a_constant_force(slope, creep):
    """Uphill at one speed: each of four wheels holds a quarter of the weight along the slope, by its roller's axis."""
    p, c = mecanum(), Contact(friction=0.7, slip_speed=0.03, creep=creep)
    pull = MASS * G * math.sin(slope) / 4.0
    found = drive(p, np.full((4, 1500), pull * RADIUS), period=1e-3, velocity=(0.8, 0.0, 0.0), contact=c,
                  ground=Ground(slope=slope))  # fmt: skip
    rolling = RADIUS * found.speeds[0, -1]
    wanted = slip_for(c, pull * math.sqrt(2.0), MASS * G * math.cos(slope) / 4.0, rolling)
    assert found.slip[:, -1] == pytest.approx([wanted] * 4, rel=1e-5)
    assert rolling - found.velocity[0, -1] == pytest.approx(wanted * math.sqrt(2.0), rel=1e-5)  # along the heading
    assert found.velocity[0, -1] == pytest.approx(found.velocity[0, -2], abs=1e-9)


def test_a_wheel_that_spins_pulls_with_the_friction_coefficient_and_no_more():
    p = replace(mecanum(), height=0.2)
    found = drive(p, np.full((4, 400), 12.0), period=1e-3, contact=Contact(friction=0.4))
    rate = np.diff(found.velocity[0]) / 1e-3
    assert rate[100:] == pytest.approx(0.4 * G / math.sqrt(2.0), rel=1e-6)  # along rollers at 45 deg
    assert (found.traction <= 0.4 * found.load * (1.0 + 1e-12)).all()
    spin = np.diff(found.speeds[0])[100:] / 1e-3  # what the floor does not take turns the wheel
    assert WHEEL * spin == pytest.approx(12.0 - 0.4 * found.load[0, 200] * RADIUS / math.sqrt(2.0), rel=1e-5)


# --- against other integrators, and the model without slip ------------------------------------------------------------


def by_newton(p, c, ground, torques):
    """Rates of posture, velocity and wheel speeds from forces at each contact point as vectors; loads by iteration."""

    def one(w, speed, u, v, turn, load):
        """Force on the platform at a wheel, and torque on the wheel."""
        ahead = np.array([math.cos(w.heading), math.sin(w.heading)])
        at_point = np.array([u - turn * w.y, v + turn * w.x]) - w.radius * speed * ahead  # of the tread on the floor
        reach = c.slip_speed + c.creep * abs(w.radius * speed)
        if w.held:
            size = np.linalg.norm(at_point)
            force = -c.friction * load * math.tanh(size / reach) * at_point / (size or 1.0)
        else:
            angle = w.heading + w.roller_angle
            along, across = np.array([math.cos(angle), math.sin(angle)]), np.array([-math.sin(angle), math.cos(angle)])
            most = math.sqrt(c.friction**2 - w.roller_resistance**2) * load
            force = -most * math.tanh(at_point @ along / reach) * along
            force -= w.roller_resistance * load * math.tanh(at_point @ across / c.turnround) * across
        resists = (w.rolling_resistance * w.radius * load + w.friction) * math.tanh(w.radius * speed / c.turnround)
        return force, -w.radius * (force @ ahead) - resists

    def rates(_, y):
        theta, (u, v, turn), speeds = y[2], y[3:6], y[6:]
        down = G * math.sin(ground.slope)
        weight = -p.mass * down * np.array([math.cos(ground.uphill - theta), math.sin(ground.uphill - theta)])
        accelerated = np.zeros(2)
        for _ in range(60):
            load = np.maximum(contact_loads(p, theta, ground, accelerated), 0.0)
            found = [one(w, s, u, v, turn, n) for w, s, n in zip(p.wheels, speeds, load, strict=False)]
            pulls = [(w.x, w.y, *f) for w, (f, _) in zip(p.wheels, found, strict=True)]
            for k, n in zip(p.casters, load[len(p.wheels) :], strict=True):
                at_point = np.array([u - turn * k.y, v + turn * k.x])
                size = np.linalg.norm(at_point)
                pull = -k.rolling_resistance * n * math.tanh(size / c.turnround) * at_point / (size or 1.0)
                pulls.append((k.x, k.y, *pull))
            force = np.sum([f[2:] for f in pulls], axis=0) + weight
            before, accelerated = accelerated, force / p.mass
            if np.abs(accelerated - before).max() < 1e-13:
                break
        moment = sum((x - p.x) * fy - (y - p.y) * fx for x, y, fx, fy in pulls)  # about the centre of mass
        spin = moment / p.inertia
        a = accelerated - np.array([-spin * p.y - turn**2 * p.x, spin * p.x - turn**2 * p.y])  # of the reference point
        turning = [(t + torque) / (w.inertia + w.rotor_inertia)
                   for w, (_, torque), t in zip(p.wheels, found, torques, strict=True)]  # fmt: skip
        cs, sn = math.cos(theta), math.sin(theta)
        return [cs * u - sn * v, sn * u + cs * v, turn, a[0] + turn * v, a[1] - turn * u, spin, *turning]

    return rates


SMALL = [
    (replace(mecanum(rolling_resistance=0.02, roller_resistance=0.03, friction=0.01), x=0.05, y=-0.03, height=0.2),
     [0.9, 0.4, -0.3, 0.8]),
    (replace(differential(inertia=0.02, rolling_resistance=0.02), x=0.06, height=0.3,
             casters=(Caster(x=0.3, y=0.05, rolling_resistance=0.03), Caster(x=-0.3, y=0.0))), [1.2, 0.5]),
    (replace(omni(), x=-0.02, y=0.04, height=0.1), [0.5, -0.3, 0.2]),
]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(("p", "torques"), SMALL, ids=["mecanum", "differential", "omni"])
def test_the_simulation_is_what_scipy_integrates(p, torques):
    c, ground = Contact(slip_speed=0.05, creep=0.02, turnround=0.02), Ground(slope=0.05, uphill=0.7)
    velocity = (0.5, 0.0 if len(torques) == 2 else 0.3, 0.4)
    found = drive(p, np.array(torques)[:, None] * np.ones((len(torques), 250)), period=2e-3, velocity=velocity,
                  heading=0.3, contact=c, ground=ground, tolerance=1e-8)  # fmt: skip
    start = [0.0, 0.0, 0.3, *velocity, *found.speeds[:, 0]]
    theirs = solve_ivp(by_newton(p, c, ground, torques), (0.0, 0.5), start, method="LSODA", rtol=1e-10, atol=1e-12)
    ours = np.concatenate([found.posture[:, -1], found.velocity[:, -1], found.speeds[:, -1]])
    assert np.abs(theirs.y[:6, -1] - start[:6]).max() > 0.2
    assert ours == pytest.approx(theirs.y[:, -1], abs=2e-6)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
def test_a_tolerance_is_kept(tolerance):
    """The step is of second order, its error of first: what is met is far below the tolerance."""
    p, torques = SMALL[0]
    given = np.array(torques)[:, None] * np.sin(np.arange(200) / 20.0)
    exact = drive(p, given, period=5e-3, tolerance=1e-10).velocity
    assert np.abs(drive(p, given, period=5e-3, tolerance=tolerance).velocity - exact).max() < 2.0 * tolerance


# --- energy, coasting, wheels without a motor -------------------------------------------------------------------------


@pytest.mark.parametrize(("p", "torques"), SMALL, ids=["mecanum", "differential", "omni"])
def test_work_is_what_is_lost_and_what_moves(p, torques):
    given = np.array(torques)[:, None] * np.sin(np.arange(2000) / 150.0 + np.arange(len(torques))[:, None])
    found = drive(p, given, period=1e-3, contact=Contact(slip_speed=0.02), ground=Ground(slope=0.03), heading=0.4)
    rest = found.work - found.lost.sum(axis=0) - (found.kinetic - found.kinetic[0])
    assert np.abs(rest).max() < 1e-5 * max(np.abs(found.work).max(), found.kinetic.max())
    assert (np.diff(found.lost, axis=1) >= -1e-12).all() and found.lost[0, -1] > 0.0
    u, v, turn = found.velocity
    bodies = p.mass * ((u - p.y * turn) ** 2 + (v + p.x * turn) ** 2) + p.inertia * turn**2
    wheels = sum((w.inertia + w.rotor_inertia) * s**2 for w, s in zip(p.wheels, found.speeds, strict=True))
    assert found.kinetic == pytest.approx((bodies + wheels) / 2.0, rel=1e-12)
    driven = np.abs(np.trapezoid(found.torque[:, :-1] * (found.speeds[:, 1:] + found.speeds[:, :-1]) / 2.0, dx=1e-3))
    assert driven.sum() > 0.0


def test_coasting():
    free = drive(mecanum(), np.zeros((4, 1000)), period=1e-3, velocity=(0.7, -0.2, 0.3), contact=STIFF, tolerance=1e-8)
    assert np.ptp(free.kinetic) < 1e-8 * free.kinetic[0]
    # the wheels' share of the inertia stays with the robot's axes: the path bends with them by that share
    share = MASS / (MASS + 4.0 * WHEEL / RADIUS**2)
    along = (0.7 - 0.2j) * np.exp(-0.3j * share * np.arange(1001) / 1e3)
    assert share < 0.96
    assert free.velocity[0] + 1j * free.velocity[1] == pytest.approx(along, abs=1e-6)
    assert free.velocity[2] == pytest.approx(0.3, abs=1e-9)
    braked = drive(mecanum(rolling_resistance=0.03), np.zeros((4, 6000)), period=1e-3, velocity=(1.0, 0.0, 0.0),
                   contact=STIFF)  # fmt: skip
    rate = 0.03 * G * MASS / (MASS + 4.0 * WHEEL / RADIUS**2)
    assert braked.velocity[0, 2000] == pytest.approx(1.0 - 2.0 * rate, rel=1e-4)
    assert braked.posture[0, -1] == pytest.approx(1.0 / (2.0 * rate), rel=2e-3)  # and stands
    assert abs(braked.velocity[0, -1]) < 1e-6


def test_a_free_wheel_is_taken_along_and_a_blocked_one_rests():
    free = without_motor(mecanum(), 1)
    found = drive(free, np.full((3, 500), 0.5), period=1e-3, contact=STIFF)
    assert found.torque[0].max() == 0.0
    taken = wheel_speeds(dynamics(free).kinematics, found.velocity[:, -1])
    assert found.speeds[:, -1] == pytest.approx(taken, rel=1e-4)
    rate = acceleration(dynamics(free), [0.0, 0.0, 0.0], [0.5] * 3)
    assert found.velocity[:, 1] / 1e-3 == pytest.approx(rate, rel=0.01, abs=1e-4)
    blocked = without_motor(mecanum(), 2, blocked=True)
    found = drive(blocked, np.array([[0.4], [0.2], [0.3]]) * np.ones((3, 300)), period=1e-3, contact=STIFF)
    assert np.abs(found.speeds[1]).max() == 0.0
    rate = acceleration(dynamics(blocked), [0.0, 0.0, 0.0], [0.4, 0.2, 0.3])
    assert np.abs(rate).max() > 0.05
    assert found.velocity[:, 1] / 1e-3 == pytest.approx(rate, rel=0.01, abs=1e-4)
    assert np.abs(dynamics(blocked).kinematics.held @ found.velocity).max() < 1e-5  # m/s


def test_a_wheel_that_lifts_off_carries_nothing():
    tall = replace(mecanum(), height=1.5)
    found = drive(tall, np.full((4, 100), 4.0), period=1e-3)
    assert found.load[:2, 50] == pytest.approx([0.0, 0.0])  # in front
    assert found.traction[:2, 50] == pytest.approx([0.0, 0.0])
    assert (found.load >= 0.0).all()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"platform": mecanum(inertia=0.0)}, "following: wheel 1 has no inertia; give inertia or rotor_inertia"),
        ({"platform": mecanum(roller_resistance=0.7)},
         "following: the rollers of wheel 1 resist by 0.7 of the load, no less than the floor's friction, 0.6"),
        ({"ground": Ground(slope=np.zeros(3))}, "following: expected one slope for the whole path"),
        ({"torques": np.full((4, 5), 1e300)}, "following: speeds diverge at 0 s; check torques, gains and periods"),
    ],
)  # fmt: skip
def test_what_cannot_be_driven(change, said):
    assert (
        refusal(lambda: drive(**({"platform": mecanum(), "torques": np.zeros((4, 5)), "period": 1e-3} | change)))
        == said
    )
