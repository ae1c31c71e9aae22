"""The site: built with warnings fatal, nothing from elsewhere, and what it says of the program is so.

Tables that people wrote are held against the program's own records; what hooks make is held against another way to it.
"""

from __future__ import annotations

import doctest
import html
import json
import math
import os
import re
import sys
import unicodedata
from html.parser import HTMLParser
from pathlib import Path

import pytest

from drivesizer import contract, contract_driving, formula, size, validate
from drivesizer.checks import TITLES
from drivesizer.declare import COMPANIONS, EQUATIONS
from drivesizer.driving import driving
from drivesizer.equations import nominal_speed
from drivesizer.following_runs import follow_all
from drivesizer.platform import notation, printed
from drivesizer.platform.notation import PLATFORM
from drivesizer.sizing import explain
from drivesizer.spec import RobotSpec, read_spec
from drivesizer.yaml_source import YamlSource

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
sys.path[:0] = [str(DOCS), str(DOCS / "hooks")]

from blocks import blocks  # noqa: E402

mathematics = pytest.importorskip("mathematics", reason="the documentation's own packages are not installed")
EVERY = [*EQUATIONS.values(), *COMPANIONS.values()]
MATRICES = [PLATFORM[number] for number in sorted(PLATFORM)]


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The site as `mkdocs build --strict` makes it: a warning ends it."""
    os.environ["NO_MKDOCS_2_WARNING"] = "1"
    from mkdocs.commands.build import build
    from mkdocs.config import load_config

    folder = tmp_path_factory.mktemp("site")
    build(load_config(str(ROOT / "mkdocs.yml"), strict=True, site_dir=str(folder)))
    return folder


def page(name):
    return (DOCS / f"{name}.md").read_text(encoding="utf-8")


def rows(text, heading, first=r"\|"):
    """Rows of the first table below a heading whose own head starts so."""
    table = re.search(rf"^{first}.*\n(?:\|.*\n)+", text.split(f"\n{heading}\n", 1)[1], re.MULTILINE)[0]
    found = [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in table.splitlines()]
    return found[2:]


def test_the_examples_of_the_hooks():
    import docstrings
    import matrices

    for module in (mathematics, docstrings, matrices):
        found = doctest.testmod(module)
        assert found.attempted and not found.failed


# --- the site as a whole


class Loads(HTMLParser):
    """Addresses that a page fetches by itself; links that a reader may follow are none."""

    def __init__(self):
        super().__init__()
        self.found, self.ids = [], set()

    def handle_starttag(self, tag, attributes):
        named = dict(attributes)
        self.ids.add(named.get("id"))
        if tag in ("script", "img", "iframe", "source", "video", "audio", "embed", "use"):
            self.found.append(named.get("src") or named.get("href") or "")
        if tag == "link" and named.get("rel") not in ("canonical", "next", "prev"):
            self.found.append(named.get("href", ""))


def test_nothing_comes_from_elsewhere(site):
    pages = sorted(site.glob("*.html"))
    assert len(pages) >= 23
    for path in pages:
        seen = Loads()
        seen.feed(path.read_text(encoding="utf-8"))
        for address in filter(None, seen.found):
            assert not re.match(r"(?:https?:)?//", address), f"{path.name}: {address}"
            assert (site / address.lstrip("/").split("?")[0].split("#")[0]).exists(), f"{path.name}: {address}"
    for path in (site / "assets").rglob("*.css"):
        assert not re.search(r"url\(\s*['\"]?(?:https?:)?//", path.read_text(encoding="utf-8")), path.name
    assert (site / "assets" / "stix-two-math.woff").read_bytes()[:4] == b"wOFF"


def test_every_formula_is_mathematics(site):
    for path in site.glob("*.html"):
        text = path.read_text(encoding="utf-8")
        assert "arithmatex" not in text, path.name
        outside = re.sub(r"(?s)<(pre|code|script|math|style)\b.*?</\1>", "", text)
        assert not re.search(r"\$[^$\n]{1,80}\$|\\[a-z]{2,}\{|\\\(", outside), path.name
    assert "<merror" not in "".join(p.read_text(encoding="utf-8") for p in site.glob("*.html"))


def test_the_project_s_own_files_are_pages(site):
    for name in ("architecture", "contributing", "changelog"):
        assert (site / f"{name}.html").exists()


# --- equations


def signs(text):
    """The letters and digits of a formula in their order, however it is set."""
    plain = html.unescape(re.sub(r"<[^>]+>", "", text)).translate(str.maketrans("²³", "23", " /√()·^_\u2062"))
    return re.sub(r"\s", "", plain.replace("−", "-").replace("\u200a", ""))


@pytest.mark.parametrize("declared", EVERY, ids=lambda e: e.name)
def test_an_equation_on_the_page_is_the_one_at_the_terminal(declared):
    """Another notation of the same syntax tree: what is read from left to right and from top to bottom is the same."""
    for form, paper in ((formula.computed(declared), False), (declared.printed, True)):
        if form:
            made = mathematics.mathml(mathematics.expression(form, paper=paper), "block")
            assert signs(made) == signs(formula.text(form, paper=paper))
            assert made.count("<mfrac>") >= (1 if "/" in form and "1 / 2" not in form else 0)
            assert made.count("<msqrt>") == form.count("sqrt(") + form.count("(1 / 2)")


def test_fractions_stand_as_they_are_written():
    fraction = mathematics.expression
    assert fraction("a / b / c") == r"\frac{a}{b\,c}"
    assert fraction("a / (b / c)") == r"\frac{a}{b}\,c"
    assert fraction("a * (b + c) / d") == r"\frac{a\,\left(b + c\right)}{d}"
    assert fraction("a - (b - c)") == r"a - \left(b - c\right)"
    assert fraction("(a + b) * (2 * c / d) * e") == r"\left(a + b\right)\,\frac{2\,c}{d}\,e"
    assert fraction("(a + b)**2 / 2") == r"\frac{\left(a + b\right)^{2}}{2}"


def bare(text):
    """The same of an equation between vectors: without brackets and commas, accents behind their letter."""
    plain = html.unescape(re.sub(r"<[^>]+>", "", text)).replace("⁻¹", "-1").replace("sum", "∑")
    plain = unicodedata.normalize("NFD", plain)
    accents = str.maketrans({"˙": "\u0307", "¨": "\u0308", "¯": "\u0304", "ᵀ": "T", "⁺": "+"} | dict.fromkeys("[];,"))
    return signs(plain.translate(accents)).translate(accents)


@pytest.mark.parametrize("declared", MATRICES, ids=lambda e: str(e.number))
def test_an_equation_of_the_platform_on_the_page_is_the_one_at_the_terminal(declared):
    import matrices

    left = declared.printed_symbol or declared.symbol
    for side, form in ((left, declared.printed), (declared.symbol, notation.computed(declared))):
        made = mathematics.mathml(matrices.equation(side, form), "block")
        side, _, vector = side.partition("] / ")  # what stands on the left as divided by a vector is multiplied by it
        right = notation.text(form)
        if form.startswith("array") and " / " in form.rsplit(")", 1)[-1]:  # and a matrix by one over what divides it
            whole, _, below = right.rpartition(" / ")
            right = f"1 / {below} {whole}"
        assert bare(made) == bare(f"{side} = {right} {vector}")
        rows = 1 + right.count("; ") if "[" in right.replace("[T]", "") else 0
        assert made.count("<mtr>") >= rows and "merror" not in made


def test_a_vector_is_a_column_and_what_a_vector_is_multiplied_with_a_row():
    import matrices

    column, row = (mathematics.mathml(matrices.expression(form)) for form in ("array([a, b])", "array([a, b]) @ c"))
    assert (column.count("<mtr>"), row.count("<mtr>"), row.count("<mtd>")) == (2, 1, 2)
    assert mathematics.mathml(matrices.expression("array([[a, b, c], [a, b, c]])")).count("<mtr>") == 2


def test_every_equation_of_the_platform_is_on_the_page_with_its_units(site):
    text = (site / "equations.html").read_text(encoding="utf-8")
    seen = Loads()
    seen.feed(text)
    assert sorted(PLATFORM) == list(range(21, 60))
    for declared in MATRICES:
        assert f"eq-{declared.number}" in seen.ids
        part = text.split(f'id="eq-{declared.number}"', 1)[1].split("<h3", 1)[0]
        for term in (*declared.terms, declared.result):
            assert html.escape(term.meaning, quote=False) in part
            assert term.unit.replace("*", "·").replace("^2", "²") in part
        assert ("Fails the value check" in part) == bool(printed.finding(declared).values)
    assert text.count("Fails the value check") == 5


def test_every_equation_is_on_the_page_with_its_units(site):
    text = (site / "equations.html").read_text(encoding="utf-8")
    seen = Loads()
    seen.feed(text)
    for declared in EVERY:
        anchor = f"eq-{declared.number}" if declared.number else declared.name.replace("_", "-")
        assert anchor in seen.ids
        assert all(html.escape(term.meaning, quote=False) in text for term in declared.terms)
    assert text.count("Fails the unit check") == sum(bool(formula.printed_failure(e)) for e in EVERY) == 2


def test_the_page_of_the_paper_names_what_fails():
    told = rows(page("paper"), "## Where the printed form cannot be followed")
    numbers = [int(n) for row in told for n in re.findall(r"\((\d+)\)", row[0])]
    assert numbers == [e.number for e in EVERY if formula.printed_failure(e)]


def test_the_page_of_the_paper_names_what_fails_of_the_platform():
    told = rows(page("paper"), "### The platform's printed form")
    numbers = [int(n) for row in told for n in re.findall(r"\(#?(\d+)\)\]", row[0])]
    assert numbers == [e.number for e in MATRICES if any(printed.finding(e))]
    assert not any(printed.finding(e).units for e in MATRICES)


@pytest.mark.parametrize(("reserve", "chosen"), [(0.69, None), (0.70, 27), (0.90, 27), (0.91, 35)])
def test_the_choice_of_the_paper_hangs_on_its_speed_reserve(reserve, chosen):
    """Of the reductions 3249/121 and 34.977 the larger that turns the gearhead's input at 8000 rpm at most."""
    assert "any from 0.70 to 0.90 gives 27:1" in page("paper")
    wheel = nominal_speed(1.5, 0.1524, reserve) * 30.0 / math.pi
    allowed = [name for name, ratio in ((27, 3249 / 121), (35, 34.977)) if wheel * 1.1 * ratio <= 8000.0]
    assert max(allowed, default=None) == chosen


