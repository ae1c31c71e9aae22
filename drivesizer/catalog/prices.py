"""Prices of parts apart from their figures: price lists of any layout, and the price that counts for so many pieces.

A price list is a table with a part, a price and its currency in each row; it may have dates, sellers, order numbers,
breaks by quantity. It goes over the prices in the rows of catalogues, and a later list over an earlier one; of one list
the newest price of each seller counts, and of sellers of the same date the lowest. Nothing is converted but by rates
that a spec gives.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache
from math import isnan, nan
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.parts import PARTS, RELATIONS
from drivesizer.catalog.tables import Catalog, Pairs, Price, Table, empty, spelling
from drivesizer.errors import InputError, quoted
from drivesizer.units import KINDS, number

_LISTS = (".csv", ".tsv", ".xlsx")  # what a price list may be, beside the section ``prices`` of a catalogue file
BY_PIECES = (("price_20", 20), ("price_5", 5), ("price", 1))  # columns of a row in EUR, from so many pieces on
_DATE = re.compile(r"(\d{1,2})[./](\d{1,2})[./](\d{4})|(\d{4}-\d{2}-\d{2}).*")

# -- Price lists as people have them.


def is_list(name: str | Path) -> bool:
    """Whether a name among the catalogues is that of a price list."""
    return Path(name).suffix.lower() in _LISTS


def price_list(path: Path, digest: str, *, shipped: bool = False) -> Catalog:
    """A price list as a catalogue without parts."""
    from drivesizer.files.sheets import decimal_sign, sheets

    for sheet in sheets(path):
        for place, (line, cells) in enumerate(sheet.rows[:15]):
            heads, columns = _understood(cells)
            if "part" not in heads or not columns:
                continue
            rows = [(at, row) for at, row in sheet.rows[place + 1 :] if any(row)]
            amounts = [row[k] for k in columns for _, row in rows if k < len(row)]
            decimal, prices, odd = decimal_sign(amounts, sheet.separator), list[Price](), list[int]()
            for at, row in rows:
                own = list(_of_row(heads, columns, row, decimal, f"{path}:{at}"))
                prices += [price._replace(file="" if shipped else path.name) for price in own]
                odd += [] if own else [at]
            if not prices:
                raise InputError(f"{path}:{line}: no price below the heads; expected one in each row, e.g. 46.55")
            left = f"{path.name}: without a price that can be read: line {', '.join(map(str, odd[:5]))}"
            left += f" and {len(odd) - 5} more" if len(odd) > 5 else ""
            none = Pairs(*(np.zeros(0, np.int32),) * 3)
            parts: dict[str, Any] = {section: empty(section) for section in PARTS} | dict.fromkeys(RELATIONS, none)
            return Catalog(**parts, sources=(), notes=(), digests={path.name: digest}, prices=tuple(prices),
                           replaced=(left,) if odd and not shipped else ())  # fmt: skip
    raise InputError(f"{path}: expected a price list with heads such as part, price, currency, date, seller")


class _Amounts(NamedTuple):
    """A column of prices: from how many pieces on, 0 where another column says it; the currency of its head."""

    pieces: int
    currency: str


def _understood(cells: Sequence[str]) -> tuple[dict[str, int], dict[int, _Amounts]]:
    """Columns of a price list by what their heads mean, and those of prices: ``price 10`` is from ten pieces on."""
    from drivesizer.files.sheets import currency_of, plain_head

    stated = [re.search(_CURRENCY, cell) for cell in cells]
    codes = [currency_of(currency[0]) if currency else "" for currency in stated]
    plain = [plain_head(re.sub(_CURRENCY, " ", cell)) for cell in cells]
    heads, amounts, price = dict[str, int](), dict[int, _Amounts](), "|".join(_words()["price"])
    for k, text in enumerate(plain):
        match = re.fullmatch(rf"(?:{price})(?:\D*?(\d+)\b.*)?", text)
        if match or (not text and codes[k]):  # a head may be the currency alone
            amounts[k] = _Amounts(int(match[1]) if match and match[1] else 0, codes[k])
    for name, words in _words().items():
        for word in words:  # the first word counts for most
            place = next(
                (k for k, text in enumerate(plain) if text == word and k not in {*heads.values(), *amounts}), None
            )
            if place is not None:
                heads.setdefault(name, place)
    if "part" not in heads and "order_number" in heads:
        heads["part"] = heads.pop("order_number")
    return heads, amounts


@cache
def _words() -> dict[str, list[str]]:
    from drivesizer.files.yaml_source import shipped_data

    headers = shipped_data("drivesizer.catalog", "headers.yaml")["price_list"]
    return {name: [name.replace("_", " "), *words.split("; ")] for name, words in headers.items()}


_CURRENCY = re.compile(rf"(?<![A-Za-z])(?:{'|'.join(KINDS['price'].units)})(?![A-Za-z])|[€$£¥]")


def _of_row(
    heads: Mapping[str, int], columns: Mapping[int, _Amounts], row: Sequence[str], decimal: str, where: str
) -> Iterator[Price]:
    """The prices of a row: one, or one of each column that has one."""
    from drivesizer.files.sheets import currency_of, figure

    def text(name: str) -> str:
        return row[heads[name]] if heads.get(name, len(row)) < len(row) else ""

    for place, column in columns.items():
        try:
            digits, behind = figure(row[place] if place < len(row) else "", decimal)
        except InputError:
            continue
        if not float(digits) > 0.0 or not text("part"):
            continue
        currency = column.currency or currency_of(text("currency").upper()) or currency_of(behind)
        if not currency:
            raise InputError(
                f"{where}: currency: {text('currency') or 'none'}; expected one of {', '.join(KINDS['price'].units)} "
                "in a column of its own or in the head, e.g. price (EUR)"
            )
        pieces = column.pieces or int(re.sub(r"\D.*", "", text("pieces")) or 1)
        texts = ("part", "seller", "order_number", "delivery", "note", "manufacturer", "document")
        yield Price(amount=float(digits), currency=currency, pieces=max(pieces, 1), date=iso_date(text("date")),
                    confidence=text("confidence") or "secondary", **{key: text(key) for key in texts})  # fmt: skip


def iso_date(text: str) -> str:
    """A date as the year first; others, and what may be month or day first, as printed.

    >>> iso_date("30.08.2026"), iso_date("2026-08-30 00:00:00"), iso_date("8/30/2026"), iso_date("5/6/2026")
    ('2026-08-30', '2026-08-30', '2026-08-30', '5/6/2026')
    """
    match = _DATE.fullmatch(text.strip())
    if match is None or match[4]:
        return match[4] if match else text.strip()
    day, month, sign = int(match[1]), int(match[2]), text.strip()[len(match[1])]
    if sign == "/" and day <= 12 and month <= 12 and day != month:
        return text.strip()
    day, month = (month, day) if sign == "/" and month > 12 else (day, month)
    return f"{match[3]}-{month:02d}-{day:02d}"


# -- The parts of the catalogues that a list has prices of.


def matched(catalog: Catalog) -> Catalog:
    """A catalogue whose prices are each of a part of it; prices of parts that it does not have are named."""
    if all(price.section for price in catalog.prices):
        return catalog
    prices, unknown = list[Price](), dict[str, list[str]]()
    for price in catalog.prices:
        parts = [(price.section, price.part)] if price.section else _parts_of(catalog, price)
        for section, part in parts:
            table = catalog.table(section)
            own = [part, *(str(table[name][table.rows[part]]) for name in ("order_number",) if name in table.columns)]
            order = price.order_number or ("" if spelling(price.part) in map(spelling, own) else price.part)
            prices.append(price._replace(section=section, part=part, order_number=order))
        if not parts and price.file:
            unknown.setdefault(price.file, []).append(price.part)
    messages = []
    for file, names in unknown.items():
        once, count = list(dict.fromkeys(names)), len({price.part for price in catalog.prices if price.file == file})
        listed = ", ".join(once[:5]) + (" ..." if len(once) > 5 else "")
        messages.append(f"{file}: {len(once)} of {count} parts are in none of the catalogues, or in those of several "
                    f"makers: {listed}")  # fmt: skip
    return replace(catalog, prices=tuple(prices), replaced=(*catalog.replaced, *messages))


def _parts_of(catalog: Catalog, price: Price) -> list[tuple[str, str]]:
    """Sections and numbers of the parts that a price is of: several, where one has figures at several voltages."""
    for name in filter(None, (price.part, price.order_number)):
        hits = [(section, row) for section in PARTS for row in catalog.table(section).called(name)]
        if not hits:
            continue
        makers = {(s, row): str(catalog.table(s)["manufacturer"][row]) for s, row in hits}
        if len(set(makers.values())) > 1:
            hits = [key for key in hits if spelling(makers[key]) == spelling(price.manufacturer)]
        return [(section, str(catalog.table(section)["part"][row])) for section, row in hits]
    return []


# -- Rates, and the currency in which prices are compared.


def factors(rates: Mapping[str, str] | None, currency: str) -> dict[str, float]:
    """Worth of one of each currency in a given one, by rates such as ``{"USD": "0.92 EUR"}``.

    Examples
    --------
    >>> factors({"USD": "0.8 EUR", "GBP": "1.5 USD"}, "EUR")
    {'EUR': 1.0, 'USD': 0.8, 'GBP': 1.2000000000000002}
    >>> factors({"USD": "0.8 EUR", "date": "2026-11-01"}, "USD")
    {'USD': 1.0, 'EUR': 1.25}
    """
    quotes = [(code, *_rate(code, text)) for code, text in (rates or {}).items() if code != "date"]
    worth = {currency: 1.0}
    for _ in quotes:
        for code, value, into in quotes:
            if into in worth:
                worth.setdefault(code, value * worth[into])
            elif code in worth:
                worth[into] = worth[code] / value
    return worth


def _rate(code: str, text: str) -> tuple[float, str]:
    """Value of a rate, and the currency that it is in.

    >>> _rate("USD", "0.92 USD")
    Traceback (most recent call last):
    drivesizer.errors.InputError: rate of USD "0.92 USD"; expected what one is in another currency, e.g. 0.92 EUR
    """
    known = KINDS["price"].units
    if code not in known:
        raise InputError(f"{quoted(code)} is no currency; expected {', '.join(known)}, or date")
    try:
        value, into = number(str(text))
    except InputError:
        value, into = nan, ""
    if not value > 0.0 or into not in known or into == code:
        other = "USD" if code == "EUR" else "EUR"
        raise InputError(f"rate of {code} {quoted(text)}; expected what one is in another currency, e.g. 0.92 {other}")
    return value, into


def priced(catalog: Catalog, limit: str = "", rates: Mapping[str, str] | None = None, pieces: int = 1) -> Catalog:
    """The catalogue with prices in one currency, each that of so many pieces.

    The currency is that of the limits, else the one that the rates are in, else that of most parts.
    """

    def make() -> Catalog:
        into = [_rate(code, text)[1] for code, text in (rates or {}).items() if code != "date"]
        currency = limit or (into[0] if into else most_common(catalog))
        plain = currency == "EUR" and not rates and pieces < BY_PIECES[-2][1]
        if plain and not catalog.prices:
            return catalog
        priced_catalog = replace(catalog, currency=currency, rates=factors(rates, currency), unpriced=catalog)
        return priced_catalog.with_tables({section: _priced(priced_catalog, section, pieces) for section in PARTS}, {})

    if catalog.unpriced:  # it is priced, and may be a view without some of the parts
        return catalog
    return catalog.once(("priced", limit, str(rates), pieces), make)


def _priced(catalog: Catalog, section: str, pieces: int) -> Table[Any]:
    """A table with the price of each part in the catalogue's currency."""
    table = catalog.table(section)
    if not len(table):
        return table
    value = np.full(len(table), nan)
    for amount, currency in _of_rows(table, pieces):
        rate = np.array([catalog.rates.get(code, nan) for code in np.atleast_1d(currency).tolist()])
        value = np.where(np.isnan(value), np.where(amount == 0.0, 0.0, amount * rate), value)
    for part in {price.part for price in catalog.prices if price.section == section}:
        if (price := price_of(catalog, section, part, pieces)) and price.currency in catalog.rates:
            value[table.rows[part]] = price.amount * catalog.rates[price.currency]
    return table.changed({"price": value})


