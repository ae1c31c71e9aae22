"""Laws that every sizing keeps, on random machines.

    python tests/campaign/laws.py 1000             # machines 0 to 999
    python tests/campaign/laws.py 1000 --first 5000 --only monotony

A machine is a spec of ``laws_machines``, every eighth with a robot of several joints beside it; its best drives and
closest rejected ones are looked at. What breaks a law is printed with the number that makes the machine again; counts
and the share of each law stand at the end. A line is a question, no verdict: a heavier load on a slope, say, helps a
brake.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from itertools import zip_longest
from math import inf, isnan, nan
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))  # this tree's program
sys.path.insert(0, str(Path(__file__).parent))
from laws_case import (
    DRIVES,
    SAME,
    Case,
    alike,
    brief,
    case_of,
    differences,
    joints_of,
    parts_of,
    same_everywhere,
    spec_of,
)
from laws_choice import more_to_choose_from, one_part, proposals
from laws_machines import LOAD, WHOLE, Plain, backwards, catalogue, in_other_units, scaled_by, several_cases

from drivesizer.errors import DrivesizerError, InputError
from drivesizer.multi_axis import size_machine
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.results.check import Check
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.problem import Problem
from drivesizer.sizing import size
from drivesizer.spec.machine import load_machine

__all__ = ["LAWS", "Case", "broken"]

ROBOTS = 8  # of so many machines there is a robot of joints beside one
RANKS = {"fail": 0, "unknown": 1, "open": 1, "pass": 2}


# --- laws -------------------------------------------------------------------------------------------------------------


def search_and_explain(case: Case) -> Iterator[str]:
    """The search and ``explain`` say the same of a drive: its encoder, controller, brake, checks."""
    for drive, alone in zip((*case.found.sets, *case.found.misses), case.explained, strict=False):
        for text in differences(drive, alone):
            yield f"{drive.label}: {text}"


def units(case: Case) -> Iterator[str]:
    """The units in which a spec is written change nothing."""
    kept = {name: case.data[name] for name in ("name", "select")}
    yield from same_everywhere(case, in_other_units(case.data) | kept)


def _two(case: Case) -> list[Plain]:
    hot = {"name": "hot", "environment": {"ambient": "48 degC"}}
    slower = scaled_by(case.data, "load", LOAD, 1.3)["load"]
    changed = {key: value for key, value in slower.items() if value != case.data["load"].get(key)}
    return (
        [hot, {"name": "laden", "load": changed}]
        if changed
        else [hot, {"name": "mild", "environment": {"ambient": "1 degC"}}]
    )


def order_of_cases(case: Case) -> Iterator[str]:
    """The order of the load cases changes nothing."""
    cases = _two(case)
    there, back = several_cases(case.data, cases), several_cases(case.data, cases[::-1])
    for drive in case.drives:
        for text in differences(case.again(there, drive), case.again(back, drive)):
            yield f"{drive.label}: {text}"


def given_twice(case: Case) -> Iterator[str]:
    """A load case that is the spec once more changes no check."""
    yield from same_everywhere(
        case, several_cases(case.data, [{"name": "again", "environment": case.data["environment"]}])
    )


def worst_case(case: Case) -> Iterator[str]:
    """Of two cases every check has the worse margin, for the same encoder, controller and brake."""
    (_, second) = _two(case)
    plain = {key: value for key, value in case.data.items() if key != "cases"}  # they take their figures of the rest
    merged = plain | {name: plain.get(name, {}) | second.get(name, {}) for name in ("load", "environment")}
    for drive in case.drives:
        three = [case.again(data, drive) for data in (several_cases(plain, [second]), plain, merged)]
        if len({parts_of(one) for one in three}) > 1:
            continue
        tables = [{c.name: c for c in one.own_checks} for one in three]
        for name in tables[0].keys() & tables[1].keys() & tables[2].keys():
            of_both, *each = (table[name] for table in tables)
            margins = [c.margin for c in each]
            if not any(map(isnan, (*margins, of_both.margin))) and not alike(of_both.margin, min(margins)):
                yield f"{drive.label}: {name} {of_both.margin!r} of {margins}"


def order_of_catalogues(case: Case) -> Iterator[str]:
    """The order of catalogues changes no drive and no figure."""
    names = case.data["select"]["catalogs"]
    first, other = (catalogue(*some) for some in ([*names, "amc"], ["amc", *names[::-1]]))
    yield from _same_drives(*(size(case.found.spec, catalog=parts, top=DRIVES).sets for parts in (first, other)))


def order_of_parts(case: Case) -> Iterator[str]:
    """The order of tables in a catalogue, and of rows in a table, changes no drive and no figure."""
    if case.data["select"]["catalogs"] == WHOLE:  # minutes of writing
        return
    other = backwards(*case.data["select"]["catalogs"])
    found = size(case.found.spec, catalog=other, top=DRIVES)
    yield from _same_drives(case.found.sets, found.sets)
    yield from _same_drives(case.found.misses, found.misses)


def _same_drives(some: tuple[DriveSet, ...], others: tuple[DriveSet, ...]) -> Iterator[str]:
    for one, two in zip_longest(some, others):
        if one is None or two is None:
            yield f"{one and one.label} / {two and two.label}"
        else:
            for text in differences(one, two):
                yield f"{one.label}: {text}"


def one_axis(case: Case) -> Iterator[str]:
    """A machine of one axis is the plain spec."""
    shared = {
        key: value for key, value in case.data.items() if key in ("name", "supply", "select", "environment", "margins")
    }
    axis = {key: value for key, value in case.data.items() if key not in shared}
    if case.data["load"]["kind"] == "recorded":
        axis["load"] = axis["load"] | {"file": str(case.folder / axis["load"]["file"])}
    result = size_machine(load_machine(shared | {"axes": {"only": axis}}), top=1)
    found = result.axes[0].best
    first = case.found.sets[0] if case.found.sets else None
    if (found is None) != (first is None):
        yield f"{first and first.label} / {found and found.label}"
    elif found is not None and first is not None:
        yield from differences(first, found)


# --- monotony ---------------------------------------------------------------------------------------------------------


def burdens(data: Plain) -> Iterator[tuple[str, Plain, Plain]]:
    """Specs of which one requires more than the other, each in one respect: its name, the lighter one, the heavier."""
    yield "mass", data, scaled_by(data, "load", {"mass", "inertia"}, 1.25)
    supply = data.get("supply", {})
    if "nominal" in supply:
        lowest = float(supply.get("min", supply["nominal"]).split()[0])
        yield "voltage", data, data | {"supply": supply | {"min": f"{0.9 * lowest:.6g} V"}}
        yield "voltage", data | {"supply": supply | {"min": supply["nominal"]}}, data
    ambient = int(data["environment"]["ambient"].split()[0])
    yield "ambient", data, data | {"environment": {"ambient": f"{ambient + 15} degC"}}
    yield "ambient", data | {"environment": {"ambient": f"{max(ambient - 10, 5)} degC"}}, data
    yield "rest", data, scaled_by(data, "motion", {"rest_time", "pause"}, 0.5)


def monotony(case: Case) -> Iterator[str]:
    """More mass, a lower voltage, hotter surroundings, shorter rests: no check that failed passes, parts alike.

    A line about a voltage or a speed in hotter surroundings is no fault of the program: magnets are weaker there, a
    motor turns faster, and its voltage may suffice where it did not.
    """
    for name, light, heavy in burdens(case.data):
        if light == heavy:
            continue
        for drive in case.drives:
            try:
                one, two = (drive if data is case.data else case.again(data, drive) for data in (light, heavy))
            except InputError:  # a wheel that slips
                continue
            if parts_of(one) == parts_of(two):
                yield from _easier(name, one, two)


def _easier(name: str, light: DriveSet, heavy: DriveSet) -> Iterator[str]:
    before, after = ({c.name: c for c in one.own_checks} for one in (light, heavy))
    for check in before.keys() & after.keys():
        if RANKS[before[check].status] == 0 < RANKS[after[check].status]:
            yield f"{name}: {light.label}: {check}: {_said(before[check])} / {_said(after[check])}"


def _said(check: Check) -> str:
    return f"{check.status} {check.demand:.5g} of {check.limit:.5g}"


def needs_cost(case: Case) -> Iterator[str]:
    """A further need makes no best drive better."""
    if not case.found.sets or case.found.sets[0].status != "pass":
        return
    best = case.found.sets[0].objective
    more: tuple[Plain, ...] = ({"diameter": "45 mm"}, {"encoder_counts": 500}, {"length": "150 mm"})
    for need in more:
        try:
            spec = spec_of(case.data | {"needs": need | case.data.get("needs", {})}, case.folder)
            found = size(spec, catalog=catalogue(*spec.select.catalogs), top=1)
        except InputError:
            continue
        if found.sets and found.sets[0].status == "pass" and found.sets[0].objective < best * (1.0 - SAME):
            yield f"{need}: {found.sets[0].objective:.6g} of {found.sets[0].label}, without {best:.6g}"


# --- limits -----------------------------------------------------------------------------------------------------------


def limits(case: Case) -> Iterator[str]:
    """A demand above its limit never passes."""
    for drive in (*case.found.sets, *case.found.misses):
        for check in drive.every_check:
            if check.status == "pass" and check.demand > check.limit + 1e-9 * abs(check.limit):
                yield f"{drive.label}: {check.name}: {_said(check)}"


def peaks(case: Case) -> Iterator[str]:
    """A drive whose printed peak or stall is below what the load alone takes of it, without losses, fails."""
    problem = case.found.problem
    for drive in (*case.found.sets, *case.found.unsure, *case.found.misses):
        if drive.status == "fail":
            continue
        for name, printed, torque in _printed_peaks(drive, problem):
            if torque > printed * 1.0001:
                yield f"{drive.label}: {drive.status} with {name} {printed:.5g} N·m, the load takes {torque:.5g} N·m"


def _printed_peaks(drive: DriveSet, problem: Problem) -> Iterator[tuple[str, float, float]]:
    """Peak and stall torques of its parts that makers print, each with the largest of the load there [N*m]."""
    at_gearhead = max(_driving_torque(one.cycle) for one in problem.cases) / drive.belt_ratio
    volts = problem.supply[1] / (drive.motor.nominal_voltage or inf)  # a stall torque is that at the printed voltage
    more = {"peak_torque": 1.0, "intermittent_torque": 1.0, "stall_torque": volts if volts > 1.0 else 1.0}
    estimated = {(one.part, one.figure): one.high for one in drive.estimated}  # a rule of thumb is no maker's limit
    motor, gearhead = ("motor", drive.motor, drive.gearhead.ratio), ("gearhead", drive.gearhead, 1.0)
    for kind, part, ratio in [("actuator", drive.actuator, 1.0)] if drive.actuator else [motor, gearhead]:
        for name, factor in more.items():
            printed = estimated.get((kind, name), getattr(part, name, nan))
            yield f"{kind}'s {name}", factor * printed, at_gearhead / ratio


def _driving_torque(cycle: LoadCycle) -> float:
    """Largest torque of the load at its shaft where it is driven or held [N*m]."""
    driven = cycle.torque * cycle.speed >= 0.0
    return float(np.abs(cycle.torque[driven]).max(initial=0.0))


LAWS: dict[str, Callable[[Case], Iterator[str]]] = {
    "search and explain": search_and_explain,
    "units": units,
    "order of cases": order_of_cases,
    "a case twice": given_twice,
    "worst case": worst_case,
    "order of catalogues": order_of_catalogues,
    "order of parts": order_of_parts,
    "one axis": one_axis,
    "monotony": monotony,
    "needs cost": needs_cost,
    "limits": limits,
    "peaks": peaks,
    "more to choose from": more_to_choose_from,
    "one part": one_part,
    "proposals": proposals,
}
OF_A_SIZING = ("limits", "peaks")  # laws that look at a sizing alone, of a robot's joints too


def broken(case: Case, law: str) -> list[str]:
    """What breaks a law on a machine; a refusal counts too, for the machine itself was none."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            return list(LAWS[law](case))
        except DrivesizerError as error:
            return [f"refused: {error}"]


