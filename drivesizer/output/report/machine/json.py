"""JSON of a machine: the document of ``drivesizer size --json`` with the closed loop of every axis in it."""

from __future__ import annotations

from pathlib import Path

from drivesizer.output.json.documents import as_text
from drivesizer.output.json.machine import machine_document
from drivesizer.output.report.machine.content import MachineContent

__all__ = ["render_machine"]


def render_machine(content: MachineContent, path: Path) -> dict[Path, bytes]:
    """The file of a JSON report."""
    return {path: f"{as_text(machine_document(content.sizing, content.proofs))}\n".encode("utf-8", "backslashreplace")}