def _columns(table: Table[Any]) -> Iterator[tuple[str, int, Any]]:
    """The columns of prices of a table, each with the pieces from which on it holds, and its currency."""
    columns: list[tuple[str, int, Any]] = [(name, pieces, "EUR") for name, pieces in BY_PIECES]
    columns += [("list_price", 1, "CHF"), ("foreign_price", 1, table["currency"])]
    return (column for column in columns if column[0] in table.columns)


def _of_rows(table: Table[Any], pieces: int) -> Iterator[tuple[NDArray[np.float64], Any]]:
    """The prices in the rows of a table for so many pieces, each with its currency."""
    return ((table[name], currency) for name, least, currency in _columns(table) if pieces >= least)


def most_common(catalog: Catalog) -> str:
    """The currency in which most parts have a price, by the lists that are given where they have one."""
    parts = {(price.section, price.part) for price in catalog.prices if price.file}
    listed = (price for price in catalog.prices if price.file or (price.section, price.part) not in parts)
    count = Counter(code for *_, code in {(price.section, price.part, price.currency) for price in listed})
    for section in PARTS:
        table = catalog.table(section)
        left = np.array([(section, part) not in parts for part in table["part"].tolist()], bool)
        for amount, currency in _of_rows(table, 1):
            known = left & (amount > 0.0)
            count.update(np.broadcast_to(currency, len(table))[known].tolist())
            left &= ~known
    return max(KINDS["price"].units, key=count.__getitem__)


