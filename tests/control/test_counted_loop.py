"""Loops around an encoder's counts: a model discretised by hand, a PI in plain loops, and what designs must hold.

The machine here is the textbook's: L di/dt = u - R i - k_e w, J dw/dt = k i, discretised by SciPy's matrix exponential.
Its angle is counted in whole edges; the speed is what was counted over n periods, over their time.
"""

from __future__ import annotations

import math
from dataclasses import replace

import control
import numpy as np
import pytest
import yaml
from exports import rendered
from linear_machines import cascade_control
from scipy.linalg import expm

from drivesizer.control.drive_train import Regime, drive_train, modes
from drivesizer.control.engine import Drive, Supply, Task, simulate
from drivesizer.control.gains import design, design_cascade
from drivesizer.control.loop_design import analyse, designed
from drivesizer.control.validation import rates
from drivesizer.errors import InputError
from drivesizer.output.export import export_of
from drivesizer.physics.counted_speed import Counts
from drivesizer.simulate import validate
from drivesizer.sizing import explain
from drivesizer.spec.drive import Control, Plant

pytestmark = pytest.mark.usefixtures("no_further_searches")

EDGES, VOLTS = 2000, 24.0  # counts of a 500-line encoder, and a supply


@pytest.fixture(scope="module")
def chosen(spec, catalog):
    """RE 25 20 W 24 V, GP 26 A 27:1, MR with 500 lines, EPOS4 Compact 50/5 CAN at 2.5 kHz."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("drivesizer.sizing.changes_for", lambda *_: ())
        return explain(spec, "118752", "406764", catalog=catalog)[0]


def controlled(spec, plant=None, **control_):
    rate = control_.pop("rate", None)
    demands = control_ | ({"rate": f"{rate} Hz"} if rate else {})
    return spec.model_copy(update={"control": Control(**demands), "plant": plant or Plant()})


def discrete(train, inertia, period):
    """The machine over a held voltage, its angle as third state."""
    R, L, k, k_e = train.resistance, train.inductance, train.torque_constant, train.back_emf_constant
    A = [
        [-R / L, -k_e / L, 0.0, 1 / L],
        [k / inertia, -train.viscous / inertia, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0] * 4,
    ]
    whole = expm(np.array(A) * period)
    return whole[:3, :3], whole[:3, 3:]


def margin_by_hand(train, inertia, gains, n):
    """Phase margin [deg] by python-control from the response, factor by factor; n = 0: exact speed."""
    T = gains.period
    state, held = discrete(train, inertia, T)
    w = np.geomspace(1e-3, 0.999, 4_000) * math.pi / T
    z = np.exp(1j * w * T)
    found = np.linalg.solve(z[:, None, None] * np.eye(3) - state, held[None])[:, :, 0]
    seen = found[:, 2] * (1.0 - z**-n) / (n * T) if n else found[:, 1]
    answer = (gains.kp + gains.ki * T * z / (z - 1.0)) / z  # a period late
    return control.margin(control.frd(seen * answer, w))[1]


@pytest.mark.parametrize("n", [1, 7, 40])
def test_the_phase_margin_of_a_counted_loop(spec, chosen, n):
    train, _ = drive_train(spec, chosen, 4e-4)
    gains = replace(design(controlled(spec), train, 4e-4, Counts(EDGES, 1.0, n)))
    assert gains.counted_over == n
    loop = analyse(train, gains).velocity
    by_hand = [margin_by_hand(train, modes(train)[r].inertia, gains, n)
               for r in (Regime.FORWARD_DRIVING, Regime.FORWARD_BRAKING)]  # fmt: skip
    assert math.degrees(loop.phase_margin) == pytest.approx(min(by_hand), abs=0.02)
    assert min(by_hand) > 45.0  # where half of the counts' time was in the delay that the rule is made for


def test_the_simulation_of_a_counted_pi(spec, chosen):
    """Sample by sample in a plain loop: counts are floors, speed their difference over n periods, the answer late."""
    T, n = 4e-4, 5
    train, _ = drive_train(spec, chosen, T)
    m = replace(train, friction=0.0, forward_torque=0.0, backward_torque=0.0, rest_torque=0.0,
                load_inertia=1e-9, gear_efficiency=1.0, belt_efficiency=1.0, viscous=0.0)  # fmt: skip
    gains = replace(design(controlled(spec), train, T, Counts(EDGES, 1.0, n)), kp=0.02, ki=0.3)
    time, speed = (0.0, 0.02, 0.2), (1.0, 1.3, 1.3)
    run = simulate(
        Drive(train=m, controller=gains, supply=Supply(voltage=VOLTS), edges=EDGES), Task(time=time, speed=speed)
    )
    bare = replace(train, viscous=0.0)
    state, held = discrete(bare, m.motor_inertia + 1e-9 / m.ratio**2, T)
    w = speed[0] * m.ratio
    x, pending = np.array([0.0, w, 0.0]), m.back_emf_constant * w
    integral, rows = pending, []
    turned = list(np.floor(w * T * np.arange(-n, 0) * EDGES / (2 * math.pi)))
    for k in range(500):
        count = math.floor(x[2] * EDGES / (2 * math.pi))
        seen = (count - turned[-n]) * 2 * math.pi / (EDGES * n * T)
        turned.append(count)
        error = float(np.interp(k * T, time, speed)) * m.ratio - seen
        integral += gains.ki * T * error
        rows.append((x[1], x[0], pending))
        x, pending = state @ x + held[:, 0] * pending, gains.kp * error + integral
    found, s = np.array(rows), run.series
    kept = np.rint(s["time"][:-1] / T).astype(int)
    ours = np.array((s["motor_speed"], s["current"], s["voltage"])).T[:-1]
    assert len(kept) > 450
    assert ours == pytest.approx(found[kept], abs=1e-6)
    assert np.ptp(found[300:, 2]) > 1.5 * gains.kp * 2 * math.pi / (EDGES * n * T)  # the counts are heard


def noise(spec, chosen, period, counts, gains):
    """Voltage demand of a simulation at a steady speed, from top to bottom [V]."""
    train, _ = drive_train(spec, chosen, period)
    drive = Drive(train=train, controller=gains, supply=Supply(voltage=1e4), edges=counts.edges)
    run = simulate(drive, Task(time=(0.0, 1.0), speed=(9.37, 9.37)))
    late = run.series["time"] > 0.5
    return float(np.ptp(run.series["voltage"][late]))


@pytest.mark.parametrize("rate", [100.0, 1000.0, 5360.0])
def test_one_count_is_answered_with_little(spec, chosen, rate):
    """Counts of n periods are whole: 2 pi/(E n T) k_p each; the rule for exact speeds gives far more."""
    bare, period = controlled(spec), 1.0 / rate
    train, _ = drive_train(bare, chosen, period)
    counts = Counts(EDGES, 0.1 * VOLTS)
    gains, loud = design(bare, train, period, counts), replace(design(bare, train, period), counted_over=1)
    grain = 2.0 * math.pi / (EDGES * gains.counted_over * period)
    assert gains.kp * grain <= 0.1 * VOLTS * (1 + 1e-9)
    assert noise(spec, chosen, period, counts, gains) < 0.3 * VOLTS
    if rate > 5000.0:
        assert noise(spec, chosen, period, counts, loud) > 2.0 * VOLTS
    loop = analyse(train, gains).velocity
    assert loop.stable and loop.phase_margin > math.radians(45.0)


def test_counts_are_the_rule_where_there_is_an_encoder(spec, chosen):
    proof = validate(controlled(spec), chosen)
    named = {check.name: check for check in proof.checks}
    assert proof.gains.counted_over >= 1 and proof.gains.period == pytest.approx(4e-4)
    assert named["phase_margin"].status == named["tracking_error"].status == "pass"
    volts = named["supply_voltage"]  # counts drive no limit
    assert volts.demand < volts.limit and volts.status == "pass"
    reported = " ".join(proof.assumptions)
    assert "counted by the encoder" in reported
    blind = validate(controlled(spec), replace(chosen, encoder=replace(chosen.encoder, counts_per_turn=math.nan)))
    assert blind.gains.counted_over == 0 and "resolution is unknown: speed is measured" in " ".join(blind.assumptions)


def test_gains_that_counts_drive_into_the_limits_fail(spec, chosen):
    """The rule's gains for an exact speed, given as if they were the user's: 20 V and more for one count."""
    train, _ = drive_train(spec, chosen, 4e-4)
    loud = design(controlled(spec), train, 4e-4)
    named = {c.name: c for c in validate(controlled(spec, kp=loud.kp, ki=loud.ki), chosen).checks}
    assert named["supply_voltage"].status == "fail"
    assert named["supply_voltage"].demand > loud.kp * 2 * math.pi / (EDGES * 4e-4) > 20.0


# --- margins that are stated


@pytest.mark.parametrize("rate", [None, 500.0])
def test_the_cascade_has_the_margin_of_its_rule(spec, chosen, rate):
    """The symmetrical optimum with a = 2 has 36.9 deg; braking, the gears' losses take a third of that away."""
    stated = math.degrees(math.atan(2.0) - math.atan(0.5))
    train, cascade, said = designed(controlled(spec, structure="cascade", rate=rate, speed_from="exact"), chosen)
    every, _ = rates(chosen.controller, rate)
    by_rule, _ = design_cascade(train, every, cascade_control())
    assert math.degrees(analyse(train, by_rule).velocity.phase_margin) < 30.0
    assert math.degrees(analyse(train, cascade).velocity.phase_margin) == pytest.approx(stated, abs=0.5)
    assert math.degrees(analyse(train, cascade).velocity.phase_margin) >= stated
    assert "slower than its design rule" in " ".join(said)


