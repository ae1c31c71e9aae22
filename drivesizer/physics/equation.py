"""Declaration of an equation: number, symbols, units, printed form, and the formula itself, once.

The decorator reads names, meanings and bracketed units from the docstring, so that the documented unit is the
one that the program uses. A declared equation stays a function: with floats or arrays in SI it computes, with
pint quantities it first checks every dimension and gives back a quantity.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from dataclasses import field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError
from drivesizer.files.frozen import dataclass
from drivesizer.units import registry

__all__ = ["COMPANIONS", "EQUATIONS", "Equation", "Term", "Value", "equation", "terms"]

Value = float | NDArray[np.float64]

EQUATIONS: dict[int, Equation] = {}  # the paper's, by number
COMPANIONS: dict[str, Equation] = {}  # what the paper uses without a number, by function name


class Term(NamedTuple):
    """A quantity in an equation: its name in the code, what it is, its SI unit."""

    name: str
    meaning: str
    unit: str


@dataclass(frozen=True, slots=True, eq=False)
class Equation:
    """A declared equation; call it like the function that it holds."""

    number: int | None
    symbol: str
    formula: Callable[..., Any]
    title: str
    terms: tuple[Term, ...]
    result: Term
    kind: str
    shown: str  # unit of the trade in which the result is printed
    printed: str = ""  # as the paper has it, in our names; "" where the paper has no such equation
    printed_units: dict[str, str] = field(default_factory=dict)  # of symbols that only the printed form has
    note: str = ""

    @property
    def name(self) -> str:
        """The function's name, which is also the requirement's name in results."""
        return self.formula.__name__

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Compute; with pint quantities, check their dimensions first.

        Raises
        ------
        InputError
            When a quantity has the wrong dimension, or a plain number stands where a unit is needed.
        """
        given_ = (*args, *kwargs.values())
        if _PLAIN.issuperset(map(type, given_)) or not any(hasattr(value, "dimensionality") for value in given_):
            return self.formula(*args, **kwargs)
        given = inspect.signature(self.formula).bind(*args, **kwargs).arguments
        units = {term.name: term for term in self.terms}
        plain = {name: self._plain(value, units[name]) for name, value in given.items()}
        return registry().Quantity(self.formula(**plain), self.result.unit)

    def _plain(self, value: Any, term: Term) -> Any:
        where = f"{self.label}: {term.name} ({term.meaning}) must be in {term.unit}"
        if not hasattr(value, "dimensionality"):
            if term.unit == "1":
                return value
            raise InputError(f"{where}, got {value!r} without a unit")
        if not value.check(term.unit if term.unit != "1" else "[]"):
            raise InputError(f"{where}, got {value.units:~C}")
        return value.to(term.unit if term.unit != "1" else "dimensionless").magnitude

    @property
    def label(self) -> str:
        """Name of the equation in text: ``equation (10)``, or its title without a number."""
        return f"equation ({self.number})" if self.number else self.title


_PLAIN = {float, int, np.float64, np.ndarray}
_SECTION = re.compile(r"(Parameters|Returns)\n\s*-+\n(.*?)(?=\n\s*\n|\Z)", re.DOTALL)
_TERM = re.compile(r"\s*(\w+): (.*) \[([^\]]+)\]\s*")


def terms(formula: Callable[..., Any]) -> dict[str, tuple[Term, ...]]:
    """The terms that a formula's docstring lists, by its sections Parameters and Returns."""
    text = inspect.getdoc(formula) or ""
    sections: dict[str, tuple[Term, ...]] = {}
    for heading, block in _SECTION.findall(text):
        lines = re.sub(r"\n {4,}", " ", block).splitlines()
        matches = [_TERM.fullmatch(line) for line in lines]
        sections[heading] = tuple(Term(*match.groups()) for match in matches if match)
    return sections


def equation(
    number: int | None,
    symbol: str,
    kind: str,
    shown: str,
    *,
    printed: str = "",
    printed_units: dict[str, str] | None = None,
    note: str = "",
) -> Callable[[Callable[..., Any]], Equation]:
    """Declare the function below as an equation.

    Parameters
    ----------
    number
        The paper's number, or None for what the paper does not number.
    symbol
        The paper's symbol of the result.
    kind, shown
        Kind of quantity of the result, and the unit of the trade it is printed in.
    printed, printed_units
        The paper's own form, and the units of symbols that only this form has.
    note
        Where the printed form fails, or what a reader must know.

    Returns
    -------
    callable
        Decorator that makes an ``Equation`` of a function and enters it in the list of equations.
    """

    def declare(formula: Callable[..., Any]) -> Equation:
        sections = terms(formula)
        declared = Equation(
            number=number,
            symbol=symbol,
            formula=formula,
            title=(inspect.getdoc(formula) or "").splitlines()[0].rstrip("."),
            terms=sections["Parameters"],
            result=sections["Returns"][0],
            kind=kind,
            shown=shown,
            printed=printed,
            printed_units=printed_units or {},
            note=note,
        )
        if number is None:
            COMPANIONS[declared.name] = declared
        else:
            EQUATIONS[number] = declared
        return declared

    return declare
