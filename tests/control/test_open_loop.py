"""A stepper behind its pulses: against its natural frequency, its start without a ramp, statics and SciPy."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drivesizer.control import open_loop
from drivesizer.control.engine import Task
from drivesizer.control.open_loop import Stepper, least_share, simulate
from drivesizer.errors import InputError
from drivesizer.physics.stepper import start_speed

T, J, P = 0.5, 1e-4, 50.0
FULL = 2.0 * math.pi / 200.0
MOVE = Task(time=(0.0, 0.05, 0.3, 0.35, 0.6), speed=(0.0, 20.0, 20.0, 0.0, 0.0))


def stepper(**changes: Any) -> Stepper:
    """A motor of 0.5 N*m with 1 kg*cm^2 at its shaft, undamped and in fine microsteps unless changed."""
    given: dict[str, Any] = {
        "teeth": P, "torque": np.full(9, T), "top_speed": 80.0, "microsteps": 64.0, "damping_ratio": 0.0,
        "motor_inertia": J,
    }  # fmt: skip
    return Stepper(**(given | changes))


def held(lasts: float = 0.3, load: float = 0.0) -> Task:
    return Task(time=(0.0, lasts), speed=(0.0, 0.0), load_time=(0.0, lasts), load_torque=(load, load))


# --- laws


def test_small_swings_have_the_natural_frequency() -> None:
    """One full step of 1/64: swings of 1.4 deg electrical at sqrt(50 * 0.5 / 1e-4) / (2 pi) = 79.58 Hz."""
    one = stepper()
    speed = 0.55 * one.microstep / 0.01
    pulse = Task(time=(0.0, 0.01, 0.01, 0.5), speed=(speed, speed, 0.0, 0.0))  # a single one, at 9.1 ms
    found = simulate(one, pulse, at_rest=True).series
    lag = found["load_angle"]
    up = np.flatnonzero((lag[:-1] < 0.0) & (lag[1:] >= 0.0))
    when = found["time"][up] - lag[up] * (found["time"][up + 1] - found["time"][up]) / (lag[up + 1] - lag[up])
    assert np.abs(lag).max() == pytest.approx(P * one.microstep, rel=1e-3)
    assert 1.0 / np.diff(when).mean() == pytest.approx(79.577, rel=2e-4)
    assert one.natural_frequency == pytest.approx(79.577, rel=1e-5)


@pytest.mark.parametrize("idle", [1.0, 0.6])
@pytest.mark.parametrize("share", [0.1, 0.5])
def test_the_load_angle_at_rest(share: float, idle: float) -> None:
    """Arcsin of load over torque, over the teeth; 0.25 N*m of 0.5 are 30 deg electrical, 0.6 deg of the shaft.

    The torque goes with the idle current: of 0.3 N*m they are 56.4 deg.
    """
    found = simulate(stepper(damping_ratio=0.1, idle=idle), held(load=share * T))
    assert found.figures["lag"] == pytest.approx(math.asin(share / idle), rel=1e-9)
    assert found.figures["error"] == pytest.approx(math.asin(share / idle) / P, rel=1e-9)


def test_less_than_the_load_at_idle_current_loses_steps() -> None:
    assert simulate(stepper(damping_ratio=0.1, idle=0.5), held(load=0.6 * T)).lost
    assert not simulate(stepper(damping_ratio=0.1, idle=0.7), held(load=0.6 * T)).lost


@pytest.mark.parametrize("load", [0.0, 0.15, -0.15])
def test_a_start_above_the_start_stop_speed_loses_steps(load: float) -> None:
    """Undamped, the speed at which it just starts is that of the balance of energy."""
    limit = float(start_speed(P, T, J, abs(load)))
    one = stepper(forward_torque=load, backward_torque=load)
    for share, lost in ((0.99, False), (1.01, True)):
        speed = math.copysign(share * limit, load or 1.0)
        # from the balance at rest the energy of the formula's swing starts at the same angle
        found = simulate(one, Task(time=(0.0, 0.5), speed=(speed, speed)), at_rest=True)
        assert (found.lost > 0) == lost, (load, share)


def test_lost_steps_come_by_fours() -> None:
    fast = 1.02 * float(start_speed(P, T, J))
    found = simulate(stepper(damping_ratio=0.1), Task(time=(0.0, 0.2), speed=(8.0 * fast,) * 2), at_rest=True)
    assert found.lost == found.lost_at_end > 0
    assert found.lost % 4 == 0
    assert found.lost == pytest.approx(8.0 * fast * 0.2 / FULL, abs=4)  # it stands, and all pulses are lost


def test_too_much_torque_slips_a_tooth_at_a_time() -> None:
    found = simulate(stepper(damping_ratio=0.1), held(0.1, 1.05 * T))
    assert found.lost >= 4 and found.lost % 4 == 0
    assert found.figures["slipped"] > 0.0
    assert found.figures["end_lag"] > 0.0  # behind: the load pulls it backward


def test_the_least_share_holds_the_load() -> None:
    """At rest what the load takes of the torque; of slow motion the same and the swings of its start."""
    assert least_share(stepper(), held(load=0.2 * T)) == pytest.approx(0.2, rel=0.012)
    share = least_share(stepper(damping_ratio=0.1), MOVE)
    one = stepper(damping_ratio=0.1)
    assert not simulate(one, MOVE, share=share).lost
    assert any(simulate(one, MOVE, share=(1.0 - less) * share).lost for less in (0.002, 0.005, 0.01))
    assert share > J * 20.0 / 0.05 / T  # no less than the acceleration needs
    heavy = least_share(one, Task(time=(0.0, 0.01, 0.1), speed=(0.0, 80.0, 80.0)))
    assert heavy > 1.0  # 0.8 N*m of 0.5
    assert least_share(one, held(load=10.0 * T)) == math.inf


def test_gears_and_friction_at_a_steady_speed() -> None:
    """(0.3 N*m / (0.8 * 3) + 0.02 N*m) upward and (0.2 * 0.8 / 3 - 0.02) downward, of 0.5 N*m."""
    one = stepper(gear_ratio=3.0, gear_efficiency=0.8, friction=0.02, load_inertia=3e-4, forward_torque=0.3,
                  backward_torque=0.2, rest_torque=0.25, damping_ratio=0.2)  # fmt: skip
    for speed, torque in ((5.0, 0.3 / 2.4 + 0.02), (-5.0, 0.2 * 0.8 / 3.0 - 0.02)):
        found = simulate(one, Task(time=(0.0, 0.4), speed=(speed, speed)))
        most = math.asin(torque / T) + 0.5 * P * one.microstep  # a pulse leads the profile by half a microstep
        assert found.figures["lag"] == pytest.approx(most, rel=0.01)
        assert found.series["motor_torque"][-1] == pytest.approx(torque, rel=0.02)
        assert found.series["gear_torque"][-1] == pytest.approx(0.3 if speed > 0 else 0.2, rel=0.02)


def test_friction_holds_the_rotor_where_it_stops() -> None:
    """Half a microstep of torque does not move a rotor that more friction holds."""
    one = stepper(forward_torque=0.1, backward_torque=-0.1, microsteps=16.0)
    found = simulate(one, Task(time=(0.0, 1.0), speed=(FULL / 10.0, FULL / 10.0)))
    moved = P * FULL / 16.0
    assert math.asin(0.1 / T) <= found.figures["lag"] <= math.asin(0.1 / T) + moved
    assert (found.series["motor_speed"] == 0.0).mean() > 0.5


# --- numbers


@pytest.mark.parametrize("microsteps", [1, 8])
def test_scipy_s_integrator_on_the_same_equations(microsteps: int) -> None:
    """DOP853 from pulse to pulse, of a motor whose torque falls with the speed, with inertia, load and damping."""
    table, load, zeta = np.linspace(0.5, 0.2, 9), 0.05, 0.1
    micro = FULL / microsteps
    one = stepper(torque=table, microsteps=microsteps, damping_ratio=zeta, forward_torque=load, backward_torque=load,
                  rest_torque=load)  # fmt: skip
    motion = Task(time=(0.0, 0.04, 0.1), speed=(0.0, 12.0, 12.0))
    found = simulate(one, motion)
    grid = np.linspace(0.0, 80.0, 9)

    def slope(t: float, y: Any, c: float) -> list[float]:
        v = 12.0 * min(t / 0.04, 1.0)
        pull = float(np.interp(v, grid, table))
        damping, fastest = 2.0 * zeta * math.sqrt(P * pull * J), 2.0 * math.sqrt(pull / (P * J))
        torque = pull * math.sin(P * (c - y[0])) + damping * (v - y[1]) * max(1.0 - abs(v - y[1]) / fastest, 0.0)
        return [y[1], (torque - load) / J]

    last = 12.0 * 0.1 - 12.0 * 0.04 / 2.0
    n = int(last / micro + 0.5)
    at = (np.arange(n) + 0.5) * micro  # angles of the profile at which a pulse comes
    pulses = np.where(at < 0.24, np.sqrt(2.0 * at * 0.04 / 12.0), 0.04 + (at - 0.24) / 12.0)
    edges = np.unique(np.concatenate([[0.0, 0.04, 0.1], pulses[pulses < 0.1]]))
    y, most = [-math.asin(load / 0.5) / P, 0.0], 0.0
    for a, b in pairwise(edges.tolist()):
        c = micro * np.count_nonzero(pulses <= a + 1e-12)
        most = max(most, abs(P * (c - y[0])))
        y = solve_ivp(slope, (a, b), y, args=(c,), method="DOP853", rtol=1e-8, atol=1e-10).y[:, -1].tolist()
    assert found.figures["end_error"] == pytest.approx(last - y[0], abs=1e-6)
    assert found.series["motor_speed"][-1] == pytest.approx(y[1], abs=1e-3)  # rad/s of 12
    assert found.figures["lag"] == pytest.approx(most, rel=1e-3)


def test_a_motion_of_days_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(open_loop, "_MOST", 1000)
    with pytest.raises(InputError, match="more than 1000 steps of a stepper's simulation; expected a shorter one by"):
        simulate(stepper(), Task(time=(0.0, 1e9), speed=(70.0, 70.0)))
