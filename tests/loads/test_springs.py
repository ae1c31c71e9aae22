"""Springs and counterweights beside the drive: closed forms, energy that comes back, and the lines that refuse them."""

import math

import numpy as np
import pytest
from refusals import refusal

from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.of_machine import starts_farther_on
from drivesizer.loads.course import Profile
from drivesizer.physics.load_cycle import integral, rms
from drivesizer.search.uncertainty.uncertain_figures import applied
from drivesizer.spec.robot import read_spec

G = 9.80665
M_G_L = 2.0 * G * 0.3  # N*m, of the arm
ARM = "kind: arm, mass: 2 kg, length: 300 mm"
LIFT = "kind: rack_pinion, mass: 6 kg, pinion_diameter: 40 mm, incline: 90 deg"
UP_AND_DOWN = [(0, 0), (0.2, 0.5), (0.6, 0.5), (0.8, 0), (1.0, 0), (1.2, -0.5), (1.6, -0.5), (1.8, 0)]  # 0.3 m
SWING = [(0, 0), (0.2, 2.0), (0.6, 2.0), (0.8, 0), (1.0, 0), (1.2, -2.0), (1.6, -2.0), (1.8, 0)]  # 1.2 rad


def spec_of(load, *springs, more=""):
    turns = any(kind in load for kind in ("arm", "table", "flywheel"))
    motion = "motion: {speed: %s, acceleration_time: 1 s, cruise_time: 1 s}\n" % ("1 rad/s" if turns else "1 m/s")
    motion = "" if "recorded" in load else motion
    sprung = f", springs: [{', '.join(f'{{{one}}}' for one in springs)}]" if springs else ""
    return read_spec(
        YamlSource(f"name: x\nload: {{{load}{sprung}}}\n{motion}supply: {{nominal: 24 V}}\n{more}", "x.yaml")
    )


def cycle_of(load, *springs, points):
    time, speed = zip(*points, strict=True)
    return load_cycle(spec_of(load, *springs), Profile("x", time, speed))


# --- closed forms -----------------------------------------------------------------------------------------------------


def test_the_best_torsion_spring_is_the_regression_of_the_weights_torque():
    """Upright, 30° to either side at constant speed: k = <M θ>/<θ²> = 3 (sin A - A cos A) / A³ of m g l."""
    A = math.pi / 6
    best = 3 * (math.sin(A) - A * math.cos(A)) / A**3 * M_G_L
    assert best / M_G_L == pytest.approx(0.973, abs=5e-4)

    def left(rate):
        spring = f"kind: torsion, rate: {rate!r} N*m/rad, torque: {rate * A!r} N*m"  # at rest where the arm is upright
        c = cycle_of(f"{ARM}, start_angle: 60 deg", spring, points=[(0, 1.0), (2 * A, 1.0)])
        return rms(c.duration, c.torque)

    sin2 = 0.5 - math.sin(2 * A) / (4 * A)  # mean of the sine's square
    exact = math.sqrt(M_G_L**2 * sin2 - best**2 * A**2 / 3)  # what a regression leaves
    assert left(best) == pytest.approx(exact, rel=2e-3)
    assert left(best * 1.01) == pytest.approx(math.sqrt(exact**2 + (0.01 * best * A) ** 2 / 3), rel=2e-3)
    assert left(best) < min(left(best * 0.999), left(best * 1.001))


def test_a_spring_of_no_free_length_balances_an_arm_everywhere():
    """Anchor b above the axis, end r on the arm, pull c l: balanced anywhere where c r b = m g l (Carwardine)."""
    r, b, start = 0.1, 0.2, math.radians(-40)
    rate = M_G_L / (r * b)
    length = math.sqrt(r * r + b * b - 2 * r * b * math.cos(start - math.pi / 2))
    spring = (
        f"kind: linear, rate: {rate!r} N/m, force: {-rate * length!r} N, "
        f"ends: {{radius: 100 mm, anchor: 200 mm, angle: {start - math.pi / 2!r} rad}}"
    )
    c = cycle_of(f"{ARM}, start_angle: -40 deg", spring, points=[(0, 1.0), (2.0, 1.0)])
    assert np.abs(c.torque).max() < 1e-12 * M_G_L
    held = load_cycle(
        spec_of(f"{ARM}, start_angle: -40 deg", spring, more="needs: {hold_unpowered: true}\n")
    ).holding_torque
    assert held < 1e-12 * M_G_L < M_G_L < load_cycle(
        spec_of(f"{ARM}, start_angle: -40 deg", more="needs: {hold_unpowered: true}\n")
    ).holding_torque * 1.0001  # fmt: skip


