"""The page of one part: its line and continuous region, what the winding bears, and that it fits every terminal.

Expected figures come from the formulas of the trade, written out here.
"""

from __future__ import annotations

from math import exp, isnan, log, pi, sqrt
from pathlib import Path

import pytest

from drivesizer.catalog.query import PartRow, find, open_catalogs
from drivesizer.machine.part_curves import continuous_curve, line, overload_times, permitted_current
from drivesizer.output.document.catalogue import page
from drivesizer.output.terminal import render
from drivesizer.physics.thermal import COPPER

RPM = pi / 30
V, R, K, I_0, I_N = 24.0, 2.0, 0.024, 0.05, 1.2
R_TH1, R_TH2, TAU_W, TAU_H, HOT = 3.0, 14.0, 12.0, 600.0, 125.0
T_25 = 298.15

MOTOR = {
    "kind": "brushed", "nominal_voltage": f"{V} V", "no_load_speed": "9500 rpm", "no_load_current": f"{I_0} A",
    "nominal_speed": "8500 rpm", "nominal_torque": "27.6 mN*m", "nominal_current": f"{I_N} A",
    "stall_torque": "288 mN*m", "stall_current": "12 A", "resistance": f"{R} ohm", "torque_constant": f"{K} N*m/A",
    "thermal_resistance_winding": f"{R_TH1} K/W", "thermal_resistance_housing": f"{R_TH2} K/W",
    "winding_time_constant": f"{TAU_W} s", "motor_time_constant": f"{TAU_H} s",
    "max_winding_temperature": f"{HOT} degC", "max_speed": "12000 rpm", "ambient_max": "85 degC",
}  # fmt: skip
REGION = {"standstill_torque": "30 mN*m", "half_speed_torque": "27 mN*m", "top_speed_torque": "18 mN*m"}
OUTPUT = {
    "kind": "brushless", "ratio": "10", "nominal_voltage": "24 V", "no_load_speed": "200 rpm",
    "nominal_speed": "150 rpm", "nominal_torque": "5 N*m", "nominal_current": "3 A", "stall_torque": "18 N*m",
    "peak_torque": "9 N*m", "max_speed": "160 rpm",
}  # fmt: skip


def write(path: Path, section: str, **figures: str) -> Path:
    rows = ", ".join(f"{name}: {text}" for name, text in figures.items())
    path.write_text(
        "catalog: 1\nmanufacturer: Anymaker\nsources:\n  sheet: {document: a sheet, confidence: quoted}\n"
        f"{section}:\n- family: F 1\n  source: sheet\n  common: {{{rows}}}\n  columns: [part]\n  rows: [[P1]]\n"
    )
    return path


@pytest.fixture
def part(tmp_path):
    """A part of made-up figures; those that are None are unknown."""

    def make(section: str = "motors", **changed: str | None) -> PartRow:
        figures = (MOTOR if section == "motors" else OUTPUT) | changed
        known = {name: text for name, text in figures.items() if text is not None}
        return find(open_catalogs([str(write(tmp_path / "own.yaml", section, **known))]), "P1")[0]

    return make


@pytest.fixture
def shown(monkeypatch, capsys):
    """The page of a part at a width."""

    def show(hit: PartRow, width: int = 80) -> str:
        monkeypatch.setenv("COLUMNS", str(width))
        render.document(page(hit))
        return capsys.readouterr().out

    return show


def words(text: str) -> str:
    return " ".join(text.split())


# --- torque and speed ------------------------------------------------------------------------------------------------


def test_the_makers_ends_are_taken(part):
    ends = line(part())
    assert (ends.speed, ends.torque, ends.computed) == (pytest.approx(9500 * RPM), pytest.approx(0.288), False)


def test_unknown_ends_follow_from_voltage_resistance_and_constant(part):
    ends = line(part(no_load_speed=None, stall_torque=None))
    assert ends.speed == pytest.approx((V - R * I_0) / K)
    assert ends.torque == pytest.approx(K * (V / R - I_0))
    assert ends.computed
    assert line(part(stall_torque=None)).torque == pytest.approx(K**2 / R * 9500 * RPM)


