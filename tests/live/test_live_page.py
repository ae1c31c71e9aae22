"""The live page in a browser, as its user walks through it: one server, one browser, a catalogue of few drives."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from browser_pages import findings, launched, until
from live_pages import SMALL, answered, field, live, opening
from live_server import serving
from playwright.sync_api import expect

from drivesizer.errors import InputError
from drivesizer.files.yaml_source import Edit, YamlSource, edited
from drivesizer.output.document.candidates import numbers_of, short_name
from drivesizer.sizing import size
from drivesizer.spec.robot import load_spec, read_spec

pytestmark = pytest.mark.slow
WIDTHS = (390, 768, 1400)


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("live") / "robot.yaml"
    made.write_text(SMALL, encoding="utf-8")
    return made


@pytest.fixture(scope="module")
def address(path: Path) -> Iterator[str]:
    with serving(path) as found:
        yield f"http://{found.host}/{found.token}/"


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    yield from launched()


@pytest.fixture(scope="module")
def tab(browser: Any, address: str) -> Iterator[Any]:
    """A tab with the page; in the end, what it said and requested is held against what it may."""
    made = live(browser, address)
    yield made
    made.context.close()
    assert made.heard.console == []
    requested = {urlsplit(url).netloc for url in made.heard.requests if not url.startswith(("data:", "blob:"))}
    assert requested == {urlsplit(address).netloc}


@pytest.fixture
def page(tab: Any, address: str, path: Path) -> Any:
    """The tab with the file as it was."""
    path.write_text(SMALL, encoding="utf-8")
    tab.goto("about:blank")
    tab.goto(address)
    return answered(tab)


def typed(page: Any, *path: str | int, value: str) -> None:
    """Type into a field and leave it."""
    field(page, *path).fill(value)
    field(page, *path).press("Enter")


def choose(page: Any, name: str) -> None:
    page.locator(".menu").get_by_role("button", name=re.compile(f"^{name}")).click()


def text_of(page: Any) -> str:
    return str(page.locator("#text").input_value())


def test_headline_is_the_first_screen_of_the_command(page: Any, path: Path) -> None:
    best = size(load_spec(path)).sets[0]
    expect(page.locator("#headline .best")).to_have_text(f"{best.status} {short_name(best)} {numbers_of(best)}")
    mass, price, margin = page.locator("#headline .key-figure strong").all_inner_texts()
    assert (mass, price) == (f"≈ {best.mass * 1e3:.4g} g", f"≥ {best.price:.2f} EUR")
    assert margin == page.locator(".margins .figure").first.inner_text()
    expect(page.locator("#report h2").first).to_have_text("Summary")


@pytest.mark.parametrize(("width", "height"), [(1400, 900), (390, 844)])
def test_one_look_shows_the_drive_its_margins_and_what_else_there_is(page: Any, width: int, height: int) -> None:
    page.set_viewport_size({"width": width, "height": height})
    if width < 992:
        page.locator("#switch").get_by_text("Answer").click()
    seen = ["#headline .best", ".key-figure >> nth=2", "#jump", "#loop", ".margins li >> nth=2"]
    for selector in seen + [".drives li >> nth=0", "#glance .drawing svg >> nth=0"] * (width > 992):
        expect(page.locator(selector)).to_be_in_viewport(timeout=20_000)
    page.set_viewport_size({"width": 1400, "height": 1000})


def test_a_change_says_by_how_much_and_the_row_leads_to_sections(page: Any) -> None:
    expect(page.locator(".change")).to_have_count(0)
    typed(page, "load", "mass", value="200 kg")
    expect(page.locator(".key-figure").first.locator(".change")).to_contain_text(re.compile(r"[+−].* k?g [▲▼]"))
    page.locator("#jump").get_by_text("Checks").click()
    expect(page.locator('[data-name="checks"] > h3, [data-name="checks"] > h2').first).to_be_focused()
    page.locator(".drives input").nth(0).check()
    page.locator(".drives input").nth(1).check()
    expect(page.locator("#compared th")).not_to_have_count(0, timeout=20_000)


def test_a_wrong_unit_stands_at_its_field_until_it_is_put_right(page: Any, tmp_path: Path) -> None:
    typed(page, "load", "mass", value="45 V")
    answered(page, "wrong")
    mass = field(page, "load", "mass")
    expect(mass).to_have_attribute("aria-invalid", "true")
    wrong = tmp_path / "robot.yaml"
    wrong.write_text(text_of(page), encoding="utf-8")
    with pytest.raises(InputError) as error:
        load_spec(wrong)
    line = str(error.value).replace(str(wrong), "robot.yaml")
    expect(page.locator("#headline .fault")).to_contain_text(line)
    said = page.locator(f"#{mass.get_attribute('aria-describedby').split()[-1]}").inner_text()
    assert line.endswith(said)
    page.get_by_text("YAML", exact=True).click()
    chosen = page.evaluate("(area => area.value.slice(area.selectionStart, area.selectionEnd))(document.activeElement)")
    assert chosen == "  mass: 45 V  # with payload"
    page.get_by_text("Form", exact=True).click()
    page.locator("#headline").get_by_role("button", name="show").click()
    expect(mass).to_be_focused()
    typed(page, "load", "mass", value="46 kg")
    answered(page)
    expect(mass).not_to_have_attribute("aria-invalid", "true")
    assert text_of(page) == SMALL.replace("45 kg", "46 kg")


def test_fields_and_items_come_and_go_with_the_keyboard_at_their_place(page: Any) -> None:
    page.get_by_role("button", name="add a field to load").click()
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowUp")
    choose(page, "slope")
    expect(field(page, "load", "slope")).to_be_focused()
    page.keyboard.type("2 deg")
    page.keyboard.press("Tab")
    until(page, lambda: "  slope: 2 deg\n" in text_of(page))
    assert page.evaluate("document.activeElement.dataset.key")
    field(page, "load", "slope", "-").press("Enter")
    expect(field(page, "load", "slope")).to_have_count(0)
    assert page.evaluate("document.activeElement.dataset.key")
    field(page, "transmission", "+").click()
    expect(field(page, "transmission", 1, "kind")).to_be_focused()
    field(page, "transmission", 1, "kind").select_option("belt")
    answered(page)
    assert {"ratio": 2, "efficiency": "95 %"}.items() <= load_spec_of(page)["transmission"][1].items()
    page.get_by_role("button", name="add a section …").click()
    page.get_by_role("textbox", name="find").fill("cases")
    page.keyboard.press("Enter")
    expect(field(page, "cases", 0, "name")).to_be_focused()
    page.keyboard.type("ramp")
    page.keyboard.press("Enter")
    answered(page)
    page.get_by_role("button", name="add a field to cases 1", exact=True).click()
    choose(page, "load")
    page.get_by_role("button", name="add a field to cases 1 load").click()
    choose(page, "slope")
    page.keyboard.type("3 deg")
    page.keyboard.press("Enter")
    answered(page)
    assert load_spec_of(page)["cases"] == [{"name": "ramp", "load": {"slope": "3 deg"}}]


def test_what_is_typed_while_the_form_is_drawn_anew_is_kept(page: Any) -> None:
    """The next field is typed in while the answer to the last one comes; Save takes what stands in the field."""
    page.evaluate("""() => { const real = fetch; window.fetch = async (...given) => {
        if (String(given[0]).endsWith("do/answer")) await new Promise((go) => { setTimeout(go, 300); });
        return real(...given); }; }""")
    field(page, "load", "mass").fill("50 kg")
    page.keyboard.press("Tab")
    field(page, "load", "wheel_diameter").click()
    page.keyboard.press("ControlOrMeta+A")
    page.keyboard.type("2", delay=50)
    until(page, lambda: "mass: 50 kg" in text_of(page))
    expect(field(page, "load", "wheel_diameter")).to_be_focused()
    page.keyboard.type("00 mm")
    page.keyboard.press("ControlOrMeta+S")
    expect(page.locator("#unsaved")).to_be_hidden()
    assert "wheel_diameter: 200 mm" in text_of(page)


def test_slider_shows_where_the_best_drive_changes_and_why(page: Any) -> None:
    page.get_by_label("slider for load mass").click()
    slider = page.get_by_role("slider", name="load · mass")
    expect(slider).to_be_focused()
    page.get_by_role("textbox", name="to, slider for load · mass").fill("200 kg")
    page.keyboard.press("Enter")
    page.locator(".slider summary").click()
    lines, said = page.locator(".stretches li"), page.locator("#said")
    expect(lines.filter(has_text="no drive meets all limits")).to_have_count(1, timeout=60_000)
    expect(lines.filter(has_text="beyond it fails:").first).to_contain_text(
        re.compile(r"fails: .+ −\d"), timeout=60_000
    )
    first = page.locator("#headline .best").inner_text()
    slider.focus()
    for _ in range(3):
        page.keyboard.press("PageUp")
    expect(page.locator("#headline .best")).not_to_have_text(first)
    here = page.locator(".stretches li.here")
    best = here.locator("div span").inner_text()
    expect(said).to_contain_text(re.compile(re.escape(best), re.IGNORECASE))
    box = slider.bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + 8, box["y"] + box["height"] / 2, steps=5)
    page.mouse.up()
    expect(field(page, "load", "mass")).to_have_value(re.compile(r"^1[12][. ]"))
    answered(page)
    assert "# with payload" in text_of(page)
    until(page, lambda: said.inner_text().partition(": ")[2] in here.inner_text())
    page.keyboard.press("ControlOrMeta+Z")
    expect(slider).not_to_have_attribute("aria-valuetext", re.compile(r"^1[12][. ]"))
    page.get_by_label("close the slider for load · mass").click()
    expect(page.get_by_label("slider for load mass")).to_be_focused()


def test_free_figures_are_typed_or_taken_from_a_slider_and_the_best_machine_fills_them_in(page: Any) -> None:
    typed(page, "load", "wheel_diameter", value="free 120 mm .. 240 mm step 40 mm")
    answered(page, "free")
    expect(field(page, "load", "wheel_diameter")).to_have_value("free 120 mm .. 240 mm step 40 mm")
    typed(page, "load", "inertia", value="= 0.1 * load.wheel_diameter ** 2")
    page.get_by_label("slider for load mass").click()
    page.get_by_role("textbox", name="from, slider for load · mass").fill("44 kg")
    page.keyboard.press("Enter")
    page.locator(".slider .bounds button").click()
    expect(page.locator("#headline .best")).to_have_text("2 figures are free")
    load = load_spec_of(page)["load"]
    assert load["mass"] == {"free": "44 kg .. 90 kg"}
    assert load["wheel_diameter"] == {"free": "120 mm .. 240 mm", "step": "40 mm"}
    assert load["inertia"] == {"expression": "0.1 * load.wheel_diameter ** 2"}
    typed(page, "load", "mass", value="free [44 kg, 45 kg]")
    until(page, lambda: load_spec_of(page)["load"]["mass"] == {"free": ["44 kg", "45 kg"]})
    assert findings(page) == []
    page.get_by_role("button", name="Find the best machine").focus()
    page.keyboard.press("Enter")
    expect(page.locator("#headline button")).to_have_text("searching …")
    assert findings(page) == []
    expect(page.locator("#designed h2")).to_be_focused(timeout=60_000)
    assert findings(page) == []
    page.get_by_role("button", name="Use the best figures").focus()
    page.keyboard.press("Enter")
    answered(page)
    assert load_spec_of(page)["load"]["mass"] == "44 kg" and "free" not in text_of(page)
    expect(page.locator("#designed")).to_be_empty()


def test_file_is_written_and_another_programs_change_is_seen(page: Any, path: Path) -> None:
    typed(page, "load", "mass", value="48 kg")
    page.get_by_role("button", name="Save").click()
    until(page, lambda: path.read_text(encoding="utf-8") == SMALL.replace("45 kg", "48 kg"))
    expect(page.locator("#unsaved")).to_be_hidden()
    path.write_text(SMALL.replace("45 kg", "60 kg"), encoding="utf-8")
    typed(page, "load", "mass", value="49 kg")
    page.get_by_role("button", name="Save").click()
    page.get_by_role("button", name="load it").click()
    expect(field(page, "load", "mass")).to_have_value("60 kg")


def test_reload_and_link_keep_what_is_not_saved(page: Any, browser: Any, path: Path) -> None:
    typed(page, "load", "mass", value="51 kg")
    typed(page, "motion", "speed", value="1 m/s .. 2 m/s")  # a range is that of its slider
    answered(page)
    page.wait_for_timeout(500)
    page.reload()
    answered(page)
    expect(field(page, "load", "mass")).to_have_value("51 kg")
    expect(field(page, "motion", "speed")).to_have_value("1.5 m/s")
    expect(page.get_by_role("slider", name="motion · speed")).to_be_visible()
    ends = page.get_by_role("textbox", name=re.compile("slider for motion · speed"))
    assert [one.input_value() for one in ends.all()] == ["1 m/s", "2 m/s"]
    other = live(browser, page.url)
    expect(field(other, "load", "mass")).to_have_value("51 kg")
    expect(other.locator("#unsaved")).to_be_visible()
    path.write_text(SMALL.replace("45 kg", "61 kg"), encoding="utf-8")
    other.reload()
    expect(other.get_by_text("has been changed by another program")).to_be_visible()
    other.context.close()
    assert path.read_text(encoding="utf-8") == SMALL.replace("45 kg", "61 kg")


def test_a_tab_goes_on_with_a_server_that_starts_again(browser: Any, tmp_path: Path) -> None:
    """What is typed meanwhile is in the download, and in the answer of the server that comes."""
    path = tmp_path / "robot.yaml"
    path.write_text(SMALL, encoding="utf-8")
    with serving(path) as first:
        page = live(browser, f"http://{first.host}/{first.token}/")
    typed(page, "load", "mass", value="52 kg")
    expect(page.get_by_text("The server does not answer.")).to_be_visible()
    page.get_by_role("button", name="Download …").click()
    with page.expect_download() as handed:
        page.get_by_role("button", name="Spec, YAML").click()
    assert handed.value.path().read_text(encoding="utf-8") == f'{SMALL}# typed since: load.mass: "52 kg"\n'
    with serving(path) as again:
        assert again.printed == first.printed
        expect(page.get_by_text("The server does not answer.")).to_have_count(0, timeout=20_000)
        until(page, lambda: text_of(page) == SMALL.replace("45 kg", "52 kg"))
        answered(page)
    page.context.close()


def test_a_range_is_computed_anew_once_the_text_can_be_read(page: Any) -> None:
    wrong = json.dumps({"kind": "wrong", "lines": ["robot.yaml:3: expected a key"]})
    page.route("**/do/sweep", lambda route: route.fulfill(body=f"{wrong}\n", content_type="application/x-ndjson"))
    page.get_by_label("slider for load mass").click()
    expect(page.locator(".bounds .far")).to_have_text("not computed: robot.yaml:3: expected a key")
    page.unroute("**/do/sweep")
    typed(page, "load", "mass", value="46 kg")  # its own figure, which alone would not begin it anew
    expect(page.locator(".bounds .far")).to_have_text(re.compile("^computing|^$"), timeout=20_000)
    page.locator(".slider summary").click()
    expect(page.locator(".stretches li").first).to_be_visible(timeout=20_000)


def test_what_takes_minutes_is_said_and_stopped(page: Any) -> None:
    """A button is there while it is computed; then the page says so, and goes on with the next change."""
    slow = SMALL + "tolerances: {confidence: 95 %, samples: 1000000}\n"
    page.locator("#opened").set_input_files({"name": "slow.yaml", "mimeType": "text/yaml", "buffer": slow.encode()})
    stop = page.locator("#progress button")
    expect(stop).to_be_visible(timeout=30_000)
    stop.click()
    expect(page.locator("#headline")).to_contain_text("stopped before it was done", timeout=30_000)
    expect(stop).to_be_hidden()
    opening(page, SMALL)


def test_notices_and_the_comparison_are_in_sight_wherever_the_page_is(page: Any) -> None:
    page.locator("#sets input").nth(0).scroll_into_view_if_needed()
    page.locator("#sets input").nth(0).check()
    page.locator("#sets input").nth(1).check()
    expect(page.locator("#compared table")).to_be_in_viewport()
    expect(page.locator("#sets input").nth(1)).to_be_in_viewport()
    page.get_by_role("button", name="Copy link").click()
    expect(page.locator(".notice.said")).to_be_in_viewport()
    expect(page.locator(".notice.said")).to_have_count(0, timeout=15_000)
    page.locator("#compared").get_by_role("button", name="close").click()
    expect(page.locator("#compared")).to_be_empty()
    assert page.locator("#checks td.used").first.evaluate("one => getComputedStyle(one).display") == "table-cell"
    page.locator("#glance input").nth(0).check()
    expect(page.locator("#compared")).not_to_be_empty()
    opening(page, SMALL.replace("45 kg", "44 kg"))
    expect(page.locator("#compared")).to_be_empty()  # it was of another spec


# -- how it looks


LONG = "#report > section:not([data-name=summary], [data-name=candidates])"
"""Sections in which axe-core takes long, and which the test of the report's own page has looked at."""


