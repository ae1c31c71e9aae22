"""One run, told by every kind of report: the same numbers in all of them.

The CSV has every digit and is held against the records. A workbook and a JSON document must have the same floats; what
is printed for people must round to the same. A further kind of report is one more line in ``READERS``.
"""

import csv
import io
import json
import re
from collections.abc import Callable
from dataclasses import replace
from math import floor, inf, isclose, isfinite, isnan, log10, nan
from pathlib import Path
from typing import Any, NamedTuple

import openpyxl
import pytest
from lxml import html
from numbers_read import NUMBER, number, value_of, words
from pdf_text import texts_of
from printed import blank_figures
from starters import starter

from drivesizer.control.validation import Validation
from drivesizer.files.yaml_source import YamlSource
from drivesizer.output.report import KNOWN, write
from drivesizer.results.check import Check
from drivesizer.results.sizing import SizingResult
from drivesizer.search.uncertainty.options import Sampling
from drivesizer.simulate import validate
from drivesizer.sizing import size
from drivesizer.spec.robot import RobotSpec, read_spec
from drivesizer.units import KINDS, from_si, label


class Fact(NamedTuple):
    """A figure, or a demand with its limit: numbers in the unit of the trade; NaN is unknown."""

    value: float = nan
    limit: float = nan
    margin: float = nan
    unit: str = ""  # as it is printed
    status: str = ""
    digits: int = 4  # that are printed for people: a mass that is estimated in part has three


Key = tuple[Any, ...]  # ("requirement", name), ("check", method, name), ("candidate", rank, figure) ...
Facts = dict[Key, Fact]


class Run(NamedTuple):
    """What was found: a reader takes the names of what it looks for from it, and no number."""

    result: SizingResult
    proof: Validation | None

    @property
    def best(self) -> Any:
        return self.result.reported

    @property
    def candidates(self) -> list[Any]:
        return [*self.result.sets, *self.result.misses]

    def checks(self) -> list[tuple[str, Check]]:
        """Each check of the chosen set and of its closed loop, with where it stands."""
        own = [("check", c) for c in self.best.every_check]
        return own + [("validation", c) for c in (self.proof.checks if self.proof else ())]


# -- what the records say


def recorded(run: Run) -> Facts:
    """The facts as the sizing found them."""
    found: Facts = {}
    for place, r in [(0, r) for r in run.result.requirements] + [(1, r) for r in run.best.requirements]:
        found["requirement", place, r.name] = Fact(r.shown, unit=label(r.unit))
    for where, c in run.checks():
        demand, limit = (float(from_si(x, c.unit, c.kind)) for x in (c.demand, c.limit))
        found[where, c.method, c.name] = Fact(demand, limit, c.margin, label(c.unit), c.status)
    for s in run.candidates:
        prices = [p.price for p in s.parts.values() if p is not None and not isnan(p.price)]
        found["candidate", s.rank, "mass"] = Fact(1000.0 * s.mass, unit="g", digits=3 if s.mass_estimated else 4)
        found["candidate", s.rank, "price"] = Fact(sum(prices) if prices else nan, unit=s.currency)
        found["candidate", s.rank, "total_ratio"] = Fact(s.total_ratio)
        found["candidate", s.rank, "verdict"] = Fact(status=s.status)
    for f in run.proof.figures if run.proof else ():
        found["figure", f.name] = Fact(float(from_si(f.value, f.unit, f.kind)), unit=label(f.unit))
    return found | machine(run)


def machine(run: Run) -> Facts:
    """What the machine weighs and draws with the chosen set: masses of all pieces; consumers, mean and at most."""
    found = {("mass", row.name): Fact(row.number * row.each, unit="kg") for row in run.best.masses}
    energy = run.best.energy
    for f in (*run.best.machine, *(energy.figures if energy else ())):
        found["machine", f.title] = Fact(float(from_si(f.value, f.unit, f.kind)), unit=label(f.unit))
    for one in energy.consumers if energy else ():
        found["consumer", one.name] = Fact(one.mean, one.peak, unit="W")
    return found


OF_THE_MACHINE = {"mass": "mass", "machine": "machine", "battery": "machine", "consumer": "consumer"}  # section: key


# -- readers: from the files of a report to its facts


SETS = {("set", name) for name in ("mass", "price", "total_ratio", "verdict")}


