"""HTML: the sections of a report with style, script and figures inside, in one file.

The file loads nothing from anywhere, and its own policy forbids it to: only the two scripts whose digests it names
may run. Texts of a spec or a catalogue are escaped everywhere. The same input gives the same bytes.
"""

from __future__ import annotations

import base64
import hashlib
import re
from collections.abc import Iterator, Mapping
from importlib import resources
from pathlib import Path
from typing import Any

from drivesizer.control.validation import Validation
from drivesizer.output.report.figures.all_figures import Drawing
from drivesizer.output.report.figures.field import conditions
from drivesizer.output.report.figures.field_panels import panels
from drivesizer.output.report.figures.style import COLOURS
from drivesizer.output.report.html.battery_plots import charge_plot, consumers_plot
from drivesizer.output.report.html.candidate_plots import front_plot, sets_plot
from drivesizer.output.report.html.curves import Plot
from drivesizer.output.report.html.field_plot import field_plot
from drivesizer.output.report.html.load_plots import cycle_plot, motion_plot
from drivesizer.output.report.html.loop_plots import bode_plot, closed_loop_plot, step_plots
from drivesizer.output.report.html.mathematics import mathml
from drivesizer.output.report.html.stills import image
from drivesizer.output.report.sections.candidates import candidate_numbers
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.document import document
from drivesizer.results.sizing import SizingResult

__all__ = ["STILL", "filled_page", "movable", "render", "report_html"]

_FILES = resources.files("drivesizer.output.report.html")
STILL = (
    "way",
    "tornado",
    "fields",
    "efficiency",
    "demand",
    "heat",
    "energy",
)  # figures that the page shows as the PDF does
_MOST_PANELS = 6  # of the motor's field that can be moved
_BREAK = "\u200b"  # where a PDF may end a line; a browser finds such places itself


def render(
    result: SizingResult, validation: Validation | None, path: Path, *, date: str | None = None
) -> dict[Path, bytes]:
    """The file of an HTML report; see :func:`report_html`.

    Parameters
    ----------
    result, validation, date
        As there.
    path
        Where to.

    Returns
    -------
    dict[Path, bytes]
    """
    return {path: report_html(result, validation, date=date)}


def report_html(result: SizingResult, validation: Validation | None, *, date: str | None = None) -> bytes:
    """The report as one HTML file.

    Parameters
    ----------
    result
        The sizing; without a drive that passes, the closest rejected ones are reported.
    validation
        The closed loop, where it was simulated.
    date
        Printed as it is given; without it there is none.

    Returns
    -------
    bytes
        The file in that form.
    """
    content = Content(result, validation)
    pictures = {name: content.drawings[name] for name in STILL if name in content.drawings}
    return filled_page(document(content, date), movable(content), pictures)


def filled_page(filled: dict[str, Any], figures: Mapping[str, Plot], pictures: Mapping[str, Drawing]) -> bytes:
    """A document with its figures as an HTML file.

    Parameters
    ----------
    filled
        Of :func:`drivesizer.output.report.sections.document.document`.
    figures
        Those that can be moved, by name.
    pictures
        Those that cannot.

    Returns
    -------
    bytes
        The file in that form.
    """
    from markupsafe import Markup
    from plotly.offline import get_plotlyjs

    from drivesizer.output.report.html.kept import packed

    doc = _unbroken(filled)
    library, script = get_plotlyjs(), _text("page.js")
    page: str = _template(mathml(_mathematics(doc["sections"]))).render(
        doc=doc,
        figures=figures,
        pictures={name: image(draw("svg")) for name, draw in pictures.items()},
        colours=COLOURS,
        style=Markup(_text("style.css")),  # noqa: S704 - our own file
        script=Markup(script),  # noqa: S704 - our own file
        # Packed, 2 MB in place of 4.8: a page is sent by mail, and text and tables are there before the figures.
        library=base64.b64encode(packed(library)).decode(),
        digests=[_digest(script), _digest(library)],
    )
    return page.encode()


def _text(name: str) -> str:
    return _FILES.joinpath(name).read_text(encoding="utf-8")


def _digest(script: str) -> str:
    """Digest by which a content security policy names a script."""
    return "sha256-" + base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()


def _unbroken(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _unbroken(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_unbroken(entry) for entry in value]
    return value.replace(_BREAK, "") if isinstance(value, str) else value


def _mathematics(value: Any) -> Iterator[str]:
    """Mathematics anywhere in the sections: marks in a text, and steps of the derivation."""
    if isinstance(value, list):
        for entry in value:
            yield from _mathematics(entry)
    elif isinstance(value, dict) and value.get("kind") == "equation":
        step = value["step"]
        yield from (step[name] for name in ("symbol_value", "printed", "used"))
        yield f"{step['numbers']} = {step['result']}" if step["numbers"] else ""
    elif isinstance(value, dict) and value.get("kind") == "math":
        yield value["symbol"]
    elif isinstance(value, dict):
        yield from _mathematics([*value.values()])


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
    return environment.get_template("page.html")


def _noted(text: str) -> Any:
    """A note with its symbols set: F_N with a lowered N."""
    from markupsafe import Markup, escape

    symbol = r"\b([A-Za-zα-ω]{1,2})_([A-Za-z]+)"
    return Markup(re.sub(symbol, r"<var>\1</var><sub>\2</sub>", str(escape(text))))  # noqa: S704 - escaped before


def movable(content: Content) -> dict[str, Plot]:
    """The figures that can be moved by name, in the order of the report; those of one kind are numbered."""
    result, validation, best = content.result, content.validation, content.drive
    drives = candidate_numbers(content)
    made: dict[str, Plot | None] = {
        "profile": motion_plot(result.spec),
        "cycle": cycle_plot(content.cycles),
        "sets-margin": sets_plot(drives, "percent", "smallest margin (%)"),
        "sets-price": sets_plot(drives, "price", "price (EUR)"),
        "front": front_plot(result) if result.front else None,
    }
    fields = panels(result.problem, best, result.requirements) if best else []
    times = [cycle.time for _, cycle in content.cycles]
    for n, panel in enumerate(fields[:_MOST_PANELS]):  # the first is in the summary
        made[f"fields-{n}" if n else "field"] = field_plot(panel, times) | {"title": conditions(panel) if n else ""}
    budget = best.energy if best else None
    made |= {"consumers": consumers_plot(budget), "charge": charge_plot(budget)}
    if validation:
        made["loop"] = closed_loop_plot(validation)
        if validation.loops:
            made["bode"] = bode_plot(validation.loops)
            for n, (title, plot) in enumerate(step_plots(validation.loops).items(), 1):
                made[f"step-{n}"] = plot | {"title": title}
    return {name: plot for name, plot in made.items() if plot}