def test_an_actuators_speed_is_not_made_of_a_constant_with_losses(part):
    out = {"no_load_speed": None, "no_load_current": "0.5 A", "resistance": "1 ohm", "torque_constant": "0.8 N*m/A"}
    assert isnan(line(part("actuators", **out)).speed)
    ends = line(part("actuators", **out, motor_torque_constant="0.1 N*m/A"))
    assert ends.speed == pytest.approx((24 - 0.5) / (0.1 * 10))
    assert line(part("actuators", **out, motor_torque_constant="0.1 N*m/A", stall_torque=None)).torque == pytest.approx(
        0.8 * (24 - 0.5)
    )


def test_the_continuous_region_goes_through_its_three_points(part):
    torque, speed = continuous_curve(part(**REGION))
    middle = speed.index(pytest.approx(6000 * RPM))
    assert [torque[0], torque[middle], torque[-1]] == pytest.approx([0.030, 0.027, 0.018])
    assert (speed[0], speed[-1]) == (0.0, pytest.approx(12000 * RPM))
    assert torque == sorted(torque, reverse=True)


def test_iron_losses_that_grow_with_the_square_of_speed_are_met_exactly(part):
    def left(share: float) -> float:  # mN*m, what a loss of 64 % at the top leaves of the copper's
        return 30.0 * sqrt(1.0 - 0.64 * share**2)

    points = {f"{at}_torque": f"{left(s)} mN*m" for at, s in (("half_speed", 0.5), ("top_speed", 1.0))}
    torque, speed = continuous_curve(part(standstill_torque="30 mN*m", **points))
    assert torque == pytest.approx([left(w / (12000 * RPM)) * 1e-3 for w in speed])


@pytest.mark.parametrize("unknown", [*REGION, "max_speed"])
def test_without_one_of_its_figures_there_is_no_region(part, unknown):
    assert continuous_curve(part(**(REGION | {unknown: None}))) == ([], [])


def test_the_chart_says_what_it_shows(part, shown):
    said = words(shown(part()))
    assert "no load 9500 rpm 0 50 mA nominal 8500 rpm 27.6 mN·m 1.2 A stall 0 288 mN·m 12 A" in said
    assert "⠒⠒ at 24 V, winding at 25 °C; stall, 288 mN·m, is beyond the chart" in said
    assert "● nominal point" in said
    assert "continuous, at 25 °C" not in said
    assert "0 20 40 60 80 torque [mN·m]" in said  # the axis ends at 3 x 27.6
    assert "⠂⠂ continuous, at 25 °C around the motor" in words(shown(part(**REGION)))


# --- heat ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("ambient", [25, 40, 60, 80])
def test_the_nominal_current_is_derated_by_what_is_left_to_the_copper(part, ambient):
    assert permitted_current(part(), ambient + 273.15) == pytest.approx(I_N * sqrt((HOT - ambient) / (HOT - 25)))


@pytest.mark.parametrize("ambient", [25, 40, 80])
def test_without_a_nominal_current_copper_and_heat_balance(part, ambient):
    current = permitted_current(part(nominal_current=None, nominal_torque=None), ambient + 273.15)
    copper = R * (1 + COPPER * (HOT - 25)) * current**2
    assert (R_TH1 + R_TH2) * copper == pytest.approx(HOT - ambient)


def test_above_the_permitted_ambient_nothing_is_borne(part, shown):
    assert isnan(permitted_current(part(), 373.15))
    assert permitted_current(part(ambient_max=None), 373.15) == pytest.approx(I_N * sqrt(0.25))
    assert "not permitted" in shown(part())
    assert "not permitted" not in shown(part(ambient_max=None))


HEAVY = {"motor_time_constant": "1e9 s"}  # a housing that hardly warms