def from_csv(folder: Path, run: Run) -> Facts:
    rows = list(csv.DictReader(io.StringIO((folder / "report.csv").read_text(encoding="utf-8"))))
    found: Facts = {}
    limited = {(where, c.method, c.name) for where, c in run.checks()}
    for row in rows:
        section, name, rank = row["section"], row["name"], row["set_rank"]
        if section in OF_THE_MACHINE and rank == str(run.best.rank):
            summed = section == "mass" and row["title"] in {f.title for f in run.best.machine}
            kind = "machine" if summed else section
            found |= of_the_machine(kind, row["title"], row["value"], row["limit"], row["unit"])
        if section not in ("requirement", "check", "validation") and (section, name) not in SETS:
            continue
        fact = Fact(*(number(row[key]) for key in ("value", "limit", "margin")), label(row["unit"]), row["status"])
        if section == "requirement" and rank in ("", str(run.best.rank)):
            found[section, int(bool(rank)), name] = fact
        elif (section, row["method"], name) in limited and rank in ("", str(run.best.rank)):
            found[section, row["method"], name] = fact
        elif section == "set":
            found["candidate", int(rank), name] = fact if name == "verdict" else fact._replace(status="")
        elif section == "validation" and row["note"] == row["status"] == "" and name != "verdict":
            found["figure", name] = fact
    return found


def of_the_machine(section: str, title: str, value: Any, limit: Any, unit: str | None) -> Facts:
    most = number(limit or 0.0) if section == "consumer" else nan  # a peak of nothing is left out
    return {(OF_THE_MACHINE[section], title): Fact(number(value), most, unit=label(unit or ""))}


Line = dict[str, Any]  # of a sheet: its cells by the heads above them, and the unit of each number


def lines(folder: Path) -> list[tuple[str, Line]]:
    """Rows of all tables with the sheet that they stand in; a head is known by its colour."""
    found = []
    for page in openpyxl.load_workbook(folder / "report.xlsx", data_only=True):
        heads: list[str] = []
        for cells in page.iter_rows():
            values = [cell.value for cell in cells]
            if cells[0].fill.fgColor.rgb == "FF0B5B8C":
                heads = [str(value or "") for value in values]
                continue
            line: Line = {}
            for n, (head, value) in enumerate(zip(heads, values, strict=False)):
                name, _, unit = head.partition(" (")
                beside = heads[n + 1 : n + 2] == ["unit"]
                if name and name not in ("unit", "SI value", "SI unit"):
                    line |= {
                        name: value,
                        f"unit of {name}": (values[n + 1] if beside else unit.removesuffix(")")) or "",
                    }
            found.append((page.title, line))
    return found


def from_xlsx(folder: Path, run: Run) -> Facts:
    found: Facts = {}
    names = {(i, r.title): r.name for i, of in enumerate((run.result, run.best)) for r in of.requirements}
    called = {(where, c.method, c.title): c.name for where, c in run.checks()}
    figures = {f.title: f.name for f in run.proof.figures} if run.proof else {}
    loop = run.proof.loop.capitalize() if run.proof else ""
    for sheet, row in lines(folder):
        title = str(row.get("title", row.get("part", ""))).removesuffix(" given")
        if row.get("drive", run.best.rank) != run.best.rank:
            continue
        if "symbol" in row and (int("drive" in row), title) in names:
            place = int("drive" in row)
            found["requirement", place, names[place, title]] = Fact(number(row["value"]), unit=row["unit of value"])
        elif "check" in row and "demand" in row and sheet != "Summary":
            where = "validation" if sheet == loop else "check"
            name = called.get((where, row["method"], row["check"]))
            figure = number(row["demand"]), number(row["limit"]), number(row["margin"])
            if name:
                found[where, row["method"], name] = Fact(*figure, row["unit of demand"], row["status"] or "")
        elif "together" in row and sheet == "The machine with this drive":
            summed = row["part"] in {f.title for f in run.best.machine}
            found["machine" if summed else "mass", row["part"]] = Fact(number(row["together"]), unit="kg")
        elif "consumer" in row:
            peak = number(row["peak"])
            found["consumer", row["consumer"]] = Fact(number(row["mean"]), 0.0 if isnan(peak) else peak, unit="W")
        elif sheet in ("The machine with this drive", "Battery") and "value" in row:
            found["machine", title] = Fact(number(row["value"]), unit=row["unit of value"])
        elif sheet == loop and title in figures and "value" in row:
            found["figure", figures[title]] = Fact(number(row["value"]), unit=row["unit of value"])
        if sheet == "Candidates" and row.get("list") in ("set", "miss", "unsure"):
            rank = row["rank"]
            (price,) = (head for head in row if re.fullmatch("price [A-Z]{3}", head))
            found["candidate", rank, "mass"] = Fact(1000.0 * number(row["mass kg"]), unit="g")
            found["candidate", rank, "price"] = Fact(number(row[price]), unit=price.split()[-1])
            found["candidate", rank, "total_ratio"] = Fact(number(row["total ratio"]))
            found["candidate", rank, "verdict"] = Fact(status=row["status"])
    return found


