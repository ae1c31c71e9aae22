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


def bench_document(result: Prediction | Identification | Comparison) -> doc.Document:
    """Prediction of a set, or figures of a log, with their course over time."""
    from drivesizer.output.report.figures.cycle import bench, measured_and_model
    from drivesizer.output.report.figures.picture import Pictured, abreast, pictured

    if isinstance(result, Prediction):
        name, subject, blocks = result.label, "prediction", _prediction(result)
        plots = bench(result)
        pictures = {"bench": Pictured(abreast(plots, 1.46, columns=3, names=4), plots)}
    else:
        plot = measured_and_model(result.time, result.traces) if len(result.traces) and len(result.time) else None
        pictures = {"bench": pictured(plot)} if plot else {}
        if isinstance(result, Identification):
            name, subject = f"{result.log}: {result.label}" if result.label else result.log, "identification"
            blocks = _identification(result)
        else:
            name, subject = f"{result.log}: {result.label}, {result.over}", "comparison"
            blocks = _comparison(result)
    sections = [doc.section("bench", subject.capitalize(), [*blocks, doc.picture(subject, "bench")])]
    return doc.Document(name=name, subject=subject, sections=sections, pictures=pictures)


def _prediction(prediction: Prediction) -> Iterator[doc.Block]:
    """A prediction as tables and sentences."""
    conditions = prediction.conditions
    load, hold = (
        "an unknown torque" if isnan(x) else show(x, "N*m", "torque", _DIGITS)
        for x in (conditions.load, conditions.hold)
    )
    words = {"load": load, "hold": hold, "duration": _time(conditions.duration).text}
    around = [show(conditions.voltage, "V", "voltage"), show(conditions.ambient, "degC", "temperature")]
    around += [f"{show(conditions.inertia, 'kg*m^2', 'inertia')} at the output"] if conditions.inertia else []
    yield doc.Words(", ".join(around))
    for group, figures in groupby(prediction.figures, key=lambda figure: figure.group):
        listed = list(figures)
        yield doc.table("predicted", _TITLES[group].format(**words), map(_row, listed), record=group)
        missing = dict.fromkeys(name for figure in listed for name in figure.missing)
        if missing:
            yield doc.Words(f"missing: {', '.join(missing)}", "note")
    if prediction.estimates:
        yield doc.table(
            "not_printed", "", [doc.row("not_printed", estimate, name="") for estimate in prediction.estimates]
        )
    bands = "; ".join(f"{name[0].lower()}{name[1:]} {text}" for name, text, _ in prediction.tolerances)
    yield doc.Bullets((doc.Note(f"5 to 95 % of {prediction.samples} samples: {bands}."),), list(prediction.assumptions))


def _row(figure: Predicted) -> doc.Row:
    """A figure with its band; what is unknown has none."""
    never = f"; never {likely(figure.never)}" if 0.0 < figure.never < 1.0 else ""
    over = f"; over its limit with {likely(figure.over)}" if figure.over > 0.0 else ""
    cells: dict[str, doc.Cell] = {"title": figure.title + never + over}
    ends = {} if isnan(figure.band.nominal) else {"p5": figure.band.p5, "p95": figure.band.p95}
    for key, x in {"value": figure.band.nominal, **ends}.items():
        beyond = (
            f"over {show(HOTTEST, 'degC', 'temperature', _DIGITS)}" if figure.unit == "degC" and x >= HOTTEST else ""
        )
        quantity = doc.Quantity(x, figure.unit, figure.kind, _DIGITS, own=beyond)
        cells[key] = _time(x) if figure.kind == "time" else quantity
    return doc.Row(cells, name=figure.name)


def _time(seconds: float) -> doc.Quantity:
    """A time in the unit that suits its size."""
    unit = "ms" if seconds < 1.0 else "s" if seconds < 600.0 else "min" if seconds < 36_000.0 else "h"
    return doc.Quantity(seconds, unit, "time", _DIGITS, own="never" if isinf(seconds) else "")


