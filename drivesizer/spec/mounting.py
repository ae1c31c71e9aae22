"""The drive's surroundings in a spec: what carries its heat away, thin air, loads on its shaft, a holding brake."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import Field

from drivesizer.files import fields
from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.figures import Figures
from drivesizer.physics.motor_demand import Demands, flange_loss
from drivesizer.physics.winding import Heat, heat
from drivesizer.spec.sections import Environment

# -- Thin air: margins by which thermal ratings must exceed the demand above 1000 m.
#
# Ratings hold up to 1000 m. Above, IEC 60034-1 takes 1 % of the permitted rise per 100 m, to 4000 m:
#
# .. math:: k = 1 - \frac{h - 1000\,\mathrm{m}}{10\,000\,\mathrm{m}}, \qquad
#           ΔT \le k \, ΔT_{max}, \quad I_{rms} \le \sqrt{k} \, I_N
#
# Controllers lose 1 % of their continuous current per 100 m, I ≤ k I_N (ABB, ACS880-14 hardware manual, altitude
# derating). No rating is changed: the margin m that a check requires becomes (1 + m) / k - 1, or with √k.
#
# Printed: a SIMOTICS S-1FK2 motor has 0.95, 0.89 and 0.84 of its torque at 2000, 3000 and 4000 m in 40 °C (Siemens,
# configuration manual A5E46927724B, derating factors); √k is 0.949, 0.894 and 0.837.


_RATED, _PER_ALL = 1000.0, 10_000.0  # m: up to which ratings hold, and over which all of a rise would be lost


def rise_left(surroundings: Environment) -> float:
    """Share of the permitted rise that is left at an altitude.

    >>> rise_left(Environment(altitude="2000 m")), rise_left(Environment(altitude="500 m"))
    (0.9, 1.0)
    """
    return 1.0 - max(0.0, surroundings.altitude - _RATED) / _PER_ALL


def rise_needed(spec: Any, margin: float | None = None) -> float:
    """Margin that a rise of temperature must leave in a spec's surroundings."""
    return _raised(spec.margins.temperature if margin is None else margin, rise_left(spec.environment))


def motor_needed(spec: Any, margin: float | None = None) -> float:
    """Margin that a motor's RMS current or torque must leave there."""
    return _raised(spec.margins.torque if margin is None else margin, math.sqrt(rise_left(spec.environment)))


def controller_needed(spec: Any, margin: float | None = None) -> float:
    """Margin that a controller's continuous current must leave there."""
    return _raised(spec.margins.torque if margin is None else margin, rise_left(spec.environment))


def _raised(margin: float, left: float) -> float:
    return margin if left == 1.0 else (1.0 + margin) / left - 1.0


def altitude_words(spec: Any) -> tuple[str, ...]:
    """The assumption behind these margins, as a sentence; nothing up to 1000 m."""
    left = rise_left(spec.environment)
    if left == 1.0 or spec.method != "physics":
        return ()
    lost, less = (100.0 * (1.0 - x) for x in (left, math.sqrt(left)))
    return (
        f"at {spec.environment.altitude:g} m the winding's rise must stay {lost:.3g} % below the permitted one and the "
        f"motor's RMS current {less:.3g} % below its nominal one (IEC 60034-1: 1 % of the rise per 100 m above "
        f"1000 m), the controller's {lost:.3g} % (1 % per 100 m); these are in the margins that the checks require",
    )


# -- Section of a spec on the mounting of the motor: what carries its heat away, and what of the gearhead's loss heats
# it.
#
# Makers print the thermal resistance from housing to ambient, R_th2, of a mounting of their own. The kinds are
# shares of it, with bands:
#
# - ``metal_flange``: 0.5 (0.2 to 0.8). maxon prints the operating range of its DCX motors at half R_th2 too, and up
# to 80 % less on a good heat sink (recalled, not quoted); Faulhaber prints recommended values at 55 % less (3564 B);
# Copley prints 18 to 30 % less with a plate of 25 x 25 x 2.5 cm (ServoTube 38). - ``insulated``: 1.2 (1 to 1.45).
# maxon's figures are of a plastic plate already; motors that are rated on a plate lose it: Copley prints 0.87 to
# 0.50 K/W without and 0.61 to 0.41 K/W with one, 22 to 43 % more. - ``plate``: a thermal resistance of its own
# beside the housing's, both to ambient.


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


class Mounting(fields.Section):
    """Mounting of the motor, as far as it carries heat away or brings it."""

    kind: Literal["as_printed", "insulated", "metal_flange", "plate"] = fields.default(
        "as_printed", "of the motor's flange; as_printed: as its maker measured"
    )
    housing_resistance: fields.Ratio | None = fields.optional(
        "share of the printed thermal resistance from housing to ambient"
    )
    low: fields.Ratio | None = fields.optional("of that share, 5th percentile; exact where not given")
    high: fields.Ratio | None = fields.optional("of that share, 95th percentile")
    plate_resistance: fields.ThermalResistance | None = fields.optional(
        "of a plate, from the flange to ambient; beside the housing's"
    )
    gear_loss_share: fields.Part = fields.default(0, "of the gearhead's loss that heats the motor's housing")

    def _contradictions(self) -> Iterator[str]:
        if (self.kind == "plate") != (self.plate_resistance is not None):
            yield "give plate_resistance with kind: plate, e.g. 2 K/W, and with no other"
        if self.housing_resistance is not None and self.kind != "as_printed":
            yield f"give kind: {self.kind} or housing_resistance, not both"
        if (self.low is not None or self.high is not None) and self.housing_resistance is None:
            yield "give housing_resistance with low and high, e.g. 0.6"
        if self.housing_resistance is not None and not self.share.low <= self.share.value <= self.share.high:
            yield "expected low <= housing_resistance <= high"

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
        share = self.share
        band = "" if share.low == share.high else f" ({share.low:g} to {share.high:g})"
        source = _SOURCES.get(self.kind, "as the spec gives it")
        return f"times {share.value:g}{band}; {source}"


