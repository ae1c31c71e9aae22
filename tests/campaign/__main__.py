"""A campaign of inputs changed by chance: nothing of it may break the program.

    python tests/campaign --inputs 100000 --seed 1 --minutes 30 --processes 2
    python tests/campaign --again spec 1234       one input again, with what it prints and where it arose
    python tests/campaign --again build/campaign/1          the same of one that was kept

Finds go to build/campaign: report.json with a class each, and the smallest input of each class in a folder of its own.
The exit status is 1 where there is one.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # before numpy
os.environ["COLUMNS"] = "100"

import argparse
import json
import shutil
import sys
import tempfile
import time
import traceback
from collections import Counter
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "helpers")]

import case as cases  # noqa: E402
from case import Case  # noqa: E402
from inputs import KINDS, made  # noqa: E402
from judge import finds  # noqa: E402
from program import ran  # noqa: E402
from runner import Outcome, campaign, judged, kind_of  # noqa: E402
from shrinking import shrunk  # noqa: E402


def main() -> int:
    given = _options()
    if given.again:
        return _again(given.again)
    seeds = range(given.seed, given.seed + given.inputs)
    kinds = given.kinds.split(",") if given.kinds else list(KINDS)
    start, ended, slowest = time.monotonic(), Counter[str](), [("", 0, 0.0)]
    classes: dict[str, dict[str, Any]] = {}
    for n, outcome in enumerate(campaign(seeds, kinds, given.processes, given.minutes), 1):
        ended[f"{outcome.kind} {outcome.status}"] += 1
        slowest = sorted([*slowest, (outcome.kind, outcome.seed, round(outcome.seconds, 1))], key=lambda s: -s[2])[:5]
        _noted(classes, outcome)
        if n % 1000 == 0:
            print(f"{n} inputs, {time.monotonic() - start:.0f} s, {len(classes)} classes", file=sys.stderr, flush=True)
    report = {"inputs": ended.total(), "seed": given.seed, "seconds": round(time.monotonic() - start),
              "ended": dict(sorted(ended.items())), "slowest": slowest, "classes": classes}  # fmt: skip
    _kept(report, Path(given.keep))
    _printed(report)
    return 1 if classes else 0


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python tests/campaign", description=__doc__.partition("\n")[0])
    parser.add_argument("--inputs", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=1, help="of the first; the others follow")
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--kinds", help=f"some of {','.join(KINDS)}")
    parser.add_argument("--keep", default=str(ROOT / "build" / "campaign"), help="folder of the finds")
    parser.add_argument("--again", nargs="+", metavar="KIND SEED | FOLDER", help="one input, with all that it prints")
    return parser.parse_args()


def _noted(classes: dict[str, dict[str, Any]], outcome: Outcome) -> None:
    """Count the finds of an input by class; the first seeds are kept."""
    for find in outcome.finds:
        new = find.kind not in classes
        one = classes.setdefault(find.kind, {"count": 0, "seen": find.seen, "seeds": []})
        one["count"] += 1
        one["seeds"] += [[outcome.kind, outcome.seed]] if len(one["seeds"]) < 10 else []
        if new:
            print(f"{find.kind}: {find.seen[:200]} ({outcome.kind} {outcome.seed})", file=sys.stderr, flush=True)


def _kept(report: dict[str, Any], folder: Path) -> None:
    """The report, and the smallest input of each class."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    with tempfile.TemporaryDirectory() as name, tempfile.TemporaryDirectory() as cache:
        os.environ["DRIVESIZER_CACHE"] = cache
        for number, (kind, one) in enumerate(report["classes"].items(), 1):
            first = made(*one["seeds"][0])
            hangs = kind.startswith(("hangs", "its process"))

            def still(other: Case, kind: str = kind) -> bool:
                return any(find.kind == kind for find in judged(other, Path(name))[2])

            cases.kept(first if hangs or not still(first) else shrunk(first, still), folder / str(number))
            one["kept"] = str(number)
    (folder / "report.json").write_text(json.dumps(report, indent=1, ensure_ascii=False), encoding="utf-8")


def _printed(report: dict[str, Any]) -> None:
    print(f"{report['inputs']} inputs in {report['seconds']} s: {len(report['classes'])} classes of finds")
    for status, count in report["ended"].items():
        print(f"  {status:20} {count}")
    for kind, one in sorted(report["classes"].items(), key=lambda pair: -pair[1]["count"]):
        first = " ".join(map(str, one["seeds"][0]))
        print(f"{one['count']:6} {kind}\n       {one['seen'][:160]}\n       --again {first}")


def _again(words: list[str]) -> int:
    """One input again: its commands, what they print, and what is wrong with it."""
    if len(words) == 1 and words[0].isdigit():
        words = [kind_of(int(words[0]), list(KINDS)), words[0]]
    case = made(words[0], int(words[1])) if len(words) == 2 else cases.read(Path(words[0]))
    here = Path(tempfile.mkdtemp(prefix="campaign-"))
    cases.kept(case, here / "input")
    (here / "run").mkdir()
    os.environ["DRIVESIZER_CACHE"] = str(here / "cache")
    found = ran(case, here / "run")
    for one in found:
        print("$ drivesizer", *one.words, f"\n{one.out}{one.err}status {one.status}, {one.seconds:.1f} s")
        if one.error is not None and one.status not in (0, 1):
            traceback.print_exception(one.error)
    wrong = [find for one in found for find in finds(one, schema=True)]
    print(f"files in {here / 'input'}; finds: {wrong or 'none'}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
