"""A drive by its log, and the log beside its sizing, as tables and sentences."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite, isinf, isnan

from drivesizer.output.document import records as doc
from drivesizer.results.identification import Comparison, Identification, IdentifiedFigure, LogFinding
from drivesizer.units import show

_DIGITS = 4


def identification_blocks(found: Identification) -> Iterator[doc.Block]:
    """An identification: figures with bands, what cannot be separated, checks of the log."""
    rows = (
        f"{found.samples:,} samples over {show(found.duration, 's', 'time', 4)}, " if isfinite(found.duration) else ""
    )
    driven = {"none": "steady figures of a file"}.get(found.driven, f"the model is driven by the logged {found.driven}")
    yield doc.Words(f"{rows}{driven}")
    yield doc.table("identified", "", map(_row, found.figures))
    bands = "from .. to: 95 %, the widest of formal, bootstrap and subsets"
    sheet = (
        "; off by: in standard deviations of band and data sheet"
        if any(isfinite(f.deviation) for f in found.figures)
        else ""
    )
    condition = f"; condition {found.condition:.3g}" if isfinite(found.condition) else ""
    if found.driven != "none":
        yield doc.Words(f"{bands}{sheet}{condition}", "note")
    yield from _findings(found.findings)
    if found.inseparable:
        yield doc.table("inseparable", "", [(one.figures, one.reason, one.needs) for one in found.inseparable])
    if found.remarks:
        yield doc.Bullets("", list(found.remarks))


def _row(one: IdentifiedFigure) -> doc.Row:
    cells: dict[str, doc.Cell] = {"title": one.title, "basis": one.basis}
    for key in ("value", "low", "high", "printed"):
        x = getattr(one, key)
        if not isnan(x):
            cells[key] = doc.Quantity(x, one.unit, one.kind, _DIGITS, own="no limit" if isinf(x) else "")
    if not isnan(one.deviation):
        cells["deviation"] = doc.Quantity(one.deviation, "1", "plain", 2)
    return doc.Row(cells, name=one.name)


def _findings(found: Sequence[LogFinding]) -> Iterator[doc.Block]:
    severe = [one.text for one in found if one.severe]
    yield from (doc.Words(text, "alarm") for text in severe)
    if quiet := [one.text for one in found if not one.severe]:
        yield doc.Bullets("The log:", quiet)


def comparison_blocks(found: Comparison) -> Iterator[doc.Block]:
    """A log beside its sizing: check by check, and what would explain the difference."""
    rows = []
    for one in found.checks:
        cells: dict[str, doc.Cell] = {"title": one.title, "status": (doc.Status(one.status),)}
        figures = {"promised": one.promised, "measured": one.measured, "limit": one.limit}
        cells |= {key: doc.Quantity(x, one.unit, one.kind, _DIGITS) for key, x in figures.items() if not isnan(x)}
        cells |= {key: doc.Quantity(x, "%", "margin") for key, x in (("margin", one.margin), ("left", one.left))
                  if not isnan(x)}  # fmt: skip
        rows.append(doc.Row(cells, name=one.name, status=one.status))
    yield doc.table("log", "", rows)
    yield from _findings(found.findings)
    if isfinite(found.difference):
        off, whole = (show(x, "mN*m", "torque", 3) for x in (found.difference, found.torque))
        yield doc.Words(f"Torque of the motor: the spec is off by {off} RMS, of {whole} that the log needs.")
    if found.explanations:
        rows = [doc.row("explanations", one, share=doc.Quantity(one.share, "%", "dimensionless", 2))
                for one in found.explanations]  # fmt: skip
        yield doc.table("explanations", "", rows)
    if found.remarks:
        yield doc.Bullets("", list(found.remarks))
