"""The command line as a page, out of the commands themselves."""

from __future__ import annotations

from typing import Any

import typer.main

from drivesizer.cli import app

__all__ = ["commands"]


def commands() -> str:
    """Every command with its arguments, options and example."""
    root = typer.main.get_command(app)
    return "\n\n".join(_command(path, command, depth=2) for path, command in _walk((), root) if path)


def _walk(path: tuple[str, ...], command: Any) -> list[tuple[tuple[str, ...], Any]]:
    """A command and those below it."""
    found = [(path, command)]
    for name, below in getattr(command, "commands", {}).items():
        found += _walk((*path, name), below)
    return found


def _command(path: tuple[str, ...], command: Any, depth: int) -> str:
    name = " ".join(("drivesizer", *path))
    context = command.make_context(name, [], resilient_parsing=True)
    usage = " ".join(command.collect_usage_pieces(context))
    parts = [f"{'#' * (depth + len(path) - 1)} {name}", _text(command.help or "")]
    if getattr(command, "commands", None):
        return "\n\n".join(parts)
    parts.append(f"`{name} {usage}`")
    rows = [_row(p, context) for p in command.params if not p.hidden]
    if rows:
        parts.append("\n".join(["| | what it is | default |", "|---|---|---|", *rows]))
    if command.epilog:
        example = command.epilog.removeprefix("Example: ")
        parts.append(f"Example: `{example}`")
    return "\n\n".join(parts)


def _row(parameter: Any, context: Any) -> str:
    """An argument or option as a row of the table, under the name that its help shows."""
    if parameter.param_type_name == "argument":
        name = f"`{parameter.metavar or parameter.name.upper()}`"
    else:
        name = f"`{parameter.get_help_record(context)[0].replace('int range', 'int')}`"
    missing = "**required**" if parameter.required else _default(parameter)
    return f"| {name} | {_text(parameter.help or '')} | {missing} |"


def _default(parameter: Any) -> str:
    value = parameter.default
    if value in (None, False, "") or callable(value):
        return ""
    return f"`{value}`"


def _text(words: str) -> str:
    return " ".join(words.split()).replace("|", "\\|").replace("<", "&lt;").replace("*", "\\*")
