"""No gearhead at all, as a row among the gearheads: what stands there weighs nothing and has no limit."""

from __future__ import annotations

import numpy as np

from drivesizer.catalog.parts import DIRECT, NO_GEARHEAD, Gearhead
from drivesizer.catalog.tables import Catalog, Source, Table

__all__ = ["NONE", "with_direct", "with_no_gearhead"]

NONE = Source("no gearhead: the motor drives the load itself", "quoted")


def with_no_gearhead(gearheads: Table[Gearhead], source: int) -> Table[Gearhead]:
    """A table of gearheads, and the lack of one as its last row, from the source of that number."""
    columns = {name: np.append(gearheads[name], getattr(NO_GEARHEAD, name)) for name in gearheads.columns}
    sources = np.append(gearheads.source, source).astype(np.int32)
    return Table(gearheads.section, columns, sources, np.append(gearheads.excluded, False))


def with_direct(catalog: Catalog) -> Catalog:
    """The catalogue with the row that stands for no gearhead, though no file of it lists one."""
    if DIRECT in catalog.gearheads.rows:
        return catalog
    table = with_no_gearhead(catalog.gearheads, len(catalog.sources))
    return catalog.with_tables({"gearheads": table, "sources": (*catalog.sources, NONE)}, {})
