"""Pages of the documentation, read: their tables, their formulas, what the built site refers to."""

from __future__ import annotations

import html
import re
import sys
import unicodedata
from html.parser import HTMLParser
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
sys.path[:0] = [str(DOCS), str(DOCS / "hooks"), str(DOCS / "generated")]

from blocks import blocks  # noqa: E402

__all__ = ["DOCS", "ROOT", "Loads", "bare", "blocks", "page", "rows", "signs"]


def page(name):
    return (DOCS / f"{name}.md").read_text(encoding="utf-8")


def rows(text, heading, first=r"\|"):
    """Rows of the first table below a heading whose own head starts so."""
    table = re.search(rf"^{first}.*\n(?:\|.*\n)+", text.split(f"\n{heading}\n", 1)[1], re.MULTILINE)[0]
    found = [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in table.splitlines()]
    return found[2:]


class Loads(HTMLParser):
    """Addresses that a page fetches by itself; links that a reader may follow are none."""

    def __init__(self):
        super().__init__()
        self.found, self.ids = [], set()

    def handle_starttag(self, tag, attributes):
        named = dict(attributes)
        self.ids.add(named.get("id"))
        if tag in ("script", "img", "iframe", "source", "video", "audio", "embed", "use"):
            self.found.append(named.get("src") or named.get("href") or "")
        if tag == "link" and named.get("rel") not in ("canonical", "next", "prev"):
            self.found.append(named.get("href", ""))


def signs(text):
    """The letters and digits of a formula in their order, however it is set."""
    plain = html.unescape(re.sub(r"<[^>]+>", "", text)).translate(str.maketrans("²³", "23", " /√()·^_\u2062"))
    return re.sub(r"\s", "", plain.replace("−", "-").replace("\u200a", ""))


def bare(text):
    """The same of an equation between vectors: without brackets and commas, accents behind their letter."""
    plain = html.unescape(re.sub(r"<[^>]+>", "", text)).replace("⁻¹", "-1").replace("sum", "∑")
    plain = unicodedata.normalize("NFD", plain)
    accents = str.maketrans({"˙": "\u0307", "¨": "\u0308", "¯": "\u0304", "ᵀ": "T", "⁺": "+"} | dict.fromkeys("[];,"))
    return signs(plain.translate(accents)).translate(accents)
