"""Records of parts: one frozen record per kind of part, which is the catalogue's schema, and its columns.

``parts.txt`` has the figures of each kind, with the kind of quantity (the reader in ``units``) and the unit in which
data sheets print them; records, loader, columns, JSON Schema and pages of parts are derived from it. All figures are SI
floats; NaN is *unknown*, and an empty text is unknown. An actuator or gearmotor is sold as one part; ``search_view``
splits it for the search.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, lru_cache
from math import inf, nan
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.files.text import listed
from drivesizer.physics.belt import pitch_diameter
from drivesizer.physics.figures import Figures

_ALL_KINDS = "every part"  # head of the fields that all kinds have
DATA = "data_temperature"  # stands at the head of a file, for all motors and actuators that have none of their own


class Column(NamedTuple):
    """One field of a part: name, kind of quantity (or ``text``), unit of data sheets, remark, range of its figures."""

    name: str
    kind: str
    unit: str
    remark: str
    least: float
    zero: bool  # whether it may be 0
    most: float

    @property
    def head(self) -> str:
        """Name and unit, as a table's head has them."""
        return self.name if self.kind in ("text", "ratio") or self.unit == "1" else f"{self.name} ({self.unit})"


def _declared() -> dict[str, dict[str, Column]]:
    """The fields of every kind of part, by section, in the order of its record."""
    columns = dict[str, dict[str, Column]]()
    for section, (name, kind, *more) in listed("drivesizer.catalog", "parts.txt"):
        unit, remark, ends = (*more, "", "", "")[:3]
        least, _, most = ends.partition("..")
        column = Column(name, kind, unit, remark, float(least or 0.0), bool(least), float(most or inf))
        columns.setdefault(section, dict(columns.get(_ALL_KINDS, {})))[name] = column
    return columns


_FIELDS = _declared()
PARTS: dict[str, type[Any]] = {}
"""The record of each section of a catalogue."""


class PartRecord:
    """Figures of one part by name; laws read them so too (``physics.figures``)."""

    __slots__ = ()
    if TYPE_CHECKING:
        __dataclass_fields__: ClassVar[dict[str, Any]]

        def __init__(self, **figures: Any) -> None: ...
        def __getattr__(self, name: str) -> Any: ...

    def __getitem__(self, name: str) -> Any:
        return getattr(self, name)


def _of(section: str) -> Callable[[type[Any]], type[Any]]:
    """Make a class the record of a section, with the fields that are declared for it."""

    def record(kind: type[Any]) -> type[Any]:
        for name, column in _FIELDS[section].items():
            text = column.kind == "text"
            kind.__annotations__[name] = str if text else float
            setattr(kind, name, field(default="" if text else nan))
        PARTS[section] = dataclass(frozen=True, slots=True, kw_only=True)(kind)
        return PARTS[section]

    return record


@_of("motors")
class Motor(PartRecord):
    """One winding of a motor, as its data sheet gives it at ``data_temperature``; 25 degC where none is stated."""


@_of("gearheads")
class Gearhead(PartRecord):
    """One reduction of a gearhead."""


@_of("encoders")
class Encoder(PartRecord):
    """One resolution of an encoder."""

    @property
    def lines(self) -> float:
        """Lines of an incremental encoder of the same resolution."""
        return float(lines(self))

    @property
    def resolution(self) -> str:
        """Resolution as text."""
        if self.counts_per_turn == self.counts_per_turn:
            return f"{self.counts_per_turn:g} counts per turn"
        return f"{self.steps_per_turn:g} steps per turn" if self.steps_per_turn == self.steps_per_turn else ""


@_of("controllers")
class Controller(PartRecord):
    """One servo controller."""


@_of("actuators")
class Actuator(PartRecord):
    """A motor sold with its gearhead inside, maybe with encoder and controller: figures at the output, as printed."""


@_of("brakes")
class Brake(PartRecord):
    """A holding brake that releases when it has current."""


@_of("steppers")
class Stepper(PartRecord):
    """One wiring of a stepper motor; its pull-out torque over speed is in ``pull_outs``."""


