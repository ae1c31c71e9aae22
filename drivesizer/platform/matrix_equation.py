"""Declaration of an equation between vectors and matrices, and its form as text.

As in ``equation``: the decorator reads names, meanings and bracketed units from the docstring, the computed form is the
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

from drivesizer.physics import equation
from drivesizer.physics.equation import Term

Array = NDArray[np.float64]

_GREEK = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "eta": "η", "theta": "θ", "xi": "ξ", "phi": "φ",
    "varphi": "ϕ", "psi": "ψ", "tau": "τ",
}  # fmt: skip
_WHOLE = {"p_dot": "d/dt(∂T/∂ψ̇)", "T_psi": "∂T/∂ψ", "T_xi": "[T]_ξ", "T_phi": "[T]_ϕ", "R_T_dot": "Ṙᵀ"}
_ACCENTS = {"dot": "\u0307", "ddot": "\u0308", "bar": "\u0304", "plus": "⁺"}
_BINDING = {ast.Add: 1, ast.Sub: 1, ast.Mult: 2, ast.Div: 2, ast.MatMult: 2, ast.Pow: 4}


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

    Returns
    -------
    callable
        The decorator, which makes a ``MatrixEquation`` of the function.
    """

    def declared(formula: Callable[..., Any]) -> MatrixEquation:
        sections = equation.terms(formula)
        title = (inspect.getdoc(formula) or "").splitlines()[0].rstrip(".")
        terms, result = sections["Parameters"], sections["Returns"][0]
        made = MatrixEquation(number, symbol, formula, title, terms, result, printed, note, printed_symbol)
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
    return str(Notation().visit(ast.parse(expression, mode="eval").body))


class Notation(ast.NodeVisitor):
    """An expression as text, node by node; what writes it otherwise puts its own signs in place of these."""

    power = {"T": "ᵀ", "inv": "⁻¹", "pinv": "⁺", "2": "²", "3": "³"}  # noqa: RUF012 - a table, never changed
    times, minus = " ", "−"
    brackets = "(", ")"

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

    def function(self, name: str, argument: ast.expr) -> str:
        """A function of one argument."""
        if name in ("diag", "sum"):
            return f"{name}({self.visit(argument).strip('[]')})"
        return f"{name} {self.inside(argument, 3)}"

    def quotient(self, node: ast.BinOp) -> str:
        """A fraction."""
        return f"{self.inside(node.left, 2)} / {self.inside(node.right, 2, strict=True)}"

    def product(self, node: ast.BinOp) -> str:
        """Two factors."""
        return f"{self.inside(node.left, 2)}{self.times}{self.inside(node.right, 2)}"

    def generic_visit(self, node: ast.AST) -> str:
        """Refuse what no declaration has."""
        raise ValueError(f"no notation for {ast.unparse(node)}")

    def visit_Constant(self, node: ast.Constant) -> str:
        """A number."""
        return str(node.value)

    def visit_Name(self, node: ast.Name) -> str:
        """A symbol."""
        return symbol(node.id)

    def visit_List(self, node: ast.List) -> str:
        """A matrix, or a list of numbers."""
        rows = [row.elts if isinstance(row, ast.List) else [row] for row in node.elts]
        cells = [[self.visit(cell) for cell in row] for row in rows]
        if all(not isinstance(row, ast.List) for row in node.elts):
            return self.listed([cell for (cell,) in cells])
        return self.matrix(cells)

    def listed(self, cells: list[str]) -> str:
        """A list of numbers."""
        return self.matrix([cells])

    def visit_Attribute(self, node: ast.Attribute) -> str:
        """The transposed of a matrix."""
        return f"{self.inside(node.value, 5)}{self.power[node.attr]}"

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
        if name in self.power:
            inner = self.visit(argument) if isinstance(argument, ast.Name) else self.bracketed(argument)
            return f"{inner}{self.power[name]}"
        return self.function(name, argument)

    def visit_BinOp(self, node: ast.BinOp) -> str:
        """A sum, difference, product, fraction or power."""
        match node.op:
            case ast.Add():
                return f"{self.visit(node.left)} + {self.visit(node.right)}"
            case ast.Sub():
                return f"{self.visit(node.left)} {self.minus} {self.inside(node.right, 1, strict=True)}"
            case ast.Pow():
                return f"{self.inside(node.left, 4, strict=True)}{self.power[ast.unparse(node.right)]}"
            case ast.Div():
                return self.quotient(node)
            case ast.Mult() | ast.MatMult():
                return self.product(node)
        return self.generic_visit(node)
