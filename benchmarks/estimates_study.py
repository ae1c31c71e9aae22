"""Sizings with figures estimated from peers beside sizings without: all starters and examples, and random machines.

Counts how often the first drive changes and by how much of its mass, and what the drives that an estimate concerns
become: candidates that pass or may pass in either sizing, the same drive in both. Random machines are starters with
loads, speeds and pauses drawn over decades, another supply and other catalogues; the same numbers give the same
machines. What no rule explains is listed: a drive that passes without estimates and does not with them, an explained
drive that is not what the search says, a machine that takes long or fails.
"""

from __future__ import annotations

import argparse
import re
import tempfile
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from functools import cache
from importlib import resources
from multiprocessing import Pool
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import yaml

from drivesizer.catalog import Catalog, load
from drivesizer.catalog.view import search_view
from drivesizer.errors import DrivesizerError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.machine.problem import problem
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.sizing import SizingResult
from drivesizer.search.columns.candidates import Candidates
from drivesizer.search.columns.evaluation import Evaluation, evaluate
from drivesizer.search.open_checks import estimated
from drivesizer.search.passing import sifted
from drivesizer.sizing import explain, size
from drivesizer.spec.robot import RobotSpec, read_spec

ROOT = Path(__file__).resolve().parent.parent
STARTERS = resources.files("drivesizer.spec") / "starters"
LOADS = {"mass", "belt_mass", "inertia", "friction_torque", "friction_force", "force", "preload_torque", "rated_torque"}
SPEEDS = {"speed", "rated_speed", "acceleration", "jerk", "to", "turning_speed", "turning_acceleration"}
DURATIONS = {"time"}  # of a profile without a speed
PAUSES = {"rest_time", "pause", "cruise_time"}
CATALOGUES = (
    *(["maxon"], ["faulhaber"], ["maxon", "faulhaber"]) * 2,
    *([name] for name in ("robotis", "cubemars", "myactuator", "robstride", "pololu", "gobilda")),
    ["robotis", "pololu", "gobilda"],
    ["cubemars", "robstride", "myactuator"],
    ["maxon", "faulhaber", "robotis", "cubemars", "myactuator", "robstride", "pololu", "gobilda"],
)
SUPPLIES = ({"accepts": "all"},) * 8 + ({}, {"capacitance": "10 mF"})
SLOW = 5.0  # s
DRAWS = 8  # of a machine at most, until its catalogues have a drive for it
SAME = 100  # drives of a machine at most whose checks are compared
STATUSES = ("pass", "open", "unknown", "fail")


class Machine(NamedTuple):
    """A spec of the study."""

    name: str
    text: str
    file: str


class Seen(NamedTuple):
    """Results of one machine."""

    name: str
    first: str  # what became of the first drive
    mass: float  # of the first drive with estimates over that without; NaN where it is the same or one is missing
    status: Counter[tuple[str, str]]  # drives by status without and with estimates
    missing: Counter[str]  # estimated figures of drives that are unknown without them
    left: Counter[str]  # checks that stay unknown
    seconds: tuple[float, float]  # without, with
    odd: tuple[str, ...]  # what no rule explains


def machines(number: int, seed: int, folder: Path) -> Iterator[Machine]:
    """Starters, examples and random machines."""
    rng = np.random.default_rng(seed)
    names = sorted(entry.name for entry in STARTERS.iterdir() if entry.name.endswith(".yaml"))
    texts = {name[:-5]: (STARTERS / name).read_text(encoding="utf-8") for name in names}
    for name, text in texts.items():
        recording(folder / "cycle.csv", 1.0, 1.0)
        yield Machine(f"starter {name}", text, str(folder / "robot.yaml"))
    for path in sorted((ROOT / "examples").glob("*.yaml")):
        if path.name != "study.yaml":
            yield Machine(f"example {path.stem}", path.read_text(encoding="utf-8"), str(path))
    kinds = list(texts)
    for n in range(number):
        for _ in range(DRAWS):
            kind = kinds[rng.integers(len(kinds))]
            data = varied(yaml.safe_load(texts[kind]), rng, folder / f"cycle{n}.csv")
            drawn = Machine(f"{n} {kind}", yaml.safe_dump(data, sort_keys=False), str(folder / "robot.yaml"))
            if served(drawn):
                break
        yield drawn


