"""The answer to a spec: ranking, sections, figures; a figure over a range; the best machine; comparisons; files."""

from __future__ import annotations

import base64
import io
import json
import re
import tempfile
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drivesizer.errors import DrivesizerError, InputError, quoted
from drivesizer.files.yaml_source import Edit, YamlSource, edited, field_name
from drivesizer.live.engine import EngineMemory, Piece, StoppedError
from drivesizer.multi_axis import size_machine
from drivesizer.output.derivation import margin
from drivesizer.output.document import records as doc
from drivesizer.output.json.documents import as_text, plain
from drivesizer.output.words import meeting, whole_name
from drivesizer.results.check import Check, gravest, tightest, worst
from drivesizer.results.drive_set import Detail
from drivesizer.results.machine import MachineSizing
from drivesizer.results.sizing import objective_figure
from drivesizer.search.shortlist import load_parts
from drivesizer.sizing import explained
from drivesizer.spec.machine import read_any
from drivesizer.spec.robot import read_spec
from drivesizer.spec.sections import FREE, open_figures
from drivesizer.units import show

if TYPE_CHECKING:
    from drivesizer.control.validation import Validation

# -- The text of the page as a spec, and its sizing.


TOP = 10  # drives of an answer, as in a report
_MARGINS = 5  # smallest ones beside the chart
FRONT = ("mass", "price", "energy")
_QUOTES = ("quote.csv", "quote.xlsx")
_CHOICES = 200  # drives to choose from by weights, as in a report


def text_of(memory: EngineMemory, request: Piece) -> str:
    """The text of a request with its edits made."""
    edits = [Edit(tuple(path), value, bool(text)) for path, value, text in request.get("edits") or []]
    return edited(str(request["text"]), edits, memory.name) if edits else str(request["text"])


def whole(
    memory: EngineMemory, text: str, *, top: int = TOP, front: bool = False, detail: Detail = "full"
) -> MachineSizing:
    """The sizing of a text, made once; of a machine of one axis also with what can be chosen by weights."""

    def sized() -> MachineSizing:
        machine, objectives = read_any(YamlSource(text, memory.name)), tuple[str, ...]()
        has_choices, spec = front and not machine.is_several, machine.axes[0].spec
        # no front where each of its drives would be weighed in the whole machine, for minutes
        if has_choices and not (
            spec.platform or spec.battery or spec.budget or spec.limits_the_bus or spec.supply.stalled
        ):
            objectives = FRONT if spec.method == "physics" else tuple(name for name in FRONT if name != "energy")
        return size_machine(
            machine, top=top, pareto=objectives, choices=_CHOICES if has_choices else 0, detail=detail,
            progress=memory.go_on,
        )  # fmt: skip

    return memory.keep(json.dumps([top, front, detail, text]), sized)


def faults(error: InputError, name: str) -> list[Piece]:
    """Each line of an error with the place that it names, a field as messages print it: ``transmission[2].ratio``."""
    pieces = []
    for line in error.lines:
        fault: Piece = {"text": line.removeprefix(f"{name}: "), "line": None, "path": []}
        if place := re.match(rf"{re.escape(name)}:(\d+): (?:([^\s:]+): )?(.*)", line, re.DOTALL):
            steps = re.findall(r"\[(\d+)\]|([^.\[\]]+)", place[2] or "")
            path = [int(index) - 1 if index else key for index, key in steps]
            fault = {"text": place[3], "line": int(place[1]), "path": path}
        pieces.append({"said": line.replace(name, Path(name).name), **fault})
    return pieces


# -- The answer to a spec: the ranking first, then the sections of its report, then the figures.


_LATER = "data:,"  # address of a still figure until it is drawn
_PAUSE = 0.12  # s without a newer request, after which the whole report is computed
_NOT_LIVE = ("repeat", "file")  # sections of a report that say how it came about


def answer(memory: EngineMemory, request: Piece) -> Iterator[Piece]:
    """Pieces ``spec``, ``wrong`` or ``ranking``, ``sections``, ``figures`` and one ``still`` after another.

    A spec with free figures is no drive yet: ``spec`` and ``free``.
    """
    text = str(request["text"])
    try:
        text = text_of(memory, request)
        source = YamlSource(text, memory.name)
        yield {"kind": "spec", "text": text, "data": source.data}
        if free := [[field_name(path), figure] for path, figure in open_figures(source.data) if FREE in figure]:
            yield {"kind": "free", "figures": free}
            return
        yield {"kind": "ranking", **ranking(whole(memory, text, detail="headline"))}
        memory.rest(_PAUSE)
        result = whole(memory, text, front=True)
    except InputError as error:
        yield {"kind": "wrong", "text": text, "lines": list(error.lines), "faults": faults(error, memory.name)}
        return
    if result.alone and not result.alone.sets:
        yield {"kind": "ranking", **ranking(result)}  # the closest rejected are of the whole sizing
    yield from result_pieces(memory, result)


