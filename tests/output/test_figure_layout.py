"""Figures are the same whether matplotlib is loaded whole or not, and laid out once for several forms or for each."""

from __future__ import annotations

import subprocess
import sys

import pytest

from drivesizer.output.report.figures.layout import once
from drivesizer.output.report.figures.style import drawn, placed

DRAWN = """
import sys
if "whole" in sys.argv:
    import matplotlib.figure
from drivesizer.output.report.figures.style import drawn, heading, limit, placed


def draw(figure):
    (left, right), _ = placed(figure, 2, 2, shared=False)
    line, = left.plot([0.0, 1.0, 2.0], [0.0, 0.4, 0.1], label="$speed$")
    left.set(xlabel="time [s]", ylabel="speed [m/s]")
    limit(left, 0.3, "limit")
    right.bar([1, 2], [3.0, 4.0], hatch="//")
    heading(figure, [line], ["speed"], 1)


for form in ("svg", "typeset", "png"):
    sys.stdout.buffer.write(drawn(draw, 3.0, form))
from matplotlib import artist
from matplotlib.lines import Line2D

assert "linewidth" in artist.kwdoc(Line2D) and artist.ArtistInspector(Line2D).get_setters()
assert ("linewidth" in (Line2D.set.__doc__ or "")) is ("whole" in sys.argv)
"""


@pytest.mark.parametrize("further", [(), ("whole",)], ids=["as reports load it", "loaded before"])
def test_a_figure_is_the_same_without_help_on_properties(further):
    figures = [
        subprocess.run([sys.executable, "-c", DRAWN, *words], capture_output=True, check=True).stdout
        for words in (further, ("whole",))
    ]
    assert figures[0] == figures[1] and len(figures[0]) > 10_000


FORMS = [("typeset", "svg"), ("svg", "typeset"), ("svg", "png", "typeset"), ("svg", "svg", "svg"), ("png", "png")]


@pytest.mark.parametrize("forms", FORMS, ids=" ".join)
def test_a_figure_that_is_laid_out_once_is_the_same_in_each_form(forms):
    calls = []

    def draw(figure):
        calls.append(1)
        (axes,) = placed(figure)[0]
        axes.plot([0.0, 1.0, 2.0], [0.0, 400.0, 100.0], label="torque")
        axes.set(xlabel="time [s]", ylabel="torque [mN·m]")
        axes.legend()

    each = [drawn(draw, 2.0, form) for form in forms]
    calls.clear()
    several = once(lambda form: drawn(draw, 2.0, form))
    assert [several(form) for form in forms] == each
    of_svg = sum(form != "png" for form in forms)
    assert len(calls) == -(-of_svg // 2) + forms.count("png")


def test_a_figure_without_fixed_places_too():
    def draw(figure):
        left, right = figure.subplots(1, 2)
        left.plot([0.0, 1.0], [0.0, 1e6])
        right.barh(["motor", "gearhead"], [1.0, 2.0])

    several = once(lambda form: drawn(draw, 2.0, form))
    assert [several("typeset"), several("svg")] == [drawn(draw, 2.0, "typeset"), drawn(draw, 2.0, "svg")]
