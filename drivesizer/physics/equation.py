"""Declaration of an equation: number, symbols, units, printed form, and the formula itself, once.

The decorator reads names, meanings and bracketed units from the docstring, so that the documented unit is the
one that the program uses. A declared equation stays a function: with floats or arrays in SI it computes, with
pint quantities it computes as well, and what pint makes of their units must be the declared unit of the result.
"""

from __future__ import annotations

import ast
import inspect
import re
import sys
import textwrap
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from math import inf, isfinite, nan
from numbers import Real
from typing import Any, NamedTuple

import numpy as np

from drivesizer.errors import InputError, quoted
from drivesizer.physics.figures import Array
from drivesizer.units import KINDS, kind_of_unit, noun

Value = float | Array
_signature = cache(inspect.signature)

EQUATIONS: dict[int, Equation] = {}  # the paper's, by number
COMPANIONS: dict[str, Equation] = {}  # what the paper uses without a number, by function name


class Term(NamedTuple):
    """A quantity in an equation: its name in the code, what it is, its SI unit."""

    name: str
    meaning: str
    unit: str

    @property
    def factor(self) -> bool:
        """Whether it is one that only takes away."""
        return self.meaning.endswith(", 0 to 1")


@dataclass(frozen=True, slots=True, eq=False)
class Declared:
    """An equation as its function has it; names, units, printed form and note are those of the docstring."""

    number: int | None
    symbol: str
    formula: Callable[..., Any]
    title: str
    terms: tuple[Term, ...]
    result: Term
    printed: str  # as the paper has it, in our names; "" where the paper has no such equation
    printed_units: dict[str, str]  # of symbols that only the printed form has
    note: str

    @property
    def name(self) -> str:
        """The function's name, which is also the requirement's name in results."""
        return self.formula.__name__

    @property
    def computed(self) -> str:
        """The expression that it computes, from its source."""
        return computed(self.formula)


