"""HTML: the template filled with the document's data, with style, script and figures inside, in one file.

The file asks for nothing from anywhere, and its own policy forbids it to: only the two scripts whose digests it names
may run. Texts of a spec or a catalogue are escaped wherever they stand. The same input gives the same bytes.
"""

from __future__ import annotations

import base64
import hashlib
import re
from collections.abc import Iterator
from importlib import resources
from pathlib import Path
from typing import Any

from drivesizer.control.validation import Validation
from drivesizer.output.report.all_figures import Drawing, report_drawings
from drivesizer.output.report.content import document
from drivesizer.output.report.figures.field import MOST_PANELS
from drivesizer.output.report.figures.field_panels import Panel, panels
from drivesizer.output.report.figures.style import COLOURS
from drivesizer.output.report.html.battery_plots import charge_plot, consumers_plot
from drivesizer.output.report.html.candidate_plots import front_plot, sets_plot
from drivesizer.output.report.html.curves import Plot
from drivesizer.output.report.html.exact import with_numbers
from drivesizer.output.report.html.field_plot import field_plot
from drivesizer.output.report.html.load_plots import cycle_plot, motion_plot
from drivesizer.output.report.html.loop_plots import bode_plot, closed_loop_plot, step_plots
from drivesizer.output.report.html.mathematics import mathml
from drivesizer.output.report.set_behaviour import Behaviour
from drivesizer.results.sizing import SizingResult
from drivesizer.units import show

__all__ = ["render", "report_html"]

_FILES = resources.files("drivesizer.output.report.html")
_STILL = ("way", "tornado", "efficiency", "demand", "heat", "energy")  # figures that the page shows as the PDF does
_BREAK = "\u200b"  # where a PDF may end a line; a browser finds such places itself


def render(
    result: SizingResult, validation: Validation | None, path: Path, *, date: str | None = None
) -> dict[Path, bytes]:
    """The file of an HTML report; see :func:`report_html`."""
    return {path: report_html(result, validation, date=date)}


def report_html(result: SizingResult, validation: Validation | None, *, date: str | None = None) -> bytes:
    """The report as one HTML file.

    Parameters
    ----------
    result
        What the sizing found; without a set, the nearest misses are reported.
    validation
        The closed loop, where it was simulated.
    date
        Printed as it is given; without it there is none.
    """
    from markupsafe import Markup
    from plotly.offline import get_plotlyjs

    from drivesizer.output.report.html.kept import packed

    shown = result.shown
    does = Behaviour(result.problem, shown) if shown else None
    told = document(result, validation, does, date=date)
    content = _unbroken(with_numbers(told, result, validation))
    drawings = report_drawings(result, validation, does)
    math = mathml(_mathematics(content))
    library, script = get_plotlyjs(), _text("page.js")
    filled = _template(math).render(
        doc=content,
        best=content["best"],
        tiles=_tiles(content),
        figures=_figures(result, validation, content),
        pictures={name: _picture(drawings[name]) for name in _STILL if name in drawings},
        colours=COLOURS,
        style=Markup(_text("style.css")),  # noqa: S704 - our own file
        script=Markup(script),  # noqa: S704 - our own file
        # Packed, 2 MB in place of 4.8: a page goes through the mail, and text and tables are there before the figures.
        library=base64.b64encode(packed(library)).decode(),
        digests=[_digest(script), _digest(library)],
    )
    made: bytes = filled.encode()
    return made


def _picture(draw: Drawing) -> str:
    """A drawing as the address of an image."""
    return f"data:image/svg+xml;base64,{base64.b64encode(draw('svg')).decode()}"


def _text(name: str) -> str:
    return _FILES.joinpath(name).read_text(encoding="utf-8")


def _digest(script: str) -> str:
    """What a content security policy calls a script by."""
    return "sha256-" + base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()