def test_a_bandwidth_that_leaves_no_margin_is_refused(spec, chosen):
    fast = controlled(spec, structure="cascade", velocity={"bandwidth": "400 Hz"})
    with pytest.raises(InputError, match=r"control\.velocity\.bandwidth: 400 Hz is .*; expected at most [0-9.]+ Hz$"):
        designed(fast, chosen)
    with pytest.raises(InputError, match=r"control\.bandwidth: 200 Hz is faster than the delay of the loop allows"):
        designed(controlled(spec, bandwidth="200 Hz"), chosen)


def test_an_elastic_shaft_and_its_backlash_slow_the_loop(spec, chosen):
    """Below a fifth of the resonance; with backlash the rotor alone, without its load, keeps its margin too."""
    margins = {}
    for gap in (0.0, 0.01):  # rad
        soft = Plant(model="two_mass", stiffness="60 N*m/rad", damping_ratio=0.05)
        one, own = controlled(spec, soft, speed_from="exact"), replace(chosen.gearhead, backlash=gap)
        proof = validate(one, replace(chosen, gearhead=own))
        train, gains, _ = designed(one, replace(chosen, gearhead=own))
        alone = margin_by_hand(train, train.motor_inertia, gains, 0)
        margins[gap] = alone if np.isfinite(alone) else -math.inf
        assert not any("swings against" in said for said in proof.warnings)
        assert {c.name: c.status for c in proof.checks}["phase_margin"] == "pass"
    assert margins[0.01] > 29.9 > margins[0.0] + 3.0


# --- in other hands


@pytest.mark.parametrize("rate", [None, 1000.0, 500.0, 100.0])
def test_gains_for_ros2_control_are_stable_at_the_rate_that_the_file_states(spec, chosen, rate):
    """J dw/dt = torque, the law of the file, each torque a period after its sample."""
    made = export_of(controlled(spec, rate=rate), chosen)
    stated = yaml.safe_load(rendered(made, "ros2_control", True))
    law = stated["velocity_controller"]["ros__parameters"]["gains"]["shaft"]
    T = 1.0 / stated["controller_manager"]["ros__parameters"]["update_rate"]
    train = made.train
    lightest = train.load_inertia + train.motor_inertia * train.ratio**2 * train.efficiency
    p, i = law["p"] * T / lightest, law["i"] * T / lightest
    # states: speed, sum of errors times T, torque as it moves as acceleration times T
    A = np.array([[1.0, 0.0, 1.0], [-T, 1.0, 0.0], [-p - i * T, i, 0.0]])
    assert np.abs(np.linalg.eigvals(A)).max() < 1.0
    assert pytest.approx(1.0 / (rate or 2500.0)) == T
