"""Sections of a spec on its drive: stages between motor and load, permitted parts and objective, the closed loop."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, field_validator

from drivesizer.catalog.parts import columns_of
from drivesizer.catalog.prices import factors
from drivesizer.catalog.typed import NAME, Typed, typed_part
from drivesizer.errors import InputError
from drivesizer.files import fields
from drivesizer.files.yaml_source import YamlSource
from drivesizer.loads.stage_losses import FixedGear

# -- The stages between motor and load that a spec may name.


DIRECT = "direct"  # the kind of stage, and the name of direct drive in catalogues


class GearheadStage(fields.Section):
    """A gearhead out of the catalogues: searched; none where the catalogues list a motor for direct drive."""

    kind: Literal["gearhead"]


class DirectStage(fields.Section):
    """No gearhead: any motor may drive the load directly, or the belt."""

    kind: Literal["direct"]


class Pulleys(fields.Section):
    """A toothed belt and its two pulleys out of the catalogues: every ratio that they give is searched."""

    profile: str = fields.required("of the teeth, as catalogues name it: HTD, GT2", min_length=1, max_length=60)
    pitch: fields.Length = fields.required(example="5 mm")
    width: fields.Length = fields.required("of the belt; pulleys take it or a wider one", example="15 mm")
    ratio_min: fields.Ratio = fields.required("teeth of the load's pulley per tooth of the gearhead's, at least")
    ratio_max: fields.Ratio = fields.required("and at most; below 1 the load turns faster")
    centre_distance: fields.Length | None = fields.optional("of the shafts; any where not given", example="200 mm")
    adjustable: fields.Thickness = fields.default("3 mm", "by how much the shafts may be moved, either way")

    def _contradictions(self) -> Iterator[str]:
        if not self.ratio_min <= self.ratio_max:
            yield "expected ratio_min <= ratio_max"


class BeltStage(fields.Section):
    """A belt between gearhead, or motor, and load: one ratio, several to search, or pulleys out of the catalogues."""

    kind: Literal["belt"]
    ratio: fields.Ratio | None = fields.optional("gearhead turns per turn of the load; or ratios, or pulleys")
    ratios: Annotated[list[fields.Ratio], Field(min_length=1, max_length=1000)] | None = None
    pulleys: Pulleys | None = None
    efficiency: fields.Share = fields.required("in either direction of power", example="95 %")
    inertia: fields.Inertia = fields.default("0 kg*m^2", "of belt and pulleys, seen at the load's shaft")
    friction_torque: fields.Torque = fields.default("0 N*m", "of its bearings at any load, seen at the load's shaft")
    stiffness: fields.Stiffness | None = fields.optional("of the belt, seen at the load's shaft")
    mass: fields.Mass | None = fields.optional("of belt and pulleys, where these are not out of the catalogues")
    pulley_diameter: fields.Length | None = fields.optional(
        "of the load's pulley; with pulleys it follows from the teeth", example="60 mm"
    )
    max_tension: fields.Force | None = fields.optional(
        "permitted effective tension, with a known pulley", example="300 N"
    )
    max_speed: fields.Speed | None = fields.optional("permitted belt speed, with a known pulley", example="20 m/s")

    def _contradictions(self) -> Iterator[str]:
        yield from fields.exactly_one(self, "ratio", "ratios", "pulleys")
        if self.pulleys is not None and self.pulley_diameter is not None:
            yield "give pulleys or pulley_diameter, not both: diameters of pulleys follow from their teeth"
        if self.pulleys is None and self.pulley_diameter is None and (self.max_tension or self.max_speed):
            yield "give pulley_diameter beside max_tension and max_speed"


class GearStage(fields.Section):
    """A further stage of fixed ratio, behind or before the belt: spur or bevel gears, a chain, or a worm."""

    kind: Literal["gear", "bevel", "chain", "worm"]
    ratio: fields.Ratio = fields.required("turns of its input shaft per turn of its output shaft; below 1 it steps up")
    efficiency: fields.Share = fields.required("when the input shaft drives", example="90 %")
    back_efficiency: fields.BackEfficiency | None = fields.optional(
        "when the output shaft drives; where not given as efficiency, of a worm 2 - 1/efficiency. 0 or "
        "below is self-locking"
    )
    pinion_inertia: fields.Inertia = fields.default("0 kg*m^2", "of what turns with its input shaft: pinion or worm")
    wheel_inertia: fields.Inertia = fields.default("0 kg*m^2", "of what turns with its output shaft: wheel or sprocket")
    pinion_friction: fields.Torque = fields.default("0 N*m", "of bearings and seals of the input shaft, at any load")
    wheel_friction: fields.Torque = fields.default("0 N*m", "of bearings and seals of the output shaft, at any load")
    pinion_diameter: fields.Length | None = fields.optional(
        "pitch circle of pinion or sprocket, for its force on the shaft; bevels: the mean one", example="40 mm"
    )
    backlash: fields.Angle | None = fields.optional("at its output shaft; unknown where not given", example="5 arcmin")
    mass: fields.Mass | None = fields.optional("of the whole stage; unknown where not given")

    def _contradictions(self) -> Iterator[str]:
        if self.kind == "worm" and self.pinion_diameter is not None:
            yield "forces of a worm are not computed; leave pinion_diameter out, see needs.radial_load"

    def fixed_gear(self, behind: float = 1.0) -> FixedGear:
        """Its figures, with inertia and friction as seen where a belt of a ratio is behind it."""
        back = self.back_efficiency
        if back is None:
            back = 2.0 - 1.0 / self.efficiency if self.kind == "worm" else self.efficiency
        return FixedGear(
            self.ratio, self.efficiency, back,
            self.pinion_inertia * behind**2, self.wheel_inertia * behind**2,
            self.pinion_friction * behind, self.wheel_friction * behind,
        )  # fmt: skip


def in_series(stages: Sequence[GearStage]) -> GearStage:
    """Gears one behind the other as one, from the motor to the load; what turns between them seen at the output.

    Where their losses by direction count, each is gone through by itself: this one has what the others read of it.
    """
    first, *others = stages
    train = first
    for other in others:
        i, gears = other.ratio, [stage.fixed_gear() for stage in (train, other)]
        backs = [gear.back_efficiency for gear in gears]
        lost = None if None in (train.backlash, other.backlash) else other.backlash + train.backlash / i  # type: ignore[operator]
        train = GearStage.model_construct(
            kind=f"{train.kind} and {other.kind}", ratio=train.ratio * i,
            efficiency=train.efficiency * other.efficiency,
            back_efficiency=backs[0] * backs[1] if min(backs) > 0.0 else min(backs),
            pinion_diameter=first.pinion_diameter, pinion_inertia=first.pinion_inertia,
            pinion_friction=first.pinion_friction, backlash=lost,
            wheel_inertia=other.wheel_inertia + (train.wheel_inertia + other.pinion_inertia) * i**2,
            wheel_friction=other.wheel_friction + (train.wheel_friction + other.pinion_friction) * i,
            mass=None if None in (train.mass, other.mass) else train.mass + other.mass,  # type: ignore[operator]
        )  # fmt: skip
    return train


Stage = Annotated[GearheadStage | DirectStage | BeltStage | GearStage, Field(discriminator="kind")]


# -- Section of a spec on permitted parts and the objective of the ranking.


@dataclass(frozen=True, slots=True)
class ObjectiveKind:
    """An objective of ranking: a sum of catalogue figures, or a figure of the load cycle."""

    title: str
    kind: str  # of quantity
    unit: str  # of the trade
    figure: str = ""  # of the parts, that is summed; none: what ``search.columns.controllers`` computes under this name
    over: tuple[str, ...] = ()  # roles of the parts that it is summed over
    note: str = ""  # beside a value that is no sum: its meaning
    more_is_better: bool = False
    by_waveform: bool = False  # needs the current over time, not moments and extremes alone


_TURNING = ("motor", "gearhead", "brake")
BOUGHT = (*_TURNING, "encoder", "controller")
"""Roles of the parts that mass and price are summed over: an actuator has some of them inside."""
OBJECTIVES: dict[str, ObjectiveKind] = {
    "mass": ObjectiveKind("mass", "mass", "g", "mass", BOUGHT),
    "price": ObjectiveKind("price", "price", "EUR", "price", BOUGHT),
    "length": ObjectiveKind("length", "length", "mm", "length", _TURNING),
    "power": ObjectiveKind("assigned power", "power", "W", "assigned_power", ("motor",)),
    "energy": ObjectiveKind("energy per cycle", "energy", "J", note="all drives, per cycle", by_waveform=True),
    "joule_heat": ObjectiveKind(
        "heat of the winding", "power", "W", note="of the motor's winding, mean", by_waveform=True
    ),
    "peak_current": ObjectiveKind("peak current", "current", "A", note="the motor's, in the worst case"),
    "winding_temperature": ObjectiveKind(
        "winding temperature", "temperature", "degC", note="peak over the periodic cycle, in the worst case",
        by_waveform=True,
    ),
    "margin": ObjectiveKind(
        "smallest margin", "dimensionless", "%", note="smallest margin of all checks", more_is_better=True,
        by_waveform=True,
    ),
}  # fmt: skip


ASSUMABLE: dict[str, tuple[str, ...]] = {  # checks that pass where a figure is missing, if the spec says so
    "ambient_range": ("motor_temperature_range", "gearhead_temperature_range"),
    "backlash": ("backlash_at_load",),
    "peak_time": ("controller_peak_time",),
}


class Choice(fields.Section):
    """Restricts a kind of part to some makers, families or part numbers; * stands for any text."""

    maker: fields.Names | None = fields.optional("such as maxon, as its catalogue has it")
    family: fields.Names | None = fields.optional('such as "EC 45 flat" or "EC*"')
    part: fields.Names | None = None

    @property
    def named(self) -> dict[str, list[str]]:
        """Names or patterns by the catalogue's column, as far as given."""
        columns = {"manufacturer": self.maker, "family": self.family, "part": self.part}
        return {column: names for column, names in columns.items() if names}


