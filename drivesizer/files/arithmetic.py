"""Arithmetic over figures by name: in a user's file, never as code, with limits on it; and in tables of the program.

>>> expression("2 * wheel.mass + sqrt(payload)").value({"wheel.mass": 1.5, "payload": 4.0}.__getitem__)
5.0
"""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from types import CodeType
from typing import Any, Literal

from drivesizer.errors import InputError, quoted
from drivesizer.units import kind_of_unit, number, to_si

_LONGEST = 400  # characters
_OPERATORS: dict[type[ast.AST], Callable[..., float]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.Pow: math.pow, ast.USub: operator.neg, ast.UAdd: operator.pos,
}  # fmt: skip
FUNCTIONS: dict[str, Callable[..., float]] = {
    "sqrt": math.sqrt, "abs": abs, "min": min, "max": max, "sin": math.sin, "cos": math.cos, "tan": math.tan,
    "exp": math.exp, "log": math.log,
}  # fmt: skip
_EXAMPLE = "mass + 0.1 * price, or 2 * load.wheel_diameter"


@cache
def code(text: str) -> CodeType:
    """An expression of a table of the program, compiled."""
    return compile(f"({text})", text, "eval")


def own_value(text: str, names: Mapping[str, Any]) -> Any:
    """The value of an expression of a table of the program over what its names are; never of a user's text."""
    return eval(code(text), {"__builtins__": {}}, names)  # noqa: S307  of our own tables


@dataclass(frozen=True, slots=True)
class Expression:
    """Arithmetic over named figures in SI."""

    text: str
    tree: ast.expr
    names: tuple[str, ...]  # of its figures

    def value(self, figure: Callable[[str], float]) -> float:
        """Its value with the figures that a function gives; NaN where it has none."""
        try:
            number = _value(self.tree, figure)
        except (ArithmeticError, ValueError):  # a root of what is negative, a division by zero
            return math.nan
        return float(number)


@lru_cache(maxsize=256)
def expression(text: str) -> Expression:
    """The expression of a text: numbers, named figures, + - * / **, and a few functions."""
    if len(text) > _LONGEST:
        raise InputError(f"{quoted(text)} is too long; expected at most {_LONGEST} characters")
    try:
        tree = ast.parse(text.strip(), mode="eval").body
        names = dict.fromkeys(_names(tree))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise InputError(f"{quoted(text)} is no expression; expected e.g. {_EXAMPLE}") from None
    return Expression(text.strip(), tree, tuple(names))


def _names(node: ast.expr) -> list[str]:
    """Names of the figures of an expression; a ValueError where a part of it is no arithmetic."""
    match node:
        case ast.Constant(value=bool() | str() | bytes() | complex() | None):
            raise ValueError
        case ast.Constant(value=int() | float()):
            return []
        case ast.Name(id="pi"):
            return []
        case ast.Name() | ast.Attribute() | ast.Subscript():
            return [_name(node)]
        case ast.UnaryOp(op=op, operand=operand) if type(op) in _OPERATORS:
            return _names(operand)
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
            return _names(left) + _names(right)
        case ast.Call(func=ast.Name(id=name), args=[_, *_] as args, keywords=[]) if name in FUNCTIONS:
            return [figure for arg in args for figure in _names(arg)]
    raise ValueError


def _name(node: ast.expr) -> str:
    """A figure's name as messages have it: ``load.mass``, ``transmission[2].ratio``."""
    match node:
        case ast.Name(id=name):
            return name
        case ast.Attribute(value=owner, attr=name):
            return f"{_name(owner)}.{name}"
        case ast.Subscript(value=owner, slice=ast.Constant(value=int() as place)):
            return f"{_name(owner)}[{place}]"
    raise ValueError


def _value(node: Any, figure: Callable[[str], float]) -> float:
    match node:
        case ast.Constant(value=int() | float() as value):
            return float(value)
        case ast.Name(id="pi"):
            return math.pi
        case ast.UnaryOp(op=op, operand=operand):
            return _OPERATORS[type(op)](_value(operand, figure))
        case ast.BinOp(left=left, op=op, right=right):
            return _OPERATORS[type(op)](_value(left, figure), _value(right, figure))
        case ast.Call(func=ast.Name(id=name), args=args):
            values = [_value(arg, figure) for arg in args]
            if any(map(math.isnan, values)):  # which the least and the greatest of several would pass over
                return math.nan
            try:
                return float(FUNCTIONS[name](*values))
            except TypeError:  # too many or too few of them
                raise ValueError from None
    return float(figure(_name(node)))


@dataclass(frozen=True, slots=True)
class Limit:
    """A limit on an expression: at most or at least a figure."""

    text: str
    of: Expression
    sign: Literal["<=", ">="]
    bound: float  # SI

    @property
    def names(self) -> tuple[str, ...]:
        """Names of its figures."""
        return self.of.names

    def excess(self, figure: Callable[[str], float]) -> float:
        """By how much the limit is exceeded, as a share of it: 0 or below where it holds, NaN unknown."""
        by = self.of.value(figure) - self.bound
        return (by if self.sign == "<=" else -by) / (abs(self.bound) or 1.0)


def names_in(several: Iterable[Expression | Limit]) -> list[str]:
    """Names of the figures in some expressions and limits."""
    return [name for expression in several for name in expression.names]


_LIMIT = re.compile(r"\s*(?P<of>[^<>=]+?)\s*(?P<sign><=|>=)\s*(?P<bound>[^<>=]+?)\s*")


def limit(text: str, kind_of: Callable[[str], str]) -> Limit:
    """The limit of a text, such as ``autonomy >= 3 h``."""
    match = _LIMIT.fullmatch(text)
    if match is None:
        raise InputError(f"{quoted(text)} is no limit; expected e.g. autonomy >= 3 h, or price <= 800 EUR")
    of, bound = expression(match["of"]), match["bound"]
    alone = of.names[0] if of.names == (of.text,) else ""
    kind = kind_of(alone) if alone else ""
    if not kind:
        kind = kind_of_unit(number(bound)[1]) or "dimensionless"
    sign: Any = match["sign"]
    try:
        return Limit(text, of, sign, to_si(bound, kind))
    except InputError as error:
        raise InputError(f"{quoted(text)}: {error}") from None
