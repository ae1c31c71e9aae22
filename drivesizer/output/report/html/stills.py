"""Still figures of the page: drawings whose colours follow the light or dark scheme of the reader.

Each colour of a drawing becomes a variable with two values; the drawing has them itself, for as an image it sees no
style of the page.
"""

from __future__ import annotations

import base64
import colorsys
import re

from drivesizer.output.report.figures.style import COLOURS

__all__ = ["both_schemes", "image"]

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
