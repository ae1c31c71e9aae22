"""The strict reader, held against pint's own definitions and against what vendors print."""

import json
import math
from importlib import resources

import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st
from refusals import refusal
from rows import hold

from drivesizer import units
from drivesizer.errors import InputError
from drivesizer.units import KINDS, from_si, label, outside, scale, show, to_si

PINT = pint.UnitRegistry()  # pint's full definitions: the authority for our short ones
NOT_IN_PINT = {"krpm", "V/krpm", "PS", "%", "1"} | KINDS["price"].units.keys()


def test_every_unit_agrees_with_pint():
    units = [(kind, unit) for kind in KINDS for unit in KINDS[kind].units if unit not in NOT_IN_PINT]
    hold(agrees_with_pint, {f"{kind} {unit}": (kind, unit) for kind, unit in units})


def agrees_with_pint(kind, unit):
    theirs = unit.replace("g_0", "standard_gravity").replace("ozf", "ounce_force").replace("lbf", "pound_force")
    theirs = theirs.replace("kgf", "kilogram_force").replace("in", "inch") if unit.startswith("kgf") else theirs
    theirs = theirs.replace("gf*", "gram*standard_gravity*") if unit.startswith("gf") else theirs
    theirs = "gram*standard_gravity" if unit == "gf" else theirs
    expected = PINT.Quantity(3.7, theirs).to(KINDS[kind].si).magnitude
    assert to_si(f"3.7 {unit}", kind) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "kind", "si"),
    [
        ("10 Nm", "torque", 10.0),
        ("10 N-m", "torque", 10.0),
        ("10 N·m", "torque", 10.0),
        ("10N m", "torque", 10.0),
        ("16 oz-in", "torque", 16 * 28.349523125e-3 * 9.80665 * 25.4e-3),
        ("16 ozin", "torque", 16 * 28.349523125e-3 * 9.80665 * 25.4e-3),
        ("5 kgcm", "torque", 5 * 9.80665 * 0.01),
        ("5 kg-cm", "torque", 5 * 9.80665 * 0.01),
        ("142 gcm2", "inertia", 142e-7),
        ("142 g·cm²", "inertia", 142e-7),
        ("142 g*cm**2", "inertia", 142e-7),
        ("25 °C", "temperature", 298.15),
        ("77 °F", "temperature", 298.15),
        ("60 rpm", "rotary_speed", 2 * math.pi),
        ("60 min^-1", "rotary_speed", 2 * math.pi),
        ("60 1/min", "rotary_speed", 2 * math.pi),
        ("40.5 rpm/mNm", "speed_torque_gradient", 40.5 * math.pi / 30 * 1000),
        ("408 rpm/V", "speed_constant", 408 * math.pi / 30),
        ("23.4 mNm/A", "torque_constant", 0.0234),
        ("2.45 mV/rpm", "torque_constant", 2.45e-3 * 30 / math.pi),
        ("5.5 km/h", "speed", 5.5 / 3.6),
        ("300 in/min", "speed", 0.127),
        ("300 ipm", "speed", 0.127),
        ("50 ft/min", "speed", 0.254),
        ("3 N·mm", "torque", 0.003),
        ("1 kgf·cm·s²", "inertia", 0.0980665),
        ("1 kg·cm·s²", "inertia", 0.0980665),  # of force, as Japanese makers print it
        ("1 slug*ft^2", "inertia", 1.3558179483314004),
        ("2 lb-in²", "inertia", 2 * 0.45359237 * 0.0254**2),
        ("16 oz·in²", "inertia", 0.45359237 * 0.0254**2),
        ("5 mil", "length", 1.27e-4),
        ("6 in", "length", 0.1524),
        ('6 "', "length", 0.1524),
        ("0.5 µm", "length", 5e-7),
        ("2.32 Ω", "resistance", 2.32),
        ("7 Ah", "charge", 25200.0),
        ("3 arcmin", "angle", math.pi / 3600),
        ("2 %", "dimensionless", 0.02),
        (0.02, "dimensionless", 0.02),
        ("5:1", "dimensionless", 5.0),
        ("3.7:1", "dimensionless", 3.7),
        ("1 g_0", "acceleration", 9.80665),
    ],
)
def test_vendor_spellings(text, kind, si):
    assert to_si(text, kind) == pytest.approx(si, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "kind", "words"),
    [
        ("3,5 mm", "length", "comma"),
        ("1,000 rpm", "rotary_speed", "comma"),
        ("10 000 rpm", "rotary_speed", "write it without: 10000 rpm"),
        ("1’000_000 g", "mass", "write it without: 1000000 g"),
        ("1e400 V", "voltage", "range"),
        ("1e-400 m", "length", "range"),
        ("1e308 km", "length", "range"),
        ("nan V", "voltage", "number"),
        ("inf V", "voltage", "number"),
        ("", "voltage", "number"),
        ("V", "voltage", "number"),
        ("24", "voltage", "no unit"),
        (24, "voltage", "no unit"),
        (True, "voltage", "not a quantity"),
        (None, "voltage", "is empty"),
        (["24 V"], "voltage", "not a quantity"),
        (True, "dimensionless", "not a quantity"),
        ("3 J", "torque", "unit of energy"),
        ("3 N*m", "energy", "unit of torque"),
        ("60 rpm", "frequency", "unit of rotary speed"),
        ("60 Hz", "rotary_speed", "unit of frequency"),
        ("25 degC", "temperature_difference", "unit of temperature"),
        ("5 V", "current", "unit of voltage"),
        ("5 m s", "time", "not a unit"),
        ("1_0 mm", "length", "write it without: 10 mm"),
        ("0x10 mm", "length", "not a unit"),
        ("١٢ mm", "length", "number"),
        ("5 nm", "torque", "not a unit"),
        ("5 NM", "torque", "not a unit"),
        ("-300 degC", "temperature", "absolute zero"),
        ("5 __import__('os')", "length", "not a unit"),
        ("5 mm; 6 mm", "length", "not a unit"),
        ("1 kgf*m^2", "inertia", "not a unit"),  # GD^2, four times the inertia and g apart
        ("5 dollars", "price", "not a unit"),
    ],
)
def test_refused_in_one_line_with_an_example(text, kind, words):
    message = refusal(lambda: to_si(text, kind), match="expected")
    assert words in message
    assert len(message) < 250


