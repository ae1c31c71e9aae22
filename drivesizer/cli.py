"""The command line: parse, call, print.

Exit status: 0 a drive was found or passes, also where that is unknown for lack of a figure, 1 none does, 2 the input
is wrong or an output cannot be written (one line says where and what), 70 drivesizer itself is at fault, 130 it
was interrupted. Results go to stdout, warnings and errors to stderr; failures are reported in `commands.ends`.
"""

from __future__ import annotations

import gc
import importlib
import os
import sys
import warnings
from collections.abc import Collection
from functools import cache
from typing import TYPE_CHECKING, Annotated

import typer

from drivesizer.commands.ends import ended, parsed, with_values
from drivesizer.errors import InputError, printable
from drivesizer.files.text import listed
from drivesizer.version import __version__

if TYPE_CHECKING:
    app: typer.Typer  # of ``__getattr__``

_TABLE = {head: {name: rest for of, (name, *rest) in listed("drivesizer.commands", "commands.txt") if of == head}
          for head in ("commands", "groups")}  # fmt: skip
_COMMANDS, _GROUPS = _TABLE["commands"], _TABLE["groups"]  # by name, in the order of use


def _version(value: bool) -> None:
    if value:
        typer.echo(f"drivesizer {__version__}")
        raise typer.Exit


def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and stop.")
    ] = False,
) -> None:
    """Size electric drives from real catalogues: one robot.yaml in, the drive with every check out."""


def _unloaded() -> None:
    """A command of which only the name and the short help are wanted."""


def _with_commands(names: Collection[str], *, loaded: bool = True) -> typer.Typer:
    """The command line with some of its commands, whose modules are loaded unless only their names are wanted."""
    app = typer.Typer(
        name="drivesizer",
        no_args_is_help=True,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    )
    app.callback()(_root)
    for name, (module, short, example) in _COMMANDS.items():
        if name in names:
            command = getattr(importlib.import_module(f"drivesizer.{module}"), name) if loaded else _unloaded
            app.command(name, short_help=short, epilog=f"Example: drivesizer {example}")(command)
    for name, (module, short) in _GROUPS.items():
        if name in names:
            group = importlib.import_module(f"drivesizer.{module}").app if loaded else typer.Typer(callback=_unloaded)
            app.add_typer(group, name=name, short_help=short)
    return app


@cache
def _whole() -> typer.Typer:
    return _with_commands(_COMMANDS | _GROUPS)


def __getattr__(name: str) -> typer.Typer:
    """``app``, all of the command line, loaded where a program imports it."""
    if name == "app":
        return _whole()
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def _command_line_of(arguments: list[str]) -> typer.Typer:
    """The command line with the one command that is run: loading the others would take as long as to parse."""
    completes = "_DRIVESIZER_COMPLETE" in os.environ  # a shell wants to know what may stand where the cursor is
    if completes:
        arguments = (os.environ.get("_TYPER_COMPLETE_ARGS") or os.environ.get("COMP_WORDS", "")).split()[1:]
    named = {*arguments[:1]}
    if named & (_COMMANDS.keys() | _GROUPS.keys()):
        return _with_commands(named)
    if completes or named & {"-h", "--help", "--version"}:
        return _with_commands(_COMMANDS | _GROUPS, loaded=False)
    return _whole()


def main() -> None:
    """Run the command line; every failure ends in one line and a status."""
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # else every package is searched for some
    warnings.showwarning = lambda message, *_, **__: print(f"note: {printable(str(message))}", file=sys.stderr)
    warnings.filterwarnings("ignore", category=RuntimeWarning)  # a figure beyond all numbers is reported as unknown
    status = ended(_run)
    gc.freeze()  # else Python looks through all objects twice more as it ends: a seventh of a `drivesizer size`
    sys.exit(status)


def _run() -> int | None:
    if sys.flags.optimize > 1:
        raise InputError("Python runs without docstrings (-OO, PYTHONOPTIMIZE=2), of which drivesizer reads its "
                         "equations; expected at most -O, PYTHONOPTIMIZE=1")  # fmt: skip
    words = with_values(sys.argv[1:])
    return parsed(lambda: _command_line_of(words)(args=words, standalone_mode=False), _whole, words)