def test_what_gas_springs_keep_is_their_friction():
    """400 N out, 1.33 times that in: half in 466 N; there and back it keeps 2 · 30 N over 0.3 m, and nothing else."""
    gas = "kind: gas, force: 400 N, progression: 1.33, stroke: 400 mm, pressed: 200 mm"
    still = cycle_of(LIFT, gas, points=[(0, 0.0), (1, 0.0)])
    assert still.torque[0] == pytest.approx([(6 * G - 466.0) * 0.02] * 2)
    for way, pressed in (("forward", 350), ("back", 50)):
        for friction in (0, 30):
            spring = gas.replace("200 mm", f"{pressed} mm") + f", pushes: {way}, friction: {friction} N"
            c = cycle_of(LIFT, spring, points=UP_AND_DOWN)
            assert integral(c.duration, c.torque, c.speed) == pytest.approx(2 * friction * 0.3, rel=1e-4, abs=1e-3)


def test_springs_along_a_line_by_hand():
    """0.3 m up: a spring of 200 N/m that starts with 100 N, one of 20 N, through a screw of 80 %."""
    springs = "kind: linear, rate: 200 N/m, force: 100 N", "kind: constant, force: 20 N"
    load = "kind: ball_screw, mass: 6 kg, lead: 10 mm, efficiency: 0.8, inertia: 0 kg*m^2, incline: 90 deg"
    c = cycle_of(load, *springs, points=[(0, 0.5), (0.6, 0.5)])
    position = np.array([0.0, 0.3])
    force = 6 * G - (100 - 200 * position) - 20  # turns round on the way: 58.8 N of weight against 120 to 60 N
    r = 0.01 / (2 * math.pi)
    ends = [c.torque[0, 0], c.torque[-1, 1]]
    assert ends == pytest.approx([one * r * (0.75 if one < 0 else 1.25) for one in force])  # e_b = 2 - 1/e
    ramp = cycle_of(load, springs[0], points=[(0, 0), (1.0, 0.6)])  # a parabola over time
    exact = (6 * G + 6 * 0.6 - (100 - 200 * 0.3 * ramp.time**2)) * r
    assert np.abs(ramp.torque - exact * np.where(exact < 0, 0.75, 1.25)).max() < 1e-4 * 60 * r * 1.25


def test_counterweights_do_what_other_machines_do():
    """On a rope along a line as that of a hoist; about an axis 2 · 0.3 = 3 · 0.2 kg·m, its inertia added."""
    hung = cycle_of(LIFT, "kind: counterweight, mass: 4 kg", points=UP_AND_DOWN)
    hoist = "kind: hoist, mass: 6 kg, counterweight: 4 kg, drum_diameter: 40 mm"
    hoisted = cycle_of(hoist, points=UP_AND_DOWN)
    assert hung.torque == pytest.approx(hoisted.torque)
    assert hung.inertia == pytest.approx(hoisted.inertia)
    for kind in (ARM, "kind: rotary_table, inertia: 0.18 kg*m^2, mass: 2 kg, eccentricity: 300 mm, tilt: 60 deg"):
        c = cycle_of(kind, "kind: counterweight, mass: 3 kg, length: 200 mm", points=SWING)
        assert c.inertia == pytest.approx(2 * 0.09 + 3 * 0.04)
        assert c.torque == pytest.approx(c.inertia * c.acceleration, abs=1e-12)


