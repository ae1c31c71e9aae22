"""JSON: a report as one document for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from drivesizer.output.json.behaviour import path_document
from drivesizer.output.json.documents import as_text, document, machine_document
from drivesizer.output.report.machine import MachineContent
from drivesizer.output.report.sections.section import Content

__all__ = ["render"]


def render(content: Content, path: Path) -> dict[Path, bytes]:
    """The file of a JSON report."""
    found: dict[str, Any] = {**document(content.result, content.validation)}
    if content.behaviour and content.result.spec.platform:
        found["platform"] = path_document(content.result.spec, content.behaviour.permitted, content.behaviour.followed)
    text = f"{as_text(found)}\n"
    return {path: text.encode("utf-8", "backslashreplace")}  # a lone surrogate, which a spec may have, becomes \udxxx


# -- JSON of a machine: the document of ``drivesizer size --json`` with the closed loop of every axis in it.


def render_machine(content: MachineContent, path: Path) -> dict[Path, bytes]:
    """The file of a JSON report."""
    return {path: f"{as_text(machine_document(content.sizing, content.proofs))}\n".encode("utf-8", "backslashreplace")}
