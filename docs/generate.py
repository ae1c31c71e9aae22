"""The generated parts of the pages, and the figures: written, or held against what is there.

    python docs/generate.py [PAGE ...]    writes what the program says now between the marks of the pages
    python docs/generate.py figures       draws docs/figures anew

A part stands between ``<!-- generated: NAME -->`` and ``<!-- end: NAME -->``; all else on a page is written by hand.
Fields come from the schema, loads and equations from their declarations, commands from the command line itself,
licences from the installed packages.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

__all__ = ["PARTS", "made", "renewed"]

DOCS = Path(__file__).resolve().parent
sys.path[:0] = [str(DOCS / "generated"), str(DOCS / "hooks")]
PARTS = {  # name: module and function that make it
    "columns": ("catalog_page", "columns"), "commands": ("command_page", "commands"),
    "equations": ("equation_page", "equations"), "licences": ("licence_page", "licences"),
    "loads": ("load_page", "loads"), "machine": ("spec_tables", "machine_sections"),
    "platform_equations": ("platform_page", "platform_equations"),
    "sensitivities": ("following_page", "sensitivities"), "spec": ("spec_tables", "sections"),
}  # fmt: skip
_PART = re.compile(r"^<!-- generated: (\w+) -->\n.*?^<!-- end: \1 -->$", re.MULTILINE | re.DOTALL)


def renewed(page: str) -> str:
    """A page with its generated parts as they are now."""
    marked = "<!-- generated: {0} -->\n\n{1}\n\n<!-- end: {0} -->"
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
    for path in [Path(name) for name in names] or sorted(DOCS.rglob("*.md")):
        text = path.read_text(encoding="utf-8")
        now = renewed(text)
        if now != text:
            print(f"{path}: renewed")
            path.write_text(now, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
