"""What the pages in docs/ show is run."""

import re
from pathlib import Path

from drivesizer.catalog import PARTS, columns_of, load

PAGE = (Path(__file__).resolve().parent.parent / "docs" / "catalogues.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)


def test_the_catalogue_on_the_page_loads(tmp_path):
    (text,) = blocks("yaml")
    (tmp_path / "example.yaml").write_text(text, encoding="utf-8")
    catalog = load([str(tmp_path / "example.yaml")])
    assert (len(catalog.motors), len(catalog.gearheads), len(catalog.motor_gearhead.left)) == (2, 2, 4)
    assert catalog.gearheads.record(0).ratio == 12.25
    assert catalog.confidence("motors", 0)["mass"] == "derived"


def test_the_python_on_the_page_prints_what_it_says(capsys):
    (text,) = blocks("python")
    exec(text, {})
    said = [line.split("# ", 1)[1] for line in text.splitlines() if line.startswith("print")]
    assert capsys.readouterr().out.splitlines() == said


def test_the_columns_on_the_page_are_those_of_the_schema():
    for section in PARTS:
        table = PAGE.split(f"### {section}\n", 1)[1].split("### ", 1)[0]
        rows = re.findall(r"^\| `(\w+)` \| (\S+) \|$", table, re.MULTILINE)
        units = {"text": "text"}
        expected = [
            (c.name, units.get(c.kind, c.unit if c.unit != "1" else "number"))
            for c in columns_of(section).values()
            if c.name != "inside"
        ]
        assert rows == expected