def main() -> int:
    """Try some machines; 1 where a law is broken."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("count", type=int)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--all", action="store_true", help="every machine with all catalogues")
    parser.add_argument("--only", default="", help="laws whose names begin so, such as limits,peaks")
    given = parser.parse_args()
    laws = [name for name in LAWS if name.startswith(tuple(given.only.split(",")))]
    tried, wrong = 0, Counter[str]()
    with tempfile.TemporaryDirectory() as scratch, warnings.catch_warnings(), brief():
        warnings.simplefilter("ignore")
        for number in range(given.first, given.first + given.count):
            case = case_of(number, Path(scratch), whole=given.all, alone=not set(laws) <= {*OF_A_SIZING})
            tried += case is not None
            joints = joints_of(number, Path(scratch)) if number % ROBOTS == 0 else []
            for one in filter(None, (case, *joints)):
                for law in laws if one is case else set(laws) & {*OF_A_SIZING}:
                    lines = broken(one, law)
                    wrong[law] += bool(lines)
                    for line in lines[:3]:
                        print(f"{number} {law}: {line}", flush=True)
            if (done := number + 1 - given.first) % 10 == 0:
                print(f"{done} of {given.count}", file=sys.stderr, flush=True)
    print(f"{tried} machines with drives to look at; broken: {dict(wrong)}")
    return bool(sum(wrong.values()))


if __name__ == "__main__":
    sys.exit(main())