class MotorChoice(Choice):
    """Restricts the motor."""

    kind: Literal["brushed", "brushless", "stepper"] | None = fields.optional(
        "stepper: of the catalogues' steppers; else they are left out"
    )


class EncoderChoice(Choice):
    """Restricts the encoder."""

    min_counts: Annotated[int, Field(ge=1)] | None = fields.optional("counts per turn at least")


class ControllerChoice(Choice):
    """Restricts the controller."""

    bus: str | None = fields.optional("such as CANopen or EtherCAT")


if TYPE_CHECKING:
    Objective = str
else:
    Objective = Literal[tuple(OBJECTIVES)]


class Weighted(fields.Section):
    """One of several objectives, weighted relative to the smallest value of all drives."""

    objective: Objective
    weight: fields.Ratio


Ranking = str | list[Weighted]  # one objective, or several with weights


_TYPED = {"motor": "motors", "gearhead": "gearheads", "actuator": "actuators"}


def or_typed(section: str) -> Callable[[dict[str, Any]], None]:
    """Let the schema of a choice take a part with figures of its own."""

    def also(schema: dict[str, Any]) -> None:
        from drivesizer.catalog.schema import table

        figures: dict[str, Any] = table(section)["properties"]["common"]["properties"]
        typed = {"type": "object", "required": [NAME], "properties": {NAME: {"type": ["string", "integer"]}} | figures}
        kind = {"$ref": schema.pop("$ref")} if "$ref" in schema else {"type": schema.pop("type")}
        schema["anyOf"] = [kind, typed]

    return also


