"""Motors of shops: by voltage, stall and no load alone. What follows from these figures is not unknown, and what lacks
is named by every command."""

from __future__ import annotations

import random
from math import isnan, nan, pi
from pathlib import Path

import numpy as np
import pytest

from drivesizer.catalog import load
from drivesizer.catalog.laws import DERIVED, derived, identities, solved, value
from drivesizer.catalog.query import PartRow
from drivesizer.catalog.tables import Table, empty
from drivesizer.catalog.view import search_view
from drivesizer.physics.drive_train import friction
from drivesizer.prediction.predict import completed, predict
from drivesizer.prediction.set_at_voltage import sampled_parts
from drivesizer.results.prediction import Conditions
from drivesizer.search.uncertainty.uncertain_figures import holding

VEX = """catalog: 1
manufacturer: VEX EDR
sources:
  shop: {document: "shop page of the two-wire motor 393", date: "2015-01", confidence: secondary}
actuators:
  - family: "393"
    source: shop
    common: {kind: brushed, gearing: spur}
    columns: [part, nominal_voltage (V), no_load_speed (rpm), no_load_current (A), stall_torque (N*m),
      stall_current (A), mass (g)]
    rows:
      - [VEX393, 7.2, 100, 0.37, 1.67, 4.8, 87]
"""
M550 = Path(__file__).with_name("verdicts_hobby_m550.yaml").read_text(encoding="utf-8")
FEW = Path(__file__).with_name("verdicts_hobby_few.yaml").read_text(encoding="utf-8")
RPM = 2 * pi / 60
BENCH = Conditions(
    voltage=nan, ambient=298.15, load=nan, hold=nan, inertia=0.0, duration=60.0, warm=nan, resistance=0.0
)


@pytest.fixture
def here(tmp_path, monkeypatch):
    files = {"vex393.yaml": VEX, "m550.yaml": M550, "few.yaml": FEW}
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def hit(name, section, part):
    catalog = load([f"{name}.yaml"])
    return PartRow(name, catalog, section, catalog.table(section).rows[part])


def of(motor, gearhead=None, **given):
    return predict(motor, gearhead, None, completed(BENCH._replace(**given), motor, gearhead))


# --- figures that follow ---------------------------------------------------------------------------------------------


def test_a_motor_by_stall_and_no_load_has_its_constants(here):
    """By hand: R = 12 V / 85 A = 0.1412 ohm, k_t = 0.498 N*m / 85 A = 5.859 mN*m/A."""
    motor = hit("m550", "motors", "M550")
    assert motor["resistance"] == pytest.approx(0.141176, rel=1e-5)
    assert motor["torque_constant"] == pytest.approx(5.85882e-3, rel=1e-5)
    sure = motor.catalog.confidence("motors", motor.row)
    assert sure["torque_constant"] == sure["resistance"] == "derived" and sure["stall_torque"] == "secondary"
    (said,) = (n.text for n in motor.catalog.notes_on("motors", "M550") if n.fields == ("torque_constant",))
    assert "stall_torque = torque_constant * stall_current" in said and "I_0 not taken off" in said
    found = of(motor)
    assert found.figure("free_speed").band.nominal == pytest.approx(19300 * RPM, rel=0.01)
    assert found.figure("no_load_current").band.nominal == pytest.approx(1.4, rel=0.02)
    assert not {"motor resistance", "motor torque constant"} & {name for one in found.figures for name in one.missing}


def test_a_gearmotor_of_unknown_ratio_lies_beside_its_printed_line(here):
    """By hand: of R = 7.2 V / 4.8 A = 1.5 ohm nine tenths are the winding's, k_e = (7.2 V - 1.5 ohm 0.37 A)/100 rpm.

    The current goes straight from 0.37 A without load to 4.8 A at 1.67 N*m; the printed line is within the band.
    """
    motor = hit("vex393", "actuators", "VEX393")
    assert isnan(motor["ratio"])
    R, k_e = 0.9 * 1.5, (7.2 - 1.5 * 0.37) / (100 * RPM)
    for torque in (0.0, 0.4, 1.1):
        found, share = of(motor, load=torque), torque / 1.67
        current, speed = 0.37 + share * (4.8 - 0.37), found.figure("load_speed").band
        assert found.figure("load_current").band.nominal == pytest.approx(current, rel=0.03)
        assert speed.nominal == pytest.approx((7.2 - R * current) / k_e, rel=0.02)
        assert speed.p5 < (1 - share) * 100 * RPM < speed.p95
    torque, current = (found.figure(name).band for name in ("stall_torque", "stall_current"))
    assert current.nominal == pytest.approx(7.2 / R, rel=0.01) and current.p5 < 4.8 < current.p95
    assert torque.nominal == pytest.approx(1.67 * (7.2 / R - 0.37) / (4.8 - 0.37), rel=0.02)
    assert torque.p5 < 1.67 < torque.p95