def served(machine: Machine) -> bool:
    """Whether the catalogues have a drive for a machine, with estimates."""
    try:
        both, specs = sides(machine)
        return len(sifted(problem(specs[1], both[1]), pareto=("mass",))[0].sets.motor) > 0
    except DrivesizerError:
        return False


def varied(data: dict[str, Any], rng: np.random.Generator, cycle: Path) -> dict[str, Any]:
    """A starter with another load, speed, duty, supply and catalogues."""
    load_, pace, pause = 10.0 ** rng.uniform([-1.6, -0.7, -1.0], [0.4, 0.3, 1.0])
    if "platform" in data:
        load_, pace = load_**0.3, pace**0.5  # a path within the grip of its wheels
        data.pop("budget")
    by = dict.fromkeys(LOADS, load_) | dict.fromkeys(SPEEDS, pace) | dict.fromkeys(PAUSES, pause)
    if data.get("motion", {}).get("profile") == "triangle":
        by |= dict.fromkeys(DURATIONS, 1.0 / pace)
    for section in ("load", "motion", "platform", "cases"):
        if section in data:
            data[section] = scaled(data[section], by)
    if data["load"]["kind"] == "recorded":
        recording(cycle, load_, pace)
        data["load"]["file"] = cycle.name
    volts = (12, 24, 48)[rng.integers(3)]
    if "battery" not in data:
        supply = {"nominal": f"{volts} V", "min": f"{0.92 * volts} V", "max": f"{1.12 * volts} V", "regeneration": 0.5}
        data["supply"] = supply | SUPPLIES[rng.integers(len(SUPPLIES))]
    data.pop("needs", None)
    data["select"] = {
        "catalogs": CATALOGUES[rng.integers(len(CATALOGUES))],
        "objective": "mass",
    }
    return data


def scaled(value: Any, by: dict[str, float], key: str = "") -> Any:
    """A section of a spec with the quantities under some keys multiplied."""
    if isinstance(value, dict):
        return {name: scaled(inner, by, name) for name, inner in value.items()}
    if isinstance(value, list):
        return [scaled(inner, by, key) for inner in value]
    found = re.fullmatch(r"(-?[\d.]+) (.+)", value) if isinstance(value, str) and key in by else None
    return f"{float(found[1]) * by[key]:.4g} {found[2]}" if found else value


def recording(path: Path, torque: float, speed: float) -> None:
    """A cycle with a pause: up, on, down against a braking torque."""
    rows = ((0.0, 0, 0.2), (0.5, 40, 1.4), (2.5, 40, 0.9), (3.0, 0, -0.3), (4.0, 0, 0.0))
    text = "".join(f"{t},{speed * n:.6g},{torque * m:.6g}\n" for t, n, m in rows)
    path.write_text(f"time,speed,torque\ns,rpm,N*m\n{text}", encoding="utf-8")


@cache
def catalogues(names: tuple[str, ...], beside: str) -> tuple[Catalog, Catalog]:
    """Catalogues for the search without and with estimates."""
    whole = load(names, beside=Path(beside))
    return search_view(whole, False), search_view(whole, True)


def with_estimates(spec: RobotSpec, state: str) -> RobotSpec:
    return spec.model_copy(update={"select": spec.select.model_copy(update={"estimates": state})})


def sides(machine: Machine) -> tuple[tuple[Catalog, Catalog], tuple[RobotSpec, RobotSpec]]:
    """Catalogues and specs without and with estimates."""
    base = read_spec(YamlSource(machine.text, machine.file))
    both = catalogues(tuple(base.select.catalogs), str(Path(machine.file).parent))
    return both, (with_estimates(base, "off"), with_estimates(base, "on"))


