"""Published cases of machine and drive together, recomputed by hand; and points that were printed and do not hold.

A and B are actuators of SizingLab's course on sizing (laboratories on a thrust vector control, 19edabfd): a motor on a
scaling law with a screw and a free gear ratio, all inertia but the rotor's left out. Both limits hold at the
optimum, so one equation in the torque T is left: T = F v / w(T) + J(T) a w(T) / v. There motors are of any size, here a
family in steps of 1 %: the member just above the optimum is the lightest. C is its second example, printed with a
torque margin of -29 N*m. The catalogue is that of NX servo motors in its laboratory.
"""

from __future__ import annotations

import math

import pytest

from drivesizer import design
from drivesizer.codesign.answer import Answer

LEAD = 0.01 / (2 * math.pi)  # m/rad
pytestmark = pytest.mark.slow

NX = """\
NX205EAV 2 2.1e-5 0.77 7500; NX205EAS 2 2.1e-5 0.77 8900; NX210EAT 3.4 3.8e-5 1.3 6000; NX210EAP 3.4 3.8e-5 1.3 7000;
NX310EAP 6.6 7.9e-5 2.1 4800; NX310EAK 6.6 7.9e-5 2.1 8400; NX420EAP 13.4 29e-5 3.8 4700; NX420EAJ 13.4 29e-5 3.8 7200;
NX430EAJ 18.8 42.6e-5 4.8 6200; NX430EAF 18.8 42.6e-5 4.8 6200; NX620EAR 26.7 98e-5 7 4500; NX620EAJ 26.7 98e-5 7 5700;
NX630EAR 40 147e-5 8.9 3100; NX630EAK 40 147e-5 8.9 5000; NX630EAG 40 147e-5 8.9 5000; NX820EAL 50 320e-5 13 6200;
NX840EAJ 92 620e-5 20 4100; NX860EAD 137 920e-5 27 3200; NX860VAG 137 920e-5 31 4000"""


def motors(rows):
    """A catalogue of motors by peak torque [N*m], inertia, mass and top speed [rad/s]; nothing else limits them."""
    columns = ["part", "peak_torque (N*m)", "rotor_inertia (kg*m^2)", "mass (kg)", "max_speed (rad/s)"]
    common = {
        "kind": "brushed", "nominal_voltage": "400 V", "torque_constant": "50 mN*m/A", "resistance": "1e-6 ohm",
        "no_load_current": "1e-6 mA", "no_load_speed": "70000 rpm", "nominal_current": "90000 A",
        "nominal_torque": "9000 N*m",
    }  # fmt: skip
    table = {"family": "LAW", "source": "s", "common": common, "columns": columns, "rows": [list(row) for row in rows]}
    return {
        "catalog": 1, "manufacturer": "Anymaker", "motors": [table],
        "sources": {"s": {"document": "scaling law", "confidence": "derived"}},
        "compatibility": {"motor_gearhead": [{"motors": ["LAW"], "gearheads": ["direct"], "source": "s"}]},
    }  # fmt: skip


def family(inertia, steps, first):
    """Motors on the law with an inertia at 13.4 N*m."""
    for n in range(steps):
        torque = first * 1.01**n
        s = torque / 13.4
        yield f"T{n}", torque, inertia * s ** (5 / 3.5), 3.8 * s ** (3 / 3.5), 754 * s ** (-1 / 3.5)


def torque_of_optimum(force, acceleration, speed, inertia):
    """The root of T = F v / w + J a w / v."""

    def short(torque):
        s = torque / 13.4
        w = 754 * s ** (-1 / 3.5)
        return force * speed / w + inertia * s ** (5 / 3.5) * acceleration * w / speed - torque

    low, high = 13.4, 134.0
    for _ in range(200):
        low, high = (low, (low + high) / 2) if short((low + high) / 2) < 0 else ((low + high) / 2, high)
    return low


