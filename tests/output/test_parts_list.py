"""The parts list: what is ordered, how many, at which price of which date; and nothing that no catalogue says."""

import csv
import io
from dataclasses import replace
from math import isnan, nan

import openpyxl
import pytest

from drivesizer.catalog import Catalog, load
from drivesizer.catalog.parts import NO_GEARHEAD, BeltDrive
from drivesizer.output.document.content import Content
from drivesizer.output.document.summary import parts_table
from drivesizer.output.parts import parts_list, totals
from drivesizer.output.report import csv as csv_tables
from drivesizer.output.report import write
from drivesizer.results.sizing import SizingResult
from drivesizer.sizing import size
from drivesizer.spec.robot import RobotSpec

PAGES = (
    "maxon online shop, product pages of the order numbers (saved pages: github.com/ekrimsk/maxon_data, commit a7418d3)"
)


@pytest.fixture(scope="module")
def result(spec: RobotSpec) -> SizingResult:
    return size(spec, top=1)


def part(catalog: Catalog, section: str, number: str):
    table = catalog.table(section)
    return table.record(table.rows[number])


def with_motor(result, catalog, number):
    return replace(result.sets[0], motor=part(catalog, "motors", number))


def test_a_line_for_each_part_with_the_number_of_the_catalogue(result):
    lines = parts_list(result.sets[0], result.catalog, 4)
    assert [(x.role, x.order_number, x.quantity) for x in lines] == [
        ("motor", "118752", 4), ("gearhead", "406764", 4), ("belt", "", 4), ("encoder", "225778", 4),
        ("controller", "541718", 4),
    ]  # fmt: skip
    gearhead = lines[1]
    # the line of 406764 in catalogs/maxon.yaml: 127.73 EUR, 77 g
    assert (gearhead.price, gearhead.currency, gearhead.pieces, gearhead.mass) == (127.73, "EUR", 1, 0.077)
    assert (gearhead.price_date, gearhead.price_confidence) == ("2019-09 to 2020-07", "quoted")
    assert gearhead.price_source == PAGES and gearhead.maker == "maxon"


def test_what_no_catalogue_knows_is_left_open(result):
    lines = {x.role: x for x in parts_list(result.sets[0], result.catalog, 4)}
    motor, belt = lines["motor"], lines["belt"]
    assert isnan(motor.price) and (motor.currency, motor.pieces, motor.price_date, motor.price_source) == (
        "",
        None,
        "",
        "",
    )
    assert belt.order_number == belt.part == belt.maker == "" and isnan(belt.mass) and belt.said.startswith("1.1 : 1")
    unknown = replace(result.sets[0], encoder=None)
    line = {x.role: x for x in parts_list(unknown, result.catalog, 4)}["encoder"]
    assert (line.order_number, line.part, line.quantity) == ("", "", 4) and isnan(line.price)
    said = " ".join(x.note + x.said for x in lines.values())
    assert "cable" not in said  # nothing is known of one


@pytest.mark.parametrize(
    ("quantity", "price", "pieces"),
    [(1, 46.55, 1), (4, 46.55, 1), (5, 42.45, 5), (19, 42.45, 5), (20, 38.91, 20), (200, 38.91, 20)],
)
def test_the_price_is_that_of_so_many_pieces(quantity, price, pieces, result, catalog):
    """265376 in the shop of 2020: 46.55 EUR for 1-4, 42.45 for 5-19, 38.91 for 20-49 pieces."""
    line = parts_list(with_motor(result, catalog, "265376"), catalog, quantity)[0]
    assert (line.price, line.currency, line.pieces, line.quantity) == (price, "EUR", pieces, quantity)