def compared(machine: Machine) -> Seen:
    """One machine sized without and with estimates."""
    nothing: Counter[Any] = Counter()
    try:
        both, specs = sides(machine)
        results, seconds = [], []
        for spec, catalog in zip(specs, both, strict=True):
            start = time.perf_counter()
            results.append(size(spec, catalog=catalog, top=5))
            seconds.append(time.perf_counter() - start)
        off, on = results
        odd = [f"takes {max(seconds):.1f} s"] if max(seconds) > SLOW else []
        odd += list(alone(on, both[1]))
        status, missing, left = nothing.copy(), nothing.copy(), nothing.copy()
        if off.method == "physics":
            status, missing, left, found = same_drives(off, on, np.random.default_rng(1))
            odd += found
        first, mass = change(off, on)
        return Seen(machine.name, first, mass, status, missing, left, (seconds[0], seconds[1]), tuple(odd))
    except DrivesizerError as error:
        return Seen(machine.name, "refused", np.nan, nothing, nothing, nothing, (np.nan, np.nan), (str(error)[:200],))


def change(off: SizingResult, on: SizingResult) -> tuple[str, float]:
    """What became of the first drive, and its mass over what it was."""
    if not off.sets or not on.sets:
        return ("none in either" if not off.sets and not on.sets else f"none {'off' if on.sets else 'on'}"), np.nan
    before, after = off.sets[0], on.sets[0]
    status = f"{before.status} -> {after.status}"
    if before.label == after.label and before.belt_ratio == after.belt_ratio:
        return f"same, {status}", np.nan
    return f"other, {status}", after.mass / before.mass


def alone(found: SizingResult, catalog: Catalog) -> Iterator[str]:
    """What explaining the first drive says otherwise, where the machine is as heavy for all."""
    budget = found.spec.budget
    if found.method != "physics" or not found.sets or (budget and budget.drive_counts):
        return
    drive = found.sets[0]
    gearhead = "" if drive.actuator else drive.gearhead.part
    again = explain(found.spec, drive.motor.part, gearhead, catalog=catalog)
    same = next((facts(one) for one in again if one.belt_ratio == drive.belt_ratio), None)
    if facts(drive) != same:
        yield f"{drive.label}: {facts(drive)} by size, {same} by explain"


def facts(drive: DriveSet) -> tuple[Any, ...]:
    return drive.status, [(check.name, check.status) for check in drive.own_checks if check.status != "pass"]


class Both(NamedTuple):
    """Some drives without and with estimates."""

    off: Evaluation
    on: Evaluation


def same_drives(
    off: SizingResult, on: SizingResult, rng: np.random.Generator
) -> tuple[Counter[Any], Counter[str], Counter[str], list[str]]:
    """Drives that pass or may pass in either sizing: status in both, missing figures, checks left, what is odd."""
    kept = [sifted(found.problem, pareto=("mass",))[0] for found in (off, on)]
    key = [list(zip(*(k.sets[n].tolist() for n in range(3)), strict=True)) for k in kept]
    certain = [dict(zip(k, one.certainty.tolist(), strict=True)) for k, one in zip(key, kept, strict=True)]
    every = sorted(set().union(*key))
    if not every:
        return Counter(), Counter(), Counter(), []
    if len(every) > SAME:
        every = [every[n] for n in sorted(rng.choice(len(every), SAME, replace=False).tolist())]
    motor, gearhead, belt = (np.array(side) for side in zip(*every, strict=True))
    sets = Candidates(motor, gearhead, belt.astype(float), np.ones(len(every), bool))
    both = Both(*(evaluate(found.problem, sets) for found in (off, on)))
    status, missing, left, odd = Counter[Any](), Counter[str](), Counter[str](), list[str]()
    for row, drive in enumerate(every):
        before, after = (one.status(row) for one in both)
        status[before, after] += 1
        if before == "unknown":
            missing.update({figure.title for figure in estimated(both.on, row)} or {"none estimated"})
        if after == "unknown":
            left.update(name for name, one in not_passed(both.on, row) if one == "unknown")
        odd += [text for text in judged(both, row) if text]
        for found, one, now in zip(("off", "on"), certain, (before, after), strict=True):
            searched = ("pass", "open", "unknown")[one[drive]] if drive in one else "fail"
            if (searched == "fail") != (now == "fail") or (searched == "open") > (now in ("open", "unknown")):
                odd.append(f"estimates {found}: {searched} by search, {now} alone: {named(both, row)}")
    return status, missing, left, odd


def not_passed(found: Evaluation, row: int) -> list[tuple[str, str]]:
    checks = [check.on(np.array([row])) for check in found.checks if not check.advice]
    names = [(check.name, "open" if check.opened is not None and check.opened[0] else "fail" if check.failed[0]
              else "pass" if check.passed[0] else "unknown") for check in checks]  # fmt: skip
    return [(name, status) for name, status in names if status != "pass"]


