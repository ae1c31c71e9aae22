"""`drivesizer catalog import` without a map: columns by the words of data sheets, shown and written as a map."""

import pytest
from typer.testing import CliRunner

from drivesizer.catalog import load
from drivesizer.catalog.importing import guessed
from drivesizer.cli import app

TABLE = """Order no.,Series,Rated voltage,Idle speed,Max. continuous torque,Rated current,Terminal resistance,Kt,\
Rotor moment of inertia,Weight,Colour
,,V,rpm,mNm,A,ohm,mNm/A,gcm2,g,
4711,M 20,24,9560,28.6,1.3,2.32,23.4,10.8,130,red
4712,M 20,48,9500,29.0,0.65,9.3,47,10.7,131,blue
"""
SAID = ["--section", "motors", "--manufacturer", "Anymaker", "--document", "sheet", "--confidence", "quoted"]


@pytest.fixture
def run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "parts.csv").write_text(TABLE, encoding="utf-8")
    return lambda *more: CliRunner().invoke(app, ["catalog", "import", "parts.csv", *SAID, *more])


def test_headers_of_data_sheets_are_understood():
    header, units = (line.split(",") for line in TABLE.splitlines()[:2])
    assert guessed(header, units, "motors") == {
        "Order no.": "part", "Series": "family", "Rated voltage": "nominal_voltage", "Idle speed": "no_load_speed",
        "Max. continuous torque": "nominal_torque", "Rated current": "nominal_current",
        "Terminal resistance": "resistance", "Kt": "torque_constant", "Rotor moment of inertia": "rotor_inertia",
        "Weight": "mass",
    }  # fmt: skip


def test_a_unit_of_another_kind_is_no_guess():
    """A weight in newton is a force; a torque in joules is energy."""
    assert guessed(["Weight", "Rated torque"], ["N", "J"], "motors") == {}
    assert guessed(["mass"], ["g"], "motors") == {}  # a column's own name is no guess


def test_the_guess_is_shown_and_written_and_can_be_used_again(run, tmp_path):
    found = run("-o", "own.yaml")
    assert found.exit_code == 0 and "guessed" in found.output and "Rated voltage → nominal_voltage" in found.output
    motor = load(["own.yaml"], beside=tmp_path).motors.record(0)
    assert (motor.part, motor.nominal_voltage, motor.mass) == ("4711", 24.0, pytest.approx(0.13))
    text = (tmp_path / "own.map.yaml").read_text(encoding="utf-8")
    assert '"Colour": ~' in text and '"Kt": torque_constant' in text
    again = CliRunner().invoke(
        app, ["catalog", "import", "parts.csv", "--section", "motors", "--map", "own.map.yaml", "-o", "again.yaml"]
    )
    assert again.exit_code == 0 and "guessed" not in again.output
    assert (tmp_path / "again.yaml").read_bytes() == (tmp_path / "own.yaml").read_bytes()


@pytest.mark.parametrize(
    ("unit", "kept"),
    [("$", ("foreign_price", 24.95, "USD")), ("GBP", ("foreign_price", 24.95, "GBP")),
     ("CHF", ("list_price", 24.95, "")), ("€", ("price", 24.95, ""))],
)  # fmt: skip
def test_a_price_keeps_its_currency(unit, kept, run, tmp_path):
    table = f"Order no.,Rated voltage,Unit price\n,V,{unit}\nM-1,12,24.95\n"
    (tmp_path / "parts.csv").write_text(table, encoding="utf-8")
    assert run("--family", "M 20", "-o", "own.yaml").exit_code == 0
    motor = load(["own.yaml"], beside=tmp_path).motors.record(0)
    column, amount, currency = kept
    assert (getattr(motor, column), motor.currency) == (amount, currency)
    with_map = ["catalog", "import", "parts.csv", "--section", "motors", "--map", "own.map.yaml", "-o", "again.yaml"]
    assert CliRunner().invoke(app, with_map).exit_code == 0
    assert repr(load(["again.yaml"], beside=tmp_path).motors.record(0)) == repr(motor)
