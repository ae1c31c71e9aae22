"""`drivesizer quote`: what is ordered, at which price of whom, by axis and for the machine, and what is missing."""

import csv
import json
from pathlib import Path

import openpyxl
import pytest
import yaml
from forty_motors import catalogue
from typer.testing import CliRunner

from drivesizer.cli import app

LIST = """part;price 1;price 5;currency;date;seller;order number;delivery
m00;80;70;EUR;2026-05-01;Shop A;A-100;2 weeks
only;55.5;;USD;2026-06-01;Shop B;;
elsewhere;1;;EUR;;;;
"""
MOTION = {"speed": "1 m/s", "acceleration_time": "0.3 s", "cruise_time": "0.5 s", "rest_time": "0.5 s"}


def spec_of(folder: Path, **select: object) -> dict:
    (folder / "shelf.yaml").write_text(catalogue(lambda n: 0.6 - 0.01 * n, "0.1 K/W", "mass: 100 g"))
    (folder / "prices.csv").write_text(LIST)
    chosen = {"catalogs": ["shelf.yaml", "prices.csv"], "estimates": "off"} | select
    return {"name": "portal", "supply": {"nominal": "24 V", "current": "60 A"}, "select": chosen}


def axis(mass: str, motors: int) -> dict:
    load = {"kind": "belt_axis", "mass": mass, "pulley_diameter": "40 mm", "motors": motors}
    return {"load": load, "motion": dict(MOTION)}


def quoted(folder: Path, spec: dict, *words: str):
    (folder / "spec.yaml").write_text(yaml.safe_dump(spec, sort_keys=False))
    made = [word for name in ("quote.csv", "quote.xlsx") for word in ("-o", str(folder / name))]
    ran = CliRunner().invoke(app, ["quote", str(folder / "spec.yaml"), *made, *words])
    if ran.exit_code:
        return ran, [], None
    rows = list(csv.DictReader((folder / "quote.csv").read_text().splitlines()))
    return ran, rows, openpyxl.load_workbook(folder / "quote.xlsx")


@pytest.fixture(scope="module")
def machine(tmp_path_factory: pytest.TempPathFactory):
    folder = tmp_path_factory.mktemp("machine")
    axes = {"x": axis("9 kg", 2), "y": axis("6 kg", 3)}
    return quoted(folder, spec_of(folder, rates={"USD": "0.8 EUR", "date": "2026-06-01"}) | {"axes": axes})


def test_a_line_for_each_part_of_each_axis_at_the_price_of_all_pieces(machine):
    """Five of m00: 70 EUR each; five controllers at 55.50 USD."""
    _, rows, _ = machine
    motors = [row for row in rows if row["role"] == "motor"]
    assert [(row["axis"], row["quantity"], row["price"], row["together"]) for row in motors] == [
        ("x", "2", "70.0", "140.0"), ("y", "3", "70.0", "210.0"),
    ]  # fmt: skip
    bought = motors[0]
    assert [bought[name] for name in ("order_number", "currency", "price_date", "seller", "delivery")] == [
        "A-100", "EUR", "2026-05-01", "Shop A", "2 weeks",
    ]  # fmt: skip
    assert "m00" in bought["description"] and bought["missing"] == ""


def test_totals_by_axis_and_for_the_machine_in_each_currency_and_by_rates(machine):
    _, rows, _ = machine
    totals = {(row["axis"], row["currency"], row["note"][:3]): float(row["together"]) for row in rows
              if row["role"] == "total"}  # fmt: skip
    assert totals == pytest.approx({
        ("x", "EUR", ""): 140.0, ("x", "USD", ""): 111.0, ("y", "EUR", ""): 210.0, ("y", "USD", ""): 166.5,
        ("machine", "EUR", ""): 350.0, ("machine", "USD", ""): 277.5, ("machine", "EUR", "all"): 350.0 + 0.8 * 277.5,
    })  # fmt: skip
    assert rows[-1]["note"] == "all of them, by the rates of the spec: 1 USD is 0.8 EUR"


def test_what_is_missing_is_said(machine):
    ran, rows, _ = machine
    assert [row["missing"] for row in rows if row["role"] == "encoder"] == ["no part is known"] * 2
    assert {row["missing"] for row in rows if row["role"] == "total" and row["axis"] == "x"} == {"no price of 1 of 3"}
    assert "no part is" in ran.output


def test_a_workbook_has_a_sheet_for_the_machine_for_each_axis_and_for_what_is_missing(machine):
    *_, book = machine
    assert book.sheetnames == ["Quote", "x", "y", "Missing"]
    heads, first, *_ = book["Quote"].iter_rows(values_only=True)
    line = dict(zip(heads, first, strict=True))
    assert (line["axis"], line["quantity"], line["price each"], line["order number"]) == ("x, y", 5, 70, "A-100")
    assert line["together"].startswith("=") and "*" in line["together"]
    assert [row[0].value for row in book["Missing"].iter_rows()] == ["axis", "x, y"]


