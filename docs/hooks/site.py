"""Hooks of mkdocs: the project's own files as pages, mathematics as MathML, and its font."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import mathematics
from mkdocs.structure.files import File

ROOT = Path(__file__).resolve().parents[2]
_PROJECT = {
    "ARCHITECTURE.md": "architecture.md", "CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md",
    "SECURITY.md": "security.md",
}  # fmt: skip
_LINK = re.compile(r"\[([^\]]+)\]\(([^)#]+)(#[^)]*)?\)")


def on_files(files: Any, config: Any) -> Any:
    """Take the project's own files in as pages."""
    for name, page in _PROJECT.items():
        text = _LINK.sub(_relinked, (ROOT / name).read_text(encoding="utf-8"))
        files.append(File.generated(config, page, content=text))
    return files


def _relinked(link: re.Match[str]) -> str:
    """A link of the project's root as one of the site; what the site has not is named without a link."""
    text, target, place = link[1], link[2], link[3] or ""
    page = _PROJECT.get(target, target.removeprefix("docs/") if target.startswith("docs/") else "")
    if target.startswith("http"):
        return link[0]
    return f"[{text}]({page}{place})" if page.endswith(".md") else text


def on_page_content(html: str, **_: Any) -> str:
    """Turn mathematics into MathML."""
    return mathematics.rendered(html)


def on_post_build(config: Any) -> None:
    """Lay the font beside the style sheet."""
    (Path(config["site_dir"]) / "assets" / "stix-two-math.woff").write_bytes(mathematics.font())
