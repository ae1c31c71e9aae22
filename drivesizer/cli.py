"""The command line: parse, call, print.

Exit status: 0 a drive was found or passes, also where that is unknown for lack of a figure, 1 none does, 2 the input
is wrong or an output cannot be written (one line says where and what), 70 drivesizer itself is at fault, 130 it
was interrupted. Results go to stdout, warnings and errors to stderr.
"""

from __future__ import annotations

import contextlib
import gc
import importlib
import os
import re
import sys
import warnings
from collections.abc import Callable, Collection
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drivesizer.commands.common import STOPPED, NothingFitsError
from drivesizer.errors import DrivesizerError, InputError, nearest, printable, quoted, reason_of
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


# -- A command line that cannot be parsed, in the words of all refusals: what was found, what is expected, an example.
#
# Typer brings a click of its own or uses the one that is installed, so that its errors are known here by their
# names.


_ALONE = {"--profile": "spec"}  # options that may stand alone, and the value that they have then

# the root of what a user can get wrong, of whichever click it is
_UsageError: type[Exception] = next(c for c in typer.BadParameter.__mro__ if c.__name__ == "ClickException")


def parsed(run: Callable[[], int | None], program: Callable[[], typer.Typer], words: list[str]) -> int | None:
    """Run a command line; without any words the help is printed."""
    try:
        return run()
    except _UsageError as error:
        if type(error).__name__ != "NoArgsIsHelpError":
            raise InputError(_line_of(error, typer.main.get_command(program()), words)) from None
        print(error.ctx.get_help())  # type: ignore[attr-defined]
        return 0


def with_values(words: list[str]) -> list[str]:
    """A command line in which an option that may stand alone has its value, also before another option or the spec.

    >>> with_values(["validate", "robot.yaml", "--profile", "--json"])
    ['validate', 'robot.yaml', '--profile', 'spec', '--json']
    >>> with_values(["validate", "--profile", "robot.yaml"])
    ['validate', '--profile', 'spec', 'robot.yaml']
    >>> with_values(["validate", "--profile", "s-curve"])
    ['validate', '--profile', 's-curve']
    """
    whole = []
    for word, after in zip(words, [*words[1:], "-"], strict=False):
        whole.append(word)
        if word in _ALONE and (after.startswith("-") or after.lower().endswith((".yaml", ".yml"))):
            whole.append(_ALONE[word])
    return whole


def _line_of(error: Any, program: Any, words: list[str]) -> str:
    path, command = "", program
    for word in words:
        if word not in getattr(command, "commands", {}):
            break
        path, command = f"{path} {word}".lstrip(), command.commands[word]
    example = (command.epilog or f"drivesizer {path} --help".replace("  ", " ")).removeprefix("Example: ")
    return f"{path and f'{path}: '}{_found_and_expected(error, command)}, e.g. `{example}`"


def _found_and_expected(error: Any, command: Any) -> str:
    """Fault of a command line, by the type of error and, of some, by its words."""
    arguments = [parameter for parameter in command.params if parameter.param_type_name == "argument"]
    flags = [name for parameter in command.params if getattr(parameter, "is_flag", False)
             for name in (*parameter.opts, *parameter.secondary_opts)]  # fmt: skip
    message = error.format_message()
    match type(error).__name__:
        case "MissingParameter" if error.param.param_type_name == "argument":
            return f"{_argument(error.param)} is missing; expected one"
        case "MissingParameter":
            name = max(error.param.opts, key=len)
            return f"{name} is missing; expected {name} with its value"
        case "NoSuchOption":
            options = (name for parameter in command.params for name in (*parameter.opts, *parameter.secondary_opts))
            known = [name for name in options if name.startswith("--")]
            expected = f"expected {', '.join(known) or 'none'}"
            return f"{quoted(error.option_name)} is no option; {expected}{nearest(error.option_name, known)}"
        case "BadOptionUsage" if error.option_name in flags:
            return f"{error.option_name} takes no value; expected {error.option_name} alone"
        case "BadOptionUsage":
            return f"{error.option_name} has no value; expected one behind it"
    if hasattr(command, "commands") and (match := re.search(r"No such command '(.*?)'", message)):
        known = list(command.commands)
        return f"{quoted(match[1])} is no command; expected {', '.join(known)}{nearest(match[1], known)}"
    if match := re.search(r"unexpected extra arguments?(?:\(s\))? \((.*)\)", message):
        expected = " and ".join(map(_argument, arguments)) or "no argument"
        return f"{quoted(match[1])} is more than it takes; expected {expected}"
    return f"{message.rstrip('.')}; expected what its --help says"


def _argument(parameter: Any) -> str:
    """An argument as the help names it."""
    return str(parameter.metavar or parameter.name.upper())


# -- End of a command: every failure becomes one line on stderr and an exit status.
#
# An error of the user's is printed as it is. Anything else is reported as a fault of the program, with the way to
# see where it arose.


FAULT = 70  # exit status where the program itself is at fault, as in sysexits.h
_REFUSING = ("strict", "surrogateescape")  # of characters that the encoding lacks; the second in the locale C
TRACEBACK = "DRIVESIZER_TRACEBACK"  # set in the environment: a fault shows where it arose


def ended(command: Callable[[], int | None]) -> int:
    """Run a command; its exit status, after the one line that a failure ends in."""
    _opened()
    try:
        status = command() or 0
        sys.stdout.flush()  # what cannot be written shows here, and not when Python ends
    except BaseException as error:
        if os.environ.get(TRACEBACK):
            import traceback

            traceback.print_exc()
        message, status = _reported(error)
        for line in error.lines if isinstance(error, InputError) else [message]:
            _say(line)
        _forget_output()
    return status


def _reported(error: BaseException) -> tuple[str, int]:
    """Message and exit status of a failure; no message where the reader is gone or the user stopped the command."""
    if isinstance(error, NothingFitsError):
        return str(error), 1
    if isinstance(error, DrivesizerError):
        return str(error), 2
    if isinstance(error, KeyboardInterrupt | typer.Abort):
        return "", STOPPED
    if isinstance(error, BrokenPipeError | SystemExit):  # typer makes the second of the first: our reader went away
        return "", 0
    if isinstance(error, MemoryError):
        return "more memory is needed than there is", 2
    if isinstance(error, OSError):
        what = f"{error.filename}: cannot be read or written" if error.filename else "the output cannot be written"
        return f"{what} ({reason_of(error)})", 2
    fault = f"{type(error).__name__}: {error}"[:300]
    return f"a fault of drivesizer itself ({fault}); please report it; {TRACEBACK}=1 shows where it arose", FAULT


def _opened() -> None:
    """Have streams to write to that take every character, also where a shell closed them (``>&-``)."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, Path(os.devnull).open("w"))  # noqa: SIM115  until the process ends
        elif getattr(getattr(sys, name), "errors", "") in _REFUSING and hasattr(getattr(sys, name), "reconfigure"):
            getattr(sys, name).reconfigure(errors="backslashreplace")


def _say(message: str) -> None:
    if message:
        with contextlib.suppress(OSError):  # no message can be written
            print(f"drivesizer: {printable(' '.join(message.split()))}", file=sys.stderr, flush=True)


def _forget_output() -> None:
    """Let what is not written yet go nowhere, so that Python does not try again as it ends."""
    try:
        sys.stdout.flush()
    except (OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)
