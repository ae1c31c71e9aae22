"""The catalogues on the live page in a browser: found, read, set side by side, dropped in, and put into the spec."""

from __future__ import annotations

import base64
import csv
import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import typst
from browser_pages import Heard, launched, until
from live_server import Serving, serving
from motor_logs import motor_log
from own_catalogue import HOSTILE, RIGHT

pytestmark = pytest.mark.slow
SPEC = """\
name: hoist
load: {kind: hoist, mass: 1 kg, drum_diameter: 40 mm}
motion: {profile: trapezoid, speed: 0.2 m/s, acceleration_time: 0.2 s, cruise_time: 1 s, there_and_back: true}
transmission: [{kind: direct}]
supply: {nominal: 24 V}
select: {catalogs: [andymark]}  # for now
"""


TUTORIAL = Path(__file__).resolve().parents[2] / "docs" / "tutorials" / "own_parts.md"


def block(title: str) -> str:
    """A file that the tutorial shows."""
    return TUTORIAL.read_text(encoding="utf-8").partition(f'title="{title}"\n')[2].partition("```")[0]


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Serving]:
    path = tmp_path_factory.mktemp("served") / "robot.yaml"
    path.write_text(SPEC, encoding="utf-8")
    with serving(path) as found:
        yield found
    assert [one.name for one in path.parent.iterdir()] == ["robot.yaml"]


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    yield from launched()


@pytest.fixture(scope="module")
def loaded(browser: Any, server: Serving) -> Iterator[Any]:
    made = browser.new_page(viewport={"width": 1400, "height": 1000})
    made.heard = Heard(made)
    made.goto(f"http://{server.host}/{server.token}/")
    made.wait_for_selector("html[data-ranked]", state="attached", timeout=60_000)
    yield made
    assert made.heard.console == []
    made.close()


@pytest.fixture
def page(loaded: Any) -> Any:
    """The page with its catalogues open."""
    opened(loaded)
    return loaded


def opened(page: Any) -> None:
    if not page.locator("#browser[open]").count():
        page.locator("#catalogues").click()
    page.locator("#parts-with").fill("")
    page.locator("#browser .listed").wait_for()


def listed(page: Any) -> list[str]:
    return page.locator("#browser .listed tbody th button").all_inner_texts()


def spec_of(page: Any) -> str:
    return str(page.locator("#text").input_value())


def dropped(page: Any, name: str, text: str) -> None:
    """Drop a file on the page as a user does."""
    make = """([name, text]) => { const moved = new DataTransfer();
      moved.items.add(new File([text], name)); return moved; }"""
    moved = page.evaluate_handle(make, [name, text])
    page.dispatch_event("#browser .drop", "drop", {"dataTransfer": moved})


def test_both_engines_know_what_was_dropped_also_afresh(server: Serving) -> None:
    text = SPEC.replace("andymark", "dropped/mine.yaml")
    sent = {"name": "mine.yaml", "content": base64.b64encode(RIGHT.encode()).decode()}
    assert server.do("document", text)[-1]["kind"] == "wrong"
    assert server.post("/catalogue", sent).pieces[0]["kind"] == "kept"
    document = base64.b64decode(server.do("document", text)[0]["content"]).decode()
    assert '"OWN-1"' in document and '"mine":' in document
    for saved, lie_nowhere in ((text, ["dropped/mine.yaml"]), (SPEC, [])):
        (piece,) = server.post("/save", {"text": saved, "anyway": True}).pieces
        assert (piece["kind"], piece["dropped"]) == ("saved", lie_nowhere)
    for engine in server.processes():
        os.kill(engine, signal.SIGKILL)
    for job in ("answer", "document"):
        pieces = server.do(job, text)
        if pieces[0]["kind"] == "wrong":  # its process had not quite ended when the request came
            pieces = server.do(job, text)
        assert pieces[-1]["kind"] != "wrong"
    assert server.post("/catalogue", sent | {"content": None}).pieces[0]["kind"] == "given up"
    assert server.do("document", text)[-1]["kind"] == "wrong"


def test_rows_that_are_pasted_become_a_catalogue_in_the_engine(server: Serving) -> None:
    rows = "part\tvoltage (V)\tno load speed (rpm)\tstall torque (mNm)\tmass (g)\nK-7\t12\t9000\t310\t52\n"
    sent = {"name": "pasted.csv", "content": base64.b64encode(rows.encode()).decode(), "text": SPEC}
    (found,) = server.post("/catalogue", sent).pieces
    assert (found["kind"], found["name"]) == ("kept", "dropped/pasted.yaml") and "K-7" in found["text"]
    assert server.do("part", SPEC, catalogue=found["name"], section="motors", part="K-7")[0]["kind"] == "part"
    assert server.post("/catalogue", {"name": "pasted.yaml", "content": None}).pieces[0]["kind"] == "given up"


