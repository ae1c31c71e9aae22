"""The site: built with warnings fatal, nothing from elsewhere, and what it says of the program is so.

Tables that people wrote are held against the program's own records, generated parts against another way to them.
"""

from __future__ import annotations

import doctest
import html
import math
import os
import re

import pytest
from docs_pages import ROOT, Loads, bare, blocks, page, rows, signs

from drivesizer import size, validate
from drivesizer.equations import nominal_speed
from drivesizer.files.yaml_source import YamlSource
from drivesizer.output import derivation
from drivesizer.physics.equation import COMPANIONS, EQUATIONS
from drivesizer.platform import robot_figures
from drivesizer.platform.equations import PLATFORM
from drivesizer.platform.equations import text as form_text
from drivesizer.results.check_kinds import CHECKS
from drivesizer.spec.robot import RobotSpec, read_spec

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


def test_the_examples_of_the_pages_own_modules():
    import docstrings
    import latex
    import matrices

    for module in (latex, docstrings, matrices):
        found = doctest.testmod(module)
        assert found.attempted and not found.failed


# --- the site as a whole


@pytest.mark.slow
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


@pytest.mark.slow
def test_every_formula_is_mathematics(site):
    for path in site.glob("*.html"):
        text = path.read_text(encoding="utf-8")
        assert "arithmatex" not in text, path.name
        outside = re.sub(r"(?s)<(pre|code|script|math|style)\b.*?</\1>", "", text)
        assert not re.search(r"\$[^$\n]{1,80}\$|\\[a-z]{2,}\{|\\\(", outside), path.name
    assert "<merror" not in "".join(p.read_text(encoding="utf-8") for p in site.glob("*.html"))


@pytest.mark.slow
def test_the_project_s_own_files_are_pages(site):
    for name in ("architecture", "contributing", "changelog"):
        assert (site / f"{name}.html").exists()


# --- equations


@pytest.mark.slow
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
        assert ("Fails the value check" in part) == bool(robot_figures.finding(declared).values)
    assert text.count("Fails the value check") == 5


@pytest.mark.slow
def test_every_equation_is_on_the_page_with_its_units(site):
    text = (site / "equations.html").read_text(encoding="utf-8")
    seen = Loads()
    seen.feed(text)
    for declared in EVERY:
        anchor = f"eq-{declared.number}" if declared.number else declared.name.replace("_", "-")
        assert anchor in seen.ids
        assert all(html.escape(term.meaning, quote=False) in text for term in declared.terms)
    assert text.count("Fails the unit check") == sum(bool(derivation.printed_failure(e)) for e in EVERY) == 2


def test_the_page_of_the_paper_names_what_fails():
    told = rows(page("paper"), "## Where the printed form cannot be followed")
    numbers = [int(n) for row in told for n in re.findall(r"\((\d+)\)", row[0])]
    assert numbers == [e.number for e in EVERY if derivation.printed_failure(e)]


@pytest.mark.parametrize(("reserve", "chosen"), [(0.706, 27), (0.904, 27), (0.905, 35)])
def test_the_choice_of_the_paper_hangs_on_its_speed_reserve(reserve, chosen):
    """Of the reductions 3249/121 and 34.977 the larger that turns the gearhead's input at 8000 rpm at most."""
    assert "**0.706 to 0.904**" in page("paper")
    wheel = nominal_speed(1.5, 0.1524, reserve) * 30.0 / math.pi
    allowed = [name for name, ratio in ((27, 3249 / 121), (35, 34.977)) if wheel * 1.1 * ratio <= 8000.0]
    assert max(allowed, default=None) == chosen


# --- what the program checks and figures out


def test_every_limit_of_the_physics_is_on_its_page():
    told = {row[0] for row in rows(page("physics"), "## Limits")}
    beside = {CHECKS["physics"][name].title for name in ("compatibility", "controller_available")}
    assert told == {declared.title for declared in CHECKS["physics"].values()} - beside
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


