"""Jobs that take longer than an answer: the closed loop, reports and exports, as the command line makes them."""

from __future__ import annotations

import base64
import io
import json
import tempfile
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from drivesizer.errors import InputError, quoted
from drivesizer.live.answer import ranking, result_pieces
from drivesizer.live.held import EngineMemory, Piece
from drivesizer.live.reading import text_of, whole

__all__ = ["document", "export", "loop", "report"]


def document(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """The JSON document of ``drivesizer size --json --top 10 --pareto mass,price,energy``, byte for byte.

    A spec of which the page shows no front, or one of mass and price, is one without ``--pareto``, or with those.
    """
    from drivesizer.output.json import documents

    result = whole(held, text_of(held, request), front=True)
    if hasattr(result, "axes"):
        from drivesizer.output.json.machine import machine_document

        text = documents.as_text(machine_document(result))
    else:
        text = documents.as_text(documents.sizing(result))
    yield _file("drive.json", f"{text}\n".encode())


def loop(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """The answer once more with its closed loop: ranking, sections, figures, still figures."""
    result, proofs = _proven(held, request)
    yield {"kind": "ranking", **ranking(result, proofs)}
    yield from result_pieces(held, result, proofs)


def report(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A report as ``drivesizer report`` writes it."""
    from drivesizer.output.report import KNOWN, write, write_machine

    suffix = f".{request['form']}"
    if suffix not in KNOWN:
        raise InputError(f"{quoted(suffix)} does not say which kind of report; expected {', '.join(KNOWN)}")
    result, proofs = _proven(held, request)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"report{suffix}"
        if hasattr(result, "axes"):
            write_machine(result, proofs, [path])
        else:
            write(result, proofs, [path])
        yield _file(path.name, path.read_bytes())


def export(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """The best drive as ``drivesizer export`` writes it, a platform whole; several files come as one archive."""
    from drivesizer.output.export import FORMATS
    from drivesizer.output.export.machine import machine_export, write_machine
    from drivesizer.output.export.platform import write_drive

    form = str(request["form"])
    if form not in FORMATS:
        raise InputError(f"{quoted(form)} is not known; expected {', '.join(FORMATS)}")
    result = whole(held, text_of(held, request), top=1)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"drive{FORMATS[form].suffixes[0]}"
        if hasattr(result, "axes"):
            if any(one.best is None for one in result.axes):
                raise InputError("an axis has no drive that meets all limits; nothing to export")
            write_machine(machine_export(result, one_rate=form == "ros2_control"), form, path)
        elif not result.sets:
            raise InputError("no drive meets all limits; nothing to export")
        else:
            write_drive(result.spec, result.sets[0], form, path)
        yield _together(Path(folder), path)


def _proven(held: EngineMemory, request: Piece) -> tuple[Any, Any]:
    """The sizing, and the closed loop of the best drive, or of each axis."""
    from drivesizer.commands.proving import proven, proven_axes

    text = text_of(held, request)
    result = whole(held, text, front=True)
    found: tuple[Any, Any] = held.keep(
        json.dumps(["proven", text]), lambda: proven_axes(result) if hasattr(result, "axes") else proven(result)
    )
    return found


def _together(folder: Path, path: Path) -> Piece:
    files = sorted(one for one in folder.rglob("*") if one.is_file())
    if len(files) == 1:
        return _file(path.name, path.read_bytes())
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for one in files:
            stamp = zipfile.ZipInfo(str(one.relative_to(folder)))  # of 1980: the same input gives the same bytes
            archive.writestr(stamp, one.read_bytes(), zipfile.ZIP_DEFLATED)
    return _file(f"{path.stem}.zip", packed.getvalue())


def _file(name: str, content: bytes) -> Piece:
    return {"kind": "file", "name": name, "content": base64.b64encode(content).decode()}
