"""JSON: a report as one document for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from drivesizer.output.json.documents import as_text
from drivesizer.output.json.driving import path_document
from drivesizer.output.json.file import document
from drivesizer.output.report.sections.content import Content

__all__ = ["render"]


def render(content: Content, path: Path) -> dict[Path, bytes]:
    """The file of a JSON report."""
    found: dict[str, Any] = {**document(content.result, content.validation)}
    if content.behaviour and content.result.spec.platform:
        found["platform"] = path_document(content.result.spec, content.behaviour.permitted, content.behaviour.followed)
    text = f"{as_text(found)}\n"
    return {path: text.encode("utf-8", "backslashreplace")}  # a lone surrogate, which a spec may have, becomes \udxxx
