"""``python -m drivesizer.units``: the table of factors and offsets, as ``units.json`` keeps it."""

from __future__ import annotations

import json

from drivesizer.units import tabulate

if __name__ == "__main__":
    lines = (f"{json.dumps(kind)}: {json.dumps(units)}" for kind, units in tabulate().items())
    print("{\n" + ",\n".join(lines) + "\n}")
