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

from drivesizer.control.closed_loop import ClosedLoop, as_warm, prepared, run, simulated, without_limits
from drivesizer.control.closed_loop.checks import checks
from drivesizer.control.engine import Drive, Task
from drivesizer.load_cases.platform import WheelLoad, motion_of
from drivesizer.physics.figures import Array
from drivesizer.results.check import Check, LoopShare
from drivesizer.results.drive_set import DriveParts
from drivesizer.search.uncertainty.sampled_drive import deviating_drive
from drivesizer.search.uncertainty.sampling import REPLICATES, mean_and_error
from drivesizer.search.uncertainty.uncertain_figures import Assumption, applied, case_paths
from drivesizer.spec.robot import RobotSpec

_LOST = "the loop does not come to an end"


def loop_share(
    spec: RobotSpec, drive: DriveParts, assumptions: Sequence[Assumption], values: Array, samples: int
) -> LoopShare | None:
    """Share of samples in which no check of the closed loop fails; None of the wheels of a platform on its path."""
    if isinstance(spec.load, WheelLoad):
        return None
    nominal = run(spec, drive, motion_of(spec))
    count = max(samples // REPLICATES, 1)
    rows = (np.arange(REPLICATES)[:, None] * (len(values) // REPLICATES) + np.arange(count)).reshape(-1)
    machines = [deviating(spec, drive, assumptions, values[row]) for row in rows]
    several = _checked(nominal, machines)
    share = mean_and_error(np.array([not any(check.status == "fail" for check in checks) for checks in several]))
    unknown = (check.title for checks in several for check in checks if check.status == "unknown" and not check.advice)
    return LoopShare(
        samples=len(rows), probability=share.value, error=share.error, weakest=_weakest(several),
        unknown=tuple(dict.fromkeys(unknown)),
    )  # fmt: skip


def deviating(
    spec: RobotSpec, drive: DriveParts, assumptions: Sequence[Assumption], values: Array
) -> tuple[RobotSpec, DriveParts]:
    """Machine and drive with the figures of one sample."""
    paths = case_paths(spec, None)
    sample_spec = applied(spec, {path: float(values[k]) - assumptions[k].nominal for k, path in paths.items()})
    factors = {a.catalogue: float(values[k]) for k, a in enumerate(assumptions) if a.catalogue}
    return sample_spec, deviating_drive(drive, sample_spec, factors)


def _checked(nominal: ClosedLoop, machines: Sequence[tuple[RobotSpec, DriveParts]]) -> list[tuple[Check, ...]]:
    """The checks of each machine with the nominal one's controller: from cold, without limits, and in steady state."""
    motions = [nominal.profile if spec.motion == nominal.spec.motion else motion_of(spec) for spec, _ in machines]
    setups = [prepared(*machine, motion, nominal.controller) for machine, motion in zip(machines, motions, strict=True)]
    cold, warm = [(setup.drive, setup.task) for setup in setups], list[tuple[Drive, Task]]()
    if nominal.steady_start is not None:  # a cycle of each that begins as warm as the nominal one's
        warm = [(as_warm(drive, nominal.steady_start), replace(task, cycles=1)) for drive, task in cold]
    outs, steady = simulated(cold), simulated(warm)
    free, steady_free = without_limits(cold, outs, nominal.loops), without_limits(warm, steady, nominal.loops)
    cycles = [() if out.problems[0] else (out, alone) for out, alone in zip(steady, steady_free, strict=True)]
    all_checks = list[tuple[Check, ...]]()
    for setup, out, alone, cycle in zip(setups, outs, free, cycles or [()] * len(setups), strict=True):
        if out.problems[0]:
            all_checks.append((replace(checks(nominal)[0], status="fail", title=_LOST),))
            continue
        loop = ClosedLoop(**vars(setup), loops=nominal.loops, out=out, unlimited=alone, periodic={}, steady_cycle=cycle)
        all_checks.append(tuple(check for check in checks(loop) if check.name != "winding_temperature"))
    return all_checks


def _weakest(all_checks: Sequence[tuple[Check, ...]]) -> str:
    """The check that fails most often, else that with the smallest margin in the mean."""
    failed = Counter(check.title for checks in all_checks for check in checks if check.status == "fail")
    if failed:
        return failed.most_common(1)[0][0]
    margins: dict[str, list[float]] = {}
    for check in chain.from_iterable(all_checks):
        if check.margin == check.margin:
            margins.setdefault(check.title, []).append(check.margin)
    return min(margins, key=lambda title: float(np.mean(margins[title])), default="")
