"""JSON: a report as one document for other programs."""

from __future__ import annotations

from typing import Any

from drivesizer.output.document.axes import MachineContent
from drivesizer.output.document.content import Content
from drivesizer.output.json.behaviour import path_document
from drivesizer.output.json.documents import as_text, document, machine_document

__all__ = ["report_json"]


def report_json(content: Content | MachineContent) -> bytes:
    """A sizing with its closed loop, or a machine with those of every axis, as the bytes of a file."""
    if isinstance(content, MachineContent):
        found: dict[str, Any] = {**machine_document(content.sizing, content.proofs)}
    else:
        found = {**document(content.result, content.validation)}
        if content.behaviour and content.result.spec.platform:
            found["platform"] = path_document(
                content.result.spec, content.behaviour.permitted, content.behaviour.followed
            )
    # a lone surrogate, which a spec may have, becomes \udxxx
    return f"{as_text(found)}\n".encode("utf-8", "backslashreplace")