def from_json(folder: Path, run: Run) -> Facts:
    document = json.loads((folder / "report.json").read_text(encoding="utf-8"), parse_constant=pytest.fail)
    (axis,) = document["axes"]
    document, driven = axis["result"], axis["validation"] or {"checks": [], "figures": []}
    best = (document["sets"] or document["unsure"] or document["misses"])[0]
    found: Facts = {}
    records = run.result.requirements, run.best.requirements, run.best.every_check, run.best.machine
    proven = (run.proof.checks, run.proof.figures) if run.proof else ((), ())
    trade = {(one.name, one.kind): one.unit for some in (*records, *proven) for one in some}
    energy = best["energy"]
    trade |= {(one.name, one.kind): one.unit for one in (run.best.energy.figures if run.best.energy else ())}

    def shown(one: dict[str, Any], key: str = "value") -> float:
        """A figure of the document, in SI, in the unit of the trade."""
        return float(from_si(number(one[key]), trade[one["name"], one["kind"]], one["kind"]))

    def unit(one: dict[str, Any]) -> str:
        return label(trade[one["name"], one["kind"]])

    for place, requirements in enumerate((document["requirements"], best["requirements"])):
        for r in requirements:
            found["requirement", place, r["name"]] = Fact(shown(r), unit=unit(r))
    own = [c for name in ("checks", "beside", "budget") for c in best[name]]
    for where, checks in (("check", own), ("validation", driven["checks"])):
        for c in checks:
            numbers = shown(c, "demand"), shown(c, "limit"), number(c["margin"])
            found[where, c["method"], c["name"]] = Fact(*numbers, unit(c), c["status"])
    for s in (*document["sets"], *document["misses"]):
        whole = [s["actuator"]] if s["actuator"] else [s["motor"], s["gearhead"]]
        belt = [part for part in (s["belt_drive"] or {}).values() if isinstance(part, dict)]
        prices = [p["price"] for p in (*whole, *belt, s["encoder"], s["controller"])
                  if p and not p.get("inside") and p["part"] != "direct" and p["price"] is not None]  # fmt: skip
        found["candidate", s["rank"], "mass"] = Fact(1000.0 * number(s["mass"]), unit="g")
        found["candidate", s["rank"], "price"] = Fact(sum(prices) if prices else nan, unit=s["currency"])
        found["candidate", s["rank"], "total_ratio"] = Fact(s["total_ratio"])
        found["candidate", s["rank"], "verdict"] = Fact(status=s["status"])
    for f in driven["figures"]:
        found["figure", f["name"]] = Fact(shown(f), unit=unit(f))
    for m in best["masses"]:
        found["mass", m["name"]] = Fact(number(m["total"]), unit="kg")
    for f in (*best["machine"], *(energy["figures"] if energy else ())):
        found["machine", f["title"]] = Fact(shown(f), unit=unit(f))
    for c in energy["consumers"] if energy else ():
        found["consumer", c["name"]] = Fact(number(c["mean"]), number(c["peak"]), unit="W")
    return found


def from_pdf(folder: Path, run: Run) -> Facts:
    return from_text(" ".join(texts_of((folder / "report.pdf").read_bytes())), run)


def from_html(folder: Path, run: Run) -> Facts:
    page = html.parse(folder / "report.html").getroot()
    for script in page.xpath("//script | //style"):
        script.drop_tree()
    for formula in page.xpath("//math"):  # its signs and powers are elements of their own
        text, tail = "".join(formula.itertext()), formula.tail
        formula.clear()
        formula.text, formula.tail = text, tail
    return from_text(" ".join(page.itertext()), run)


STATUS = r"\b(?P<status>pass|fail|unknown)\b"


def from_text(text: str, run: Run) -> Facts:
    """The facts of a report for people, by the titles beside which its numbers stand."""
    text = re.sub(r"\s+", " ", text).replace("\u200b", "").replace("\xa0", " ")
    expected, found = recorded(run), {}
    titles: dict[Key, str] = {(where, c.method, c.name): c.title for where, c in run.checks()}
    for place, of in enumerate((run.result, run.best)):
        titles |= {("requirement", place, r.name): r.title for r in of.requirements}
    titles |= {("figure", f.name): f.title for f in (run.proof.figures if run.proof else ())}
    titles |= {key: key[1] for key in expected if key[0] == "machine"}
    for key in expected:
        if key[0] in ("mass", "consumer"):
            found[key] = nearest(expected[key], read_row(text, key, expected[key].unit))
    for key, title in titles.items():
        found[key] = nearest(expected[key], read_all(text, title, expected[key], key[0] in ("check", "validation")))
    for s in run.candidates:
        found |= candidate(text, s, expected)
    return {key: fact for key, fact in found.items() if fact is not None}


