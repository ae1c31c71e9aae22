"""Every benchmark in turn, and their results as one table in ``docs/speed.md``.

    python benchmarks/table.py [--dry]      # what make bench does

Each benchmark compares within its own run; the machine's load changes from one to the next. One that fails leaves its
lines empty, and the exit status is 1.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from goals import GOALS, shown

HERE = Path(__file__).resolve().parent
PAGE = HERE.parent / "docs" / "speed.md"
SCRIPTS = (
    "size_start", "catalog_load", "search_sets", "day", "closed_loop", "report", "platform_hour", "platform_following",
    "tolerances", "study", "machine",
)  # fmt: skip
_PART = re.compile(r"(?<=<!-- measured -->\n).*?(?=<!-- end -->)", re.DOTALL)


def measured() -> tuple[dict[str, float], list[str]]:
    """Results of all benchmarks by name, and the benchmarks that failed; what they print is printed."""
    failed = []
    with tempfile.TemporaryDirectory() as folder:
        kept = Path(folder) / "results"
        kept.touch()
        for script in SCRIPTS:
            print(f"\n== {script}", flush=True)
            run = subprocess.run([sys.executable, HERE / f"{script}.py"], check=False,
                                 env=os.environ | {"BENCH_RESULTS": str(kept)})  # fmt: skip
            failed += [script] * bool(run.returncode)
        return dict(json.loads(row) for row in kept.read_text(encoding="utf-8").splitlines()), failed


def table(found: dict[str, float]) -> str:
    """The table of the page; a goal that no benchmark measures yet has no figure, and is not reached."""
    rows = [
        f"| {goal.what} | {goal.beside} | {shown(found[name], goal) if name in found else ''} | "
        + f"{goal.sense} {goal.value:g} {goal.unit}".rstrip()
        + f" | {'yes' if name in found and holds(name, found[name]) else 'no'} |"
        for name, goal in GOALS.items()
    ]
    return "\n".join(["", "| what | beside | measured | goal | reached |", "|---|---|---|---|---|", *rows, "", ""])


def holds(name: str, value: float) -> bool:
    """Whether a goal is reached."""
    goal = GOALS[name]
    return value <= goal.value if goal.sense == "at most" else value >= goal.value


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--dry", action="store_true", help="leave the page as it is")
    dry = parser.parse_args().dry
    found, failed = measured()
    text = table(found)
    print(text)
    if not dry:
        page = PAGE.read_text(encoding="utf-8")
        PAGE.write_text(_PART.sub(lambda _: text, page), encoding="utf-8")
    if failed:
        sys.exit(f"failed: {', '.join(failed)}")


if __name__ == "__main__":
    main()
