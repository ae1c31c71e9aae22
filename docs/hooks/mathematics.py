"""Mathematics of the pages as MathML, from LaTeX in their text.

Browsers show MathML themselves; the font with the tables that this takes is STIX Two Math (SIL Open Font License),
cut down to the signs that the pages use.
"""

from __future__ import annotations

import html
import re
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path

from latex2mathml.converter import convert

__all__ = ["font", "mathml", "rendered"]

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


def _displayed(source: str) -> str:
    """LaTeX as a formula on a line of its own; what stands apart in it may go to the next in a narrow window."""
    parts = "".join(mathml(part, "block") for part in source.split(r"\qquad"))
    return f'<div class="equation">{parts}</div>'


def rendered(page: str) -> str:
    """A page in HTML with its mathematics as MathML."""
    page = _DISPLAY.sub(lambda m: _displayed(html.unescape(m[1])), page)
    return _INLINE.sub(lambda m: mathml(html.unescape(m[1])), page)


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
