"""The engine at rest: an integral that friction makes needless is drained, one that carries a load is kept."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from engine_tasks import PERIOD, gains, machine
from starters import STARTERS

from drivesizer.control.engine import Drive, Supply, Task, simulate
from drivesizer.control.validation import Cascade
from drivesizer.simulate import validate
from drivesizer.sizing import size
from drivesizer.spec.robot import load_spec

STOP = Task(time=(0.0, 0.1, 0.3, 0.4, 1.6), speed=(0.0, 40.0, 40.0, 0.0, 0.0))
SUPPLY = Supply(voltage=24.0)
CASCADE = Cascade(
    current_kp=0.6, current_ki=900.0, velocity_kp=0.01, velocity_ki=0.6, current_period=1e-4, velocity_period=4e-4
)


def at_rest(run, since=1.2):
    """Current at the samples of the rest."""
    t = run.series["time"]
    return t[t >= since], run.series["current"][t >= since]


def test_a_drained_voltage_decays_by_its_time_constant_and_then_is_none():
    m = machine(friction=4e-3, forward_torque=0.2, backward_torque=-0.2)
    drive = Drive(train=m, controller=gains(kp=0.03, ki=0.5), supply=SUPPLY)
    t, kept = at_rest(simulate(drive, STOP))
    assert abs(kept[0]) > 0.05  # braking left it, and friction lets it stay
    assert kept == pytest.approx(np.full(len(kept), kept[0]), rel=1e-3)
    _, drained = at_rest(simulate(replace(drive, drain_time=0.2), STOP))
    n = np.rint((t - t[0]) / PERIOD)
    assert drained[0] < 0.9 * kept[0]
    assert drained[:-1] == pytest.approx(drained[0] * np.exp(-n[:-1] * PERIOD / 0.2), rel=1e-6, abs=1e-9)
    assert math.exp(-n[-1] * PERIOD / 0.2) < 0.2


@pytest.mark.parametrize("controller", [gains(kp=0.03, ki=0.5), CASCADE])
def test_a_load_that_friction_does_not_hold_is_held_as_before(controller):
    hangs = machine(friction=1e-4, forward_torque=0.5, backward_torque=0.5, rest_torque=0.5)
    drive = Drive(train=hangs, controller=controller, supply=SUPPLY)
    kept, drained = simulate(drive, STOP), simulate(replace(drive, drain_time=0.05), STOP)
    assert np.array_equal(kept.series["current"], drained.series["current"])
    assert abs(kept.series["current"][-1]) > 0.3 * 0.5 * 0.72 / 9.1 / 0.0234


def test_a_cascade_is_drained_too_and_starts_again():
    m = machine(friction=4e-3, forward_torque=0.2, backward_torque=-0.2)
    drive = Drive(train=m, controller=CASCADE, supply=SUPPLY, drain_time=0.05)
    again = Task(time=(*STOP.time, 1.7, 1.9), speed=(*STOP.speed, 40.0, 40.0))
    run = simulate(drive, again)
    t, i, w = (run.series[name] for name in ("time", "current", "motor_speed"))
    assert i[np.searchsorted(t, 1.59)] == pytest.approx(0.0, abs=1e-8)
    assert w[-1] == pytest.approx(40.0 * m.ratio, rel=0.1)


@pytest.mark.parametrize("kind", ["conveyor", "lead_screw"])
def test_a_drive_that_is_held_by_friction_passes_in_closed_loop_as_it_is_sized(kind, catalog):
    spec = load_spec(STARTERS / f"{kind}.yaml")
    chosen = size(spec, catalog=catalog, top=1).sets[0]
    assert (chosen.status, validate(spec, chosen).status) == ("pass", "pass")
