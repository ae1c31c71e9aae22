"""JSON: a report as one document for other programs."""

from __future__ import annotations

from drivesizer.output.document.axes import MachineContent
from drivesizer.output.document.content import Content
from drivesizer.output.json.documents import OnPath, as_text, on_path, report
from drivesizer.results.machine import of_one_axis


def report_json(content: Content | MachineContent) -> bytes:
    """A sizing with the closed loop of every axis, as the bytes of a file."""
    if isinstance(content, MachineContent):
        found = report(content.sizing, content.proofs)
    else:
        sizing, behaviour, paths = of_one_axis(content.result), content.behaviour, dict[str, OnPath]()
        name = sizing.axes[0].name
        if behaviour and content.result.spec.platform:
            paths[name] = on_path(content.result.spec, behaviour.permitted, behaviour.followed)
        found = report(sizing, {name: content.validation} if content.validation else {}, paths)
    # a lone surrogate, which a spec may have, becomes \udxxx
    return f"{as_text(found)}\n".encode("utf-8", "backslashreplace")