def _unbroken(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _unbroken(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_unbroken(entry) for entry in value]
    return value.replace(_BREAK, "") if isinstance(value, str) else value


def _mathematics(content: dict[str, Any]) -> Iterator[str]:
    for step in (*content["load_steps"], *content["motor_steps"]):
        yield from (step[name] for name in ("symbol", "symbol_value", "printed", "used"))
        yield f"{step['numbers']} = {step['result']}" if step["numbers"] else ""


def _template(math: Any) -> Any:
    """The template with its filters; a name that the document does not have is an error, not an empty place."""
    import jinja2
    from markupsafe import Markup

    from drivesizer.output.report.html.kept import Compiled

    environment = jinja2.Environment(
        loader=jinja2.FunctionLoader(_text), autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True,
        lstrip_blocks=True, bytecode_cache=Compiled(),
    )  # fmt: skip
    environment.policies["json.dumps_kwargs"] = {"allow_nan": False, "ensure_ascii": False, "separators": (",", ":")}
    environment.filters["math"] = lambda source: Markup(math[source])  # noqa: S704 - set by typst from our own source
    environment.filters["noted"] = _noted
    environment.filters["slug"] = lambda text: re.sub(r"\W+", "-", text).strip("-").lower()
    return environment.get_template("page.html")


def _noted(text: str) -> Any:
    """A note with its symbols set: F_N with a lowered N."""
    from markupsafe import Markup, escape

    symbol = r"\b([A-Za-zα-ω]{1,2})_([A-Za-z]+)"
    return Markup(re.sub(symbol, r"<var>\1</var><sub>\2</sub>", str(escape(text))))  # noqa: S704 - escaped before


def _tiles(content: dict[str, Any]) -> list[dict[str, str]]:
    """What a reader wants first: tightest margin, mass, price, energy, reduction."""
    told = content["best"]
    if told is None:
        return []
    tiles = [
        ("smallest margin", told["tight"]["margin"], told["tight"]["title"]),
        ("mass of one set", told["mass"], told["mass_of"]),
        ("price of one set", told["price"], told["price_of"]),
        ("energy of a cycle", told["energy"], told["energy_of"]),
        ("whole reduction", told["total_ratio"], "motor turns per turn of the " + content["place"]),
    ]
    return [dict(zip(("name", "value", "more"), tile, strict=True)) for tile in tiles]


def _figures(result: SizingResult, validation: Validation | None, content: dict[str, Any]) -> dict[str, Plot]:
    """Every figure by its name, in the order of the report."""
    best = result.shown
    cycles = [(case.name, case.cycle) for case in result.problem.cases]
    sets = content["candidates"]["sets"]
    made: dict[str, Plot | None] = {
        "motion": motion_plot(result.spec),
        "cycle": cycle_plot(cycles),
        "sets-margin": sets_plot(sets, "percent", "smallest margin (%)"),
        "sets-price": sets_plot(sets, "price", "price (EUR)"),
        "front": front_plot(result) if result.front else None,
    }
    fields = panels(result.problem, best, result.requirements)[:MOST_PANELS] if best else []
    times = [cycle.time for _, cycle in cycles]
    for n, panel in enumerate(fields, 1):
        made[f"field-{n}"] = field_plot(panel, times) | {"title": _conditions(panel) if len(fields) > 1 else ""}
    budget = best.energy if best else None
    made |= {"consumers": consumers_plot(budget), "charge": charge_plot(budget)}
    if validation:
        made["loop"] = closed_loop_plot(validation)
        if validation.loops:
            made["bode"] = bode_plot(validation.loops)
            for n, (title, plot) in enumerate(step_plots(validation.loops).items(), 1):
                made[f"step-{n}"] = plot | {"title": title}
    return {name: plot for name, plot in made.items() if plot}


def _conditions(panel: Panel) -> str:
    lines = panel.cases[0][-1]
    given = show(lines.voltage, "V", "voltage"), show(lines.ambient, "degC", "temperature")
    return f"{given[0]} usable, ambient {given[1]}"