def test_every_check_and_figure_of_the_open_loop_is_on_its_page():
    text = page("steppers")
    checks = " | ".join(row[0] for row in rows(text, "## Lost steps", r"\| check"))
    for declared in CHECKS["open loop"].values():
        assert declared.title in checks
    printed = text.split("Figures of the open loop", 1)[1].split("```", 1)[0]
    figures = " | ".join(row[0] for row in rows(text, "## Lost steps", r"\| figure"))
    for first in ("Full steps lost, largest", "Load angle left", "Position error at the load", "Motor torque, peak"):
        assert first in figures and first in printed


def test_every_check_and_figure_of_the_closed_loop_is_on_its_page(proofs):
    text = page("validation")
    checks = " | ".join(row[0] for row in rows(text, "## Checks and figures"))
    figures = " | ".join(row[0] for row in rows(text, "## Checks and figures", r"\| figure"))
    for proof in proofs:
        for check in proof.checks:
            assert check.title.removesuffix(" (advice)") in checks, check.title
        for figure in proof.figures:
            first, _, rest = figure.title.partition(", ")
            assert first in figures and rest.split(", ")[-1] in figures, figure.title


# --- the platform, the battery, the machine


ROUTE = re.compile(
    r"^(kinematic|dynamic), (PI?), (open loop|fed back), (all|not all) +([\d.]+) m +([\d.]+) ° +0 %$", re.MULTILINE
)


def test_what_is_read_out_of_the_runs_is_in_the_tables():
    """Every figure of the reading is one of the table's, and what is said of them holds."""
    text = page("platform")
    reading = text.split("Our reading:", 1)[1].split("![Path", 1)[0]
    figures = {m[0] for m in re.finditer(r"[\d.]+ m\b", reading)}
    at = {row[:4]: float(row[4]) for row in ROUTE.findall(text)}
    heading = {row[:4]: float(row[5]) for row in ROUTE.findall(text)}
    (unresisted,) = re.findall(r"\| all resistance: .*", text)  # no resistance is known
    kinematic, dynamic = re.findall(r"([\d.]+)\u00a0m, [\d.]+\u00a0°", unresisted)[:2]
    named = {f"{value:g} m" for value in at.values()} | {f"{dynamic} m", "2.8 m"}  # the last is the paper's
    assert len(at) == 10 and len(figures) == 9 and figures <= named
    assert float(kinematic) == at["kinematic", "P", "open loop", "all"] and float(dynamic) > 0.9 * float(kinematic)
    P, PI = ("P", "open loop"), ("PI", "open loop")
    gains = [f"{of['kinematic', *P, knows] / of['dynamic', *P, knows]:.1f} times" for of, knows in
             ((at, "not all"), (heading, "not all"), (heading, "all"))]  # fmt: skip
    assert gains == ["2.6 times", "2.5 times", "6.6 times"] and all(gain in reading for gain in gains)
    for knows in ("all", "not all"):
        assert abs(at["kinematic", *PI, knows] / at["dynamic", *PI, knows] - 1.0) < 0.25
    assert max(value for key, value in at.items() if key[2] == "fed back") < 0.01
    for errors in ("2.78 m     5.1 °", "0.89 m    0.45 °"):  # the paper's, section V
        assert re.search(rf", measured +{re.escape(errors)}", text)


# --- the spec, the loads, JSON


@pytest.mark.slow
def test_every_field_of_a_spec_is_on_a_page(site):
    text = "".join((site / f"{name}.html").read_text(encoding="utf-8") for name in ("spec", "loads"))
    shown = set(re.findall(r"<code>(\w+)</code>", text))
    models = {"RobotSpec": RobotSpec.model_json_schema(), **RobotSpec.model_json_schema()["$defs"]}
    for name, model in models.items():
        lacking = set(model["properties"]) - shown - {"kind", "profile"}
        assert not lacking, f"{name}: {lacking}"


# --- the paper, command by command


def commands_of_the_paper():
    """Rows of the table: what is meant, the command, the exit status that it says."""
    for meant, command, _ in rows(page("paper"), "## All of the paper, command by command"):
        found = re.fullmatch(r"`drivesizer ([^`]+)`(?: \(exit status (\d)\))?|–", command)
        assert found, command
        yield meant, (found[1] or "").split(), int(found[2] or 0)


