"""The templates of the page: of a whole report, and of one section alone, each text escaped."""

from __future__ import annotations

import base64
import hashlib
import re
from collections.abc import Iterator, Mapping
from functools import cache
from importlib import resources
from typing import TYPE_CHECKING, Any

from drivesizer.output.report.html.mathematics import mathml

if TYPE_CHECKING:
    from jinja2 import Environment

__all__ = ["digest", "environment", "mathematics", "own_file", "section_html", "unbroken"]

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

    from drivesizer.output.report.html.kept import Compiled

    made = jinja2.Environment(
        loader=jinja2.FunctionLoader(own_file), autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True,
        lstrip_blocks=True, bytecode_cache=Compiled(),
    )  # fmt: skip
    made.policies["json.dumps_kwargs"] = {"allow_nan": False, "ensure_ascii": False, "separators": (",", ":")}
    made.filters["math"] = lambda source: Markup(math[source])  # noqa: S704 - set by typst from our own source
    made.filters["noted"] = _noted
    return made


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
