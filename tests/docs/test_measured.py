"""Drives that other people measured, against the drive model; and the page about them.

The figures here are a few of the records. Servos: Rhoban/bam at a6f2671b7f08524f6bb308ce3d2016a30faac61e,
atomic/data/velocity_mx64.json and velocity_mx106.json, atomic/stall.py, atomic/R_identification.py. RI50: karthikurs/
actuator-dynamometer at 1ab6e56f6f9dbedd90398ccdfc05a4728ed38e03, futek_data/futek_test_24_05_2021_16-20-14.csv and
futek_test_27_04_2021_17-39-20.csv: means over the second half of each step.
"""

import re
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from drivesizer.machine.part_curves import overload_times
from drivesizer.physics.thermal import TwoBodies

DOCS = Path(__file__).resolve().parents[2] / "docs"
sys.path.insert(0, str(DOCS))

import measured_data as data  # noqa: E402
import measured_models as models  # noqa: E402

PAGE = (DOCS / "measured.md").read_text(encoding="utf-8")
FREE = {"MX-64": {3.0: 1.70456, 12.0: 7.00109, 15.0: 8.77406}, "MX-106": {3.0: 1.10631, 12.0: 4.98268, 15.0: 6.28441}}
STALLED = np.array([  # amplitude A, winding degC, W of both drives, W of the other one
    (4.017, 54.15, 44.17, 19.93), (6.004, 64.69, 93.27, 41.05), (8.002, 75.01, 171.57, 76.55),
])  # fmt: skip
STANDBY = 3.930, 1.954  # W, likewise
IDLE = np.array([(15.725, 0.461), (47.119, 0.839), (78.442, 1.067), (125.680, 1.232)])  # rad/s, amplitude A


def rows():
    lines = re.findall(r"^\| (.+) \|$", PAGE, re.MULTILINE)
    return [line.split(" | ") for line in lines[2:]]


def servo(name="MX-106 12 V"):
    return models.part("robotis", name)


def ri50():
    return models.part("cubemars", "RI50 KV100")


# --- servos ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", FREE)
def test_the_free_speed_of_the_sheet_is_within_7_percent(name):
    V, w = (np.array(list(x)) for x in (FREE[name], FREE[name].values()))
    error = models.sheet_free_speed(servo(f"{name} 12 V"), V) / w - 1
    assert (np.abs(error) < 0.07).all()
    assert (error[1:] < -0.05).all()  # the units are faster than printed
    assert error[0] > error[1]  # friction takes its share of a low voltage


def test_a_line_with_an_offset_follows_the_free_speed():
    V, w = (np.array(list(x)) for x in (FREE["MX-106"], FREE["MX-106"].values()))
    slope, offset = models.with_offset(V, w)
    assert slope * (V - offset) == pytest.approx(w, rel=0.01)
    assert offset == pytest.approx(0.43, abs=0.05)  # V


def test_the_lifted_torque_needs_the_gears_efficiency():
    V, I, M = data.lifted()
    amperes, torque = models.sheet_lift(servo(), V)
    assert amperes == pytest.approx(I, rel=0.07)
    assert torque == pytest.approx(M, rel=0.085)
    assert (torque / servo()["efficiency"] / M > 1.55).all()


def test_the_gears_efficiency_is_that_of_stall_over_free_speed():
    _, I, M = data.lifted()
    free = FREE["MX-106"]
    k_e = (15.0 - 3.0) / (free[15.0] - free[3.0])  # V*s/rad at the horn
    assert servo()["efficiency"] == pytest.approx((M / I).mean() / k_e, rel=0.03)


def test_the_resistance_is_within_what_two_measurements_differ():
    V, I, _ = data.lifted()
    measured = [np.polyfit(data.LOCKED[:, 0], data.LOCKED[:, 1], 1)[0], np.polyfit(I, V, 1)[0]]
    assert min(measured) * 0.99 < servo()["resistance"] < max(measured) * 1.01
    assert max(measured) / min(measured) > 1.09


# --- brushless motor -------------------------------------------------------------------------------------------------


def test_each_drive_that_is_on_takes_its_standby_at_the_first_supply():
    both, one = STANDBY
    on, off = 2.322, 0.382  # W, futek_test_17_05_2021_17-17-56.csv at rest: the other drive is off
    assert both - one == pytest.approx(on - off, rel=0.03)
    assert both == pytest.approx(2 * one, rel=0.03)


