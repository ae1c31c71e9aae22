"""A command line that cannot be parsed, in the words of all refusals: what was found, what is expected, an example.

Typer brings a click of its own or uses the one that is installed, so that its errors are known here by their names.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any

import typer

from drivesizer.errors import InputError, nearest, quoted

__all__ = ["parsed", "with_values"]

_ALONE = {"--profile": "spec"}  # options that may stand alone, and the value that they have then

# the root of what a user can get wrong, of whichever click it is
_UsageError: type[Exception] = next(c for c in typer.BadParameter.__mro__ if c.__name__ == "ClickException")


def parsed(run: Callable[[], int | None], program: Callable[[], typer.Typer], words: list[str]) -> int | None:
    """Run a command line; without any words the help is printed.

    Parameters
    ----------
    run
        Parses and runs it, with typer's errors.
    program
        All commands, loaded where one must be named.
    words
        The command line, without the name of the program.

    Returns
    -------
    int or None
        Exit status of the command; none where it says nothing of it.

    Raises
    ------
    InputError
        When it cannot be parsed: command, found, expected, an example.
    """
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
    said = _SAID.get(type(error).__name__, _unknown_command)(error, command)
    example = (command.epilog or f"drivesizer {path} --help".replace("  ", " ")).removeprefix("Example: ")
    return f"{path and f'{path}: '}{said}, e.g. `{example}`"


def _missing(error: Any, command: Any) -> str:
    name = _name(error.param)
    return f"{name} is missing; expected {f'{name} with its value' if name.startswith('-') else 'one'}"


def _unknown_option(error: Any, command: Any) -> str:
    known = [name for one in command.params for name in _names(one) if name.startswith("--")]
    expected = f"expected {', '.join(known) or 'none'}"
    return f"{quoted(error.option_name)} is no option; {expected}{nearest(error.option_name, known)}"


def _option_misused(error: Any, command: Any) -> str:
    """An option without its value, or one that takes none with one."""
    flags = [name for one in command.params if getattr(one, "is_flag", False) for name in _names(one)]
    if error.option_name in flags:
        return f"{error.option_name} takes no value; expected {error.option_name} alone"
    return f"{error.option_name} has no value; expected one behind it"


def _unknown_command(error: Any, command: Any) -> str:
    """A command that there is not, or words too many, of one type of error."""
    message = error.format_message()
    if hasattr(command, "commands") and (found := re.search(r"No such command '(.*?)'", message)):
        known = list(command.commands)
        return f"{quoted(found[1])} is no command; expected {', '.join(known)}{nearest(found[1], known)}"
    if found := re.search(r"unexpected extra arguments?(?:\(s\))? \((.*)\)", message):
        names = [_name(one) for one in command.params if one.param_type_name == "argument"]
        return f"{quoted(found[1])} is more than it takes; expected {' and '.join(names) or 'no argument'}"
    return f"{message.rstrip('.')}; expected what its --help says"


def _names(parameter: Any) -> list[str]:
    """All that one may type for an option, ``--maps`` and ``--no-maps``."""
    return [*parameter.opts, *parameter.secondary_opts]


def _name(parameter: Any) -> str:
    """An argument or option as the help names it."""
    if parameter.param_type_name == "argument":
        return str(parameter.metavar or parameter.name.upper())
    return str(max(parameter.opts, key=len))


_SAID: Mapping[str, Callable[[Any, Any], str]] = {
    "MissingParameter": _missing,
    "NoSuchOption": _unknown_option,
    "BadOptionUsage": _option_misused,
}