def test_nothing_lies_beyond_an_edge_and_axe_finds_nothing_serious(page: Any) -> None:
    """With slider, comparison and report; the two parts of a narrow page at once, as no user sees them."""
    page.get_by_label("slider for load mass").click()
    page.locator("#sets input").nth(0).check()
    page.locator("#sets input").nth(1).check()
    expect(page.locator("#compared table")).to_be_visible()
    page.evaluate(f"for (const one of document.querySelectorAll({LONG!r})) one.remove()")
    for width in WIDTHS:
        page.set_viewport_size({"width": width, "height": 900})
        page.evaluate("for (const one of document.querySelectorAll('[name=pane]')) one.checked = false")
        page.evaluate("dispatchEvent(new Event('resize'))")
        until(page, lambda: page.evaluate("document.documentElement.scrollWidth - innerWidth") == 0)
        assert page.evaluate(BEYOND) == []
        for scheme in ("light", "dark"):
            page.emulate_media(color_scheme=scheme)
            assert findings(page) == []
    page.set_viewport_size({"width": 390, "height": 844})
    page.locator("#switch").get_by_text("Machine").click()
    typed(page, "load", "mass", value="45")
    answered(page, "wrong")
    page.get_by_role("button", name="add a field to load").click()
    assert findings(page) == []
    page.keyboard.press("Escape")
    page.set_viewport_size({"width": 1400, "height": 1000})
    for scheme in ("dark", "light"):  # with the report that is of the text before
        page.emulate_media(color_scheme=scheme)
        assert findings(page) == []


