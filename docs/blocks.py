"""The blocks of the pages: found, run, and their output brought up to date.

    python docs/blocks.py [PAGE ...]      writes into the pages what their commands print now

Commands of a ``bash`` block run one after the other in a folder of the page's own, which starts empty; ``examples/``
that it has not are the project's. A ``text`` block after it is what they print, a line ``...`` stands for lines left
out. A ``yaml`` or ``csv`` block with a title is that file from there on. tests/docs/test_docs.py runs all of it.
"""

from __future__ import annotations

import difflib
import io
import os
import re
import shlex
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

__all__ = ["ROOT", "Block", "Shell", "blocks", "commands", "shown", "written"]

ROOT = Path(__file__).resolve().parent.parent
_FENCE = re.compile(r"^( *)```([^\n`]*)\n(.*?)^\1```[ ]*$", re.MULTILINE | re.DOTALL)
_TITLE = re.compile(r'title="([^"]+)"')
_STATUS = re.compile(r"\s+# exit status (\d)$")
_PLAIN = ("cat", "cd", "cp", "head", "ls", "mkdir", "sed", "tail")  # besides drivesizer
_ELSEWHERE = {  # what makes or builds the project: it must be there; the gate runs it
    "pip install .": "pyproject.toml", "mkdocs build --strict": "mkdocs.yml", ".ci/run": ".ci/run",
    "python docs/generate.py": "docs/generate.py", "python docs/generate.py figures": "docs/generate.py",
}  # fmt: skip
_CUT = "..."


@dataclass(frozen=True, slots=True)
class Block:
    """A fenced block of a page."""

    language: str
    title: str
    text: str
    line: int
    start: int  # of its text in the page
    end: int


class Said(NamedTuple):
    """What a command printed, results and messages as they come, and its exit status."""

    text: str
    status: int


def blocks(page: str) -> list[Block]:
    """All fenced blocks of a page, in their order."""
    found = []
    for match in _FENCE.finditer(page):
        head, title = match[2].strip(), _TITLE.search(match[2])
        language = head.split()[0] if head else ""
        line = page.count("\n", 0, match.start()) + 1
        body = re.sub(rf"^{match[1]}", "", match[3], flags=re.MULTILINE)
        found.append(Block(language, title[1] if title else "", body, line, *match.span(3)))
    return found


def commands(text: str) -> list[tuple[str, int]]:
    """The commands of a block with the exit status that each says it has; a comment after two blanks is none of it."""
    found = []
    for line in text.replace("\\\n", " ").splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        status = _STATUS.search(line)
        found.append((re.sub(r"\s{2,}#.*$", "", line).strip(), int(status[1]) if status else 0))
    return found


