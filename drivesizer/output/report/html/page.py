"""HTML: the sections of a report with style, script and figures inside, in one file.

The file loads nothing from anywhere, and its own policy forbids it to: only the two scripts whose digests it names
may run. Texts of a spec or a catalogue are escaped everywhere. The same input gives the same bytes.
"""

from __future__ import annotations

import base64
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from drivesizer.output.report.figures.all_figures import STILL, Drawing
from drivesizer.output.report.figures.field import conditions
from drivesizer.output.report.figures.field_panels import panels
from drivesizer.output.report.figures.style import COLOURS
from drivesizer.output.report.html.battery_plots import charge_plot, consumers_plot
from drivesizer.output.report.html.candidate_plots import front_plot, sets_plot
from drivesizer.output.report.html.choices_plot import choices_plot
from drivesizer.output.report.html.curves import Plot
from drivesizer.output.report.html.field_plot import field_plot
from drivesizer.output.report.html.load_plots import cycle_plot, motion_plot
from drivesizer.output.report.html.loop_plots import bode_plot, closed_loop_plot, step_plots
from drivesizer.output.report.html.mathematics import mathml
from drivesizer.output.report.html.stills import image
from drivesizer.output.report.html.templates import digest, environment, mathematics, own_file, unbroken
from drivesizer.output.report.html.weights import weights_section
from drivesizer.output.report.sections.candidates import candidate_numbers
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.document import document

__all__ = ["SCRIPTS", "filled_page", "movable", "page_parts", "render", "report_html"]

SCRIPTS = ("tables.js", "plots.js", "weights.js", "weights_view.js", "page.js")  # one after the other, as one script
_MOST_PANELS = 6  # of the motor's field that can be moved


def render(content: Content, path: Path, *, date: str | None = None) -> dict[Path, bytes]:
    """The file of an HTML report; see :func:`report_html`."""
    return {path: report_html(content, date=date)}


def report_html(content: Content, *, date: str | None = None) -> bytes:
    """The report as one HTML file."""
    return filled_page(*page_parts(content, date))


def page_parts(content: Content, date: str | None = None) -> tuple[dict[str, Any], dict[str, Plot], dict[str, Drawing]]:
    """The document of a report, its figures that can be moved, and those that cannot, by name."""
    still = {name: content.drawings[name] for name in STILL if name in content.drawings}
    filled = document(content, date)
    return filled | {"sections": [*_with_weights(filled, content)]}, movable(content), still


def _with_weights(filled: dict[str, Any], content: Content) -> Iterator[dict[str, Any]]:
    """The sections, with the choice by weights behind the candidates and what belongs to them."""
    chosen, reached = weights_section(content), False
    for section in filled["sections"]:
        if chosen and reached and section["level"] == 1:
            yield chosen
            chosen = None
        reached = reached or section["name"] == "candidates"
        yield section
    if chosen:
        yield chosen


def filled_page(filled: dict[str, Any], figures: Mapping[str, Plot], pictures: Mapping[str, Drawing]) -> bytes:
    """A document with its figures as an HTML file."""
    from markupsafe import Markup
    from plotly.offline import get_plotlyjs

    from drivesizer.output.report.html.kept import packed

    doc = unbroken(filled)
    library, script = get_plotlyjs(), "".join(own_file(name) for name in SCRIPTS)
    page: str = (
        environment(mathml(mathematics(doc["sections"])))
        .get_template("page.html")
        .render(
            doc=doc,
            figures=figures,
            pictures={name: image(draw("svg")) for name, draw in pictures.items()},
            colours=COLOURS,
            style=Markup(own_file("style.css")),  # noqa: S704 - our own file
            script=Markup(script),  # noqa: S704 - our own file
            # Packed, 2 MB in place of 4.8: a page is sent by mail, and text and tables are there before the figures.
            library=base64.b64encode(packed(library)).decode(),
            digests=[digest(script), digest(library)],
        )
    )
    return page.encode()


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
    made["choices"] = choices_plot(result.choices)
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
