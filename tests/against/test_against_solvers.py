"""The machine in motion against SciPy's DOP853, as a textbook has it, under the voltages that the simulation applied.

The machine here is written anew and has no modes. Torques at the motor shaft, with the gears' loss by the direction of
power (H. Giberti, S. Cinquemani, G. Legnani, *Effects of transmission mechanical characteristics on the choice of a
motor-reducer*, Mechatronics 20 (2010) 604-610), T the torque of the driven shaft, e the efficiency, K the reduction:

    L di/dt = u - R i - k w
    J_m dw/dt = k i - f sgn w - b w - T/(K e) where T w > 0, - T e/K where T w < 0
    rigid:       T = T_load(sgn w) + b_l w/K + J_l/K dw/dt
    two masses:  T = c (twist -+ gap/2) + d (w/K - v) while it presses,  J_l dv/dt = T - T_load(sgn v) - b_l v

``test_against_controllers`` closes the loop around it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from textbook_machine import PERIOD, RUBS, SAGS, SHAFT, STEEP, driven, net, on_slope, task_of, textbook

from drivesizer.control.engine import Drive, Task, simulate
from drivesizer.control.gains import design

# --- the machine


# --- under the voltages that were applied


def replayed(m, run, end):
    """Current and speed at the samples under a simulation's voltages; electrical energy and copper loss [J]."""
    s = run.series
    machine, rows, electrical = textbook(m, s["current"][0], s["motor_speed"][0]), [], 0.0
    for u, dt in zip(s["voltage"], np.diff(s["time"], append=end), strict=True):
        rows.append((machine.i, machine.w))
        before = machine.charge
        machine.advance(u, dt)
        electrical += u * (machine.charge - before)
    return np.array(rows).T, electrical, m.resistance * machine.square, machine


@pytest.mark.parametrize(
    ("degrees", "more", "grain"),
    [(0.0, {}, 6e-4), (4.0, RUBS | SHAFT | {"gap": 0.01}, 0.06)],
    ids=["rigid, level", "two masses, uphill"],
)
def test_the_machine_under_the_voltage_that_was_applied(spec, catalog, degrees, more, grain):
    """Exact but for the grain: a change of mode is met up to 1/1024 of a period, 0.4 us, late.

    Rigid, that shows at the reversal: it is still at 0 where the machine runs backward with up to 1270 rad/s^2 (6 A,
    driving), 5e-4 rad/s. A rotor that is alone in the backlash has k i/J_M, up to 1.5e5 rad/s^2: 0.06 rad/s.
    """
    train, drive = driven(spec, catalog, degrees, more)
    run = simulate(drive, task_of(train, *STEEP))
    assert run.figures["time_at_voltage_limit"][0] > 0.02
    speed, current = run.series["motor_speed"], run.series["current"]
    assert speed.max() > 240.0 and speed.min() < -50.0
    found, electrical, copper, end = replayed(drive.train, run, STEEP[0][-1])
    off = np.abs(found[::-1] - (speed, current))
    turn = np.argmax(speed < 0.0)
    assert off[1].max() < 1e-4 and off[0].max() < grain  # A of 10, rad/s of 290
    if not more:
        assert off[:, :turn].max() < 3e-6
    assert run.figures["angle"][0] == pytest.approx(end.angle, abs=1e-4)  # rad, of 30 and more
    assert net(run) == pytest.approx(electrical, rel=1e-5)  # 35 J
    # the simulation takes the current within a period for a parabola; it settles in 0.1 ms, a quarter of that
    assert run.figures["copper_heat"][0] == pytest.approx(copper, rel=1e-4)


def test_copper_loss_under_a_voltage_that_leaps_every_few_periods(spec, catalog):
    """An encoder of few edges: at 300 rad/s a count more or less makes the voltage leap by 2 V, the current by 0.8 A.

    The simulation takes the current within a period for a parabola, of which it settles in a quarter: the loss of the
    ripple comes out too large, by 0.6 % of all at 0.4 ms, by 0.02 % at 0.1 ms. State and electrical energy are exact.
    """
    hilly, train = on_slope(spec, catalog, 3.0)
    m = train
    for n, share in ((1, 8e-3), (4, 2.5e-4)):
        g = replace(design(hilly, train, PERIOD / n), kp=8e-3, ki=0.02)
        task = Task(time=(0.0, 0.08), speed=(300.0 / m.ratio,) * 2)
        run = simulate(Drive(train=m, controller=g, supply=SAGS, edges=64 * n), task)
        found, electrical, copper, _ = replayed(m, run, 0.08)
        assert np.ptp(run.series["voltage"]) > 1.9 and np.ptp(found[0]) > 0.55  # V, A of 1.0
        assert found == pytest.approx(np.array((run.series["current"], run.series["motor_speed"])), abs=1e-9)
        assert net(run) == pytest.approx(electrical, rel=1e-9)  # 0.95 J
        assert 0.0 < run.figures["copper_heat"][0] / copper - 1.0 < share


def test_errors_of_the_load_are_not_those_of_the_motor(spec, catalog):
    """Speed and angle of either mass against what is asked for: the load's angle is the motor's through the gears, less
    the twist of the shaft since the start."""
    train, drive = driven(spec, catalog, 4.0, RUBS | SHAFT | {"gap": 0.01})
    task = task_of(train, *STEEP)
    run, m = simulate(drive, task), drive.train
    s, asked, samples = run.series, np.array(task.speed), round(STEEP[0][-1] / PERIOD)
    assert len(s["time"]) == samples + 1
    own, rows = textbook(m, s["current"][0], s["motor_speed"][0]), []
    start = own.y[2]
    for u in s["voltage"][:-1]:
        rows.append((own.angle / m.ratio, own.angle / m.ratio - (own.y[2] - start), own.y[1] / m.ratio, own.y[3]))
        own.advance(u, PERIOD)
    time = np.arange(samples) * PERIOD
    speed = np.interp(time, task.time, asked)
    turned = np.concatenate(([0.0], np.cumsum(np.diff(task.time) * (asked[1:] + asked[:-1]) / 2.0)))
    piece = np.clip(np.searchsorted(task.time, time + 1e-9) - 1, 0, None)
    angle = turned[piece] + (asked[piece] + speed) / 2.0 * (time - np.array(task.time)[piece])
    motor_way, way, motor, load = np.array(rows).T
    told = {name: float(column[0]) for name, column in run.figures.items()}
    assert told["angle_error"] / m.ratio == pytest.approx(np.abs(angle - motor_way).max(), rel=1e-3)
    assert told["load_angle_error"] == pytest.approx(np.abs(angle - way).max(), rel=1e-3)
    assert told["speed_error"] / m.ratio == pytest.approx(np.abs(speed - motor).max(), rel=1e-3)
    assert told["load_speed_error"] == pytest.approx(np.abs(speed - load).max(), rel=1e-3)
    squares = (np.square(angle - way).sum() * PERIOD, np.square(speed - load).sum() * PERIOD)
    assert (told["load_angle_error_square"], told["load_speed_error_square"]) == pytest.approx(squares, rel=2e-3)
    assert s["load_position_error"][:-1] == pytest.approx(angle - way, abs=2e-4)  # rad
    assert np.abs(way - motor_way).max() > 5e-3  # rad: beyond the tolerances above
