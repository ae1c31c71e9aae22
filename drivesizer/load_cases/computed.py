"""A load that comes with its load cycle: computed of a whole machine, not recorded."""

from __future__ import annotations

from pydantic import PrivateAttr

from drivesizer.loads.recorded import Recorded
from drivesizer.physics.load_cycle import LoadCycle

__all__ = ["ComputedLoad"]


class ComputedLoad(Recorded):
    """A load of kind recorded that has its cycle already."""

    _cycle: LoadCycle = PrivateAttr()

    @property
    def cycle(self) -> LoadCycle:
        """Of its shaft."""
        return self._cycle

    @property
    def shaft_inertia(self) -> float:
        """Of all that one drive moves, at its shaft [kg*m^2]."""
        return self._cycle.inertia
