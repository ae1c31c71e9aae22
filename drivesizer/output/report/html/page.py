"""HTML: the sections of a report, of one drive or of a machine, with style, script and figures inside, in one file."""

from __future__ import annotations

import base64
import colorsys
import re
from collections.abc import Iterator, Mapping
from typing import Any

from drivesizer.output.document.axes import Reportable, document_of
from drivesizer.output.document.candidates import candidate_numbers
from drivesizer.output.document.content import Content
from drivesizer.output.document.paper import paper_data, pictures_of
from drivesizer.output.report.figures.picture import Pictured
from drivesizer.output.report.figures.style import COLOURS, Drawing
from drivesizer.output.report.html.candidate_plots import choices_plot, sets_plot, weights_section
from drivesizer.output.report.html.plots import Data, movable
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


def image(drawing: Drawing) -> str:
    """A drawing as the address of an image that follows the scheme, with fonts of the same width for its letters."""
    svg = drawing("typeset").decode().replace("'DejaVu Sans'", "'DejaVu Sans', Verdana, sans-serif")
    return f"data:image/svg+xml;base64,{base64.b64encode(both_schemes(svg).encode()).decode()}"


def both_schemes(svg: str) -> str:
    """A drawing with each colour as a variable, and their values for light and for dark."""
    styled = _GROUND.sub(r'\1style="fill: \2"', svg)
    named = _COLOUR.sub(lambda match: f"var(--{match[0][1:]})", styled)
    colours = sorted({_BLACK, *_COLOUR.findall(styled)})
    light = "".join(f"--{colour[1:]}:{colour};" for colour in colours)
    dark = "".join(f"--{colour[1:]}:{_dark(colour)};" for colour in colours)
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
    return "#" + "".join(f"{round(255 * part):02x}" for part in (red, green, blue))


# -- HTML: the sections of a report with style, script and figures inside, in one file.
#
# The file loads nothing from anywhere, and its own policy forbids it to: only the two scripts whose digests it names
# may run. Texts of a spec or a catalogue are escaped everywhere. The same input gives the same bytes.


SCRIPTS = ("tables.js", "plots.js", "weights.js", "weights_view.js", "page.js")  # one after the other, as one script


def report_html(content: Reportable, *, date: str | None = None) -> bytes:
    """The report as one HTML file."""
    return filled_page(*page_parts(content, date))


def page_parts(
    content: Reportable, date: str | None = None
) -> tuple[dict[str, Any], dict[str, Data], dict[str, Drawing]]:
    """The document of a report, its figures that can be moved, and those that cannot, by name."""
    filled, pictures = paper_data(document_of(content), date), dict(content.pictures)
    if alone := getattr(content, "alone", None):
        filled["sections"] = [*_with_weights(filled["sections"], alone)]
        pictures = pictures | _of_candidates(alone)
    printed = {
        name: picture for name in dict.fromkeys(pictures_of(filled["sections"])) if (picture := pictures.get(name))
    }
    figures = {f"{name}-{n}" if len(picture.page) > 1 else name: movable(plot)
               for name, picture in printed.items() for n, plot in enumerate(picture.page, 1)}  # fmt: skip
    return (
        filled,
        figures,
        {name: picture.paper for name, picture in printed.items() if picture.paper and not picture.page},
    )


def _of_candidates(content: Content) -> dict[str, Pictured]:
    """Figures that the page alone has."""
    drives = candidate_numbers(content)
    plots = {"sets-margin": sets_plot(drives, "percent", "smallest margin", "%"),
            "sets-price": sets_plot(drives, "price", "price", content.result.catalog.currency),
            "choices": choices_plot(content.result.choices)}  # fmt: skip
    return {name: Pictured(None, [plot]) for name, plot in plots.items() if plot}


def _with_weights(sections: list[dict[str, Any]], content: Content) -> Iterator[dict[str, Any]]:
    """The sections, with the choice by weights behind the candidates and what belongs to them."""
    weights, reached = weights_section(content), False
    for section in sections:
        if weights and reached and section["level"] == 1:
            yield weights
            weights = None
        reached = reached or section["name"] == "candidates"
        yield section
    if weights:
        yield weights


def filled_page(filled: dict[str, Any], figures: Mapping[str, Data], pictures: Mapping[str, Drawing]) -> bytes:
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
            pictures={name: image(drawing) for name, drawing in pictures.items()},
            colours=COLOURS,
            style=Markup(own_file("style.css")),  # noqa: S704 - our own file
            script=Markup(script),  # noqa: S704 - our own file
            # Packed, 2 MB in place of 4.8: a page is sent by mail, and text and tables are there before the figures.
            library=base64.b64encode(packed(library)).decode(),
            digests=[digest(script), digest(library)],
        )
    )
    return page.encode()
