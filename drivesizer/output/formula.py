"""A declared equation as text for the terminal and typst mathematics for the report.

The computed form is read from the function's own return expression, so that what is shown is what runs; the
printed form is an expression in the declaration. Both are small Python expressions; one table of operators
turns their syntax tree into either notation. ``printed_failure`` evaluates a printed form with units and says
what is wrong with it.
"""

from __future__ import annotations

import ast
import inspect
import re
import textwrap
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from drivesizer import equations
from drivesizer.physics.equation import COMPANIONS, EQUATIONS, Equation
from drivesizer.units import label, registry

__all__ = ["computed", "find", "printed_failure", "symbol_text", "symbol_typst", "text", "typst"]

assert equations.__all__  # importing them declares them

_GREEK = {
    "eta": "η", "delta": "δ", "theta": "θ", "kappa": "κ", "rho": "ρ", "tau": "τ", "pi": "π", "alpha": "α", "omega": "ω",
}  # fmt: skip
_NAMES = {"eta_speed": "eta_v", "eta_robot": "eta_R", "eta_gear": "eta_g", "eta_b": "eta_b", "J_mK2": "J_m K²"}
_PAPER = {"eta_speed": "eta", "eta_robot": "eta", "eta_gear": "eta", "U": "upsilon"}
_BINDING = {ast.Add: 1, ast.Sub: 1, ast.Mult: 2, ast.Div: 2, ast.USub: 3, ast.Pow: 4}


def find(key: str) -> Equation | None:
    """The equation with a paper's number (as text) or a function name, or None."""
    bare = key.strip().strip("()")
    if bare.isascii() and bare.isdigit():
        return EQUATIONS.get(int(bare))
    everything = {e.name: e for e in EQUATIONS.values()} | COMPANIONS
    return everything.get(bare)


@cache
def computed(declared: Equation) -> str:
    """The expression that a declared equation computes, from its source.

    >>> from drivesizer.equations import acceleration
    >>> computed(acceleration)
    'V_nom / t_acc'
    """
    tree = ast.parse(textwrap.dedent(inspect.getsource(declared.formula)))
    returned = next(node for node in ast.walk(tree) if isinstance(node, ast.Return))
    assert returned.value is not None
    return ast.unparse(returned.value).replace("np.", "")


def symbol_text(name: str, *, paper: bool = False) -> str:
    """A symbol for the terminal."""
    name = (_PAPER if paper else {}).get(name) or _NAMES.get(name, name)
    head, _, tail = name.partition("_")
    tail = re.sub(r"_(m0?)$", r"/\1", tail)
    head = "υ" if head == "upsilon" else _GREEK.get(head, head)
    return f"{head}_{tail}" if tail else head


def symbol_typst(name: str, *, paper: bool = False) -> str:
    """A symbol in typst mathematics."""
    head, _, tail = symbol_text(name, paper=paper).partition("_")
    head = {"υ": "upsilon", **{v: k for k, v in _GREEK.items()}}.get(head, f'"{head}"' if len(head) > 1 else head)
    return f'{head}_"{tail}"' if tail else head


def text(expression: str, *, paper: bool = False, values: dict[str, str] | None = None) -> str:
    """An expression on one line of text.

    Examples
    --------
    >>> text("60 * V_nom / (pi * d * eta_speed)", paper=True)
    '60 V_nom / (π d η)'
    """

    def divide(a: str, b: str) -> str:
        return f"{a} / {b}"

    def root(a: str) -> str:
        return f"√({a})"

    def power(a: str, b: str) -> str:
        return f"{a}{ {'2': '²', '3': '³'}.get(b) or '^' + b }"

    def name(n: str) -> str:
        return (values or {}).get(n) or symbol_text(n, paper=paper)

    return _render(expression, name, divide, root, power, bracket=True, between=" · " if values else " ")


def typst(expression: str, *, paper: bool = False, values: dict[str, str] | None = None) -> str:
    """An expression in typst mathematics.

    Examples
    --------
    >>> typst("V_nom / t_acc")
    '(V_"nom") / (t_"acc")'
    """

    def name(n: str) -> str:
        return (values or {}).get(n) or symbol_typst(n, paper=paper)

    def divide(a: str, b: str) -> str:
        return f"({a}) / ({b})"

    def root(a: str) -> str:
        return f"sqrt({a})"

    def power(a: str, b: str) -> str:
        return f"{a}^({b})"

    between = " dot " if values else " "
    return _render(expression, name, divide, root, power, bracket=False, between=between)


