"""The best machine with its drive: closed forms, brute force, limits, what is wrong in one line."""

from __future__ import annotations

import math
import re
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from refusals import refusal
from typer.testing import CliRunner

from drivesizer import LoadCycle
from drivesizer.cli import app
from drivesizer.codesign.answer import answer, roundest
from drivesizer.codesign.task import read_task
from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource, read
from drivesizer.sizing import size
from drivesizer.spec.robot import load_spec

ROTOR = 5e-5  # kg*m^2
MOTORS = f"""\
catalog: 1
manufacturer: Anymaker
sources: {{s: {{document: data sheet, confidence: quoted, date: "2024-05"}}}}
motors:
- family: LAW
  source: s
  common: {{kind: brushed, nominal_voltage: 400 V, torque_constant: 1 N*m/A, resistance: 1 ohm, inductance: 1 mH,
    no_load_current: 1e-6 mA, nominal_current: 50 A, nominal_torque: 50 N*m, max_speed: 100000 rpm, mass: 1 kg,
    no_load_speed: 3819.7 rpm, max_winding_temperature: 300 degC,
    thermal_resistance_housing: 0.001 K/W, thermal_resistance_winding: 0.001 K/W, winding_time_constant: 9 s,
    motor_time_constant: 999 s}}
  columns: [part, rotor_inertia (kg*m^2)]
  rows: [[A, {ROTOR}]]
compatibility: {{motor_gearhead: [{{motors: [LAW], gearheads: [direct], source: s}}]}}
"""
TABLE = """\
name: table
load: {kind: rotary_table, inertia: 0.02 kg*m^2}
motion: {profile: trapezoid, speed: 2 rad/s, acceleration_time: 1 s, cruise_time: 1 s}
transmission:
  - {kind: direct}
  - {kind: gear, ratio: {free: 3 .. 60}, efficiency: 1}   # of the belt's makers
supply: {nominal: 400 V, accepts: all}
select: {catalogs: [motors.yaml], estimates: "off"}
design: {minimise: joule_heat, evaluations: 200}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "motors.yaml").write_text(MOTORS, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def best(folder: Path, text: str, **how):
    (folder / "robot.yaml").write_text(text, encoding="utf-8")
    return answer(read_task(read(folder / "robot.yaml")), processes=1, **how)


def figure(found, name="transmission[2].ratio"):
    return float(re.match(r"[-\d.e]+", str(found.values[name]))[0])


@pytest.mark.parametrize(
    ("efficiency", "friction"), [(1.0, 0.0), pytest.param(1.0, 0.5, marks=pytest.mark.slow), (0.7, 0.5)]
)
def test_the_ratio_of_least_heat_is_that_of_the_closed_form(folder, efficiency, friction):
    """Pasch, Seering 1984: sqrt(J_L/J_M); Giberti et al. 2010: sqrt(T_rms/(eta J_M a_rms)) where it always drives."""
    text = TABLE.replace("efficiency: 1}", f"efficiency: {efficiency}}}")
    text = text.replace("0.02 kg*m^2}", f"0.02 kg*m^2, friction_torque: {friction} N*m}}")
    ends = friction + 0.02 * 2.0, friction, friction - 0.02 * 2.0
    rms = math.sqrt(sum(one**2 for one in ends) / 3)
    alpha = 2.0 * math.sqrt(2 / 3)
    expected = math.sqrt(rms / (efficiency * ROTOR * alpha))
    assert friction or expected == pytest.approx(math.sqrt(0.02 / ROTOR))
    found = best(folder, text.replace("3 .. 60", "3 .. 200"))
    assert figure(found) == pytest.approx(expected, rel=1e-3)


def test_a_trapezoid_of_thirds_takes_the_least_heat_and_a_parabola_less(folder):
    """Over D in T the integral of a^2 is 12 D^2/T^3 of the parabola of speed, 13.5 of thirds, 16 of the triangle."""
    text = TABLE.replace("{free: 3 .. 60}", "7")
    move = """{profile: trapezoid, speed: {expression: 6 / (3 - motion.acceleration_time)},
  acceleration_time: {free: 0.3 s .. 1.49 s}, cruise_time: {expression: 3 - 2 * motion.acceleration_time}}"""
    found = best(folder, re.sub(r"motion: .*", f"motion: {move}", text))
    assert figure(found, "motion.acceleration_time") == pytest.approx(1.0, rel=2e-3)
    triangle = best(folder, re.sub(r"motion: .*", f"motion: {move}", text).replace("0.3 s .. 1.49 s", "[1.499999 s]"))
    thirds, most = (one.choice.goals[0] for one in (found, triangle))
    assert most == pytest.approx(16 / 13.5 * thirds, rel=1e-3)
    time = np.linspace(0.0, 3.0, 301)  # 4 rad in 3 s, as the table's own trapezoid
    parabola = LoadCycle.from_arrays(time, 8 / 9 * time * (3 - time), 0.02 * 8 / 9 * (3 - 2 * time), inertia=0.02)
    sizings = (size(load_spec_of(text), load=load, detail="drives").sets[0] for load in (parabola, None))
    least, own = (next(one.value for one in found.figures if one.name == "joule_heat") for found in sizings)
    assert own / least == pytest.approx(13.5 / 12, rel=1e-3)


def test_a_wheel_and_a_ratio_of_which_only_the_quotient_counts_are_flat_together(folder):
    """Traction is M i eta/r: without inertia of the wheel the valley i/r is flat, and both may go along it."""
    axis = "{kind: belt_axis, mass: 20 kg, pulley_diameter: {free: 40 mm .. 80 mm}}"
    text = TABLE.replace("{kind: rotary_table, inertia: 0.02 kg*m^2}", axis).replace("speed: 2 rad/s", "speed: 0.4 m/s")
    found = best(folder, text.replace("3 .. 60", "5 .. 30"))
    expected = math.sqrt(20 / ROTOR)  # per metre: i/r = sqrt(m/J_M)
    assert figure(found) / (figure(found, "load.pulley_diameter") / 2e3) == pytest.approx(expected, rel=2e-3)


CART = """\
name: cart
load: {kind: wheeled_vehicle, mass: MASS kg, driven_wheels: {free: [2, 4]}, rolling_resistance: 0.02,
  wheel_diameter: {free: 120 mm .. 240 mm, step: 40 mm}, inertia: 40 kg*cm^2, slope: SLOPE deg}