def test_a_price_in_francs_stays_one(result, catalog):
    """112862, a GP 16 K, has a list price of 44.80 CHF and none in euros: the two are never added."""
    found = replace(with_motor(result, catalog, "265376"), gearhead=part(catalog, "gearheads", "112862"))
    lines = parts_list(found, catalog, 2)
    assert (lines[1].price, lines[1].currency) == (44.8, "CHF")
    euros, francs = (t for t in totals(lines) if t.name == "price")
    assert (euros.value, euros.unit, euros.over) == (2 * 46.55, "EUR", ("motor",))
    assert (francs.value, francs.unit, francs.over) == (2 * 44.8, "CHF", ("gearhead",))
    assert set(euros.lacks) == {"gearhead", "belt", "encoder", "controller"}


def test_a_name_that_the_catalogue_made_up_is_no_order_number(result, catalog):
    encoder = part(catalog, "encoders", "ENX 16 EASY 1024")
    line = parts_list(replace(result.sets[0], encoder=encoder), catalog, 1)[3]
    assert (line.part, line.order_number) == ("ENX 16 EASY 1024", "")
    assert line.note.startswith("part: no order number known; the part name is made up here")


def test_no_made_up_name_of_any_catalogue_passes_for_an_order_number(catalog):
    """Held against the notes of the file itself: each that denies an order number has the words that are looked for."""
    from drivesizer.output.parts import NO_NUMBER

    denied = [n for n in catalog.notes if "part" in n.fields and "made up" in n.text]
    assert denied and all(NO_NUMBER in note.text for note in denied)


def test_a_cable_is_told_where_the_catalogue_knows_of_one(result, catalog):
    """HEDL 5540, 110512: its mass includes the cable (catalogs/maxon.yaml, note on the mass)."""
    encoder = part(catalog, "encoders", "110512")
    line = parts_list(replace(result.sets[0], encoder=encoder), catalog, 1)[3]
    assert "the mass includes the cable" in line.note and line.note.startswith("mass: ")


def test_mass_and_price_of_all_are_those_of_the_lines(result):
    lines = parts_list(result.sets[0], result.catalog, 4)
    mass, price = totals(lines)
    assert (mass.unit, mass.value) == ("kg", pytest.approx(4 * (0.130 + 0.077)))  # RE 25 130 g, GP 26 A 77 g
    assert (price.unit, price.value) == ("EUR", pytest.approx(4 * 127.73))
    assert set(mass.over) | set(mass.lacks) == {line.role for line in lines}
    assert totals([]) == []


def test_an_actuator_is_one_line_and_belts_are_three(result, tmp_path):
    shelf = load(["robstride", "vbelt", "wcp"])
    actuator = shelf.actuators.record(0)
    pulley, belt = shelf.pulleys.record(0), shelf.belts.record(0)
    drive = BeltDrive(driving=pulley, driven=pulley, belt=belt, centre_distance=0.1, teeth_in_mesh=8.0)
    best = replace(result.sets[0], actuator=actuator, belt_drive=drive, encoder=None, controller=None)
    lines = parts_list(best, shelf, 3)
    assert [x.role for x in lines] == ["actuator", "driving pulley", "belt", "driven pulley", "encoder", "controller"]
    assert [x.part for x in lines[:4]] == [actuator.part, pulley.part, belt.part, pulley.part]
    assert {x.quantity for x in lines} == {3}


def test_the_list_as_a_file_of_its_own(result, tmp_path):
    written = write(result, None, [tmp_path / "report.csv"])
    assert [path.name for path in written] == ["report.csv", "report-parts.csv"]
    rows = list(csv.DictReader(io.StringIO(written[1].read_text(encoding="utf-8"))))
    lines = parts_list(result.sets[0], result.catalog, result.spec.load.motors)
    assert [(r["role"], r["order_number"], int(r["quantity"])) for r in rows[:-1]] == [
        (x.role, x.order_number, x.quantity) for x in lines
    ]
    for row, line in zip(rows, lines, strict=False):
        for cell, figure in ((row["price"], line.price), (row["mass_kg"], line.mass)):
            assert cell == "" if isnan(figure) else float(cell) == figure
        assert row["price_date"] == line.price_date and bool(row["currency"]) == (not isnan(line.price))


