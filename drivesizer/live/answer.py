"""The answer to a spec: the ranking first, then the sections of its report, then the figures."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.live.held import EngineMemory, Piece
from drivesizer.live.reading import faults, text_of, whole

__all__ = ["answer", "ranking", "result_pieces"]

_LATER = "data:,"  # address of a still figure until it is drawn
_PAUSE = 0.12  # s without a newer request, after which the whole report is computed
_NOT_LIVE = ("repeat", "file")  # sections of a report that say how it came about


def answer(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """Pieces ``spec``, ``wrong`` or ``ranking``, ``sections``, ``figures`` and one ``still`` after another."""
    text = str(request["text"])
    try:
        text = text_of(held, request)
        source = YamlSource(text, held.name)
        yield {"kind": "spec", "text": text, "data": source.data}
        yield {"kind": "ranking", **ranking(whole(held, text, brief=True))}
        held.rest(_PAUSE)
        result = whole(held, text, front=True)
    except InputError as error:
        yield {"kind": "wrong", "text": text, "lines": list(error.lines), "faults": faults(error, held.name)}
        return
    if not hasattr(result, "axes") and not result.sets:
        yield {"kind": "ranking", **ranking(result)}  # the closest rejected are of the whole sizing
    yield from result_pieces(held, result)


def result_pieces(held: EngineMemory, result: Any, proofs: Any = None) -> Iterator[Piece]:
    """Pieces of a sizing: sections, figures, still figures."""
    from drivesizer.output.json.documents import plain_data
    from drivesizer.output.report.html.stills import image
    from drivesizer.output.report.html.templates import section_html

    document, figures, still = _parts(result, proofs)
    printed = [one for one in document["sections"] if one["name"] not in _NOT_LIVE]
    made = section_html(printed, figures, dict.fromkeys(still, _LATER))
    heads = ({name: one[name] for name in ("name", "title", "level")} for one in printed)
    sections = [head | {"html": html} for head, html in zip(heads, made, strict=True)]
    yield {"kind": "sections", "sections": sections, "drives": _listed(result)}
    held.go_on()
    yield {"kind": "figures", "figures": plain_data(figures)}
    for name, draw in still.items():
        held.go_on()
        yield {"kind": "still", "name": name, "address": image(draw("svg"))}


def _listed(result: Any) -> list[Piece]:
    """Drives of the table of candidates, of which some can be compared; those of a machine are of several searches."""
    if hasattr(result, "axes"):
        return []
    return [_named(one) for one in (*result.sets, *result.unsure, *result.misses)]


def _parts(result: Any, proofs: Any) -> tuple[dict[str, Any], dict[str, Any], dict[str, Any]]:
    """Document, figures that can be moved and still ones, as of the HTML report."""
    if hasattr(result, "axes"):
        from drivesizer.output.report.machine.content import MachineContent
        from drivesizer.output.report.machine.html import machine_parts

        return machine_parts(MachineContent(result, proofs or {}))
    from drivesizer.output.report.html.page import page_parts
    from drivesizer.output.report.sections.content import Content

    return page_parts(Content(result, proofs))


def ranking(result: Any, proofs: Any = None) -> Piece:
    """The drives in a few figures, for what the page shows before the report: the best, and what decides."""
    from drivesizer.output.counted import meeting
    from drivesizer.results.check import gravest, worst

    found = proofs if isinstance(proofs, dict) else {proofs.loop: proofs} if proofs else {}
    loops = [[name, f"{one.status}: {one.failed}".removesuffix(": ")] for name, one in found.items()]
    made = [one.status for one in found.values()]
    if hasattr(result, "axes"):
        axes = [{"axis": one.name, **_set(one.best)} if one.best else {"axis": one.name} for one in result.axes]
        return {"machine": True, "status": gravest([result.status, *made]), "axes": axes, "sets": [], "loops": loops}
    listed = result.sets or result.misses
    best = result.shown
    return {
        "machine": False, "status": gravest([best.status if best else "fail", *made]), "loops": loops,
        "found": bool(result.sets), "axes": [],
        "considered": result.counts.considered, "feasible": result.counts.feasible,
        "met": meeting(result.counts, best.status if result.sets and best else None), "objective": result.objective,
        "tight": _tight(worst(best.deciding)) if best else None, "sets": [_set(one) for one in listed],
    }  # fmt: skip


def _set(one: Any) -> Piece:
    from drivesizer.output.json.loops import number
    from drivesizer.results.check import worst
    from drivesizer.results.objectives import objective_figure

    return {
        **_named(one), "status": one.status, "mass": number(one.mass), "price": number(one.price),
        "energy": number(objective_figure(one, "energy").value), "tight": _tight(worst(one.deciding)),
        "figures": list(_figures(one)),
    }  # fmt: skip


def _named(one: Any) -> Piece:
    return {"rank": one.rank, "label": one.label, "motor": one.motor.part, "gearhead": one.gearhead.part}


def _figures(one: Any) -> Iterator[tuple[str, str]]:
    """The figures that a reader wants first of a drive; unknown ones are left out."""
    from drivesizer.results.objectives import objective_figure
    from drivesizer.units import show

    energy = objective_figure(one, "energy").value
    each = [show(one.mass, "g", "mass")] if one.mass == one.mass else []
    each += [one.price_text] if one.price_of else []
    if each:
        yield "a drive", ", ".join(each)
    if energy == energy:
        yield "energy per cycle", show(energy, "J", "energy")


def _tight(check: Any) -> Piece | None:
    from drivesizer.output.json.loops import number
    from drivesizer.output.text import margin

    if check is None:
        return None
    return {"title": check.title, "margin": number(check.margin), "said": margin(check.margin), "status": check.status}
