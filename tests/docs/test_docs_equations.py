"""Equations on their page: as at the terminal, whatever the notation."""

from __future__ import annotations

import pytest
from docs_pages import bare, signs

from drivesizer.output import derivation
from drivesizer.physics.equation import COMPANIONS, EQUATIONS
from drivesizer.platform.equations import PLATFORM
from drivesizer.platform.equations import text as form_text

mathematics = pytest.importorskip("mathematics", reason="the documentation's own packages are not installed")
latex = pytest.importorskip("latex")
EVERY = [*EQUATIONS.values(), *COMPANIONS.values()]
MATRICES = [PLATFORM[number] for number in sorted(PLATFORM)]


@pytest.mark.parametrize("declared", EVERY, ids=lambda e: e.name)
def test_an_equation_on_the_page_is_the_one_at_the_terminal(declared):
    """Another notation of the same syntax tree: what is read from left to right and from top to bottom is the same."""
    for form, paper in ((declared.computed, False), (declared.printed, True)):
        if form:
            made = mathematics.mathml(latex.expression(form, paper=paper), "block")
            assert signs(made) == signs(derivation.text(form, paper=paper))
            assert made.count("<mfrac>") >= (1 if "/" in form and "1 / 2" not in form else 0)
            assert made.count("<msqrt>") == form.count("sqrt(") + form.count("(1 / 2)")


@pytest.mark.parametrize("declared", MATRICES, ids=lambda e: str(e.number))
def test_an_equation_of_the_platform_on_the_page_is_the_one_at_the_terminal(declared):
    import matrices

    left = declared.printed_symbol or declared.symbol
    for side, form in ((left, declared.printed), (declared.symbol, declared.computed)):
        made = mathematics.mathml(matrices.equation(side, form), "block")
        side, _, vector = side.partition("] / ")  # what stands on the left as divided by a vector is multiplied by it
        right = form_text(form)
        if form.startswith("array") and " / " in form.rsplit(")", 1)[-1]:  # and a matrix by one over what divides it
            whole, _, below = right.rpartition(" / ")
            right = f"1 / {below} {whole}"
        assert bare(made) == bare(f"{side} = {right} {vector}")
        rows = 1 + right.count("; ") if "[" in right.replace("[T]", "") else 0
        assert made.count("<mtr>") >= rows and "merror" not in made


def test_a_vector_is_a_column_and_what_a_vector_is_multiplied_with_a_row():
    import matrices

    column, row = (mathematics.mathml(matrices.expression(form)) for form in ("array([a, b])", "array([a, b]) @ c"))
    assert (column.count("<mtr>"), row.count("<mtr>"), row.count("<mtd>")) == (2, 1, 2)
    assert mathematics.mathml(matrices.expression("array([[a, b, c], [a, b, c]])")).count("<mtr>") == 2