LARGER = {"g": "kg", "J": "kJ", "W": "kW", "mN·m": "N·m", "N": "kN"}  # the next prefix, from a thousand on


def read_all(text: str, title: str, expected: Fact, limited: bool) -> list[Fact]:
    """What stands behind each place at which a title does: a method's table, the other's, the tightest margins."""
    unit, larger = re.escape(expected.unit), re.escape(LARGER.get(expected.unit, "no unit"))
    quantity = rf"(?:({NUMBER}) ?(?:{unit}|({larger}))|(unknown)|(unbounded))(?![\w.])"
    if not limited:
        pattern = rf"{words(title)}.{{0,90}}?[= ]{quantity}"
        return [Fact(parsed(m, 1), unit=expected.unit) for m in re.finditer(pattern, text)]
    if isnan(expected.value) and isnan(expected.limit):  # a condition without figures
        pattern = rf"{words(title)} [^%]{{0,200}}?{STATUS}"
        return [Fact(unit=expected.unit, status=m["status"]) for m in re.finditer(pattern, text)]
    margin = rf"(?: (?:(?P<margin>{NUMBER})|(?P<beyond>> 9999)) %)?(?: needs \S+ %)?"
    pattern = rf"{words(title)} .{{0,300}}?{quantity} {quantity}{margin} {STATUS}"
    return [
        Fact(
            parsed(m, 1),
            parsed(m, 5),
            inf if m["beyond"] else value_of(m["margin"]) / 100.0 if m["margin"] else nan,
            expected.unit,
            m["status"],
        )
        for m in re.finditer(pattern, text)
    ]


def read_row(text: str, key: Key, unit: str) -> list[Fact]:
    """A row of a table: after the name how many there are, where it is more than one, then its figures.

    A part's mass is each and together, where there are several; a consumer's power is the mean and then the peak,
    which is left out where it is nothing.
    """
    quantity = rf"(?:({NUMBER}) (?:k?{unit})|(unknown))(?![\w.])"
    pattern = rf"(?<!\w){words(key[1])} (?:\d+ (?:× )?|– )?{quantity}(?: \([^)]*\))?(?: {quantity})?"  # a band
    found = []
    for m in re.finditer(pattern, text):
        several = bool(m[3] or m[4])
        if key[0] == "mass":
            found.append(Fact(parsed_of(m, 3 if several else 1), unit=unit))
        else:
            found.append(Fact(parsed_of(m, 1), parsed_of(m, 3) if several else 0.0, unit=unit))
    return found


def parsed_of(match: re.Match[str], first: int) -> float:
    return value_of(match[first]) if match[first] else nan


def parsed(match: re.Match[str], first: int) -> float:
    digits, thousand, unknown, endless = match.group(first, first + 1, first + 2, first + 3)
    return nan if unknown else inf if endless else (1000.0 if thousand else 1.0) * value_of(digits)


def nearest(expected: Fact, read: list[Fact]) -> Fact | None:
    """Of several places the one that agrees; else the first, which does not."""
    return next((fact for fact in read if rounds(expected, fact)), read[0] if read else None)


def candidate(text: str, s: Any, expected: Facts) -> Facts:
    motor = " ?".join(re.escape(letter) for letter in s.motor_name if letter != " ")  # a cell may break inside a name
    pattern = (
        rf"\b{s.rank} {motor} .{{0,80}}? (?P<ratio>{NUMBER}) (?:{mark(s)}(?P<mass>{NUMBER} k?g)|unknown) "
        rf"(?P<price>{NUMBER}|unknown) .{{0,120}}?{STATUS}"
    )
    table = text[text.index("combinations of motor and gearhead, with") :]
    match, head = re.search(pattern, table), re.search(r"\bprice \(([A-Z]{3})\)", table)
    if match is None or head is None:
        return {}
    mass, _, unit = (match["mass"] or "").partition(" ")
    grams = value_of(mass) * (1000.0 if unit == "kg" else 1.0) if mass else nan
    price = nan if match["price"] == "unknown" else value_of(match["price"])
    return {
        ("candidate", s.rank, "mass"): Fact(grams, unit="g"),
        ("candidate", s.rank, "price"): Fact(price, unit=head[1]),
        ("candidate", s.rank, "total_ratio"): Fact(value_of(match["ratio"])),
        ("candidate", s.rank, "verdict"): Fact(status=match["status"]),
    }


