"""The servo cascade: rules against the textbooks' closed loops, sampled loops against a simulation in plain loops."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import control
import numpy as np
import pytest
from linear_machines import cascade_control
from refusals import refusal

from drivesizer.control.devices import controller_gains, devices
from drivesizer.control.drive_train import DriveTrain, Regime, modes
from drivesizer.control.gains import (
    design_cascade,
    feedforward,
    loop_warnings,
    magnitude_optimum,
    most_bandwidth,
    natural_frequency,
    pole_placement,
    resolution_warning,
    resonance_warning,
    shortest_ramp,
    spread_of,
    symmetrical_optimum,
)
from drivesizer.control.loop_design import (
    analyse,
    current_open_loop,
    dc_motor,
    frequency_response,
    from_error,
    loop_of,
    resonance,
    velocity_open_loop,
    voltage_open_loop,
)
from drivesizer.control.validation import Cascade, Gains, Rates, rates
from drivesizer.errors import InputError
from drivesizer.loads.course import Profile

EPOS4 = Rates(4e-5, 4e-4, 4e-4)
R, L, K_T, K_E, J_M = 2.3, 2.4e-4, 0.0234, 0.0271, 1.3e-6
K, E = 27.0 * 1.1, 0.8 * 0.95
J_L = 1e-3 + 11.0 * 0.0762**2
S = control.tf("s")


def train_of(**figures):
    """A small brushed motor behind a gearhead and a belt."""
    given = {
        "resistance": R, "inductance": L, "torque_constant": K_T, "back_emf_constant": K_E, "friction": 9e-4,
        "motor_inertia": J_M, "gear_ratio": 27.0, "gear_efficiency": 0.8, "belt_ratio": 1.1, "belt_efficiency": 0.95,
        "load_inertia": J_L, "radius": 0.0762, "forward_torque": 0.3, "backward_torque": -0.1, "rest_torque": 0.1,
    }  # fmt: skip
    return DriveTrain(**(given | figures))


TRAIN = train_of()
J = J_M + J_L / (E * K * K)  # driving


def designed(train=TRAIN, every=EPOS4, **wanted):
    return design_cascade(train, every, cascade_control(**wanted))[0]


def dead(time):
    """A dead time, to a Padé approximation of high order."""
    return control.tf(*control.pade(time, 8))


def overshoot(closed, end):
    _, y = control.step_response(closed, np.linspace(0.0, end, 20_001))
    return y.max() / float(np.real(closed(0j))) - 1.0


# --- the rules against the closed loops of the textbooks


def test_magnitude_optimum():
    """Kessler 1955: damping 0.707, overshoot 4.3 %, and 2 T as the lag of the loop."""
    lag = 6e-5
    kp, ki = magnitude_optimum(R, L, lag)
    closed = control.feedback((kp + ki / S) / (R + L * S) / (1 + lag * S), 1)
    w, damping, poles = control.damp(closed, doprint=False)
    pair = [n for n, p in enumerate(poles) if abs(p.imag) > 1.0]
    assert damping[pair] == pytest.approx([math.sqrt(0.5)] * 2, rel=1e-9)
    assert w[pair] == pytest.approx([1 / (math.sqrt(2) * lag)] * 2, rel=1e-9)
    assert overshoot(closed, 20 * lag) == pytest.approx(0.0432, abs=1e-4)  # exp(-pi)
    slope = (1.0 - float(np.real(closed(1j * 1.0)))) + abs(float(np.imag(closed(1j * 1.0))))
    assert slope == pytest.approx(2 * lag, rel=1e-3)


@pytest.mark.parametrize("a", [1.7, 2.0, 2.6])
def test_symmetrical_optimum(a):
    """Kessler 1958; Schröder: crossover 1/(a T), margin atan((a^2 - 1)/(2 a)), damping (a - 1)/2."""
    lag = 7e-4
    kp, ki = symmetrical_optimum(J, K_T, lag, a)
    opened = (kp + ki / S) * K_T / (J * S) / (1 + lag * S)
    _, margin, _, crossover = control.margin(opened)
    assert margin == pytest.approx(math.degrees(math.atan((a * a - 1) / (2 * a))), abs=1e-4)
    assert crossover == pytest.approx(1 / (a * lag), rel=1e-6)
    assert spread_of(math.radians(margin)) == pytest.approx(a, rel=1e-5)
    poles = control.feedback(opened, 1).poles()
    wanted = np.roots(np.polymul([a * lag, 1], [(a * lag) ** 2, (a - 1) * a * lag, 1]))
    assert np.sort_complex(poles) == pytest.approx(np.sort_complex(wanted), rel=1e-6)
    if a == 2.0:
        assert margin == pytest.approx(36.87, abs=0.01)
        assert overshoot(control.feedback(opened, 1), 40 * lag) == pytest.approx(0.434, abs=5e-4)


@pytest.mark.parametrize("damping", [0.4, math.sqrt(0.5), 1.3])
def test_pole_placement_and_its_required_bandwidth(damping):
    w, b = natural_frequency(12.0, damping), 2e-5
    kp, ki = pole_placement(J, K_T, w, damping, b)
    placed = control.feedback((kp + ki / S) * K_T / (J * S + b), 1).poles()
    assert np.sort_complex(placed) == pytest.approx(np.sort_complex(np.roots([1, 2 * damping * w, w * w])), rel=1e-9)
    kp, ki = pole_placement(J, K_T, w, damping)
    closed = control.feedback((kp + ki / S) * K_T / (J * S), 1)
    assert abs(closed(2j * math.pi * 12.0)) == pytest.approx(math.sqrt(0.5), rel=1e-9)


@pytest.mark.parametrize("damping", [0.5, 1.0])
def test_the_widest_bandwidth_leaves_30_degrees_where_the_inertia_is_least(damping):
    lag, left = 7e-4, 0.6
    w = natural_frequency(most_bandwidth(lag, damping, left), damping)
    kp, ki = pole_placement(J, K_T, w, damping)
    _, margin, _, _ = control.margin((kp + ki / S) * K_T / (left * J * S) * dead(lag))
    assert margin == pytest.approx(30.0, abs=0.01)


def test_feedforward_by_hand():
    acceleration, viscous, friction = feedforward(replace(TRAIN, viscous=3e-6))
    assert acceleration == pytest.approx(J / K_T)
    assert viscous == pytest.approx(3e-6 / K_T)
    assert friction == pytest.approx((9e-4 + 0.2 / (K * E)) / K_T)  # half of what the direction changes


# --- an EPOS4's own figures


def test_units_of_the_epos4():
    """The defaults of objects 0x30A0 and 0x30A2 in both units, as a user's guide to the EPOS4 prints them (EposLib)."""
    cascade = Cascade(
        current_kp=1.17188, current_ki=3906.25, velocity_kp=0.02, velocity_ki=0.5, current_period=4e-5,
        velocity_period=4e-4, feedforward_velocity=20.858e-3, feedforward_acceleration=6.274e-3,
    )  # fmt: skip
    gains, said = controller_gains(cascade, train_of(), devices()["epos4"])
    assert [(g.place, g.value, g.unit) for g in gains] == [
        ("0x30A0:01", 1_171_880, "µV/A"),
        ("0x30A0:02", 3_906_250, "µV/(A·ms)"),
        ("0x30A2:01", 20_000, "µA·s/rad"),
        ("0x30A2:02", 500_000, "µA/rad"),
        ("0x30A2:03", 20_858, "µA·s/rad"),
        ("0x30A2:04", 6_274, "µA·s²/rad"),
    ]
    assert said == []
    assert controller_gains(cascade, train_of(), devices()["escon"]) == ((), [])