def test_the_power_at_stall_is_that_of_the_hot_resistance():
    I, T, both, other = STALLED.T
    measured = both - other - (STANDBY[0] - STANDBY[1])
    I, R = models.DC * I, ri50()["resistance"]
    hot = models.hot(R, T + data.CELSIUS) * I**2
    assert (np.abs(hot / measured - 1) < 0.15).all()
    assert R * I[-1] ** 2 / measured[-1] < 0.75  # cold
    R_own, by_current = models.driver_loss(I, measured, models.hot(1.0, T + data.CELSIUS))
    own = models.hot(R_own, T + data.CELSIUS) * I**2 + by_current * I
    assert (np.abs(own / measured - 1) < 0.02).all()
    assert R < R_own < 1.2 * R  # cables and transistors come on top


def test_of_one_no_load_current_part_is_dry_and_part_grows_with_the_speed():
    """Neither all of it at any speed nor all of it by the speed; the dry share that is taken misses by less."""
    w, I = IDLE.T
    I = models.DC * I
    flat, parted = (models.idle_current(w, 0.1, I[-1], w[-1], kind) for kind in ("brushed", "brushless"))
    proportional = I[-1] * w / w[-1]
    assert (flat[:-1] > 1.1 * I[:-1]).all()
    assert (proportional[:-1] < 0.8 * I[:-1]).all()
    missed = [np.sqrt(np.mean((one / I - 1.0) ** 2)) for one in (parted, flat, proportional)]
    assert missed[0] < 0.5 * missed[1] and missed[0] < 0.85 * missed[2]
    rest, rise, speed = models.saturating(w, I)
    assert rest + rise * (1 - np.exp(-w / speed)) == pytest.approx(I, rel=0.02)


def test_without_thermal_figures_nothing_is_said_about_heat():
    for part in (ri50(), servo()):
        assert np.isnan(overload_times(part, 5.0)).all()


# --- the refinements -------------------------------------------------------------------------------------------------


def test_the_chain_of_bodies_with_two_is_the_programs():
    I2 = np.repeat([0.0, 4.0, 49.0, 0.2, 20.0], 40)
    model = models.Thermal(np.array([11.8, 464.0]), np.array([1.61]), 0.0, ())
    motor = TwoBodies(
        R_25=1.42, R_th1=1.61, R_th2=models.NO_COOLING, tau_w=11.8 * 1.61, tau_h=464.0 * models.NO_COOLING
    )
    ours = models.chain(model, 1.42, 295.0, 0.05, I2, np.array([330.0, 300.0]))
    assert ours == pytest.approx(models.two_body_course(motor, 295.0, 0.05, I2, (330.0, 300.0)), abs=0.03)


def test_the_chain_keeps_its_heat():
    model = models.Thermal(np.array([9.2, 39.0, 300.0]), np.array([1.4, 6.0]), 0.0, ())
    found = models.chain(model, 1.42, 300.0, 0.25, np.zeros(400), np.array([350.0, 300.0, 300.0]))
    heat = (found - 300.0) @ model.C
    assert heat[-1] == pytest.approx(50.0 * 9.2, rel=0.001)
    assert heat[-1] < 50.0 * 9.2  # a little leaves the housing


def test_a_fit_finds_the_bodies_that_made_a_record():
    true = models.Thermal(np.array([9.0, 300.0]), np.array([1.7]), 2.0, (0.7,))
    I2, hold = np.repeat([0.0, 30.0, 0.0, 30.0, 0.0], 60), np.repeat([0, 0, 0, 1, 1], 60)
    share = np.array([1.0, 0.7])[hold]
    shown = models.followed(true, 1.42, 295.0, 0.25, I2 * share, np.full(2, 295.0))
    first = models.Thermal(np.array([12.0, 400.0]), np.array([1.2]), 1.0, (1.0,))
    found = models.fit_thermal(first, 1.42, 0.25, I2, hold, *shown)
    for name, value in true._asdict().items():
        assert getattr(found, name) == pytest.approx(value, rel=0.01), name


def test_the_sensor_lags_by_its_time_constant():
    model = models.Thermal(np.ones(2), np.ones(1), 2.0, ())
    shown = models.sensed(model, np.full(8, 301.0), 0.25, 300.0)
    assert shown[-1] == pytest.approx(301.0 - np.exp(-1.0))


# --- the page --------------------------------------------------------------------------------------------------------


