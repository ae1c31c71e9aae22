"""Two RI50 motors shaft to shaft: torque and power at stall, current and power without load, winding temperature."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from measured_compared import OWN_PARTS, Axis, Comparison, against, banded, part, predicted, sampled
from measured_data import Array, Held, course, held, record

from drivesizer.kernel.warming import State
from drivesizer.physics.thermal import resistance_at
from drivesizer.prediction.set_at_voltage import Heating, SetAtVoltage, hottest_phase, over_time
from drivesizer.results.prediction import Band

_SUPPLY = 36.0  # V
_SPEED, _CURRENT, _POWER = Axis("speed", "rad/s"), Axis("current", "A"), Axis("power", "W")
_SENSOR = 0.5  # K
_WARM = 5.0  # K of rise, below which a relative error says nothing


def ri50(folder: Path) -> list[Comparison]:
    """The driven motor."""
    motor = part("cubemars", "RI50 KV100")
    one, parts = sampled(motor, _SUPPLY, part(OWN_PARTS, "brushless bridge"))
    stall = held(record(folder, "stall with power"))
    rest, driven = stall[0], [x for x in stall[:5] if x.I2 > 1.0]
    torques = [x for x in held(record(folder, "stall")) if abs(x.command) > 1.0] + driven
    idle = [x for x in held(record(folder, "no load")) if x.w > 1.0]
    running = held(record(folder, "no load with power"))
    moving = [x for x in running if x.w > 1.0]
    return [
        _torque(torques), _stall_power(one, driven, rest),
        _idle("ri50_idle_1", one, idle), _idle("ri50_idle_2", one, moving), _running(one, moving, running[0]),
        *(_warming(key, folder, name, one, hottest_phase(one, parts))
          for key, name in (("ri50_winding_1", "stall"), ("ri50_winding_2", "stall with power"))),
    ]  # fmt: skip


def _column(steps: list[Held], name: str) -> Array:
    return np.array([getattr(x, name) for x in steps])


def _torque(steps: list[Held]) -> Comparison:
    motor, M, I = part("cubemars", "RI50 KV100"), np.abs(_column(steps, "M")), np.sqrt(_column(steps, "I2"))
    bands = predicted(motor, "hold_current", [{"hold": m} for m in M])
    return against("ri50_hold_current", M, Axis("torque", "N·m"), I, _CURRENT, bands, M / motor["torque_constant"])


def _stall_power(one: SetAtVoltage, steps: list[Held], rest: Held) -> Comparison:
    """The supply of the first instrument feeds both drives, the second instrument sees the other one."""
    assert one.feed is not None
    feed, I, T = one.feed, np.sqrt(_column(steps, "I2")), _column(steps, "winding")
    P = _column(steps, "P_1") - _column(steps, "P_2") - (rest.P_1 - rest.P_2)
    bands = banded(lambda i, t: resistance_at(one.bodies.R_25, t) * i**2 + feed.lost(i), I, T)
    return against("ri50_stall_power", I, _CURRENT, P, _POWER, bands, one.bodies.R_25[0] * I**2)


def _idle(key: str, one: SetAtVoltage, steps: list[Held]) -> Comparison:
    """The driven motor drags the other one along: the friction of two."""
    w, I = _column(steps, "w"), _column(steps, "I")
    bands = banded(lambda x: 2.0 * (one.coulomb + one.drive.viscous * x) / one.drive.k_t, w)
    return against(key, w, _SPEED, I, Axis("no-load current", "A"), bands, np.nan)


def _running(one: SetAtVoltage, steps: list[Held], rest: Held) -> Comparison:
    assert one.feed is not None
    feed, w, I, I2, T = one.feed, *(_column(steps, name) for name in ("w", "I", "I2", "winding"))
    P = _column(steps, "P_1") - _column(steps, "P_2") - (rest.P_1 - rest.P_2)

    def power(x: float, i: float, square: float, t: float) -> Array:
        return np.asarray(resistance_at(one.bodies.R_25, t) * square + one.drive.k_e * i * x + feed.lost(i))

    plain = one.bodies.R_25[0] * I2 + one.motor["torque_constant"][0] * I * w
    return against("ri50_idle_power", w, _SPEED, P, _POWER, banded(power, w, I, I2, T), plain)


def _warming(key: str, folder: Path, name: str, one: SetAtVoltage, bodies: object) -> Comparison:
    """Rise of the winding while the measured current flows, by the program's two bodies."""
    measured = course(folder, name)
    start = float(measured.winding[0])
    whole, still = np.ones_like(one.bodies.R_25), np.zeros_like(one.bodies.R_25)
    state, begun, rises = State(start, start), 0.0, list[Array]()
    for end, square in zip(measured.t, measured.I2, strict=True):
        current = np.sqrt(square) * whole
        heating = Heating(bodies, start, lambda _, I=current: (I, still))  # type: ignore[arg-type, misc]
        winding, housing = over_time(heating, state, np.array([0.0, end - begun]))
        state, begun = State(winding[-1], housing[-1]), end
        rises.append(winding[-1] - start)
    ends = (np.quantile(x[1:], (0.05, 0.5, 0.95), method="inverted_cdf") for x in rises)
    bands = [Band(p50, p5, p50, p95) for p5, p50, p95 in ends]
    rise = Axis("rise of the winding", "K")
    return against(key, measured.t, Axis("time", "s"), measured.winding - start, rise, bands, np.nan, _WARM, _SENSOR)