# --- what the program checks and figures out


def test_every_limit_of_the_physics_is_on_its_page():
    told = {row[0] for row in rows(page("physics"), "## Limits")}
    beside = {TITLES["physics"][name] for name in ("compatibility", "controller_available")}
    assert told == set(TITLES["physics"].values()) - beside
    assert all(f"*{title}*" in page("physics") for title in beside)


MACHINES = {
    "voltage": "",
    "cascade": "control: {structure: cascade, velocity: {bandwidth: 20 Hz}, position: {}}\nneeds: {bandwidth: 5 Hz}\n",
    "soft": "plant: {model: two_mass, stiffness: 3000 N*m/rad}\nmission: {duration: 60 s}\n",
}


@pytest.fixture(scope="module")
def proofs():
    """Closed loops that have all kinds of checks and figures between them."""
    (text,) = (b.text for b in blocks(page("validation")) if b.title == "robot.yaml")
    bare = re.sub(r"(?ms)^(?:control|mission|cases):.*?(?=^\w|\Z)", "", text)
    bare = bare.replace("rolling_resistance: 2 %", "rolling_resistance: 2 %\n  friction_coefficient: 0.6")
    specs = [read_spec(YamlSource(bare + more, "x.yaml")) for more in MACHINES.values()]
    chosen = size(specs[0], top=1).sets[0]
    return [validate(spec, chosen) for spec in specs]


