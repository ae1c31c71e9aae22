"""The engine of the closed loop: closed forms, an independent integrator, energy, batches, cycles."""

from __future__ import annotations

import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from engine_tasks import FAR, MOTOR, PERIOD, SERVO, figure, gains, machine, open_drive, saturated_by_solver
from starters import STARTERS

from drivesizer.control import engine, open_loop
from drivesizer.control.drive_train import columns, discretised, generators
from drivesizer.control.engine import CurrentLimit, Drive, MotorHeat, Supply, Task, simulate
from drivesizer.control.open_loop import kernel as stepper
from drivesizer.control.validation import Cascade
from drivesizer.files import machine_code
from drivesizer.files.machine_code import SlowWarning, all_kernels
from drivesizer.kernel.warming import State, steady_state
from drivesizer.physics.thermal import TwoBodies
from drivesizer.simulate import validate
from drivesizer.sizing import size
from drivesizer.spec.robot import load_spec

# --- the modes and the machine


@pytest.mark.parametrize("more", [{}, {"stiffness": 900.0, "damping": 0.4, "gap": 1e-3, "viscous": 1e-6}])
def test_modes_are_the_matrix_exponential(more):
    from scipy.linalg import expm

    table = columns([machine(**more)])
    R, period = np.array([[2.32]]), np.array([PERIOD])
    G, found = generators(table, R), discretised(table, R, period)
    states = found.shape[-1] - 4
    for mode in range(G.shape[2]):
        for level, share in ((0, 1024), (5, 32), (10, 1)):
            exact = expm(G[0, 0, mode] * PERIOD / share)[: states + 2]
            exact = np.delete(exact, [states, states + 1], axis=1)
            assert found[0, 0, mode, level] == pytest.approx(exact, rel=1e-9, abs=1e-12 * np.abs(exact).max())


# --- heat


def test_a_day_at_one_speed_is_carried_to_the_steady_temperature():
    m = machine(friction=0.02)
    heat = MotorHeat(bodies=MOTOR, ambient=298.15, loss_torque=1e-3)
    drive = Drive(train=m, controller=gains(kp=0.02, ki=0.5), supply=Supply(voltage=24.0), heat=heat)
    run = simulate(drive, Task(time=(0.0, 86400.0), speed=(20.0, 20.0)))
    settled = steady_state(MOTOR, 298.15, 0.02 / 0.0234, 1e-3 * 20.0 * 9.1)
    assert State(figure(run, "winding"), figure(run, "housing")) == pytest.approx(settled, abs=1e-2)
    assert figure(run, "steps") < 2e6


# --- energy, periods, limits


def test_bus_sags_by_its_resistance():
    m = machine(friction=1.0, inductance=5e-3)
    supply = Supply(voltage=24.0, resistance=0.3, sets=4, max_duty=0.9, voltage_drop=1.0)
    run = simulate(replace(open_drive(m, 1.0), supply=supply), FAR)
    u, i = run.series["voltage"][-1], run.series["current"][-1]
    bus = u / 0.9 + 1.0
    assert i == pytest.approx(u / 2.32, rel=1e-6)  # the rotor is locked
    assert bus == pytest.approx(24.0 - 0.3 * 4 * u * i / bus, rel=1e-6)
    # meanwhile the current grows within a period, which the limit does not see
    assert figure(run, "bus_lowest") == pytest.approx(bus, rel=0.02)


def test_peak_current_for_its_time_then_the_continuous():
    m = machine(friction=1.0)
    limit = CurrentLimit(peak=4.0, continuous=1.5, peak_time=0.5)
    drive = Drive(train=m, controller=SERVO, supply=Supply(voltage=24.0), current=limit)
    run = simulate(drive, FAR)
    i, t = run.series["current"], run.series["time"]
    assert i[(t > 0.01) & (t < 0.49)] == pytest.approx(4.0, abs=1e-3)
    assert i[t > 0.53] == pytest.approx(1.5, abs=1e-3)
    assert figure(run, "i2t_share") == pytest.approx(1.0, abs=2e-3)