motion: {speed: {free: 0.8 m/s .. 1.6 m/s, step: 0.2 m/s}, acceleration_time: 1 s, cruise_time: 10 s}
supply: {nominal: 24 V, accepts: all}
select: {catalogs: [maxon], motor: {family: [RE 25, RE 30, RE 40]}, gearhead: {family: [GP 32 A, GP 42 C]}}
design: {minimise: GOAL, subject_to: [LIMIT]}
"""


@pytest.mark.parametrize("number", [n if n < 2 else pytest.param(n, marks=pytest.mark.slow) for n in range(20)])
def test_brute_force_finds_no_better_machine(tmp_path, number):
    """Twenty carts by chance: of every combination `size` makes the sums, whatever the design room looks at."""
    chance = np.random.default_rng(number)
    goal = ["mass", "price", "mass - 0.5 * motion.speed", "mass + load.wheel_diameter"][number % 4]
    least = f"motion.speed >= {chance.choice([0.9, 1.1, 1.3])} m/s"
    text = CART.replace("MASS", f"{chance.uniform(30, 150):.3g}").replace("SLOPE", f"{chance.uniform(0, 4):.2g}")
    text = text.replace("GOAL", goal).replace("LIMIT", least)
    (tmp_path / "cart.yaml").write_text(text, encoding="utf-8")
    task = read_task(read(tmp_path / "cart.yaml"))
    found = answer(task, processes=1)
    brute = math.inf
    for values in product(*(one.values for one in task.free)):
        wheels, diameter, speed = values[0], *(float(one.split()[0]) for one in values[1:])
        if speed < float(least.split()[2]):
            continue
        spec = load_spec_of(task.filled(values))
        for one in size(spec, top=1, detail="drives").sets:
            mass, more = wheels * one.mass, (0.0, 0.0, -0.5 * speed, diameter / 1e3)[number % 4]
            brute = min(brute, wheels * one.price if goal == "price" else mass + more)
    assert (found.choice.goals[0] if found.choice else math.inf) == pytest.approx(brute, rel=1e-9)


def load_spec_of(text):
    return load_spec({**YamlSource(text, "cart").data})


def test_what_no_machine_meets_is_no_optimum(folder):
    """An infeasible point is never the best: it is named as the closest, with what it fails on, and the status is 1."""
    text = TABLE.replace("400 V, accepts", "1 V, accepts").replace("free: 3 .. 60", "free: [5, 20, 40]")
    (folder / "robot.yaml").write_text(text, encoding="utf-8")
    run = CliRunner().invoke(app, ["design", "--processes", "1", "-o", "best.yaml"])
    assert run.exit_code == 1
    assert "No machine is within all limits." in run.stdout
    assert not (folder / "best.yaml").exists()


def test_the_spec_is_written_with_its_comments_and_sizes_as_it_was_found(folder):
    (folder / "robot.yaml").write_text(TABLE.replace("evaluations: 200", "evaluations: 40"), encoding="utf-8")
    run = CliRunner().invoke(app, ["design", "--processes", "1", "-o", "best.yaml", "--folder", "rows"])
    assert run.exit_code == 0, run.output
    text = (folder / "best.yaml").read_text(encoding="utf-8")
    assert "# of the belt's makers" in text
    assert "free" not in text
    ratio = float(re.search(r"ratio: ([\d.]+)", text)[1])
    assert f"{ratio:g}" in run.stdout
    before = (folder / "rows" / "rows.jsonl").read_bytes()
    again = CliRunner().invoke(app, ["design", "--processes", "1", "-o", "best.yaml", "--folder", "rows"])
    assert again.stdout == run.stdout
    assert (folder / "rows" / "rows.jsonl").read_bytes() == before  # nothing was sized again
    (folder / "rows" / "rows.jsonl").write_bytes(before[: len(before) // 2])  # killed on the way
    assert CliRunner().invoke(app, ["design", "--processes", "1", "--folder", "rows"]).stdout in run.stdout


def test_a_limit_of_the_battery_is_written_as_it_was_said_and_checks_without_figures_are_named(folder):
    """A battery without a voltage at rest: its checks at the peak are unknown, and the autonomy is Peukert's."""
    block = "chemistry: lead-acid, nominal_voltage: 12 V, capacity: 7 A*h, rated_time: 20 h, peukert_exponent: 1.2"
    limits = "{minimise: -autonomy, subject_to: [autonomy >= 2 h]}"
    text = CART.replace("MASS", "40").replace("SLOPE", "0").replace("120 mm .. 240 mm, step: 40 mm", "[120 mm]")
    text = re.sub("design: .*", f"design: {limits}", text).replace(
        "nominal: 24 V", "nominal: 24 V, min: 20 V, max: 29 V"
    )
    found = best(folder, f"{text}battery: {{series: 2, {block}}}\n")
    assert "autonomy: 2 h" in found.filled()
    assert "Best autonomy: " in str(found)
    assert re.search(r"unknown +battery power, largest; battery voltage at the peak", re.sub(r"\s+", " ", str(found)))