def currencies(catalog: Catalog, section: str) -> dict[str, set[str]]:
    """The parts of a section that have a price, by its currency: in their rows, or in price lists."""
    table, by_currency = catalog.table(section), dict[str, set[str]]()
    for amount, currency in _of_rows(table, 1):
        codes = np.broadcast_to(currency, len(table))
        for row in np.flatnonzero(amount > 0.0).tolist():
            by_currency.setdefault(str(codes[row]), set()).add(str(table["part"][row]))
    for price in (price for price in catalog.prices if price.section == section):
        by_currency.setdefault(price.currency, set()).add(price.part)
    return by_currency


# -- The price of a part that counts.


def price_of(catalog: Catalog, section: str, part: str, pieces: int) -> Price | None:
    """The price of a part for so many pieces; None where none is known."""
    if section == "motors" and part in catalog.steppers.rows and part not in (catalog.unpriced or catalog).motors.rows:
        section = "steppers"  # as the view has them
    order, best = list(catalog.digests), dict[tuple[str, str, str], Price]()
    for price in _prices_of(catalog, section, part):
        key = price.file, price.seller or price.column, price.currency
        known = best.get(key)
        if price.pieces <= pieces and (known is None or (price.date, price.pieces) >= (known.date, known.pieces)):
            best[key] = price

    def rank(price: Price) -> tuple[Any, ...]:
        place = 1 + order.index(price.file) if price.file in order else 0
        own, rated = price.currency == catalog.currency, price.currency in catalog.rates
        return place > 0, rated, place, not price.column, own, price.date, price.pieces, -price.amount

    return max(best.values(), key=rank, default=None)


