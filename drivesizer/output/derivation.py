"""Requirements as mathematics: printed form, computed form, with numbers, result.

The mathematics is typst source made of our own declarations and of numbers; no text of a spec or a catalogue
enters it. ``python -m drivesizer.output.derivation > printed_failures.json`` renews the list of printed
forms that fail the unit check.
"""

from __future__ import annotations

import ast
import inspect
import json
import math
from collections.abc import Callable
from functools import cache
from importlib import resources
from typing import Any

from drivesizer.output.formula import computed, printed_failure, symbol_typst, text, typst
from drivesizer.physics.equation import COMPANIONS, EQUATIONS, Equation
from drivesizer.results.requirement import Requirement
from drivesizer.units import KINDS, from_si, label

__all__ = ["MATHEMATICS", "evaluated_failures", "numbers_in", "quantity", "step", "symbol"]

MATHEMATICS = ("symbol", "symbol_value", "printed", "used", "numbers", "result")  # of a step: typst source


def step(r: Requirement) -> dict[str, Any]:
    """A requirement as the report prints it: texts, and typst mathematics under the names in ``MATHEMATICS``."""
    left = symbol(r.symbol)
    made = {
        "number": str(r.equation or ""),
        "title": r.title,
        "symbol": left,
        "symbol_value": f"{left} = {quantity(float(r.value), r.unit, r.kind)}",
        "note": r.note,
        "printed": "",
        "used": "",
        "numbers": "",
        "result": "",
        "failure": "",
    }
    if r.declared is None:
        return made
    expression = _expression(r)
    printed, used = _forms(r.declared, expression)
    made["printed"] = f"{left} = {printed}" if printed else ""
    made["used"] = f"{left} = {used}" if used.replace("^(2)", "^2") not in ("", left) else ""
    made["numbers"] = f"{left} = {_put_in(r, expression)}"
    made["result"] = _result(r)
    made["failure"] = _failures().get(r.declared.name, "")
    return made


def symbol(text: str) -> str:
    """A requirement's symbol in typst mathematics.

    >>> symbol("J_m K²")
    'J_"m" K^2'
    """
    return " ".join(
        f"{symbol_typst(part[:-1])}^2" if part.endswith("²") else symbol_typst(part) for part in text.split()
    )


def quantity(value: float, unit: str, kind: str) -> str:
    """An SI value in a unit of its kind, as typst mathematics.

    Examples
    --------
    >>> quantity(1.08e-6, "kg*m^2", "inertia")
    '1.08 dot 10^(-6) thin "kg·m²"'
    """
    return _with_unit(float(from_si(value, unit, kind)), unit)


def _with_unit(value: float, unit: str) -> str:
    return _number(value) if unit == "1" or math.isnan(value) else f'{_number(value)} thin "{_unit(unit)}"'


def _number(value: float) -> str:
    """Four digits; powers of ten for what is very large or very small."""
    if not math.isfinite(value):
        return '"unknown"' if math.isnan(value) else "infinity"
    if value == 0.0 or 1e-3 <= abs(value) < 1e6:
        return f"{value:.0f}" if abs(value) >= 1e4 else f"{value:.4g}"
    mantissa, _, exponent = f"{value:.3e}".partition("e")
    return f"{float(mantissa):g} dot 10^({int(exponent)})"


def _unit(unit: str) -> str:
    """A unit inside a formula; unlike a label it keeps the brackets of a quotient."""
    return unit.replace("*", "·").replace("^2", "²").replace("^3", "³").replace("ohm", "Ω").replace("deg", "°")


@cache
def _failures() -> dict[str, str]:
    """Printed forms that fail the unit check, by name: found once and kept, so that no report needs pint."""
    kept: dict[str, str] = json.loads(resources.files(__package__).joinpath("printed_failures.json").read_bytes())
    return kept


def evaluated_failures() -> dict[str, str]:
    """The same, found anew: every declared equation's printed form evaluated with units."""
    every = [*EQUATIONS.values(), *COMPANIONS.values()]
    found = {declared.name: printed_failure(declared) for declared in every}
    return {name: failure for name, failure in found.items() if failure}


def _expression(r: Requirement) -> str:
    """Expression that was computed; the printed form where only its quantities were put in (one shown beside ours)."""
    assert r.declared is not None
    used = computed(r.declared)
    return r.declared.printed if r.name.endswith("_as_printed") else used


def _forms(declared: Equation, expression: str) -> tuple[str, str]:
    """Printed and computed form; no computed form where it only repeats the printed one."""
    printed = typst(declared.printed, paper=True) if declared.printed else ""
    same = declared.printed and typst(declared.printed) == typst(expression)
    return printed, "" if same else typst(expression)


def _put_in(r: Requirement, expression: str) -> str:
    return typst(expression, values=_values(r, expression, _with_unit))


def numbers_in(r: Requirement) -> str:
    """A requirement's equation with its numbers put in, as a line of text without the left side."""
    expression = _expression(r)
    return text(expression, values=_values(r, expression, _plain))


def _plain(value: float, unit: str) -> str:
    return "unknown" if math.isnan(value) else f"{value:.4g} {label(unit)}".rstrip()


def _values(r: Requirement, expression: str, with_unit: Callable[[float, str], str]) -> dict[str, str]:
    """Values of an equation's terms as they are put in, in brackets where a sign or an exponent needs them."""
    assert r.declared is not None
    defaults = inspect.signature(r.declared.formula).parameters
    raised, values = _raised(expression), {}
    for name, unit in ((term.name, term.unit) for term in r.declared.terms):
        value = float(r.inputs.get(name, defaults[name].default))
        if unit == "rad":
            value, unit = math.degrees(value), "deg"
        written = with_unit(value, unit)
        values[name] = f"({written})" if value < 0 or (name in raised and written != with_unit(value, "1")) else written
    return values


def _raised(expression: str) -> set[str]:
    """Names with an exponent: with its unit, such a figure needs brackets."""
    powers = (
        node.left
        for node in ast.walk(ast.parse(expression))
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow)
    )
    return {base.id for base in powers if isinstance(base, ast.Name)}


def _result(r: Requirement) -> str:
    """The result in SI, and in the unit of the trade where that is another."""
    value, si = float(r.value), KINDS[r.kind].si
    trade = quantity(value, r.unit, r.kind)
    return trade if si == r.unit else f"{quantity(value, si, r.kind)} = {trade}"


if __name__ == "__main__":
    import drivesizer.equations  # noqa: F401 - declares them

    print(json.dumps(evaluated_failures(), ensure_ascii=False, indent=1))