# --- backlash


def test_a_gap_is_crossed_without_torque():
    m = machine(stiffness=200.0, damping=0.2, gap=0.02, friction=5e-4)
    run = simulate(Drive(train=m, controller=gains(kp=0.02), supply=Supply(voltage=24.0)),
                Task(time=(0.0, 0.2, 0.4), speed=(0.0, 20.0, -20.0)))  # fmt: skip
    free = run.series["gear_torque"] == 0.0
    assert free[1:].any() and not free.all()
    twist = figure(run, "angle") / m.ratio - figure(run, "load_angle")
    assert abs(twist) == pytest.approx(0.01, abs=2e-3)


# --- many, long, wrong


def test_unstable_gains_come_to_an_end():
    wild = Drive(train=machine(), controller=gains(kp=1e5, ki=1e7), supply=Supply(voltage=math.inf))
    run = simulate(wild, FAR)
    assert "unstable" in run.problems[0]
    few = simulate(open_drive(machine(), 12.0), FAR, most_steps=100)
    assert "steps" in few.problems[0] and figure(few, "steps") <= 101 + 2048


# --- loads, corners and losses

# --- regenerated energy


def pulled(supply, **more):
    """A set that its load pulls at a constant speed, and the current that holds it."""
    m = machine(friction=1e-3)
    drive = Drive(train=m, controller=gains(kp=0.02, ki=0.5), supply=supply)
    task = Task(**({"time": (0.0, 2.0), "speed": (40.0, 40.0)} | more), load_time=(0.0,), load_torque=(-0.6,))
    return simulate(drive, task), (1e-3 - 0.6 * 0.72 / 9.1) / 0.0234


def test_a_chopper_takes_returned_energy():
    run, i = pulled(Supply(voltage=24.0, resistance=0.3, sets=4))
    power = 4 * (2.32 * i + 0.026 * 40.0 * 9.1) * i  # the voltage rests on k_e, the current on k_t
    assert power < -25.0
    assert figure(run, "bus_lowest") == pytest.approx(24.0, rel=1e-9)
    assert figure(run, "energy_returned") == pytest.approx(-power / 4 * 2.0, rel=1e-9)
    assert figure(run, "energy_in") == figure(run, "bus_current") == 0.0


def test_a_bus_that_a_chopper_keeps_leaves_its_whole_voltage():
    supply = Supply(voltage=24.0, resistance=0.5, sets=4, max_duty=0.9, voltage_drop=1.0)
    run, i = pulled(supply, time=(0.0, 1e-3, 3.0), speed=(40.0, 1e4, 1e4))
    assert run.series["voltage"][-1] == pytest.approx(0.9 * (24.0 - 1.0), rel=1e-6)
    assert run.series["motor_speed"][-1] == pytest.approx((0.9 * (24.0 - 1.0) - 2.32 * i) / 0.026, rel=1e-6)


# --- loads


@pytest.mark.parametrize("more", [{}, {"stiffness": 30.0, "damping": 0.02}])
def test_a_load_with_corners_in_a_saturated_loop_against_an_integrator(more):
    m, g = machine(friction=1e-3, forward_torque=0.1, backward_torque=-0.1, **more), gains(kp=0.04, ki=0.6)
    corners = tuple(PERIOD * n for n in (250, 500, 625, 1125, 1375))  # at samples: the engine has no others
    task = Task(
        time=(0.0, 0.1, 0.4, 0.5, 0.6), speed=(10.0, 10.0, 60.0, 20.0, 20.0), load_time=corners,
        load_torque=(0.05, 0.25, -0.05, 0.1, 0.3),
    )  # fmt: skip
    run = simulate(Drive(train=m, controller=g, supply=Supply(voltage=11.0)), task)
    exact = saturated_by_solver(m, g, 11.0, task, 1500)
    n = np.rint(run.series["time"][:-1] / PERIOD).astype(int)
    assert figure(run, "time_at_voltage_limit") > 0.05
    assert run.series["motor_speed"][:-1] == pytest.approx(exact[n, 1], abs=2e-3)  # rad/s of 546
    assert run.series["current"][:-1] == pytest.approx(exact[n, 0], abs=2e-4)  # A of 4