class Shell:
    """Runs the commands of a page in a folder; ``drivesizer`` in this process."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def write(self, name: str, text: str) -> None:
        """A file as a page shows it."""
        (self.folder / name).write_text(text, encoding="utf-8")

    def run(self, command: str) -> Said:
        """Run one command; what it prints, blanks at the ends of lines taken off.

        Raises
        ------
        ValueError
            When a page should not have such a command.
        """
        if _elsewhere(command):
            return Said("", 0)
        words = shlex.split(command)
        target = words[-1] if len(words) > 2 and words[-2] == ">" else ""
        if words[0] == "cd":
            self.folder = (self.folder / words[1]).resolve()
            return Said("", 0)
        if words[0] == "drivesizer":
            said = _drivesizer([self._found(word) for word in (words[1:-2] if target else words[1:])], self.folder)
        elif words[0] in _PLAIN:
            words = words[:-2] if target else words
            done = subprocess.run(words, cwd=self.folder, capture_output=True, encoding="utf-8", check=False)  # noqa: S603
            said = Said(done.stdout + done.stderr, done.returncode)
        else:
            raise ValueError(f"{words[0]}: no command that a page runs; expected drivesizer, {', '.join(_PLAIN)}")
        if target:
            self.write(target, said.text)
            return Said("", said.status)
        return Said("".join(f"{line.rstrip()}\n" for line in said.text.splitlines()), said.status)

    def _found(self, word: str) -> str:
        """An example of the project by its path."""
        own = word.startswith("examples/") and not (self.folder / word).exists()
        return str(ROOT / word) if own else word


def _elsewhere(command: str) -> bool:
    """Whether a command builds the project, and is one that there is."""
    if command.startswith("make "):
        rules = (ROOT / "Makefile").read_text(encoding="utf-8")
        return all(re.search(rf"^{re.escape(word)}:", rules, re.MULTILINE) for word in command.split()[1:])
    return command in _ELSEWHERE and (ROOT / _ELSEWHERE[command]).exists()


def _drivesizer(words: list[str], folder: Path) -> Said:
    """The command line in this process, as at a terminal of 80 columns."""
    from drivesizer.cli import main

    out, showwarning = io.StringIO(), warnings.showwarning
    with _at(folder), warnings.catch_warnings(), redirect_stdout(out), redirect_stderr(_Messages(out)):
        before, sys.argv = sys.argv, ["drivesizer", *words]
        try:
            main()
        except SystemExit as stopped:
            status = int(stopped.code or 0)
        finally:
            sys.argv, warnings.showwarning = before, showwarning
    return Said(out.getvalue(), status)


class _Messages(io.TextIOBase):
    """stderr into the same text; without the empty line that a progress bar leaves where it is not shown."""

    def __init__(self, into: io.StringIO) -> None:
        self.into = into

    def write(self, text: str) -> int:
        if text != "\n" or not self.into.getvalue().endswith("\n"):
            self.into.write(text)
        return len(text)


@contextmanager
def _at(folder: Path) -> Iterator[None]:
    """Another current folder, and a terminal of 80 columns without colour."""
    here, environment = Path.cwd(), dict(os.environ)
    os.chdir(folder)
    os.environ |= {"COLUMNS": "80", "NO_COLOR": "1", "TERM": "dumb"}
    try:
        yield
    finally:
        os.chdir(here)
        os.environ.clear()
        os.environ |= environment


def shown(block: str, output: str) -> str:
    """Where a text block is not what was printed: its first line that does not follow, or nothing."""
    lines, at, skipping = output.rstrip().splitlines(), 0, False
    for part in _chunks(block):
        starts = range(at, len(lines) - len(part) + 1) if skipping else [at]
        place = next((n for n in starts if lines[n : n + len(part)] == part), None)
        if place is None:
            given = lines[at : at + len(part)]
            wrong = next((i for i, line in enumerate(part) if given[i : i + 1] != [line]), 0)
            return part[0] if skipping else part[wrong]
        at, skipping = place + len(part), True
    return "" if at == len(lines) or block.splitlines()[-1].strip() == _CUT else lines[at]


def _chunks(block: str) -> list[list[str]]:
    """Lines between ellipses; the first chunk is at the start, empty where lines are left out."""
    found: list[list[str]] = [[]]
    for line in block.splitlines():
        if line.strip() == _CUT:
            found.append([])
        else:
            found[-1].append(line)
    return [part for n, part in enumerate(found) if part or n == 0]


def renewed(block: str, output: str) -> str:
    """A text block as it is now: each chunk from the line most like its first to that most like its last."""
    lines, at, made = output.rstrip().splitlines(), 0, []
    cut = [line.strip() == _CUT for line in block.splitlines()]
    chunks = _chunks(block)
    for n, part in enumerate(chunks):
        if not part:
            continue
        first = _most_like(part[0], lines, at, at) if n else 0
        last = _most_like(part[-1], lines, first, first + len(part) - 1) if len(part) > 1 else first
        if n == len(chunks) - 1 and not cut[-1]:  # a page that cuts nothing at the end shows all to the end
            last = len(lines) - 1
        if n:
            made.append(_CUT)
        made += lines[first : last + 1]
        at = last + 1
    if cut and cut[-1]:
        made.append(_CUT)
    return "".join(f"{line}\n" for line in made)


def _most_like(line: str, lines: list[str], start: int, expected: int) -> int:
    """The line from the start on that is most like another; of equals, the nearest to where it is expected."""

    def likeness(other: str) -> float:
        bare = [" ".join(re.sub(r"[\d.,]+", "0", text).split()) for text in (line, other)]
        begins = 0.5 if bare[1].startswith(bare[0]) else 0.0
        return difflib.SequenceMatcher(None, *bare, autojunk=False).ratio() + begins

    return max(range(start, len(lines)), key=lambda n: (likeness(lines[n]), -abs(n - expected)))


def written(page: str, folder: Path, text_block: Callable[[Block, str], None]) -> None:
    """Run a page's blocks in a folder.

    Parameters
    ----------
    page
        Its Markdown.
    folder
        Where its commands run.
    text_block
        Called with each text block that follows commands, and what they printed.

    Raises
    ------
    ValueError
        When a command ends with another status than the page says, or a block has no language that is known.
    """
    shell, output = Shell(folder), ""
    for block in blocks(page):
        if block.language in ("yaml", "csv") and block.title:
            shell.write(block.title, block.text)
        elif block.language == "bash":
            output = ""
            for command, expected in commands(block.text):
                said = shell.run(command)
                if said.status != expected:
                    raise ValueError(f"line {block.line}: {command}: exit status {said.status}\n{said.text}")
                output += said.text
        elif block.language == "text":
            text_block(block, output)


def main(names: list[str]) -> None:
    """Bring pages up to date."""
    pages = [Path(name) for name in names] or sorted((ROOT / "docs").rglob("*.md"))
    for path in pages:
        text = path.read_text(encoding="utf-8")
        found: list[tuple[Block, str]] = []
        with tempfile.TemporaryDirectory() as folder:
            written(text, Path(folder), lambda block, output, into=found: into.append((block, output)))
        for block, output in reversed(found):
            now = renewed(block.text, output)
            if now != block.text:
                print(f"{path}:{block.line}: renewed")
                text = text[: block.start] + now + text[block.end :]
        path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
