"""Flow of the energy of a cycle, as bars that follow one another from the energy drawn down to nothing."""

from __future__ import annotations

from itertools import accumulate
from typing import TYPE_CHECKING, Any, NamedTuple

from drivesizer.machine.energy_flow import EnergyFlow
from drivesizer.output.report.figures.style import COLOURS, Form, drawn, placed
from drivesizer.units import from_si, label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["Share", "energy_bars", "energy_unit", "shares"]

_ROW = 0.17  # in
_SMALLEST = 1e-6  # of what is drawn: less is none, or the rounding of a trajectory
_LOOKS: dict[str, dict[str, Any]] = {  # distinct in grey as well
    "drawn": {"facecolor": "#BBBBBB", "edgecolor": "black"},
    "loss": {"facecolor": "#F4C9A8", "edgecolor": COLOURS["vermillion"], "hatch": "/////"},
    "load": {"facecolor": COLOURS["sky"], "edgecolor": COLOURS["blue"]},
    "back": {"facecolor": "white", "edgecolor": COLOURS["green"], "hatch": "\\\\\\"},
}


class Share(NamedTuple):
    """A part of the energy."""

    name: str
    value: float  # J
    look: str


def shares(flow: EnergyFlow) -> list[Share]:
    """Energy drawn, and then all that it goes into; shares of zero are left out."""
    into = [
        Share("resistance of the supply", flow.supply, "loss"),
        Share("controllers", flow.controller, "loss"),
        Share("brake, released", flow.brake, "loss"),
        Share("copper of the winding", flow.copper, "loss"),
        Share("friction and iron of the motor", flow.friction, "loss"),
        Share("gearhead", flow.gearhead, "loss"),
        Share("belt", flow.belt, "loss"),
        Share("work on the load", flow.load, "load"),
        Share("more in rotor and gear at the end", flow.rotor, "load"),
        Share("regenerated, kept by the supply", flow.stored, "back"),
        Share("regenerated, not kept", flow.burnt, "loss"),
    ]
    size = max(flow.drawn, abs(flow.load))
    return [Share("drawn from the supply", flow.drawn, "drawn"), *(x for x in into if abs(x.value) > _SMALLEST * size)]


def energy_unit(largest: float) -> str:
    """The unit in which energies up to some size are shown [J]."""
    return "J" if largest < 1e4 else "kJ" if largest < 1e7 else "MJ"


def energy_bars(flow: EnergyFlow, form: Form = "svg") -> bytes:
    """The energy of a cycle: each bar begins where the one above it ends, the last one ends at nothing."""
    shown = shares(flow)
    unit = energy_unit(max(abs(share.value) for share in shown))

    def draw(figure: Figure) -> None:
        axes = placed(figure, left=2.0, right=1.25, top=0.06)[0][0]
        left = [0.0, *accumulate((-share.value for share in shown[1:]), initial=flow.drawn)]
        for place, (share, start) in enumerate(zip(shown, left, strict=False)):
            _bar(axes, place, share, start, (unit, flow.drawn))
        axes.set_yticks(range(len(shown)), [share.name for share in shown])
        axes.tick_params(axis="y", length=0)
        axes.grid(axis="y", visible=False)
        axes.axvline(0.0, color="black", linewidth=0.6)
        axes.set(ylim=(len(shown) - 0.4, -0.6), xlabel=f"energy of a cycle ({label(unit)})")

    return drawn(draw, _ROW * len(shown) + 0.52, form)


def _bar(axes: Axes, place: int, share: Share, start: float, scale: tuple[str, float]) -> None:
    unit, whole = scale
    first, width = (float(from_si(x, unit, "energy")) for x in (start, share.value))
    down = share.look != "drawn"
    axes.barh(place, -width if down else width, left=first, height=0.66, linewidth=0.6, zorder=3, **_LOOKS[share.look])
    part = f", {100.0 * share.value / whole:.3g} %" if down and whole > 0.0 else ""
    said = f"{width:.4g} {label(unit)}{part}".replace("-", "−")
    axes.annotate(said, (1.0, place), xycoords=("axes fraction", "data"), xytext=(5, 0), textcoords="offset points",
                  va="center", fontsize=6.8)  # fmt: skip