@pytest.mark.parametrize("times", [1.5, 2.0, 3.0, 5.0])
def test_a_single_body_follows_the_logarithm(part, times):
    """Housing as heavy as a house: w' tau = R_th1 I^2 R (1 + a w) - w, so that the rise lags with tau / (1 - feedback).

    With k the current over the one that the winding alone bears, t = tau / (1 - f) ln(k'^2 / (k'^2 - 1)) where
    k'^2 = steady rise / permitted rise; without the copper's feedback f that is tau ln(k^2 / (k^2 - 1)).
    """
    alone = sqrt((HOT - 25) / (R_TH1 * R * (1 + COPPER * (HOT - 25))))
    current = times * alone
    feedback = COPPER * R_TH1 * R * current**2
    square = R_TH1 * R * current**2 / (1 - feedback) / (HOT - 25)
    expected = TAU_W / (1 - feedback) * log(square / (square - 1))
    assert overload_times(part(**HEAVY), current)[0] == pytest.approx(expected, rel=1e-5)


def test_a_warm_motor_starts_from_its_housing(part):
    """Heavy housing at the temperature of the nominal point: a single body again, from another start."""
    rubs = K * I_0 * (0.65 + 0.35 * 8500 / 9500)  # a part of a brushed motor's no-load torque grows with speed
    loss, at_25 = rubs * 8500 * RPM, (R_TH1 + R_TH2) * R * I_N**2
    winding = (at_25 + R_TH2 * loss) / (1 - COPPER * at_25)
    copper = R * (1 + COPPER * winding) * I_N**2
    housing = R_TH2 * (copper + loss)
    assert winding == pytest.approx(housing + R_TH1 * copper)
    current = 3 * I_N
    feedback = COPPER * R_TH1 * R * current**2
    steady = (R_TH1 * R * current**2 + housing) / (1 - feedback)
    expected = TAU_W / (1 - feedback) * log((steady - housing) / (steady - (HOT - 25)))
    assert overload_times(part(**HEAVY), current)[1] == pytest.approx(expected, rel=1e-5)
    assert housing + (steady - housing) * (1 - exp(-expected * (1 - feedback) / TAU_W)) == pytest.approx(HOT - 25)


def test_what_is_borne_for_ever_has_no_end_and_more_is_shorter(part):
    hit = part()
    forever = permitted_current(part(nominal_current=None, nominal_torque=None), T_25)
    assert overload_times(hit, 0.999 * forever)[0] == float("inf")
    assert overload_times(hit, 1.001 * forever)[0] < float("inf")
    times = [overload_times(hit, n * I_N) for n in (1.5, 2.0, 3.0, 5.0)]
    assert times == sorted(times, reverse=True)
    assert all(warm < cold for cold, warm in times)


def test_the_tables_of_heat(part, shown):
    said = words(shown(part()))
    assert "25 °C 40 °C 60 °C 80 °C 100 °C" in said
    assert "nominal 1.2 A 1.11 A 0.967 A 0.805 A –" in said
    assert "Overload at standstill, 25 °C, to 125 °C" in said
    assert "current 1.8 A 2.4 A 3.6 A 6 A" in said
    assert said.count("from cold") == said.count("from warm") == 1
    assert "does not flow" not in said
    assert "more than 5 A does not flow at nominal voltage" in words(shown(part(resistance="4.8 ohm")))
    assert "more than 4 A exceeds the permitted peak torque" in words(shown(part(peak_torque="96 mN*m")))


# --- the page --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("width", [60, 80, 140])
@pytest.mark.parametrize("section", ["motors", "actuators"])
def test_the_page_fits_and_is_plain_on_a_pipe(part, shown, section, width):
    out = shown(part(section, **(REGION if section == "motors" else {})), width)
    widest = max(len(text.rstrip()) for text in out.splitlines())
    assert width - 2 <= widest <= width
    assert "\x1b" not in out


def test_a_part_without_torque_and_speed_has_its_figures(tmp_path, shown):
    hit = find(open_catalogs([str(write(tmp_path / "own.yaml", "encoders", counts_per_turn="500"))]), "P1")[0]
    said = words(shown(hit))
    assert "counts per turn 500" in said
    assert "heat" not in said
    assert "┤" not in said
