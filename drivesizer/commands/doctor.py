"""Check of an installation: libraries, cache, catalogues, fonts, terminal; with a remedy for each failure."""

from __future__ import annotations

import os
import platform
import re
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator, Sequence
from importlib import metadata, resources
from pathlib import Path
from typing import NamedTuple

from drivesizer.errors import DrivesizerError, reason_of
from drivesizer.output.words import number_of
from drivesizer.version import __version__


class Finding(NamedTuple):
    """Result of one check of the installation."""

    subject: str
    found: str
    works: bool
    remedy: str = ""  # where it does not work


def examined() -> list[Finding]:
    """Everything that a command needs, in the order in which it would fail."""
    return [finding for look in (_program, _libraries, _cache, _catalogues, _machine_code, _report, _terminal)
            for finding in _findings_of(look)]  # fmt: skip


def _findings_of(look: Callable[[], Iterator[Finding]]) -> list[Finding]:
    """Findings of one check; a failure inside it is a finding too."""
    findings: list[Finding] = []
    try:
        findings.extend(look())
    except (DrivesizerError, ImportError, OSError, RuntimeError) as error:
        name = look.__name__.strip("_").replace("_", " ")
        findings.append(Finding(name, f"{type(error).__name__}: {error}", False, "install drivesizer anew"))
    return findings


def _program() -> Iterator[Finding]:
    yield Finding("drivesizer", f"{__version__} in {Path(str(resources.files('drivesizer')))}", True)
    yield Finding("Python", f"{platform.python_version()} ({sys.executable})", sys.version_info >= (3, 11),
                  "drivesizer needs Python 3.11 or later")  # fmt: skip


def _libraries() -> Iterator[Finding]:
    """Each library that drivesizer names, with the least version required; one of an extra may be missing."""
    for line in metadata.requires("drivesizer") or ():
        required = re.match(r"([\w.-]+)\s*>=\s*([\d.]+)(?:\s*;\s*(.*))?$", line)
        extra = re.search(r"extra\s*==\s*['\"](\w+)", line)
        below = re.search(r"python_version\s*<\s*['\"]([\d.]+)", (required and required[3]) or "")
        of_later = below is not None and sys.version_info[:2] >= tuple(_number(below[1]))
        if required is None or of_later or (extra and extra[1] == "dev"):
            continue
        name, least = required[1], required[2]
        try:
            version = metadata.version(name)
        except metadata.PackageNotFoundError:
            state = f"not installed, optional: pip install drivesizer[{extra[1]}]" if extra else "missing"
            yield Finding(name, state, extra is not None, f"pip install '{name}>={least}'")
            continue
        yield Finding(name, version, _number(version) >= _number(least), f"pip install '{name}>={least}'")


def _number(version: str) -> list[int]:
    """Leading numbers of a version.

    >>> _number("0.10.2.post1")
    [0, 10, 2]
    """
    leading = re.match(r"\d+(?:\.\d+)*", version)
    return [int(part) for part in leading[0].split(".")] if leading else []


def _cache() -> Iterator[Finding]:
    from drivesizer.files.cache import folder

    place = folder()
    try:
        place.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=place):
            pass
    except OSError as error:
        state = f"{place} cannot be written ({reason_of(error)})"
        yield Finding("cache", state, False, "every start is slower; name another folder with DRIVESIZER_CACHE")
        return
    files = [path for path in place.rglob("*") if path.is_file()]
    size = sum(path.stat().st_size for path in files) / 1e6
    yield Finding("cache", f"{place}: {number_of(len(files), 'file')}, {size:.1f} MB", True)


def _catalogues() -> Iterator[Finding]:
    from drivesizer.catalog import load
    from drivesizer.files.cache import CacheWarning

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CacheWarning)  # the cache's own finding says it
        parts = load(("all",))
    counts = ", ".join(f"{len(getattr(parts, name).rows)} {name}" for name in ("motors", "gearheads", "actuators"))
    text = f"{number_of(len(parts.digests), 'file')}: {counts}"
    yield Finding("catalogues", text, bool(parts.digests), "install drivesizer anew")


def _machine_code() -> Iterator[Finding]:
    from drivesizer.control.engine import is_compiled

    ready = is_compiled()
    slow = "not at hand as machine code, some hundred times slower without numba"
    yield Finding("closed loop", "ready as machine code" if ready else slow, ready, "install drivesizer anew")


def _report() -> Iterator[Finding]:
    """Whether a page can be set and a figure drawn."""
    from drivesizer.output.report.figures.style import Drawing
    from drivesizer.output.report.pdf import fonts

    figure = Drawing(lambda figure: figure.add_subplot().plot([0.0, 1.0]))()
    yield Finding("figures", f"drawn by matplotlib ({len(figure)} bytes)", figure.startswith(b"<?xml"))
    import typst

    page: bytes = typst.compile(b'#set text(font: "DejaVu Sans")\nA page', font_paths=fonts(), format="pdf")
    yield Finding("PDF and fonts", f"set by typst ({len(page)} bytes)", page.startswith(b"%PDF"))


def _terminal() -> Iterator[Finding]:
    from drivesizer.output.terminal.tables import console

    terminal = console()
    colour = "colour" if terminal.color_system else "no colour"
    because = " (NO_COLOR)" if os.environ.get("NO_COLOR") else ""
    yield Finding("terminal", f"{terminal.width} columns, {colour}{because}, {terminal.encoding}", True)
    works = terminal.encoding.lower().replace("-", "") == "utf8"
    if not works:
        yield Finding("letters", "Greek letters and frames cannot be shown", False, "set PYTHONUTF8=1")


def print_findings(findings: Sequence[Finding]) -> None:
    """Print what was examined, and the remedy where something does not work."""
    from drivesizer.commands.common import show_blocks
    from drivesizer.output.document import records as doc

    rows = [(finding.subject, finding.found, "ok" if finding.works else (doc.Strong("WRONG"),)) for finding in findings]
    remedies = [doc.Words(f"{finding.subject}: {finding.remedy}") for finding in findings if not finding.works]
    show_blocks([doc.table("installation", "", rows), *(remedies or [doc.Words("Everything works.")])])
