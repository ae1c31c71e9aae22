"""A screw out of a catalogue in the machine that it moves."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import isnan
from typing import TYPE_CHECKING, Any

from drivesizer.catalog.more_parts import Screw
from drivesizer.loads.kinds import MODULES
from drivesizer.physics.elements.screw import shaft_mass
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

if TYPE_CHECKING:
    from drivesizer.loads.screw import Screw as ScrewLoad

__all__ = ["ChosenScrew", "chosen_of", "for_drive", "leaves_open", "screw_figures", "wants_screw", "with_screw"]

_DESIGNS = {"THK": "THK", "HIWIN": "HIWIN", "Bosch Rexroth": "Rexroth"}  # makers that print factors of their own
_RATINGS = (
    "diameter", "root_diameter", "ball_diameter", "pitch_diameter", "shaft_diameter", "dynamic_load", "static_load",
    "permissible_thrust", "dn_max",
)  # fmt: skip

# ratings without which a check is unknown, by kind of screw; the others it need not have
_CHECKED = {"ball": ("dynamic_load", "static_load", "dn_max"), "": ("permissible_thrust", "dynamic_load")}


@dataclass(frozen=True, slots=True, kw_only=True)
class ChosenScrew:
    """A nut with its shaft, as long as the machine needs."""

    screw: Screw  # its mass that of nut and shaft
    length: float  # m, of the shaft with its ends
    shaft_mass: float  # kg

    @property
    def least_mass(self) -> float:
        """Mass of shaft and nut, as far as it is known [kg]."""
        return self.shaft_mass if isnan(self.screw.mass) else self.screw.mass

    @property
    def running(self) -> str:
        """Size of the screw, in words."""
        size = " x ".join(show(x, "mm", "length") for x in (self.screw.diameter, self.screw.lead))
        return f"{self.screw.kind} screw {size}, {show(self.length, 'mm', 'length')} long{self._shaft}"

    @property
    def _shaft(self) -> str:
        """The mass of the shaft, where that of the nut is unknown."""
        return f", shaft {show(self.shaft_mass, 'kg', 'mass')}" if isnan(self.screw.mass) else ""


def leaves_open(spec: RobotSpec) -> bool:
    """Whether the load of a spec is moved by a screw that has yet to be chosen."""
    load: Any = spec.load
    return MODULES[load.kind] == "screw" and load.lead is None


def wants_screw(spec: RobotSpec) -> bool:
    """Whether a load case leaves the screw to the catalogues."""
    return any(leaves_open(case) for _, case in spec.load_cases)


def chosen_of(spec: RobotSpec, screw: Screw) -> ChosenScrew:
    """A screw of a catalogue at the length that a spec needs."""
    load: Any = spec.load
    shaft = float(shaft_mass(_thick(screw), load.overall))
    return ChosenScrew(screw=replace(screw, mass=shaft + screw.nut_mass), length=load.overall, shaft_mass=shaft)


def _thick(screw: Screw) -> float:
    """Diameter of a smooth shaft of the same inertia, as makers have it [m]."""
    return screw.diameter if isnan(screw.shaft_diameter) else screw.shaft_diameter


def screw_figures(load: ScrewLoad, screw: Screw) -> dict[str, Any]:
    """Fields of a load that a screw of a catalogue gives."""
    checked = _CHECKED.get(screw.kind, _CHECKED[""])
    figures = {name: getattr(screw, name) for name in _RATINGS}
    given = {name: value if name in checked else _known(value) for name, value in figures.items()}
    if load.thread_friction is None and load.efficiency is None:
        given["efficiency"] = _known(screw.efficiency)
        given["back_efficiency"] = load.back_efficiency or _known(screw.back_efficiency)
    design = load.design or _DESIGNS.get(screw.manufacturer)
    return given | {"lead": screw.lead, "design": design}


def _known(value: float) -> float | None:
    return None if isnan(value) else value


def with_screw(spec: RobotSpec, screw: Screw) -> RobotSpec:
    """A spec with the screw of a catalogue in place of its choice, in all load cases."""

    def chosen(one: RobotSpec) -> RobotSpec:
        load: Any = one.load
        if not leaves_open(one):
            return one
        return one.model_copy(update={"load": load.model_copy(update=screw_figures(load, screw))})

    return spec.changed(chosen)


def for_drive(spec: RobotSpec, chosen: ChosenScrew | None) -> RobotSpec:
    """A spec with the screw of a drive, where it leaves one open."""
    return with_screw(spec, chosen.screw) if chosen is not None and wants_screw(spec) else spec
