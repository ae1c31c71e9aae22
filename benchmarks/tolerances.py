"""Time of 10 000 samples of the 100 best drives, beside one whole `drivesizer size` of the same machine.

The SPS robot by physics over the whole catalogue, with tolerances of mass, rolling resistance, supply and ambient and
with the default classes of the catalogue's figures. Sampling is measured in a process that has sized already, as
`drivesizer size --confidence` does it: points drawn or, from the second time on, taken from the cache, load cycles,
whether each drive fails in each sample, and of the drives that are printed margins and shares of every check. Beside
it the same of every drive. All in turns on the same machine in the same minutes, as processor time and wall clock;
without the closed loop. Then the plain evaluation, one sample of one drive at a time; and `drivesizer size
--confidence` over the whole catalogue, as it is called, with the best drives in closed loop, and with
``--loop-samples 0``: once each, for they take long.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import time
from pathlib import Path

from goals import line
from second_start import second_start

SPEC = Path(__file__).resolve().parent.parent / "examples" / "sps_robot.yaml"
CHANGES = {
    "method: paper": "method: physics",
    "mass: 45 kg ": "mass: 45 kg +- 3 kg ",
    "rolling_resistance: 0.02 ": "rolling_resistance: 0.02 in 0.015..0.03 ",
    "min: 22 V ": "min: normal(22 V, 0.2 V) ",
    "ambient: 25 degC ": "ambient: 25 degC +- 10 K ",
}
SETS, SAMPLES, SHOWN = 100, 10_000, 5
CONFIDENCE = "0.2"  # which drives of this machine reach, so that some are simulated


def written(folder: Path) -> Path:
    """The spec with tolerances."""
    text = SPEC.read_text(encoding="utf-8")
    text = text[: text.index("select:")]
    for old, new in CHANGES.items():
        assert old in text
        text = text.replace(old, new)
    path = folder / "robot.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def plainly(folder: Path) -> Path:
    """The same without."""
    text = SPEC.read_text(encoding="utf-8")
    path = folder / "plain.yaml"
    path.write_text(text[: text.index("select:")].replace("method: paper", "method: physics"), encoding="utf-8")
    return path


def sampled(path: Path) -> None:
    """Sample in a process of its own, and print processor time and wall clock."""
    from drivesizer.machine.problem import problem
    from drivesizer.search.search import search
    from drivesizer.search.shortlist import load_parts
    from drivesizer.search.uncertainty.options import Sampling
    from drivesizer.search.uncertainty.probabilities import sample_drives, subject
    from drivesizer.spec.robot import load_spec

    spec = load_spec(path)
    catalog = load_parts(spec)
    given = problem(spec, catalog)
    found = search(given, top=SETS, misses=0).evaluation
    subjects = {row: subject(found, row) for row in range(SETS)}
    processor, wall = time.process_time(), time.perf_counter()
    result = sample_drives(given, subjects, Sampling(SAMPLES, 1, float(CONFIDENCE)))
    shown = result.examined([*result.good[:SHOWN], *result.bad[:SHOWN]])
    taken = time.process_time() - processor, time.perf_counter() - wall
    assert len(result.good) + len(result.bad) == SETS and len(result.ready.values) == SAMPLES
    assert all((shown[row].reliability.probability >= float(CONFIDENCE)) == (row in result.good) for row in shown)
    processor = time.process_time()
    assert len(sample_drives(given, subjects, Sampling(SAMPLES, 1, None)).examined(subjects)) == SETS
    print(*taken, time.process_time() - processor)


def one_by_one(path: Path, samples: int) -> float:
    """Processor time of the plain evaluation, one sample at a time [s each]."""
    import numpy as np

    from drivesizer.machine.problem import problem
    from drivesizer.search.columns.evaluation import evaluate
    from drivesizer.search.search import search
    from drivesizer.search.shortlist import load_parts
    from drivesizer.spec.robot import load_spec

    spec = load_spec(path)
    catalog = load_parts(spec)
    found = search(problem(spec, catalog), top=1, misses=0).evaluation
    one = found.candidates.on(np.arange(1))
    start = time.process_time()
    for _ in range(samples):
        evaluate(problem(spec, catalog), one)
    return (time.process_time() - start) / samples


def process(command: list[str]) -> tuple[float, float, str]:
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    run = subprocess.run(command, check=True, capture_output=True, text=True)
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, wall, run.stdout


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--sample", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.sample:
        sampled(options.sample)
        return
    with second_start() as place:
        path, plain = written(place), plainly(place)
        whole = [sys.executable, "-m", "drivesizer", "size", str(plain)]
        process(whole)  # compiles the catalogue
        size, taken = [], []
        for _ in range(options.runs):
            size.append(process(whole)[:2])
            printed = process([sys.executable, __file__, "--sample", str(path)])[2]
            taken.append(tuple(map(float, printed.split())))
        each = one_by_one(path, 30)
        confident = [*whole[:-1], str(path), "--confidence", CONFIDENCE]
        process(confident)  # translates the loops
        looped, brief = (process([*confident, *more])[0] for more in ([], ["--loop-samples", "0"]))
    both = [(min(column) for column in zip(*times, strict=True)) for times in (size, taken)]
    (size_cpu, size_wall), (cpu, wall, every) = (tuple(one) for one in both)
    print(f"{'':40}{'processor':>12}{'wall clock':>12}")
    print(f"{'drivesizer size, whole process':40}{size_cpu:10.2f} s{size_wall:10.2f} s")
    print(f"{f'{SAMPLES:,} samples of {SETS} drives':40}{cpu:10.2f} s{wall:10.2f} s")
    first_cpu, first_wall = taken[0][:2]
    print(f"{'the first time, with the sampler loaded':40}{first_cpu:10.2f} s{first_wall:10.2f} s")
    print(f"{'samples / size':40}{cpu / size_cpu:12.2f}{wall / size_wall:12.2f}")
    print(f"{'with every check of every drive':40}{every / size_cpu:12.2f}")
    print(line("samples", cpu / size_cpu))
    print(line("confidence", looped / size_cpu))
    print(f"{'without the closed loop':40}{brief / size_cpu:12.2f}")
    slow = each * SAMPLES * SETS
    print(f"{'one by one, by the plain evaluation':40}{slow:10.0f} s   {slow / cpu:,.0f} times as long")


if __name__ == "__main__":
    main()