def test_an_auto_tuned_epos4_has_these_gains():
    """Objects of one EPOS4 after EPOS Studio's tuning, as read from it (github.com/chimnonvuive/ExoModel)."""
    k_t, inertia, viscous = 69_523e-6, 4_378_489e-10, 152_443e-9 * 30 / math.pi  # 0x3001:05, 0x30A3:05, 0x30A3:04
    kp, ki = 775_467e-6, 23_963_356e-6  # 0x30A2:01, :02
    by_rule = pole_placement(inertia, k_t, math.sqrt(k_t * ki / inertia), 1.0)
    assert by_rule == pytest.approx((kp, ki), rel=3e-3)  # it places a double pole
    train = train_of(torque_constant=k_t, motor_inertia=inertia - J_L / (E * K * K))
    rubbing = replace(train, viscous=viscous)
    assert feedforward(rubbing)[:2] == pytest.approx((6_274e-6, 20_858e-6), rel=5e-3)  # 0x30A2:04, :03


def test_the_epos4_s_position_pid_is_the_cascade_with_the_path_s_velocity():
    cascade = replace(designed(position=True, bandwidth=40.0), velocity_kd=1e-4)
    gains, said = controller_gains(cascade, train_of(), devices()["epos4"])
    pid = {g.place: g.value * 1e-6 for g in gains}
    kv, pi = cascade.position_kp, cascade.velocity_kp + cascade.velocity_ki / S
    ours, theirs = pi * (kv + S), pid["0x30A1:01"] + pid["0x30A1:02"] / S + pid["0x30A1:03"] * S
    for w in (1.0, 30.0, 1000.0):
        assert ours(1j * w) == pytest.approx(theirs(1j * w), rel=1e-5)
    assert said == ["maxon EPOS4 has no place for velocity kd", "maxon EPOS4 has no place for feedforward friction"]


