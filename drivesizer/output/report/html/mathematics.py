"""Typst mathematics as MathML, which browsers set themselves: it can be copied, read aloud, and follows the page."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Mapping

__all__ = ["mathml"]


def mathml(sources: Iterable[str]) -> Mapping[str, str]:
    """MathML of pieces of typst mathematics, in one run of typst.

    Examples
    --------
    >>> mathml(["V / t"])["V / t"]
    '<math><mfrac><mi>V</mi><mi>t</mi></mfrac></math>'
    """
    import typst

    wanted = list(dict.fromkeys(source for source in sources if source))
    if not wanted:
        return {}
    page = "\n".join(f"#html.elem({_PLACE})[${source}$]" for source in wanted)
    made = typst.compile(page.encode(), format="html", font_paths=typst.Fonts(include_system_fonts=False))
    found = re.findall(f"<{_TAG}>(.*?)</{_TAG}>", made.decode(), re.DOTALL)
    return {source: _plain(text) for source, text in zip(wanted, found, strict=True)}


_TAG = "output"  # an element that mathematics does not have
_PLACE = f'"{_TAG}"'


def _plain(math: str) -> str:
    """Letters of the alphabet in place of mathematical ones: a browser slants them itself, in any font."""
    return re.sub(r"<mi>([^<]+)</mi>", lambda m: f"<mi>{unicodedata.normalize('NFKC', m[1])}</mi>", math)