def test_the_list_as_a_section_of_the_table(result):
    rows = list(csv.DictReader(io.StringIO(csv_tables.report_csv(Content(result)).decode())))
    found = {r["name"]: r for r in rows if r["section"] == "part"}
    assert found["gearhead_quantity"]["value"] == "4"
    assert (found["gearhead_price"]["value"], found["gearhead_price"]["unit"]) == ("127.73", "EUR")
    assert (found["motor_price"]["value"], found["motor_price"]["status"]) == ("", "unknown")
    assert float(found["total_masses"]["si_value"]) == pytest.approx(0.828)


def test_the_list_has_its_sums_in_file_and_workbook(result, tmp_path):
    """208 g four times; 4 x 127.73 EUR: as numbers in the file, as formulas of the cells above in the workbook."""
    written = write(result, None, [tmp_path / "report.csv", tmp_path / "report.xlsx"])
    *_, total = csv.DictReader(io.StringIO(written[1].read_text(encoding="utf-8")))
    assert total["role"] == "total" and float(total["prices"]) == pytest.approx(510.92)
    assert float(total["masses_kg"]) == pytest.approx(0.828)
    rows = [[cell.value for cell in row] for row in openpyxl.load_workbook(written[-1])["Summary"].iter_rows()]
    at = next(n for n, row in enumerate(rows) if "order number" in row)
    heads, lines = rows[at], rows[at + 1 : at + 7]
    mass, quantity, each = (heads.index(head) for head in ("mass (g)", "quantity", "mass of one (g)"))
    letters = [openpyxl.utils.get_column_letter(n + 1) for n in (quantity, each, mass)]
    assert lines[0][mass] == f"={letters[0]}{at + 2}*{letters[1]}{at + 2}"
    assert lines[5][mass] == f"=SUM({letters[2]}{at + 2}:{letters[2]}{at + 6})"


def test_a_set_that_falls_is_not_bought(result, tmp_path):
    fallen = replace(result, sets=(), misses=result.sets)
    assert [path.name for path in write(fallen, None, [tmp_path / "report.csv"])] == ["report.csv"]
    assert not [
        r
        for r in csv.DictReader(io.StringIO(csv_tables.report_csv(Content(fallen)).decode()))
        if r["section"] == "part"
    ]


def test_a_part_without_any_figure_has_a_line(result, catalog):
    bare = replace(result.sets[0].motor, mass=nan, price=nan, price_5=nan, price_20=nan, list_price=nan)
    line = parts_list(replace(result.sets[0], motor=bare), catalog, 7)[0]
    assert line.quantity == 7 and isnan(line.mass)


def test_a_total_that_no_part_has_is_unknown(result, catalog):
    lines = [replace(line, mass=nan, price=nan, currency="") for line in parts_list(result.sets[0], catalog, 1)]
    total = parts_table(lines, "the one drive", "selected").rows[-1]
    assert {total.cells["masses"], total.cells["price"]} == {"unknown"}


def test_a_price_in_another_currency_has_a_total_of_its_own(spec, tmp_path):
    text = (
        "catalog: 1\nmanufacturer: Anymaker\nsources: {sheet: {document: sheet, confidence: quoted}}\nmotors:\n"
        "- family: M\n  source: sheet\n  columns: [part, mass (g), foreign_price, currency]\n"
        "  rows: [[M-1, 120, 24.95, USD]]\n"
    )
    (tmp_path / "own.yaml").write_text(text, encoding="utf-8")
    own = load(["own.yaml"], beside=tmp_path)
    found = size(spec, top=1).sets[0]
    lines = parts_list(
        replace(found, motor=own.motors.record(0), gearhead=NO_GEARHEAD, encoder=None, controller=None), own, 4
    )
    assert (lines[0].price, lines[0].currency, lines[0].price_confidence) == (24.95, "USD", "quoted")
    dollars = next(total for total in totals(lines) if total.unit == "USD")
    assert dollars.value == pytest.approx(4 * 24.95) and dollars.over == ("motor",)
