"""Mathematics of the pages as MathML: from LaTeX in the text, and from the expressions of declared equations.

Browsers show MathML themselves; the font with the tables that this takes is STIX Two Math (SIL Open Font License),
cut down to the signs that the pages use.
"""

from __future__ import annotations

import ast
import html
import re
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path

from latex2mathml.converter import convert

from drivesizer.output import formula

__all__ = ["displayed", "expression", "font", "rendered", "symbol"]

_INLINE = re.compile(r'<span class="arithmatex">\\\((.*?)\\\)</span>', re.DOTALL)
_DISPLAY = re.compile(r'<div class="arithmatex">\s*\\\[(.*?)\\\]\s*</div>', re.DOTALL)
_SPACE = '<mspace width="0.17em"/>'
_FUNCTION = re.compile(r"(?<=>)<mi>(sin|cos|tan|tanh|arctan|exp|min|max|sgn)</mi>(<mo[^>]*>&#x00028;)?")
_WORD = re.compile(r"\\mathrm\{([A-Za-z]{2,})\}")
_USED: set[str] = set()  # signs that the pages have shown so far


def mathml(source: str, display: str = "inline") -> str:
    """LaTeX as MathML."""
    named = _WORD.sub(lambda m: rf"\operatorname{{{m[1]}}}" if m[1] == "sgn" else rf"\text{{{m[1]}}}", source)
    made = convert(named.strip(), display=display)
    made = re.sub(r"<mo[^>]*>sgn</mo>", "<mi>sgn</mi>", made).replace("<mover>", '<mover accent="true">')
    made = made.replace('<mo stretchy="false">&#x0007C;</mo>', '<mo stretchy="false" lspace="0" rspace="0">|</mo>')
    made = _FUNCTION.sub(lambda m: f"{_SPACE}<mi>{m[1]}</mi>{m[2] or _SPACE}", made)
    _USED.update(html.unescape(re.sub(r"<[^>]+>", "", made)))
    return made


def displayed(source: str) -> str:
    """LaTeX as a formula on a line of its own; what stands apart in it may go to the next in a narrow window."""
    parts = "".join(mathml(part, "block") for part in source.split(r"\qquad"))
    return f'<div class="equation">{parts}</div>'


def rendered(page: str) -> str:
    """A page in HTML with its mathematics as MathML."""
    page = _DISPLAY.sub(lambda m: displayed(html.unescape(m[1])), page)
    return _INLINE.sub(lambda m: mathml(html.unescape(m[1])), page)


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
            return symbol(formula.symbol_text(name, paper=paper))
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


def font() -> bytes:
    """STIX Two Math with the signs that the pages use, as WOFF."""
    from fontTools import subset
    from fontTools.ttLib import TTFont

    package = find_spec("ziamath")
    assert package is not None and package.origin is not None
    source = Path(package.origin).parent / "fonts" / "STIXTwoMath-Regular.ttf"
    options = subset.Options(
        flavor="woff", layout_features=["*"], recalc_timestamp=False, hinting=False, name_IDs=["*"]
    )
    letters = {chr(code) for code in range(0x20, 0x7F)} | set("√−") | _USED | _italics()
    with TTFont(source, recalcTimestamp=False) as whole:
        cut = subset.Subsetter(options)
        cut.populate(unicodes=[ord(c) for c in letters])
        cut.subset(whole)
        whole.flavor = "woff"
        made = BytesIO()
        whole.save(made)
    return made.getvalue()


def _italics() -> set[str]:
    """Mathematical italics: a browser takes these for single letters."""
    return {chr(code) for code in range(0x1D434, 0x1D468)} | {chr(code) for code in range(0x1D6E2, 0x1D71C)} | {"ℎ"}
