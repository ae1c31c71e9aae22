"""Equations between vectors and matrices as LaTeX: what ``drivesizer.platform.notation`` has as text."""

from __future__ import annotations

import ast
import re
import unicodedata

from drivesizer.platform.notation import symbol

__all__ = ["equation", "expression", "term", "text"]

_ACCENTS = {"\u0307": "dot", "\u0308": "ddot", "\u0304": "bar"}
_RAISED = {"ᵀ": "T", "⁺": "+", "⁻¹": "-1", "²": "2"}
_AFTER = {"inv": "-1", "pinv": "+"}
_ONE = re.compile(r"([A-Za-zα-ωϕ])([\u0307\u0308\u0304]?)(_[A-Za-z0-9α-ωϕ]+)?((?:ᵀ|⁺|⁻¹|²)?)")
_FUNCTIONS = ("cos", "sin", "diag", "sum")
_LOOSE = {ast.Add: 1, ast.Sub: 1, ast.Mult: 2, ast.MatMult: 2, ast.Div: 2, ast.Pow: 4}


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
    return _walk(ast.parse(source, mode="eval").body)


def _inside(node: ast.expr, least: int, *, strict: bool = False) -> str:
    """A part in brackets where it binds less than its surroundings; a fraction needs none."""
    level = _LOOSE[type(node.op)] if isinstance(node, ast.BinOp) else 3 if isinstance(node, ast.UnaryOp) else 5
    made = _walk(node)
    return rf"\left({made}\right)" if level < least or (strict and level == least) else made


def _walk(node: ast.expr) -> str:
    match node:
        case ast.Constant(value=value):
            return str(value)
        case ast.Name(id=name):
            return term(name)
        case ast.List():
            return _rows(node)
        case ast.Attribute(value=value, attr="T"):
            return f"{_inside(value, 5)}^{{{_upright('T')}}}"
        case ast.Call(func=ast.Name(id=name), args=[argument, *_]):
            return _call(name, argument)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return f"-{_inside(operand, 2)}"
        case ast.BinOp():
            return _joined(node)
    raise ValueError(f"no mathematics for {ast.unparse(node)}")


def _rows(node: ast.List) -> str:
    """A matrix; a list of numbers is a column."""
    rows = [row.elts if isinstance(row, ast.List) else None for row in node.elts]
    if all(row is not None for row in rows):
        return _matrix([[_walk(cell) for cell in row or ()] for row in rows])
    return _matrix([[_walk(cell)] for cell in node.elts])


def _flat(node: ast.expr) -> list[ast.expr] | None:
    """The numbers of ``array([a, b, c])``; nothing of anything else."""
    match node:
        case ast.Call(func=ast.Name(id="array"), args=[ast.List(elts=cells)]) if not isinstance(cells[0], ast.List):
            return cells
    return None


def _matrix(rows: list[list[str]]) -> str:
    body = r"\\".join("&".join(row) for row in rows)
    return rf"\left[\begin{{matrix}}{body}\end{{matrix}}\right]"


def _call(name: str, argument: ast.expr) -> str:
    if name == "array":
        return _walk(argument)
    if name == "concatenate" and isinstance(argument, ast.List):
        return _matrix([[_walk(part)] for part in argument.elts])
    if name in _AFTER:
        inner = _walk(argument)
        if isinstance(argument, ast.Name):
            return f"{inner}^{{{_AFTER[name]}}}"
        return rf"\left({inner}\right)^{{{_AFTER[name]}}}"
    if name == "diag" and isinstance(argument, ast.List):
        return rf"\text{{diag}}\left({', '.join(_walk(cell) for cell in argument.elts)}\right)"
    if name == "diag":
        return rf"\text{{diag}}\left({_walk(argument)}\right)"
    if name == "sum":
        return rf"\sum {_walk(argument)}"
    return rf"\{name} {_inside(argument, 3)}"


def _joined(node: ast.BinOp) -> str:
    match node.op:
        case ast.Add():
            return f"{_walk(node.left)} + {_walk(node.right)}"
        case ast.Sub():
            return f"{_walk(node.left)} - {_inside(node.right, 1, strict=True)}"
        case ast.Pow():
            return f"{_inside(node.left, 4, strict=True)}^{{{_walk(node.right)}}}"
        case ast.Div() if isinstance(node.left, ast.Call):  # a matrix over a number
            return rf"\frac{{1}}{{{_walk(node.right)}}}\,{_walk(node.left)}"
        case ast.Div():
            return rf"\frac{{{_walk(node.left)}}}{{{_walk(node.right)}}}"
        case ast.MatMult() if _flat(node.left) is not None:  # times a vector: a row
            return rf"{_matrix([[_walk(cell) for cell in _flat(node.left) or ()]])}\,{_inside(node.right, 2)}"
        case ast.Mult() | ast.MatMult():
            return rf"{_inside(node.left, 2)}\,{_inside(node.right, 2)}"
    raise ValueError(f"no mathematics for {ast.unparse(node)}")