# --- sampled loops


def test_the_sampled_current_loop_is_the_magnitude_optimum():
    """Dead time instead of a lag: L = exp(-1.5 T s)/(3 T s), 90 - 0.5 rad = 61.35 deg at 1/(3 T)."""
    T = EPOS4.current
    slow = train_of(inductance=R * 500 * T)  # so slow a winding that the sampled integral is a continuous one
    loop = loop_of("current", current_open_loop(slow, designed(slow)))
    assert math.degrees(loop.phase_margin) == pytest.approx(90 - math.degrees(0.5), abs=0.7)
    assert loop.crossover == pytest.approx(1 / (3 * T) / (2 * math.pi), rel=0.01)
    continuous = control.feedback(control.tf(*control.pade(1.5, 4)) / (3 * S), 1)  # in periods
    assert loop.overshoot == pytest.approx(overshoot(continuous, 60.0), abs=0.012)
    assert loop.bandwidth == pytest.approx(control.bandwidth(continuous) / (2 * math.pi * T), rel=0.05)
    quick = loop_of("current", current_open_loop(TRAIN, designed()))
    assert quick.stable and quick.overshoot < 0.06


def test_margins_are_control_s():
    """On the same sampled loop python-control finds the same by its own method."""
    loop_ = from_error(velocity_open_loop(TRAIN, modes(TRAIN)[Regime.FORWARD_DRIVING], designed(bandwidth=40.0)))
    found = loop_of("velocity", loop_)
    w = np.geomspace(50.0, math.pi / loop_.dt * 0.9999, 3000)
    points = control.frequency_response(loop_[1, 0], w, squeeze=True)
    response = points.magnitude * np.exp(1j * points.phase)
    gain, margin, _, crossover = control.margin(control.frd(response, w))
    assert found.gain_margin == pytest.approx(gain, rel=1e-3)
    assert math.degrees(found.phase_margin) == pytest.approx(margin, abs=0.01)
    assert found.crossover == pytest.approx(crossover / (2 * math.pi), rel=1e-3)
    assert np.max(found.bode.closed_magnitude) < found.sensitivity + 1.0
    assert np.interp(found.crossover, found.bode.frequency, found.bode.open_magnitude) == pytest.approx(1.0, rel=1e-3)


def test_placed_poles_are_there_in_the_sampled_loop():
    cascade = designed(bandwidth=4.0, damping=0.8)
    loop = loop_of("velocity", from_error(velocity_open_loop(TRAIN, modes(TRAIN)[Regime.FORWARD_DRIVING], cascade)))
    w = natural_frequency(4.0, 0.8)
    wanted = np.exp((-0.8 + 1j * math.sqrt(1 - 0.64)) * w * EPOS4.velocity)
    nearest = min(loop.poles, key=lambda p: abs(p - wanted))
    assert abs(nearest - wanted) < 0.03 * abs(1 - wanted)  # of the distance from the pole to 1: 3 % of the frequency
    assert loop.bandwidth == pytest.approx(4.0, rel=0.03)


