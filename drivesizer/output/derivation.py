"""Declared equations and the derivation of requirements: printed, computed, with numbers, as text that can be set."""

from __future__ import annotations

import ast
import inspect
import json
import math
import re
from collections.abc import Callable, Mapping
from functools import cache
from importlib import resources
from typing import Any

import numpy as np

from drivesizer import equations  # noqa: F401 - declares them
from drivesizer.files.arithmetic import code, own_value
from drivesizer.physics.equation import COMPANIONS, EQUATIONS, Equation, Notation
from drivesizer.results.drive_set import Requirement
from drivesizer.units import KINDS, from_si, label, registry

# -- A declared equation as text for the terminal and typst mathematics for the report.
#
# The computed form is read from the function's own return expression, so that what is shown is what runs; the
# printed form is an expression in the declaration. Both are small Python expressions, and ``physics.notation``
# walks their syntax tree for either notation. ``printed_failure`` evaluates a printed form with units and says
# what is wrong with it.


_GREEK = {
    "eta": "η", "delta": "δ", "theta": "θ", "kappa": "κ", "rho": "ρ", "tau": "τ", "pi": "π", "alpha": "α", "omega": "ω",
    "beta": "β", "mu": "μ", "phi": "φ", "epsilon": "ε",
}  # fmt: skip
_NAMES = {"eta_speed": "eta_v", "eta_robot": "eta_R", "eta_gear": "eta_g", "eta_b": "eta_b", "J_mK2": "J_m K²"}
_PAPER = {"eta_speed": "eta", "eta_robot": "eta", "eta_gear": "eta", "U": "upsilon"}


def find(key: str) -> Equation | None:
    """The equation with a paper's number (as text) or a function name, or None."""
    bare = key.strip().strip("()")
    if bare.isascii() and bare.isdigit():
        return EQUATIONS.get(int(bare))
    everything = {e.name: e for e in EQUATIONS.values()} | COMPANIONS
    return everything.get(bare)


def symbol_text(name: str, *, paper: bool = False) -> str:
    """A symbol for the terminal."""
    name = (_PAPER if paper else {}).get(name) or _NAMES.get(name, name)
    head, _, tail = name.partition("_")
    tail = re.sub(r"_(m0?)$", r"/\1", tail)
    head = "υ" if head == "upsilon" else _GREEK.get(head, head)
    return f"{head}_{tail}" if tail else head


def symbol_typst(name: str, *, paper: bool = False) -> str:
    """A symbol in typst mathematics."""
    head, _, tail = symbol_text(name, paper=paper).partition("_")
    head = {"υ": "upsilon", **{v: k for k, v in _GREEK.items()}}.get(head, f'"{head}"' if len(head) > 1 else head)
    return f'{head}_"{tail}"' if tail else head


def text(expression: str, *, paper: bool = False, values: dict[str, str] | None = None) -> str:
    """An expression on one line of text.

    Examples
    --------
    >>> text("60 * V_nom / (pi * d * eta_speed)", paper=True)
    '60 V_nom / (π d η)'
    """
    known = values or {}
    return Notation(lambda n: known.get(n) or symbol_text(n, paper=paper), " · " if values else " ").of(expression)


def typst(expression: str, *, paper: bool = False, values: dict[str, str] | None = None) -> str:
    """An expression in typst mathematics.

    Examples
    --------
    >>> typst("V_nom / t_acc")
    '(V_"nom") / (t_"acc")'
    """
    known = values or {}
    return _Typst(lambda n: known.get(n) or symbol_typst(n, paper=paper), " dot " if values else " ").of(expression)


class _Typst(Notation):
    """The same with signs of typst, which draws fractions and roots."""

    minus = "-"

    def root(self, node: ast.expr) -> str:
        return f"sqrt({self.visit(node)})"

    def power(self, base: str, exponent: str) -> str:
        return f"{base}^({exponent})"

    def quotient(self, node: ast.BinOp) -> str:
        return f"({self.visit(node.left)}) / ({self.visit(node.right)})"

    def product(self, node: ast.BinOp) -> str:
        return f"{self.inside(node.left, 2)}{self.times}{self.inside(node.right, 2)}"