@pytest.mark.parametrize("when", [250 * PERIOD, 250.3 * PERIOD, 0.1, 7 * PERIOD])
def test_a_jump_of_the_load_takes_effect_at_the_next_sample(when):
    m = machine(resistance=1e7, inductance=1.0)  # no current: it coasts
    task = Task(
        time=(0.0, 0.2), speed=(40.0, 40.0), load_time=(when, math.nextafter(when, 1.0)), load_torque=(0.0, 0.1)
    )
    run = simulate(Drive(train=m, controller=gains(), supply=Supply(voltage=1e-6)), task)
    share = 1.0 / (m.ratio * m.efficiency)
    slows = 0.1 * share / (m.motor_inertia + m.load_inertia * share / m.ratio)
    sample = math.ceil(when / PERIOD - 1e-6) * PERIOD
    expected = 364.0 - slows * np.maximum(run.series["time"] - sample, 0.0)
    turning = expected > 10.0
    assert run.series["motor_speed"][turning] == pytest.approx(expected[turning], abs=1e-3)  # a sample is 0.8 rad/s
    assert expected.min() < 200.0


def test_a_load_of_many_corners_within_a_sample_keeps_its_size():
    """Pieces that are short beside a sample run to where the load is at the next one, never beyond."""
    m = machine(resistance=1e7, inductance=1.0)
    # a ramp within a hundredth of a period, with a sample in its middle
    mid = 100 * PERIOD
    task = Task(time=(0.0, 0.2), speed=(40.0, 40.0), load_time=(mid - 2e-6, mid + 2e-6), load_torque=(0.0, 0.1))
    run = simulate(Drive(train=m, controller=gains(), supply=Supply(voltage=1e-6)), task)
    share = 1.0 / (m.ratio * m.efficiency)
    slows = 0.1 * share / (m.motor_inertia + m.load_inertia * share / m.ratio)
    late = run.series["time"] > mid + PERIOD
    # half of it at the sample, all of it at the next: three quarters of it over that period
    expected = 364.0 - slows * (run.series["time"][late] - mid - PERIOD / 4)
    assert run.series["motor_speed"][late] == pytest.approx(expected, abs=1e-3)


# --- what the housing loses


def test_a_loss_that_grows_with_the_square_of_speed_settles_as_computed():
    m = machine(friction=0.02)
    heat = MotorHeat(bodies=MOTOR, ambient=298.15, loss_torque=1e-3, loss_viscous=5e-5)
    drive = Drive(train=m, controller=gains(kp=0.02, ki=0.5), supply=Supply(voltage=24.0), heat=heat)
    run = simulate(drive, Task(time=(0.0, 86400.0), speed=(20.0, 20.0)))
    w = 20.0 * m.ratio
    settled = steady_state(MOTOR, 298.15, 0.02 / 0.0234, 1e-3 * w + 5e-5 * w**2)
    assert 5e-5 * w**2 > 1.0
    assert State(figure(run, "winding"), figure(run, "housing")) == pytest.approx(settled, abs=1e-2)


def test_a_loss_by_the_square_of_speed_over_ramps():
    """All of the heat stays where nothing leads it away: copper's, and the integral of the speed's square."""
    kept = TwoBodies(R_25=2.32, R_th1=3.1, R_th2=1e9, tau_w=12.4, tau_h=612e8)
    heat = MotorHeat(bodies=kept, ambient=298.15, loss_viscous=5e-5)
    m = machine(friction=1e-3)
    drive = Drive(train=m, controller=gains(kp=0.02, ki=0.5), supply=Supply(voltage=24.0), heat=heat)
    run = simulate(drive, Task(time=(0.0, 0.5, 1.0, 1.5), speed=(0.0, 40.0, 40.0, -10.0)))
    w = run.series["motor_speed"]
    swept = PERIOD / 3.0 * np.sum(w[:-1] ** 2 + w[:-1] * w[1:] + w[1:] ** 2)
    stored = 12.4 / 3.1 * (figure(run, "winding") - 298.15) + 61.2 * (figure(run, "housing") - 298.15)
    assert stored == pytest.approx(figure(run, "copper_heat") + 5e-5 * swept, rel=2e-4)
    assert 5e-5 * swept > 0.1 * figure(run, "copper_heat")