def _render(
    expression: str,
    name: Callable[[str], str],
    divide: Callable[[str, str], str],
    root: Callable[[str], str],
    power: Callable[[str, str], str],
    *,
    bracket: bool,
    between: str = " ",
) -> str:
    """Walk the tree; ``bracket`` says that a fraction is written on one line and needs its own brackets."""

    def inside(node: ast.expr, least: int, *, strict: bool = False) -> str:
        level = _level(node)
        return f"({walk(node)})" if level < least or (strict and level == least) else walk(node)

    def walk(node: ast.expr) -> str:
        match node:
            case ast.Constant(value=value):
                return f"{value:g}" if isinstance(value, float) else str(value)
            case ast.Name(id=identifier):
                return name(identifier)
            case ast.Call(func=ast.Name(id="sqrt"), args=[argument]):
                return root(walk(argument))
            case ast.Call(func=ast.Name(id=function), args=[argument]):
                return f"{function} {inside(argument, 3)}"
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return f"-{inside(operand, 3)}"
            case ast.BinOp(left=left, op=ast.Pow(), right=right):
                if ast.unparse(right) == "1 / 2":
                    return root(walk(left))
                return power(inside(left, 4, strict=True), walk(right))
            case ast.BinOp(left=left, op=ast.Div(), right=right):
                if bracket:
                    return divide(inside(left, 2), inside(right, 2, strict=True))
                return divide(walk(left), walk(right))
            case ast.BinOp(left=left, op=ast.Mult(), right=right):
                return f"{inside(left, 2)}{between}{inside(right, 2, strict=bracket)}"
            case ast.BinOp(left=left, op=ast.Add(), right=right):
                return f"{walk(left)} + {walk(right)}"
            case ast.BinOp(left=left, op=ast.Sub(), right=right):
                return f"{walk(left)} {'−' if bracket else '-'} {inside(right, 1, strict=True)}"
        raise ValueError(f"no notation for {ast.unparse(node)}")

    return walk(ast.parse(expression, mode="eval").body)


def _level(node: ast.expr) -> int:
    if isinstance(node, ast.BinOp):
        return _BINDING[type(node.op)]
    return 3 if isinstance(node, ast.UnaryOp) else 5


def printed_failure(declared: Equation) -> str | None:
    """Failure of the printed form in the unit check, or None when it passes (or there is none).

    The printed expression is evaluated with pint quantities in the declared units.
    """
    from pint import DimensionalityError

    if not declared.printed:
        return None
    unit = {term.name: term.unit for term in _known_terms()}
    unit |= {term.name: term.unit for term in (*declared.terms, declared.result)} | declared.printed_units
    ureg = registry()

    def quantity(name: str) -> Any:
        return ureg.Quantity(1.5, unit[name] if unit[name] != "1" else "")

    functions = {"sqrt": np.sqrt, "sin": np.sin, "cos": np.cos, "pi": np.pi}
    names = {n.id for n in ast.walk(ast.parse(declared.printed)) if isinstance(n, ast.Name)}
    space = {n: functions[n] if n in functions else quantity(n) for n in names}
    try:
        value = eval(declared.printed, {"__builtins__": {}}, space)  # noqa: S307 - our own declarations
    except DimensionalityError as error:
        one, other = (label(f"{ureg.Unit(str(unit)):~C}") for unit in (error.units1, error.units2))
        return f"{one} cannot be added to {other}"
    wanted = ureg.Quantity(1.0, declared.result.unit if declared.result.unit != "1" else "")
    if value.dimensionality != wanted.dimensionality:
        excess, si = (value / wanted).to_base_units().units, label(declared.result.unit)
        return f"its unit is {si} times {label(f'{excess:~C}')}, not {si}"
    return None


def _known_terms() -> list[Any]:
    every = [*EQUATIONS.values(), *COMPANIONS.values()]
    return [term for e in every for term in (*e.terms, e.result)]
