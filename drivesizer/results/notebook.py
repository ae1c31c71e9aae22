"""Tables for notebooks, which show what ``_repr_html_`` of a record gives."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import isnan

from drivesizer.results.check import Check

__all__ = ["checks_table", "html_table", "share"]


def html_table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """An HTML table, every text escaped.

    Examples
    --------
    >>> html_table(("a",), [("<1>",)])
    '<table><tr><th>a</th></tr><tr><td>&lt;1&gt;</td></tr></table>'
    """
    from html import escape  # whose table of names takes a millisecond to load

    lines = ["".join(f"<th>{escape(head)}</th>" for head in heads)]
    lines += ["".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rows]
    return f"<table>{''.join(f'<tr>{line}</tr>' for line in lines)}</table>"


def checks_table(checks: Iterable[Check]) -> str:
    """Checks with demand, limit, margin and verdict as an HTML table."""
    rows = (
        (check.title, check.shown(check.demand), check.shown(check.limit), share(check.margin), check.status)
        for check in checks
    )
    return html_table(("check", "demand", "limit", "margin", ""), rows)


def share(margin: float) -> str:
    """A margin in per cent; empty where there is none."""
    return "" if isnan(margin) else f"{100 * margin:+.0f} %"
