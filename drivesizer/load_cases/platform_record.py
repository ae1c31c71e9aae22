"""The platform of a spec as the record that kinematics and dynamics take: section and load put together."""

from __future__ import annotations

from dataclasses import replace

from drivesizer.errors import InputError
from drivesizer.loads.wheeled_vehicle import WheeledVehicle, rolling_resistance, turning_inertia
from drivesizer.platform import wheels
from drivesizer.spec.platform import Platform
from drivesizer.units import show

__all__ = ["box_inertia", "platform_assumptions", "platform_of"]


def platform_of(section: Platform, load: WheeledVehicle, rotor_inertia: float = 0.0) -> wheels.Platform:
    """The platform with its payloads, of the load's mass."""
    driven = sum(place.driven for place in section.places)
    if driven != load.driven_wheels:
        raise InputError(f"platform: {driven} of its wheels are driven, load.driven_wheels is {load.driven_wheels}")
    C_rr = rolling_resistance(load)
    common = {"inertia": turning_inertia(load), "rolling_resistance": C_rr}
    placed = [place.record(load.wheel_diameter / 2, **common) for place in section.places]
    turned = (replace(w, rotor_inertia=rotor_inertia) if w.drive == "motor" else w for w in placed)
    rolling = (w if w.held else replace(w, roller_resistance=section.roller_resistance) for w in turned)
    centre, own = section.centre_of_mass, _own_mass(section, load)
    empty = wheels.Platform(
        wheels=tuple(rolling),
        mass=own,
        inertia=box_inertia(section, own) if section.inertia is None else section.inertia,
        x=centre.x,
        y=centre.y,
        height=centre.height or 0.0,
        casters=tuple(
            wheels.Caster(
                x=c.x, y=c.y, rolling_resistance=C_rr if c.rolling_resistance is None else c.rolling_resistance
            )
            for c in section.casters
        ),
    )
    carried = (
        wheels.Payload(mass=p.mass, x=p.x, y=p.y, height=p.height or 0.0, inertia=p.inertia) for p in section.payloads
    )
    whole = wheels.loaded(empty, *carried)
    for number in dict.fromkeys(section.failed):
        whole = wheels.without_motor(whole, number, blocked=section.blocked)
    return whole


def _own_mass(section: Platform, load: WheeledVehicle) -> float:
    """Mass of the robot without its payloads [kg]."""
    carried = sum(p.mass for p in section.payloads)
    if not carried < load.mass:
        found, of_all = show(carried, "kg", "mass"), show(load.mass, "kg", "mass")
        raise InputError(f"platform: payloads of {found} leave nothing of load.mass, {of_all}, which includes them")
    return load.mass - carried


def box_inertia(section: Platform, mass: float) -> float:
    """Inertia of a homogeneous box of the robot's size about its vertical axis, m (L² + W²) / 12 [kg*m^2]."""
    assert section.size is not None
    return mass * (section.size.length**2 + section.size.width**2) / 12.0


def platform_assumptions(section: Platform, load: WheeledVehicle) -> tuple[str, ...]:
    """Assumptions about the platform where the spec gives no figure, as sentences."""
    found = []
    if section.inertia is None:
        inertia = show(box_inertia(section, _own_mass(section, load)), "kg*m^2", "inertia")
        found.append(f"The robot's inertia is that of a homogeneous box of its size without payloads, {inertia}.")
    if not section.height_known:
        found.append("The height of the centre of mass is not given: wheels are taken to carry what they do at rest.")
    if any(not place.driven for place in section.places):
        found.append("A wheel without a drive has the inertia of one with.")
    if any(c.rolling_resistance is None for c in section.casters):
        found.append("Casters roll as hard as the wheels.")
    return tuple(found)