@_of("belts")
class Belt(PartRecord):
    """One toothed belt, closed."""


@_of("pulleys")
class Pulley(PartRecord):
    """One pulley for toothed belts."""


@_of("screws")
class Screw(PartRecord):
    """One nut with its shaft, of steel, as long as the machine needs."""


@_of("batteries")
class Battery(PartRecord):
    """One cell or block."""


@_of("power_supplies")
class PowerSupply(PartRecord):
    """A power supply unit, or a converter from one direct voltage to another."""


@_of("brake_resistors")
class BrakeResistor(PartRecord):
    """A resistor for a chopper, a shunt regulator, which has both, or what a drive has of them inside."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BeltDrive:
    """A belt and two pulleys out of a catalogue."""

    driving: Pulley  # on the shaft of the gearhead, or of the motor where there is none
    driven: Pulley  # on the load's shaft
    belt: Belt
    centre_distance: float  # m
    teeth_in_mesh: float  # on the small pulley

    @property
    def ratio(self) -> float:
        """Turns of the driving pulley per turn of the driven one; below 1 it is a step up."""
        return float(self.driven.teeth / self.driving.teeth)

    @property
    def name(self) -> str:
        """The ratio by its teeth, as 36:24."""
        return f"{self.driven.teeth:.0f}:{self.driving.teeth:.0f}"

    @property
    def driven_diameter(self) -> float:
        """Pitch diameter of the load's pulley [m]."""
        return float(pitch_diameter(self.driven.teeth, self.driven.pitch))

    @property
    def parts(self) -> dict[str, Belt | Pulley]:
        """Parts of the belt drive, by role."""
        return {"driving pulley": self.driving, "belt": self.belt, "driven pulley": self.driven}


EDGES = 4  # of an incremental encoder per line, evaluated in quadrature
DIRECT = "direct"  # the part that represents direct drive, without a gearhead
# Direct drive weighs nothing and limits nothing: infinity here is the absence of a limit, not an unknown figure.
NO_GEARHEAD = Gearhead(
    part=DIRECT, family=DIRECT, kind=DIRECT, reduction="1:1", ratio=1.0, stages=0.0, direction=1.0, efficiency=1.0,
    continuous_torque=inf, intermittent_torque=inf, continuous_input_speed=inf, intermittent_input_speed=inf,
    continuous_power=inf, intermittent_power=inf, max_radial_load=inf, max_axial_load=inf, max_tilting_moment=inf,
    emergency_torque=inf, ratcheting_torque=inf, rated_life=inf, median_life=inf, temperature_min=0.0,
    temperature_max=inf, backlash=0.0, inertia=0.0, diameter=0.0, length=0.0, mass=0.0, price=0.0,
)  # fmt: skip


def lines(encoder: Figures) -> Any:
    """Lines of incremental encoders of the same resolution: their own, or an absolute one's steps over four.

    >>> float(lines({"counts_per_turn": np.nan, "steps_per_turn": 4096.0}))
    1024.0
    """
    own = encoder["counts_per_turn"]
    return np.where(np.isnan(own), encoder["steps_per_turn"] / EDGES, own)


# Parts that go with a motor, by the name of the list of pairs.
RELATIONS = {"motor_gearhead": "gearheads", "motor_encoder": "encoders", "motor_brake": "brakes"}


class OneRow:
    """A part's figures as columns of one; without a part every figure is unknown.

    >>> OneRow(NO_GEARHEAD)["ratio"], OneRow(None)["inertia"]
    (array([1.]), array([nan]))
    """

    def __init__(self, part: Any) -> None:
        self.part, self.cells = part, dict[Any, Any]()

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self.cells:
            self.cells[name] = np.array([np.nan if self.part is None else getattr(self.part, name)])
            self.cells[name].flags.writeable = False  # others take it as well
        return self.cells[name]

    def per_part(self, compute: Callable[[Any], Any]) -> Any:
        """Result of a function of the part's figures, once for each function."""
        if compute not in self.cells:
            self.cells[compute] = compute(self)
        return self.cells[compute]


