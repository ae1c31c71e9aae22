"""What the pages show is run: every command, what it prints, every spec, catalogue and piece of Python."""

from __future__ import annotations

import re
import shutil
import sys
from pathlib import Path

import pytest
from catalog_texts import MAP, SHEET
from motor_logs import motor_log

from drivesizer.catalog import load
from drivesizer.files.yaml_source import YamlSource
from drivesizer.spec.machine import is_machine, read_machine
from drivesizer.spec.robot import read_spec

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "docs"))

from blocks import Shell, blocks, commands, shown, written  # noqa: E402

PAGES = sorted((ROOT / "docs").rglob("*.md"))
LANGUAGES = {"bash", "text", "python", "yaml", "csv", "sh"}  # sh: commands that are run each alone
README = (ROOT / "README.md").read_text(encoding="utf-8")
CATALOGUES = (ROOT / "docs" / "catalogues.md").read_text(encoding="utf-8")


def text_of(page):
    return page.read_text(encoding="utf-8")


def said_by(code):
    """What a piece of Python says that it prints: comments on lines of their own, and behind a print."""
    return [m[1] for m in re.finditer(r"^(?:print\(.*\)  )?# (.*)$", code, re.MULTILINE)]


REST = {"name": "shown", "supply": "{nominal: 48 V}", "transmission": "[{kind: gearhead}]"}  # of a spec shown in part


def read(text, folder):
    """A spec, which may be shown in part, or a catalogue by the strict reader."""
    if text.startswith("catalog:"):
        path = folder / "shown.yaml"
        path.write_text(text, encoding="utf-8")
        return load([str(path)])
    if text.startswith("load:"):
        text += "".join(f"{field}: {value}\n" for field, value in REST.items() if f"\n{field}:" not in text)
    source = YamlSource(text, "shown.yaml")
    return read_machine(source) if is_machine(source) else read_spec(source)


# --- the pages


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_block_of_a_page_has_a_language_that_is_run(page):
    known = {block.language for block in blocks(text_of(page))}
    assert known <= LANGUAGES
    fences = len(re.findall(r"^ *```", text_of(page), re.MULTILINE))
    assert fences == 2 * len(blocks(text_of(page)))  # none is left open, none is overlooked
    assert not re.search(r"(?:^|\n\n)(?:    |\t)(?![-*\d ]).*\n", re.sub(r"(?s)```.*?```", "", text_of(page)))


@pytest.mark.slow
@pytest.mark.parametrize("page", [p for p in PAGES if "```" in text_of(p)], ids=lambda page: page.stem)
def test_what_a_page_shows_is_what_happens(page, tmp_path, monkeypatch, capsys):
    """In the order of the page, in one folder: commands, what they print, and Python."""
    compared = []

    def compare(block, output):
        assert shown(block.text, output) == "", f"{page.name}:{block.line}\n{output}"
        compared.append(block)

    written(text_of(page), tmp_path, compare)
    found = blocks(text_of(page))
    assert len(compared) == sum(block.language == "text" for block in found)
    monkeypatch.chdir(tmp_path)
    capsys.readouterr()
    for block in found:
        if block.language == "python":
            exec(compile(block.text, f"{page.name}:{block.line}", "exec"), {})
            assert capsys.readouterr().out.splitlines() == said_by(block.text)
        elif block.language == "yaml" and not block.title:
            read(block.text, tmp_path)


def test_a_text_follows_the_commands_that_print_it():
    for page in PAGES:
        order = [block.language for block in blocks(text_of(page)) if block.language in ("bash", "text")]
        assert all(order[n - 1 : n] == ["bash"] for n, language in enumerate(order) if language == "text"), page.name


@pytest.mark.parametrize("name", ["README.md", "CONTRIBUTING.md"])
def test_what_is_linked_is_there(name):
    for target in re.findall(r"\]\(([^)#]+)", (ROOT / name).read_text(encoding="utf-8")):
        assert target.startswith("http") or (ROOT / target).exists(), target