@pytest.fixture
def actuator(tmp_path, monkeypatch):
    """The best ratio of an actuator with a screw as a pinion of the same travel per angle."""
    import yaml

    monkeypatch.chdir(tmp_path)

    def best(rows, force, acceleration, speed, ratio="0.5 .. 10", lead=LEAD, **free) -> Answer:
        (tmp_path / "motors.yaml").write_text(yaml.safe_dump(motors(rows), width=10_000), encoding="utf-8")
        spec = {
            "name": "actuator", "supply": {"nominal": "400 V", "accepts": "all"},
            "load": {"kind": "rack_pinion", "mass": "800 kg", "pinion_diameter": f"{2e3 * lead} mm",
                     "force": f"{force - 800 * acceleration} N"},
            "motion": {"speed": f"{speed} m/s", "acceleration_time": f"{speed / acceleration} s", "cruise_time": "1 s"},
            "transmission": [{"kind": "direct"}, {"kind": "gear", "ratio": {"free": ratio}, "efficiency": 1}],
            "select": {"catalogs": ["motors.yaml"], "estimates": "off"},
        }  # fmt: skip
        return design(spec, free=free, minimise="mass", evaluations=400)

    return best


def drive_of(found):
    row = dict(zip(found.task.heads, found.choice.row, strict=True))
    return row["motor_part"], row["machine_mass_kg"], float(found.values["transmission[2].ratio"])


A, B = (48000.0, 11.68, 0.22, 7.25e-5), (47895.68, 9.869604, 0.314159, 1.45e-4)


@pytest.mark.parametrize(
    ("case", "torque", "mass", "ratio"), [(A, 20.56, 5.49, 4.83), (B, 38.40, 9.37, 2.83)], ids=["A", "B"]
)
def test_the_lightest_motor_and_its_ratio_are_those_printed(actuator, case, torque, mass, ratio):
    assert torque_of_optimum(*case) == pytest.approx(torque, abs=0.006)
    rows = list(family(case[3], 20, 0.92 * torque))
    found = actuator(rows, *case[:3])
    part, weight, number = drive_of(found)
    lightest = next(row for row in rows if row[1] >= torque_of_optimum(*case))
    assert part == lightest[0]
    assert mass <= weight + 0.005 <= 1.01 * mass
    assert number == pytest.approx(ratio, rel=0.02)


def test_of_lead_and_ratio_their_quotient_alone_is_fixed(actuator):
    """Half the lead gives half the ratio and the same motor; where both are free only N/p = 3032.6 rad/m is."""
    rows = list(family(A[3], 20, 18.9))
    whole, half = (drive_of(actuator(rows, *A[:3], lead=lead)) for lead in (LEAD, LEAD / 2))
    assert whole[0] == half[0]
    assert half[2] / (LEAD / 2) == pytest.approx(whole[2] / LEAD, rel=0.02)
    assert whole[2] / LEAD == pytest.approx(3032.6, rel=0.01)


def test_what_was_printed_beyond_its_limits_is_no_optimum(actuator):
    """9.20 kg with a torque margin of -29 N*m: no motor below the optimum of B holds, at any ratio."""
    lighter = [row for row in family(B[3], 40, 26.0) if row[3] <= 9.2]
    found = actuator(lighter, *B[:3])
    assert found.best is None
    assert "No machine is within all limits" in str(found)


def test_of_the_nx_motors_one_holds_in_the_window_of_its_ratios(actuator):
    """A ratio exists where peak^2 / (4 J) >= F a: of B the NX860 alone, from N 0.876 to 1.525; of A none."""
    rows = [
        (part, float(peak), float(inertia), float(mass), float(rpm) * math.pi / 30)
        for part, peak, inertia, mass, rpm in (line.split() for line in NX.replace("\n", " ").split(";"))
    ]
    able = {row[0] for row in rows if row[1] ** 2 / (4 * row[2]) >= B[0] * B[1]}
    assert able == {"NX860EAD", "NX860VAG"}
    found = actuator(rows, *B[:3])
    assert drive_of(found)[:2] == ("NX860EAD", 27.0)
    flat = found.flat[0]
    assert float(flat.low) == pytest.approx(0.8759, rel=2e-3)
    assert float(flat.high) == pytest.approx(1.5254, rel=2e-3)
    assert flat.above == "motor_peak_torque"
    assert actuator(rows, *A[:3]).best is None