def test_every_check_and_figure_of_the_closed_loop_is_on_its_page(proofs):
    text = page("validation")
    checks = " | ".join(row[0] for row in rows(text, "## Checks and figures"))
    figures = " | ".join(row[0] for row in rows(text, "## Checks and figures", r"\| figure"))
    for proof in proofs:
        for check in proof.checks:
            assert check.title in checks, check.title
        for figure in proof.figures:
            first, _, rest = figure.title.partition(", ")
            assert first in figures and rest.split(", ")[-1] in figures, figure.title


# --- the platform, the battery, the machine


def test_every_budget_check_is_on_its_page():
    told = {row[0] for name in ("battery", "budgets") for row in rows(page(name), "## What is compared")}
    assert told == set(TITLES["budget"].values())


def test_what_is_read_out_of_the_runs_is_in_the_tables(site):
    """Every figure of the reading is one of the table's, and what is said of them holds."""
    text = page("platform")
    reading = text.split("How we read it:", 1)[1].split("![Path", 1)[0]
    figures = {m[0] for m in re.finditer(r"[\d.]+ m\b", reading)}
    built = (site / "platform.html").read_text(encoding="utf-8").replace("\u00a0", " ").replace("&nbsp;", " ")
    table = (
        built.split("real robot, measured", 1)[0].rsplit("<table>", 1)[1] + built.split("real robot, measured", 2)[2]
    )
    cells = [re.findall(r"<td>(.*?)</td>", row) for row in table.split("</table>", 1)[0].split("<tr>")[1:]]
    at = {tuple(row[:4]): float(row[4].removesuffix(" m")) for row in cells if len(row) == 6}
    assert len(figures) == 8 and figures <= {f"{value:g} m" for value in at.values()}
    P, PI, known, off = ("P", "open loop"), ("PI", "open loop"), "all", "not its errors"
    assert round(at["kinematic", *P, known] / at["dynamic", *P, known]) == 14
    for loops, knows in ((PI, known), (PI, off), (P, off)):
        assert abs(at["kinematic", *loops, knows] / at["dynamic", *loops, knows] - 1.0) < 0.2
    assert max(value for key, value in at.items() if key[2] == "fed back") < 0.005
    assert "2.78 m" in built and "5.1 °" in built and "0.89 m" in built and "0.45 °" in built