def test_every_equation_figure_table_and_requirement_of_the_paper_has_a_row():
    meant = [text.split(":")[0] for text, _, _ in commands_of_the_paper()]

    def numbered(kind):
        """Numbers behind a word, each of a range as well."""
        texts = [text.translate({ord("("): None, ord(")"): None}) for text in meant if re.match(kind, text)]
        for low, high in re.findall(r"(\d+)(?: to (\d+))?", " ".join(texts)):
            yield from range(int(low), int(high or low) + 1)

    assert set(numbered(r"\(")) == set(range(1, 60))
    assert sorted(numbered("Figure")) == list(range(1, 14))
    assert list(numbered("Requirement")) == [1, 2, 3, 4, 5] and list(numbered("Table")) == [1]


def test_the_equations_of_the_table_are_printed(run, monkeypatch):
    monkeypatch.chdir(ROOT)
    quick = [words for _, words, _ in commands_of_the_paper() if words[:1] == ["equations"] and len(words) == 2]
    assert len(quick) > 12
    assert {run(*words)[0] for words in quick} == {0}


@pytest.mark.slow
def test_the_commands_of_the_table_end_as_it_says(run, monkeypatch, tmp_path):
    """But for the following of a path, which the page on the platform runs."""
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    every = {
        (" ".join(words), status) for _, words, status in commands_of_the_paper() if words and "--follow" not in words
    }
    assert len({command for command, _ in every}) == len(every)
    assert {command: run(*command.split())[0] for command, _ in every} == dict(every)


# --- pages of platform, battery and machine

pytest.importorskip("mathematics", reason="the documentation's own packages are not installed")


def test_the_page_of_the_paper_names_what_fails_of_the_platform():
    told = rows(page("paper"), "### The platform's printed form")
    numbers = [int(n) for row in told for n in re.findall(r"\(#?(\d+)\)\]", row[0])]
    assert numbers == [e.number for e in MATRICES if any(robot_figures.finding(e))]
    assert not any(robot_figures.finding(e).units for e in MATRICES)


def test_every_budget_check_is_on_its_page():
    told = {row[0] for name in ("battery", "budgets") for row in rows(page(name), "## Checks")}
    assert told == {declared.title for declared in CHECKS["budget"].values()}


def test_what_a_radius_comes_to_straight_ahead():
    lever = 0.27406 * (math.cos(math.radians(29.5)) + math.sin(math.radians(29.5)))
    assert f"{math.degrees(0.001 / (4 * lever) * 90):.1f}°" == "3.5°"
    assert "90 m straight ahead would make it 3.5°" in page("platform")


# --- equations as at the terminal

latex = pytest.importorskip("latex")


@pytest.mark.parametrize("declared", EVERY, ids=lambda e: e.name)
def test_an_equation_on_the_page_is_the_one_at_the_terminal(declared):
    """Another notation of the same syntax tree: what is read from left to right and from top to bottom is the same."""
    for form, paper in ((declared.computed, False), (declared.printed, True)):
        if form:
            made = mathematics.mathml(latex.expression(form, paper=paper), "block")
            assert signs(made) == signs(derivation.text(form, paper=paper))
            assert made.count("<mfrac>") >= (1 if "/" in form and "1 / 2" not in form else 0)
            assert made.count("<msqrt>") == form.count("sqrt(") + form.count("(1 / 2)")


@pytest.mark.parametrize("declared", MATRICES, ids=lambda e: str(e.number))
def test_an_equation_of_the_platform_on_the_page_is_the_one_at_the_terminal(declared):
    import matrices

    left = declared.printed_symbol or declared.symbol
    for side, form in ((left, declared.printed), (declared.symbol, declared.computed)):
        made = mathematics.mathml(matrices.equation(side, form), "block")
        side, _, vector = side.partition("] / ")  # what stands on the left as divided by a vector is multiplied by it
        right = form_text(form)
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