BEYOND = """() => [...document.querySelectorAll("body *")].filter((one) => one.checkVisibility()
    && !one.closest(".scroll, .step dd, .lines, svg, .skip, .hidden, pre")
    && one.getBoundingClientRect().right > innerWidth + 1).map((one) => one.outerHTML.slice(0, 120))"""


def test_everything_is_reached_and_seen_by_keyboard(page: Any) -> None:
    page.locator(".skip").focus()
    seen: list[str] = []
    for _ in range(90):
        seen.append(page.evaluate(FOCUSED))
        if seen[-1].startswith("slider for supply"):
            break
        page.keyboard.press("Tab")
    text = "\n".join(seen)
    for wanted in (
        "To the answer",
        "New …",
        "Save",
        "Download …",
        "Form",
        "mass",
        "slider for load mass",
        "add a field to load",
    ):
        assert wanted in text
    assert "hidden" not in text and "body" not in text
    page.get_by_role("radio", name="Form").focus()
    page.keyboard.press("ArrowRight")
    expect(page.locator("#text")).to_be_visible()
    page.keyboard.press("ArrowLeft")
    page.locator("#new").press("Enter")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Escape")
    expect(page.locator("#new")).to_be_focused()


# what has the keyboard: whether it is seen, with an outline, and not below what stays at the top
FOCUSED = """() => {
  const one = document.activeElement, box = one.getBoundingClientRect(), top = document.getElementById("top");
  if (one === document.body) return "body";
  const outlined = getComputedStyle(one).outlineStyle !== "none";
  const below = !one.closest("#top, .skip") && box.top < top.getBoundingClientRect().bottom - 1;
  const name = one.getAttribute("aria-label") ?? (one.labels?.[0]?.textContent || one.textContent.trim());
  return name + (outlined && !below && box.bottom > 0 && box.top < innerHeight ? "" : ` hidden: ${one.outerHTML}`);
}"""