def mark(s: Any) -> str:
    """Before a mass: at least that, where a counted part's is unknown; about that, where one is estimated."""
    return "≥ " if s.unknown_parts("mass", s.mass_of) else "≈ " if s.mass_estimated else ""


# -- how well they must agree


def same(expected: Fact, fact: Fact) -> bool:
    """All digits; a workbook keeps 16 of 17."""
    numbers = zip(expected[:3], fact[:3], strict=True)
    return expected[3:5] == fact[3:5] and all(both_unknown(a, b) or isclose(a, b, rel_tol=1e-15) for a, b in numbers)


def rounds(expected: Fact, fact: Fact) -> bool:
    """Its digits, money to the cent, a margin to the tenth of a percent below ten and to the percent above."""
    fine = 0.0005 if abs(expected.margin) < 0.0995 else 0.005
    return (
        expected[3:5] == fact[3:5]
        and all(
            both_unknown(a, b) or abs(a - b) <= digit(a, expected) for a, b in zip(expected[:2], fact[:2], strict=True)
        )
        and (
            both_unknown(expected.margin, fact.margin)
            or abs(expected.margin - fact.margin) <= fine * (1 + 1e-9)
            or (fact.margin == inf and expected.margin >= 99.99)  # printed as beyond 9999 %
        )
    )


def digit(value: float, expected: Fact) -> float:
    """Half of the last digit that is printed."""
    if expected.unit in KINDS["price"].units:
        return 0.005 * (1 + 1e-9)
    return (
        0.5 * 10.0 ** (floor(log10(abs(value))) + 1 - expected.digits) * (1 + 1e-9)
        if value and isfinite(value)
        else 0.0
    )


def both_unknown(a: float, b: float) -> bool:
    return (isnan(a) and isnan(b)) or a == b


# A kind of report: from its folder to its facts, and how well these agree with the records.
READERS: dict[str, tuple[Callable[[Path, Run], Facts], Callable[[Fact, Fact], bool]]] = {
    ".csv": (from_csv, same),
    ".xlsx": (from_xlsx, same),
    ".json": (from_json, same),
    ".pdf": (from_pdf, rounds),
    ".html": (from_html, rounds),
}


def differences(suffix: str, run: Run, folder: Path, records: Facts) -> dict[Key, tuple[Fact, Fact | None]]:
    """Where a report says other than the records, or nothing."""
    with blank_figures():  # numbers stand in words and tables
        write(run.result, run.proof, [folder / f"report{suffix}"])
    read, agree = READERS[suffix]
    facts = read(folder, run)
    return {k: (v, facts.get(k)) for k, v in records.items() if k not in facts or not agree(v, facts[k])}


# -- the runs

ROOT = Path(__file__).resolve().parents[2]


def driven(result: SizingResult) -> Validation:
    """The closed loop of the best set, of whose samples, which nobody reads here, few are kept."""
    proof = validate(result.spec, result.sets[0])
    return replace(proof, series={name: values[::50] for name, values in proof.series.items()})


@pytest.fixture(scope="module")
def runs(spec: RobotSpec, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Run]:
    paper = size(spec, top=5)
    folder = tmp_path_factory.mktemp("starters")
    hoist = size(starter("hoist", folder, ("mass: 15 kg", "mass: 900 kg")), top=3)
    arm = starter("arm", folder)
    example = ROOT / "examples" / "sps_platform.yaml"
    text = example.read_text(encoding="utf-8").replace(", mass: 2.65 kg", "")  # of unknown mass
    platform = size(read_spec(YamlSource(text, str(example))), top=3)
    wide = arm.select.model_copy(update={"catalogs": ["cubemars", "robstride", "myactuator"]})
    return {
        "paper": Run(paper, driven(paper)),
        "fails": Run(hoist, None),
        "platform": Run(platform, driven(platform)),
        "actuators": Run(size(arm.model_copy(update={"select": wide}), top=3), None),
        "unsure": Run(size(paper.spec, top=2, sampling=Sampling(256, 1, 1.0)), None),
    }


@pytest.mark.slow
@pytest.mark.parametrize("name", ["paper", "fails", "actuators", "platform", "unsure"])
@pytest.mark.parametrize("suffix", READERS)
def test_every_report_has_the_numbers_of_the_run(suffix, name, runs, tmp_path):
    records = recorded(runs[name])
    assert differences(suffix, runs[name], tmp_path, records) == {}


def test_every_kind_of_report_is_read():
    assert set(KNOWN) == set(READERS)
