"""Compare the results of two checkouts: numbers bit for bit, differences of words apart.

    python tests/tools/same_numbers.py OTHER [--keep FOLDER]

OTHER is another checkout, or a folder that was kept of one. Both run ``size``, ``validate`` and ``drive`` with
``--json``, ``report`` as CSV over all starters and examples, and ``catalog check``. Exit status 1 when a number
differs, a key or row is on one side only, or a command ends otherwise.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import re
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?", re.I)
Difference = tuple[str, Any, Any]


def commands(tree: Path, out: Path) -> Iterator[tuple[Path, list[str]]]:
    """Every command to run in a checkout, and the file for what it prints."""
    for spec in [*(tree / "drivesizer/spec/starters").glob("*.yaml"), *(tree / "examples").glob("*.yaml")]:
        name, file = spec.stem, str(spec.relative_to(tree))
        yield out / f"{name}.size.json", ["size", file, "--json"]
        yield out / f"{name}.val.json", ["validate", file, "--json"]
        yield out / f"{name}.rep.out", ["report", file, "-o", str(out / f"{name}.csv")]
        if "platform" in name and spec.parent.name == "examples":
            yield out / f"{name}.drive.json", ["drive", file, "--json"]
    yield out / "catalog.txt", ["catalog", "check"]


def results(tree: Path, out: Path) -> None:
    """Run all commands of a checkout and keep what they print, write and end with."""
    surroundings = os.environ | {"PYTHONPATH": str(tree), "COLUMNS": "100"}

    def run(task: tuple[Path, list[str]]) -> str:
        target, words = task
        whole = [sys.executable, "-m", "drivesizer", *words]
        done = subprocess.run(whole, cwd=tree, env=surroundings, capture_output=True, encoding="utf-8", check=False)
        target.write_text(done.stdout.replace(str(tree), "."), encoding="utf-8")
        return f"{target.name} {done.returncode}\n"

    out.mkdir(parents=True, exist_ok=True)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        (out / "ends.csv").write_text("".join(sorted(pool.map(run, commands(tree, out)))), encoding="utf-8")


def walk(a: Any, b: Any, place: str) -> Iterator[Difference]:
    """Leaves that differ, and keys or rows on one side only."""
    if isinstance(a, dict) and isinstance(b, dict):
        for key in {**a, **b}:
            yield from walk(a.get(key, "(absent)"), b.get(key, "(absent)"), f"{place}/{key}")
    elif isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        for n, pair in enumerate(zip(a, b, strict=True)):
            yield from walk(*pair, f"{place}[{n}]")
    elif a != b and not (a is b or repr(a) == repr(b)):  # NaN is NaN
        yield place, a, b


def only_words(place: str, a: Any, b: Any) -> bool:
    """Whether two values differ in words: texts with the same numbers, or names of files and digests."""
    if not (isinstance(a, str) and isinstance(b, str)) or "(absent)" in (a, b):
        return False
    return "/catalogs" in place or NUMBER.findall(a) == NUMBER.findall(b)


def read(path: Path) -> Any:
    """What a file holds: a document, rows, or lines."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".json":
        return json.loads(text) if text else ""
    return list(csv.reader(text.splitlines())) if path.suffix == ".csv" else text.splitlines()


def main() -> int:
    """Run, compare, and print: numbers one by one, words once each with how often."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("other", type=Path, help="another checkout, or a folder kept of one")
    parser.add_argument("--keep", type=Path, help="where this checkout's results are kept")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        before, after = options.other.resolve(), (options.keep or Path(scratch) / "after").resolve()
        if (before / "pyproject.toml").exists():
            results(before, Path(scratch) / "before")
            before = Path(scratch) / "before"
        results(ROOT, after)
        wrong, words = 0, Counter[str]()
        files = {p.name for p in [*before.iterdir(), *after.iterdir()] if p.suffix in (".json", ".csv")} | {
            "catalog.txt"
        }
        for name in sorted(files):
            if not ((before / name).exists() and (after / name).exists()):
                wrong += name != "ends.csv"
                print(f"{name}: on one side only")
                continue
            for place, a, b in walk(read(before / name), read(after / name), ""):
                if only_words(place, a, b):
                    words[f"{a!r} -> {b!r}"] += 1
                else:
                    wrong += 1
                    print(f"{name}{place}: {str(a)[:80]} -> {str(b)[:80]}")
    print(f"\n{wrong} numbers, keys or rows differ; {len(words)} texts differ in words:")
    for text, count in words.most_common():
        print(f"{count:6d}  {text[:300]}")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