@pytest.mark.slow
def test_thirty_free_figures_are_told_not_to_be_searched_whole(folder):
    bodies = ["{shape: point, offset: 100 mm, mass: {free: 10 g .. 90 g}}"] * 29
    text = TABLE.replace("0.02 kg*m^2", f"[{', '.join(bodies)}]").replace("evaluations: 200", "evaluations: 40")
    found = best(folder, text)
    assert len(found.values) == 30
    assert "30 free figures allow; not all" in str(found)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("free: 3 .. 60", "free: 60 .. 3"), 'ratio.free: "60 .. 3": the first is not below the second'),
        (("free: 3 .. 60", "free: 3 kg .. 60"), "robot.yaml:6: transmission[2].ratio.free"),
        (("free: 3 .. 60", "free: 3 .. 60, stop: 2"), 'robot.yaml:6: transmission[2].ratio.stop: unknown key'),
        (("free: 3 .. 60", "free: 3 .. 60, step: -2"), "robot.yaml:6: transmission[2].ratio.step"),
        (("free: 3 .. 60", "free: []"), "robot.yaml:6: transmission[2].ratio"),
        (("{free: 3 .. 60}", "7"), "robot.yaml: no figure is free"),
        (("joule_heat,", "weight,"), 'robot.yaml:9: design.minimise: "weight" is no figure'),
        (("joule_heat,", "load.mass,"), "robot.yaml:9: design.minimise"),
        (("joule_heat,", "'().__class__',"), "robot.yaml:9: design.minimise"),
        (("joule_heat,", "mass, subject_to: [mass < 3 kg],"), "is no limit; expected e.g. autonomy >= 3 h"),
        (("joule_heat,", "mass, subject_to: [mass <= 3 s],"), "unit of time, not of mass"),
        (("joule_heat,", "-autonomy,"), 'design.minimise: "-autonomy": autonomy is by a battery; expected a section'),
        (("0.02 kg*m^2", "{expression: 2 * load.inertia}"), "follows from itself"),
        (("0.02 kg*m^2", "{expression: 2 * load.width}"), "load.width"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_one_line(folder, change, said):
    assert said in refusal(lambda: best(folder, TABLE.replace(*change)))


def test_a_free_figure_is_refused_where_one_is_wanted(folder):
    (folder / "robot.yaml").write_text(TABLE, encoding="utf-8")
    with pytest.raises(InputError, match=r"robot.yaml:6: transmission\[2\].ratio: is free; `drivesizer design`"):
        load_spec("robot.yaml")


@pytest.mark.parametrize(
    ("ends", "near", "found"),
    [((171.3, 188.9), 176, 180), ((0.21, 0.29), 0.25, 0.25), ((1.49, 2.6), 1.6, 2), ((3, 3), 3, 3)],
)
def test_the_roundest_figure_of_a_range(ends, near, found):
    assert roundest(*ends, near) == pytest.approx(found)
