"""Holds the program's predictions against measured drives: makes docs/measured.md and its figures.

    python docs/measured.py FOLDER

FOLDER holds the records of the repositories that the head of measured_data.py names. The page's text stands in
measured.txt, with the names of figures in braces, and behind a line of dashes one line about each quantity.
"""

from __future__ import annotations

import sys
from pathlib import Path

import measured_motors
import measured_ri50
import measured_servos
from measured_compared import Comparison
from measured_figures import drawing
from measured_tables import GOAL, LARGE, abouts, by_quantity, coverage, drive_table, misses, quantities, share

HERE = Path(__file__).resolve().parent
DRIVES = {  # name of the figure: heading, and what compares
    "mx": ("MX-64 and MX-106, geared servos", measured_servos.mx),
    "xl330": ("XL330, geared hobby servo", measured_servos.xl330),
    "sts3215": ("STS3215, geared hobby servo", measured_servos.sts3215),
    "jameco": ("Jameco 12 V, brushed", measured_motors.jameco),
    "ri50": ("RI50, brushless, frameless", measured_ri50.ri50),
    "contest": ("NEO, NEO 550, Falcon 500, brushless", measured_motors.contest),
    "d5065": ("ODrive D5065, brushless", measured_motors.d5065),
}


def page(found: dict[str, list[Comparison]]) -> tuple[str, dict[str, bytes]]:
    """The page, and its figures by name."""
    text, _, lines = (HERE / "measured.txt").read_text(encoding="utf-8").partition("\n---\n")
    texts = abouts(lines.strip().splitlines())
    every = [one for some in found.values() for one in some]
    inside, points = sum(int(one.inside.sum()) for one in every), sum(len(one.y) for one in every)
    small = [one for one in every if len(one.y) < LARGE]
    half, good = quantities(every, texts)
    values = {
        "coverage": coverage({DRIVES[name][0]: some for name, some in found.items()}, texts),
        "quantities": half, "good": str(sum(good)), "of": str(len(good)), "misses": misses(every, texts),
        "share": share(inside, points), "goal": f"{100 * GOAL:.0f} %",
        "small_share": share(sum(int(one.inside.sum()) for one in small), sum(len(one.y) for one in small)),
    } | by_quantity(every) | {f"table_{name}": drive_table(some, texts) for name, some in found.items()}  # fmt: skip
    figures = {f"measured-{name}": drawing(some, [texts[one.key].name for one in some]) for name, some in found.items()}
    return text.format(**values) + "\n", figures


def main(folder: Path, into: Path = HERE) -> None:
    """Write the page and its figures."""
    text, figures = page({name: compared(folder) for name, (_, compared) in DRIVES.items()})
    (into / "measured.md").write_text(text, encoding="utf-8")
    (into / "figures").mkdir(exist_ok=True)
    for name, drawn in figures.items():
        (into / "figures" / f"{name}.svg").write_bytes(drawn)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python docs/measured.py FOLDER (with the records of the repositories in measured_data.py)")
    main(Path(sys.argv[1]))
