"""Drives per second that the search examines with every check, on one core: in ratios of one run.

The SPS robot over the whole catalogue with several belt ratios: once on its own cycle of three segments, once on a
recording of it with 36 000 noisy samples. The baseline is a plain loop over the drives, NumPy over the samples of
each, for torques, currents, voltages cold and hot and power, without the periodic heat and the choice of encoder and
controller. Memory is that of a process of its own, also with ten times as many belt ratios. A recording of a million
samples is read too.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from goals import line

from drivesizer.catalog import load
from drivesizer.catalog.view import search_view
from drivesizer.files import sheets
from drivesizer.load_cases import load_cycle
from drivesizer.machine.problem import problem
from drivesizer.search.columns.candidates import Rows, pairs
from drivesizer.search.search import search
from drivesizer.spec.robot import RobotSpec, load_spec

SPEC = Path(__file__).resolve().parent.parent / "examples" / "sps_robot.yaml"


def written(folder: Path, belts: int) -> tuple[Path, Path]:
    """The spec on its own cycle, and on a recording of it."""
    text = SPEC.read_text(encoding="utf-8")
    text = text[: text.index("select:")].replace("method: paper", "method: physics")
    ratios = ", ".join(f"{1 + 0.4 * k / belts:.5f}" for k in range(belts))
    text = text.replace("    ratio: 1.1  ", f"    ratios: [{ratios}]  ")
    text = text[: text.index("platform:")] + text[text.index("environment:") :]  # a recording has none
    short, long = folder / "short.yaml", folder / "long.yaml"
    short.write_text(text, encoding="utf-8")
    recording(load_spec(short), folder / "cycle.csv")
    head, rest = text[: text.index("load:")], text[text.index("transmission:") :]
    rest = rest[: rest.index("paper_factors:")] + rest[rest.index("supply:") :]
    recorded = "load: {kind: recorded, file: cycle.csv, motors: 4, smoothing: 1 s}\n\n"
    long.write_text(head + recorded + rest, encoding="utf-8")
    return short, long


def recording(spec: RobotSpec, path: Path, samples: int = 36_000) -> None:
    """The cycle of all motors together, its torque off by 10 % at each sample."""
    cycle, noise = load_cycle(spec), np.random.default_rng(1)
    t = np.linspace(0.0, cycle.total, samples)
    segment = np.minimum(np.searchsorted(cycle.time[:, 1], t), len(cycle.duration) - 1)
    share = (t - cycle.time[segment, 0]) / cycle.duration[segment]
    speed, torque = (c[segment, 0] + share * (c[segment, 1] - c[segment, 0]) for c in (cycle.speed, cycle.torque))
    torque = 4 * torque * (1.0 + 0.1 * noise.normal(size=samples))
    rows = "".join(f"{a:.9g},{b:.9g},{c:.9g}\n" for a, b, c in zip(t, speed, torque, strict=True))
    path.write_text(f"time,speed,torque\ns,rad/s,N*m\n{rows}", encoding="utf-8")


def rates(specs: Sequence[RobotSpec], runs: int, estimates: bool = True) -> list[tuple[float, int]]:
    """Drives per second of the processor, best of some runs in turns, and the number of drives that pass."""
    catalog, best = search_view(load(["maxon"]), estimates), [(0.0, 0)] * len(specs)
    for _ in range(runs):
        for place, spec in enumerate(specs):
            one = problem(spec, catalog)  # reads the recording and makes the load cycle, once
            start = time.process_time()
            counts = search(one, top=5).counts
            rate = counts.considered / (time.process_time() - start)
            best[place] = max(best[place], (rate, counts.feasible))
    return best


def reading(folder: Path, spec: RobotSpec, runs: int) -> float:
    """Processor time to read a recording of a million samples [s]."""
    path, best = folder / "million.csv", np.inf
    recording(spec, path, 1_000_000)
    for _ in range(runs):
        start = time.process_time()
        sheets.columns(path, {"time": "time", "speed": "rotary_speed", "torque": "torque"})
        best = min(best, time.process_time() - start)
    return float(best)


def loop_rate(spec: RobotSpec, drives: int) -> float:
    """Drives per second of the loop over the samples of a cycle: demands of each drive against its limits."""
    catalog, cycle = load(["maxon"]), load_cycle(spec)
    every = pairs(problem(spec, catalog))
    some = every.on(np.random.default_rng(2).integers(0, len(every.motor), drives))
    motor, gearhead = Rows(catalog.motors, some.motor), Rows(catalog.gearheads, some.gearhead)
    names = {
        "motor": ("torque_constant", "no_load_current", "resistance", "rotor_inertia", "thermal_resistance_winding",
                  "thermal_resistance_housing"),
        "gearhead": ("ratio", "efficiency", "inertia"),
    }  # fmt: skip
    columns = [motor[n] for n in names["motor"]] + [gearhead[n] for n in names["gearhead"]]
    t, w, a, T = (c.reshape(-1) for c in (cycle.time, cycle.speed, cycle.acceleration, cycle.torque))
    start = time.perf_counter()
    for k_t, I_0, R, J_m, R_1, R_2, i, e, J_g in zip(*(c.tolist() for c in columns), strict=True):
        K = i * 1.1
        at_gear = np.where(T * w > 0, T / (1.1 * 0.95), T * 0.95 / 1.1)
        gear = np.sqrt(np.trapezoid(at_gear**2, t) / cycle.total), np.abs(at_gear).max(), np.abs(w).max() * K
        at_motor = np.where(T * w > 0, at_gear / (i * e), at_gear * e / i)
        current = (at_motor + (J_m + J_g) * K * a + k_t * I_0 * np.sign(w)) / k_t
        rms = np.sqrt(np.trapezoid(current**2, t) / cycle.total)
        loss = (R_1 + R_2) * R * rms**2
        hot = R * (1 + 0.0039 * loss / max(1 - 0.0039 * loss, 1e-9))
        volts = R * current + k_t * K * w, hot * current + k_t * K * w
        power = (volts[1] * current).max()
        _ = gear, rms < 5.0, np.abs(current).max() < 15.0, max(np.abs(v).max() for v in volts) < 18.9, power < 120.0
    return drives / (time.perf_counter() - start)


def memory(spec: Path) -> float:
    """Peak memory of a process that searches, of all so far the largest [MB]."""
    code = (
        "import sys; from drivesizer.catalog import load; from drivesizer.search.search import search;"
        "from drivesizer.spec.robot import load_spec; from drivesizer.machine.problem import problem;"
        "search(problem(load_spec(sys.argv[1]), load(['maxon'])), top=5)"
    )
    subprocess.run([sys.executable, "-c", code, str(spec)], check=True)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--belts", type=int, default=17, help="belt ratios, times 59 946 combinations")
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        megabytes, many = (memory(written(Path(folder), n)[0]) for n in (options.belts, min(10 * options.belts, 1000)))
        short_path, long_path = written(Path(folder), options.belts)
        short, long = load_spec(short_path), load_spec(long_path)
        (fast, passing), (slow, same) = rates((short, long), options.runs)
        printed = [rate for rate, _ in rates((short, long), options.runs, False)]
        loops = loop_rate(short, 2000), loop_rate(long, 200)
        at_once = reading(Path(folder), short, options.runs)
    print(f"{'':28}{'3 segments':>14}{'36 000 samples':>16}")
    print(f"{'drives per second':28}{fast:14,.0f}{slow:16,.0f}")
    print(f"{'the same without estimates':28}{printed[0]:14,.0f}{printed[1]:16,.0f}")
    print(f"{'drives that pass':28}{passing:14,}{same:16,}")
    print(f"{'loop, drives per second':28}{loops[0]:14,.0f}{loops[1]:16,.0f}")
    print(f"{'search / loop':28}{fast / loops[0]:14,.0f}{slow / loops[1]:16,.0f}")
    print(
        line("search", fast / 1e6), line("search / loop", fast / loops[0]), line("long / short", fast / slow), sep="\n"
    )
    print(f"{'peak memory':28}{megabytes:11,.0f} MB{'':16}   goal: 400 MB at a million drives")
    print(f"{'the same, ten times as many':28}{many:11,.0f} MB")
    print(f"{'a million samples read':28}{at_once:12.2f} s")


if __name__ == "__main__":
    main()
