"""How sure the sets are, told by every kind of report: the same numbers in all of them, as in test_same_numbers.

CSV, workbook and JSON have the same floats; what is printed for people rounds to the same. No probability is printed as
100 % where a sample fails.
"""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Callable
from dataclasses import replace
from math import floor, isclose, isfinite, log10, nan
from pathlib import Path

import openpyxl
import pytest
from lxml import html
from numbers_read import NUMBER, number, sheet, value_of, words
from pdf_text import texts_of
from printed import blank_figures

from drivesizer.files.yaml_source import YamlSource
from drivesizer.output.report import write, write_sets
from drivesizer.output.words import likely, moved
from drivesizer.results.check import Reliability
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.sizing import SizingResult
from drivesizer.search.uncertainty.options import Sampling
from drivesizer.sizing import size
from drivesizer.spec.robot import read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

Key = tuple[object, ...]  # (rank, figure), (rank, check, figure), ("driver", figure, which)
Numbers = dict[Key, float]  # shares of 1
QUANTILES = ("5", "50", "95")
PRINTED = 12  # checks that a page has; files for programs have all


@pytest.fixture(scope="module")
def result(example_text: str) -> SizingResult:
    """Some sets that are sure enough, driven in closed loop, one of them nearly certain, and some that are not."""
    text = example_text[: example_text.index("select:")].replace("method: paper", "method: physics")
    text = text.replace("mass: 45 kg ", "mass: 45 kg +- 3 kg ")
    text = text.replace("rolling_resistance: 0.02 ", "rolling_resistance: 0.02 in 0.015..0.03 ")
    spec = read_spec(YamlSource(text + "select: {motor: {family: [DCX 22 S, RE 30]}}\n", "robot.yaml"))
    found = size(spec, top=2, sampling=Sampling(512, 1, 0.5, loop=8))
    best = found.sets[0]
    nearly = replace(best, reliability=replace(of(best), probability=0.99996))
    return replace(found, sets=(nearly, *found.sets[1:]))


def sampled(result: SizingResult) -> list[DriveSet]:
    return [*result.sets, *result.unsure]


def of(one: DriveSet) -> Reliability:
    assert one.reliability
    return one.reliability


# -- what the records say


def recorded(result: SizingResult) -> Numbers:
    found: Numbers = {}
    for one in sampled(result):
        sure = of(one)
        found |= {(one.rank, "probability"): sure.passing, (one.rank, "error"): sure.error}
        found |= {(one.rank, "5"): sure.low, (one.rank, "50"): sure.middle}
        if sure.loop:
            found |= {(one.rank, "loop"): sure.loop.passing, (one.rank, "loop error"): sure.loop.error}
    best = result.sets[0]
    for check in moved(of(best))[:PRINTED]:
        found[best.rank, check.title, "passes"] = check.passes
        for quantile, margin in zip(QUANTILES, (check.low, check.middle, check.high), strict=True):
            if isfinite(margin):
                found[best.rank, check.title, quantile] = margin
    for driver in of(best).drivers[:3]:
        found["driver", driver.title, "share"] = driver.share
        found |= {("driver", driver.title, "low"): driver.low_margin}
        found |= {("driver", driver.title, "high"): driver.high_margin}
    return found


# -- readers


def rows_of(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(path.read_text(encoding="utf-8"))))


def from_csv(folder: Path, result: SizingResult) -> Numbers:
    names = {"all_checks": "probability", "error_95": "error", "closed_loop": "loop",
             "closed_loop_error_95": "loop error"}  # fmt: skip
    titles = {driver.name: driver.title for driver in of(result.sets[0]).drivers}
    found: Numbers = {}
    for row in rows_of(folder / "report.csv"):
        if row["section"] == "reliability":
            rank, margins = int(row["set_rank"]), {q: number(row[f"margin_{q}"]) for q in QUANTILES}
            if name := names.get(row["name"]):
                found |= {(rank, name): number(row["si_value"])} | {(rank, q): m for q, m in margins.items() if m == m}
            title = row["title"].removeprefix("Passes: ")
            found |= {(rank, title, "passes"): number(row["si_value"])}
            found |= {(rank, title, q): m for q, m in margins.items()}
        elif row["section"] == "driver" and row["set_rank"] == "1":
            which = {"share_of_variance": "share", "smallest_margin_at_5": "low", "smallest_margin_at_95": "high"}
            value = row["si_value"] or row["margin"]
            found["driver", titles[row["case"]], which.get(row["name"], row["name"])] = number(value)
    return found