def test_the_page_says_what_the_program_says_today():
    said = {row[0]: row[1] for row in rows()}
    for name in ("MX-64", "MX-106"):
        for voltage in ("12", "14.8"):
            rpm = servo(f"{name} {voltage} V")["no_load_speed"] * 30 / np.pi
            assert said[f"{name}, free speed at {voltage} V"] == f"{rpm:.1f} rpm"
    assert said["MX-106, resistance, rotor locked"] == f"{servo()['resistance']:.2f} Ω"
    assert said["MX-106, gear efficiency"] == f"{100 * servo()['efficiency']:.1f} %"
    assert said["RI50, torque per ampere (stall, slope)"] == f"{1e3 * ri50()['torque_constant']:.1f} mN·m/A"
    I, T, *_ = STALLED[-1]
    power = float(said["RI50, power at stall, 8 A, winding at 75 °C"].removesuffix(" W"))
    assert power == pytest.approx(
        float(models.hot(ri50()["resistance"], T + data.CELSIUS)) * (models.DC * I) ** 2, abs=0.1
    )


def test_what_leaves_the_band_of_the_classes_is_told_as_missed():
    """By hand: R +- 10 % is 1/1.1 - 1 to 1/0.9 - 1 of error, friction -30 to +60 % is 1/1.6 - 1 to 1/0.7 - 1."""
    bands = {"RI50, power at stall": (-0.091, 0.111), "RI50, the same, flat": (-0.375, 0.429),
             "RI50, torque per ampere": (-0.091, 0.111), "MX-64, free speed": (-0.1, 0.1)}  # fmt: skip
    missed = {row[0] for row in rows() if "missed" in row[4]}
    for start, band in bands.items():
        for row in (row for row in rows() if row[0].startswith(start)):
            ends = [float(x) / 100 for x in re.findall(r"([+-]?[\d.]+) %", row[4].replace("−", "-"))]
            assert ends == pytest.approx(band, abs=6e-4), row[0]
            errors = [float(x) / 100 for x in re.findall(r"([+-]?[\d.]+) %", row[3].replace("−", "-"))]
            assert (row[0] in missed) == any(not band[0] < x < band[1] for x in errors), row[0]
    assert sum(name.startswith("RI50, power at stall") for name in missed) == 4
    listed = PAGE.split("## What is missed")[1].split("## What to remember")[0]
    assert {line[2:].split(": ")[0] for line in listed.splitlines() if line.startswith("- ")} == missed


def test_every_prediction_says_whose_it_is():
    """The program's function, the catalogue's figure, or the page's own formula."""
    whose = {row[0]: row[5] for row in rows()}
    assert all(text.startswith(("the program", "the catalogue", "this page: ")) for text in whose.values())
    own = [name for name, text in whose.items() if text.startswith("this page")]
    assert len(own) >= 10 and "RI50, power at stall, 8 A, winding at 75 °C" in own
    assert "what the program says" not in PAGE.split("| quantity")[0]


def test_errors_on_the_page_are_predicted_over_measured():
    checked = 0
    for _, predicted, measured, error, *_ in rows():
        figures = [re.fullmatch(r"([\d.]+) (\S+)", text) for text in (predicted, measured)]
        if all(figures) and figures[0][2] == figures[1][2]:
            half = [0.5 * 10.0 ** -len(f[1].partition(".")[2]) / float(f[1]) for f in figures]
            ratio = float(figures[0][1]) / float(figures[1][1]) - 1
            shown = float(error.removesuffix(" %").replace("−", "-")) / 100
            assert ratio == pytest.approx(shown, abs=sum(half) * 1.1 + 0.0006), predicted
            checked += 1
    assert checked == 16


def test_every_row_is_whole_and_every_figure_is_there():
    assert {len(row) for row in rows()} == {8}
    named = set(re.findall(r"\]\(figures/([\w-]+)\.svg\)", PAGE))
    assert named == {path.stem for path in (DOCS / "figures").glob("*.svg")}
    assert len(named) == 5
    for name in named:
        path = DOCS / "figures" / f"{name}.svg"
        assert ElementTree.parse(path).getroot().tag.endswith("svg")
        assert path.stat().st_size < 100_000


def test_the_page_is_its_text_with_figures_filled_in():
    text = (DOCS / "measured.txt").read_text(encoding="utf-8")
    pieces = [re.escape(piece) for piece in re.split(r"\{\w+\}", text)]
    assert re.fullmatch(r"(?s:.+?)".join(pieces), PAGE)


def test_a_folder_without_the_records_is_one_line(tmp_path):
    with pytest.raises(SystemExit, match=r"no file velocity_mx64\.json in it"):
        data.free_speed(tmp_path, "mx64")
