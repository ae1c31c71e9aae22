"""From a log of a real drive to its figures with bands, and the log beside what a sizing promised.

May import: control, kernel, load_cases, spec, results, catalog, physics, files, units; not output.
"""

from __future__ import annotations

from drivesizer.files.text import listed


def declared(section: str) -> list[list[str]]:
    """Rows of a section of ``figures.txt``."""
    return [cells for head, cells in listed("drivesizer.identification", "figures.txt") if head == section]