@given(st.text(max_size=40), st.sampled_from(sorted(KINDS)))
def test_any_text_gives_a_finite_number_or_an_input_error(text, kind):
    try:
        assert math.isfinite(to_si(text, kind))
    except InputError as error:
        assert "\n" not in str(error)


@given(st.floats(-1e9, 1e9), st.sampled_from([(k, u) for k in KINDS for u in KINDS[k].units if k != "temperature"]))
def test_round_trip(value, kind_unit):
    kind, unit = kind_unit
    text = f"{value!r} {unit if unit != '1' else ''}"
    if outside(value * scale(unit, kind)[0], kind):
        with pytest.raises(InputError, match="of a machine; expected"):
            to_si(text, kind)
        return
    assert from_si(to_si(text, kind), unit, kind) == pytest.approx(value, rel=1e-14, abs=1e-300)


@pytest.mark.parametrize(
    ("figure", "kind"),  # among the smallest and the largest that are built, out of makers' and museums' own pages
    [
        ("0.0004 g*cm^2", "inertia"),  # rotor of a motor of 6 mm
        ("0.25 mN*m", "torque"),  # and what it gives
        ("14200 t", "mass"),  # Bagger 293, bucket-wheel excavator
        ("7600000 N*m", "torque"),  # shaft of a ship's diesel, 80 MW at 102 rpm
        ("80080 kW", "power"),
        ("1200000 rpm", "rotary_speed"),  # a spindle of the ETH Zurich
        ("1.16e-5 turn/s", "rotary_speed"),  # a telescope that follows the stars
        ("0.6 mohm", "resistance"),
        ("1e9", "dimensionless"),  # counts of a 30-bit encoder
    ],
)
def test_what_is_built_is_not_refused(figure, kind):
    assert to_si(figure, kind) > 0.0


@given(st.floats(-200, 2000), st.sampled_from(["K", "degC", "degF"]))
def test_temperatures_round_trip_and_scale_alike(value, unit):
    if (value + 459.67) * 5 / 9 < 1 or (unit != "degF" and value + 273.15 * (unit == "degC") < 1):
        return
    kelvin = to_si(f"{value!r} {unit}", "temperature")
    factor, offset = scale(unit, "temperature")
    assert value * factor + offset == pytest.approx(kelvin, rel=1e-13)
    assert from_si(kelvin, unit, "temperature") == pytest.approx(value, rel=1e-12, abs=1e-9)


def test_output_in_the_units_of_the_trade():
    assert show(0.0263, "mN*m", "torque") == "26.3 mN·m"
    assert show(298.15, "degC", "temperature") == "25 °C"
    assert show(-0.0, "rpm", "rotary_speed") == "0 rpm"
    assert show(math.nan, "rpm", "rotary_speed") == "unknown"
    assert show(math.inf, "degC", "temperature") == "unbounded"
    assert label("rpm/(mN*m)") == "rpm/(mN·m)"
    assert label("uN*m") == "µN·m"
    assert label("ohm") == "Ω"


def test_the_example_of_every_kind_is_read():
    for name, kind in KINDS.items():
        for example in kind.example.split(" or "):
            assert math.isfinite(to_si(example, name))


def test_the_kept_table_is_what_pint_gives():
    """units.json is made by `python -m drivesizer.units`; a unit that was added or changed shows here."""
    kept = resources.files(units).joinpath("units.json").read_text(encoding="utf-8")
    assert json.loads(kept) == units.tabulate()
