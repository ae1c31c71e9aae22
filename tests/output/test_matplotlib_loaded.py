"""matplotlib as reports load it: figures are the same as after loading it whole."""

from __future__ import annotations

import subprocess
import sys

import pytest

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