# -- machines, and every kind of load and motion


def test_machine_of_several_axes(page: Any, tmp_path: Path) -> None:
    opening(page, two_axes_text())
    expect(page.locator("#headline .best")).to_contain_text("Machine of 2 axes")
    expect(page.locator("#headline dt")).to_have_text(["lift", "turn"])
    assert page.locator("#report h2").all_inner_texts()[0] == "Summary"
    assert page.locator("#sets input").count() == 0
    page.locator("#form summary", has_text="lift").click()
    expect(field(page, "axes", "lift", "load", "kind")).to_have_value("hoist")
    typed(page, "axes", "lift", "load", "mass", value="2.5 kg")
    until(page, lambda: "mass: 2.5 kg" in text_of(page))
    answered(page)
    page.get_by_label("slider for axes lift load mass").click()
    page.locator(".slider summary").click()
    expect(page.locator(".stretches li").first).to_contain_text("lift: ", timeout=30_000)
    page.get_by_role("textbox", name="name of another of axes").fill("second")
    page.keyboard.press("Enter")
    page.get_by_role("button", name="add another of axes").click()
    expect(page.locator("#headline .best")).to_contain_text("Machine of 3 axes", timeout=30_000)


def test_two_sliders_give_a_map_of_the_best_drive(page: Any) -> None:
    """Its corners are the answers to the figures that they stand for."""
    button = page.get_by_role("button", name="map over both sliders")
    page.get_by_label("slider for load mass").click()
    expect(button).to_be_hidden()
    page.get_by_label("slider for load wheel diameter").click()
    button.click()
    cells = page.locator(".map .cells i")
    expect(cells).to_have_count(49)
    expect(page.locator(".map .cells .wait")).to_have_count(0, timeout=240_000)
    for place, mass, diameter in ((0, 11.25, 304.0), (42, 11.25, 38.0), (48, 90.0, 38.0)):
        text = edited(
            SMALL, [Edit(("load", "mass"), f"{mass:g} kg"), Edit(("load", "wheel_diameter"), f"{diameter:g} mm")], "x"
        )
        best = size(read_spec(YamlSource(text, "x"))).sets
        where = f"{mass:g} kg, {diameter:g} mm: "
        expect(cells.nth(place)).to_have_attribute(
            "title", where + (best[0].label if best else "no drive meets all limits")
        )
    typed(page, "load", "mass", value="46 kg")
    expect(cells.first).to_be_hidden()


