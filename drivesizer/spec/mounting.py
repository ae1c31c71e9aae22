"""Section of a spec on the mounting of the motor: what carries its heat away, and what of the gearhead's loss heats it.

Makers print the thermal resistance from housing to ambient, R_th2, of a mounting of their own. The kinds are shares of
it, with bands:

- ``metal_flange``: 0.5 (0.2 to 0.8). maxon prints the operating range of its DCX motors at half R_th2 too, and up to
  80 % less on a good heat sink (recalled, not quoted); Faulhaber prints recommended values at 55 % less (3564 B);
  Copley prints 18 to 30 % less with a plate of 25 x 25 x 2.5 cm (ServoTube 38).
- ``insulated``: 1.2 (1 to 1.45). maxon's figures are of a plastic plate already; motors that are rated on a plate lose
  it: Copley prints 0.87 to 0.50 K/W without and 0.61 to 0.41 K/W with one, 22 to 43 % more.
- ``plate``: a thermal resistance of its own beside the housing's, both to ambient.
"""

from typing import Any, Literal, NamedTuple, Self

from pydantic import Field, model_validator

from drivesizer.files.fields import Part, Ratio, Section, ThermalResistance, default
from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.figures import Figures
from drivesizer.physics.motor_demand import flange_loss

__all__ = ["Mounting", "Share", "loss_at_flange", "mounting_words"]


class Share(NamedTuple):
    """Share of the printed thermal resistance from housing to ambient [1]."""

    value: float
    low: float  # 5th percentile
    high: float  # 95th percentile


AS_PRINTED = Share(1.0, 1.0, 1.0)
_SHARES = {"metal_flange": Share(0.5, 0.2, 0.8), "insulated": Share(1.2, 1.0, 1.45)}
_SOURCES = {
    "metal_flange": "maxon: half in operating ranges, up to 80 % less (recalled); Faulhaber: 55 % less; "
    "Copley: 18 to 30 % less",
    "insulated": "maxon's figures are of a plastic plate; Copley: 22 to 43 % more without a plate",
}


class Mounting(Section):
    """Mounting of the motor, as far as it carries heat away or brings it."""

    kind: Literal["as_printed", "insulated", "metal_flange", "plate"] = Field(
        default="as_printed", description="of the motor's flange; as_printed: as its maker measured"
    )
    housing_resistance: Ratio | None = Field(
        default=None, description="share of the printed thermal resistance from housing to ambient"
    )
    low: Ratio | None = Field(default=None, description="of that share, 5th percentile; exact where not given")
    high: Ratio | None = Field(default=None, description="of that share, 95th percentile")
    plate_resistance: ThermalResistance | None = Field(
        default=None, description="of a plate, from the flange to ambient; beside the housing's"
    )
    gear_loss_share: Part = default(0, description="of the gearhead's loss that heats the motor's housing")

    @model_validator(mode="after")
    def _one_figure(self) -> Self:
        if (self.kind == "plate") != (self.plate_resistance is not None):
            raise ValueError("give plate_resistance with kind: plate, e.g. 2 K/W, and with no other")
        if self.housing_resistance is not None and self.kind != "as_printed":
            raise ValueError(f"give kind: {self.kind} or housing_resistance, not both")
        if (self.low is not None or self.high is not None) and self.housing_resistance is None:
            raise ValueError("give housing_resistance with low and high, e.g. 0.6")
        if self.housing_resistance is not None and not self.share.low <= self.share.value <= self.share.high:
            raise ValueError("expected low <= housing_resistance <= high")
        return self

    @property
    def share(self) -> Share:
        """Share of the printed thermal resistance with its band; 1 with a plate, which is no share."""
        own = self.housing_resistance
        if own is None:
            return _SHARES.get(self.kind, AS_PRINTED)
        return Share(own, own if self.low is None else self.low, own if self.high is None else self.high)

    @property
    def changes_housing(self) -> bool:
        """Whether the housing's thermal resistance is another than the printed one."""
        return self.plate_resistance is not None or self.share != AS_PRINTED

    @property
    def words(self) -> str:
        """Thermal resistance as mounted, in words."""
        if self.plate_resistance is not None:
            return f"beside a plate of {self.plate_resistance:g} K/W"
        one = self.share
        band = "" if one.low == one.high else f" ({one.low:g} to {one.high:g})"
        source = _SOURCES.get(self.kind, "as the spec gives it")
        return f"times {one.value:g}{band}; {source}"


def loss_at_flange(spec: Any, cycle: AtGearhead, gearhead: Figures) -> Any:
    """Loss of gearheads that heats the housings of their motors, per speed of their output."""
    share = spec.mounting.gear_loss_share if spec.mounting else 0.0
    return share * flange_loss(cycle, gearhead) if share else 0.0


def mounting_words(spec: Any) -> tuple[str, ...]:
    """Assumptions of the mounting, as sentences; none as printed."""
    one = spec.mounting
    if one is None:
        return ()
    found = []
    if one.changes_housing:
        found.append(
            f"the thermal resistance from housing to ambient is the printed one {one.words}; time constant of the "
            "housing and nominal current follow, that of brushed motors at worst stays as printed where it would rise: "
            "brushes may set it"
        )
    if one.gear_loss_share:
        found.append(f"{100.0 * one.gear_loss_share:g} % of the gearhead's loss heats the motor's housing")
    return tuple(found)
