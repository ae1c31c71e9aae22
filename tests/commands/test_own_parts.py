"""Parts of one's own: from a data sheet and an offer to a quote, and one by one, asked for or by options."""

from __future__ import annotations

import csv
import os
import pty
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import typst
from typer.testing import CliRunner

from drivesizer.catalog import load
from drivesizer.cli import app
from drivesizer.errors import DrivesizerError

PAGE = Path(__file__).resolve().parents[2] / "docs" / "tutorials" / "own_parts.md"
FIGURES = {"name": "775", "maker": "Anymaker", "kind": "brushed", "voltage": "12 V", "no_load_speed": "15000 rpm",
           "no_load_current": "1.2 A", "stall_torque": "0.5 N m", "stall_current": "70 A"}  # fmt: skip


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.chdir(tmp_path)

    def command(*words: str) -> str:
        found = CliRunner().invoke(app, words)
        if isinstance(found.exception, DrivesizerError):
            return str(found.exception)
        assert found.exit_code in (0, 1), found.exception
        return found.output

    return command


def block(title: str) -> str:
    """A file that the page shows."""
    return PAGE.read_text(encoding="utf-8").partition(f'title="{title}"\n')[2].partition("```")[0]


def add(run: Any, *more: str, **figures: str) -> str:
    named = [word for name, text in figures.items() for word in ("--set", f"{name}={text}")]
    return str(run("catalog", "add", "-o", "my.yaml", *more, *named))


def test_a_data_sheet_as_pdf_and_an_offer_lead_to_a_quote_in_three_commands(run: Any, tmp_path: Path):
    look = '#set page(width: 25cm)\n#set text(font: "DejaVu Sans Mono", size: 8pt)\n'
    sheet = f'{look}#raw(block: true, "{block("m20.txt")}")'
    (tmp_path / "m20.pdf").write_bytes(typst.compile(sheet.encode(), format="pdf"))
    for name in ("gears.csv", "robot.yaml"):
        (tmp_path / name).write_text(block(name), encoding="utf-8")
    maker = ("--manufacturer", "Anymaker")
    assert "3 motors" in run("catalog", "import", "m20.pdf", "-o", "motors.yaml", *maker, "--set", "kind=brushed")
    assert "2 gearheads" in run("catalog", "import", "gears.csv", "-o", "gears.yaml", *maker)
    run("quote", "-o", "quote.csv")
    rows = {
        row["role"]: row for row in csv.DictReader((tmp_path / "quote.csv").read_text(encoding="utf-8").splitlines())
    }
    assert (rows["motor"]["order_number"], rows["gearhead"]["order_number"]) == ("M20-24", "G26-14")
    assert rows["motor"]["maker"] == rows["gearhead"]["maker"] == "Anymaker"


def test_parts_are_added_one_by_one_and_what_fits_is_assumed(run: Any, tmp_path: Path):
    said = add(run, **FIGURES)
    assert "motor 775 added to my.yaml" in said and "a sizing still needs: rotor inertia" in " ".join(said.split())
    written = (tmp_path / "my.yaml").read_text()
    (tmp_path / "my.yaml").write_text(f"# mine\n{written}")
    add(run, "--section", "gearheads", name="G 27:1", ratio="27", efficiency="80 %", rated_torque="2 N m")
    assert (tmp_path / "my.yaml").read_text().startswith(f"# mine\n{written[:60]}")
    catalog = load([str(tmp_path / "my.yaml")])
    assert catalog.motors.record(0).resistance == pytest.approx(12 / 70)
    pairs = zip(*catalog.motor_gearhead[:2], strict=True)
    assert ("775", "G 27:1") in [(catalog.motors["part"][m], catalog.gearheads["part"][g]) for m, g in pairs]
    assert catalog.sources[0].document == "a shop's page" and catalog.sources[0].confidence == "secondary"


@pytest.mark.parametrize(
    ("figures", "said"),
    [
        (FIGURES, 'part "775" is given twice'),
        ({"voltage": "12 V"}, "--set: the part has no name; expected e.g. --set name=775"),
        ({**FIGURES, "name": "x", "voltage": "12"}, '--set: voltage: "12" has no unit; expected voltage, e.g. 24 V'),
        ({**FIGURES, "name": "x", "maker": "Other"}, 'is of "Anymaker"; parts of "Other" need a file of their own'),
        ({"name": "x", "colour": "red"}, '--set: colour: unknown key "colour"'),
    ],
)
def test_a_wrong_part_is_one_line_and_changes_nothing(run: Any, tmp_path: Path, figures: dict[str, str], said: str):
    add(run, **FIGURES)
    before = (tmp_path / "my.yaml").read_bytes()
    found = add(run, **figures)
    assert said in found and "\n" not in found
    assert (tmp_path / "my.yaml").read_bytes() == before


def at_a_terminal(folder: Path, lines: list[str], *words: str) -> str:
    """The output of a command whose questions are answered at a terminal."""
    ours, theirs = pty.openpty()
    done = subprocess.Popen([sys.executable, "-m", "drivesizer", *words], cwd=folder, stdin=theirs, stdout=theirs)
    os.close(theirs)
    os.write(ours, "".join(f"{line}\n" for line in lines).encode())
    found = b""
    while True:
        try:
            piece = os.read(ours, 4096)
        except OSError:  # the other end is closed
            break
        if not piece:
            break
        found += piece
    assert done.wait(60) == 0, found
    return found.decode()


def test_a_terminal_is_asked_for_what_is_not_given(tmp_path: Path):
    answers = ["775", "", "brushed", "12", "12 V", "15000 rpm", "1.2 A", "0.5 N m", "70 A", *[""] * 6]
    said = at_a_terminal(tmp_path, answers, "catalog", "add", "-o", "my.yaml")
    assert 'voltage: "12" has no unit; expected voltage, e.g. 24 V' in said
    assert load([str(tmp_path / "my.yaml")]).motors.record(0).torque_constant == pytest.approx(0.5 / 70)


def test_an_import_asks_for_the_column_of_a_head_that_it_does_not_understand(tmp_path: Path):
    (tmp_path / "list.csv").write_text("Model;Rated voltage [V];No-load speed [rpm];Zwirbel [mNm]\nA;24;9000;30\n")
    answers = ["nominal_torqe", "nominal_torque", "brushed"]
    said = at_a_terminal(tmp_path, answers, "catalog", "import", "list.csv", "-o", "own.yaml", "--section", "motors")
    assert '"nominal_torqe" is not known' in said
    motor = load([str(tmp_path / "own.yaml")]).motors.record(0)
    assert (motor.nominal_torque, motor.kind) == (pytest.approx(0.03), "brushed")