@pytest.mark.parametrize("maker", ["andymark", "banebots", "ctre", "vex"])
def test_motors_that_were_worked_out_by_hand_come_out_alike(maker):
    """The shipped rows of FRC motors have V / I_stall and M_stall / I_stall to four digits."""
    table = load([maker]).motors
    by_hand = ~np.isnan(table["stall_torque"] + table["torque_constant"]) & (table["commutation"] == "")
    by_hand &= np.abs(table["resistance"] * table["stall_current"] / table["nominal_voltage"] - 1) < 1e-3
    assert_alike(table, by_hand, ("resistance", "torque_constant"), 6e-4)


@pytest.mark.parametrize("maker", ["pololu", "dfrobot", "gobilda"])
def test_gearmotors_that_were_worked_out_by_hand_come_out_alike(maker):
    table = load([maker]).actuators
    by_hand = ~np.isnan(table["stall_torque"] + table["no_load_current"])
    assert_alike(table, by_hand, ("resistance", "motor_torque_constant", "efficiency"), 2e-3)


def assert_alike(table, rows, figures, rel):
    """Figures that are taken away come back as they were."""
    some = table.at_rows(np.flatnonzero(rows))
    columns = {name: values.copy() for name, values in some.columns.items()}
    for name in (*figures, "torque_constant"):
        columns[name][:] = nan
    bare = Table(some.section, columns, some.source, some.excluded)
    derived({section: empty(section) for section in ("motors", "actuators")} | {some.section: bare})
    assert len(some) >= 2
    for name in figures:
        np.testing.assert_allclose(columns[name], some[name], rtol=rel)


@pytest.mark.parametrize("one", DERIVED, ids=lambda one: f"{one.section} {one.figure} {one.identity}")
def test_what_is_solved_fulfils_its_identity(one):
    """Random figures; the solved one put back fulfils it, and gives another again where it is linear in that."""
    draw = random.Random(7)
    equation = identities()[one.section][one.identity]
    figures = {name: draw.uniform(0.2, 0.9) for name in columns_in(equation)} | {"back_emf_constant": nan}
    found = solved(equation, figures, one.figure)
    whole = figures | {one.figure: float(found)}
    left, right = equation.partition(" where ")[0].split(" = ")
    assert value(left, whole) == pytest.approx(value(right, whole), rel=1e-9, nan_ok=True)
    squared = {("speed-torque gradient", "torque_constant"), ("mechanical time constant", "torque_constant"),
               ("stall torque and no-load speed", "nominal_voltage"),
               ("stall torque and no-load speed alone", "nominal_voltage")}  # fmt: skip
    for name in columns_in(equation) - {one.figure, "back_emf_constant"}:
        if (one.identity, name) not in squared:
            assert solved(equation, whole, name) == pytest.approx(whole[name], rel=1e-9)


def columns_in(equation):
    bare = equation.partition(" where ")[0].replace("(", " ").replace(")", " ")
    names = {name for name in bare.split() if name[0].isalpha()}
    return (names - {"k_e"}) | ({"torque_constant"} if "k_e" in names else set())


def test_a_friction_that_stands_alone_counts():
    """k_t I_0 = 6 mN*m at 586.4 rad/s, 2e-6 N*m*s/rad of it viscous: 4.827 mN*m are dry."""
    motor = {"torque_constant": 0.02, "no_load_current": 0.3, "no_load_speed": 586.4, "kind": "brushed",
             "inside": "", "winding": "", "friction_torque": nan, "viscous_friction": 2e-6}  # fmt: skip
    coulomb, viscous = friction(motor)
    assert (float(coulomb), float(viscous)) == pytest.approx((4.8272e-3, 2e-6))
    coulomb, viscous = friction(motor | {"friction_torque": 4.8272e-3, "viscous_friction": nan})
    assert (float(coulomb), float(viscous)) == pytest.approx((4.8272e-3, 2e-6))
    coulomb, viscous = friction(motor | {"no_load_current": nan})
    assert isnan(coulomb) and viscous == 2e-6  # what is dry of it nobody knows: not none


# --- what lacks is named ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("part", ["KRI", "KRI brushless"])
def test_a_free_speed_needs_neither_a_nominal_point_nor_an_efficiency(here, part):
    """(12 V - 0.5 ohm 0.3 A) / (20 mN*m/A) / 9 = 65.83 rad/s."""
    found = of(hit("few", "motors", part), hit("few", "gearheads", "G9"), voltage=12.0)
    assert found.figure("free_speed").band.nominal == pytest.approx(65.833, rel=0.005)
    assert found.figure("no_load_current").band.nominal == pytest.approx(0.3, rel=0.02)
    assert found.figure("stall_torque").missing == ("gearhead efficiency",)
    assert "gearhead efficiency" not in found.figure("step_time_63").missing