class Select(fields.Section):
    """Permitted parts, and the objective of the ranking."""

    catalogs: fields.Names = fields.default(["maxon"], "names, files of your own, or all for all that ship")
    motor: MotorChoice = fields.all_defaults(
        "or one with figures of its own, typed: name, voltage, no_load_speed ...", json_schema_extra=or_typed("motors")
    )
    gearhead: Choice = fields.all_defaults("or a typed one", json_schema_extra=or_typed("gearheads"))
    actuator: None = fields.optional("a typed one: name and figures", json_schema_extra=or_typed("actuators"))
    encoder: EncoderChoice = fields.all_defaults()
    controller: ControllerChoice = fields.all_defaults()
    brake: Choice = fields.all_defaults()
    objective: Objective | Annotated[list[Weighted], Field(min_length=1, max_length=8)] = "mass"
    unknown: Literal["allow", "reject"] = fields.default("allow", "drives with a check that is unknown")
    assume: list[Literal["ambient_range", "backlash", "peak_time"]] = fields.default(
        [], "checks that pass where their figure is missing, shown as assumed"
    )

    rates: Annotated[dict[str, str], Field(max_length=40)] = fields.all_defaults(
        "what one of a currency is in another, {USD: 0.92 EUR}, with a date if wanted; for prices to be compared"
    )
    estimates: Literal["on", "off"] = fields.default(
        "on", "figures that data sheets leave out, from those of their peers"
    )

    @field_validator("rates")
    @classmethod
    def _known_rates(cls, rates: dict[str, str]) -> dict[str, str]:
        factors(rates, "EUR")
        return rates

    @field_validator("objective")
    @classmethod
    def _each_once(cls, objective: Objective | list[Weighted]) -> Objective | list[Weighted]:
        names = [weighted.objective for weighted in objective] if isinstance(objective, list) else []
        if twice := [name for name in names if names.count(name) > 1]:
            raise ValueError(f"expected each objective once; {twice[0]} is given twice")
        return objective

    def ranked_by(self, objective: Ranking | None) -> Select:
        """The same with another objective; itself where none is given."""
        other = objective is not None and objective != self.objective
        return self.model_copy(update={"objective": objective}) if other else self

    def pair_with(self, motor: str, family: str) -> Select:
        """The same with one motor and one family of gearheads alone."""
        return self.model_copy(update={"motor": MotorChoice(part=[motor]), "gearhead": Choice(family=[family])})

    @property
    def weights(self) -> dict[str, float]:
        """The objectives of the ranking with their weights."""
        return weights_of(self.objective)

    @property
    def is_restricted(self) -> bool:
        """Whether makers, families or parts are named."""
        return any(self.named.values())

    @property
    def named(self) -> dict[str, dict[str, list[str]]]:
        """Makers, families and parts that are named, by section of the catalogue."""
        return {
            f"{role}s": getattr(self, role).named for role in ("motor", "gearhead", "encoder", "controller", "brake")
        }