def from_sets_csv(folder: Path, result: SizingResult) -> Numbers:
    heads = {"probability": "probability", "error": "probability_error_95", "5": "smallest_margin_5",
             "50": "smallest_margin_50", "loop": "closed_loop_probability",
             "loop error": "closed_loop_error_95"}  # fmt: skip
    names = {check.title: check.name for check in of(result.sets[0]).checks}
    found: Numbers = {}
    for row in rows_of(folder / "sets.csv"):
        if row["list"] not in ("set", "unsure"):
            continue
        rank = int(row["rank"])
        found |= {(rank, name): number(row[head]) for name, head in heads.items()}
        for title, name in names.items():
            found[rank, title, "passes"] = number(row[f"passes_{name}"])
            found |= {(rank, title, q): number(row[f"margin_{q}_{name}"]) for q in QUANTILES}
    return found | drivers_of_the_records(result)  # one row a set has no place for them


def drivers_of_the_records(result: SizingResult) -> Numbers:
    return {key: value for key, value in recorded(result).items() if key[0] == "driver"}


def from_xlsx(folder: Path, result: SizingResult) -> Numbers:
    book = openpyxl.load_workbook(folder / "report.xlsx")
    heads = {"5": "margin that 95 % exceed (%)", "50": "median margin (%)", "95": "margin that 5 % exceed (%)"}
    whole = {"probability": "all pass (%)", "error": "error, 95 % (%)", "loop": "all pass in closed loop (%)",
             "loop error": "its error, 95 % (%)"}  # fmt: skip
    found: Numbers = {}
    for row in sheet(book, "Tolerances"):
        found |= {(row["drive"], name): number(row[head]) for name, head in (whole | heads).items()}
    for row in sheet(book, "Tolerance checks"):
        of_a_check = heads | {"passes": "passes (%)"}
        found |= {(row["drive"], row["check"], name): number(row[head]) for name, head in of_a_check.items()}
    written = {driver.title.split(" ")[0]: driver.title for driver in of(result.sets[0]).drivers if "." in driver.title}
    for row in sheet(book, "Uncertain figures"):
        title = written.get(row["figure"], f"{row['figure']} {row['tolerance']}")
        which = {"share": "share of variance (%)", "low": "smallest margin at low (%)",
                 "high": "smallest margin at high (%)"}  # fmt: skip
        if row["drive"] == 1:
            found |= {("driver", title, name): number(row[head]) for name, head in which.items()}
    return found


def from_json(folder: Path, result: SizingResult) -> Numbers:
    document = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    titles = {check.name: check.title for check in of(result.sets[0]).checks}
    names = {driver.name: driver.title for driver in of(result.sets[0]).drivers}
    found: Numbers = {}
    for one in (*document["sets"], *document["unsure"]):
        rank, sure = one["rank"], one["reliability"]
        found |= {(rank, "probability"): sure["probability"], (rank, "error"): sure["error_95"]}
        found |= {(rank, q): number(sure["smallest_margin"][f"p{q}"]) for q in QUANTILES}
        if loop := sure["closed_loop"]:
            found |= {(rank, "loop"): loop["probability"], (rank, "loop error"): loop["error_95"]}
        for check in sure["checks"]:
            found[rank, titles.get(check["name"]), "passes"] = check["passes"]
            found |= {(rank, titles.get(check["name"]), q): number(check["margin"][f"p{q}"]) for q in QUANTILES}
    for one in document["sets"][0]["reliability"]["drivers"]:
        title = names[one["name"]]
        found["driver", title, "share"] = one["share_of_variance"]
        found["driver", title, "low"] = number(one["at_p5"]["smallest_margin"])
        found["driver", title, "high"] = number(one["at_p95"]["smallest_margin"])
    return found


def from_pdf(folder: Path, result: SizingResult) -> Numbers:
    return from_text(" ".join(texts_of((folder / "report.pdf").read_bytes())), result)


def from_html(folder: Path, result: SizingResult) -> Numbers:
    page = html.parse(folder / "report.html").getroot()
    for script in page.xpath("//script | //style"):
        script.drop_tree()
    return from_text(" ".join(page.itertext()), result)


