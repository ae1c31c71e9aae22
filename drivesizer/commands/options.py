"""Options and arguments of which typer would refuse a value in words of its own: numbers, and files.

What is wrong with a number is said with its option, its range and an example; what is wrong with a file where it is
read or written.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import inf
from typing import Any

import typer

from drivesizer.errors import DrivesizerError, quoted

__all__ = ["NumberError", "file_argument", "file_option", "number_option", "whole_option"]

# typer looks whether a file may be read, also where it is one to write
file_option = partial(typer.Option, readable=False)
file_argument = partial(typer.Argument, readable=False)


class NumberError(DrivesizerError):
    """A number that an option does not take; no ValueError, which typer would say in words of its own."""


def whole_option(
    option: str, example: int, low: float = -inf, high: float = inf, *, meaning: str, metavar: str = "<int>"
) -> Any:
    """An option that takes a whole number, as typer has it.

    Parameters
    ----------
    option, meaning, metavar
        Its name, ``--top``, its line of the help, and what stands there for the number.
    example
        A number that it takes.
    low, high
        Smallest and largest that it takes; infinite where there is none, or where what computes with it knows them.

    Returns
    -------
    typer.Option
        For the annotation of a command's parameter.
    """
    return typer.Option(option, parser=_whole(option, example, low, high), metavar=metavar, help=meaning)


def number_option(option: str, example: float, *, meaning: str) -> Any:
    """An option that takes a number, of which what computes with it knows the range.

    Parameters
    ----------
    option, example, meaning
        As of :func:`whole_option`.

    Returns
    -------
    typer.Option
        For the annotation of a command's parameter.
    """

    def read(text: object) -> float:
        try:
            return float(str(text))
        except ValueError:
            raise NumberError(f"{option}: {quoted(text)} is not a number; expected e.g. {example:g}") from None

    return typer.Option(option, parser=read, metavar="<float>", help=meaning)


def _whole(option: str, example: int, low: float, high: float) -> Callable[[object], int]:
    """Reader of the number, also of a default.

    >>> _whole("--top", 3, 1, 1000)("x")
    Traceback (most recent call last):
    drivesizer.commands.options.NumberError: --top: "x" is not a whole number; expected 1 to 1000, e.g. 3
    """
    limits = f"{low:.0f} or more, " if high == inf else f"{low:.0f} to {high:.0f}, "
    expected = f"expected {limits if low > -inf else ''}e.g. {example}"

    def read(text: object) -> int:
        try:
            value = int(str(text))
        except ValueError:
            raise NumberError(f"{option}: {quoted(text)} is not a whole number; {expected}") from None
        if not low <= value <= high:
            raise NumberError(f"{option}: {quoted(text)} is out of range; {expected}")
        return value

    return read