def split_typed(source: YamlSource, data: Any) -> tuple[Any, tuple[Typed, ...]]:
    """Parts with figures of their own in the section ``select``, and the data with these parts chosen by number."""
    selection, typed_parts = data.get("select"), list[Typed]()
    select = dict(selection) if isinstance(selection, dict) else {}
    for role, section in _TYPED.items():
        fields_, place = select.get(role), ("select", role)
        if not isinstance(fields_, dict) or NAME not in fields_:
            figures = set(fields_ or ()) & (columns_of(section).keys() - {"part", "family", "kind"})
            if figures and isinstance(fields_, dict):
                where = source.where((*place, min(figures)))
                raise InputError(f'{where}: a part with figures of its own needs its name, e.g. name: "775"')
            continue
        stepper = role == "motor" and fields_.get("kind") == "stepper"
        if role == "actuator" and "motor" in select:
            raise InputError(f"{source.where(place)}: give select.motor or select.actuator, not both")
        section = "steppers" if stepper else section
        text = typed_part(source, place, section)
        typed_parts.append(Typed(section, str(fields_[NAME]), text, ".".join(place)))
        select.pop(role)
        criteria = {"part": [str(fields_[NAME])]} | ({"kind": "stepper"} if stepper else {})
        select["gearhead" if role == "gearhead" else "motor"] = criteria
    return (data | {"select": select} if typed_parts else data), tuple(typed_parts)


def weights_of(objective: Ranking) -> dict[str, float]:
    """The objectives that are counted with their weights; each is there once.

    >>> weights_of("mass")
    {'mass': 1.0}
    """
    return (
        {objective: 1.0}
        if isinstance(objective, str)
        else {weighted.objective: weighted.weight for weighted in objective}
    )


# -- Sections of a spec on the closed loop: the controller's structure and gains, and the model of the machine.


class CurrentLoop(fields.Section):
    """Gains of the current loop; designed where none is given."""

    kp: fields.Gain | None = fields.optional("proportional gain [V/A]")
    ki: fields.Gain | None = fields.optional("integral gain [V/(A s)]")


class VelocityLoop(fields.Section):
    """Gains of the velocity loop, or targets of their design."""

    kp: fields.Gain | None = fields.optional("proportional gain [A per rad/s at the motor]")
    ki: fields.Gain | None = fields.optional("integral gain [A per rad]")
    kd: fields.Gain | None = fields.optional("derivative gain [A per rad/s^2]")
    filter_time: fields.Duration | None = fields.optional("of the derivative", example="1 ms")
    bandwidth: fields.Frequency | None = fields.optional("to place the poles for", example="30 Hz")
    damping: fields.Gain | None = fields.optional("of the placed poles; 0.707 where not given")
    phase_margin: fields.Angle | None = fields.optional(
        "for the symmetrical optimum; 37 deg where not given", example="45 deg"
    )