# --- at rest

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


# --- as machine code

KERNELS = {one.functions[-1].__name__: one for one in all_kernels()}
MOTION = Task(time=(0.0, 0.01, 0.02), speed=(0.0, 8.0, 0.0))


@pytest.fixture(params=KERNELS)
def kernel(request):
    return KERNELS[request.param]


def moved():
    """Figures of a stepper's short move."""
    one = open_loop.Stepper(
        teeth=50.0, torque=np.array([0.5, 0.3, 0.1]), top_speed=90.0, microsteps=3.0, damping_ratio=0.1,
        motor_inertia=3e-6,
    )  # fmt: skip
    return open_loop.simulate(one, MOTION).figures


def test_every_kernel_is_translated_as_its_sources_are(kernel):
    assert kernel.translated
    name = kernel.functions[-1].__name__
    assert list(kernel.library.parent.glob(f"{name}-*.so")) == [kernel.library]


def test_no_compiler_is_loaded_to_run_it():
    code = "import sys; from drivesizer.control import engine; engine.machine_code(engine.KERNEL); print(*sys.modules)"
    loaded = subprocess.check_output([sys.executable, "-c", code], text=True).split()
    assert not {"numba", "llvmlite"} & set(loaded)


def test_without_machine_code_it_is_the_same_and_said_to_be_slow(monkeypatch):
    by_machine_code = moved()
    monkeypatch.setattr(machine_code.Kernel, "translated", False)
    monkeypatch.setitem(sys.modules, "numba", None)
    with pytest.warns(SlowWarning, match="a stepper runs some hundred times slower, for there is no machine code"):
        plain = machine_code.machine_code.__wrapped__(stepper.KERNEL)
    monkeypatch.setattr(open_loop, "machine_code", lambda _: plain)
    assert moved() == pytest.approx(by_machine_code, rel=1e-9)


def test_what_has_changed_is_translated_anew(tmp_path, monkeypatch):
    last = stepper.KERNEL.functions[-1].__name__
    (tmp_path / f"{last}-of-before.so").write_text("")
    library = tmp_path / f"{last}-of-now.so"
    monkeypatch.setattr(machine_code.Kernel, "library", library)
    by_machine_code, anew = moved(), machine_code.machine_code.__wrapped__(stepper.KERNEL)
    assert list(tmp_path.iterdir()) == [library]
    monkeypatch.setattr(open_loop, "machine_code", lambda _: anew)
    assert moved() == by_machine_code


# --- missions

SET = machine(friction=1e-3, forward_torque=0.3, backward_torque=-0.3)
HEAT = MotorHeat(bodies=MOTOR, ambient=298.15, loss_torque=1e-3, loss_viscous=1e-6)
COUNTED = Drive(
    train=SET, controller=replace(SERVO, counted_over=4), supply=Supply(voltage=24.0), current=CurrentLimit(peak=6.0),
    edges=2000, heat=HEAT,
)  # fmt: skip
CYCLE = Task(time=(0.0, 0.1, 0.5, 0.6, 2.0), speed=(0.0, 30.0, 30.0, 0.0, 0.0), cycles=120)
MET = ("time", "rms_current", "energy_in", "copper_heat", "rms_gear_torque_running")


def all_simulated(monkeypatch, drive, task):
    """The same with nothing alike."""
    with monkeypatch.context() as patch:
        for name in ("_PERIODIC", "_PERIODIC_WARM", "_ALIKE"):
            patch.setattr(engine, name, -1.0)
        return simulate(drive, task, rows=0, most_steps=10**9)


