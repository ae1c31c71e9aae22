"""The templates of the page, each text escaped; mathematics as MathML; what all pages share, kept once made."""

from __future__ import annotations

import base64
import hashlib
import re
import unicodedata
import zlib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from functools import cache
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jinja2 import BytecodeCache
from jinja2.bccache import Bucket

from drivesizer.files.cache import cached, cached_bytes, digest_of, folder, keep

if TYPE_CHECKING:
    from jinja2 import Environment


# -- Parts that all pages share, kept in the cache folder once made: the compiled template, the library as packed.


class Compiled(BytecodeCache):
    """Templates as Python compiles them; jinja2 holds them against their source and its own version."""

    def load_bytecode(self, bucket: Bucket) -> None:
        """Fill a bucket with what was kept, if it is whole."""
        bytecode = cached_bytes(_place(bucket))
        if bytecode is not None:
            bucket.bytecode_from_string(bytecode)

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Keep what a bucket holds; where the folder cannot be written it is compiled again the next time."""
        with suppress(OSError):
            keep(_place(bucket), bucket.bytecode_to_string())


def _place(bucket: Bucket) -> Path:
    return folder() / f"template{bucket.key[:8]}-{bucket.checksum}.jinja"


def packed(script: str) -> bytes:
    """A script as zlib packs it best, which takes a quarter of a second for a plotting library."""
    digest = digest_of(zlib.ZLIB_RUNTIME_VERSION.encode(), script.encode())
    return cached(f"script-{digest}.z", lambda: zlib.compress(script.encode(), 9))


# -- Typst mathematics as MathML, which browsers set themselves: it can be copied, read aloud, and follows the page.


def mathml(sources: Iterable[str]) -> Mapping[str, str]:
    """MathML of pieces of typst mathematics, in one run of typst.

    Examples
    --------
    >>> mathml(["V / t"])["V / t"]
    '<math><mfrac><mi>V</mi><mi>t</mi></mfrac></math>'
    """
    import typst

    formulas = list(dict.fromkeys(source for source in sources if source))
    if not formulas:
        return {}
    page = "\n".join(f"#html.elem({_PLACE})[${source}$]" for source in formulas)
    html = typst.compile(page.encode(), format="html", font_paths=typst.Fonts(include_system_fonts=False))
    texts = re.findall(f"<{_TAG}>(.*?)</{_TAG}>", html.decode(), re.DOTALL)
    return {source: _plain(text) for source, text in zip(formulas, texts, strict=True)}


_TAG = "output"  # an element that mathematics does not have
_PLACE = f'"{_TAG}"'


def _plain(math: str) -> str:
    """Letters of the alphabet in place of mathematical ones: a browser slants them itself, in any font."""
    return re.sub(r"<mi>([^<]+)</mi>", lambda m: f"<mi>{unicodedata.normalize('NFKC', m[1])}</mi>", math)


# -- The templates of the page: of a whole report, and of one section alone, each text escaped.


_FILES = resources.files("drivesizer.output.report.html")
_BREAK = "\u200b"  # where a PDF may end a line; a browser finds such places itself


@cache
def own_file(name: str) -> str:
    """Text of a template, style or script of this folder."""
    return _FILES.joinpath(name).read_text(encoding="utf-8")


def digest(script: str) -> str:
    """Digest by which a content security policy names a script."""
    return "sha256-" + base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()


def environment(math: Mapping[str, str]) -> Environment:
    """The templates with their filters; a name that a document does not have is an error, not an empty place."""
    import jinja2
    from markupsafe import Markup

    templates = jinja2.Environment(
        loader=jinja2.FunctionLoader(own_file), autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True,
        lstrip_blocks=True, bytecode_cache=Compiled(),
    )  # fmt: skip
    templates.policies["json.dumps_kwargs"] = {"allow_nan": False, "ensure_ascii": False, "separators": (",", ":")}
    templates.filters["math"] = lambda source: Markup(math[source])  # noqa: S704 - set by typst from our own source
    templates.filters["noted"] = _noted
    return templates


def _noted(text: str) -> Any:
    """A note with its symbols set: F_N with a lowered N."""
    from markupsafe import Markup, escape

    symbol = r"\b([A-Za-zα-ω]{1,2})_([A-Za-z]+)"
    return Markup(re.sub(symbol, r"<var>\1</var><sub>\2</sub>", str(escape(text))))  # noqa: S704 - escaped before


def unbroken(value: Any) -> Any:
    """A document without the places where a PDF may end a line."""
    if isinstance(value, dict):
        return {key: unbroken(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [unbroken(entry) for entry in value]
    return value.replace(_BREAK, "") if isinstance(value, str) else value


def mathematics(value: Any) -> Iterator[str]:
    """Mathematics anywhere in the sections: marks in a text, and steps of the derivation."""
    if isinstance(value, list):
        for entry in value:
            yield from mathematics(entry)
    elif isinstance(value, dict) and value.get("kind") == "equation":
        step = value["step"]
        yield from (step[name] for name in ("symbol_value", "printed", "used"))
        yield f"{step['numbers']} = {step['result']}" if step["numbers"] else ""
    elif isinstance(value, dict) and value.get("kind") == "math":
        yield value["symbol"]
    elif isinstance(value, dict):
        yield from mathematics([*value.values()])


def section_html(sections: list[dict[str, Any]], figures: Mapping[str, Any], pictures: Mapping[str, str]) -> list[str]:
    """Sections of a document, each as HTML of its own."""
    whole = unbroken(sections)
    parts: Any = environment(mathml(mathematics(whole))).get_template("blocks.html").module
    page = {"figures": figures, "pictures": pictures}
    return ["".join(str(parts.block(block, page)) for block in section["blocks"]) for section in whole]
