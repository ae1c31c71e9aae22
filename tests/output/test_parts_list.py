"""The parts list: what is ordered, how many, at which price of which date; and nothing that no catalogue says."""

import csv
import io
from dataclasses import replace

import openpyxl
import pytest

from drivesizer.catalog import Catalog, load
from drivesizer.catalog.parts import BeltDrive
from drivesizer.output.document.axes import content_of
from drivesizer.output.document.quote import Ordered
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
    assert (
        Ordered("", line).missing == "no order number of motor with encoder and no price"
    )  # maxon numbers them together


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
        for r in csv.DictReader(io.StringIO(csv_tables.report_csv(content_of(fallen)).decode()))
        if r["section"] == "part"
    ]