def test_what_a_radius_comes_to_straight_ahead():
    lever = 0.27406 * (math.cos(math.radians(29.5)) + math.sin(math.radians(29.5)))
    assert f"{math.degrees(0.001 / (4 * lever) * 90):.1f}°" == "3.5°"
    assert "90 m straight ahead would make it 3.5°" in page("platform")


AMOUNTS = {  # what the page says, and the line of the test that says it
    "8 mrad/s of 470 rad/s": ("mujoco", "< 8e-3  # rad/s of up to 470"),
    "10 µA of 4.3 A": ("mujoco", "< 1e-5  # A of up to 4.3"),
    "12 mrad/s and 1 mA RMS over a second": ("mujoco", "strayed[0] < 0.012 and strayed[1] < 1e-3"),
    "0.08 rad/s at the reversal": ("mujoco", "abs=0.08)"),
    "0.45 rad/s of 380": ("mujoco", "off(fine, s)[0] < 0.45"),
    "0.4 mrad/s; no motion below": ("mujoco", "abs=4e-4)"),
    "0.6 mrad/s of 290 rad/s": ("solvers", "[(0.0, {}, 6e-4),"),
    "energy to 1e-5": ("solvers", "pytest.approx(electrical, rel=1e-5)"),
    "0.06 rad/s": ("solvers", '{"gap": 0.01}, 0.06)]'),
    "0.6 mrad/s; 5 µA": ("controllers", "[(0.0, {}, 6e-4, 5e-6)"),
    "before the reversal 3e-6": ("controllers", "before.max() < 3e-6"),
    "1e-8 rad/s of 8": ("linear", "abs=1e-8)  # rad/s of 8"),
    "1e-10 rad": ("linear", "abs=1e-10)  # rad"),
    "to 4 % of that": ("linear", "pytest.approx([2.0] * 3, abs=0.08)"),
    "1e-6 of what is turned over": ("itself", "abs=1e-6 * turned_over"),
}


@pytest.mark.parametrize("said", AMOUNTS)
def test_amounts_of_the_page_are_those_of_the_tests(said):
    name, line = AMOUNTS[said]
    assert said in page("validation")
    assert line in (ROOT / "tests" / f"test_against_{name}.py").read_text(encoding="utf-8")


FURTHER = {  # of other pages
    ("platform", "0.3 %, and half of that at half the step"): (
        "platform_mujoco",
        "assert fine < 0.006  # N*m, of 2.08: 0.3 %",
    ),
    ("platform", "the paper's robot, to 1e-12"): ("platform_kinematics", "pytest.approx(by_hand, rel=1e-12) == k.E"),
    ("platform", "on a slope: to 1e-12"): (
        "platform_dynamics",
        "np.broadcast_to(cycle.torque, torques.shape), rel=1e-12",
    ),
    ("platform", "a platform that coasts: 1e-9"): ("platform_dynamics", "pytest.approx(kept[0], rel=1e-9)"),
    ("platform", "while it slips: 1e-5"): ("platform_slip", "found.imbalance < 1e-5"),
    ("platform", "arc by radii apart: 0.3 % and better"): (
        "platform_following",
        "heading_by_lever(0.03, 2.0), rel=3e-3)",
    ),
    ("platform", "times of planned ways: 1e-8"): (
        "platform_planner",
        "by_hand_s_curve(way, 1.2, 0.8, jerk), rel=1e-8)",
    ),
    ("battery", "-15 to +4 %, half of them within 3 %"): ("battery_pack", "assert mean.min() > -0.15"),
    ("battery", "of one battery 24 %"): ("battery_pack", '("SW12140E", -0.24, -0.16)'),
    ("battery", "0.1 µV"): ("battery", "right, abs=1e-7"),
    ("battery", "3 h 15 min: 74 W"): ("battery_budget", "printed = 24 * 3.55 * (3 / 3.25) ** (1 / slope) * 7.0 / 7.58"),
}


