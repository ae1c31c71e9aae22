"""The live page in a real browser: from a changed slider to the new ranking, beside the engine's own time.

A vehicle over the whole maxon catalogue by physics. A slider is moved by its keys, and the time ends when the page has
the new drive in its headline. Then many changes, and the memory of all processes before and after.
"""

from __future__ import annotations

import argparse
import re
import signal
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from second_start import second_start

from drivesizer.sizing import size
from drivesizer.spec.robot import load_spec

SPEC = """\
name: AGV
supply: {nominal: 48 V}
load: {kind: wheeled_vehicle, mass: 120 kg, wheel_diameter: 150 mm, driven_wheels: 2, rolling_resistance: 0.02,
       slope: 3 deg, inertia: 0.004 kg*m^2}
motion: {speed: 1.2 m/s, acceleration_time: 1.5 s, cruise_time: 10 s, rest_time: 5 s}
"""
BROWSER = "/usr/bin/chromium"
FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking"]
# moves a slider to a share of its range, and waits until the page shows the ranking of that
MOVE = """async ([label, share]) => {
  const range = document.querySelector(`input[type="range"][aria-label="${label}"]`);
  const page = document.documentElement, before = page.dataset.ranked;
  range.value = String(Math.round(share * Number(range.max)));
  const start = performance.now();
  range.dispatchEvent(new Event("input", { bubbles: true }));
  await new Promise((found) => {
    const watch = new MutationObserver(() => { if (page.dataset.ranked !== before) { watch.disconnect(); found(); } });
    watch.observe(page, { attributes: true, attributeFilter: ["data-ranked"] });
  });
  await new Promise(requestAnimationFrame);
  return performance.now() - start;
}"""


@contextmanager
def served(path: Path) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """The server of a spec, and its address."""
    command = [sys.executable, "-m", "drivesizer", "serve", str(path), "--no-browser"]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, start_new_session=True)
    try:
        assert server.stdout
        found = re.search(r"http://\S+", server.stdout.readline())
        assert found
        yield server, found[0]
    finally:
        server.send_signal(signal.SIGINT)
        server.wait(10)


def memory(group: int) -> float:
    """Resident memory of a process and those that it started [MB]."""
    found = subprocess.check_output(["ps", "-o", "rss=", "--sid", str(group)], text=True)
    return sum(map(int, found.split())) / 1024


def engine(path: Path, runs: int) -> tuple[float, float]:
    """Median time of the ranking alone and of a whole sizing, in this process [s]."""
    text, taken = path.read_text(encoding="utf-8"), dict[bool, list[float]]()
    for n in range(runs + 1):
        path.write_text(text.replace("1.2 m/s", f"{1 + n / 50:.2f} m/s"), encoding="utf-8")
        for brief in (True, False):
            start = time.perf_counter()
            size(load_spec(path), top=10, brief=brief)
            taken.setdefault(brief, []).append(time.perf_counter() - start)
    path.write_text(text, encoding="utf-8")
    return statistics.median(taken[True][1:]), statistics.median(taken[False][1:])


def moved(page: Any, runs: int) -> list[float]:
    """Time of each move of the slider [s]."""
    return [page.evaluate(MOVE, ["motion · speed", 0.2 + 0.6 * ((7 * n) % 31) / 31]) / 1e3 for n in range(runs)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=60, help="moves of the slider that are timed")
    parser.add_argument("--changes", type=int, default=200, help="moves over which memory is watched")
    given = parser.parse_args()
    from playwright.sync_api import sync_playwright

    with second_start() as folder, sync_playwright() as playwright:
        path = folder / "robot.yaml"
        path.write_text(SPEC, encoding="utf-8")
        browser = playwright.chromium.launch(executable_path=BROWSER, args=FLAGS)
        with served(path):
            pass  # fills the caches
        start = time.perf_counter()
        with served(path) as (server, address):
            page = browser.new_page()
            page.goto(address)
            page.wait_for_selector("#form input")
            first = time.perf_counter() - start
            page.wait_for_selector("html[data-ranked]", state="attached")
            ranked = time.perf_counter() - start
            page.get_by_label("slider for motion speed").click()
            page.wait_for_timeout(6000)  # until the ranges of the slider are known
            moved(page, 5)
            taken, (ranking, whole) = sorted(moved(page, given.runs)), engine(path, 20)
            median, most = statistics.median(taken), taken[int(0.95 * len(taken))]
            before = memory(server.pid)
            moved(page, given.changes)
            after = memory(server.pid)
        print(f"page {first:.2f} s after the command (goal: 2), first ranking {ranked:.2f} s")
        print(f"slider to ranking: median {1e3 * median:.0f} ms, 95 % {1e3 * most:.0f} ms   goals: 300, 600")
        print(
            f"the engine alone: ranking {1e3 * ranking:.0f} ms, whole sizing {1e3 * whole:.0f} ms; "
            f"page / ranking {median / ranking:.2f}"
        )
        print(f"memory of server and engines {before:.0f} MB, after {given.changes} changes {after:.0f} MB")
        browser.close()


if __name__ == "__main__":
    main()
