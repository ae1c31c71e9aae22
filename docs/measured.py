"""Holds the drive model against measured drives: makes docs/measured.md and its figures.

    python docs/measured.py FOLDER

FOLDER holds the records of the two repositories that the head of measured_data.py names. The page's text stands in
measured.txt, with the names of figures in braces; what stands there follows from the records and the program alone.
"""

from __future__ import annotations

import sys
from pathlib import Path

import measured_heat
import measured_motor
import measured_servo
from measured_tables import Findings, misses, table

HERE = Path(__file__).resolve().parent


def main(folder: Path) -> None:
    """Write the page and its figures."""
    parts: list[Findings] = [module.findings(folder) for module in (measured_servo, measured_motor, measured_heat)]
    values = {name: value for part in parts for name, value in part.values.items()}
    text = (HERE / "measured.txt").read_text(encoding="utf-8")
    rows = [row for part in parts for row in part.rows]
    page = text.format(table=table(rows), misses=misses(rows), **values)
    (HERE / "measured.md").write_text(page, encoding="utf-8")
    (HERE / "figures").mkdir(exist_ok=True)
    for part in parts:
        for name, drawing in part.figures.items():
            (HERE / "figures" / f"{name}.svg").write_bytes(drawing)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python docs/measured.py FOLDER (with the records of the repositories in measured_data.py)")
    main(Path(sys.argv[1]))
