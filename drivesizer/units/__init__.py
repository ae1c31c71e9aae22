"""Units at the door: user text to SI floats, SI floats to the units of the trade.

The registry is our own (``units.txt``): pint reads ``3,5 mm`` as 35 mm, 60 rpm as 6.28 Hz and N*m as J. What pint makes
of each listed unit is kept in ``units.json``, so that no start waits for it.

May import: errors, version.

One strict reader (``reader``) serves specs, catalogues and the command line. Text never reaches pint unread: a unit
must be listed for its kind of quantity (``kinds``), a figure must lie in the range of its kind (``ranges``). Kinds that
share a dimension stay apart: torque and energy, rotary speed and frequency, temperature and temperature difference.
"""

from __future__ import annotations

from drivesizer.units.kinds import KINDS, Kind, resolved
from drivesizer.units.reader import (
    digits_of,
    from_si,
    kind_of_unit,
    label,
    noun,
    number,
    possible,
    registry,
    scale,
    show,
    show_band,
    tabulate,
    to_si,
)

__all__ = [
    "KINDS", "Kind", "digits_of", "from_si", "kind_of_unit", "label", "noun", "number", "possible", "registry",
    "resolved", "scale", "show", "show_band", "tabulate", "to_si",
]  # fmt: skip
