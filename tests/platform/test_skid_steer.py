"""Four fixed wheels that slide while the vehicle turns: the moment of turning by hand, straight ahead, refusals."""

from __future__ import annotations

import numpy as np
import pytest
from platform_specs import SIZE, vehicle
from pydantic import ValidationError

from drivesizer.errors import InputError
from drivesizer.load_cases.platform import platform_of
from drivesizer.platform.dynamics import Moving, dynamics, wheel_torques
from drivesizer.platform.kinematics import wheel_speeds
from drivesizer.platform.stability import floor_forces
from drivesizer.spec.platform import Platform

G, RADIUS = 9.80665, 0.0762
BASE, TRACK, SLIDING = 0.4, 0.5, 0.6
SKID = {"kind": "skid", "wheelbase": "400 mm", "track": "500 mm"}


def skid(**given):
    return Platform.model_validate({"layout": SKID, "size": SIZE, "sliding_friction": SLIDING} | given)


def torques(eta, eta_dot=(0.0, 0.0, 0.0), **given):
    d = dynamics(platform_of(skid(**given), vehicle(rolling_resistance=0.0)))
    return d, wheel_torques(d, Moving(np.array(eta), np.array(eta_dot)))


def test_turning_on_the_spot_by_hand():
    """Kozłowski, Pazderski: M = μ m g a, a the half wheelbase; four wheels at half the track make it: M r / (4 c)."""
    d, found = torques((0.0, 0.0, 1.0))
    moment = SLIDING * 45 * G * BASE / 2
    assert np.abs(found) == pytest.approx(moment * RADIUS / (4 * TRACK / 2))
    assert np.sign(found).tolist() == [1, -1, -1, 1]  # right wheels forwards, left ones back: to the left
    speeds = wheel_speeds(d.kinematics, np.array([0.0, 0.0, 1.0]))
    assert speeds == pytest.approx(np.sign(found) * TRACK / 2 / RADIUS)
    assert found @ speeds == pytest.approx(moment * 1.0)  # what sliding takes
    assert np.abs(floor_forces(d, Moving(np.array([0.0, 0.0, 1.0]), np.zeros(3)))[0]) == pytest.approx(
        moment / TRACK / 2
    )


def test_straight_ahead_nothing_slides_and_a_curve_takes_all_of_the_moment():
    _, ahead = torques((1.0, 0.0, 0.0), (0.5, 0.0, 0.0))
    four = 4 * 32e-4 / RADIUS**2
    assert ahead == pytest.approx((45 + four) * 0.5 * RADIUS / 4)
    _, curve = torques((1.0, 0.0, 0.2))
    _, spot = torques((0.0, 0.0, 1.0))
    assert curve == pytest.approx(spot)  # Coulomb: as soon as it turns
    _, back = torques((1.0, 0.0, -0.2))
    assert back == pytest.approx(-spot)


def test_a_mass_in_front_loads_one_axle_more():
    """The moment is that of loads times their distances from midway: one gains, one loses."""
    _, middle = torques((0.0, 0.0, 1e-3))
    _, front = torques((0.0, 0.0, 1e-3), centre_of_mass={"x": "100 mm", "height": "0 mm"})
    assert front == pytest.approx(middle, rel=1e-6)


def test_it_does_not_move_sideways_and_its_friction_is_given():
    d, _ = torques((1.0, 0.0, 0.0))
    assert d.kinematics.mobility == 2
    with pytest.raises(InputError, match=r"velocity of the platform: it slides wheel 1 by 1 m/s"):
        wheel_speeds(d.kinematics, np.array([0.0, 1.0, 0.0]))
    with pytest.raises(ValidationError, match="give sliding_friction of the skid wheels"):
        skid(sliding_friction=None)
    with pytest.raises(ValidationError, match="sliding_friction: it is of skid wheels; leave it out"):
        skid(layout={"kind": "differential", "track": "500 mm"})