def two_axes_text() -> str:
    return """\
name: two
supply: {nominal: 24 V}
select: {motor: {family: RE 25}, gearhead: {family: GP 26 A}}
axes:
  lift:
    load: {kind: hoist, mass: 2 kg, drum_diameter: 40 mm}
    motion: {speed: 0.2 m/s, acceleration_time: 0.2 s, cruise_time: 1 s, rest_time: 2 s}
  turn:
    load: {kind: rotary_table, inertia: 0.02 kg*m^2}
    motion: {speed: 60 rpm, acceleration_time: 0.3 s, cruise_time: 1 s, rest_time: 2 s}
"""


# turns the group at a path of a spec, drawn by the form itself, into each other kind: the edits of each
TURNED = """async ([data, path]) => {
  const form = await import(new URL("page/form.js", location.href.split("#")[0]));
  const schemas = await (await fetch("schema.json")).json(), found = {};
  let edits = null;
  const pick = () => document.querySelector(`#form [data-key="${CSS.escape(path.join("\\u001f"))}"]`);
  form.prepare(schemas, (made) => { edits = made; }, () => {});
  form.show(data, []);
  for (const { value } of [...pick().options]) {
    form.forget();
    if (pick().value === value) continue;
    const kept = pick().value;
    pick().value = value;
    pick().dispatchEvent(new Event("change"));
    pick().value = kept;
    found[value] = edits;
  }
  return found;
}"""
LINEAR = dict(YamlSource(SMALL, "robot.yaml").data) | {
    "transmission": [{"kind": "gearhead"}, {"kind": "belt", "ratio": 2, "efficiency": 0.95}]
}
TABLE = LINEAR | {"load": {"kind": "rotary_table", "inertia": "0.1 kg*m^2"},
                  "motion": {"speed": "60 rpm", "acceleration_time": "1 s", "cruise_time": "2 s"}}  # fmt: skip
