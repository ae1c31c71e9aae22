"""Price lists: those that people have, over the prices of catalogues; one currency to compare in, and rates.

The lists are our own renditions of layouts that shops and ERP systems of several countries write.
"""

import csv
import io
from pathlib import Path

import pytest
import xlsxwriter
from typer.testing import CliRunner

from drivesizer.catalog import load, shipped
from drivesizer.catalog.prices import factors, most_common, price_of, priced, uncompared
from drivesizer.catalog.query import coverage
from drivesizer.cli import app
from drivesizer.errors import CatalogError, InputError
from drivesizer.files.fields import money

PARTS = """catalog: 1
manufacturer: Example
sources: {sheet: {document: data sheet, date: "2025-01", confidence: quoted}}
motors:
- family: M 20
  source: sheet
  common: {kind: brushed}
  columns: [part, order_number, also_called, nominal_voltage (V), price (EUR), price_5 (EUR), foreign_price, currency]
  rows:
  - [M20-24, ~, MX-24; MX-24R, 24, 50, 45, ~, ~]
  - [M20-48, ~, ~, 48, ~, ~, 70, USD]
  - [M30 12 V, M30, ~, 12, ~, ~, ~, ~]
  - [M30 24 V, M30, ~, 24, ~, ~, ~, ~]
"""
PLAIN = """part,price,currency,date,seller
M20-24,40,EUR,2026-03-01,A
M20-24,39,EUR,2026-03-01,B
m20 48,61.5,USD,2026-02-01,A
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "parts.yaml").write_text(PARTS)
    return tmp_path


def opened(folder: Path, *lists: str | bytes, suffix: str = ".csv"):
    names = ["parts.yaml"]
    for number, text in enumerate(lists):
        names.append(f"list{number}{suffix}")
        (folder / names[-1]).write_bytes(text if isinstance(text, bytes) else text.encode())
    return load(names, beside=folder)


def found(catalog, part: str, pieces: int = 1, section: str = "motors"):
    price = price_of(catalog, section, part, pieces)
    return price and (price.amount, price.currency)


# --- files of several countries


GERMAN = "Bestellnummer;Bezeichnung;Preis (EUR);Stand;Lieferant;Lieferzeit\n" \
         "M20-24;Motor;1.234,50;01.02.2026;Händler;3 Wochen\nM30;Motor;12,00;;;\n"  # fmt: skip
ENGLISH = (
    'Item No,Description,Unit price,Supplier,Price date\nM20-24,Motor,"$1,234.50",Shop,2/28/2026\nM30,Motor,$12.00,,\n'
)
FRENCH = "Référence\tPrix\tDevise\tFournisseur\nM20-24\t1 234,50\tCHF\tVendeur\nM30\t12,00\tCHF\t\n"


@pytest.mark.parametrize(
    ("raw", "currency"),
    [
        (GERMAN.encode("cp1252"), "EUR"), (GERMAN.encode("utf-16"), "EUR"), (GERMAN.encode("utf-8-sig"), "EUR"),
        (ENGLISH.encode(), "USD"), (FRENCH.encode("cp1252"), "CHF"),
    ],
)  # fmt: skip
def test_a_list_of_any_country_is_read(raw, currency, folder):
    catalog = opened(folder, raw)
    assert found(catalog, "M20-24") == (1234.5, currency)
    assert found(catalog, "M30 12 V") == found(catalog, "M30 24 V") == (12.0, currency)  # one order number


def test_dates_sellers_and_delivery_are_kept(folder):
    price = price_of(opened(folder, GERMAN), "motors", "M20-24", 1)
    assert (price.date, price.seller, price.delivery, price.note) == ("2026-02-01", "Händler", "3 Wochen", "")


def test_a_workbook_is_a_list_too(folder):
    stream = io.BytesIO()
    book = xlsxwriter.Workbook(stream)
    sheet = book.add_worksheet("Preise")
    for at, row in enumerate([["Preisliste 2026"], [], ["Artikel", "Preis", "Währung"], ["M20-24", 41.5, "EUR"]]):
        sheet.write_row(at, 0, row)
    book.close()
    assert found(opened(folder, stream.getvalue(), suffix=".xlsx"), "M20-24") == (41.5, "EUR")


def test_a_column_for_each_currency(folder):
    """The head may be the currency alone."""
    for heads in ("part,price (EUR),price (USD)", "Part,EUR,USD"):
        catalog = opened(folder, f"{heads}\nM20-24,40,44\nM30,,12\n")
        assert found(catalog, "M20-24") == (40.0, "EUR") and found(catalog, "M30 12 V") == (12.0, "USD")
        assert found(priced(catalog, "USD"), "M20-24") == (44.0, "USD")


def test_breaks_by_quantity_in_rows_and_in_columns(folder):
    rows = "part;ab Menge;Preis;Währung\nM20-24;1;40;EUR\nM20-24;10;35,5;EUR\n"
    columns = "part,price 1,price 10,currency\nM20-24,40,35.5,EUR\n"
    for text in (rows, columns):
        catalog = opened(folder, text)
        assert [found(catalog, "M20-24", n)[0] for n in (1, 9, 10, 99)] == [40.0, 40.0, 35.5, 35.5]
    only_many = opened(folder, "part,price,currency,pieces\nM20-24,30,EUR,100\n")
    assert [found(only_many, "M20-24", n)[0] for n in (1, 5, 100)] == [50.0, 45.0, 30.0]  # of the row until then


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a,b\n1,2\n", "expected a price list with heads such as part, price, currency"),
        ("part,price\nM20-24,40\n", "list0.csv:2: currency: none; expected one of EUR, USD"),
        ("part,price,currency\nM20-24,40,XYZ\n", "list0.csv:2: currency: XYZ; expected one of EUR, USD"),
        ("part,price,currency\nM20-24,on request,EUR\n", "no price below the heads"),
    ],
)
def test_a_list_that_is_wrong_is_one_line(text, words, folder):
    with pytest.raises(InputError, match=words):
        opened(folder, text)


def test_rows_without_a_price_and_parts_of_no_catalogue_are_named(folder):
    catalog = opened(folder, PLAIN + "M20-48,on request,EUR,,\nX-1,10,EUR,,\nX-2,11,EUR,,\n")
    assert catalog.replaced == (
        "list0.csv: without a price that can be read: line 5",
        "list0.csv: 2 of 4 parts are in none of the catalogues, or in those of several makers: X-1, X-2",
    )


# --- which price counts


def test_the_newest_price_of_each_seller_and_the_lowest_of_one_date(folder):
    assert found(opened(folder, PLAIN), "M20-24") == (39.0, "EUR")
    older = "part,price,currency,date,seller\nM20-24,40,EUR,2026-03-01,A\nM20-24,20,EUR,2025-03-01,A\n"
    assert found(opened(folder, older), "M20-24") == (40.0, "EUR")


def test_a_list_goes_over_the_row_and_a_later_list_over_an_earlier_one(folder):
    assert found(opened(folder), "M20-24") == (50.0, "EUR")
    assert found(opened(folder, PLAIN, "part,price,currency\nM20-24,60,EUR\n"), "M20-24") == (60.0, "EUR")


def test_another_name_of_a_part_is_what_is_ordered(folder):
    price = price_of(opened(folder, "part,price,currency\nMX-24R,40,EUR\n"), "motors", "M20-24", 1)
    assert (price.amount, price.order_number) == (40.0, "MX-24R")
    same = price_of(opened(folder, "part,price,currency\nm20-24,40,EUR\n"), "motors", "M20-24", 1)
    assert same.order_number == ""


def test_of_two_makers_with_such_a_part_the_named_one(folder):
    other = (
        PARTS.replace("manufacturer: Example", "manufacturer: Other")
        .replace("M20-24", "m 2024")
        .split("  - [M20-48")[0]
    )
    (folder / "other.yaml").write_text(other)
    for maker, prices in {"": [50.0, 50.0], "other": [50.0, 9.0]}.items():
        (folder / "list.csv").write_text(f"part,price,currency,manufacturer\nM2024,9,EUR,{maker}\n")
        catalog = load(["parts.yaml", "other.yaml", "list.csv"], beside=folder)
        assert [found(catalog, part)[0] for part in ("M20-24", "m 2024")] == prices


# --- in a catalogue file


def test_a_catalogue_file_has_prices_of_parts_of_any_catalogue(folder):
    (folder / "shop.yaml").write_text("""catalog: 1
