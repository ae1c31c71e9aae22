"""The simulation against shorter control periods, and against the balance of energy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_machines import both_ways, machine, one_mode, servo, shafts, shorter
from textbook_machine import PERIOD, RUBS, net, on_slope, slower, task_of

from drivesizer.control.drive_train import Regime
from drivesizer.control.engine import CurrentLimit, Drive, Supply, simulate
from drivesizer.control.gains import design

structures = pytest.mark.parametrize("structure", ["voltage PID", "cascade"])


def controller_of(structure, hilly, train, shaft):
    if structure == "cascade":
        return servo(train, shaft)
    g = design(hilly, train, PERIOD)
    return slower(g) if shaft else g


# --- a shorter control period


@structures
@shafts
def test_half_the_control_period_moves_the_results_by_little(spec, catalog, structure, shaft):
    """With the same gains, through the limits, there and back: largest error, copper loss and electrical energy.

    They settle as the period does. Where in a period the motion turns makes up to 5e-5 of it: as much as half a period.
    """
    hilly, train = on_slope(spec, catalog, 3.0)
    task = task_of(train, (0.0, 0.3, 0.6, 1.1, 1.32), (0.0, 1.2, 1.2, -0.6, -0.6))
    c = controller_of(structure, hilly, train, shaft)
    limits = {"supply": Supply(voltage=22.0, max_duty=0.9, voltage_drop=1.0), "current": CurrentLimit(peak=6.0)}
    drive = Drive(train=machine(train, shaft), controller=c, **limits)
    found = []
    for n in (1, 2, 4, 16):
        run = simulate(replace(drive, controller=shorter(c, n)), task, rows=0)
        assert run.figures["time_at_current_limit"][0] > 0.01
        found.append([run.figures["speed_error"][0], run.figures["copper_heat"][0], net(run)])
    whole, half, quarter, sixteenth = np.array(found)
    # of 160 to 260 rad/s, 50 to 90 J; measured: 0.08 and 0.64 %
    assert np.abs(half / whole - 1.0).max() < (1e-3 if structure == "voltage PID" else 7e-3)
    assert (sixteenth - quarter) / (quarter - whole) == pytest.approx([0.25] * 3, abs=0.1)


# --- energy


def ended(drive, task):
    """A simulation, and its series, whose last row is its end."""
    found = simulate(drive, task)
    assert found.series["time"][-1] == pytest.approx(task.time[-1], abs=1e-9)
    return found, found.series


@structures
@shafts
@both_ways
def test_electrical_energy_is_work_losses_and_what_is_stored(spec, catalog, structure, shaft, degrees, regime):
    """In one direction of power the gears' loss is a share of what goes through them.

    All from the simulation's own tallies but for what grows with the square of a speed: that is added up over the
    series.
    """
    hilly, train = on_slope(spec, catalog, degrees)
    m = replace(machine(train, shaft), **RUBS)
    task = task_of(train, (0.0, 0.1, 0.5), (0.3, 0.3, 1.3 if degrees > 0.0 else 0.2))
    drive = Drive(train=m, controller=controller_of(structure, hilly, train, shaft), supply=Supply(voltage=24.0))
    run, s = ended(drive, task)
    assert one_mode(run, regime)
    f = {name: float(column[0]) for name, column in run.figures.items()}
    w, i, v = s["motor_speed"], s["current"], s["load_speed"]

    def rubbed(viscous, speed):
        return viscous * np.trapezoid(speed**2, s["time"])

    def stored(half, rate):
        return half / 2.0 * (rate[-1] ** 2 - rate[0] ** 2)

    parts = {"work on the load": m.forward_torque * f["load_angle"], "stored in the load": stored(m.load_inertia, v)}
    if shaft:
        start = m.forward_torque / m.stiffness
        twist = np.array((start, start + f["angle"] / m.ratio - f["load_angle"]))
        parts |= {"stored in the shaft": stored(m.stiffness, twist), "damped": rubbed(m.damping, w / m.ratio - v)}
    through, e = sum(parts.values()), m.efficiency
    assert np.sign(through) == (1 if regime == Regime.FORWARD_DRIVING else -1)
    parts |= {
        "lost in the gears": through * (1.0 / e - 1.0 if regime == Regime.FORWARD_DRIVING else e - 1.0),
        "copper": f["copper_heat"],
        "friction": m.friction * f["angle"],
        "rubbed off at the motor": rubbed(m.viscous, w),
        "stored in the rotor": stored(m.motor_inertia, w),
        "stored in the winding": stored(m.inductance, i),
    }
    turned_over = sum(map(abs, parts.values()))  # 50 J, 3 J
    assert net(run) == pytest.approx(sum(parts.values()), abs=1e-6 * turned_over)