def loss_at_flange(spec: Any, cycle: AtGearhead, gearhead: Figures) -> Any:
    """Loss of gearheads that heats the housings of their motors, per speed of their output."""
    share = spec.mounting.gear_loss_share if spec.mounting else 0.0
    return share * flange_loss(cycle, gearhead) if share else 0.0


def heat_of(
    spec: Any, cycle: AtGearhead, demand: Demands, motor: Figures, gearhead: Figures, losses: Any = None
) -> Heat:
    """Losses at the housings of motors, and the least that their windings come to: in the long run, or as they start.

    Run once from cold a motion is over before the long run begins.
    """
    ambient = spec.environment.ambient
    heating = heat(ambient, cycle, demand, motor, losses, loss_at_flange(spec, cycle, gearhead))
    return heating._replace(winding=np.where(np.isnan(heating.winding), np.nan, ambient)) if spec.once else heating


def mounting_words(spec: Any) -> tuple[str, ...]:
    """Assumptions of the mounting, as sentences; none as printed."""
    mounting = spec.mounting
    if mounting is None:
        return ()
    sentences = []
    if mounting.changes_housing:
        sentences.append(
            f"the thermal resistance from housing to ambient is the printed one {mounting.words}; time constant of the "
            "housing and nominal current follow, that of brushed motors at worst stays as printed where it would rise: "
            "brushes may set it"
        )
    if mounting.gear_loss_share:
        sentences.append(f"{100.0 * mounting.gear_loss_share:g} % of the gearhead's loss heats the motor's housing")
    return tuple(sentences)


# -- Section of a spec on what acts on the output shaft of gearhead or motor.


ToothAngle = Annotated[float, fields.Quantity("angle", least=0.0, most=math.radians(45.0))]


class Shaft(fields.Section):
    """Overhung shaft of gearhead, or motor: pulley or pinion of the next stage, or what of the load it carries."""

    distance: fields.Thickness | None = fields.optional(
        "of the radial force from the mounting face of gearhead or motor; where not given that of the maker's limit",
        example="20 mm",
    )
    carries_load: bool = fields.default(
        False, "that the load's wheel, pinion, pulley, drum or screw has no bearing of its own, but this shaft's"
    )
    wheel_load: fields.Force | None = fields.optional(
        "of the floor on a carried wheel; an equal part of the weight where not given", example="400 N"
    )
    pressure_angle: ToothAngle = fields.default("20 deg", "of a pinion's teeth")
    helix_angle: ToothAngle = fields.default("0 deg", "of a pinion's teeth")
    belt_pretension: fields.Force | None = fields.optional(
        "of each strand at rest; where not given only the least force of a belt is known", example="100 N"
    )
    load_factor: fields.Factor = fields.default(1.5, "f_w of the bearing's life: 1 smooth, 1.5, 3 with impacts")
    static_safety: fields.Factor = fields.default(1.5, "of the bearing: 1.5, 2 with impacts, 3 for precision")


# -- Section of a spec on a holding brake of its own, and what is required of one.


_FIGURES = {"torque": "static_torque", "voltage": "supply", "length": "added_length"}  # others have the same name


class OwnBrake(fields.Section):
    """A holding brake with figures of its own, in place of one out of the catalogues."""

    torque: fields.TorqueAbove = fields.required("static, that it holds at least", example="2 N*m")
    dynamic_torque: fields.TorqueAbove | None = fields.optional("while it slips", example="1.5 N*m")
    at: Literal["motor", "load"] = fields.default("motor", "whose shaft it sits on")
    inertia: fields.Inertia | None = fields.optional("that turns with that shaft; estimated where not given")
    power: fields.Power | None = fields.optional("of its coil while released; estimated where not given")
    holding_power: fields.Consumed | None = fields.optional("that keeps it released, where that is less")
    voltage: fields.Voltage | None = fields.optional("of its coil")
    mass: fields.Mass | None = fields.optional("estimated where not given")
    length: fields.Thickness | None = fields.optional("that it adds to the motor", example="30 mm")
    price: fields.Price | None = None
    release_time: fields.Duration | None = fields.optional(example="30 ms")
    engage_time: fields.Pause | None = fields.optional("until it has its torque", example="20 ms")
    max_speed: fields.Turning | None = fields.optional("of its shaft")
    energy_per_stop: fields.Energy | None = fields.optional("permitted in one emergency stop", example="20 J")
    total_energy: fields.Energy | None = fields.optional("of all emergency stops in its life", example="10 kJ")
    emergency_stops: Annotated[int, Field(ge=1)] | None = fields.optional("permitted in its life")

    def _contradictions(self) -> Iterator[str]:
        if self.total_energy is not None and not self.total_energy >= (self.energy_per_stop or 0.0):
            yield "total_energy: expected at least energy_per_stop, as it is that of all stops"

    @property
    def figures(self) -> dict[str, Any]:
        """Columns of the catalogue, as far as given [SI]; arrays over samples."""
        figures = {_FIGURES.get(name, name): getattr(self, name) for name in type(self).model_fields if name != "at"}
        known = {name: value for name, value in figures.items() if value is not None}
        return known | {"shaft": "load" if self.at == "load" else ""}
