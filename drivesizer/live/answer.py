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
from drivesizer.multi_axis.sizing import size_machine
from drivesizer.output.derivation import margin
from drivesizer.output.document import records as doc
from drivesizer.output.json.documents import as_text, plain
from drivesizer.output.words import meeting, whole_name
from drivesizer.results.check import Check, gravest, tightest, worst
from drivesizer.results.machine import MachineSizing
from drivesizer.results.sizing import mass_text, objective_figure
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


def text_of(held: EngineMemory, request: Piece) -> str:
    """The text of a request with its edits made."""
    edits = [Edit(tuple(path), value, bool(text)) for path, value, text in request.get("edits") or []]
    return edited(str(request["text"]), edits, held.name) if edits else str(request["text"])


def whole(held: EngineMemory, text: str, *, top: int = TOP, front: bool = False, brief: bool = False) -> MachineSizing:
    """The sizing of a text, made once; of a machine of one axis also with what can be chosen by weights."""

    def sized() -> MachineSizing:
        machine, objectives = read_any(YamlSource(text, held.name)), tuple[str, ...]()
        wanted, spec = front and not machine.is_several, machine.axes[0].spec
        # no front where each of its drives would be weighed in the whole machine, for minutes
        if wanted and not (spec.platform or spec.battery or spec.budget or spec.limits_the_bus or spec.supply.stalled):
            objectives = FRONT if spec.method == "physics" else tuple(name for name in FRONT if name != "energy")
        return size_machine(
            machine, top=top, pareto=objectives, choices=_CHOICES if wanted else 0, brief=brief, headline=brief,
            progress=held.go_on,
        )  # fmt: skip

    found: MachineSizing = held.keep(json.dumps([top, front, brief, text]), sized)
    return found


def faults(error: InputError, name: str) -> list[Piece]:
    """Each line of an error with the place that it names, a field as messages print it: ``transmission[2].ratio``."""
    found = []
    for line in error.lines:
        fault: Piece = {"text": line.removeprefix(f"{name}: "), "line": None, "path": []}
        if place := re.match(rf"{re.escape(name)}:(\d+): (?:([^\s:]+): )?(.*)", line, re.DOTALL):
            steps = re.findall(r"\[(\d+)\]|([^.\[\]]+)", place[2] or "")
            path = [int(index) - 1 if index else key for index, key in steps]
            fault = {"text": place[3], "line": int(place[1]), "path": path}
        found.append({"said": line.replace(name, Path(name).name), **fault})
    return found


# -- The answer to a spec: the ranking first, then the sections of its report, then the figures.


_LATER = "data:,"  # address of a still figure until it is drawn
_PAUSE = 0.12  # s without a newer request, after which the whole report is computed
_NOT_LIVE = ("repeat", "file")  # sections of a report that say how it came about