@dataclass(frozen=True, slots=True, eq=False)
class Equation(Declared):
    """A declared equation; call it like the function that it holds."""

    kind: str
    display_unit: str  # unit of the trade in which the result is printed

    @property
    def __doc__(self) -> str | None:  # type: ignore[override]
        return self.formula.__doc__

    def __repr__(self) -> str:
        return f"{self.name}{inspect.signature(self.formula)}"

    def __getattr__(self, name: str) -> Any:  # of the record alone: its class has a name and a signature of its own
        if name == "__wrapped__":
            return self.formula
        if name == "__name__":
            return self.formula.__name__
        raise AttributeError(f"an equation has no {name}")

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Compute with numbers and arrays in SI, or with pint quantities in any unit of their terms.

        In an array NaN is unknown, as in a column of candidates; a single figure must be finite.

        Raises
        ------
        InputError
            When an argument is missing, no number, of another unit, or one at which the formula has no value.
        """
        types = {type(figure) for figure in (*args, *kwargs.values())}
        if np.ndarray in types and types <= _PLAIN:
            try:
                return self.formula(*args, **kwargs)
            except (TypeError, ValueError):
                pass  # the reason is found below
        elif types <= _PLAIN and (plain := _plain(self, args, kwargs)):
            return _result(self, plain)
        try:
            by_name = not args and kwargs.keys() == {term.name for term in self.terms}
            arguments = kwargs if by_name else _signature(self.formula).bind(*args, **kwargs).arguments
        except TypeError as error:
            terms = ", ".join(f"{term.name} [{term.unit}]" for term in self.terms)
            raise InputError(f"{self.label}: {error}; expected {terms}") from None
        with_units = [value for value in arguments.values() if hasattr(value, "dimensionality")]
        listed = [term for term in self.terms if term.name in arguments]
        plain = {term.name: _in_si(self, arguments[term.name], term, bool(with_units)) for term in listed}
        result = _result(self, plain)
        if not with_units:
            return result
        quantity = with_units[0]._REGISTRY.Quantity  # the caller's own: the result goes with other quantities there
        value = _single(self, **{term.name: quantity(plain[term.name], _pint(term.unit)) for term in listed})
        return quantity(value).to(_pint(self.result.unit))

    @property
    def label(self) -> str:
        """Name of the equation in text: ``equation (10)``, or its title without a number."""
        return f"equation ({self.number})" if self.number else self.title


_KIND_OF = {kind.si: name for name, kind in reversed(KINDS.items())}  # the first of each unit
_NEVER_BELOW_0 = {"length", "mass", "inertia", "density", "time", "dimensionless"}
_PLAIN = {float, int, np.float64, np.ndarray}
_LARGEST = sys.float_info.max


@cache
def _ends(declared: Equation) -> dict[str, tuple[float, float]]:
    """The least and the largest that a figure of each term may be."""
    least = {term.name: 0.0 if _KIND_OF[term.unit] in _NEVER_BELOW_0 else -_LARGEST for term in declared.terms}
    return {term.name: (least[term.name], 1.0 if term.factor else _LARGEST) for term in declared.terms}


def _plain(declared: Equation, args: tuple[Any, ...], kwargs: dict[str, Any]) -> dict[str, float]:
    """All arguments as single figures; none where one is missing, or beyond its ends."""
    ends = _ends(declared)
    figures = dict(zip(ends, args, strict=False)) | kwargs
    if not (figures.keys() == ends.keys() and len(args) + len(kwargs) == len(ends)):
        return {}
    within = all(ends[name][0] <= figure <= ends[name][1] for name, figure in figures.items())
    return {name: float(figure) for name, figure in figures.items()} if within else {}


def _in_si(declared: Equation, value: Any, term: Term, with_units: bool) -> Any:
    """An argument as a number or array in SI."""
    kind = _KIND_OF[term.unit]

    def refused(fault: str) -> InputError:
        text = f"{value:~C}" if hasattr(value, "dimensionality") else value
        got = quoted(text) if isinstance(value, str) else quoted(text)[1:-1]
        expected = "a plain number" if term.unit == "1" else f"in {term.unit}, e.g. {KINDS[kind].example}"
        return InputError(f"{declared.label}: {term.name} ({term.meaning}) must be {expected}; got {got}{fault}")

    figure = value
    if hasattr(value, "dimensionality"):
        fault = _misfit(value, term.unit, kind)
        if fault is not None:
            raise refused(fault)
        figure = value.to(_pint(term.unit)).magnitude
    elif with_units and term.unit != "1":
        raise refused(" without a unit")
    if isinstance(figure, Real) and not isinstance(figure, bool):
        try:
            figure = float(figure)
        except OverflowError:
            figure = inf
        if not isfinite(figure):
            raise refused(", no finite number")
        if figure < 0.0 and kind in _NEVER_BELOW_0:
            raise refused(", below 0")
        if figure > 1.0 and term.factor:
            raise refused(", above 1")
    elif not hasattr(figure, "__array__") or np.asarray(figure).dtype.kind not in "fiu":
        raise refused(", no number")
    return figure


def _misfit(value: Any, unit: str, kind: str) -> str | None:
    """Reason that a pint quantity is none of a term's unit; None where it is.

    Kinds that share a dimension stay apart as in a spec: joules are no torque, and a rotary speed counts an angle.
    """
    symbol = f"{value.units:~C}"
    other = kind_of_unit(symbol)
    if other not in (None, kind):
        return f", a unit of {noun(str(other))}"
    if not value.check(_pint(unit) or "[]"):
        return ""
    angle = dict(value.to_root_units().unit_items()).get("radian", 0)
    if angle != unit.count("rad") and (angle == 0 or unit == "1"):
        return ", which has no angle in it" if angle == 0 else ", an angle"
    return None


def _pint(unit: str) -> str:
    return "" if unit == "1" else unit


@np.errstate(all="ignore")
def _single(declared: Equation, *args: Any, **kwargs: Any) -> Any:
    """Value of the formula; NaN where arithmetic ends."""
    try:
        return declared.formula(*args, **kwargs)
    except ArithmeticError:
        return nan


def _result(declared: Equation, plain: dict[str, Any]) -> Any:
    """Value of the formula; where it has none, the arguments that are to blame are named."""
    try:
        result = _single(declared, **plain)
    except ValueError as error:
        raise InputError(f"{declared.label}: {error}; expected arrays of one length") from None
    if isfinite(result) if isinstance(result, float) else np.ndim(result) or isfinite(result):  # most are floats
        return result
    zeros = [term for term in declared.terms if np.all(plain.get(term.name, 1.0) == 0.0)]
    blamed = [term for term in zeros if isfinite(_single(declared, **plain | {term.name: 1.0}))]
    if not blamed and isfinite(_single(declared, **plain | {term.name: 1.0 for term in zeros})):
        blamed = zeros  # several at once
    if not blamed:
        raise InputError(f"{declared.label}: the result is outside the range of numbers that can be computed with")
    named = " and ".join(f"{term.name} ({term.meaning}) is 0" for term in blamed)
    raise InputError(f"{declared.label} has no value where {named}; expected more than 0")


_SECTION = re.compile(r"(Parameters|Returns|Printed|Notes)\n\s*-+\n(.*?)(?=\n\s*\n|\Z)", re.DOTALL)
_TERM = re.compile(r"\s*(\w+): (.*) \[([^\]]+)\]\s*")


def of_docstring(
    formula: Callable[..., Any],
) -> tuple[str, tuple[Term, ...], Term, str, dict[str, str], str]:
    """Title, terms, result, printed form with units of its own, and note: of a formula's docstring."""
    text = inspect.getdoc(formula) or ""
    terms: dict[str, tuple[Term, ...]] = {}
    words = {"Printed": "", "Notes": ""}
    for heading, block in _SECTION.findall(text):
        lines = re.sub(r"\n {4,}", " ", block).splitlines()
        matches = [_TERM.fullmatch(line) for line in lines]
        terms[heading] = tuple(Term(*match.groups()) for match in matches if match)
        if heading in words:
            words[heading] = " ".join(line for line, match in zip(lines, matches, strict=True) if not match)
    own = {term.name: term.unit for term in terms.get("Printed", ())}
    title = text.splitlines()[0].rstrip(".")
    return title, terms["Parameters"], terms["Returns"][0], words["Printed"], own, words["Notes"]