def from_text(text: str, result: SizingResult) -> Numbers:
    """The numbers of a report for people, by the names beside which they stand."""
    text = re.sub(r"\s+", " ", text).replace("\u200b", "")
    share, found = rf"({NUMBER}) %", {}
    for one in sampled(result):
        pattern = rf"{one.rank} {words(one.label)} {share} ± {share} [^%]*?{share} {share}(?: {share} ± {share})?"
        match = re.search(pattern, text)
        assert match, one.label
        names = ("probability", "error", "5", "50", "loop", "loop error")
        found |= {(one.rank, name): value_of(digits) / 100.0 for name, digits in zip(names, match.groups(), strict=True)
                  if digits}  # fmt: skip
    told = text[text.index("that samples change") :]
    for check in moved(of(result.sets[0]))[:PRINTED]:
        match = re.search(rf"{words(check.title)} {share} " + " ".join([rf"(?:{share}|–)"] * 3), told)
        assert match, check.title
        numbers = [nan if digits is None else value_of(digits) / 100.0 for digits in match.groups()]
        found |= {(1, check.title, name): n for name, n in zip(("passes", *QUANTILES), numbers, strict=True)}
    for driver in of(result.sets[0]).drivers[:3]:
        match = re.search(rf"{words(driver.title)} {share} {share} at .{{1,20}}? {share} at ", told)
        assert match, driver.title
        for name, digits in zip(("share", "low", "high"), match.groups(), strict=True):
            found["driver", driver.title, name] = value_of(digits) / 100.0
    return found


# -- how well they must agree


def same(key: Key, expected: float, told: float) -> bool:
    return isclose(expected, told, rel_tol=1e-15)


def rounds(key: Key, expected: float, told: float) -> bool:
    """Probabilities to the digit that ``likely`` has, errors to two digits, shares to the per cent, margins as ever."""
    if key[-1] in ("probability", "loop", "passes"):
        return likely(expected) == likely(told)
    if key[-1] in ("error", "loop error"):
        fine = 0.5 * 10.0 ** (floor(log10(expected)) - 1)
    elif key[-1] == "share":
        fine = 0.005
    else:
        fine = 0.0005 if abs(expected) < 0.0995 else 0.005
    return abs(expected - told) <= fine * (1.0 + 1e-9)


Reader = Callable[[Path, SizingResult], Numbers]
READERS: dict[str, tuple[Reader, Callable[[Key, float, float], bool]]] = {
    "report.csv": (from_csv, same),
    "sets.csv": (from_sets_csv, same),
    "report.xlsx": (from_xlsx, same),
    "report.json": (from_json, same),
    "report.pdf": (from_pdf, rounds),
    "report.html": (from_html, rounds),
}


def differences(name: str, result: SizingResult, folder: Path, records: Numbers) -> set[Key]:
    if name == "sets.csv":
        write_sets(result, folder / name)
    else:
        with blank_figures():  # numbers stand in words and tables
            write(result, None, [folder / name])
    read, agree = READERS[name]
    told = read(folder, result)
    return {key for key, value in records.items() if key not in told or not agree(key, value, told[key])}


@pytest.mark.slow
@pytest.mark.parametrize("name", READERS)
def test_every_report_has_the_probabilities_of_the_run(name: str, result: SizingResult, tmp_path: Path) -> None:
    records = recorded(result)
    assert len(result.sets) == 2 and len(result.unsure) == 2
    assert {key[-1] for key in records} >= {"probability", "loop", "passes", "share", "low", "high", *QUANTILES}
    assert differences(name, result, tmp_path, records) == set()
    if name == "report.xlsx":  # no probability is rounded up to certainty
        page = openpyxl.load_workbook(tmp_path / name)["Tolerances"]
        assert page["D2"].value == 0.99996 and page["D2"].number_format == "0.000 %"
    if name in ("report.pdf", "report.html"):
        assert likely(READERS[name][0](tmp_path, result)[1, "probability"]) == "99.996 %"


@pytest.mark.parametrize("name", READERS)
def test_a_probability_that_differs_is_found(name: str, result: SizingResult, tmp_path: Path) -> None:
    best, other = result.sets[0], result.unsure[0]
    sure = of(best)
    check = moved(sure)[0]
    off = replace(check, passes=check.passes - 0.002, middle=check.middle + 0.02)
    moved_ = replace(sure, low=sure.low + 0.02, checks=tuple(off if one is check else one for one in sure.checks))
    less = replace(of(other), probability=of(other).probability - 0.002)
    changed = replace(result, sets=(replace(best, reliability=moved_), *result.sets[1:]),
                      unsure=(replace(other, reliability=less), *result.unsure[1:]))  # fmt: skip
    assert differences(name, changed, tmp_path, recorded(result)) == {
        (1, "5"), (1, check.title, "passes"), (1, check.title, "50"), (other.rank, "probability"),
    }  # fmt: skip