def result_pieces(
    memory: EngineMemory, sizing: MachineSizing, proofs: Mapping[str, Validation] | None = None
) -> Iterator[Piece]:
    """Pieces of a sizing: sections, figures that can be moved, still figures; as of the HTML report."""
    from drivesizer.output.document.axes import content_of
    from drivesizer.output.report.html.page import image, page_parts
    from drivesizer.output.report.html.templates import section_html

    document, figures, still = page_parts(content_of(sizing, proofs or {}))
    printed = [section for section in document["sections"] if section["name"] not in _NOT_LIVE]
    texts = section_html(printed, figures, dict.fromkeys(still, _LATER))
    sections = [{name: section[name] for name in ("name", "title", "level")} | {"html": html}
                for section, html in zip(printed, texts, strict=True)]  # fmt: skip
    # of the table of candidates, of which some can be compared; those of a machine are of several searches
    listed = (*alone.sets, *alone.unsure, *alone.misses) if (alone := sizing.alone) else ()
    yield {"kind": "sections", "sections": sections, "drives": [_named(drive) for drive in listed]}
    memory.go_on()
    yield {"kind": "figures", "figures": plain(figures)}
    for name, drawing in still.items():
        memory.go_on()
        yield {"kind": "still", "name": name, "address": image(drawing)}


def ranking(sizing: MachineSizing, proofs: Mapping[str, Validation] | None = None) -> Piece:
    """The drives in a few figures, for what the page shows before the report: the best, and what decides."""
    alone, axis_proofs = sizing.alone, proofs or {}
    loops = [[proof.loop if alone else name, f"{proof.status}: {proof.failed}".removesuffix(": ")]
             for name, proof in axis_proofs.items()]  # fmt: skip
    statuses = [proof.status for proof in axis_proofs.values()]
    if not alone:
        axes = [{"axis": axis.name, **_set(axis.best)} if axis.best else {"axis": axis.name} for axis in sizing.axes]
        return {"machine": True, "status": gravest([sizing.status, *statuses]), "axes": axes, "sets": [],
                "loops": loops, **_of_all_axes(sizing)}  # fmt: skip
    best = alone.reported
    return {
        "machine": False, "status": gravest([best.status if best else "fail", *statuses]), "loops": loops,
        "found": bool(alone.sets), "axes": [],
        "considered": alone.counts.considered, "feasible": alone.counts.feasible,
        "met": meeting(alone.counts, best.status if alone.sets and best else None), "objective": alone.objective,
        "margins": [_tight(check) for check in tightest(best.deciding, _MARGINS)] if best else [],
        "sets": [_set(s) for s in alone.sets or alone.misses],
    }  # fmt: skip


def _of_all_axes(sizing: MachineSizing) -> Piece:
    """Totals of the parts list of all axes as reports have them, and the smallest margin with its axis."""
    from drivesizer.output.document.summary import total_of
    from drivesizer.output.parts import machine_parts_of_axes, totals_of_axes

    totals = totals_of_axes(machine_parts_of_axes(sizing))
    sums = {name: [total for total in totals if total.name == name] for name in ("mass", "price")}
    least = "" if sizing.complete else "≥ "
    texts = {name: " + ".join(least + total_of(amount).text.removeprefix(least) for amount in amounts) or "unknown"
            for name, amounts in sums.items()}  # fmt: skip
    check, axis = sizing.tightest() or (None, "")
    tight = _tight(check)
    values = {name: plain(amounts[0].value) if len(amounts) == 1 else None for name, amounts in sums.items()}
    return {**values, "figures": texts, "tight": tight and tight | {"axis": axis}}


def _set(drive: Any) -> Piece:
    """A drive with the figures that a reader wants first; unknown ones are left out of the texts."""
    from drivesizer.output.document.candidates import numbers_of, short_name

    energy = objective_figure(drive, "energy").value
    figures = {"mass": drive.mass_text, "price": drive.price_text.replace("at least", "≥")}
    figures |= {"energy": show(energy, "J", "energy")} if energy == energy else {}
    return {
        **_named(drive), "name": short_name(drive), "numbers": numbers_of(drive), "status": drive.status,
        "mass": plain(drive.mass), "price": plain(drive.price), "energy": plain(energy),
        "tight": _tight(worst(drive.deciding)), "figures": figures,
    }  # fmt: skip


