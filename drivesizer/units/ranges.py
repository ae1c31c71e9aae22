"""Ranges of figures of machines: for each kind of quantity the one that a user's figure must lie in.

A rotor of 5e-324 kg·m² or a torque of 1e300 N·m is a slip of the pen, and behind the door it ends in a division by
zero or in a unbounded number. The ranges reach some powers of ten beyond what is built, from watch motors to ship
drives, so that no real figure is refused; products of figures inside them stay in the range of floats.
"""

from __future__ import annotations

from typing import Any

__all__ = ["AT_MOST", "MAY_BE_ZERO", "RANGES", "outside"]

# kind -> the smallest magnitude but 0, and the largest, in SI
RANGES: dict[str, tuple[float, float]] = {
    "length": (1e-9, 1e7),
    "mass": (1e-7, 1e8),
    "inertia": (1e-15, 1e9),
    "torque": (1e-10, 1e9),
    "energy": (1e-10, 1e13),
    "power": (1e-10, 1e10),
    "force": (1e-10, 1e9),
    "speed": (1e-12, 1e5),
    "rotary_speed": (1e-12, 1e6),
    "frequency": (1e-6, 1e10),
    "acceleration": (1e-12, 1e7),
    "angular_acceleration": (1e-12, 1e10),
    "jerk": (1e-12, 1e12),
    "angular_jerk": (1e-12, 1e15),
    "area": (1e-12, 1e8),
    "capacitance": (1e-15, 1e6),
    "time": (1e-9, 1e10),
    "voltage": (1e-6, 1e6),
    "current": (1e-9, 1e6),
    "charge": (1e-6, 1e9),
    "resistance": (1e-8, 1e8),
    "inductance": (1e-10, 1e4),
    "torque_constant": (1e-7, 1e5),
    "back_emf_constant": (1e-7, 1e5),
    "speed_constant": (1e-5, 1e7),
    "speed_torque_gradient": (1e-9, 1e15),
    "thermal_resistance": (1e-5, 1e6),
    "heat_capacity": (1e-7, 1e9),
    "current_per_temperature": (1e-9, 1e6),
    "temperature": (1.0, 3e3),
    "temperature_difference": (1e-6, 3e3),
    "angle": (1e-9, 1e9),
    "density": (1e-4, 1e6),
    "stiffness": (1e-6, 1e13),
    "torsional_stiffness": (1e-9, 1e13),
    "damping": (1e-15, 1e7),
    "dimensionless": (1e-12, 1e12),
    "ratio": (1e-5, 1e7),
    "price": (1e-6, 1e12),
    "price_chf": (1e-6, 1e12),
}

# figures of parts that may be 0: what a part has none of; any other figure of 0 is unknown, and written ~
MAY_BE_ZERO = frozenset({
    "added_length", "ambient_max", "ambient_min", "axial_play", "backlash", "commutator_segments", "coulomb_friction",
    "current_draw",
    "direction", "friction_torque", "inertia", "load_friction", "mass", "max_axial_load", "max_press_fit",
    "max_radial_load", "no_load_current", "no_load_torque", "phases", "pole_pairs", "price", "price_5", "price_20",
    "list_price", "foreign_price", "radial_load_distance", "stages",
    "thermal_resistance_winding", "viscous_friction", "voltage_drop", "bearing_distance",
})  # fmt: skip

# figures of parts that have an end by what they are
AT_MOST = {"efficiency": 1.0, "max_efficiency": 1.0, "max_duty": 1.0, "direction": 1.0}


def outside(values: Any, kind: str) -> Any:
    """Whether an SI figure of a kind (a float, or an array of them) lies outside its range; 0 and the unknown do not.

    Parameters
    ----------
    values
        The figure, or an array of them [SI].
    kind
        A key of :data:`RANGES`.

    Returns
    -------
    bool or array of bool, in the shape of ``values``.

    Examples
    --------
    >>> [outside(figure, "inertia") for figure in (0.0, 5e-324, 1e-5, 1e300)]
    [False, True, False, True]
    """
    least, most = RANGES[kind]
    size = abs(values)
    return (size > most) | ((size < least) & (size > 0.0))