def test_own_parts_lead_from_a_data_sheet_and_an_offer_to_a_quote(server: Serving) -> None:
    """The files of the tutorial, as they lie there: the PDF's motors are said to be brushed."""
    spec = block("robot.yaml").replace("motors.yaml, gears.yaml", "dropped/m20.yaml, dropped/gears.yaml")
    look = '#set page(width: 25cm)\n#set text(font: "DejaVu Sans Mono", size: 8pt)\n'
    sheet = f'{look}#raw(block: true, "{block("m20.txt")}")'
    files = {"m20.pdf": typst.compile(sheet.encode(), format="pdf"), "gears.csv": block("gears.csv").encode()}
    given = {"manufacturer": "Anymaker"}
    for name, content in files.items():
        sent = {"name": name, "content": base64.b64encode(content).decode(), "text": spec, "given": given}
        (found,) = server.post("/catalogue", sent).pieces
        assert found["kind"] == "kept" and found["given"]["manufacturer"] == "Anymaker"
        if "kind" in found["given"]:
            assert any("a sizing still needs: kind" in line for line in found["read"])
            (found,) = server.post("/catalogue", {**sent, "given": given | {"kind": "brushed"}}).pieces
            assert not any("still needs" in line for line in found["read"])
    (quote,) = server.do("report", spec, form="quote.csv")
    rows = {one["role"]: one for one in csv.DictReader(base64.b64decode(quote["content"]).decode().splitlines())}
    assert (rows["motor"]["order_number"], rows["gearhead"]["order_number"]) == ("M20-24", "G26-14")
    assert rows["motor"]["maker"] == rows["gearhead"]["maker"] == "Anymaker"
    for name in ("m20.yaml", "gears.yaml"):
        assert server.post("/catalogue", {"name": name, "content": None}).pieces[0]["kind"] == "given up"


def test_a_log_that_is_dropped_shows_its_fit(page: Any) -> None:
    dropped(page, "log.csv", motor_log(";"))
    page.locator("#browser .fit .main-svg").first.wait_for(timeout=90_000)
    assert page.evaluate("document.activeElement.textContent") == "log.csv: the drive by its log"
    row = page.locator("#browser .fit tr", has_text="resistance").first.inner_text()
    assert float(row.split()[1]) == pytest.approx(2.0, rel=0.01)
    page.get_by_role("button", name="Back to the list").click()
    page.locator("#browser .listed").wait_for()


def test_parts_are_found_sorted_read_and_set_side_by_side(page: Any) -> None:
    assert "motors (" in page.locator("#parts-of option").first.inner_text()
    page.locator("#browser summary", has_text="Catalogues:").click()
    page.get_by_role("button", name="all", exact=True).click()
    page.locator("#parts-power").fill(">=x")
    page.locator("#parts-power-error").wait_for()
    page.locator("#parts-power").fill("")
    page.locator("#parts-with").fill("RE 25")
    page.get_by_label("add a condition").select_option("nominal_torque")
    page.keyboard.type("27")
    until(page, lambda: "118743" in listed(page) and "118752" not in listed(page))  # 28.6 and 26.3 mN*m
    page.get_by_role("button", name="remove the condition on nominal torque").click()
    page.locator("#parts-with").fill("A-max")
    page.get_by_role("button", name="price EUR", exact=True).click()
    until(page, lambda: page.locator("#browser th[aria-sort=ascending]").count() == 1)
    prices = [float(text) for text in page.locator("#browser tbody td:last-child").all_inner_texts() if text != "–"]
    assert len(prices) > 10 and prices == sorted(prices)
    page.locator("#parts-with").fill("RE 25")
    page.get_by_role("button", name="118752", exact=True).click()
    page.locator("#browser .drawing .main-svg").first.wait_for()
    assert "assigned power\t20 W\tsecondary\t[1]" in page.locator("#browser .sheets").inner_text()
    page.get_by_role("button", name="Back to the list").click()
    assert page.evaluate("document.activeElement.textContent") == "118752"
    for part in ("118752", "118743"):
        page.get_by_label(f"{part}: side by side").check()
    page.get_by_role("button", name="Compare").click()
    assert "≠\tnominal voltage\t" in page.locator("#browser .beside").inner_text()
    page.keyboard.press("Escape")
    until(page, lambda: page.evaluate("document.activeElement.id") == "catalogues")


def test_a_catalogue_that_is_dropped_is_checked_ranked_with_and_never_markup(page: Any) -> None:
    page.locator("#parts-with").fill("OWN-")
    dropped(page, "mine.yaml", HOSTILE.replace("rotor_inertia", "<i>x</i>"))
    until(page, lambda: 'unknown key "<i>x</i>"' in page.locator("#browser .checked").inner_text())
    dropped(page, "mine.yaml", HOSTILE)
    page.get_by_role("button", name="Search it alone").wait_for()
    assert "must lie beside it in a folder dropped" in page.locator("#browser .own").inner_text()
    until(page, lambda: "OWN-2" in listed(page))
    assert page.locator("#browser img, #browser tbody b").count() == 0
    click = "[...document.querySelectorAll('#browser .part-link')].find((one) => one.textContent === 'OWN-2')?.click()"
    until(page, lambda: page.locator("#browser .sheets").count() or page.evaluate(click))  # the list may be made anew
    page.locator("#browser .drawing .main-svg").first.wait_for()
    assert page.locator("#browser h3").inner_text() == "<b>Any</b> <img src=x onerror=alert(1)> OWN-2"
    page.get_by_role("button", name="Use this part").click()
    until(page, lambda: "OWN-2" in page.locator("#headline").inner_text())
    assert spec_of(page).startswith(SPEC.partition("select")[0]) and "dropped/mine.yaml" in spec_of(page)
    opened(page)
    page.get_by_role("button", name="Search it alone").click()
    until(page, lambda: "andymark" not in spec_of(page))
    page.locator("#undo").click()
    until(page, lambda: "andymark" in spec_of(page))
    opened(page)
    page.get_by_role("button", name="give it up").click()
    until(page, lambda: page.locator("#headline.wrong").count() == 1)
