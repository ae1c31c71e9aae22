"""Figures of a spec with tolerances: which enter checks beside the load cycle, and which have no effect on any.

A figure shapes the load cycle of each sample, or enters checks as a column, or neither. Whether it has an effect on a
machine is seen from its checks, with that figure alone at either end (``without_effect``).
"""

from __future__ import annotations

from drivesizer.files.yaml_source import Path_

__all__ = ["COLUMNS", "NOT_SAMPLED", "enters_checks", "reason"]

COLUMNS = {
    "load": {"pinion_diameter", "pulley_diameter", "drum_diameter", "efficiency", "rope_efficiency"},  # of shaft loads
    "transmission": {"efficiency", "back_efficiency", "ratio", "stiffness", "max_tension", "max_speed", "backlash",
                     "pinion_diameter", "pulley_diameter"},
    "supply": {"nominal", "min", "max", "resistance", "current", "power", "peak_current", "regeneration",
               "capacitance"},
    "brake_resistor": {"chopper_voltage"},
    "power_stage": {"voltage_drop", "resistance", "standby"},
    "environment": {"ambient"},
    "needs": {"radial_load", "backlash_at_load", "inertia_ratio", "resonance", "resolution_at_load", "life",
              "shock_torque", "axial_load", "tilting_moment", "start_speed"},
    "brake": {"torque", "dynamic_torque", "inertia", "power", "holding_power", "engage_time", "max_speed",
              "energy_per_stop", "total_energy"},
    "shaft": {"distance", "wheel_load", "belt_pretension", "load_factor", "static_safety", "pressure_angle",
              "helix_angle"},
    "battery": {"nominal_voltage", "capacity", "rated_time", "peukert_exponent", "resistance", "open_circuit",
                "peak_current", "start", "usable", "health", "autonomy", "range"},
    "mission": {"duration"},
    "equipment": {"power", "peak_power", "efficiency", "duty", "time"},
}  # fmt: skip
_BUDGET = "budgets of the machine are at nominal figures"
_MARGIN = "a required margin is no figure of the machine"
_LOOP = "loops are designed at nominal figures"
_SIZE = "sums of length, mass and price are at nominal figures"
NOT_SAMPLED = {  # figures whose tolerance has no effect on any sampled check, by section, or by section and field
    "brake_resistor": "the brake resistor is checked at nominal figures",
    "supply.peak_time": "the power supply's peak and trip are checked at nominal figures",
    "supply.overvoltage_trip": "the power supply's peak and trip are checked at nominal figures",
    "brake.voltage": "no check depends on it", "brake.release_time": "no check depends on it",
    "brake.mass": _SIZE, "brake.length": _SIZE, "brake.price": _SIZE, "transmission.mass": _SIZE,
    "needs.mass": _SIZE, "needs.length": _SIZE, "needs.price": _SIZE, "needs.diameter": _SIZE,
    "needs.holding_factor": _MARGIN, "margins": _MARGIN,
    "needs.bandwidth": _LOOP, "control": _LOOP, "plant": "of the closed loop alone",
    "mounting": "the mounting is in all samples as in the nominal one",
    "environment.altitude": "derating by altitude is that of the nominal one",
    "paper_factors": "the paper's factors do not enter the physics",
    "requirements": "what is required is no figure of the machine",
    "budget": _BUDGET, "battery": "of the battery autonomy, range, peak and voltage are sampled",
    **dict.fromkeys(
        ("platform.size", "platform.passages", "platform.misjudged", "platform.following"),
        "of a platform its motion is sampled, not its room, footing and controller",
    ),
}  # fmt: skip


def _field(path: Path_) -> str:
    """Field of a section, or of a stage, consumer or wheel in its list."""
    return str(next((step for step in path[1:] if isinstance(step, str)), ""))


def enters_checks(path: Path_) -> bool:
    """Whether a figure enters checks beside the load cycle.

    >>> enters_checks(("supply", "min")), enters_checks(("transmission", 1, "mass"))
    (True, False)
    """
    return _field(path) in COLUMNS.get(str(path[0]), set())


def reason(path: Path_) -> str:
    """Reason for which a tolerance has no effect on a sampled check; empty where it has one on some machines.

    >>> reason(("margins", "torque")), reason(("supply", "min"))
    ('a required margin is no figure of the machine', '')
    """
    section, field = str(path[0]), _field(path)
    if enters_checks(path):
        return ""
    return NOT_SAMPLED.get(f"{section}.{field}", NOT_SAMPLED.get(section, ""))
