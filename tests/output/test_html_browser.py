"""The HTML report in a browser: it loads in silence, sorts, answers pointer and keys, prints, and fits a telephone."""

import re
from collections.abc import Iterator
from dataclasses import replace
from math import nan
from pathlib import Path
from typing import Any

import pytest
from browser_pages import findings, kept, launched, until
from html_reports import CASE, hostile_spec, whole_validation, with_choices

from drivesizer.load_cases import load_cycle
from drivesizer.machine.operating_field import field
from drivesizer.output.report import write
from drivesizer.results.sizing import SizingResult
from drivesizer.sizing import size

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    yield from launched()


@pytest.fixture(scope="module")
def report(result: SizingResult, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The SPS robot with every figure that there is, and drives to choose from."""
    (path,) = write(with_choices(result), whole_validation(result), [tmp_path_factory.mktemp("page") / "report.html"])
    return path


@pytest.fixture(scope="module")
def hoist(tmp_path_factory, catalog) -> SizingResult:
    """60 candidates and more, one of unknown mass and price, load cases, names that are markup."""
    spec = hostile_spec(tmp_path_factory.mktemp("hostile"))
    found = size(spec, catalog=catalog, top=60, pareto=("mass", "price"))
    one = found.sets[5]
    parts = {"motor": replace(one.motor, price=nan), "gearhead": replace(one.gearhead, price=nan)}
    unknown = replace(one, mass=nan, encoder=None, controller=None, **parts)
    return replace(found, sets=(*found.sets[:5], unknown, *found.sets[6:]))


@pytest.fixture(scope="module")
def hostile(hoist: SizingResult, tmp_path_factory: pytest.TempPathFactory) -> Path:
    (path,) = write(hoist, None, [tmp_path_factory.mktemp("page") / "report.html"])
    return path


@pytest.fixture(scope="module")
def page(browser, report):
    yield from kept(browser, report)


@pytest.fixture(scope="module")
def wild(browser, hostile):
    yield from kept(browser, hostile)


@pytest.fixture(scope="module")
def narrow(browser, report):
    """The robot on a telephone with a dark screen."""
    yield from kept(browser, report, 360, color_scheme="dark")


@pytest.fixture(scope="module")
def narrow_wild(browser, hostile):
    yield from kept(browser, hostile, 360)


@pytest.fixture(scope="module")
def undrawn(browser, report):
    """The robot in a browser that cannot unpack what draws the figures."""
    made = browser.new_page()
    made.add_init_script("delete window.DecompressionStream")
    made.goto(report.as_uri())
    made.wait_for_selector("html[data-drawn='0']")
    yield made
    made.close()


def test_it_loads_in_silence_and_asks_for_nothing(page, report):
    assert page.heard.console == [] and page.heard.requests == [report.as_uri()]
    assert page.locator("html").get_attribute("data-drawn") == "17"
    assert page.evaluate("performance.getEntriesByType('resource').map(e => e.name)") == []


def test_markup_in_names_is_text(wild, hostile, hoist):
    assert wild.heard.console == [] and wild.heard.requests == [hostile.as_uri()]
    assert wild.locator("h1").inner_text().startswith('<script>alert(1)</script> "</script> <!-- ]]> & &lt;')
    legend = wild.locator("#figure-cycle .legend button")
    assert [text.strip() for text in legend.all_inner_texts()] == ["as specified", CASE, "weak"]


def test_its_own_policy_forbids_other_scripts_and_requests(undrawn):
    found = undrawn.evaluate("""async () => {
        const broken = [];
        document.addEventListener("securitypolicyviolation", (e) => broken.push(e.effectiveDirective));
        const script = document.createElement("script");
        script.textContent = "window.ran = true";
        document.body.append(script);
        const image = document.createElement("img");
        image.src = "https://example.org/x.png";
        document.body.append(image);
        await fetch("https://example.org/").catch(() => null);
        await new Promise((done) => setTimeout(done, 200));
        return [broken.sort(), window.ran ?? false];
    }""")
    assert found == [["connect-src", "img-src", "script-src-elem"], False]


# -- the table


def column(page: Any, place: int) -> list[float | None]:
    return page.evaluate(f"""() => [...document.querySelectorAll("#sets tbody tr")].map((row) =>
        row.cells[{place}].querySelector("data") ? Number(row.cells[{place}].querySelector("data").value) : null)""")  # type: ignore[no-any-return]


@pytest.mark.parametrize(("name", "place"), [("mass", 4), ("ratio", 3)])
def test_a_click_sorts_the_candidates_and_a_second_one_backwards(wild, hoist, name, place):
    ranks = column(wild, 0)
    assert len(ranks) == len(hoist.sets) + len(hoist.misses) >= 60
    head = wild.locator("#sets thead th", has_text=re.compile(rf"^\s*{name}\b"))
    for way in ("ascending", "descending"):
        head.get_by_role("button").click()
        found = column(wild, place)
        known = [value for value in found if value is not None]
        assert known == sorted(known, reverse=way == "descending") and len(set(known)) > 5
        assert found[: len(known)] == known  # what is unknown stays last
        assert found.count(None) == (1 if name in ("mass", "price") else 0)
        assert head.get_attribute("aria-sort") == way
        assert wild.locator("#sets th[aria-sort$=ending]").count() == 1
    wild.locator("#sets thead button").first.click()
    assert column(wild, 0) == sorted(ranks)


# -- figures


def pointed(page: Any, name: str, curve: str, point: int) -> str:
    """What a figure tells of a point that the pointer is moved to."""
    drawing = page.locator(f"[data-plot='{name}']")
    drawing.scroll_into_view_if_needed()
    x, y = drawing.evaluate(
        """(d, [label, point]) => {
        const trace = d.data.find((t) => t.legendgroup === label), {xaxis, yaxis} = d._fullLayout;
        const box = d.querySelector(".nsewdrag").getBoundingClientRect();
        return [box.x + xaxis.d2p(trace.x[point]), box.y + yaxis.d2p(trace.y[point])];
    }""",
        [curve, point],
    )
    label = drawing.locator(".hoverlayer .hovertext")
    for patience in range(1, 20):  # a figure that is being drawn does not hear the pointer
        page.mouse.move(x - 3, y - 2)
        page.mouse.move(x, y, steps=4)
        page.wait_for_timeout(50 * patience)
        if label.count():
            break
    label.first.wait_for(timeout=5_000)
    return " | ".join(label.first.locator("tspan.line, text").all_text_contents())


def test_the_pointer_finds_an_operating_point(page, result):
    found, cycle = field(result.spec, result.sets[0]), load_cycle(result.spec)
    end = pointed(page, "field", "load cycle", 1)  # the end of the acceleration
    rpm, torque = found.cycle_speed[0, 1] * 9.5492966, 1e3 * found.cycle_torque[0, 1]
    assert "load cycle" in end and f"{rpm:.0f} rpm, {torque:.4g} mN·m" in end
    assert f"at {cycle.time[0, 1]:g} s of the cycle" in end
    assert f"{found.cycle_speed[0, 1] * found.cycle_torque[0, 1]:.4g} W" in end


def test_the_buttons_of_a_figure_are_the_known_ones(page):
    """One of plotly.js's own sends the figure to a server."""
    found = page.evaluate("[...document.querySelectorAll('.modebar-btn')].map((e) => e.dataset.title)")
    assert {*found} == {"Download plot as a PNG", "Zoom", "Pan", "Zoom in", "Zoom out", "Reset axes"}


def shown_lines(page: Any, name: str) -> int:
    return page.locator(f"[data-plot='{name}'] .scatterlayer .trace path.js-line").count()  # type: ignore[no-any-return]


def test_a_line_is_hidden_and_shown_by_its_button(page):
    before = shown_lines(page, "bode")
    button = page.locator("#figure-bode .legend button", has_text="velocity")
    assert button.get_attribute("aria-pressed") == "true"
    button.click()
    assert button.get_attribute("aria-pressed") == "false" and shown_lines(page, "bode") == before - 3
    button.focus()
    page.keyboard.press("Enter")
    assert button.get_attribute("aria-pressed") == "true" and shown_lines(page, "bode") == before


def changed(page, element, before):
    """The text of an element once it is another one."""
    until(page, lambda: element.text_content() not in ("", before))
    return element.text_content()


def test_arrow_keys_go_from_point_to_point(page, result):
    drawing = page.locator("[data-plot='field']")
    drawing.focus()
    labels = []
    for key in ("ArrowRight", "ArrowRight", "ArrowDown"):
        page.keyboard.press(key)
        labels.append(changed(page, drawing.locator(".hoverlayer"), labels[-1] if labels else ""))
    assert len(set(labels)) == 3 and all("rpm" in label and "mN·m" in label for label in labels)
    page.keyboard.press("Escape")
    assert drawing.locator(".hoverlayer .hovertext").count() == 0


# -- screens and paper


FITTED = """() => [...document.querySelectorAll(".drawing")].every((d) =>
    Math.abs(d._fullLayout.width - d.getBoundingClientRect().width) < 1.5)"""


def resized(page: Any, width: int) -> None:
    """Wait until every figure has found its new width: the page does that by itself, a moment later."""
    page.set_viewport_size({"width": width, "height": 1000})
    until(page, lambda: page.evaluate(FITTED))


@pytest.mark.parametrize("width", [1400, 360, 700])
def test_no_page_is_wider_than_its_window(page, wild, narrow, narrow_wild, width):
    """As it is opened, wide and narrow, and as its window is drawn to another width."""
    for made in (page, wild) if width >= 1000 else (narrow, narrow_wild):
        resized(made, width)
        assert made.evaluate("document.documentElement.scrollWidth") <= width, made.url
        over = made.evaluate("""() => [...document.querySelectorAll("main *")].filter((e) =>
            !e.closest(".scroll, .lines, dd, .js-plotly-plot") && e.getBoundingClientRect().right > innerWidth + 1)
            .map((e) => e.outerHTML.slice(0, 80))""")
        assert over == [] and made.heard.console == []


def test_axe_finds_nothing_serious_on_a_dark_telephone(narrow):
    assert findings(narrow) == []


def test_it_prints(page, result, tmp_path):
    import pypdf

    before = page.locator("[data-plot='loop'] .main-svg").first.bounding_box()["width"]
    page.pdf(path=tmp_path / "report.pdf", prefer_css_page_size=True)
    text = " ".join(sheet.extract_text() for sheet in pypdf.PdfReader(tmp_path / "report.pdf").pages)
    text = re.sub(r"\s+", " ", text)
    for said in (
        "A drive was found",
        result.sets[0].motor.part,
        "open loop, phase",
        "winding temperature (°C)",
        "Gearhead input speed",
    ):
        assert said in text, said
    assert "Contents" not in text
    assert page.locator("[data-plot='loop'] .main-svg").first.bounding_box()["width"] == pytest.approx(before)
    assert page.heard.console == []


def test_a_browser_that_cannot_unpack_says_so_and_shows_the_rest(undrawn):
    assert "cannot draw the figures" in undrawn.locator("[data-plot='loop']").inner_text()
    undrawn.locator("#sets thead button").first.click()
    assert undrawn.locator("#sets th[aria-sort=ascending]").count() == 1


def test_without_javascript_the_text_is_there(browser, report):
    page = browser.new_page(java_script_enabled=False)
    page.goto(report.as_uri())
    assert "need JavaScript" in page.locator("noscript").first.inner_text()
    assert page.locator("#checks tbody tr").count() > 10
    page.close()