@pytest.mark.parametrize("said", FURTHER, ids=lambda said: f"{said[0]}: {said[1]}")
def test_amounts_of_other_pages_are_those_of_the_tests(said):
    name, line = FURTHER[said]
    assert said[1] in page(said[0])
    assert line in (ROOT / "tests" / f"test_{name}.py").read_text(encoding="utf-8")


# --- the spec, the loads, JSON


def test_every_field_of_a_spec_is_on_a_page(site):
    text = "".join((site / f"{name}.html").read_text(encoding="utf-8") for name in ("spec", "loads"))
    shown = set(re.findall(r"<code>(\w+)</code>", text))
    models = {"RobotSpec": RobotSpec.model_json_schema(), **RobotSpec.model_json_schema()["$defs"]}
    for name, model in models.items():
        lacking = set(model["properties"]) - shown - {"kind", "profile"}
        assert not lacking, f"{name}: {lacking}"


TYPES = {"string": str, "integer": int, "number": (int, float), "boolean": bool, "array": list, "object": dict}
RECORDS = {  # heading: where such a record is in a document
    "Sizing": lambda sizing, proof: [sizing],
    "Set": lambda sizing, proof: [*sizing["sets"], *sizing["misses"], proof["set"]],
    "Requirement": lambda sizing, proof: [
        requirement for part in (sizing, sizing["sets"][0]) for requirement in part["requirements"].values()
    ],
    "Check": lambda sizing, proof: [*sizing["sets"][0]["checks"], *proof["checks"]],
    "Figure": lambda sizing, proof: [*proof["figures"].values(), *proof["set"]["figures"].values()],
    "Change": lambda sizing, proof: sizing["explained"]["changes"],
    "Validation": lambda sizing, proof: [proof],
    "Loop": lambda sizing, proof: proof["loops"],
}
DRIVEN = {
    "Drive": lambda driven: [driven],
    "Wheel": lambda driven: driven["wheels"],
    "Run": lambda driven: [*driven["following"].values()],
}


@pytest.fixture(scope="module")
def documents(spec, catalog, proofs):
    """Of a sizing with misses and changes, and of a closed loop."""
    result = size(spec, catalog=catalog)
    document = json.loads(contract.as_text(contract.sizing(result)))
    fallen = spec.model_copy(update={"method": "physics"})
    heavy = fallen.model_copy(update={"load": fallen.load.model_copy(update={"mass": 300.0})})
    found = explain(heavy, "118752", "406764", catalog=catalog)[0]
    document["explained"] = json.loads(contract.as_text(contract.drive_set(found)))
    assert document["misses"] and document["explained"]["changes"]
    return document, json.loads(contract.as_text(contract.validation(proofs[1])))


@pytest.fixture(scope="module")
def driven():
    """Of the platform of the page on the first metres of a way, followed and not."""
    (text,) = (b.text for b in blocks(page("platform")) if b.title == "robot.yaml")
    motion = "motion: {waypoints: [{x: 0 m, y: 0 m, heading: 0 deg}, {x: 1 m, y: 1 m, heading: 30 deg}]}"
    spec = read_spec(YamlSource(re.sub(r"(?m)^motion:.*$", motion, text), "x.yaml"))
    found = driving(spec)
    return [
        json.loads(contract.as_text(contract_driving.driving(found, None, runs)))
        for runs in ({}, follow_all(found, None))
    ]


@pytest.mark.parametrize("heading", DRIVEN)
def test_the_tables_of_a_driven_platform_are_the_document(driven, heading):
    held_against_the_page(heading, [record for document in driven for record in DRIVEN[heading](document)])


@pytest.mark.parametrize("heading", RECORDS)
def test_the_tables_of_the_json_page_are_the_documents(documents, heading):
    held_against_the_page(heading, RECORDS[heading](*documents))


def held_against_the_page(heading, found):
    """A table has the keys of all records, and their types."""
    told = {row[0].strip("`"): row[1] for row in rows(page("json"), f"## {heading}")}
    assert found
    for record in found:
        assert set(record) - {"explained"} == set(told), heading
        for key, said in told.items():
            kinds = [kind for kind in said.split(" or ") if kind != "null"]
            value = record[key]
            fits = any(
                isinstance(value, TYPES[kind]) and isinstance(value, bool) == (kind == "boolean") for kind in kinds
            )
            assert fits or (value is None and "null" in said), f"{heading}.{key}: {value!r}"