def _named(drive: Any) -> Piece:
    return {"rank": drive.rank, "label": drive.label, "motor": drive.motor.part, "gearhead": drive.gearhead.part}


def _tight(check: Any) -> Piece | None:
    if check is None:
        return None
    return {"title": check.title, "margin": plain(check.margin), "said": margin(check.margin), "status": check.status}


# -- A figure of the spec over a range: where the best drive changes, and what rejects the one before it.


def sweep(memory: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``point`` for each value, in the order of the request."""
    text, path = text_of(memory, request), tuple(request["path"])
    for place, value in enumerate(request["values"]):
        memory.go_on()
        best = _best(memory, edited(text, [Edit(path, value)], memory.name))
        yield {"kind": "point", "number": place, "value": value, **best}


def _best(memory: EngineMemory, text: str) -> Piece:
    """The best drive of a spec, or why there is none."""
    from drivesizer.output.document.candidates import short_name

    try:
        result = whole(memory, text, top=1, detail="headline")
    except StoppedError:
        raise
    except DrivesizerError as error:
        return {"status": "wrong", "said": str(error)}
    if not result.alone:
        best = [axis.best for axis in result.axes]
        labels = [f"{axis.name}: {axis.best.label if axis.best else 'none'}" for axis in result.axes]
        parts = [[drive_set.motor.part, drive_set.gearhead.part] if drive_set else [] for drive_set in best]
        return {"status": result.status, "label": "; ".join(labels), "parts": parts}
    drive = result.alone.reported
    if not drive:
        return {"status": "fail", "label": "", "parts": []}
    return {"status": drive.status if result.alone.sets else "fail", "label": drive.label, "name": short_name(drive),
            "parts": [drive.motor.part, drive.gearhead.part]}  # fmt: skip


def rejected(memory: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``rejected``: whether a set still passes, and its check of the smallest margin."""
    spec = read_spec(YamlSource(text_of(memory, request), memory.name))
    sets = explained(spec, request["motor"], request["gearhead"]).sets
    tight = worst(sets[0].deciding) if sets else None
    yield {"kind": "rejected", "status": sets[0].status if sets else "fail", "tight": tight.title if tight else "",
           "said": margin(tight.margin) if tight else ""}  # fmt: skip


# -- Two drives side by side: their parts, figures and checks, whether the search lists them or not.


def compare(memory: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``compared``: a table with a column for each drive, as HTML."""
    from drivesizer.live.catalogue import html

    spec = read_spec(YamlSource(text_of(memory, request), memory.name))
    catalog, drives = load_parts(spec), []
    for motor, gearhead in request["sets"]:
        memory.go_on()
        sets = explained(spec, motor, gearhead, catalog=catalog).sets
        if not sets:
            raise InputError(f"{motor} with {gearhead}: no belt of the spec goes with it")
        drives.append(min(sets, key=lambda drive: drive.rank))
    rows: list[tuple[str, str, list[doc.Text]]] = [
        ("drive", "verdict", [(doc.Status(drive.status),) for drive in drives])
    ]
    for role in dict.fromkeys(role for drive in drives for role in drive.parts):
        parts = [drive.parts.get(role) for drive in drives]
        rows.append(("parts", role, [whole_name(part) if part else "none" for part in parts]))
    rows.append(("figures", "mass of a drive", [drive.mass_text for drive in drives]))
    rows.append(("figures", "price of a drive", [drive.price_text for drive in drives]))
    figures = [{figure.name: figure for figure in drive.figures} for drive in drives]
    for name, title in {figure.name: figure.title for drive in drives for figure in drive.figures}.items():
        rows.append(("figures", title, [by_name[name].text if name in by_name else "–" for by_name in figures]))
    checks = [{check.name: check for check in drive.checks} for drive in drives]
    for name, title in {check.name: check.title for drive in drives for check in drive.checks}.items():
        rows.append(("checks", title, [_judged(by_name.get(name)) for by_name in checks]))
    columns = [doc.Column("title", "", "name"), *(doc.Column(str(n), drive.label) for n, drive in enumerate(drives))]
    table_rows = [
        doc.Row({"group": group, "title": title} | {str(n): cell for n, cell in enumerate(cells)},
                status="" if len(set(map(repr, cells))) > 1 else "alike")
        for group, title, cells in rows
    ]  # fmt: skip
    words = "Margins are of each drive's worst case; rows in which the drives differ are in full colour."
    yield {"kind": "compared", "html": html([doc.Table(words, columns, table_rows, group="group", look="compared")])}


def _judged(check: Check | None) -> doc.Text:
    """A margin with how it ends, where that is not a plain pass."""
    text = margin(check.margin) if check else "–"
    return (text or "pass") if not check or check.status == "pass" else (f"{text} ".lstrip(), doc.Status(check.status))


# -- The best machine of a spec with free figures.


def design(memory: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``designed``: what ``drivesizer design`` prints, as HTML, and the spec with its figures filled in."""
    from drivesizer.codesign.answer import answer as designed
    from drivesizer.codesign.task import read_task
    from drivesizer.live.catalogue import html

    machine = designed(read_task(YamlSource(text_of(memory, request), memory.name)), processes=1, progress=memory.go_on)
    fills = [["best", machine.filled()]] if machine.best else []
    fills += [["rounded", machine.filled(rounded=True)]] if machine.rounded else []
    yield {"kind": "designed", "html": html(machine.blocks()), "fills": fills}


# -- Jobs that take longer than an answer: the closed loop, reports and exports, as the command line makes them.


def document(memory: EngineMemory, request: Piece) -> Iterator[Piece]:
    """The JSON document of ``drivesizer size --json --top 10 --pareto mass,price,energy``, byte for byte.

    A spec of which the page shows no front, or one of mass and price, is one without ``--pareto``, or with those.
    """
    yield _file("drive.json", f"{as_text(whole(memory, text_of(memory, request), front=True))}\n".encode())


def loop(memory: EngineMemory, request: Piece) -> Iterator[Piece]:
    """The answer once more with its closed loop: ranking, sections, figures, still figures."""
    result, proofs = _proven(memory, request)
    yield {"kind": "ranking", **ranking(result, proofs)}
    yield from result_pieces(memory, result, proofs)


def report(memory: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A report as ``drivesizer report`` writes it, or what to order as ``drivesizer quote`` does."""
    from drivesizer.output.report import KNOWN, write, write_quote

    form = str(request["form"])
    if f".{form}" not in KNOWN and form not in _QUOTES:
        raise InputError(f"{quoted(form)} is no kind of report; expected {', '.join([*KNOWN, *_QUOTES])}")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / (form if form in _QUOTES else f"report.{form}")
        if form in _QUOTES:
            sizing = whole(memory, text_of(memory, request), top=1)
            if sizing.status == "fail":
                raise InputError("no drive meets all limits: there is nothing to order")
            write_quote(sizing, [path])
        else:
            write(*_proven(memory, request), [path])
        yield _file(path.name, path.read_bytes())


def export(memory: EngineMemory, request: Piece) -> Iterator[Piece]:
    """The best drive as ``drivesizer export`` writes it, a platform whole; several files come as one archive."""
    from drivesizer.output import export as exports

    form = str(request["form"])
    if form not in exports.FORMATS:
        raise InputError(f"{quoted(form)} is not known; expected {', '.join(exports.FORMATS)}")
    sizing, bodies = whole(memory, text_of(memory, request), top=1), exports.FORMATS[form].bodies
    of = exports.machine_export(sizing, one_rate=form == "ros2_control", bodies=bodies)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"drive{exports.FORMATS[form].suffixes[0]}"
        exports.write(of, form, path)
        yield _together(Path(folder), path)


def _proven(memory: EngineMemory, request: Piece) -> tuple[MachineSizing, dict[str, Validation]]:
    """The sizing, and the closed loop of the best drive of each axis."""
    from drivesizer.commands.common import proven

    text = text_of(memory, request)
    result = whole(memory, text, front=True)
    return memory.keep(json.dumps(["proven", text]), lambda: proven(result))


def _together(folder: Path, path: Path) -> Piece:
    files = sorted(file for file in folder.rglob("*") if file.is_file())
    if len(files) == 1:
        return _file(path.name, path.read_bytes())
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in files:
            stamp = zipfile.ZipInfo(str(file.relative_to(folder)))  # of 1980: the same input gives the same bytes
            archive.writestr(stamp, file.read_bytes(), zipfile.ZIP_DEFLATED)
    return _file(f"{path.stem}.zip", packed.getvalue())


def _file(name: str, content: bytes) -> Piece:
    return {"kind": "file", "name": name, "content": base64.b64encode(content).decode()}
