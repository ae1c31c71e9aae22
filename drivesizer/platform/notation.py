"""How an equation between vectors and matrices is declared, and how it reads as text.

As in ``declare``: the decorator reads names, meanings and bracketed units from the docstring, the computed form is the
function's own return expression, and the printed form is an expression in our names beside it. A vector's unit lists
its entries, ``[m/s, m/s, rad/s]``, or is the one unit of all. A matrix takes one vector to another, so its unit is
``[rad/s per m/s, m/s, rad/s]``: the entry in row i and column j has the i-th unit over the j-th.
"""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer import declare
from drivesizer.declare import Term

__all__ = ["PLATFORM", "Array", "MatrixEquation", "computed", "matrix_equation", "symbol", "text"]

Array = NDArray[np.float64]

_GREEK = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "eta": "η", "theta": "θ", "xi": "ξ", "phi": "φ",
    "varphi": "ϕ", "psi": "ψ", "tau": "τ",
}  # fmt: skip
_WHOLE = {"p_dot": "d/dt(∂T/∂ψ̇)", "T_psi": "∂T/∂ψ", "T_xi": "[T]_ξ", "T_phi": "[T]_ϕ", "R_T_dot": "Ṙᵀ"}
_ACCENTS = {"dot": "\u0307", "ddot": "\u0308", "bar": "\u0304", "plus": "⁺"}
_BINDING = {ast.Add: 1, ast.Sub: 1, ast.Mult: 2, ast.Div: 2, ast.MatMult: 2, ast.Pow: 4}
_AFTER = {"inv": "⁻¹", "pinv": "⁺"}


@dataclass(frozen=True, slots=True, eq=False)
class MatrixEquation:
    """A declared equation of the platform; call it like the function that it holds."""

    number: int
    symbol: str
    formula: Callable[..., Any]
    title: str
    terms: tuple[Term, ...]
    result: Term
    printed: str
    note: str = ""
    printed_symbol: str = ""  # where the paper has another left side

    @property
    def name(self) -> str:
        """The function's name."""
        return self.formula.__name__

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Compute, in SI."""
        return self.formula(*args, **kwargs)


PLATFORM: dict[int, MatrixEquation] = {}  # by the paper's number


def matrix_equation(
    number: int, symbol: str, *, printed: str, note: str = "", printed_symbol: str = ""
) -> Callable[[Callable[..., Any]], MatrixEquation]:
    """Declare the function below as an equation of the platform.

    Parameters
    ----------
    number
        The paper's number.
    symbol
        What stands on the left, as text.
    printed
        The paper's own right side, as an expression in our names.
    note
        Where the printed form fails, or what a reader must know.
    printed_symbol
        The paper's own left side, where it is another.
    """

    def declared(formula: Callable[..., Any]) -> MatrixEquation:
        sections = declare.terms(formula)
        title = (inspect.getdoc(formula) or "").splitlines()[0].rstrip(".")
        made = MatrixEquation(
            number,
            symbol,
            formula,
            title,
            sections["Parameters"],
            sections["Returns"][0],
            printed,
            note,
            printed_symbol,
        )
        PLATFORM[number] = made
        return made

    return declared


def computed(declared: MatrixEquation) -> str:
    """The expression that a declared equation computes, from its source."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(declared.formula)))
    returned = next(node for node in ast.walk(tree) if isinstance(node, ast.Return))
    assert returned.value is not None
    return ast.unparse(returned.value).replace("np.linalg.", "").replace("np.", "")


def symbol(name: str) -> str:
    """A name as a symbol.

    >>> [symbol(n) for n in ("m_R", "theta", "K_plus", "tau_1")]
    ['m_R', 'θ', 'K⁺', 'τ_1']
    """
    if name in _WHOLE:
        return _WHOLE[name]
    head, *marks = name.split("_")
    accents = "".join(_ACCENTS[m] for m in marks if m in _ACCENTS)
    index = "".join(f"_{m.replace('phi', 'ϕ')}" for m in marks if m not in _ACCENTS)
    return _GREEK.get(head, head) + accents + index


def text(expression: str) -> str:
    """An expression on one line; rows of a matrix end with a semicolon.

    >>> text("-inv(J_2) @ J_1")
    '-J_2⁻¹ J_1'
    >>> text("theta_dot * array([[0, -m_R], [m_R, 0]])") == symbol("theta_dot") + " [0, -m_R; m_R, 0]"
    True
    """
    return _walk(ast.parse(expression, mode="eval").body)


def _inside(node: ast.expr, least: int, *, strict: bool = False) -> str:
    """A part in brackets where it binds less than its surroundings."""
    level = _BINDING[type(node.op)] if isinstance(node, ast.BinOp) else 3 if isinstance(node, ast.UnaryOp) else 5
    words = _walk(node)
    return f"({words})" if level < least or (strict and level == least) else words


def _walk(node: ast.expr) -> str:
    match node:
        case ast.Constant(value=value):
            return str(value)
        case ast.Name(id=name):
            return symbol(name)
        case ast.List(elts=rows):
            row = "; " if rows and isinstance(rows[0], ast.List) else ", "
            return "[" + row.join(_walk(r).strip("[]") if isinstance(r, ast.List) else _walk(r) for r in rows) + "]"
        case ast.Attribute(value=value, attr="T"):
            return f"{_inside(value, 5)}ᵀ"
        case ast.Call(func=ast.Name(id=name), args=[argument, *_]):
            return _call(name, argument)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return f"-{_inside(operand, 2)}"
        case ast.BinOp():
            return _joined(node)
    raise ValueError(f"no notation for {ast.unparse(node)}")


def _call(name: str, argument: ast.expr) -> str:
    if name == "array":
        return _walk(argument)
    if name == "concatenate":
        assert isinstance(argument, ast.List)
        return "[" + "; ".join(_walk(part) for part in argument.elts) + "]"
    if name in _AFTER:
        inner = _walk(argument)
        return f"{inner if isinstance(argument, ast.Name) else f'({inner})'}{_AFTER[name]}"
    if name in ("diag", "sum"):
        return f"{name}({_walk(argument).strip('[]')})"
    return f"{name} {_inside(argument, 3)}"


def _joined(node: ast.BinOp) -> str:
    match node.op:
        case ast.Add():
            return f"{_walk(node.left)} + {_walk(node.right)}"
        case ast.Sub():
            return f"{_walk(node.left)} − {_inside(node.right, 1, strict=True)}"
        case ast.Pow():
            return f"{_inside(node.left, 4, strict=True)}{ {'2': '²', '3': '³'}[ast.unparse(node.right)] }"
        case ast.Div():
            return f"{_inside(node.left, 2)} / {_inside(node.right, 2, strict=True)}"
        case ast.Mult() | ast.MatMult():
            return f"{_inside(node.left, 2)} {_inside(node.right, 2)}"
    raise ValueError(f"no notation for {ast.unparse(node)}")
