"""The generated parts of the pages, and the figures: written, or held against what is there.

    python docs/generate.py [PAGE ...]    writes what the program says now between the marks of the pages
    python docs/generate.py figures       draws docs/figures anew

A part stands between ``<!-- generated: NAME -->`` and ``<!-- end: NAME -->``, a number within a line between
``<!-- count: NAME -->`` and ``<!-- end -->``; all else on a page is written by hand.
Fields come from the schema, loads and equations from their declarations, commands from the command line itself,
licences from the installed packages.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

__all__ = ["PAGES", "PARTS", "made", "renewed"]

DOCS = Path(__file__).resolve().parent
PAGES = [DOCS.parent / "README.md", *sorted(DOCS.rglob("*.md"))]
sys.path[:0] = [str(DOCS / "generated"), str(DOCS / "hooks")]
PARTS = {  # name: module and function that make it
    "actuators": ("catalog_page", "actuators"), "columns": ("catalog_page", "columns"),
    "combinations": ("catalog_page", "combinations"), "commands": ("command_page", "commands"),
    "equations": ("equation_page", "equations"), "json": ("json_page", "json_documents"),
    "licences": ("licence_page", "licences"),
    "loads": ("load_page", "loads"), "machine": ("spec_tables", "machine_sections"),
    "makers": ("catalog_page", "makers"), "shipped": ("catalog_page", "shipped"),
    "permitted": ("catalog_page", "permitted"),
    "with_overlap": ("catalog_page", "with_overlap"), "without_overlap": ("catalog_page", "without_overlap"),
    "platform_equations": ("platform_page", "platform_equations"),
    "sensitivities": ("following_page", "sensitivities"), "spec": ("spec_tables", "sections"),
}  # fmt: skip
_PART = re.compile(r"^<!-- generated: (\w+) -->\n.*?^<!-- end: \1 -->$", re.MULTILINE | re.DOTALL)
_COUNT = re.compile(r"<!-- count: (\w+) -->[^<]*<!-- end -->")


def renewed(page: str) -> str:
    """A page with its generated parts as they are now."""
    marked = "<!-- generated: {0} -->\n\n{1}\n\n<!-- end: {0} -->"
    page = _COUNT.sub(lambda found: f"<!-- count: {found[1]} -->{made(found[1])}<!-- end -->", page)
    return _PART.sub(lambda found: marked.format(found[1], made(found[1])), page)


def made(name: str) -> str:
    """A generated part by its name."""
    module, function = PARTS[name]
    make: Callable[[], str] = getattr(import_module(module), function)
    return make()


def main(names: list[str]) -> None:
    """Bring pages, or the figures, up to date."""
    if names == ["figures"]:
        import_module("figures").write(DOCS / "figures")
        return
    for path in [Path(name) for name in names] or PAGES:
        text = path.read_text(encoding="utf-8")
        now = renewed(text)
        if now != text:
            print(f"{path}: renewed")
            path.write_text(now, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