manufacturer: Shop
sources: {shop: {document: price list of the shop, date: "2026-05-01", confidence: quoted}}
prices:
- source: shop
  common: {currency: USD, seller: Shop}
  columns: [part, price, pieces]
  rows:
  - [M20-24, 30, 1]
  - [M20-24, 25.5, 10]
""")
    catalog = load(["parts.yaml", "shop.yaml"], beside=folder)
    in_dollars = priced(catalog, "USD")
    assert [found(in_dollars, "M20-24", n) for n in (1, 10)] == [(30.0, "USD"), (25.5, "USD")]
    price = price_of(in_dollars, "motors", "M20-24", 1)
    assert (price.date, price.document, price.confidence) == ("2026-05-01", "price list of the shop", "quoted")


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("columns: [part, cost], rows: [[M20-24, 3]]", 'unknown column "cost"; expected part, price'),
        ("columns: [part, price], rows: [[M20-24, x]]", "does not start with a number"),
        ("columns: [part, price, pieces], rows: [[M20-24, 3, some]]", "from how many pieces on"),
        ("columns: [part, price, currency], rows: [[M20-24, 3, XYZ]]", "not a unit of price"),
    ],
)
def test_wrong_prices_of_a_catalogue_file_are_one_line(given, words, folder):
    (folder / "parts.yaml").write_text(f"{PARTS}prices: [{{source: sheet, {given}}}]\n")
    with pytest.raises(CatalogError, match=words):
        opened(folder)


# --- one currency


def test_rates_lead_from_one_currency_to_another_and_back():
    assert factors({"USD": "0.8 EUR", "GBP": "1.5 USD"}, "EUR") == pytest.approx({"EUR": 1, "USD": 0.8, "GBP": 1.2})
    assert factors({"USD": "0.8 EUR", "date": "2026-11-01"}, "USD") == pytest.approx({"USD": 1.0, "EUR": 1.25})
    for wrong in ({"USD": "0.8"}, {"USD": "-1 EUR"}, {"USD": "1 USD"}, {"ABC": "1 EUR"}):
        with pytest.raises(InputError, match="expected"):
            factors(wrong, "EUR")


def test_prices_are_compared_in_the_currency_of_most_parts_or_of_a_limit_or_of_rates(folder):
    catalog = opened(folder, "part,price,currency\nM30,10,USD\nM20-24,52,USD\n")
    assert most_common(catalog) == "USD"
    rows = catalog.motors.rows

    def each(*how):
        seen = priced(catalog, *how)
        return seen.currency, [float(seen.motors["price"][rows[part]]) for part in ("M20-24", "M20-48", "M30 12 V")]

    assert each() == ("USD", [52.0, 70.0, 10.0])
    assert each("EUR")[1] == pytest.approx([50.0, float("nan"), float("nan")], nan_ok=True)
    assert each("", {"USD": "0.5 EUR"}) == ("EUR", [26.0, 35.0, 5.0])  # a list counts before the row, converted too
    assert each("USD", {"USD": "0.5 EUR"}) == ("USD", [52.0, 70.0, 10.0])
    assert each("EUR", None, 5)[1][0] == 45.0  # from five pieces on


def test_prices_that_do_not_count_are_named(folder):
    catalog = opened(folder, "part,price,currency\nM30,10,GBP\n")
    words = uncompared(priced(catalog, "EUR"))
    assert words.startswith("prices are compared in EUR; without a rate the price of other parts counts as unknown: ")
    assert "1 in USD (M20-48)" in words and "2 in GBP (M30 12 V, M30 24 V)" in words
    assert uncompared(priced(catalog, "EUR", {"USD": "0.9 EUR", "GBP": "1.2 EUR"})) == ""


def test_money_keeps_its_currency():
    assert [(one, one.currency) for one in map(money, ("300 USD", "5 €", "1e3 CHF"))] == [
        (300.0, "USD"), (5.0, "EUR"), (1000.0, "CHF"),
    ]  # fmt: skip


# --- what catalogues have and leave out


def test_statistics_count_priced_parts_by_currency_and_name_silent_families(folder):
    """Of four motors two have prices, in rows or lists; no row gives rotor inertia, one family of two gives voltage."""
    other = "- {family: M 90, source: sheet, columns: [part], rows: [[M90]]}\n"
    (folder / "parts.yaml").write_text(PARTS + other)
    found = coverage(opened(folder, "part,price,currency\nM90,10,GBP\n"), "motors")
    assert (found.parts, found.priced, found.prices) == (5, 3, {"EUR": 1, "USD": 1, "GBP": 1})
    assert found.silent["rotor inertia"] == ["M 20", "M 90"] and found.silent["nominal voltage"] == ["M 90"]
    ran = CliRunner().invoke(app, ["catalog", "stats", "--catalog", str(folder / "parts.yaml")])
    assert "rotor inertia (all families)" in ran.output and "prices: motors 1 in EUR, 1 in USD" in ran.output


# --- the lists that ship


def test_the_shipped_lists_are_whole_and_dated():
    place = shipped()["maxon"].parent / "prices"
    lists = {
        path.stem: list(csv.DictReader(path.read_text(encoding="utf-8").splitlines())) for path in place.glob("*.csv")
    }
    assert sum(map(len, lists.values())) > 140
    for name, rows in lists.items():
        assert all(float(row["price"]) > 0 and row["source"] and row["confidence"] for row in rows), name
    assert sum(bool(load([name]).prices) for name in lists.keys() & shipped()) >= 14


def test_prices_of_parts_as_their_sellers_print_them():
    """XM430-W350-R 333.39 USD and 325.56 EUR, RS02 145 USD, NEO 550 is REV-21-1651, 30 USD (shops, August 2026 on)."""
    catalog = load(["robotis", "robstride", "rev"])
    in_dollars = priced(catalog, "USD")
    assert found(in_dollars, "XM430-W350 12 V", 1, "actuators") == (333.39, "USD")
    assert found(priced(catalog, "EUR"), "XM430-W350 12 V", 1, "actuators") == (325.56, "EUR")
    assert found(in_dollars, "RS02", 1, "actuators") == (145.0, "USD")
    neo = price_of(in_dollars, "motors", "NEO 550", 1)
    assert (neo.amount, neo.order_number, neo.seller) == (30.0, "REV-21-1651", "revrobotics.com")