def test_a_machine_of_one_axis_has_no_column_for_it(tmp_path):
    """Without a rate the two currencies stay two totals."""
    _, rows, book = quoted(tmp_path, spec_of(tmp_path) | axis("9 kg", 1))
    assert "axis" not in rows[0] and book.sheetnames == ["Quote", "Missing"]
    assert [(row["together"], row["currency"]) for row in rows if row["role"] == "total"] == [
        ("80.0", "EUR"), ("55.5", "USD"),
    ]  # fmt: skip


def test_nothing_is_ordered_where_no_drive_passes(tmp_path):
    ran, *_ = quoted(tmp_path, spec_of(tmp_path) | axis("9000 kg", 1))
    assert ran.exit_code == 1 and not (tmp_path / "quote.csv").exists()


def test_the_suffix_says_which_kind_of_file(tmp_path):
    (tmp_path / "spec.yaml").write_text(yaml.safe_dump(spec_of(tmp_path) | axis("9 kg", 1)))
    ran = CliRunner().invoke(app, ["quote", str(tmp_path / "spec.yaml"), "-o", "quote.pdf"])
    assert ran.exit_code and "expected .csv or .xlsx" in str(ran.exception)


# -- limits and objective in one currency


def test_a_limit_of_price_is_in_the_currency_that_it_is_given_in(tmp_path):
    """A motor of 80 EUR is 100 USD by the rate: 90 USD do not pass, 110 do; a limit in francs has no rate."""
    rates = {"USD": "0.8 EUR"}
    for limit, code in (("90 USD", 1), ("110 USD", 0), ("79 EUR", 1), ("81 EUR", 0), ("500 CHF", 0)):
        spec = spec_of(tmp_path, rates=rates, motor={"part": "m00"}) | axis("9 kg", 1) | {"needs": {"price": limit}}
        (tmp_path / "spec.yaml").write_text(yaml.safe_dump(spec))
        ran = CliRunner().invoke(app, ["size", str(tmp_path / "spec.yaml"), "--checks"])
        assert ran.exit_code == code, limit
        if code == 0 and "CHF" not in limit:
            assert limit in ran.output


def test_two_limits_in_two_currencies_are_refused(tmp_path):
    spec = spec_of(tmp_path) | axis("9 kg", 1) | {"needs": {"price": "90 USD"}, "budget": {"price": "100 EUR"}}
    (tmp_path / "spec.yaml").write_text(yaml.safe_dump(spec))
    ran = CliRunner().invoke(app, ["size", str(tmp_path / "spec.yaml")])
    assert "found USD and EUR; expected one currency" in str(ran.exception)


def test_drives_are_ranked_by_price_across_currencies(tmp_path):
    """m01 at 100 USD is dearer than m02 at 79 EUR where a dollar is 0.8 EUR, and cheaper where it is 0.7 EUR."""
    for rate, best in (("0.8 EUR", "m02"), ("0.7 EUR", "m01")):
        spec = spec_of(tmp_path, rates={"USD": rate}, objective="price", motor={"part": ["m01", "m02"]}) | axis(
            "5 kg", 1
        )
        (tmp_path / "prices.csv").write_text("part,price,currency\nm01,100,USD\nm02,79,EUR\nonly,50,EUR\n")
        (tmp_path / "spec.yaml").write_text(yaml.safe_dump(spec))
        made = tmp_path / f"{best}.csv"
        CliRunner().invoke(app, ["quote", str(tmp_path / "spec.yaml"), "-o", str(made)], catch_exceptions=False)
        assert best in made.read_text().splitlines()[1], rate


def test_a_machines_budget_is_in_its_own_currency(tmp_path):
    """Five motors at 70 EUR and five controllers at 55.50 USD are 715 USD where a dollar is 0.8 EUR."""
    for limit, status in (("700 USD", "fail"), ("730 USD", "pass"), ("730 CHF", "unknown")):
        only = spec_of(tmp_path, rates={"USD": "0.8 EUR"}, motor={"part": "m00"})
        spec = only | {"axes": {"x": axis("9 kg", 2), "y": axis("6 kg", 3)}}
        (tmp_path / "spec.yaml").write_text(yaml.safe_dump(spec | {"budget": {"price": limit}}))
        ran = CliRunner().invoke(app, ["size", str(tmp_path / "spec.yaml"), "--json"])
        (check,) = [one for one in json.loads(ran.output)["checks"] if one["name"] == "price"]
        assert (check["status"], check["unit"]) == (status, limit[-3:]), limit
        assert "CHF" in limit or check["demand"] == pytest.approx(5 * 70 / 0.8 + 5 * 55.5)
