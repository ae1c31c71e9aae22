"""An expression of a declared equation in the notation of the field, out of its Python source."""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Callable
from functools import cache
from typing import Any

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