@pytest.mark.filterwarnings("ignore")  # control.margin leaves polynomials for the frequency response, which is accurate
def test_the_voltage_loop_has_python_control_s_margins():
    gains = Gains(kp=0.05, ki=1.5, kd=0.0, filter_time=0.0, period=4e-4, rule="", source="")
    found = analyse(TRAIN, gains)
    both = [
        from_error(voltage_open_loop(TRAIN, modes(TRAIN)[r], gains))[1, 0]
        for r in (Regime.FORWARD_DRIVING, Regime.FORWARD_BRAKING)
    ]
    gain, phase = zip(*(control.margin(loop)[:2] for loop in both), strict=True)
    assert found.velocity.gain_margin == pytest.approx(min(gain), rel=1e-5)
    assert math.degrees(found.velocity.phase_margin) == pytest.approx(min(phase), rel=1e-5)
    assert found.velocity.stable and found.velocity.direction in ("driving", "braking")
    assert found.all == (found.velocity,)


@pytest.mark.parametrize("wanted", [{}, {"bandwidth": 20.0}, {"bandwidth": 60.0, "damping": 1.0}, {"velocity_ki": 0.0,
                                    "velocity_kp": 2.0}])  # fmt: skip
def test_the_position_loop_does_not_overshoot(wanted):
    loops = analyse(TRAIN, designed(position=True, **wanted))
    assert loops.position.stable and loops.position.overshoot < 1e-3
    assert [loop.name for loop in loops.all] == ["current", "velocity", "position"]
    assert loops.position.settling_time > loops.position.rise_time > loops.velocity.rise_time


# --- the elastic machine


@pytest.mark.parametrize("regime", [Regime.FORWARD_DRIVING, Regime.FORWARD_BRAKING])
def test_resonances_are_the_closed_forms(regime):
    """Schröder: c/J_L, and c (1/J_L + 1/(e K^2 J_M)); both also as poles and zeros of the plant."""
    c, e = 500.0, E if regime == Regime.FORWARD_DRIVING else 1 / E
    mode, train = modes(TRAIN)[regime], replace(TRAIN, stiffness=c)
    anti, main = (2 * math.pi * f for f in resonance(train, mode))
    assert anti == pytest.approx(math.sqrt(c / J_L), rel=1e-12)
    assert main == pytest.approx(math.sqrt(c * (1 / J_L + 1 / (e * K * K * J_M))), rel=1e-12)
    stiff = np.array([[c / (e * K * K), -c / (e * K)], [-c / K, c]]) / np.array([[J_M], [J_L]])  # angles motor, wheel
    assert math.sqrt(max(np.linalg.eigvals(stiff).real)) == pytest.approx(main, rel=1e-9)
    soft = dc_motor(train, mode)
    assert np.abs(soft[1, 0].zeros().imag) == pytest.approx([anti, anti], rel=1e-6)
    assert max(np.abs(np.linalg.eigvals(soft.A[1:, 1:]).imag)) == pytest.approx(main, rel=1e-9)


def test_resonance_near_the_bandwidth_is_reported_and_its_cure_is_one():
    cascade = designed(bandwidth=20.0)
    loops = analyse(replace(TRAIN, stiffness=500.0), cascade)
    (said,) = resonance_warning(loops, 500.0)
    assert "within the bandwidth" in said and "a fifth" in said
    stiffer = 1.01 * float(said.rsplit("above ", 1)[1].split()[0])
    assert resonance_warning(analyse(replace(TRAIN, stiffness=stiffer), cascade), stiffer) == []


def test_a_sharp_resonance_is_not_missed_between_two_frequencies():
    mode, train = modes(TRAIN)[Regime.FORWARD_DRIVING], replace(TRAIN, stiffness=500.0, damping=1e-4)
    opened = from_error(velocity_open_loop(train, mode, designed(bandwidth=1.0)))
    model = opened[1, 0]
    f = max(abs(np.angle(p)) for p in model.poles() if abs(p) > 0.99 and p.imag > 0.0) / (2 * math.pi * opened.dt)
    near = f * (1.0 + np.linspace(-1e-3, 1e-3, 2001))
    peak = np.abs(model(np.exp(2j * math.pi * near * opened.dt))).max()
    bode = loop_of("velocity", opened).bode
    there = np.abs(bode.frequency / f - 1.0) < 1e-3
    assert bode.open_magnitude[there].max() == pytest.approx(peak, rel=0.02)


