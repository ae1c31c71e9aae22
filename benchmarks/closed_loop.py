"""The closed loop's engine beside a general solver, many drives beside one, missions of hours, and a cascade at 25 kHz.

All ratios are of one run. The rival is python-control's `input_output_response` with LSODA on the saturated loop, each
control period integrated (a sampled controller cannot be stepped over); its speeds are held against the engine's.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from goals import line

from drivesizer.control.drive_train import DriveTrain
from drivesizer.control.engine import CurrentLimit, Drive, Supply, Task, simulate
from drivesizer.control.validation import Cascade, Gains

PERIOD = 1e-3
SAW = Task(time=tuple(0.5 * n for n in range(21)), speed=tuple(40.0 * (n % 2) + 5.0 for n in range(21)))
MACHINE = DriveTrain(
    resistance=2.0, inductance=1e-3, torque_constant=0.05, back_emf_constant=0.05, motor_inertia=2e-5, gear_ratio=7.0,
    gear_efficiency=0.8,
    load_inertia=2e-3, friction=2e-3, forward_torque=0.1, backward_torque=-0.1,
)  # fmt: skip
GAINS = Gains(kp=0.15, ki=3.0, kd=0.0, filter_time=0.0, period=PERIOD, rule="benchmark", source="")
DRIVE = Drive(train=MACHINE, controller=GAINS, supply=Supply(voltage=15.0))
HOURS, CYCLE = 8, 10.0  # h, s
CASCADE = Cascade(
    current_kp=2.0, current_ki=4e3, velocity_kp=0.05, velocity_ki=1.0, current_period=4e-5, velocity_period=4e-4
)
TIGHT = replace(DRIVE, current=CurrentLimit(peak=6.0))


def best(work: Callable[[], Any], runs: int) -> tuple[float, Any]:
    taken, found = [], None
    for _ in range(runs):
        start = time.perf_counter()
        found = work()
        taken.append(time.perf_counter() - start)
    return statistics.median(taken), found


def rival() -> Any:
    """Speeds at the samples by python-control: the plant of driving and braking, LSODA over each period."""
    import control

    K, e, J = MACHINE.ratio, MACHINE.efficiency, MACHINE.load_inertia

    def rate(_t: float, x: Any, u: Any, _p: Any) -> Any:
        i, w = x
        net = MACHINE.torque_constant * i - MACHINE.friction
        share = 1 / (K * e) if 0.1 * K * MACHINE.motor_inertia + J * net > 0 else e / K
        turn = (net - 0.1 * share) / (MACHINE.motor_inertia + J * share / K)
        return [(u[0] - 2.0 * i - 0.05 * w) / 1e-3, turn]

    plant = control.nlsys(rate, None, inputs=1, outputs=2, states=2)
    w = 5.0 * K
    i = (MACHINE.friction + 0.1 / (K * e)) / MACHINE.torque_constant
    pending = integral = 2.0 * i + 0.05 * w
    state, found = np.array([i, w]), []
    for k in range(10_000):
        t = k * PERIOD
        error = K * float(np.interp(t, SAW.time, SAW.speed)) - state[1]
        found.append(state[1])
        u = min(max(pending, -15.0), 15.0)
        if not (pending - u) * error > 0.0:
            integral += GAINS.ki * PERIOD * error
        pending = GAINS.kp * error + integral
        run = control.input_output_response(
            plant, np.array([0.0, PERIOD]), np.array([[u, u]]), state, solve_ivp_method="LSODA",
            solve_ivp_kwargs={"rtol": 1e-8, "atol": 1e-8},
        )  # fmt: skip
        state = run.states[:, -1]
    return np.array(found)


def main() -> None:
    simulate(DRIVE, SAW)  # compiles, or loads
    one, ours = best(lambda: simulate(DRIVE, SAW), 9)
    theirs, speeds = best(rival, 1)
    off = np.abs(ours.series["motor_speed"][: len(speeds)] - speeds).max() / speeds.max()
    print(f"{'10 s at 1 kHz, saturated':40}{one * 1e3:9.2f} ms   python-control, LSODA {theirs * 1e3:9.0f} ms")
    print(line("loop", theirs / one), f"\n{'they differ by':40}{off:9.1e} of the top speed")
    many = [replace(DRIVE, train=replace(MACHINE, resistance=2.0 + 1e-4 * n)) for n in range(1000)]
    bare, _ = best(lambda: simulate(many[:1], SAW, rows=0, threads=1), 9)
    for threads in (1, 2):
        all_of_them, _ = best(lambda threads=threads: simulate(many, SAW, rows=0, threads=threads), 3)
        print(f"{f'1000 drives, {threads} threads':40}{all_of_them:9.2f} s    {all_of_them / bare:9.0f} single runs")
    cycles = int(HOURS * 3600 / CYCLE)
    mission, found = best(lambda: simulate(DRIVE, replace(SAW, cycles=cycles), rows=0), 3)
    steps = found.figures["steps"][0]
    print(f"{f'mission of {HOURS} h':40}{mission * 1e3:9.1f} ms   {steps:9.0f} steps of {cycles * 1e4:.3g}")
    short = Task(time=(0.0, 0.5, 1.0), speed=(5.0, 30.0, 5.0))
    cascade = replace(TIGHT, controller=CASCADE)
    simulate(cascade, short, rows=0)
    second, _ = best(lambda: simulate(cascade, short, rows=0), 9)
    print(f"{'cascade at 25 kHz, of real time':40}{second * 100:9.2f} %    {25_000 / second:9.0f} periods per second")


if __name__ == "__main__":
    main()