def printed_failure(declared: Equation) -> str | None:
    """Failure of the printed form in the unit check, or None when it passes (or there is none).

    The printed expression is evaluated with pint quantities in the declared units.
    """
    from pint import DimensionalityError

    if not declared.printed:
        return None
    declarations = [*EQUATIONS.values(), *COMPANIONS.values()]
    unit = {term.name: term.unit for equation in declarations for term in (*equation.terms, equation.result)}
    unit |= {term.name: term.unit for term in (*declared.terms, declared.result)} | declared.printed_units
    ureg = registry()

    def quantity(name: str) -> Any:
        return ureg.Quantity(1.5, unit[name] if unit[name] != "1" else "")

    functions = {"sqrt": np.sqrt, "sin": np.sin, "cos": np.cos, "pi": np.pi}
    space = {n: functions[n] if n in functions else quantity(n) for n in code(declared.printed).co_names}
    try:
        value = own_value(declared.printed, space)
    except DimensionalityError as error:
        first, second = (label(f"{ureg.Unit(str(unit)):~C}") for unit in (error.units1, error.units2))
        return f"{first} cannot be added to {second}"
    expected = ureg.Quantity(1.0, declared.result.unit if declared.result.unit != "1" else "")
    if value.dimensionality != expected.dimensionality:
        excess, si = (value / expected).to_base_units().units, label(declared.result.unit)
        return f"its unit is {si} times {label(f'{excess:~C}')}, not {si}"
    return None


# -- Requirements as mathematics: printed form, computed form, with numbers, result.
#
# The mathematics is typst source made of our own declarations and of numbers; no text of a spec or a catalogue
# enters it. ``python -m drivesizer.output.derivation > printed_failures.json`` renews the list of printed
# forms that fail the unit check.


MATHEMATICS = ("symbol", "symbol_value", "printed", "used", "numbers", "result")  # of a step: typst source


def step(r: Requirement) -> dict[str, Any]:
    """A requirement as the report prints it: texts, and typst mathematics under the names in ``MATHEMATICS``."""
    left, trade = symbol(r.symbol), quantity(float(r.value), r.unit, r.kind)
    texts: dict[str, Any] = dict.fromkeys((*MATHEMATICS, "failure"), "") | {
        "number": str(r.equation or ""), "title": r.title, "symbol": left, "symbol_value": f"{left} = {trade}",
        "note": r.note,
    }  # fmt: skip
    if r.declared is None:
        return texts
    expression, printed = _expression(r), r.declared.printed
    if printed:
        texts["printed"] = f"{left} = {typst(printed, paper=True)}"
    computed = "" if printed and typst(printed) == typst(expression) else typst(expression)
    texts["used"] = f"{left} = {computed}" if computed.replace("^(2)", "^2") not in ("", left) else ""
    texts["numbers"] = f"{left} = {typst(expression, values=_put_in(expression, _terms(r), _with_unit))}"
    si = KINDS[r.kind].si
    texts["result"] = trade if si == r.unit else f"{quantity(float(r.value), si, r.kind)} = {trade}"
    texts["failure"] = _failures().get(r.declared.name, "")
    return texts


def value_of(expression: str, terms: Mapping[str, tuple[float, str]]) -> float:
    """An expression of ours with the values of its terms.

    >>> value_of("m * g * sin(beta)", {"m": (2.0, "kg"), "g": (9.8, "m/s^2"), "beta": (math.pi / 2, "rad")})
    19.6
    """
    space: dict[str, Any] = {"sqrt": math.sqrt, "sin": math.sin, "cos": math.cos}
    space |= {term: value for term, (value, _) in terms.items()}
    return float(own_value(expression, space))


def worked(
    name: str, title: str, left: str, expression: str, terms: Mapping[str, tuple[float, str]], unit: str, kind: str,
    note: str = "", *, bare: bool = False,
) -> tuple[dict[str, Any], float]:  # fmt: skip
    """A formula with its numbers put in, as a step of a derivation, and its value; ``bare``: numbers without units."""
    value, sign = value_of(expression, terms), symbol_typst(left)
    written = (lambda x, unit: _with_unit(x, unit if unit == "deg" else "1")) if bare else _with_unit
    texts = dict.fromkeys((*MATHEMATICS, "failure"), "") | {
        "number": "", "title": title, "symbol": sign, "symbol_value": f"{sign} = {quantity(value, unit, kind)}",
        "used": f"{sign} = {typst(expression)}",
        "numbers": f"{sign} = {typst(expression, values=_put_in(expression, terms, written))}",
        "result": quantity(value, unit, kind), "note": note, "exact": {"name": name, "value": value},
    }  # fmt: skip
    return texts, value


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
    return json.loads(resources.files(__package__).joinpath("printed_failures.json").read_bytes())


def evaluated_failures() -> dict[str, str]:
    """The same, found anew: every declared equation's printed form evaluated with units."""
    declarations = [*EQUATIONS.values(), *COMPANIONS.values()]
    failures = {declared.name: printed_failure(declared) for declared in declarations}
    return {name: failure for name, failure in failures.items() if failure}


