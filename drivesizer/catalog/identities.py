"""What a datasheet says twice: laws between the figures of one part, as a table.

Every law compares one figure with a function of the part's other figures, or of its sisters'. A figure that is not
known makes its law say nothing (NaN). The tolerance of a law is what rounding can do, half of the last printed digit of
every figure in it, and an ``allowance`` for physics that the formula leaves out, with its reason.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.parts import PARTS, columns_of
from drivesizer.catalog.tables import Table
from drivesizer.thermal import DATA_TEMPERATURE, continuous_current, nominal_current

__all__ = ["LAWS", "Law", "Numbers"]

Numbers = NDArray[np.float64]
Side = Callable[[Table[Any]], Any]

HANDBOOK = "maxon academy, Formulae Handbook, 2nd ed., 2012"
DEFINITION = "what the words mean"
BODY = "a body's mass and volume"
USAGE = "usual in the trade"
ROUNDED = "only what rounding explains"


@dataclass(frozen=True, slots=True, kw_only=True)
class Law:
    """One figure against what other figures say of it."""

    section: str
    name: str
    meaning: str  # as a formula or half a sentence
    figure: str  # the field that is compared; both numbers have its unit
    relation: str  # = <= >= < >, figure on the left
    expected: Side
    fields: tuple[str, ...]  # the other figures in it, as often as their power says
    allowance: float = 0.0  # relative, beyond rounding
    rounds: bool = True  # whether the rounding of the figures counts
    reason: str = ROUNDED  # of the tolerance
    source: str = DEFINITION
    grade: str = "finding"  # or information


# --- sides that are more than a formula ------------------------------------------------------------------------------


def _only(table: Table[Any], kind: str, values: Any) -> Numbers:
    """Values of the parts of one kind, unknown for the others."""
    return np.where(table["kind"] == kind, values, np.nan)


def _groups(table: Table[Any], *names: str) -> NDArray[np.intp]:
    """Number of the group in which parts agree in some fields; an unknown figure agrees with an unknown one."""
    found: NDArray[np.intp] = np.zeros(len(table), np.intp)
    for name in names:
        numbers = np.unique(table[name], return_inverse=True)[1]
        found = np.unique(found * (len(table) + 1) + numbers, return_inverse=True)[1]
    return found


def _over(table: Table[Any], figure: str, rows: NDArray[np.bool_], how: Callable[[Numbers], Any]) -> float:
    """Median, least or greatest figure of some of the offered parts."""
    values = table[figure][rows & ~table.excluded & ~np.isnan(table[figure])]
    return float(how(values)) if len(values) else np.nan


def _usual(*names: str) -> Callable[[str], Side]:
    """The median of a figure over the parts that agree in some fields."""

    def side(figure: str) -> Side:
        def values(table: Table[Any]) -> Numbers:
            group = _groups(table, *names)
            medians = [_over(table, figure, group == k, np.median) for k in range(int(group.max(initial=-1)) + 1)]
            alike = np.all([~np.isnan(table[n]) for n in names if columns_of(table.section)[n].kind != "text"], axis=0)
            return np.where(alike, np.array(medians, float)[group], np.nan)

        return values

    return side


_of_its_size = _usual("family", "diameter")
_of_its_stages = _usual("family", "version", "stages")


def _one_stage_less(figure: str, how: Callable[[Numbers], Any]) -> Side:
    """The least or greatest figure of the same gearhead with the next lower number of stages."""

    def values(table: Table[Any]) -> Numbers:
        group, stages = _groups(table, "family", "version", "diameter"), table["stages"]
        found = np.full(len(table), np.nan)
        for k in range(int(group.max(initial=-1)) + 1):
            counts = np.unique(stages[(group == k) & ~np.isnan(stages)])
            for less, more in pairwise(counts):
                lesser = _over(table, figure, (group == k) & (stages == less), how)
                found[(group == k) & (stages == more)] = lesser
        return found

    return values


def _printed_reduction(table: Table[Any]) -> Numbers:
    """The number in front of ``:1``; unknown where the reduction is written otherwise."""

    def number(text: str) -> float:
        try:
            return float(text.removesuffix(":1"))
        except ValueError:
            return np.nan

    return np.array([number(text) for text in table["reduction"].tolist()], float)


def _direction(table: Table[Any]) -> Numbers:
    """Every spur stage turns the direction round; a planetary stage with a fixed ring does not."""
    odd = np.where(np.isnan(table["stages"]), np.nan, 1.0 - 2.0 * (table["stages"] % 2))
    return np.where(table["kind"] == "planetary", 1.0, _only(table, "spur", odd))


def _of_toothed_stages(g: Table[Any], base: float) -> Numbers:
    """A number to the power of the stages, of planetary and spur gearheads."""
    return np.where(np.isin(g["kind"], ("planetary", "spur")), base ** g["stages"], np.nan)


def _thermal(m: Table[Any], housing_loss: bool) -> Numbers:
    """Current that the thermal figures bear."""
    th1, th2, hot = m["thermal_resistance_winding"], m["thermal_resistance_housing"], m["max_winding_temperature"]
    if housing_loss:
        flow = (m["torque_constant"], m["no_load_current"], m["nominal_speed"])
        return np.asarray(nominal_current(m["resistance"], th1, th2, hot, *flow))
    return np.asarray(continuous_current(m["resistance"], th1, th2, hot, DATA_TEMPERATURE))


def _cylinder(t: Table[Any]) -> Numbers:
    return np.asarray(np.pi / 4 * t["diameter"] ** 2 * t["length"])


# --- the motor's laws ------------------------------------------------------------------------------------------------

_HEAT = ("resistance", "thermal_resistance_winding", "thermal_resistance_housing", "max_winding_temperature")
_BRUSHED = ("kind", "torque_constant", "no_load_current", "nominal_current")

# name, meaning, figure, relation, expected, other figures, allowance, reason
_MOTOR_LAWS: list[tuple[str, str, str, str, Side, tuple[str, ...], float, str]] = [
    ("speed constant", "k_n = 1 / k_t", "speed_constant", "=",
     lambda m: 1 / m["torque_constant"], ("torque_constant",), 0.0, ROUNDED),
    ("stall current", "I_A = V / R", "stall_current", "=",
     lambda m: m["nominal_voltage"] / m["resistance"], ("nominal_voltage", "resistance"), 0.0, ROUNDED),
    ("stall torque", "M_H = k_t I_A", "stall_torque", "=",
     lambda m: m["torque_constant"] * m["stall_current"], ("torque_constant", "stall_current"), 0.0, ROUNDED),
    ("speed-torque gradient", "R / k_t^2", "speed_torque_gradient", "=",
     lambda m: m["resistance"] / m["torque_constant"] ** 2,
     ("resistance", "torque_constant", "torque_constant"), 0.0, ROUNDED),
    ("mechanical time constant", "J R / k_t^2", "mechanical_time_constant", "=",
     lambda m: m["rotor_inertia"] * m["resistance"] / m["torque_constant"] ** 2,
     ("rotor_inertia", "resistance", "torque_constant", "torque_constant"), 0.0, ROUNDED),
    ("no-load speed", "(V - I_0 R) / k_t", "no_load_speed", "=",
     lambda m: (m["nominal_voltage"] - m["no_load_current"] * m["resistance"]) / m["torque_constant"],
     ("nominal_voltage", "no_load_current", "resistance", "torque_constant"), 0.045,
     "brush drop and the choke of a driver are not in it: 95 % of 642 maxon motors within 1 %, the worst 3.9 %"),
    ("friction", "I_0 = (M_R + c w_0) / k_t", "no_load_current", "=",
     lambda m: (m["friction_torque"] + m["viscous_friction"] * m["no_load_speed"]) / m["torque_constant"],
     ("friction_torque", "viscous_friction", "no_load_speed", "torque_constant"), 0.1,
     "friction is printed as a typical value"),
    ("nominal torque of brushed motors", "k_t (I_N - I_0)", "nominal_torque", "=",
     lambda m: _only(m, "brushed", m["torque_constant"] * (m["nominal_current"] - m["no_load_current"])),
     _BRUSHED, 0.04, "brush friction changes with speed: 300 maxon motors within 3.5 %"),
    ("nominal torque of brushless motors", "not below k_t (I_N - I_0)", "nominal_torque", ">=",
     lambda m: _only(m, "brushless", m["torque_constant"] * (m["nominal_current"] - m["no_load_current"])),
     _BRUSHED, 0.0,
     "friction is greatest at no-load speed"),
    ("nominal torque without friction", "not above k_t I_N", "nominal_torque", "<=",
     lambda m: m["torque_constant"] * m["nominal_current"], ("torque_constant", "nominal_current"), 0.14,
     "slotted brushless motors, whose k_t is not one number: 29 of 642 maxon motors above, by up to 13 %"),
    ("nominal speed", "w_0 - gradient M_N", "nominal_speed", "=",
     lambda m: m["no_load_speed"] - m["speed_torque_gradient"] * m["nominal_torque"],
     ("no_load_speed", "speed_torque_gradient", "nominal_torque"), 0.18,
     "iron losses bend the line: brushless motors down to -17 %"),
    ("maximum efficiency", "(1 - sqrt(I_0 / I_A))^2", "max_efficiency", "=",
     lambda m: (1 - np.sqrt(m["no_load_current"] * m["resistance"] / m["nominal_voltage"])) ** 2,
     ("no_load_current", "resistance", "nominal_voltage"), 0.09,
     "friction at the best speed is not that at no load: 642 maxon motors within -8 and +7 %"),
    ("nominal current of brushed motors, from heat", "not above what R, R_th1, R_th2 and T_max bear, friction counted",
     "nominal_current", "<=", lambda m: _only(m, "brushed", _thermal(m, True)),
     (*_BRUSHED[:3], *_HEAT, "nominal_speed"), 0.03,
     "the copper's share of the housing's loss; brushes may set a lower one, so there is no lower bound"),
    ("nominal current, from heat", "not above what R, R_th1, R_th2 and T_max bear without any other loss",
     "nominal_current", "<=", lambda m: _thermal(m, False), _HEAT, 0.14,
     "thermal resistances are typical values: 29 of 334 brushless maxon motors above, by 13.7 %"),
]  # fmt: skip

# section, figure, relation, the figure it is compared with
_ORDERS: list[tuple[str, str, str, str]] = [
    ("motors", "nominal_speed", "<", "no_load_speed"),
    ("motors", "nominal_speed", "<=", "max_speed"),
    ("motors", "nominal_torque", "<", "stall_torque"),
    ("motors", "nominal_torque", "<=", "peak_torque"),
    ("motors", "nominal_current", "<", "stall_current"),
    ("motors", "no_load_current", "<", "nominal_current"),
    ("motors", "winding_time_constant", "<", "motor_time_constant"),
    ("motors", "ambient_min", "<", "ambient_max"),
    ("motors", "ambient_max", "<=", "max_winding_temperature"),
    ("motors", "price_5", "<=", "price"),
    ("motors", "price_20", "<=", "price_5"),
    ("gearheads", "intermittent_torque", ">=", "continuous_torque"),
    ("gearheads", "intermittent_power", ">=", "continuous_power"),
    ("gearheads", "intermittent_input_speed", ">=", "continuous_input_speed"),
    ("gearheads", "temperature_min", "<", "temperature_max"),
    ("gearheads", "price_5", "<=", "price"),
    ("gearheads", "price_20", "<=", "price_5"),
    ("encoders", "max_speed", "<=", "max_mechanical_speed"),
    ("controllers", "supply_min", "<", "supply_max"),
    ("controllers", "supply_max", "<=", "absolute_max"),
    ("controllers", "supply_min", ">=", "absolute_min"),
    ("controllers", "peak_current", ">=", "continuous_current"),
    ("controllers", "speed_loop", "<=", "current_loop"),
    ("controllers", "position_loop", "<=", "speed_loop"),
    ("controllers", "max_speed_sine", "<=", "max_speed_block"),
]

# section, figure, side, how many times its sisters' at most, reason
_BESIDE: list[tuple[str, str, Callable[[str], Side], float, str]] = [
    ("motors", "mass", _of_its_size, 6.0, "of the family's parts of that diameter: rotors of several lengths"),
    ("motors", "price", _of_its_size, 6.0, "of the family's parts of that diameter"),
    ("gearheads", "mass", _of_its_stages, 2.0, "of the family's parts with as many stages"),
    ("gearheads", "length", _of_its_stages, 2.0, "of the family's parts with as many stages"),
    ("gearheads", "efficiency", _of_its_stages, 1.25, "of the family's parts with as many stages"),
    ("gearheads", "continuous_torque", _of_its_stages, 4.0, "of the family's parts with as many stages"),
    ("gearheads", "price", _of_its_stages, 3.0, "of the family's parts with as many stages"),
]

_RATE = "francs for a euro from 2010 on, and what the shop rounds"

# section, name, figure, expected, least and most share of it, other figures, reason
_BANDS: list[tuple[str, str, str, Side, float, float, tuple[str, ...], str]] = [
    ("motors", "assigned power beside M_N w_N", "assigned_power",
     lambda m: m["nominal_torque"] * m["nominal_speed"], 0.4, 4.0, ("nominal_torque", "nominal_speed"),
     "a class of the type and not a figure of the winding: 0.55 to 3.2 of 641 maxon motors"),
    ("motors", "mass beside volume", "mass", _cylinder, 1500.0, 9000.0, ("diameter", "length"),
     "kg/m^3: hollow plastic and solid copper"),
    ("motors", "mass beside diameter", "mass", lambda m: m["diameter"] ** 3, 300.0, 25000.0, ("diameter",),
     "kg/m^3: a flat ring and five diameters of steel; 850 to 18200 of 643 maxon motors"),
    ("motors", "rotor inertia beside the whole motor's", "rotor_inertia",
     lambda m: m["mass"] * m["diameter"] ** 2 / 4, 0.003, 1.0, ("mass", "diameter"),
     "of a ring with all its mass at the rim; 0.01 to 0.32 of 643 maxon motors"),
    ("motors", "heat capacity of the winding", "winding_time_constant",
     lambda m: m["thermal_resistance_winding"] * m["mass"] * 390, 0.01, 0.5, ("thermal_resistance_winding", "mass"),
     "of the motor's mass in copper, 390 J/kg K; 0.02 to 0.17 of 642 maxon motors"),
    ("motors", "heat capacity of the housing", "motor_time_constant",
     lambda m: m["thermal_resistance_housing"] * m["mass"] * 450, 0.05, 2.5, ("thermal_resistance_housing", "mass"),
     "of the motor's mass in steel, 450 J/kg K; 0.1 to 1.8 of 642 maxon motors"),
    ("gearheads", "mass beside volume", "mass", _cylinder, 1000.0, 12000.0, ("diameter", "length"),
     "kg/m^3: plastic; steel, and the flange and the pinion that the length leaves out"),
    ("motors", "francs beside euros", "list_price", lambda t: t["price"], 0.9, 1.5, ("price",), _RATE),
    ("gearheads", "francs beside euros", "list_price", lambda t: t["price"], 0.9, 1.5, ("price",), _RATE),
]  # fmt: skip

# figure, and whether a further stage may make it smaller or greater
_STAGES = [("continuous_torque", ">="), ("intermittent_torque", ">="), ("efficiency", "<="), ("mass", ">="),
           ("length", ">=")]  # fmt: skip

# section, figure: below 1 (a share)
_SHARES = [("motors", "max_efficiency"), ("gearheads", "efficiency"), ("controllers", "max_efficiency")]

_WHOLE = [("motors", "pole_pairs"), ("motors", "phases"), ("motors", "commutator_segments"), ("gearheads", "stages"),
          ("encoders", "counts_per_turn"), ("encoders", "channels")]  # fmt: skip

# thermal_resistance_winding: motors of which only winding to ambient is known have it in the housing's;
# stages: 0 stands for no gearhead at all
_MAY_BE_ZERO = {"thermal_resistance_winding", "friction_torque", "viscous_friction", "backlash", "voltage_drop",
                "stages", "direction", "price", "price_5", "price_20", "list_price", "added_length",
                "inertia"}  # fmt: skip

_OTHERS = (
    Law(section="gearheads", name="printed reduction", meaning="the reduction is the ratio, rounded", figure="ratio",
        relation="=", expected=_printed_reduction, fields=("reduction",), allowance=0.03,
        reason="half of the last digit of the reductions from 17:1 on; 4.8:1 and the like come nearer"),
    Law(section="gearheads", name="ratio per stage, at least", meaning="1.5 to the power of the stages at least",
        figure="ratio", relation=">=", expected=lambda g: np.where(g["stages"] > 0, 1.5 ** g["stages"], np.nan),
        fields=("stages",), reason="2.1 to 6.75 of 2215 maxon gearheads, Faulhaber from 1.76", source=USAGE),
    Law(section="gearheads", name="ratio per stage, at most", meaning="10 to the power of the stages at most",
        figure="ratio", relation="<=", expected=lambda g: _of_toothed_stages(g, 10.0), fields=("stages", "kind"),
        reason="beyond, planets would touch; other kinds have no such bound", source=USAGE),
    Law(section="gearheads", name="efficiency per stage, at least", meaning="0.75 to the power of the stages at least",
        figure="efficiency", relation=">=", expected=lambda g: _of_toothed_stages(g, 0.75), fields=("stages", "kind"),
        reason="0.80 to 0.97 of 2215 maxon gearheads", source=USAGE),
    Law(section="gearheads", name="direction", meaning="every spur stage turns it round, a planetary stage does not",
        figure="direction", relation="=", expected=_direction, fields=("kind", "stages"), rounds=False,
        reason="none: a sign"),
    Law(section="encoders", name="speed at the greatest frequency", meaning="not above 60 f / counts",
        figure="max_speed", relation="<=", expected=lambda e: 2 * np.pi * e["max_frequency"] / e["counts_per_turn"],
        fields=("max_frequency", "counts_per_turn"), reason=f"{ROUNDED}; the bearing may set a lower one"),
)  # fmt: skip


def _motor_laws() -> Iterator[Law]:
    for name, meaning, figure, relation, expected, fields, allowance, reason in _MOTOR_LAWS:
        yield Law(section="motors", name=name, meaning=meaning, figure=figure, relation=relation, expected=expected,
                  fields=fields, allowance=allowance, reason=reason, source=HANDBOOK)  # fmt: skip


def _orders() -> Iterator[Law]:
    """Figures of one part in their order; printed figures are in it themselves, so rounding has no say."""
    words = {"<": "below", "<=": "not above", ">=": "not below"}
    for section, figure, relation, other in _ORDERS:
        yield Law(section=section, name=f"{_words(figure)} and {_words(other)}", figure=figure, relation=relation,
                  meaning=f"{words[relation]} {_words(other)}", expected=_column(other), fields=(other,), rounds=False,
                  reason="none: rounding keeps the order")  # fmt: skip


def _bands() -> Iterator[Law]:
    for section, name, figure, side, least, most, fields, reason in _BANDS:
        for relation, share, word in ((">=", least, "least"), ("<=", most, "most")):
            yield Law(section=section, name=f"{name}, at {word}", meaning=f"{share:g} of it at {word}", figure=figure,
                      relation=relation, expected=_times(share, side), fields=fields, reason=reason,
                      source=BODY if "mass" in (figure, *fields) else USAGE)  # fmt: skip


def _families() -> Iterator[Law]:
    for section, figure, side, times, reason in _BESIDE:
        for relation, share, word in ((">=", 1 / times, "least"), ("<=", times, "most")):
            yield Law(section=section, name=f"{_words(figure)} beside its sisters', at {word}", figure=figure,
                      meaning=f"{share:.3g} of the median at {word}", relation=relation, fields=("family",),
                      expected=_times(share, side(figure)), rounds=False, reason=reason, source=USAGE)  # fmt: skip
    for figure, relation in _STAGES:
        word, how = ("least", np.min) if relation == ">=" else ("greatest", np.max)
        yield Law(section="gearheads", name=f"{_words(figure)} by stages", figure=figure, relation=relation,
                  meaning=f"against the family's {word} with one stage less", fields=("stages",), rounds=False,
                  expected=_one_stage_less(figure, how), reason="none: a stage more", source=USAGE)  # fmt: skip


def _numbers() -> Iterator[Law]:
    """What a number of that kind cannot be."""
    for section, figure in _SHARES:
        yield Law(section=section, name=f"{_words(figure)} is a share", meaning="below 1", figure=figure, relation="<",
                  expected=_number(1.0), fields=(), rounds=False, reason="none")  # fmt: skip
    for section, figure in _WHOLE:
        yield Law(section=section, name=f"{_words(figure)} is a whole number", meaning="whole", figure=figure,
                  relation="=", expected=_whole(figure), fields=(), rounds=False, reason="none")  # fmt: skip
    for section in PARTS:
        for column in columns_of(section).values():
            if column.kind not in ("text", "temperature") and column.name not in _MAY_BE_ZERO:
                yield Law(section=section, name=f"{_words(column.name)} is above zero", meaning="0 is not unknown (~)",
                          figure=column.name, relation=">", expected=_number(0.0), fields=(), rounds=False,
                          reason="none")  # fmt: skip


def _words(name: str) -> str:
    return name.replace("_", " ")


def _number(value: float) -> Side:
    """The same number for every part but a gearhead of no stages, which stands for no gearhead at all."""

    def values(table: Table[Any]) -> Numbers:
        found = np.full(len(table), value)
        return np.where(table["stages"] == 0, np.nan, found) if "stages" in table.columns else found

    return values


def _column(name: str) -> Side:
    return lambda table: table[name]


def _whole(name: str) -> Side:
    return lambda table: np.round(table[name])


def _times(share: float, side: Side) -> Side:
    return lambda table: share * side(table)


LAWS: tuple[Law, ...] = (*_motor_laws(), *_orders(), *_OTHERS, *_bands(), *_families(), *_numbers())