def test_lines_of_code_fit_the_page():
    for page in PAGES:
        for block in blocks(text_of(page)):
            if page.name not in ("catalogues.md", "loads.md") and block.language in ("yaml", "python"):
                assert max(map(len, block.text.splitlines())) <= 92, f"{page.name}:{block.line}"


# --- README and CONTRIBUTING


_RUN: dict[str, object] = {}  # what a command said, so that none is run twice


@pytest.fixture
def desk(tmp_path):
    """A folder with what the examples of the help name, each command in a state as if it were the first."""
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    for name, text in (
        ("log.csv", motor_log(",")),
        ("parts.csv", SHEET),
        ("map.yaml", MAP),
        ("my_parts.yaml", catalogue_of_the_page()),
    ):
        (tmp_path / name).write_text(text, encoding="utf-8")

    def run(command):
        command = command.replace(" examples/sps_robot.yaml", "")  # it is the robot.yaml of the folder
        if command not in _RUN:
            _RUN[command] = anew(command)
        return _RUN[command]

    def anew(command):
        target = re.search(r"(?:-o|>) (\S+)", command)
        (tmp_path / (target[1] if target else "none")).unlink(missing_ok=True)
        if command.split()[1] == "init":
            (tmp_path / "robot.yaml").unlink(missing_ok=True)
        elif not target or target[1] != "robot.yaml":
            shutil.copy(ROOT / "examples" / "sps_robot.yaml", tmp_path / "robot.yaml")
        return Shell(tmp_path).run(command)

    return run


def catalogue_of_the_page():
    return next(block.text for block in blocks(CATALOGUES) if block.language == "yaml")


ENDLESS = "drivesizer serve"  # runs until it is stopped, in tests/live


@pytest.mark.slow
def test_every_command_that_is_listed_runs(desk):
    (block,) = (block for block in blocks(text_of(ROOT / "docs" / "commands.md")) if block.language == "sh")
    found = commands(re.sub(r"^ +#.*$", "", block.text, flags=re.MULTILINE))
    assert len(found) >= 10
    for command, _ in found:
        if command.startswith(ENDLESS):
            continue
        said = desk(command)
        assert said.status < 2, f"{command}\n{said.text}"
        fails = command.split()[1] in ("explain", "compare")  # a pair that falls; the log of a motor on its own bench
        assert said.status == 0 or fails, command


@pytest.mark.slow
def test_every_example_of_the_help_runs(desk):
    import typer.main

    from drivesizer.cli import app

    def examples(command):
        for below in getattr(command, "commands", {}).values():
            if not getattr(below, "commands", None):
                assert below.epilog, below.name
                yield below.epilog.removeprefix("Example: ")
            yield from examples(below)

    found = list(examples(typer.main.get_command(app)))
    assert len(found) >= 14
    for command in found:
        if command.startswith(ENDLESS):
            continue
        said = desk(command)
        assert said.status < 2, f"{command}\n{said.text}"


def test_blocks_of_the_readme_are_all_run():
    """yaml and text in test_package; what is indented is looked up."""
    assert sorted(block.language for block in blocks(README)) == ["text", "yaml"]
    for name in ("README.md", "CONTRIBUTING.md"):
        text = re.sub(r"(?s)```.*?```", "", (ROOT / name).read_text(encoding="utf-8"))
        for run in re.findall(r"(?:^    .*\n)+", text, re.MULTILINE):
            lines = [line[4:] for line in run.splitlines() if not line.startswith("     ")]
            for command, _ in commands("\n".join(lines)):
                assert command.startswith("drivesizer ") or Shell(ROOT).run(command).status == 0


# --- the page of the catalogues


def test_the_catalogue_on_the_page_is_read_as_it_says(tmp_path):
    (tmp_path / "example.yaml").write_text(catalogue_of_the_page(), encoding="utf-8")
    catalog = load([str(tmp_path / "example.yaml")])
    assert (len(catalog.motors), len(catalog.gearheads), len(catalog.motor_gearhead.left)) == (2, 2, 4)
    assert catalog.gearheads.record(0).ratio == 12.25
    assert catalog.confidence("motors", 0)["mass"] == "derived"