def test_energy_comes_back_from_any_spring_about_an_axis():
    ends = "ends: {radius: 80 mm, anchor: 250 mm, angle: -70 deg}"
    gas = "kind: gas, force: 300 N, progression: 1.5, stroke: 200 mm, pressed: 90 mm"
    pull = "kind: constant, force: -90 N"
    for spring in (
        f"kind: linear, rate: 3 N/mm, {ends}",
        f"{pull}, {ends}",
        "kind: constant, torque: 4 N*m",
        gas + f", {ends}",
    ):
        c = cycle_of(ARM, spring, points=SWING)
        taken = np.abs(c.torque - cycle_of(ARM, "kind: torsion, rate: 1e-9 N*m/rad", points=SWING).torque.max()).max()
        assert taken > 1.0
        assert integral(c.duration, c.torque, c.speed) == pytest.approx(0.0, abs=1e-4)


def test_a_recording_turns_a_spring(tmp_path):
    (tmp_path / "r.csv").write_text("time,speed,torque\ns,rad/s,N*m\n0,0,1\n1,2,1\n2,0,1\n")
    spec = spec_of("kind: recorded, file: %s" % (tmp_path / "r.csv"), "kind: torsion, rate: 3 N*m/rad")
    assert load_cycle(spec).torque[:, 1] == pytest.approx([1 + 3 * 1.0, 1 + 3 * 2.0])


def test_a_spring_with_a_tolerance_is_a_column():
    spec = spec_of(
        ARM, "kind: torsion, rate: 3 N*m/rad, torque: 1 N*m", "kind: counterweight, mass: 1 kg, length: 0.1 m"
    )
    moved = np.array([-0.5, 0.0, 0.7])
    path = ("load", "springs", 0, "rate")
    together = load_cycle(applied(spec, {path: moved}), sampled=True)
    for n, one in enumerate(moved):
        alone = load_cycle(applied(spec, {path: float(one)}))
        assert rms(alone.duration, alone.torque) == pytest.approx(rms(together.duration, together.torque)[n])


# --- the edges --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("load", "spring", "said"),
    [
        (LIFT, "kind: torsion, rate: 1 N*m/rad", "the load moves along a line; expected kind: linear"),
        (ARM, "kind: linear, rate: 1 N/mm", "a force about an axis needs ends, e.g. {radius: 50 mm"),
        (ARM, "kind: constant, force: 1 N, torque: 1 N*m", "a constant one has one of force and torque"),
        (ARM, "kind: counterweight, mass: 1 kg", "a counterweight needs its length"),
        (LIFT, "kind: counterweight, mass: 1 kg, length: 1 m", "along a line hangs on its rope: leave length"),
        ("kind: flywheel, inertia: 1 kg*m^2", "kind: counterweight, mass: 1 kg, length: 1 m", "expected kind: arm"),
        (LIFT, "kind: gas, force: 9 N, stroke: 1 m, pressed: 2 m", "expected pressed of no more than stroke"),
        (LIFT, "kind: leaf, rate: 1 N/mm", '"leaf" is not known; the nearest is linear'),
    ],
)
def test_a_spring_that_does_not_fit_its_axis(load, spring, said):
    assert said in refusal(lambda: spec_of(load, spring), match=r"^x\.yaml:2: load")


def test_the_motion_stays_inside_a_gas_spring():
    with pytest.raises(InputError, match=r"load\.springs: the motion leads 200 mm beyond a gas spring's stroke"):
        cycle_of(LIFT, "kind: gas, force: 9 N, stroke: 1 m, pressed: 100 mm", points=UP_AND_DOWN)
    with pytest.raises(InputError, match="a counterweight's rope goes slack"):
        cycle_of(LIFT, "kind: counterweight, mass: 1 kg", points=[(0, 0), (0.01, 0.5), (0.02, 0)])


def test_a_sprung_load_has_to_come_back():
    spec = spec_of("kind: rotary_table, inertia: 1 kg*m^2", "kind: torsion, rate: 1 N*m/rad")
    assert "beyond where it starts, and the cycle repeats" in starts_farther_on("", spec)[0]