# --- warnings


def test_warnings():
    assert loop_warnings(analyse(TRAIN, designed(bandwidth=20.0)).all) == []
    wild = analyse(TRAIN, designed(velocity_kp=30.0, velocity_ki=0.0))
    assert any("velocity loop, " in w and "unstable" in w for w in loop_warnings(wild.all))
    assert math.isnan(wild.velocity.phase_margin) and math.isnan(wild.velocity.bandwidth)
    rings = analyse(TRAIN, designed())  # braking, a = 2 is too near
    assert any("rings: phase margin" in w for w in loop_warnings(rings.all))
    slow = analyse(TRAIN, designed(bandwidth=2.0))
    (said,) = loop_warnings(slow.all, Profile("jerky", (0.0, 0.02, 0.05, 1.0, 1.4), (0.0, 0.5, 1.0, 1.0, 0.0)))
    assert "slower than the profile" in said and "0.05 s, needs 6.99 Hz" in said  # 0.35/0.05 s


def test_shortest_ramp():
    assert shortest_ramp(Profile("", (0.0, 1.0, 1.5, 2.0, 5.0, 5.7), (0.0, 2.0, 2.5, 2.5, -1.0, 0.0))) == pytest.approx(
        0.7
    )
    assert math.isnan(shortest_ramp(Profile("", (0.0, 1.0), (1.0, 1.0))))


def test_resolution():
    """500 lines at 2.5 kHz: 2 pi/(2000 * 0.4 ms) = 75 rpm."""
    (said,) = resolution_warning(500.0, 4e-4, 0.5, 10.0)
    assert "75 rpm" in said and "3.93 A of 10 A" in said
    assert resolution_warning(500.0, 4e-4, 0.1, 10.0) == []
    assert resolution_warning(math.nan, 4e-4, 0.5, 10.0) == []
    assert "3.93 V" in resolution_warning(500.0, 4e-4, 0.5, 10.0, "voltage")[0]


# --- rates and what the user gives


def test_rates():
    own = SimpleNamespace(current_loop=25e3, speed_loop=2.5e3, position_loop=1.7e3)
    found, said = rates(own)
    assert found == pytest.approx((4e-5, 4e-4, 4e-4))
    assert said == ["the position loop runs every 400 µs, a whole multiple of the loop inside"]
    found, said = rates(SimpleNamespace(current_loop=math.nan, speed_loop=2e3, position_loop=math.nan))
    assert found == pytest.approx((5e-5, 5e-4, 1e-3))
    assert len(said) == 2 and all("unknown" in s for s in said)
    assert rates(None)[0] == pytest.approx((1e-4, 1e-3, 1e-3))


def test_what_is_given_is_taken_and_the_rest_designed_around_it():
    whole = designed()
    names = ("current_kp", "current_ki", "velocity_kp", "velocity_ki")
    for given in names:
        found = designed(**{given: getattr(whole, given)})
        for name in names:
            assert getattr(found, name) == pytest.approx(getattr(whole, name), rel=1e-9)
    placed = designed(bandwidth=25.0, damping=0.9)
    for name in ("velocity_kp", "velocity_ki"):
        found = designed(damping=0.9, **{name: getattr(placed, name)})
        assert found.velocity_kp == pytest.approx(placed.velocity_kp, rel=1e-9)
        assert found.velocity_ki == pytest.approx(placed.velocity_ki, rel=1e-9)
    slower = designed(current_ki=whole.current_ki / 10)
    assert slower.velocity_kp < whole.velocity_kp  # around the slower current loop
    mixed = designed(velocity_kp=0.7, velocity_ki=9.0, velocity_kd=0.01, position_kp=3.0, feedforward_friction=0.2)
    assert (mixed.velocity_kp, mixed.velocity_ki, mixed.position_kp, mixed.feedforward_friction) == (0.7, 9.0, 3.0, 0.2)
    assert mixed.filter_time == pytest.approx(0.01 / 0.7 / 10)
    assert "given" in mixed.rule and "magnitude optimum" in mixed.rule and "Kessler" in mixed.source


