"""The machines in examples/ and the starters: each is sized, and the arm is worked out again from its trajectory."""

import math
import re
from importlib import resources
from pathlib import Path

import pytest
from by_hand import friction
from refusals import refusal

from drivesizer.load_cases.platform import WheelLoad
from drivesizer.output.export import FORMATS, export_of, files, one_axis
from drivesizer.sizing import size
from drivesizer.spec.machine import load_any
from drivesizer.spec.robot import load_spec

ROOT = Path(__file__).resolve().parent.parent
STARTERS = sorted(
    p.name for p in (resources.files("drivesizer.spec") / "starters").iterdir() if p.name.endswith(".yaml")
)


@pytest.mark.parametrize("name", STARTERS)
def test_every_starter_finds_a_drive(name, tmp_path, catalog):
    path = tmp_path / "robot.yaml"
    text = (resources.files("drivesizer.spec") / "starters" / name).read_text(encoding="utf-8")
    path.write_text(text, encoding="utf-8")
    rows = "".join(f"{t / 10},{60 * math.sin(t / 20) ** 2:.4f},{1.2 + math.cos(t / 20):.4f}\n" for t in range(63))
    (tmp_path / "cycle.csv").write_text(f"time,speed,torque\ns,rpm,N*m\n{rows}", encoding="utf-8")
    spec = load_spec(path)
    result = size(spec, catalog=catalog, top=3)
    assert result.sets, result.counts
    assert result.method == "physics"
    record = export_of(spec, result.sets[0])
    for form, about in FORMATS.items():
        assert all(files(one_axis(record), form, tmp_path / f"set{about.suffixes[0]}").values()), form
    assert record.cycle.time[-1] == pytest.approx(result.problem.cases[0].cycle.total)
    whose = [said for said in record.assumptions if "the other wheels have their own" in said]
    assert bool(whose) == isinstance(result.problem.spec.load, WheelLoad)


@pytest.mark.parametrize("name", sorted(p.name for p in (ROOT / "examples").glob("*.yaml") if p.name != "study.yaml"))
def test_every_example_finds_a_drive(name, catalog):
    machine = load_any(ROOT / "examples" / name)
    if not machine.is_several:  # the page on machines sizes the one that is
        assert size(machine.axes[0].spec, catalog=catalog, top=1, detail="drives").sets


def arm_in_closed_form(s, seconds=20_000):
    """Mean Joule heat and RMS current of the sweeping arm: the trajectory itself, no segments."""
    motor, i, e = s.motor, s.gearhead.ratio, s.gearhead.efficiency
    encoder = 0.0 if s.encoder is None or math.isnan(s.encoder.inertia) else s.encoder.inertia
    J, (dry, per_speed) = motor.rotor_inertia + s.gearhead.inertia + encoder, friction(motor)
    m, length, square = 5.7182, 0.15, 0.0
    for k in range(seconds):
        t = (k + 0.5) / seconds
        angle = -math.pi / 4 * math.cos(2 * math.pi * t)
        w = math.pi**2 / 2 * math.sin(2 * math.pi * t)
        a = math.pi**3 * math.cos(2 * math.pi * t)
        T = m * length**2 * a + m * 9.81 * length * math.cos(angle)
        forward = T / (i * e) if T * w > 0 else T * e / i
        loss = math.copysign(dry, w) + per_speed * w * i
        square += (forward + J * i * a + loss) ** 2 / seconds
    return math.sqrt(square) / motor.torque_constant


def test_the_arm_of_cords(catalog):
    """Rezazadeh and Hurst, IROS 2014: theta = -(pi/4) cos 2 pi t, the largest torque 10 N m, least Joule heat."""
    result = size(load_spec(ROOT / "examples" / "cords_arm.yaml"), catalog=catalog, top=5)
    torque = next(r for r in result.requirements if r.name == "maximum_torque_per_motor").value
    assert torque == pytest.approx(10.0, rel=1e-4)
    heats = [s.objective for s in result.sets]
    assert heats == sorted(heats)
    for s in result.sets:
        rms = next(c for c in s.checks if c.name == "motor_nominal_current").demand
        assert rms == pytest.approx(arm_in_closed_form(s), rel=1e-4)
        warmer = s.objective / (s.motor.resistance * rms**2)  # by the resistance that grows with the winding's warmth
        assert 1.0 < warmer < 1.0 + 0.0039 * 100


NAMED = {  # what a starter says in place of its motion
    "recorded.yaml": ("load.file", ""),
    "hoist.yaml": ("motion.file", "motion: {profile: csv, file: cycle.csv}\n"),
    "mecanum_platform.yaml": ("motion.trajectory", "motion: {profile: trajectory, trajectory: cycle.csv}\n"),
}


@pytest.mark.parametrize("name", NAMED)
def test_a_file_that_a_spec_names_and_that_is_not_there(name, tmp_path):
    field, motion = NAMED[name]
    text = (resources.files("drivesizer.spec") / "starters" / name).read_text(encoding="utf-8")
    path = tmp_path / "robot.yaml"
    path.write_text(re.sub(r"^motion:.*\n(?:[ #].*\n)*", motion, text, flags=re.MULTILINE), encoding="utf-8")
    rows = enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
    line = next(n for n, row in rows if re.search(r"(file|trajectory): cycle\.csv", row))
    assert refusal(lambda: size(load_spec(path))) == (
        f'{path}:{line}: {field}: "cycle.csv" cannot be read (no such file or directory); '
        "expected a CSV file, its path from the spec's folder, e.g. cycle.csv"
    )
