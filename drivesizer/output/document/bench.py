"""A motor with its gearhead at the bench: figures predicted, identified from a log, and a log beside its sizing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from math import isfinite, isinf, isnan

from drivesizer.output.document import records as doc
from drivesizer.output.words import likely
from drivesizer.results.identification import Comparison, Identification, IdentifiedFigure, LogFinding
from drivesizer.results.prediction import HOTTEST, Predicted, Prediction
from drivesizer.units import from_si, show

_DIGITS = 3
_TITLES = {
    "free": "Free running",
    "stall": "Stalled at full voltage",
    "load": "Running against {load}",
    "step": "Step to full voltage, no load",
    "start": "Full voltage, the machine from where its motion starts",
    "swing": "Let go where weight turns it most, terminals open",
    "coast": "Coasting, terminals open",
    "hold": "Holding {hold} at rest for {duration}",
    "work": "Running against {load} for {duration}",
}


def bench_document(found: Prediction | Identification | Comparison) -> doc.Document:
    """Prediction of a set, or figures of a log, with their course over time."""
    from drivesizer.output.report.figures.cycle import bench, measured_and_model
    from drivesizer.output.report.figures.picture import Pictured, abreast, on_paper

    if isinstance(found, Prediction):
        name, subject, blocks = found.label, "prediction", _prediction(found)
        plots = bench(found)
        pictures = {"bench": Pictured(abreast(plots, 1.46, columns=3, names=4), plots)}
    else:
        plot = measured_and_model(found.time, found.traces) if len(found.traces) and len(found.time) else None
        pictures = {"bench": Pictured(on_paper(plot), [plot])} if plot else {}
        if isinstance(found, Identification):
            name, subject = f"{found.log}: {found.label}" if found.label else found.log, "identification"
            blocks = _identification(found)
        else:
            name, subject = f"{found.log}: {found.label}, {found.over}", "comparison"
            blocks = _comparison(found)
    sections = [doc.section("bench", subject.capitalize(), [*blocks, doc.picture(subject, "bench")])]
    return doc.Document(name=name, subject=subject, sections=sections, pictures=pictures)


def _prediction(found: Prediction) -> Iterator[doc.Block]:
    """A prediction as tables and sentences."""
    given = found.conditions
    load, hold = (
        "an unknown torque" if isnan(x) else show(x, "N*m", "torque", _DIGITS) for x in (given.load, given.hold)
    )
    words = {"load": load, "hold": hold, "duration": _time(given.duration).text}
    around = [show(given.voltage, "V", "voltage"), show(given.ambient, "degC", "temperature")]
    around += [f"{show(given.inertia, 'kg*m^2', 'inertia')} at the output"] if given.inertia else []
    yield doc.Words(", ".join(around))
    for group, some in groupby(found.figures, key=lambda one: one.group):
        listed = list(some)
        yield doc.table("predicted", _TITLES[group].format(**words), map(_row, listed), record=group)
        missing = dict.fromkeys(name for one in listed for name in one.missing)
        if missing:
            yield doc.Words(f"missing: {', '.join(missing)}", "note")
    if found.estimates:
        yield doc.table("not_printed", "", [doc.row("not_printed", one, name="") for one in found.estimates])
    bands = "; ".join(f"{name[0].lower()}{name[1:]} {text}" for name, text, _ in found.tolerances)
    yield doc.Bullets((doc.Note(f"5 to 95 % of {found.samples} samples: {bands}."),), list(found.assumptions))


def _row(one: Predicted) -> doc.Row:
    """A figure with its band; what is unknown has none."""
    never = f"; never {likely(one.never)}" if 0.0 < one.never < 1.0 else ""
    over = f"; over its limit with {likely(one.over)}" if one.over > 0.0 else ""
    cells: dict[str, doc.Cell] = {"title": one.title + never + over}
    ends = {} if isnan(one.band.nominal) else {"p5": one.band.p5, "p95": one.band.p95}
    for key, x in {"value": one.band.nominal, **ends}.items():
        beyond = f"over {show(HOTTEST, 'degC', 'temperature', _DIGITS)}" if one.unit == "degC" and x >= HOTTEST else ""
        quantity = doc.Quantity(x, one.unit, one.kind, _DIGITS, own=beyond)
        cells[key] = _time(x) if one.kind == "time" else quantity
    return doc.Row(cells, name=one.name)


def _time(seconds: float) -> doc.Quantity:
    """A time in the unit that suits its size."""
    unit = "ms" if seconds < 1.0 else "s" if seconds < 600.0 else "min" if seconds < 36_000.0 else "h"
    return doc.Quantity(seconds, unit, "time", _DIGITS, own="never" if isinf(seconds) else "")


# -- A drive by its log, and the log beside its sizing.


_LOG_DIGITS = 4


def _identification(found: Identification) -> Iterator[doc.Block]:
    """An identification: figures with bands, what cannot be separated, checks of the log."""
    rows = (
        f"{found.samples:,} samples over {show(found.duration, 's', 'time', 4)}, " if isfinite(found.duration) else ""
    )
    driven = {"none": "steady figures of a file"}.get(found.driven, f"the model is driven by the logged {found.driven}")
    yield doc.Words(f"{rows}{driven}")
    yield doc.table("identified", "", map(_identified_row, found.figures))
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


def _identified_row(one: IdentifiedFigure) -> doc.Row:
    cells: dict[str, doc.Cell] = {"title": one.title, "basis": one.basis}
    for key in ("value", "low", "high", "printed"):
        x = getattr(one, key)
        if not isnan(x):
            plain = (
                "" if key == "value" else f"{float(from_si(x, one.unit, one.kind)):.{_LOG_DIGITS}g}"
            )  # one unit a row
            own = plain if isfinite(x) else "no limit"
            cells[key] = doc.Quantity(x, one.unit, one.kind, _LOG_DIGITS, own=own)
    if not isnan(one.deviation):
        cells["deviation"] = doc.Quantity(one.deviation, "1", "plain", 2)
    return doc.Row(cells, name=one.name)


def _findings(found: Sequence[LogFinding]) -> Iterator[doc.Block]:
    severe = [one.text for one in found if one.severe]
    yield from (doc.Words(text, "alarm") for text in severe)
    if quiet := [one.text for one in found if not one.severe]:
        yield doc.Bullets("The log:", quiet)


def _comparison(found: Comparison) -> Iterator[doc.Block]:
    """A log beside its sizing: check by check, and what would explain the difference."""
    rows = []
    for one in found.checks:
        cells: dict[str, doc.Cell] = {"title": one.title, "status": (doc.Status(one.status),)}
        figures = {"promised": one.promised, "measured": one.measured, "limit": one.limit}
        cells |= {key: doc.Quantity(x, one.unit, one.kind, _LOG_DIGITS) for key, x in figures.items() if not isnan(x)}
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
