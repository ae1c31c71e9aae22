"""Figures are the same whether they are laid out once for several forms or for each."""

from __future__ import annotations

import pytest

from drivesizer.output.report.figures.style import drawn, once, placed

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