def _expression(r: Requirement) -> str:
    """Expression that was computed; the printed form where only its quantities were put in (one shown beside ours)."""
    assert r.declared is not None
    return r.declared.printed if r.name.endswith("_as_printed") else r.declared.computed


def _terms(r: Requirement) -> dict[str, tuple[float, str]]:
    """The terms of a requirement's equation with their values and units."""
    assert r.declared is not None
    defaults = inspect.signature(r.declared.formula).parameters
    values = {term.name: r.inputs.get(term.name, defaults[term.name].default) for term in r.declared.terms}
    return {term.name: (float(values[term.name]), term.unit) for term in r.declared.terms}


def numbers_in(r: Requirement) -> str:
    """A requirement's equation with its numbers put in, as a line of text without the left side."""

    def plain(value: float, unit: str) -> str:
        return "unknown" if math.isnan(value) else f"{value:.4g} {label(unit)}".rstrip()

    return text(_expression(r), values=_put_in(_expression(r), _terms(r), plain))


def _put_in(
    expression: str, terms: Mapping[str, tuple[float, str]], written: Callable[[float, str], str]
) -> dict[str, str]:
    """Terms as they are put in, in brackets where a sign, or a unit below an exponent, needs them."""
    powers = (node.left for node in ast.walk(ast.parse(expression))
              if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow))  # fmt: skip
    raised = {base.id for base in powers if isinstance(base, ast.Name)}
    values = {}
    for name, (value, unit) in terms.items():
        if unit == "rad":
            value, unit = math.degrees(value), "deg"
        put = written(value, unit)
        values[name] = f"({put})" if value < 0.0 or (name in raised and put != written(value, "1")) else put
    return values


if __name__ == "__main__":
    import drivesizer.equations  # noqa: F401 - declares them

    print(json.dumps(evaluated_failures(), ensure_ascii=False, indent=1))


# -- Texts of the PDF report: cleaned, cut, and made breakable.
#
# Text of a spec or a catalogue is printed letter for letter; only invisible characters, and words too long for a
# column, are changed.


_BREAK = "\u200b"  # zero width space: a line may end here
_LONG = 40  # characters of a word that fit a line of text; the template handles narrower columns


def clean(text: str) -> str:
    """A text with control characters spelled out, and places to break in very long words.

    >>> clean("a\\x00b")
    'a\\\\x00b'
    """
    visible = "".join(c if c.isprintable() or c == "\n" else repr(c)[1:-1] for c in text.expandtabs(4))
    return re.sub(rf"\S{{{_LONG + 1},}}", lambda match: _broken(match.group()), visible)


def _broken(word: str) -> str:
    return _BREAK.join(word[start : start + _LONG] for start in range(0, len(word), _LONG))


def cleaned(value: Any) -> Any:
    """Every text inside nested lists and dicts, cleaned; mathematics and pictures are left alone."""
    if isinstance(value, dict):
        return {key: entry if key in _RAW else cleaned(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [cleaned(entry) for entry in value]
    return clean(value) if isinstance(value, str) else value


_RAW = {*MATHEMATICS, "svg"}  # made by us


def short(text: str, longest: int = 60) -> str:
    """A text for a line that must not wrap.

    Examples
    --------
    >>> short("a long name", 8)
    'a long …'
    """
    return text if len(text) <= longest else text[: longest - 1] + "…"


def margin(value: float) -> str:
    """A margin as it is printed, empty where there is none.

    >>> margin(0.2095), margin(-0.05), margin(10.1), margin(1.28e6)
    ('+21 %', '−5.0 %', '+1010 %', '> 9999 %')
    """
    if math.isnan(value):
        return ""
    percent = 100.0 * value
    if percent >= _MOST_PERCENT:
        return f"> {_MOST_PERCENT} %"
    digits = f"{abs(percent):.1f}" if abs(percent) < 9.95 else f"{abs(percent):.0f}"
    sign = "" if float(digits) == 0.0 else "−" if percent < 0 else "+"
    return f"{sign}{digits} %"


_MOST_PERCENT = 9999  # of a margin; beyond it is no figure, but a limit that does not matter


def minus(figure: str) -> str:
    """A printed figure with the minus sign that margins have.

    >>> minus("-4.93 %"), minus("0.02 in 0.015..0.03")
    ('−4.93 %', '0.02 in 0.015..0.03')
    """
    return f"−{figure[1:]}" if figure.startswith("-") else figure


def use(value: float) -> float | None:
    """The used share of a limit that belongs to a margin, None where it is unknown.

    >>> use(0.25)
    0.8
    """
    if math.isnan(value):
        return None
    return 1.0 / (1.0 + value) if value > -1.0 else 99.0