class PositionLoop(fields.Section):
    """The position loop; without this section there is none."""

    kp: fields.Gain | None = fields.optional("speed demand per position error [1/s]")
    planned_speed: bool = fields.default(True, "whether the planned speed is fed forward to the velocity loop")


class Feedforward(fields.Section):
    """Current added to the velocity loop's; from the model where not given, 0 for none."""

    velocity: fields.Gain | None = fields.optional("[A per rad/s at the motor]")
    friction: fields.Gain | None = fields.optional("[A] in the direction of the speed")
    acceleration: fields.Gain | None = fields.optional("[A per rad/s^2 at the motor]")


class Control(fields.Section):
    """The controller of the validation; gains are designed where none are given."""

    structure: Literal["voltage_pid", "cascade"] = fields.default(
        "voltage_pid", "one velocity loop on the voltage, or current, velocity and position loops"
    )
    kp: fields.Gain | None = fields.optional("proportional gain of voltage_pid [V per rad/s at the motor]")
    ki: fields.Gain = fields.default(0, "integral gain of voltage_pid [V per rad]")
    kd: fields.Gain = fields.default(0, "derivative gain of voltage_pid [V per rad/s^2]")
    bandwidth: fields.Frequency | None = fields.optional("closed-loop bandwidth to design voltage_pid for")
    current: CurrentLoop = fields.all_defaults()
    velocity: VelocityLoop = fields.all_defaults()
    position: PositionLoop | None = None
    feedforward: Feedforward = fields.all_defaults()
    rate: fields.Frequency | None = fields.optional(
        "at which the velocity loop runs; the controller's own where not given", example="1 kHz"
    )
    speed_from: Literal["exact", "counts"] = fields.default(
        "counts", "how speed is measured: by the encoder's counts where it has one, or exactly"
    )
    computing: Literal[0, 1] = fields.default(
        1, "periods that the velocity and position loops of a cascade take to respond to a sample; 0: they do within it"
    )
    at_rest: Literal["drain", "hold", "brake"] = fields.default(
        "drain",
        "integral of the velocity loop at rest where friction alone holds the load: drained to no current, "
        "or kept as braking left it; or the holding brake closes at every rest: no current holds the load there, none "
        "keeps the brake released (the closed loop is simulated without the brake)",
    )
    count_time: fields.Duration | None = fields.optional(
        "over which counts are taken for a speed; designed where not given", example="2 ms"
    )
    microsteps: Annotated[int, Field(ge=1)] | None = fields.optional(
        "of a stepper's driver, to a full step, in size and validate; its finest where not given"
    )
    phase_current: fields.Current | None = fields.optional(
        "that a stepper's driver is set to; the stepper's rated current where not given", example="2 A"
    )
    idle_current: fields.Share | None = fields.optional(
        "of a stepper's current at rest, as a share of that in motion; all of it where not given"
    )
    damping_ratio: fields.Part | None = fields.optional("of the swings of a stepper's rotor; 0.1 where not given")

    def _contradictions(self) -> Iterator[str]:
        if self.kp is None and (self.ki or self.kd):
            yield "ki and kd need kp"
        if self.count_time is not None and self.speed_from == "exact":
            yield "count_time belongs to speed_from: counts"
        if self.kp is not None and self.bandwidth is not None:
            yield "give kp or bandwidth, not both"
        own = {"current", "velocity", "position", "feedforward"} & self.model_fields_set
        if self.structure == "voltage_pid" and own:
            yield f"{min(own)} belongs to structure: cascade"
        if self.structure == "cascade" and {"kp", "ki", "kd", "bandwidth"} & self.model_fields_set:
            yield "kp, ki, kd and bandwidth belong under current or velocity in structure: cascade"


class Plant(fields.Section):
    """Model of the machine in closed loop; rigid where not given."""

    model: Literal["rigid", "two_mass"] = fields.default("rigid", "two_mass: motor, shaft, load")
    stiffness: fields.Stiffness | None = fields.optional("of the shaft, seen at the load; else the belt's")
    damping_ratio: fields.Part = fields.default(0.02, "of the load on its shaft, the motor held")
    backlash: fields.Angle | None = fields.optional("at the load; else the gearhead's")
    warming: bool = fields.default(True, "whether the winding warms along the run")

    def _contradictions(self) -> Iterator[str]:
        if self.model == "rigid" and {"stiffness", "damping_ratio", "backlash"} & self.model_fields_set:
            yield "stiffness, damping_ratio and backlash belong to model: two_mass"