def _prices_of(catalog: Catalog, section: str, part: str) -> Iterator[Price]:
    """All prices of a part: of lists, then of its row."""
    listed: dict[tuple[str, str], list[Price]] = catalog.once("prices by part", lambda: _by_part(catalog))
    yield from listed.get((section, part), ())
    table = (catalog.unpriced or catalog).table(section)
    row = table.rows.get(part)
    if row is None:  # of the spec's own
        table, row = catalog.table(section), catalog.table(section).rows[part]
        if not isnan(table["price"][row]):
            yield Price(part, float(table["price"][row]), catalog.currency, column="price")
        return
    for name, pieces, currency in _columns(table):
        if not isnan(table[name][row]):
            own = str(np.broadcast_to(currency, len(table))[row])
            yield Price(part, float(table[name][row]), own, pieces, column=name)


def _by_part(catalog: Catalog) -> dict[tuple[str, str], list[Price]]:
    prices: dict[tuple[str, str], list[Price]] = {}
    for price in catalog.prices:
        prices.setdefault((price.section, price.part), []).append(price)
    return prices


def uncompared(catalog: Catalog) -> str:
    """A line on the parts whose prices are in no currency that can be compared; nothing where all are."""
    left: dict[str, dict[str, None]] = {}
    source, compared = catalog.unpriced or catalog, catalog.table
    for section in PARTS:
        table, counted = source.table(section), compared(section)
        for amount, currency in _of_rows(table, 1):
            codes = np.broadcast_to(currency, len(table))
            for row in np.flatnonzero(~np.isnan(amount) & (codes != catalog.currency)).tolist():
                part = str(table["part"][row])
                if part in counted.rows and isnan(counted["price"][counted.rows[part]]):
                    left.setdefault(str(codes[row]), {})[part] = None
    for price in catalog.prices:
        counted = compared(price.section)
        known = price.currency in catalog.rates or price.part not in counted.rows
        if not known and isnan(counted["price"][counted.rows[price.part]]):
            left.setdefault(price.currency, {})[price.part] = None
    counts = [
        f"{len(parts)} in {code} ({', '.join(list(parts)[:3])}{' ...' * (len(parts) > 3)})"
        for code, parts in left.items()
    ]
    if not counts:
        return ""
    return (f"prices are compared in {catalog.currency}; without a rate the price of other parts counts as unknown: "
            f"{'; '.join(counts)}: select.rates, e.g. {{{next(iter(left))}: ... {catalog.currency}}}")  # fmt: skip
