"""Figures are the same whether they are laid out once for several forms or for each."""

from __future__ import annotations

import pytest

from drivesizer.output.report.figures.style import Drawing, placed

FORMS = [("typeset", "svg"), ("svg", "typeset"), ("svg", "png", "typeset"), ("svg", "svg", "svg"), ("png", "png")]


@pytest.mark.parametrize("forms", FORMS, ids=" ".join)
@pytest.mark.parametrize("fixed", [True, False], ids=["fixed places", "free places"])
def test_a_figure_that_is_laid_out_once_is_the_same_in_each_form(forms, fixed):
    calls = []

    def draw(figure):
        calls.append(1)
        axes = placed(figure, 2.0)[0][0] if fixed else figure.subplots(1, 2)[0]
        axes.plot([0.0, 1.0, 2.0], [0.0, 400.0, 100.0], label="torque")
        axes.set(xlabel="time [s]", ylabel="torque [mN·m]")
        axes.legend()

    each = [Drawing(draw)(form) for form in forms]
    calls.clear()
    several = Drawing(draw)
    assert [several(form) for form in forms] == each
    of_svg = sum(form != "png" for form in forms)
    assert len(calls) == -(-of_svg // 2) + forms.count("png")
