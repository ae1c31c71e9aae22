"""HTML: the sections of a report, of one drive or of a machine, with style, script and figures inside, in one file."""

from __future__ import annotations

import base64
import colorsys
import re
from collections.abc import Iterator, Mapping
from typing import Any

from drivesizer.output.document.axes import MachineContent, document_of, drawings_of
from drivesizer.output.document.candidates import candidate_numbers
from drivesizer.output.document.content import Content
from drivesizer.output.document.paper import paper_data, pictures_of
from drivesizer.output.report.figures.all_figures import STILL
from drivesizer.output.report.figures.field import conditions, panels
from drivesizer.output.report.figures.style import COLOURS, Drawing
from drivesizer.output.report.html.candidate_plots import choices_plot, front_plot, sets_plot, weights_section
from drivesizer.output.report.html.curves import Plot
from drivesizer.output.report.html.plots import (
    bode_plot,
    charge_plot,
    closed_loop_plot,
    consumers_plot,
    cycle_plot,
    field_plot,
    motion_plot,
    power_plot,
    step_plots,
)
from drivesizer.output.report.html.templates import digest, environment, mathematics, mathml, own_file, unbroken

# -- Still figures of the page: drawings whose colours follow the light or dark scheme of the reader.
#
# Each colour of a drawing becomes a variable with two values; the drawing has them itself, for as an image it sees
# no style of the page.


_DARK = {  # of colours that have a meaning: those of style.css
    "#ffffff": "#14171a", "#000000": "#e8eaed", "#dddddd": "#343a41", COLOURS["blue"].lower(): "#56b4e9",
    COLOURS["vermillion"].lower(): "#f08040", COLOURS["green"].lower(): "#2fc495", COLOURS["grey"].lower(): "#a3abb5",
    COLOURS["purple"].lower(): "#cc79a7", COLOURS["orange"].lower(): "#e69f00", COLOURS["sky"].lower(): "#4b86a8",
}  # fmt: skip
_BLACK = "#000000"  # of letters and lines that name no colour
_GROUND = re.compile(r'(<rect [^>]*)fill="(#[0-9a-f]{6})"(?=/>)')  # below a hatch: a colour that is no style
_COLOUR = re.compile(r"(?<=: )#[0-9a-f]{6}\b")


def image(svg: bytes) -> str:
    """A drawing as the address of an image that follows the scheme."""
    return f"data:image/svg+xml;base64,{base64.b64encode(both_schemes(svg.decode()).encode()).decode()}"


def both_schemes(svg: str) -> str:
    """A drawing with each colour as a variable, and their values for light and for dark."""
    styled = _GROUND.sub(r'\1style="fill: \2"', svg)
    named = _COLOUR.sub(lambda found: f"var(--{found[0][1:]})", styled)
    used = sorted({_BLACK, *_COLOUR.findall(styled)})
    light = "".join(f"--{colour[1:]}:{colour};" for colour in used)
    dark = "".join(f"--{colour[1:]}:{_dark(colour)};" for colour in used)
    style = (f"<style>:root{{{light}fill:var(--{_BLACK[1:]})}}"
             f"@media screen and (prefers-color-scheme:dark){{:root{{{dark}}}}}</style>")  # fmt: skip
    opening = re.search(r"<svg\b[^>]*>", named)
    assert opening is not None
    return named[: opening.end()] + style + named[opening.end() :]


def _dark(colour: str) -> str:
    """A colour on a dark page: as given, else of the opposite lightness.

    >>> _dark("#ffffff"), _dark("#cfe3f1")
    ('#14171a', '#153449')
    """
    if colour in _DARK:
        return _DARK[colour]
    hue, light, full = colorsys.rgb_to_hls(*(int(colour[n : n + 2], 16) / 255.0 for n in (1, 3, 5)))
    red, green, blue = colorsys.hls_to_rgb(hue, 0.08 + 0.86 * (1.0 - light), full)
    return "#" + "".join(f"{round(255 * one):02x}" for one in (red, green, blue))


# -- HTML: the sections of a report with style, script and figures inside, in one file.
#
# The file loads nothing from anywhere, and its own policy forbids it to: only the two scripts whose digests it names
# may run. Texts of a spec or a catalogue are escaped everywhere. The same input gives the same bytes.


SCRIPTS = ("tables.js", "plots.js", "weights.js", "weights_view.js", "page.js")  # one after the other, as one script
_MOST_PANELS = 6  # of the motor's field that can be moved


def report_html(content: Content | MachineContent, *, date: str | None = None) -> bytes:
    """The report as one HTML file."""
    return filled_page(*page_parts(content, date))


def page_parts(
    content: Content | MachineContent, date: str | None = None
) -> tuple[dict[str, Any], dict[str, Plot], dict[str, Drawing]]:
    """The document of a report, its figures that can be moved, and those that cannot, by name."""
    filled, drawings = paper_data(document_of(content), date), drawings_of(content)
    wanted, figures = {*pictures_of(filled["sections"])}, dict[str, Plot]()
    if isinstance(content, MachineContent) and len(content.axes) > 1:
        stacked = power_plot(content.sizing.power) if content.sizing.power else None
        figures |= {"power": stacked} if stacked else {}
        figures |= {f"{one.key}{name}": plot for one in content.axes for name, plot in movable(one.content).items()}
        still = [*content.loads, *(f"{one.key}{name}" for one in content.axes for name in STILL)]
    else:
        alone = content.axes[0].content if isinstance(content, MachineContent) else content
        figures, still = movable(alone), [*STILL]
        filled["sections"] = [*_with_weights(filled["sections"], alone)]
        wanted |= {"choices"}
    kinds = {name: re.sub(r"-\d+$", "", name) for name in figures}  # those of one kind are numbered
    pictures = {name: drawings[name] for name in still if name in wanted and name in drawings}
    return filled, {name: figures[name] for name in figures if kinds[name] in wanted}, pictures


def _with_weights(sections: list[dict[str, Any]], content: Content) -> Iterator[dict[str, Any]]:
    """The sections, with the choice by weights behind the candidates and what belongs to them."""
    chosen, reached = weights_section(content), False
    for section in sections:
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

    from drivesizer.output.report.html.templates import packed

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