def equation(number: int | None, symbol: str, kind: str, printed: str) -> Callable[[Callable[..., Any]], Equation]:
    """Declare the function below as an equation.

    Parameters
    ----------
    number
        The paper's number, or None for what the paper does not number.
    symbol
        The paper's symbol of the result.
    kind, printed
        Kind of quantity of the result, and the unit of the trade it is printed in.

    Returns
    -------
    callable
        Decorator that makes an ``Equation`` of a function and enters it in the list of equations.
    """

    def declare(formula: Callable[..., Any]) -> Equation:
        declared = Equation(number, symbol, formula, *of_docstring(formula), kind, printed)
        if number is None:
            COMPANIONS[declared.name] = declared
        else:
            EQUATIONS[number] = declared
        return declared

    return declare


# -- An expression of a declared equation in the notation of the field, out of its Python source.


_BINDING = {ast.Add: 1, ast.Sub: 1, ast.Mult: 2, ast.Div: 2, ast.MatMult: 2, ast.Pow: 4}


@cache
def computed(formula: Callable[..., Any]) -> str:
    """The expression that a function returns, from its source."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(formula)))
    returned = next(node for node in ast.walk(tree) if isinstance(node, ast.Return))
    assert returned.value is not None
    return ast.unparse(returned.value).replace("np.linalg.", "").replace("np.", "")


class Notation(ast.NodeVisitor):
    """An expression as text on one line, node by node; what writes it otherwise puts its own signs in place of these.

    Rows of a matrix end with a semicolon.
    """

    powers = {"T": "ᵀ", "inv": "⁻¹", "pinv": "⁺", "2": "²", "3": "³"}  # noqa: RUF012 - a table, never changed
    minus = "−"
    brackets = "(", ")"

    def __init__(self, symbol: Callable[[str], str], times: str = " ") -> None:
        self.symbol, self.times = symbol, times

    def of(self, expression: str) -> str:
        """An expression."""
        return str(self.visit(ast.parse(expression, mode="eval").body))

    def inside(self, node: ast.expr, least: int, *, strict: bool = False) -> str:
        """A part in brackets where it binds less than its surroundings."""
        level = _BINDING[type(node.op)] if isinstance(node, ast.BinOp) else 3 if isinstance(node, ast.UnaryOp) else 5
        return self.bracketed(node) if level < least or (strict and level == least) else str(self.visit(node))

    def bracketed(self, node: ast.expr) -> str:
        """A part in brackets."""
        return str(self.visit(node)).join(self.brackets)

    def matrix(self, rows: list[list[str]]) -> str:
        """Rows of cells; one row alone is a list."""
        return "[" + "; ".join(", ".join(row) for row in rows) + "]"

    def listed(self, cells: list[str]) -> str:
        """A list of numbers."""
        return self.matrix([cells])

    def root(self, node: ast.expr) -> str:
        """A square root."""
        return f"√{self.bracketed(node)}"

    def function(self, name: str, argument: ast.expr) -> str:
        """A function of one argument."""
        if name in ("diag", "sum"):
            return f"{name}({self.visit(argument).strip('[]')})"
        return f"{name} {self.inside(argument, 3)}"

    def quotient(self, node: ast.BinOp) -> str:
        """A fraction."""
        return f"{self.inside(node.left, 2)} / {self.inside(node.right, 2, strict=True)}"

    def product(self, node: ast.BinOp) -> str:
        """Two factors; a fraction behind the other one is in brackets."""
        fraction = isinstance(node.right, ast.BinOp) and isinstance(node.right.op, ast.Div)
        return f"{self.inside(node.left, 2)}{self.times}{self.inside(node.right, 2, strict=fraction)}"

    def power(self, base: str, exponent: str) -> str:
        """A power."""
        return base + (self.powers.get(exponent) or f"^{exponent}")

    def generic_visit(self, node: ast.AST) -> str:
        """Refuse what no declaration has."""
        raise ValueError(f"no notation for {ast.unparse(node)}")

    def visit_Constant(self, node: ast.Constant) -> str:
        """A number."""
        return f"{node.value:g}" if isinstance(node.value, float) else str(node.value)

    def visit_Name(self, node: ast.Name) -> str:
        """A symbol."""
        return self.symbol(node.id)

    def visit_List(self, node: ast.List) -> str:
        """A matrix, or a list of numbers."""
        rows = [row.elts if isinstance(row, ast.List) else [row] for row in node.elts]
        cells = [[self.visit(cell) for cell in row] for row in rows]
        if all(not isinstance(row, ast.List) for row in node.elts):
            return self.listed([cell for (cell,) in cells])
        return self.matrix(cells)

    def visit_Attribute(self, node: ast.Attribute) -> str:
        """The transposed of a matrix."""
        return f"{self.inside(node.value, 5)}{self.powers[node.attr]}"

    def visit_UnaryOp(self, node: ast.UnaryOp) -> str:
        """The opposite."""
        return f"-{self.inside(node.operand, 2)}"

    def visit_Call(self, node: ast.Call) -> str:
        """A matrix, its inverse, or a function."""
        assert isinstance(node.func, ast.Name)
        name, argument = node.func.id, node.args[0]
        if name == "array":
            return str(self.visit(argument))
        if name == "concatenate" and isinstance(argument, ast.List):
            return self.matrix([[self.visit(part)] for part in argument.elts])
        if name in self.powers:
            inner = self.visit(argument) if isinstance(argument, ast.Name) else self.bracketed(argument)
            return f"{inner}{self.powers[name]}"
        return self.root(argument) if name == "sqrt" else self.function(name, argument)

    def visit_BinOp(self, node: ast.BinOp) -> str:
        """A sum, difference, product, fraction, power or root."""
        match node.op:
            case ast.Add():
                return f"{self.visit(node.left)} + {self.visit(node.right)}"
            case ast.Sub():
                return f"{self.visit(node.left)} {self.minus} {self.inside(node.right, 1, strict=True)}"
            case ast.Pow():
                if ast.unparse(node.right) == "1 / 2":
                    return self.root(node.left)
                return self.power(self.inside(node.left, 4, strict=True), self.visit(node.right))
            case ast.Div():
                return self.quotient(node)
            case ast.Mult() | ast.MatMult():
                return self.product(node)
        return self.generic_visit(node)