# -- A drive by its log, and the log beside its sizing.


_LOG_DIGITS = 4


def _identification(identification: Identification) -> Iterator[doc.Block]:
    """An identification: figures with bands, what cannot be separated, checks of the log."""
    rows = (
        f"{identification.samples:,} samples over {show(identification.duration, 's', 'time', 4)}, "
        if isfinite(identification.duration)
        else ""
    )
    driven = {"none": "steady figures of a file"}.get(
        identification.driven, f"the model is driven by the logged {identification.driven}"
    )
    yield doc.Words(f"{rows}{driven}")
    yield doc.table("identified", "", map(_identified_row, identification.figures))
    bands = "from .. to: 95 %, the widest of formal, bootstrap and subsets"
    sheet = (
        "; off by: in standard deviations of band and data sheet"
        if any(isfinite(f.deviation) for f in identification.figures)
        else ""
    )
    condition = f"; condition {identification.condition:.3g}" if isfinite(identification.condition) else ""
    if identification.driven != "none":
        yield doc.Words(f"{bands}{sheet}{condition}", "note")
    yield from _findings(identification.findings)
    if identification.inseparable:
        yield doc.table(
            "inseparable", "", [(group.figures, group.reason, group.needs) for group in identification.inseparable]
        )
    if identification.remarks:
        yield doc.Bullets("", list(identification.remarks))


def _identified_row(figure: IdentifiedFigure) -> doc.Row:
    cells: dict[str, doc.Cell] = {"title": figure.title, "basis": figure.basis}
    for key in ("value", "low", "high", "printed"):
        x = getattr(figure, key)
        if not isnan(x):
            plain = (
                "" if key == "value" else f"{float(from_si(x, figure.unit, figure.kind)):.{_LOG_DIGITS}g}"
            )  # one unit a row
            own = plain if isfinite(x) else "no limit"
            cells[key] = doc.Quantity(x, figure.unit, figure.kind, _LOG_DIGITS, own=own)
    if not isnan(figure.deviation):
        cells["deviation"] = doc.Quantity(figure.deviation, "1", "plain", 2)
    return doc.Row(cells, name=figure.name)


def _findings(findings: Sequence[LogFinding]) -> Iterator[doc.Block]:
    severe = [finding.text for finding in findings if finding.severe]
    yield from (doc.Words(text, "alarm") for text in severe)
    if quiet := [finding.text for finding in findings if not finding.severe]:
        yield doc.Bullets("The log:", quiet)


def _comparison(comparison: Comparison) -> Iterator[doc.Block]:
    """A log beside its sizing: check by check, and what would explain the difference."""
    rows = []
    for check in comparison.checks:
        cells: dict[str, doc.Cell] = {"title": check.title, "status": (doc.Status(check.status),)}
        figures = {"promised": check.promised, "measured": check.measured, "limit": check.limit}
        cells |= {
            key: doc.Quantity(x, check.unit, check.kind, _LOG_DIGITS) for key, x in figures.items() if not isnan(x)
        }
        cells |= {key: doc.Quantity(x, "%", "margin") for key, x in (("margin", check.margin), ("left", check.left))
                  if not isnan(x)}  # fmt: skip
        rows.append(doc.Row(cells, name=check.name, status=check.status))
    yield doc.table("log", "", rows)
    yield from _findings(comparison.findings)
    if isfinite(comparison.difference):
        off, whole = (show(x, "mN*m", "torque", 3) for x in (comparison.difference, comparison.torque))
        yield doc.Words(f"Torque of the motor: the spec is off by {off} RMS, of {whole} that the log needs.")
    if comparison.explanations:
        rows = [doc.row("explanations", explanation, share=doc.Quantity(explanation.share, "%", "dimensionless", 2))
                for explanation in comparison.explanations]  # fmt: skip
        yield doc.table("explanations", "", rows)
    if comparison.remarks:
        yield doc.Bullets("", list(comparison.remarks))