@lru_cache(maxsize=256)
def one_row(part: Any) -> OneRow:
    """A part's figures as columns of one; of parts of late with those that were taken before."""
    return OneRow(part)


def singular(section: str) -> str:
    """Singular of a section's name.

    >>> singular("motors"), singular("batteries"), singular("brake_resistors")
    ('motor', 'battery', 'brake resistor')
    """
    return re.sub("ies$", "y", section).removesuffix("s").replace("_", " ")


_COMPUTED_COLUMNS = {  # columns that no catalogue file gives: the search view has them, of actuators and steppers
    "motors": {"inside", "holding_torque", "detent_torque", "start_speed", "pull_out_share", "mounted_gain"},
    "steppers": {"pull_out_share"},
}


def printed(section: str) -> dict[str, Column]:
    """The columns that a catalogue file may give, without those that only the search view fills."""
    view_columns = _COMPUTED_COLUMNS.get(section, {"inside"})
    return {name: column for name, column in columns_of(section).items() if name not in view_columns}


# columns that come first of any part, its names, and those that come last
NAMES = ("part", "order_number", "also_called", "family", "manufacturer")
_LAST = ("mass", "price", "price_5", "price_20", "list_price", "foreign_price", "currency")


@cache
def columns_of(section: str) -> Mapping[str, Column]:
    """The columns of a catalogue section, in the order in which they are printed.

    >>> columns_of("motors")["rotor_inertia"].unit
    'g*cm^2'
    """
    fields = _FIELDS[section]
    inner = [name for name in fields if name not in (*NAMES, *_LAST)]
    return MappingProxyType({name: fields[name] for name in (*NAMES, *inner, *_LAST) if name in fields})


# -- Tables of batteries and steppers: every printed figure is one entry of columns, in the order of the file


DISCHARGES = "discharges"  # the section of a catalogue file, and the name for all of a battery's in a note
PULL_OUTS = "pull_outs"  # the same of a stepper's pull-out torque over speed
CONSTANT_DRAWS = {"current": "A", "power": "W"}  # what is held while a battery empties


class Discharges(NamedTuple):
    """Printed discharges of all batteries: at which current or power, to which end voltage, how long."""

    battery: NDArray[np.int32]  # row of the batteries' table
    source: NDArray[np.int32]  # index into Catalog.sources
    cutoff_voltage: NDArray[np.float64]  # V, at which it ends, of the part
    time: NDArray[np.float64]  # s
    current: NDArray[np.float64]  # A; NaN where power is held
    power: NDArray[np.float64]  # W of the part; NaN where current is held

    def on(self, rows: Any) -> Discharges:
        """Some of the entries."""
        return Discharges(*(column[rows] for column in self))


class PullOuts(NamedTuple):
    """Printed points of all pull-out curves, each curve at a supply voltage, with a driver."""

    stepper: NDArray[np.int32]  # row of the steppers' table
    source: NDArray[np.int32]  # index into Catalog.sources
    curve: NDArray[np.int32]  # number of the curve
    voltage: NDArray[np.float64]  # V, of the driver's supply
    current: NDArray[np.float64]  # A, amplitude of a phase's current that the driver was set to; NaN unknown
    speed: NDArray[np.float64]  # rad/s, rising along a curve
    torque: NDArray[np.float64]  # N*m
    driver: NDArray[np.str_]  # as printed; empty where it is not

    def on(self, rows: Any) -> PullOuts:
        """Some of the entries."""
        return PullOuts(*(column[rows] for column in self))


def entries(kind: Any, rows: Sequence[tuple[Any, ...]]) -> Any:
    """Columns of a kind, from rows with its fields in their order."""
    types = {"battery": np.int32, "stepper": np.int32, "source": np.int32, "curve": np.int32, "driver": np.str_}
    columns = zip(*rows, strict=True) if rows else [()] * len(kind._fields)
    return kind(*(np.array(values, types.get(n, np.float64)) for n, values in zip(kind._fields, columns, strict=True)))


NO_DISCHARGES: Discharges = entries(Discharges, ())
NO_PULL_OUTS: PullOuts = entries(PullOuts, ())
