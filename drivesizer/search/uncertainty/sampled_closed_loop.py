"""A drive in closed loop over samples: gains designed at nominal figures, machines that deviate from them.

Samples with the same motion, as a vehicle's of any mass and friction have, are simulated as one batch. Linear theory's
loops are those at nominal figures, and the winding's temperature is left to the sampled physics, which has it in
periodic steady state.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.closed_loop.checks import checks
from drivesizer.control.closed_loop.run import (
    ClosedLoop,
    Prepared,
    as_warm,
    limited,
    prepared,
    run,
    unlimited,
)
from drivesizer.control.engine import Simulation, Task, simulate
from drivesizer.load_cases.platform import WheelLoad, motion_of
from drivesizer.results.check import Check, LoopShare
from drivesizer.results.drive_set import DriveParts
from drivesizer.search.uncertainty.sampled_drive import deviating_drive
from drivesizer.search.uncertainty.sampling import REPLICATES, mean_and_error
from drivesizer.search.uncertainty.uncertain_figures import Assumption, applied, case_paths
from drivesizer.spec.robot import RobotSpec

Array = NDArray[np.float64]
_LOST = "the loop does not come to an end"


def loop_share(
    spec: RobotSpec, one: DriveParts, given: Sequence[Assumption], values: Array, samples: int
) -> LoopShare | None:
    """Share of samples in which no check of the closed loop fails; None of the wheels of a platform on its path."""
    if isinstance(spec.load, WheelLoad):
        return None
    nominal = run(spec, one, motion_of(spec))
    each = max(samples // REPLICATES, 1)
    rows = (np.arange(REPLICATES)[:, None] * (len(values) // REPLICATES) + np.arange(each)).reshape(-1)
    machines = [deviating(spec, one, given, values[row]) for row in rows]
    several = _checked(nominal, machines)
    share = mean_and_error(np.array([not any(check.status == "fail" for check in checks) for checks in several]))
    unknown = (check.title for checks in several for check in checks if check.status == "unknown" and not check.advice)
    return LoopShare(
        samples=len(rows), probability=share.value, error=share.error, weakest=_weakest(several),
        unknown=tuple(dict.fromkeys(unknown)),
    )  # fmt: skip


def deviating(
    spec: RobotSpec, one: DriveParts, given: Sequence[Assumption], values: Array
) -> tuple[RobotSpec, DriveParts]:
    """Machine and drive with the figures of one sample."""
    paths = case_paths(spec, None)
    moved = applied(spec, {path: float(values[k]) - given[k].nominal for k, path in paths.items()})
    factors: dict[str, dict[str, float]] = {"motor": {}, "gearhead": {}, "controller": {}}
    for k, assumption in enumerate(given):
        if assumption.catalogue:
            of_part, figure = factors[assumption.catalogue.part], assumption.catalogue.figure
            assert figure not in of_part, f"{assumption.name}: of another maker's part"
            of_part[figure] = float(values[k])
    return moved, deviating_drive(one, moved, factors)


def _checked(nominal: ClosedLoop, machines: Sequence[tuple[RobotSpec, DriveParts]]) -> list[tuple[Check, ...]]:
    """The checks of each machine with the nominal one's controller: from cold, without limits, and in steady state."""
    motions = [nominal.profile if spec.motion == nominal.spec.motion else motion_of(spec) for spec, _ in machines]
    made = [prepared(*machine, motion, nominal.controller) for machine, motion in zip(machines, motions, strict=True)]
    cold = _simulated(made)
    free, warm, found = _freed(made, cold, nominal), _warm(made, nominal), list[tuple[Check, ...]]()
    for (spec, drive), motion, one, out, alone, steady in zip(machines, motions, made, cold, free, warm, strict=True):
        if out.problems[0]:
            found.append((replace(checks(nominal)[0], status="fail", title=_LOST),))
            continue
        loop = ClosedLoop(
            spec, drive, motion, one.train, one.controller, nominal.loops, one.usable_voltage, one.task,
            out, alone, {}, one.assumptions, steady_cycle=steady,
        )  # fmt: skip
        found.append(tuple(check for check in checks(loop) if check.name != "winding_temperature"))
    return found


def _weakest(found: Sequence[tuple[Check, ...]]) -> str:
    """The check that fails most often, else that with the smallest margin in the mean."""
    failed = Counter(check.title for checks in found for check in checks if check.status == "fail")
    if failed:
        return failed.most_common(1)[0][0]
    margins: dict[str, list[float]] = {}
    for check in chain.from_iterable(found):
        if check.margin == check.margin:
            margins.setdefault(check.title, []).append(check.margin)
    return min(margins, key=lambda title: float(np.mean(margins[title])), default="")


def _warm(made: Sequence[Prepared], nominal: ClosedLoop) -> list[tuple[Simulation, ...]]:
    """A cycle of each that begins as warm as the nominal one's, and without limits; none where that is unknown."""
    if nominal.steady_start is None:
        return [()] * len(made)
    warmer = [
        one._replace(drive=as_warm(one.drive, nominal.steady_start), task=replace(one.task, cycles=1)) for one in made
    ]
    found = _simulated(warmer)
    return [
        () if out.problems[0] else (out, free) for out, free in zip(found, _freed(warmer, found, nominal), strict=True)
    ]


def _freed(made: Sequence[Prepared], found: Sequence[Simulation], nominal: ClosedLoop) -> list[Simulation]:
    """The same without limits where any was met; one that cannot be simulated without them is as it is with them."""
    places = [n for n, out in enumerate(found) if not out.problems[0] and limited(out, nominal.loops)]
    free = [*found]
    for n, out in zip(
        places, _simulated([made[n]._replace(drive=unlimited(made[n].drive)) for n in places]), strict=True
    ):
        free[n] = found[n] if out.problems[0] else out
    return free


def _simulated(made: Sequence[Prepared]) -> list[Simulation]:
    """Each on its task; those with the same task side by side."""
    tasks: list[Task] = []
    for one in made:
        if one.task not in tasks:
            tasks.append(one.task)
    found: dict[int, Simulation] = {}
    for task in tasks:
        places = [n for n, one in enumerate(made) if one.task == task]
        together = simulate([made[n].drive for n in places], task, rows=0)
        for k, n in enumerate(places):
            figures = {name: column[k : k + 1] for name, column in together.figures.items()}
            found[n] = Simulation(figures=figures, problems=(together.problems[k],), series=None)
    return [found[n] for n in range(len(made))]
