"""What was found of an installation, at the terminal."""

from __future__ import annotations

from collections.abc import Iterable

from rich.text import Text

from drivesizer.commands.doctor import Finding
from drivesizer.output.terminal.tables import STYLE, bare, console

__all__ = ["examined"]


def examined(findings: Iterable[Finding]) -> None:
    """Print what was looked at in an installation, and what to do where it does not work."""
    found = list(findings)
    table = bare(("", "left"), ("found", "left"), ("", "left"))
    for one in found:
        mark = Text("ok", style=STYLE["pass"]) if one.works else Text("WRONG", style=STYLE["fail"])
        table.add_row(one.subject, one.found, mark)
    shown = console()
    shown.print(table)
    wrong = [one for one in found if not one.works]
    for one in wrong:
        shown.print(Text(f"{one.subject}: {one.remedy}"))
    if not wrong:
        shown.print("Everything works.")
