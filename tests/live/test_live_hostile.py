"""Specs and catalogues of strangers on the live page: texts in them stay texts, and what is absurd is refused."""

from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from own_catalogue import RIGHT

from drivesizer.files.text import hand_over
from drivesizer.live.engine import EngineMemory, done, take_over

SCRIPT = '<script>alert(1)</script><img src=x onerror=alert(2)>"><svg/onload=alert(3)>{{7*7}}'
SPEC = f"""\
name: '{SCRIPT}'
supply: {{nominal: 24 V, current: 20 A}}
load: {{kind: wheeled_vehicle, mass: 45 kg, driven_wheels: 4, wheel_diameter: 152 mm, rolling_resistance: 0.02,
       inertia: 0.004 kg*m^2}}
motion: {{speed: 0.5 m/s, acceleration_time: 2 s, cruise_time: 9 s, rest_time: 5 s}}
cases: [{{name: '{SCRIPT[:40]}'}}]
transmission: [{{kind: direct}}]
select: {{catalogs: [dropped/mine.yaml]}}
"""
CATALOGUE = RIGHT.replace("OWN 40", f"'{SCRIPT}'").replace("Anymaker", f"'{SCRIPT}'").replace("OWN-1", f"'{SCRIPT}'")
CATALOGUE = CATALOGUE.replace('"data sheet, page 3"', f"'{SCRIPT}'").replace("https:", "javascript:")


class Elements(HTMLParser):
    """Elements of a page with their attributes, and its text."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.names: set[str] = set()
        self.attributes: list[tuple[str, str]] = []
        self.text = ""
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag != "script" or dict(attrs).get("type") != "application/json":  # data, which is not run
            self.names.add(tag)
        self.attributes += [(name, value or "") for name, value in attrs]

    def handle_data(self, data: str) -> None:
        self.text += data


def test_script_in_any_text_is_shown_and_not_run(tmp_path: Path) -> None:
    held = EngineMemory(str(tmp_path / "robot.yaml"))
    take_over(held, {"dropped/mine.yaml": CATALOGUE.encode()})
    try:
        pieces = {}
        for piece in done(held, "answer", {"text": SPEC}):
            pieces[piece["kind"]] = piece
            if "figures" in pieces:
                break
    finally:
        hand_over({})
    assert "sections" in pieces, pieces
    page = Elements("".join(one["html"] for one in pieces["sections"]["sections"]))
    assert not page.names & {"script", "iframe", "object", "embed", "link", "style", "base", "form", "meta"}
    assert not [name for name, _ in page.attributes if name.startswith("on")]
    assert not [value for name, value in page.attributes if name in ("href", "src") and "script" in value.lower()]
    assert "<script>alert(1)</script>" in page.text and "{{7*7}}" in page.text
    assert SCRIPT in str(pieces["ranking"])  # as data, which the page sets as text


@pytest.mark.parametrize(
    "text",
    [
        "a: &x [1, 2]\nb: *x\n", "a: &x {b: 1}\n<<: *x\n", "[" * 100_000, "{a: " * 5000, "- " * 50_000 + "1",
        "".join(f"k{n}: 1\n" for n in range(150_000)), "a: !!python/object/apply:os.system [id]\n", "name: \x1b[31m\n",
        "name: a\u202eb\n", "name: '" + "x" * 1_900_000 + "'\n", "a: 1\n---\nb: 2\n", "\x00", "? [a]\n: 1\n",
        "supply: {nominal: " + "9" * 100_000 + " V}\n", "name: \U000e0041\n" * 3, "%TAG ! tag:x,2000:\n---\na: 1\n",
        "name: x\nload: {kind: " + "a" * 100_000 + "}\n", "x" * 2_000_000,
    ],
    ids=range(18),
)  # fmt: skip
def test_absurd_yaml_is_refused_in_a_few_lines(text: str) -> None:
    *_, last = done(EngineMemory("robot.yaml"), "answer", {"text": text})
    assert last["kind"] == "wrong" and len(last["lines"]) <= 10
    for line in last["lines"]:
        assert "\n" not in line and len(line) < 1500 and line.isprintable() and "fault" not in line
    rest: Any = done(EngineMemory("robot.yaml"), "document", {"text": text, "edits": [[["new", "field"], "1", False]]})
    assert next(rest)["kind"] == "wrong"