NEEDS = {  # what only the user has, and stages of which a second one makes no sense
    "csv": "motion.file: is missing", "cam": "motion.file: is missing", "trajectory": "motion.trajectory: is missing",
    "waypoints": "section platform", "direct": "transmission", "gearhead": "transmission",
}  # fmt: skip


def test_every_kind_turned_into_any_other_reads(page: Any) -> None:
    """From the form's own select; what only the user can know is missing, by name."""
    groups = (["load", "kind"], ["motion", "profile"], ["transmission", 1, "kind"])
    read = 0
    for data in (LINEAR, TABLE):
        for place in groups:
            turned = page.evaluate(TURNED, [data, place])
            assert len(turned) > 5
            for name, edits in turned.items():
                text = edited(json.dumps(data), [Edit(tuple(path), value, bool(plain)) for path, value, plain in edits])
                if name in NEEDS:
                    with pytest.raises(InputError, match=f"[: ]{re.escape(NEEDS[name])}"):
                        load_spec(load_spec_in(text))
                    continue
                assert load_spec(load_spec_in(text))
                read += 1
    assert read > 40


def load_spec_in(text: str) -> dict[str, Any]:
    """A text as data, by the strict reader."""
    return dict(YamlSource(text, "robot.yaml").data)


def load_spec_of(page: Any) -> dict[str, Any]:
    """The text of the page as data."""
    return load_spec_in(text_of(page))
