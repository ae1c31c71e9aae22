"""The parts list as the report prints it: how many of what, its order number, and what it costs as of when."""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan
from typing import Any

from drivesizer.output.parts import PartLine, ordered_as, totals

__all__ = ["order_list"]


def order_list(lines: Sequence[PartLine]) -> dict[str, Any]:
    """Rows of the list, the sum of what is known, and what it lacks.

    Parameters
    ----------
    lines
        Of :func:`drivesizer.output.parts.parts_list`.
    """
    prices = [total for total in totals(lines) if total.name == "price"]
    lacks = [line.role for line in lines if isnan(line.price)]
    return {
        "order": [_row(line) for line in lines],
        "order_sum": " + ".join(f"{total.value:.2f} {total.unit}" for total in prices) or "unknown",
        "order_lacks": f"without {', '.join(lacks)}" if lacks else "",
    }


def _row(line: PartLine) -> dict[str, str]:
    maker = line.family if line.maker in line.family else f"{line.maker} {line.family}"
    named = ordered_as(line.part, line.order_number)
    return {
        "count": f"{line.quantity} ×", "role": line.role, "family": maker or line.said or "unknown", "part": named,
        "each": _money(line.price, line.currency), "all": _money(line.quantity * line.price, line.currency),
        "dated": " ".join([*(["no date"] if not isnan(line.price) and not line.price_date else []), line.price_date,
                           *([f"from {line.pieces} pieces"] if (line.pieces or 1) > 1 else [])]).strip(),
    }  # fmt: skip


def _money(price: float, currency: str) -> str:
    return "unknown" if isnan(price) else f"{price:.2f} {currency}"