def answer(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """Pieces ``spec``, ``wrong`` or ``ranking``, ``sections``, ``figures`` and one ``still`` after another.

    A spec with free figures is no drive yet: ``spec`` and ``free``.
    """
    text = str(request["text"])
    try:
        text = text_of(held, request)
        source = YamlSource(text, held.name)
        yield {"kind": "spec", "text": text, "data": source.data}
        if free := [[field_name(path), given] for path, given in open_figures(source.data) if FREE in given]:
            yield {"kind": "free", "figures": free}
            return
        yield {"kind": "ranking", **ranking(whole(held, text, brief=True))}
        held.rest(_PAUSE)
        result = whole(held, text, front=True)
    except InputError as error:
        yield {"kind": "wrong", "text": text, "lines": list(error.lines), "faults": faults(error, held.name)}
        return
    if result.alone and not result.alone.sets:
        yield {"kind": "ranking", **ranking(result)}  # the closest rejected are of the whole sizing
    yield from result_pieces(held, result)


def result_pieces(
    held: EngineMemory, sizing: MachineSizing, proofs: Mapping[str, Validation] | None = None
) -> Iterator[Piece]:
    """Pieces of a sizing: sections, figures that can be moved, still figures; as of the HTML report."""
    from drivesizer.output.document.axes import content_of
    from drivesizer.output.report.html.page import image, page_parts
    from drivesizer.output.report.html.templates import section_html

    document, figures, still = page_parts(content_of(sizing, proofs or {}))
    printed = [one for one in document["sections"] if one["name"] not in _NOT_LIVE]
    made = section_html(printed, figures, dict.fromkeys(still, _LATER))
    sections = [{name: one[name] for name in ("name", "title", "level")} | {"html": html}
                for one, html in zip(printed, made, strict=True)]  # fmt: skip
    # of the table of candidates, of which some can be compared; those of a machine are of several searches
    listed = (*one.sets, *one.unsure, *one.misses) if (one := sizing.alone) else ()
    yield {"kind": "sections", "sections": sections, "drives": [_named(drive) for drive in listed]}
    held.go_on()
    yield {"kind": "figures", "figures": plain(figures)}
    for name, draw in still.items():
        held.go_on()
        yield {"kind": "still", "name": name, "address": image(draw("svg"))}


def ranking(sizing: MachineSizing, proofs: Mapping[str, Validation] | None = None) -> Piece:
    """The drives in a few figures, for what the page shows before the report: the best, and what decides."""
    one, found = sizing.alone, proofs or {}
    loops = [[proof.loop if one else name, f"{proof.status}: {proof.failed}".removesuffix(": ")]
             for name, proof in found.items()]  # fmt: skip
    made = [proof.status for proof in found.values()]
    if not one:
        axes = [{"axis": axis.name, **_set(axis.best)} if axis.best else {"axis": axis.name} for axis in sizing.axes]
        return {"machine": True, "status": gravest([sizing.status, *made]), "axes": axes, "sets": [], "loops": loops,
                **_of_all_axes(sizing)}  # fmt: skip
    best = one.shown
    return {
        "machine": False, "status": gravest([best.status if best else "fail", *made]), "loops": loops,
        "found": bool(one.sets), "axes": [],
        "considered": one.counts.considered, "feasible": one.counts.feasible,
        "met": meeting(one.counts, best.status if one.sets and best else None), "objective": one.objective,
        "margins": [_tight(check) for check in tightest(best.deciding, _MARGINS)] if best else [],
        "sets": [_set(s) for s in one.sets or one.misses],
    }  # fmt: skip


def _of_all_axes(sizing: MachineSizing) -> Piece:
    """Totals of the parts list of all axes as reports have them, and the smallest margin with its axis."""
    from drivesizer.output.document.summary import total_of
    from drivesizer.output.parts import machine_parts_of_axes, totals_of_axes

    every = totals_of_axes(machine_parts_of_axes(sizing))
    sums = {name: [one for one in every if one.name == name] for name in ("mass", "price")}
    least = "" if sizing.complete else "≥ "
    said = {name: " + ".join(least + total_of(one).text.removeprefix(least) for one in found) or "unknown"
            for name, found in sums.items()}  # fmt: skip
    check, axis = sizing.tightest() or (None, "")
    tight = _tight(check)
    values = {name: plain(found[0].value) if len(found) == 1 else None for name, found in sums.items()}
    return {**values, "figures": said, "tight": tight and tight | {"axis": axis}}


def _set(one: Any) -> Piece:
    """A drive with the figures that a reader wants first; unknown ones are left out of the texts."""
    from drivesizer.output.document.candidates import numbers_of, short_name

    energy = objective_figure(one, "energy").value
    figures = {"mass": mass_text(one), "price": one.price_text.replace("at least", "≥")}
    figures |= {"energy": show(energy, "J", "energy")} if energy == energy else {}
    return {
        **_named(one), "name": short_name(one), "numbers": numbers_of(one), "status": one.status,
        "mass": plain(one.mass), "price": plain(one.price), "energy": plain(energy),
        "tight": _tight(worst(one.deciding)), "figures": figures,
    }  # fmt: skip


def _named(one: Any) -> Piece:
    return {"rank": one.rank, "label": one.label, "motor": one.motor.part, "gearhead": one.gearhead.part}


def _tight(check: Any) -> Piece | None:
    if check is None:
        return None
    return {"title": check.title, "margin": plain(check.margin), "said": margin(check.margin), "status": check.status}


# -- A figure of the spec over a range: where the best drive changes, and what rejects the one before it.


def sweep(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``point`` for each value, in the order of the request."""
    text, path = text_of(held, request), tuple(request["path"])
    for place, value in enumerate(request["values"]):
        held.go_on()
        best = _best(held, edited(text, [Edit(path, value)], held.name))
        yield {"kind": "point", "number": place, "value": value, **best}


def _best(held: EngineMemory, text: str) -> Piece:
    """The best drive of a spec, or why there is none."""
    from drivesizer.output.document.candidates import short_name

    try:
        result = whole(held, text, top=1, brief=True)
    except StoppedError:
        raise
    except DrivesizerError as error:
        return {"status": "wrong", "said": str(error)}
    if not result.alone:
        best = [one.best for one in result.axes]
        labels = [f"{one.name}: {one.best.label if one.best else 'none'}" for one in result.axes]
        parts = [[one.motor.part, one.gearhead.part] if one else [] for one in best]
        return {"status": result.status, "label": "; ".join(labels), "parts": parts}
    one = result.alone.shown
    if not one:
        return {"status": "fail", "label": "", "parts": []}
    return {"status": one.status if result.alone.sets else "fail", "label": one.label, "name": short_name(one),
            "parts": [one.motor.part, one.gearhead.part]}  # fmt: skip


def rejected(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``rejected``: whether a set still passes, and its check of the smallest margin."""
    spec = read_spec(YamlSource(text_of(held, request), held.name))
    found = explained(spec, request["motor"], request["gearhead"]).sets
    tight = worst(found[0].deciding) if found else None
    yield {"kind": "rejected", "status": found[0].status if found else "fail", "tight": tight.title if tight else "",
           "said": margin(tight.margin) if tight else ""}  # fmt: skip


# -- Two drives side by side: their parts, figures and checks, whether the search lists them or not.


def compare(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``compared``: a table with a column for each drive, as HTML."""
    from drivesizer.live.catalogue import html

    spec = read_spec(YamlSource(text_of(held, request), held.name))
    catalog, drives = load_parts(spec), []
    for motor, gearhead in request["sets"]:
        held.go_on()
        sets = explained(spec, motor, gearhead, catalog=catalog).sets
        if not sets:
            raise InputError(f"{motor} with {gearhead}: no belt of the spec goes with it")
        drives.append(min(sets, key=lambda one: one.rank))
    rows: list[tuple[str, str, list[doc.Text]]] = [("drive", "verdict", [(doc.Status(one.status),) for one in drives])]
    for role in dict.fromkeys(role for one in drives for role in one.parts):
        parts = [one.parts.get(role) for one in drives]
        rows.append(("parts", role, [whole_name(part) if part else "none" for part in parts]))
    rows.append(("figures", "mass of a drive", [mass_text(one) for one in drives]))
    rows.append(("figures", "price of a drive", [one.price_text for one in drives]))
    figures = [{one.name: one for one in drive.figures} for drive in drives]
    for name, title in {one.name: one.title for drive in drives for one in drive.figures}.items():
        rows.append(("figures", title, [each[name].text if name in each else "–" for each in figures]))
    checks = [{one.name: one for one in drive.checks} for drive in drives]
    for name, title in {one.name: one.title for drive in drives for one in drive.checks}.items():
        rows.append(("checks", title, [_judged(each.get(name)) for each in checks]))
    columns = [doc.Column("title", "", "name"), *(doc.Column(str(n), one.label) for n, one in enumerate(drives))]
    made = [
        doc.Row({"group": group, "title": title} | {str(n): cell for n, cell in enumerate(cells)},
                status="" if len(set(map(repr, cells))) > 1 else "alike")
        for group, title, cells in rows
    ]  # fmt: skip
    words = "Margins are of each drive's worst case; rows in which the drives differ are in full colour."
    yield {"kind": "compared", "html": html([doc.Table(words, columns, made, group="group", look="compared")])}


def _judged(check: Check | None) -> doc.Text:
    """A margin with how it ends, where that is not a plain pass."""
    said = margin(check.margin) if check else "–"
    return (said or "pass") if not check or check.status == "pass" else (f"{said} ".lstrip(), doc.Status(check.status))


# -- The best machine of a spec with free figures.


def design(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``designed``: what ``drivesizer design`` prints, as HTML, and the spec with its figures filled in."""
    from drivesizer.codesign.answer import answer as designed
    from drivesizer.codesign.task import read_task
    from drivesizer.live.catalogue import html

    found = designed(read_task(YamlSource(text_of(held, request), held.name)), processes=1, progress=held.go_on)
    fills = [["best", found.filled()]] if found.best else []
    fills += [["rounded", found.filled(rounded=True)]] if found.rounded else []
    yield {"kind": "designed", "html": html(found.blocks()), "fills": fills}


# -- Jobs that take longer than an answer: the closed loop, reports and exports, as the command line makes them.


def document(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """The JSON document of ``drivesizer size --json --top 10 --pareto mass,price,energy``, byte for byte.

    A spec of which the page shows no front, or one of mass and price, is one without ``--pareto``, or with those.
    """
    yield _file("drive.json", f"{as_text(whole(held, text_of(held, request), front=True))}\n".encode())


def loop(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """The answer once more with its closed loop: ranking, sections, figures, still figures."""
    result, proofs = _proven(held, request)
    yield {"kind": "ranking", **ranking(result, proofs)}
    yield from result_pieces(held, result, proofs)


def report(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A report as ``drivesizer report`` writes it, or what to order as ``drivesizer quote`` does."""
    from drivesizer.output.report import KNOWN, write, write_quote

    form = str(request["form"])
    if f".{form}" not in KNOWN and form not in _QUOTES:
        raise InputError(f"{quoted(form)} is no kind of report; expected {', '.join([*KNOWN, *_QUOTES])}")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / (form if form in _QUOTES else f"report.{form}")
        if form in _QUOTES:
            sizing = whole(held, text_of(held, request), top=1)
            if sizing.status == "fail":
                raise InputError("no drive meets all limits: there is nothing to order")
            write_quote(sizing, [path])
        else:
            write(*_proven(held, request), [path])
        yield _file(path.name, path.read_bytes())


def export(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """The best drive as ``drivesizer export`` writes it, a platform whole; several files come as one archive."""
    from drivesizer.output import export as exports

    form = str(request["form"])
    if form not in exports.FORMATS:
        raise InputError(f"{quoted(form)} is not known; expected {', '.join(exports.FORMATS)}")
    sizing, bodies = whole(held, text_of(held, request), top=1), exports.FORMATS[form].bodies
    of = exports.machine_export(sizing, one_rate=form == "ros2_control", bodies=bodies)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"drive{exports.FORMATS[form].suffixes[0]}"
        exports.write(of, form, path)
        yield _together(Path(folder), path)


def _proven(held: EngineMemory, request: Piece) -> tuple[MachineSizing, dict[str, Validation]]:
    """The sizing, and the closed loop of the best drive of each axis."""
    from drivesizer.commands.common import proven

    text = text_of(held, request)
    result = whole(held, text, front=True)
    found: tuple[MachineSizing, dict[str, Validation]] = held.keep(json.dumps(["proven", text]), lambda: proven(result))
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
