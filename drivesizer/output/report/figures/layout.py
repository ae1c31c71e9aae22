"""matplotlib's figures, laid out once for several forms of the same drawing."""

from __future__ import annotations

from collections.abc import Callable
from contextvars import ContextVar
from typing import Any

__all__ = ["laid_out", "once"]

_KEPT: ContextVar[list[Any] | None] = ContextVar("_KEPT", default=None)  # where figures are kept that are drawn once


def once(draw: Callable[[Any], bytes]) -> Callable[[Any], bytes]:
    """A drawing that is laid out when it is first printed as SVG, and let go when it is printed as such again."""
    kept: list[Any] = []

    def printed(form: Any) -> bytes:
        before = _KEPT.set(None if form == "png" else kept)  # a picture has other letters
        try:
            return draw(form)
        finally:
            _KEPT.reset(before)

    return printed


def laid_out(draw: Callable[[Any], None], size: tuple[float, float], dots: int, canvas: Any) -> Any:
    """A figure with its axes placed, that of before where a drawing is printed again."""
    from matplotlib.figure import Figure

    kept = _KEPT.get()
    if kept:
        return kept.pop()
    figure = Figure(figsize=size, layout="constrained", dpi=dots)
    canvas(figure)
    draw(figure)
    _place(figure)
    if kept is not None:
        kept.append(figure)
    return figure


def _place(figure: Any) -> None:
    """Place the axes once: left to itself, matplotlib draws the whole figure for that before it draws it."""
    if figure.get_layout_engine() is not None:
        figure.get_layout_engine().execute(figure)
        figure.set_layout_engine("none")
