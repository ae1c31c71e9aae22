"""Equations between vectors and matrices as LaTeX: what ``drivesizer.platform.equations`` has as text."""

from __future__ import annotations

import ast
import re
import unicodedata

from drivesizer.physics.equation import Notation
from drivesizer.platform.equations import symbol

__all__ = ["equation", "expression", "term", "text"]

_ACCENTS = {"\u0307": "dot", "\u0308": "ddot", "\u0304": "bar"}
_RAISED = {"ᵀ": "T", "⁺": "+", "⁻¹": "-1", "²": "2"}
_ONE = re.compile(r"([A-Za-zα-ωϕ])([\u0307\u0308\u0304]?)(_[A-Za-z0-9α-ωϕ]+)?((?:ᵀ|⁺|⁻¹|²)?)")
_FUNCTIONS = ("cos", "sin", "diag", "sum")


def equation(left: str, right: str) -> str:
    r"""Both sides of an equation; what the left side is divided by as a vector stands behind the right side.

    >>> equation("τ", "E.T @ F")
    'τ = E^{\\text{T}}\\,F'
    >>> equation("[a; b] / η", "J")
    '\\left[\\begin{matrix}a\\\\b\\end{matrix}\\right] = J\\,η'
    """
    rows, divided, vector = left.partition("] / ")
    behind = rf"\,{text(vector)}" if divided else ""
    return f"{text(rows + ']' if divided else left)} = {expression(right)}{behind}"


def text(words: str) -> str:
    r"""A side that is written as text, such as ``Eᵀ τ`` or ``[r ϕ̇ cos γ; v]``.

    >>> text("Eᵀ τ_ϕ")
    'E^{\\text{T}}\\,τ_{ϕ}'
    """
    if words in ("d/dt(∂T/∂ψ̇)", "∂T/∂ψ"):
        slope = r"\frac{∂T}{∂\dot{ψ}}" if "dt" in words else r"\frac{∂T}{∂ψ}"
        return rf"\frac{{d}}{{dt}}\left({slope}\right)" if "dt" in words else slope
    if words.startswith("[") and words.endswith("]"):
        return _matrix([[text(row)] for row in words[1:-1].split("; ")])
    if words.startswith("[T]_"):
        return rf"\left[T\right]_{{{words[4:]}}}"
    parts = [_sign(part) for part in unicodedata.normalize("NFD", words).split()]
    joined = re.sub(r"\\,([+-])\\,", r" \1 ", r"\,".join(parts))
    return re.sub(r"(\\(?:cos|sin))\\,", r"\1 ", joined)


def _sign(word: str) -> str:
    if word in _FUNCTIONS:
        return rf"\{word}"
    if word in "+−-" or word.isdigit():
        return word.replace("−", "-")
    whole = _ONE.fullmatch(word)
    if whole is None:
        raise ValueError(f"no mathematics for {word!r}")
    head, accent, index, raised = whole.groups()
    made = rf"\{_ACCENTS[accent]}{{{head}}}" if accent else head
    made += f"_{{{_index(index[1:])}}}" if index else ""
    return made + (f"^{{{_upright(_RAISED[raised])}}}" if raised else "")


def _index(tail: str) -> str:
    return "".join(part if part in "αγϕξψi" else rf"\text{{{part}}}" for part in re.findall(r"[α-ωϕi]|[^α-ωϕi]+", tail))


def _upright(power: str) -> str:
    return r"\text{T}" if power == "T" else power


def term(name: str) -> str:
    r"""A name of an equation's term.

    >>> term("varphi_1_dot"), term("K_plus")
    ('\\dot{ϕ}_{\\text{1}}', 'K^{+}')
    """
    return text(symbol(name))


def expression(source: str) -> str:
    r"""An expression as a declaration has it.

    >>> expression("-inv(J_2) @ J_1")
    '-J_{\\text{2}}^{-1}\\,J_{\\text{1}}'
    """
    return _Latex(term, r"\,").of(source)


class _Latex(Notation):
    """The same with signs of LaTeX: fractions, powers, and a list of numbers as a column."""

    powers = {"T": r"^{\text{T}}", "inv": "^{-1}", "pinv": "^{+}", "2": "^{2}", "3": "^{3}"}  # noqa: RUF012
    minus = "-"
    brackets = r"\left(", r"\right)"

    def matrix(self, rows):
        return _matrix(rows)

    def listed(self, cells):
        return _matrix([[cell] for cell in cells])

    def function(self, name, argument):
        if name == "diag" and isinstance(argument, ast.List):
            return rf"\text{{diag}}\left({', '.join(map(self.visit, argument.elts))}\right)"
        if name == "diag":
            return rf"\text{{diag}}{self.bracketed(argument)}"
        return rf"\sum {self.visit(argument)}" if name == "sum" else rf"\{name} {self.inside(argument, 3)}"

    def quotient(self, node):
        if isinstance(node.left, ast.Call):  # a matrix over a number
            return rf"\frac{{1}}{{{self.visit(node.right)}}}\,{self.visit(node.left)}"
        return rf"\frac{{{self.visit(node.left)}}}{{{self.visit(node.right)}}}"

    def product(self, node):
        cells = _flat(node.left) if isinstance(node.op, ast.MatMult) else None
        if cells is None:
            return super().product(node)
        return rf"{_matrix([[self.visit(cell) for cell in cells]])}\,{self.inside(node.right, 2)}"  # a row


def _flat(node: ast.expr) -> list[ast.expr] | None:
    """The numbers of ``array([a, b, c])``; nothing of anything else."""
    match node:
        case ast.Call(func=ast.Name(id="array"), args=[ast.List(elts=cells)]) if not isinstance(cells[0], ast.List):
            return cells
    return None


def _matrix(rows: list[list[str]]) -> str:
    body = r"\\".join("&".join(row) for row in rows)
    return rf"\left[\begin{{matrix}}{body}\end{{matrix}}\right]"
