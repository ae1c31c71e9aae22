"""The live page in a real browser: from a changed slider to the new headline, over maxon and over all catalogues.

A vehicle by physics. A slider is moved, and the time ends when the page has drawn the new headline. Beside it stands
the processor time of a move: of the engine, which ranks and sends, of the server between, and of the page's scripts,
style, layout and all its tasks; a busy machine lengthens the first and leaves the others. Then many moves, and the
memory before and after.
"""

from __future__ import annotations

import argparse
import os
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

from drivesizer.live.answer import ranking
from drivesizer.multi_axis import size_machine
from drivesizer.spec.machine import load_any

SPEC = """\
name: AGV
supply: {nominal: 48 V}
load: {kind: wheeled_vehicle, mass: 120 kg, wheel_diameter: 150 mm, driven_wheels: 2, rolling_resistance: 0.02,
       slope: 3 deg, inertia: 0.004 kg*m^2}
motion: {speed: 1.2 m/s, acceleration_time: 1.5 s, cruise_time: 10 s, rest_time: 5 s}
"""
GOALS = {"maxon": (150, 400, 5), "all": (300, 800, 15)}  # ms of the median and of 95 %, s of the band
PATIENCE = 300_000  # ms
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
        server.wait(60)


def of_group(group: int, what: str) -> dict[int, str]:
    """A figure of ps, of a process and of those that it started."""
    lines = subprocess.check_output(["ps", "-o", f"pid=,{what}=", "--sid", str(group)], text=True).splitlines()
    return {int(number): figure for number, figure in map(str.split, lines)}


def memory(group: int) -> float:
    """Resident memory of a process and those that it started [MB]."""
    return sum(map(int, of_group(group, "rss").values())) / 1024


def processor(group: int) -> tuple[float, float]:
    """Processor time of the server and of its engines [s]."""
    times = dict[int, float]()
    for number in of_group(group, "rss"):
        fields = Path(f"/proc/{number}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
        times[number] = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    return times.pop(group), sum(times.values())


def engine(path: Path, runs: int) -> float:
    """Median processor time of a ranking alone, in this process [s]."""
    text, taken = path.read_text(encoding="utf-8"), list[float]()
    for n in range(runs + 1):
        path.write_text(text.replace("1.2 m/s", f"{1 + n / 50:.2f} m/s"), encoding="utf-8")
        start = time.process_time()
        ranking(size_machine(load_any(path), top=10, detail="headline"))
        taken.append(time.process_time() - start)
    path.write_text(text, encoding="utf-8")
    return statistics.median(taken[1:])


def moved(page: Any, runs: int) -> list[float]:
    """Time of each move of the slider [s]."""
    return [page.evaluate(MOVE, ["motion · speed", 0.2 + 0.6 * ((7 * n) % 31) / 31]) / 1e3 for n in range(runs)]


def computed(page: Any) -> float:
    """Moment from which on nothing of a slider's band is computed for a second [s]."""
    since = 0.0
    while not since or time.perf_counter() - since < 1.0:
        still = page.locator(".slider .far").text_content() == ""
        since = (since or time.perf_counter()) if still else 0.0
        page.wait_for_timeout(50)
    return since


def measured(browser: Any, path: Path, runs: int, changes: int) -> None:
    catalogs = "all" if "catalogs: all" in path.read_text(encoding="utf-8") else "maxon"
    median_goal, most_goal, band_goal = GOALS[catalogs]
    for again in (False, True):  # the first start fills the caches
        start = time.perf_counter()
        with served(path) as (server, address):
            page = browser.new_page()
            page.set_default_timeout(PATIENCE)
            page.goto(address)
            page.wait_for_selector("#form input")
            first = time.perf_counter() - start
            page.wait_for_selector("html[data-ranked]", state="attached")
            ranked = time.perf_counter() - start
            if not again:
                page.close()
                continue
            page.wait_for_selector('html[data-state="whole"]', state="attached")
            start = time.perf_counter()
            page.get_by_label("slider for motion speed").click()
            band = computed(page) - start
            moved(page, 5)
            figures = page.context.new_cdp_session(page)
            figures.send("Performance.enable", {"timeDomain": "threadTicks"})

            def page_time(figures: Any = figures) -> tuple[float, float, float]:
                values = {one["name"]: one["value"] for one in figures.send("Performance.getMetrics")["metrics"]}
                laid = values["LayoutDuration"] + values["RecalcStyleDuration"]
                return values["ScriptDuration"], laid, values["TaskDuration"]

            before = *processor(server.pid), *page_time()
            taken = sorted(moved(page, runs))
            after = *processor(server.pid), *page_time()
            spent = [1e3 * (y - x) / runs for x, y in zip(before, after, strict=True)]
            median, most = 1e3 * statistics.median(taken), 1e3 * taken[int(0.95 * len(taken))]
            used = memory(server.pid)
            moved(page, changes)
            left = memory(server.pid)
            page.close()
    alone = 1e3 * engine(path, 10)
    print(f"{catalogs}: page {first:.2f} s after the command (goal: 2), first ranking {ranked:.2f} s")
    print(f"  slider to headline: median {median:.0f} ms, 95 % {most:.0f} ms   goals: {median_goal}, {most_goal}")
    own, engines, script, layout, tasks = map(round, spent)
    print(f"  processor time of a move: engine {engines} ms, of which a ranking alone {alone:.0f} ms; server {own} ms; "
          f"page {tasks} ms, of which scripts {script} ms, style and layout {layout} ms")  # fmt: skip
    print(f"  band of the slider: {band:.1f} s   goal: {band_goal}")
    print(f"  memory of server and engines {used:.0f} MB, after {changes} changes {left:.0f} MB")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=60, help="moves of the slider that are timed")
    parser.add_argument("--changes", type=int, default=200, help="moves over which memory is watched")
    parser.add_argument("--catalogs", choices=GOALS, nargs="*", default=[*GOALS])
    given = parser.parse_args()
    from playwright.sync_api import sync_playwright

    with second_start() as folder, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=BROWSER, args=FLAGS)
        for catalogs in given.catalogs:
            path = folder / f"{catalogs}.yaml"
            path.write_text(f"{SPEC}select: {{catalogs: {catalogs}}}\n", encoding="utf-8")
            measured(browser, path, given.runs, given.changes)
        browser.close()


if __name__ == "__main__":
    main()
