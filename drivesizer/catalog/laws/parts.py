"""Laws of motors, gearheads, encoders and controllers, as tables; and the tuple of all laws."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from drivesizer.catalog.identities import IDENTITIES, solved
from drivesizer.catalog.laws.law import (
    HANDBOOK,
    ROUNDED,
    USAGE,
    Band,
    Beside,
    Formula,
    Law,
    Numbers,
    Side,
    above_zero,
    across_offers,
    against_similar,
    bands,
    cylinder,
    formulas,
    groups,
    only,
    orders,
    per_stage,
    reductions,
    shares,
    usual,
    whole_numbers,
    words,
)
from drivesizer.catalog.laws.more_parts import LAWS_OF_MORE_PARTS
from drivesizer.catalog.tables import Table
from drivesizer.physics.thermal import continuous_current, nominal_current, rated_ambient, resistance_25

__all__ = ["LAWS"]

# --- sides that take more than a formula -----------------------------------------------------------------------------

_of_its_size = usual("family", "diameter")
_of_its_stages = usual("family", "version", "stages")


def _one_stage_less(figure: str, how: Callable[[Numbers], Any]) -> Side:
    """The least or greatest figure of the same gearhead with the next lower number of stages."""

    def values(table: Table[Any]) -> Numbers:
        group, stages = groups(table, "family", "version", "diameter"), table["stages"]
        found = np.full(len(table), np.nan)
        for k in range(int(group.max(initial=-1)) + 1):
            counts = np.unique(stages[(group == k) & ~np.isnan(stages)])
            for less, more in pairwise(counts):
                lesser = across_offers(table, figure, (group == k) & (stages == less), how)
                found[(group == k) & (stages == more)] = lesser
        return found

    return values


def _direction(table: Table[Any]) -> Numbers:
    """Sign of the ratio: every spur stage reverses it, a planetary stage with a fixed ring does not."""
    odd = np.where(np.isnan(table["stages"]), np.nan, 1.0 - 2.0 * (table["stages"] % 2))
    return np.where(table["kind"] == "planetary", 1.0, only(table, "spur", odd))


def _k_e(m: Table[Any]) -> Numbers:
    """The printed back-EMF constant; k_t where none is."""
    return np.where(np.isnan(m["back_emf_constant"]), m["torque_constant"], m["back_emf_constant"])


def _thermal(m: Table[Any], housing_loss: bool) -> Numbers:
    """Continuous current that the thermal figures permit."""
    th1, th2, hot = m["thermal_resistance_winding"], m["thermal_resistance_housing"], m["max_winding_temperature"]
    if housing_loss:
        flow = (m["torque_constant"], m["no_load_current"], m["nominal_speed"])
        return np.asarray(nominal_current(resistance_25(m), th1, th2, hot, *flow, rated_ambient(m)))
    return np.asarray(continuous_current(resistance_25(m), th1, th2, hot, rated_ambient(m)))


def _continuous_torque(m: Table[Any]) -> Numbers:
    """Continuous torque at nominal speed: parabola through those at 0, half and full permissible speed."""
    x = m["nominal_speed"] / m["max_speed"]
    curve = (
        m["standstill_torque"] * (1 - x) * (1 - 2 * x)
        + m["half_speed_torque"] * 4 * x * (1 - x)
        + m["top_speed_torque"] * x * (2 * x - 1)
    )
    return np.where(x <= 1, curve, np.nan)


# --- tables ----------------------------------------------------------------------------------------------------------

_ARC_MINUTE = np.pi / 180 / 60
_HEAT = ("resistance", "thermal_resistance_winding", "thermal_resistance_housing", "max_winding_temperature")
_BRUSHED = ("kind", "torque_constant", "no_load_current", "nominal_current")
_CURVE = ("standstill_torque", "half_speed_torque", "top_speed_torque", "nominal_speed", "max_speed")

_NOMINAL_TORQUE = IDENTITIES["motors"]["nominal torque of brushed motors"]
_MOTOR_LAWS: list[Formula] = [
    ("speed constant", "k_n = 1 / k_e", "speed_constant", "=",
     None, ("torque_constant",), 0.0, ROUNDED),
    ("back-EMF constant", "k_e = k_t", "back_emf_constant", "=",
     None, ("torque_constant",), 0.05,
     "the magnets' temperature and the sine's share of the voltage; more is a k_t of stall, or of other amperes"),
    ("stall current", "I_A = V / R", "stall_current", "=",
     None, ("nominal_voltage", "resistance"), 0.0, ROUNDED),
    ("stall torque", "M_H = k_t I_A", "stall_torque", "=",
     None, ("torque_constant", "stall_current"), 0.0, ROUNDED),
    ("speed-torque gradient", "R / (k_t k_e)", "speed_torque_gradient", "=",
     None,
     ("resistance", "torque_constant", "torque_constant"), 0.0, ROUNDED),
    ("mechanical time constant", "J R / (k_t k_e)", "mechanical_time_constant", "=",
     None,
     ("rotor_inertia", "resistance", "torque_constant", "torque_constant"), 0.0, ROUNDED),
    ("no-load speed", "(V - I_0 R) / k_e", "no_load_speed", "=",
     None,
     ("nominal_voltage", "no_load_current", "resistance", "torque_constant"), 0.045,
     "brush drop and the choke of a driver are not in it: 95 % of 642 maxon motors within 1 %, the worst 3.9 %"),
    ("no-load speed without its current", "not above V / k_e", "no_load_speed", "<=",
     lambda m: np.where(np.isnan(m["no_load_current"]), m["nominal_voltage"] / _k_e(m), np.nan),
     ("nominal_voltage", "torque_constant"), 0.045, "as for the no-load speed"),
    ("friction", "I_0 = (M_R + c w_0) / k_t", "no_load_current", "=",
     None,
     ("friction_torque", "viscous_friction", "no_load_speed", "torque_constant"), 0.1,
     "friction is printed as a typical value"),
    ("nominal torque of brushed motors", "k_t (I_N - I_0)", "nominal_torque", "=",
     lambda m: only(m, "brushed", solved(_NOMINAL_TORQUE, m.columns, "nominal_torque")),
     _BRUSHED, 0.04, "brush friction changes with speed: 300 maxon motors within 3.5 %"),
    ("nominal torque of brushless motors", "not below k_t (I_N - I_0)", "nominal_torque", ">=",
     lambda m: only(m, "brushless", solved(_NOMINAL_TORQUE, m.columns, "nominal_torque")),
     _BRUSHED, 0.0,
     "friction is greatest at no-load speed"),
    ("nominal torque without friction", "not above k_t I_N", "nominal_torque", "<=",
     lambda m: m["torque_constant"] * m["nominal_current"], ("torque_constant", "nominal_current"), 0.14,
     "slotted brushless motors, whose k_t is not one number: 29 of 642 maxon motors above, by up to 13 %"),
    ("nominal speed", "w_0 - gradient M_N", "nominal_speed", "=",
     None,
     ("no_load_speed", "speed_torque_gradient", "nominal_torque"), 0.18,
     "iron losses bend the line: brushless motors down to -17 %"),
    ("maximum efficiency", "(1 - sqrt(I_0 / I_A))^2", "max_efficiency", "=",
     None,
     ("no_load_current", "resistance", "nominal_voltage"), 0.09,
     "friction at the best speed is not that at no load: 642 maxon motors within -8 and +7 %"),
    ("nominal current of brushed motors, from heat", "not above what R, R_th1, R_th2 and T_max permit with friction",
     "nominal_current", "<=", lambda m: only(m, "brushed", _thermal(m, True)),
     (*_BRUSHED[:3], *_HEAT, "nominal_speed"), 0.03,
     "the copper's share of the housing's loss; brushes may set a lower one, so there is no lower bound"),
    ("nominal current, from heat", "not above what R, R_th1, R_th2 and T_max permit without any other loss",
     "nominal_current", "<=", lambda m: _thermal(m, False), _HEAT, 0.14,
     "thermal resistances are typical values: 29 of 334 brushless maxon motors above, by 13.7 %"),
]  # fmt: skip

# the orders of two figures, by section
_ORDERS = {
    "motors": (
        "nominal_speed < no_load_speed", "nominal_speed <= max_speed", "nominal_torque < stall_torque",
        "nominal_torque <= peak_torque", "nominal_current < stall_current", "no_load_current < nominal_current",
        "winding_time_constant < motor_time_constant", "ambient_min < ambient_max",
        "ambient_max <= max_winding_temperature", "half_speed_torque <= standstill_torque",
        "top_speed_torque <= half_speed_torque", "shaft_diameter < diameter", "price_5 <= price", "price_20 <= price_5",
    ),
    "gearheads": (
        "intermittent_torque >= continuous_torque", "emergency_torque >= intermittent_torque",
        "emergency_torque >= continuous_torque", "intermittent_power >= continuous_power",
        "ratcheting_torque >= emergency_torque", "median_life >= rated_life",
        "bearing_static_load >= bearing_dynamic_load",
        "intermittent_input_speed >= continuous_input_speed", "temperature_min < temperature_max", "price_5 <= price",
        "price_20 <= price_5",
    ),
    "encoders": ("max_speed <= max_mechanical_speed",),
    "controllers": (
        "supply_min < supply_max", "supply_max <= absolute_max", "supply_min >= absolute_min",
        "peak_current >= continuous_current", "speed_loop <= current_loop", "position_loop <= speed_loop",
        "max_speed_sine <= max_speed_block", "full_current_ambient < ambient_max", "reduced_power < max_power",
        "max_power_voltage < reduced_power_voltage",
    ),
}  # fmt: skip

_BESIDE: list[Beside] = [
    ("motors", "mass", _of_its_size, 6.0, "of the family's parts of that diameter: rotors of several lengths"),
    ("motors", "price", _of_its_size, 6.0, "of the family's parts of that diameter"),
    ("gearheads", "mass", _of_its_stages, 2.0, "of the family's parts with as many stages"),
    ("gearheads", "length", _of_its_stages, 2.0, "of the family's parts with as many stages"),
    ("gearheads", "efficiency", _of_its_stages, 1.25, "of the family's parts with as many stages"),
    ("gearheads", "continuous_torque", _of_its_stages, 4.0, "of the family's parts with as many stages"),
    ("gearheads", "price", _of_its_stages, 3.0, "of the family's parts with as many stages"),
]

_RATE = "francs for a euro from 2010 on, and what the shop rounds"

_BANDS: list[Band] = [
    ("controllers", "continuous current beside its derating", "continuous_current",
     lambda c: c["derating_slope"] * (c["ambient_max"] - c["full_current_ambient"]), 0.98, 1e3,
     ("derating_slope", "ambient_max", "full_current_ambient"),
     "no more is taken off up to the largest ambient than there is: 3 of maxon lose all of it"),
    ("motors", "assigned power beside M_N w_N", "assigned_power",
     lambda m: m["nominal_torque"] * m["nominal_speed"], 0.4, 4.0, ("nominal_torque", "nominal_speed"),
     "a class of the type and not a figure of the winding: 0.55 to 3.2 of 641 maxon motors"),
    ("motors", "nominal torque beside the operating range", "nominal_torque", _continuous_torque, 0.93, 1.18, _CURVE,
     "of the parabola through the torques at speed 0, half and top: 0.96 to 1.16 of 602 maxon motors, median 1.07"),
    ("motors", "mass beside volume", "mass", cylinder, 1500.0, 9000.0, ("diameter", "length"),
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
    ("gearheads", "mass beside volume", "mass", cylinder, 1000.0, 12000.0, ("diameter", "length"),
     "kg/m^3: plastic; steel, and the flange and the pinion that the length leaves out"),
    ("gearheads", "no-load torque beside continuous torque / ratio", "no_load_torque",
     lambda g: g["continuous_torque"] / g["ratio"], 0.005, 1.0, ("continuous_torque", "ratio"),
     "seals and oil; 0.02 to 0.48 of 156 Wittenstein gearheads; at 1 the rated torque would only turn it back"),
    ("gearheads", "twist at continuous torque", "stiffness", lambda g: g["continuous_torque"] / _ARC_MINUTE,
     1 / 60, 1 / 0.3, ("continuous_torque",), "0.3 to 60 arcmin; 1.8 to 8.6 of 119 gearheads of four makers"),
    ("gearheads", "lever of the tilting moment", "max_tilting_moment", lambda g: g["max_radial_load"], 0.005, 1.0,
     ("max_radial_load",), "m, from the bearing: 0.05 to 0.17 of 36 Wittenstein gearheads"),
    ("motors", "francs beside euros", "list_price", lambda t: t["price"], 0.9, 1.5, ("price",), _RATE),
    ("gearheads", "francs beside euros", "list_price", lambda t: t["price"], 0.9, 1.5, ("price",), _RATE),
]  # fmt: skip

# figure, and whether a further stage may make it smaller or greater
_STAGES = [("continuous_torque", ">="), ("intermittent_torque", ">="), ("efficiency", "<="), ("mass", ">="),
           ("length", ">=")]  # fmt: skip

# section, figure: below 1 (a share)
_SHARES = [("motors", "max_efficiency"), ("gearheads", "efficiency"), ("controllers", "max_efficiency")]

_WHOLE = [("motors", "pole_pairs"), ("motors", "phases"), ("motors", "commutator_segments"), ("gearheads", "stages"),
          ("encoders", "counts_per_turn"), ("encoders", "steps_per_turn"), ("encoders", "channels")]  # fmt: skip

# thermal_resistance_winding: motors of which only winding to ambient is known have it in the housing's;
# stages: 0 is direct drive
_MAY_BE_ZERO = {"thermal_resistance_winding", "friction_torque", "viscous_friction", "backlash", "axial_play",
                "voltage_drop", "stages", "direction", "price", "price_5", "price_20", "list_price", "added_length",
                "inertia", "bearing_distance"}  # fmt: skip

_OTHERS = (
    Law(section="gearheads", name="efficiency per stage, at least", meaning="0.75 to the power of the stages at least",
        figure="efficiency", relation=">=", expected=lambda g: per_stage(g, "kind", 0.75),
        fields=("stages", "kind"), reason="0.80 to 0.97 of 2215 maxon gearheads", source=USAGE),
    Law(section="gearheads", name="direction", meaning="every spur stage turns it round, a planetary stage does not",
        figure="direction", relation="=", expected=_direction, fields=("kind", "stages"), rounds=False,
        reason="none: a sign"),
    Law(section="encoders", name="speed at the greatest frequency", meaning="not above 60 f / counts",
        figure="max_speed", relation="<=", expected=lambda e: 2 * np.pi * e["max_frequency"] / e["counts_per_turn"],
        fields=("max_frequency", "counts_per_turn"), reason=f"{ROUNDED}; the bearing may set a lower one"),
)  # fmt: skip


def _stage_laws() -> Iterator[Law]:
    for figure, relation in _STAGES:
        word, how = ("least", np.min) if relation == ">=" else ("greatest", np.max)
        yield Law(section="gearheads", name=f"{words(figure)} by stages", figure=figure, relation=relation,
                  meaning=f"against the family's {word} with one stage less", fields=("stages",), rounds=False,
                  expected=_one_stage_less(figure, how), reason="none: a stage more", source=USAGE)  # fmt: skip


LAWS: tuple[Law, ...] = (
    *formulas("motors", _MOTOR_LAWS, HANDBOOK),
    *orders(_ORDERS),
    *reductions("gearheads", "kind"),
    *_OTHERS,
    *bands(_BANDS),
    *against_similar(_BESIDE),
    *_stage_laws(),
    *shares(_SHARES),
    *whole_numbers(_WHOLE),
    *LAWS_OF_MORE_PARTS,
    *above_zero(_MAY_BE_ZERO),
)
