"""Direct drive as a row of the gearheads: no mass, no loss and no limits."""

from __future__ import annotations

import numpy as np

from drivesizer.catalog.parts import NO_GEARHEAD, Gearhead
from drivesizer.catalog.tables import Source, Table

__all__ = ["NO_GEARHEAD_SOURCE", "with_no_gearhead"]

NO_GEARHEAD_SOURCE = Source("no gearhead: the motor drives the load itself", "quoted")


def with_no_gearhead(gearheads: Table[Gearhead], source: int) -> Table[Gearhead]:
    """A table of gearheads with the row of direct drive, which weighs nothing and has no limits, as its last."""
    columns = {name: np.append(gearheads[name], getattr(NO_GEARHEAD, name)) for name in gearheads.columns}
    sources = np.append(gearheads.source, source).astype(np.int32)
    return Table(gearheads.section, columns, sources, np.append(gearheads.excluded, False))
