"""A toothed belt and its pair of pulleys as catalogue parts, with the geometry between them."""

from __future__ import annotations

from dataclasses import dataclass

from drivesizer.catalog.more_parts import Belt, Pulley
from drivesizer.physics.elements.belt import pitch_diameter

__all__ = ["BeltDrive"]


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
        return self.driven.teeth / self.driving.teeth

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