@pytest.mark.parametrize("change", [
    {},
    {"heat": None},
    {"edges": 0},
    {"train": replace(SET, stiffness=60.0, damping=0.05, gap=4e-3)},
    {"edges": 256},
], ids=["counted and heated", "counted", "heated", "backlash", "few edges"])  # fmt: skip
def test_cycles_that_are_alike_are_added(change, monkeypatch):
    drive = replace(COUNTED, **change)
    added, simulated = simulate(drive, CYCLE), all_simulated(monkeypatch, drive, CYCLE)
    assert figure(added, "steps") < 0.4 * figure(simulated, "steps")
    for name in MET:
        assert figure(added, name) == pytest.approx(figure(simulated, name), rel=5e-3), name
    assert figure(added, "angle") == pytest.approx(figure(simulated, "angle"), abs=0.5)  # rad at the motor of 15 000
    if drive.heat:
        for name in ("winding", "winding_highest", "housing"):
            rise = figure(simulated, name) - 298.15
            assert rise > 10.0
            assert figure(added, name) - 298.15 == pytest.approx(rise, rel=5e-3)


@pytest.mark.parametrize("change", [{}, {"edges": 0, "heat": None}], ids=["counted", "cold"])
def test_the_current_s_integral_grows_through_cycles_that_are_added(change, monkeypatch):
    limit = CurrentLimit(peak=6.0, continuous=1.2, peak_time=30.0)
    drive = replace(COUNTED, current=limit, **change)
    added, simulated = simulate(drive, CYCLE), all_simulated(monkeypatch, drive, CYCLE)
    square = figure(simulated, "rms_current") ** 2
    assert figure(simulated, "time_at_current_limit") == 0.0
    rises = (square - 1.2**2) * figure(simulated, "time")  # it never comes to zero meanwhile
    assert rises > 300.0
    assert figure(simulated, "i2t_highest") > rises
    assert figure(added, "i2t_highest") == pytest.approx(figure(simulated, "i2t_highest"), rel=5e-3)
    assert figure(added, "steps") < 0.4 * figure(simulated, "steps")


@pytest.mark.parametrize("edges", [0, 2000], ids=["exact", "counted"])
def test_a_mission_with_long_stretches(edges):
    """80 min at cruise, four times: the current of each stretch is known, and the temperatures it settles at."""
    drive = replace(COUNTED, edges=edges, train=replace(SET, forward_torque=0.15, backward_torque=-0.15))
    run = simulate(drive, Task(time=(0.0, 1.0, 4801.0, 4802.0), speed=(0.0, 40.0, 40.0, 0.0), cycles=4))
    w = 40.0 * SET.ratio
    i = (1e-3 + 0.15 / (SET.ratio * SET.efficiency)) / SET.torque_constant
    assert figure(run, "time") == pytest.approx(4 * 4802.0, rel=1e-6)
    assert figure(run, "rms_current") == pytest.approx(i, rel=5e-3)
    assert figure(run, "angle") == pytest.approx(4 * 4801.0 * w, rel=1e-6)
    settled = steady_state(MOTOR, 298.15, i, 1e-3 * w + 1e-6 * w**2)
    reached = State(figure(run, "winding_highest"), figure(run, "housing_highest"))
    assert np.subtract(reached, 298.15) == pytest.approx(np.subtract(settled, 298.15), rel=5e-3)
    work = (SET.back_emf_constant * w * i + (figure(run, "copper_heat") / figure(run, "time"))) * figure(run, "time")
    assert figure(run, "energy_in") == pytest.approx(work, rel=5e-3)
    assert figure(run, "steps") < 0.01 * figure(run, "time") / SERVO.current_period


def test_a_counted_drive_at_rest_within_its_count_is_carried():
    run = simulate(COUNTED, Task(time=(0.0, 0.5, 1.0, 3601.0), speed=(0.0, 30.0, 0.0, 0.0)))
    assert figure(run, "steps") < 0.01 * 3601.0 / SERVO.current_period
    assert run.series["motor_speed"][-1] == 0.0
