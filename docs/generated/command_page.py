"""The command line as a page, out of the commands themselves."""

from __future__ import annotations

from collections import Counter
from typing import Any

import typer.main

from drivesizer.cli import app

__all__ = ["commands"]


def commands() -> str:
    """Every command with its arguments, options and example."""
    every = [(path, command) for path, command in _walk((), typer.main.get_command(app)) if path]
    rows = Counter(_row(p, command) for _, command in every for p in command.params if not p.hidden)
    shared = {row for row, count in rows.items() if count > 1}
    table = "\n".join(["| | what it is |", "|---|---|", *(row for row in rows if row in shared)])
    parts = [f"## Options of several commands\n\n{table}"]
    return "\n\n".join([*parts, *(_command(path, command, shared) for path, command in every)])


def _walk(path: tuple[str, ...], command: Any) -> list[tuple[tuple[str, ...], Any]]:
    """A command and those below it."""
    found = [(path, command)]
    for name, below in getattr(command, "commands", {}).items():
        found += _walk((*path, name), below)
    return found


def _command(path: tuple[str, ...], command: Any, shared: set[str]) -> str:
    name = " ".join(("drivesizer", *path))
    parts = [f"{'#' * (len(path) + 1)} {name}", _text(command.help or "")]
    if getattr(command, "commands", None):
        return "\n\n".join(parts)
    every = [_row(p, command) for p in command.params if not p.hidden]
    rows, common = [row for row in every if row not in shared], [row.split("`")[1] for row in every if row in shared]
    if rows:
        parts.append("\n".join(["| | what it is |", "|---|---|", *rows]))
    if common:
        names = ", ".join(f"`{name}`" for name in common)
        parts.append(f"And {names}: [of several commands](#options-of-several-commands).")
    if command.epilog:
        example = command.epilog.removeprefix("Example: ")
        parts.append(f"Example: `{example}`")
    return "\n\n".join(parts)


def _row(parameter: Any, command: Any) -> str:
    """An argument or option as a row of the table, under the name that its help shows."""
    context = command.make_context("drivesizer", [], resilient_parsing=True)
    if parameter.param_type_name == "argument":
        name = f"`{parameter.metavar or parameter.name.upper()}`"
    else:
        name = f"`{parameter.get_help_record(context)[0].replace('int range', 'int')}`"
    value = parameter.default
    if parameter.required:
        name = f"**{name}**"
    given = value not in (None, False, "") and not callable(value) and "default" not in (parameter.help or "")
    return f"| {name} | {_text(parameter.help or '')}{f' Else `{value}`.' if given else ''} |"


def _text(words: str) -> str:
    return " ".join(words.split()).replace("|", "\\|").replace("<", "&lt;").replace("*", "\\*")