def test_whatever_lacks_is_named(here):
    """Of a motor from whose row figures are struck at random, every unknown figure says what it lacks."""
    draw = random.Random(3)
    catalog = load(["maxon"])
    full = catalog.motors.rows["DCX22S01EBKL598"]
    names = [name for name, values in catalog.motors.columns.items() if values.dtype.kind == "f"]
    for _ in range(8):
        columns = {name: values[full : full + 1].copy() for name, values in catalog.motors.columns.items()}
        for name in draw.sample(names, 12):
            columns[name][:] = nan
        table = Table("motors", columns, catalog.motors.source[full : full + 1], np.zeros(1, bool))
        one = PartRow("maxon", catalog.with_tables({"motors": table}, {}), "motors", 0)
        for figure in of(one).figures:
            assert isnan(figure.band.nominal) == bool(figure.missing), figure


# --- classes of what follows from stall

GIVEN = Conditions(nan, 298.15, nan, nan, 0.0, 3600.0, nan, 0.0)
LIFTED = [(2.53, 0.175), (3.69, 0.239), (5.79, 0.368), (6.94, 0.371)]  # V, N*m
FREE = [(3.0, 1.70456), (12.0, 7.00109), (15.0, 8.77406)]  # MX-64: V, rad/s


def classes_of(catalogue, part, given=None):
    view = search_view(load([catalogue]))
    row = view.motors.rows[part]
    (gearhead,) = np.flatnonzero(view.gearheads["inside"] == part) if view.motors["inside"][row] else (-1,)
    held = holding(view, given or {}, "motor", row) + holding(view, given or {}, "gearhead", int(gearhead))
    return {f"{one.part}.{one.figure}": one.text for one in held}


def hit_of(catalogue, section, part):
    found = load((catalogue,))
    return PartRow(", ".join(found.digests), found, section, found.table(section).rows[part])


def test_what_follows_from_stall_has_classes_of_its_own():
    found = classes_of("robotis", "MX-64 12 V")
    assert found["motor.resistance"] == "0.72..0.9..1.22 times"
    assert found["gearhead.peak_torque"] == "0.5..1.1 times"
    # 200:1 is four stages: 0.87^4 = 57 %, against what the sheet has without the friction
    view = search_view(load(["robotis"])).actuators
    sheet = view["efficiency"][view.rows["MX-64 12 V"]]
    low, high = (float(x) for x in found["gearhead.efficiency"].removesuffix(" times").split(".."))
    assert (low, high) == pytest.approx((0.35, (0.87**-4 - 1) / (1 / sheet - 1)), rel=0.1)


@pytest.mark.parametrize(("catalogue", "part"), [("maxon", "118752"), ("faulhaber", "2232S024BX4")])
def test_printed_figures_keep_the_class_of_printed_figures(catalogue, part):
    found = classes_of(catalogue, part)
    assert (found["motor.resistance"], found["motor.torque_constant"]) == ("+- 10 %", "+- 10 %")
    assert ("motor.dry_friction" in found) == (catalogue == "maxon") and "gearhead.peak_torque" not in found


def test_a_motor_of_a_printed_no_load_current_keeps_the_class_of_its_constant():
    found = classes_of("rev", "NEO V1.1")
    assert (found["motor.resistance"], found["motor.torque_constant"]) == ("0.72..0.9..1.22 times", "+- 10 %")
    assert found["motor.dry_friction"] == "-75 %..65 %"


def test_measured_servos_are_within_the_bands():
    def band_at(hit_of, volts, figure):
        at = completed(GIVEN._replace(voltage=volts), hit_of, None)
        return predict(hit_of, None, None, at, warming=False).figure(figure).band

    mx = hit_of("robotis", "actuators", "MX-64 12 V")
    for volts, speed in FREE:
        band = band_at(mx, volts, "free_speed")
        assert band.p5 < speed < band.p95
    xl = hit_of("robotis", "actuators", "XL330-M288-T 6 V")
    for volts, torque in LIFTED:
        band = band_at(xl, volts, "stall_torque")
        assert band.p5 < torque < band.p95
    R = sampled_parts(hit_of("robotis", "actuators", "MX-106 12 V"), None, None, 9).motor["resistance"][1:]
    assert np.quantile(R, 0.05) < 2.09 < 2.32 < np.quantile(R, 0.95) * 1.01  # ohm, locked and lifting
