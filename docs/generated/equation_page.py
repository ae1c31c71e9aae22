"""The equations as a page, out of their declarations."""

from __future__ import annotations

from latex import displayed, expression, inline, symbol

import drivesizer.equations  # noqa: F401 - declares them
from drivesizer.output import derivation
from drivesizer.physics.equation import COMPANIONS, EQUATIONS, Equation
from drivesizer.units import label

__all__ = ["equations", "escaped"]


def equations() -> str:
    """All equations in the order of the paper, those without a number where the paper uses them."""
    return "\n\n".join(_equation(declared) for declared in _in_order())


def _in_order() -> list[Equation]:
    """In the order of the source: a companion follows its equation."""
    everything = [*EQUATIONS.values(), *COMPANIONS.values()]
    return sorted(everything, key=lambda e: e.formula.__code__.co_firstlineno)


def _equation(e: Equation) -> str:
    number = f"({e.number})" if e.number else "–"
    anchor = f"eq-{e.number}" if e.number else e.name.replace("_", "-")
    parts = [f'### <a id="{anchor}"></a>{number} {e.title}', *_forms(e)]
    if e.note:
        parts.append(f"> {escaped(e.note)}")
    parts.append(_terms(e))
    return "\n\n".join(parts)


def _forms(e: Equation) -> list[str]:
    """The printed form, the result of the unit check, and the computed form."""
    left, computed = symbol(e.symbol), e.computed
    used = f"{left} = {expression(computed)}" if expression(computed) != left else left
    if not e.printed:
        return ["Not in the paper; as computed:", displayed(used)]
    failure = derivation.printed_failure(e)
    finding = f'<span class="fails">Fails the unit check:</span> {escaped(failure)}.' if failure else "Units agree."
    printed = displayed(f"{left} = {expression(e.printed, paper=True)}")
    if expression(e.printed) == expression(computed):
        return [f"As printed and as computed. {finding}", printed]
    return [f"As printed. {finding}", printed, "As computed:", displayed(used)]


def _terms(e: Equation) -> str:
    """Result and terms; the unit is the one that the program uses."""
    shown = label(e.display_unit)
    si = label(e.result.unit)
    unit = f"{si}, shown in {shown}" if shown and shown != si else si
    rows = [(inline(symbol(e.symbol)), e.result.meaning, unit)]
    rows += [(inline(symbol(derivation.symbol_text(t.name))), t.meaning, label(t.unit)) for t in e.terms]
    return where(rows)


def where(rows: list[tuple[str, str, str]]) -> str:
    """Symbols of an equation with their meaning and unit, in a sentence."""
    return "With " + "; ".join(f"{symbol} {escaped(meaning)} [{unit or '1'}]" for symbol, meaning, unit in rows) + "."


def escaped(text: str) -> str:
    """A text of a declaration as Markdown that shows it as it is."""
    for sign in ("\\", "|", "*", "_", "$", "<"):
        text = text.replace(sign, f"\\{sign}" if sign != "<" else "&lt;")
    return text
