"""Expressions of declared equations as LaTeX, between the signs that code hosts and the site read as mathematics."""

from __future__ import annotations

import ast

from drivesizer.output import derivation

__all__ = ["displayed", "expression", "inline", "symbol"]


def displayed(source: str) -> str:
    """LaTeX as a formula on a line of its own."""
    return f"$$\n{source}\n$$"


def inline(source: str) -> str:
    """LaTeX within a line."""
    return f"${source}$"


def symbol(text: str) -> str:
    """A symbol as it is printed, ``M_rms/m``, as LaTeX.

    >>> symbol("J_m K²")
    'J_{\\\\text{m}}\\\\,K^{2}'
    """
    return r"\,".join(_one(part[:-1]) + "^{2}" if part.endswith("²") else _one(part) for part in text.split())


def _one(text: str) -> str:
    head, _, tail = text.partition("_")
    head = rf"\text{{{head}}}" if len(head) > 1 else head
    return rf"{head}_{{\text{{{tail}}}}}" if tail else head


def expression(source: str, *, paper: bool = False) -> str:
    """The expression of a declared equation as LaTeX.

    >>> expression("d / 2 * F_nom / delta")
    '\\\\frac{d}{2}\\\\,\\\\frac{F_{\\\\text{nom}}}{δ}'
    """
    return _sum(ast.parse(source, mode="eval").body, paper)


def _sum(node: ast.expr, paper: bool) -> str:
    """A sum as it is, anything else as a product."""
    match node:
        case ast.BinOp(left=left, op=ast.Add() | ast.Sub() as sign, right=right):
            return f"{_sum(left, paper)} {'+' if isinstance(sign, ast.Add) else '-'} {_product(right, paper)}"
    return _product(node, paper)


def _product(node: ast.expr, paper: bool) -> str:
    """A product of fractions: a / b * c / d is two of them, as it is written."""
    fractions: list[tuple[list[ast.expr], list[ast.expr]]] = [([], [])]
    for factor, divides, starts in _factors(node):
        if starts or (not divides and fractions[-1][1]):
            fractions.append(([], []))
        fractions[-1][divides].append(factor)
    made = []
    for above, below in fractions:
        parts = [r"\,".join(_factor(f, paper, alone=len(side) == 1) for f in side) for side in (above, below)]
        bare = r"\,".join(_factor(f, paper) for f in above)
        made.append(rf"\frac{{{parts[0]}}}{{{parts[1]}}}" if below else bare)
    return r"\,".join(made)


def _factors(node: ast.expr) -> list[tuple[ast.expr, bool, bool]]:
    """Factors in the order in which they are written, whether each divides, and whether a bracket starts with it."""
    match node:
        case ast.BinOp(left=left, op=ast.Mult(), right=right):
            first, *rest = _factors(right)
            return [*_factors(left), (*first[:2], bool(rest)), *rest]
        case ast.BinOp(left=left, op=ast.Div(), right=right):
            return [*_factors(left), *((f, not divides, False) for f, divides, _ in _factors(right))]
    return [(node, False, False)]


def _factor(node: ast.expr, paper: bool, *, alone: bool = False) -> str:
    """A name, a number, a root, a power, a function, or a sum in brackets that it needs unless it is alone."""
    match node:
        case ast.Constant(value=value):
            return f"{value:g}"
        case ast.Name(id=name):
            return symbol(derivation.symbol_text(name, paper=paper))
        case ast.UnaryOp(op=ast.USub(), operand=inside):
            return f"-{_factor(inside, paper)}"
        case ast.Call(func=ast.Name(id="sqrt"), args=[inside]):
            return rf"\sqrt{{{_sum(inside, paper)}}}"
        case ast.Call(func=ast.Name(id=function), args=[inside]):
            return rf"\{function} {_factor(inside, paper)}"
        case ast.BinOp(left=base, op=ast.Pow(), right=power):
            if ast.unparse(power) == "1 / 2":
                return rf"\sqrt{{{_sum(base, paper)}}}"
            return rf"{_factor(base, paper)}^{{{_sum(power, paper)}}}"
    inside = _sum(node, paper)
    return inside if alone else rf"\left({inside}\right)"