# a controller of which no loss is printed loses 1 V per ampere with estimates, nothing without: more power is drawn,
# less is returned; and a drive may then get another controller
BY_LOSSES = {"supply_power", "supply_current", "bus_voltage"}


def judged(both: Both, row: int) -> Iterator[str]:
    """Checks that an estimate turned from decided to something else."""
    before, after = (dict(not_passed(one, row)) for one in both)
    for name in before.keys() | after.keys():
        was, now = before.get(name, "pass"), after.get(name, "pass")
        undecided = both.on.status(row) == "fail" and now in ("open", "unknown")  # of what fails not all is computed
        if was in ("pass", "fail") and was != now and name not in BY_LOSSES and not undecided:
            yield f"{name} {was} -> {now}: {named(both, row)}"


def named(both: Both, row: int) -> str:
    catalog, sets = both.on.catalog, both.on.candidates
    parts = catalog.motors["part"][sets.motor[row]], catalog.gearheads["part"][sets.gearhead[row]]
    return f"{parts[0]} + {parts[1]}, belt {sets.belt[row]:g}"


def report(found: list[Seen]) -> None:
    """The tables."""
    groups = {
        "starters and examples": [one for one in found if not one.name[0].isdigit()],
        "random machines": [one for one in found if one.name[0].isdigit()],
    }
    for title, some in groups.items():
        print(f"\n{title}: {len(some)}")
        for first, count in Counter(one.first for one in some).most_common():
            print(f"  first drive {first:32}{count:6}")
        ratios = np.array([one.mass for one in some if one.mass == one.mass])
        if len(ratios):
            lighter, heavier = (ratios < 0.999).sum(), (ratios > 1.001).sum()
            middle = ", ".join(f"{x:.2f}" for x in np.quantile(ratios, (0.0, 0.25, 0.5, 0.75, 1.0)))
            print(f"  of another first drive: {lighter} lighter, {heavier} heavier; mass after / before {middle}")
        status = sum((one.status for one in some), Counter[Any]())
        print(f"  {'drives, without -> with':24}" + "".join(f"{name:>10}" for name in STATUSES))
        for before in STATUSES:
            if row := [status[before, after] for after in STATUSES]:
                print(f"  {before:24}" + "".join(f"{count:10,}" for count in row))
        for what, name in (("missing", "estimated figures of those unknown without"), ("left", "checks left unknown")):
            total = sum((getattr(one, what) for one in some), Counter[str]())
            print(f"  {name}: " + ", ".join(f"{key} {count:,}" for key, count in total.most_common(8)))
        seconds = np.array([one.seconds for one in some if one.seconds[0] == one.seconds[0]])
        if len(seconds):
            ratio = np.quantile(seconds[:, 1] / seconds[:, 0], (0.5, 0.9))
            total_ = seconds.sum(axis=0)
            sums = f"{total_[1] / total_[0]:.2f} of all, {ratio[0]:.2f} median, {ratio[1]:.2f} in one of ten"
            print(f"  time with / without: {sums}; longest {seconds.max():.1f} s")
    for one in found:
        for text, count in Counter(re.sub(r":.*", "", odd) for odd in one.odd).items():
            example = next(odd for odd in one.odd if odd.startswith(text))
            print(f"odd: {one.name}: {count} x {example}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--machines", type=int, default=200, help="random ones")
    parser.add_argument("--seed", type=int, default=19)
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--keep", type=Path, help="folder for the specs and a line for each")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = (given.keep or Path(scratch)).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        every = kept(machines(given.machines, given.seed, folder), folder)
        with Pool(given.processes) as pool, (folder / "done.txt").open("w", encoding="utf-8") as lines:
            found = []
            for one in pool.imap(compared, every):
                found.append(one)
                print(*one, sep="; ", file=lines, flush=True)
    report(found)


def kept(every: Iterable[Machine], folder: Path) -> Iterator[Machine]:
    """The same machines, each written to a file."""
    for one in every:
        (folder / f"{one.name.replace(' ', '_')}.yaml").write_text(one.text, encoding="utf-8")
        yield one


if __name__ == "__main__":
    main()