@pytest.mark.parametrize(("given", "said"), [
    ({"velocity_kp": 1e4}, "control.velocity.kp: with 1e+04 no reset time makes the loop stable; expected less"),
    ({"velocity_ki": 1e6}, "control.velocity.ki: with 1e+06 no reset time"),
    ({"velocity_kp": math.nan}, "control.velocity.kp: nan is no use; expected 0 to 1e+09"),
    ({"position_kp": -1.0}, "control.position.kp: -1 is no use"),
    ({"bandwidth": 0.0}, "control.velocity.bandwidth: 0 is no use; expected more"),
    ({"bandwidth": 9.0, "velocity_kp": 1.0}, "control.velocity.bandwidth: velocity_kp is given too"),
    ({"damping": 1.0}, "control.velocity.damping: it belongs to bandwidth, velocity_kp or velocity_ki"),
    ({"damping": 0.1, "bandwidth": 5.0}, "control.velocity.damping: 0.1 leaves a phase margin below 30°"),
    ({"phase_margin": 0.7, "bandwidth": 5.0}, "control.velocity.phase_margin: expected either it, or bandwidth"),
    ({"phase_margin": 1.6}, "control.velocity.phase_margin: expected more than 0°"),
    ({"filter_time": 0.01}, "control.velocity.filter_time: it belongs to velocity_kd; expected both"),
    ({"current_kp": 0.0}, "control.current.kp: without it and current_ki no current flows"),
])  # fmt: skip
def test_bad_input_is_one_line(given, said):
    assert refusal(lambda: designed(**given)).startswith(said)


def test_a_bandwidth_below_the_friction_s_own_is_refused():
    with pytest.raises(InputError, match="the friction alone makes the drive faster"):
        design_cascade(replace(TRAIN, viscous=1e-3), EPOS4, cascade_control(bandwidth=0.1))


@pytest.mark.parametrize("above", [0.0, 5e-4])
def test_a_crossover_on_the_grid_of_frequencies_is_found(above):
    """An integrator k T / (z - 1): its gain is 1 at 2/T asin(k T / 2), its phase margin there 90° less w T / 2.

    The grid is of 1500 frequencies over six decades below the Nyquist frequency; on some of them the gain is exactly 1.
    """
    period = 1e-3
    grid = np.geomspace(math.pi / period * 1e-6, math.pi / period, 1500)
    for w in grid[900:1300:20]:
        gain = 2.0 * math.sin(w * period / 2.0) * (1.0 + above)
        one = np.ones((1, 1))
        loop = loop_of("an integrator", control.ss(one, one, gain * one, 0.0 * one, period))
        crossover = 2.0 / period * math.asin(gain / 2.0)
        assert loop.crossover == pytest.approx(crossover / (2.0 * math.pi), rel=1e-9)
        assert loop.phase_margin == pytest.approx((math.pi - crossover * period) / 2.0, rel=1e-9)


@pytest.mark.parametrize("periods", [1, 60])
def test_the_frequency_response_is_python_control_s(periods):
    """For all frequencies at once, also of a long delay, whose poles at 0 no eigenvectors tell apart."""
    h = 4e-4
    late = control.ss(np.eye(periods, k=-1), np.eye(periods, 1), np.eye(1, periods, periods - 1), 0.0, h)
    lag = control.ss(control.tf([0.01, 0.002], [1.0, -0.9], h))
    loop = control.feedback(lag * late, 1) if periods > 1 else lag * late
    w = np.geomspace(1.0, 0.999 * math.pi / h, 60)
    theirs = control.frequency_response(loop, w, squeeze=True).complex
    assert frequency_response(loop)(w)[0] == pytest.approx(theirs, rel=1e-9, abs=1e-12)
    assert frequency_response(control.ss([], [], [], [[-2.5]], h))(w).tolist() == [[-2.5] * len(w)]
