"""The platform's equations as a page, from their declarations; findings on printed forms are computed."""

from __future__ import annotations

import matrices
from equation_page import escaped, where
from latex import displayed, inline

from drivesizer.physics.equation import Term
from drivesizer.platform import robot_figures
from drivesizer.platform.equations import PLATFORM, MatrixEquation

__all__ = ["platform_equations"]


def platform_equations() -> str:
    """All equations of the platform by their number."""
    return "\n\n".join(_equation(PLATFORM[number]) for number in sorted(PLATFORM))


def _equation(e: MatrixEquation) -> str:
    heading = f'### <a id="eq-{e.number}"></a>({e.number}) {e.title}'
    note = [f"> {escaped(e.note)}"] if e.note else []
    return "\n\n".join([heading, *_forms(e), *note, _terms(e)])


def _forms(e: MatrixEquation) -> list[str]:
    """The printed form with its findings, and the computed form where it differs."""
    found, computed = robot_figures.finding(e), e.computed
    units = (
        f'<span class="fails">Fails the unit check:</span> {escaped(found.units)}.' if found.units else "Units agree"
    )
    values = f'<span class="fails">Fails the value check:</span> {escaped(found.values)}.' if found.values else ""
    left = e.printed_symbol or e.symbol
    as_printed = displayed(matrices.equation(left, e.printed))
    if (left, e.printed) == (e.symbol, computed):
        return [f"As printed and as computed. {units}.", as_printed]
    checked = f"{units}. {values}" if values else f"{units}, and so do the values of a sample robot."
    return [f"As printed. {checked}", as_printed, "As computed:", displayed(matrices.equation(e.symbol, computed))]


def _terms(e: MatrixEquation) -> str:
    rows = [(_given(e), e.result.meaning, unit(e.result))]
    rows += [(inline(matrices.term(t.name)), t.meaning, unit(t)) for t in e.terms]
    return where(rows)


def _given(e: MatrixEquation) -> str:
    """The result's symbol; where the left side is a 0 or has several, it needs none."""
    plain = "[" not in e.symbol or e.symbol.startswith("[T]")
    return inline(matrices.text(e.symbol)) if plain and e.symbol != "0" else "–"


def unit(term: Term) -> str:
    """The unit of a number, of each entry of a vector, or of a matrix (output per input)."""
    return term.unit.replace("*", "·").replace("^2", "²")
