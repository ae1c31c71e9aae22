"""Logs made by another program (matrix exponentials of scipy, friction by hand) give back the figures behind them."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import expm

from drivesizer.identification.identify import Reference, identify

Array = NDArray[np.float64]
FINE = 10  # steps of the simulation in a sample
NAMES = ("R", "k_e", "J", "M_c", "b", "L", "delay")


def drawn(seed: int) -> dict[str, float]:
    """A motor at 24 V: resistances of 1:100, time constants as they follow, friction of some per cent of its stall."""
    random = np.random.default_rng(seed)
    R, k = 10 ** random.uniform(-1, 1), 10 ** random.uniform(-2, -0.7)
    J = 10 ** random.uniform(-6, -4.5)
    tau, stall = J * R / k**2, k * 24.0 / R
    h = tau / random.uniform(10, 40)
    return {
        "R": R, "k_e": k, "J": J, "h": h, "L": R * tau * random.uniform(0.01, 0.1),
        "M_c": stall * random.uniform(0.01, 0.06),
        "b": stall * random.uniform(0.004, 0.05) * k / 24.0, "delay": round(FINE * random.uniform(0, 2)) / FINE * h,
    }  # fmt: skip


def simulated(
    one: dict[str, float], u: Array, load: float = 0.0, share: tuple[float, float] = (1.0, 1.0)
) -> tuple[Array, Array]:
    """Current and speed at each sample under held voltages; a load at a gear of ratio 1, by its direction of power."""
    R, L, k, J, b = (one[n] for n in ("R", "L", "k_e", "J", "b"))
    dt, n = one["h"] / FINE, len(u)
    G = np.zeros((4, 4))
    G[:2] = [[-R / L, -k / L, 1 / L, 0], [k / J, -b / J, 0, -1 / J]]

    def steps(span: float) -> Array:
        return np.asarray(expm(G * span))

    whole, still, late = steps(dt), np.exp(-R * dt / L), round(one["delay"] / dt)
    fine = np.concatenate([np.full(late, u[0]), np.repeat(u, FINE)])[: n * FINE]
    x, found = np.zeros(2), np.zeros((n, 2))
    for j, v in enumerate(fine):
        if j % FINE == 0:
            found[j // FINE] = x
        up, down = one["M_c"] + load * share[0], -one["M_c"] + load * share[1]
        push = k * x[0]
        side = np.sign(x[1]) or (1.0 if push > up else -1.0 if push < down else 0.0)
        if side == 0.0:
            x[0] = v / R + (x[0] - v / R) * still
            continue
        held = np.array([v, up if side > 0.0 else down])
        after = whole[:2, :2] @ x + whole[:2, 2:] @ held
        if x[1] * after[1] < 0.0:  # it turns within the step: on from rest
            when = dt * x[1] / (x[1] - after[1])
            part = steps(when)
            x = part[:2, :2] @ x + part[:2, 2:] @ held
            x[1], push, rest = 0.0, k * x[0], dt - when
            side = 1.0 if push > up else -1.0 if push < down else 0.0
            if side == 0.0:
                x[0] = v / R + (x[0] - v / R) * np.exp(-R * rest / L)
                continue
            part = steps(rest)
            after = part[:2, :2] @ x + part[:2, 2:] @ np.array([v, up if side > 0.0 else down])
        x = after
    return found[:, 0], found[:, 1]


def steps_of_voltage(one: dict[str, float], seed: int, count: int = 1000) -> Array:
    """Voltages that step every 40 samples."""
    return np.repeat(np.random.default_rng([seed, 1]).uniform(-24.0, 24.0, count // 40 + 1), 40)[:count]


def written(path: Path, one: dict[str, float], u: Array, current: Array, speed: Array, seed: int, *, left_out: str = "",
            more: dict[str, Array] | None = None) -> Path:  # fmt: skip
    """A log of it: noise of 1 % on the current, of 0.5 % on the speed, which comes in 500 steps of its range."""
    random = np.random.default_rng([seed, 2])
    current = current + 0.01 * np.abs(current).max() * random.standard_normal(len(u))
    speed = speed + 0.005 * np.abs(speed).max() * random.standard_normal(len(u))
    step = np.abs(speed).max() / 250.0
    columns = {"time (s)": one["h"] * np.arange(len(u)), "voltage (V)": u, "current (A)": current,
               "speed (rad/s)": np.round(speed / step) * step, **(more or {})}  # fmt: skip
    columns = {name: x for name, x in columns.items() if not left_out or not name.startswith(left_out)}
    rows = [",".join(columns), *(",".join(f"{x:.8g}" for x in row) for row in zip(*columns.values(), strict=True))]
    path.write_text("\n".join(rows) + "\n")
    return path


def met(folder: Path, seeds: range) -> tuple[list[bool], list[float]]:
    """Whether each figure of each drive lies in its band or is named as one that cannot be had; widths of bands."""
    inside, widths = list[bool](), list[float]()
    for seed in seeds:
        one = drawn(seed)
        u = steps_of_voltage(one, seed)
        found = identify(written(folder / "log.csv", one, u, *simulated(one, u), seed))
        named = " ".join(tied.figures for tied in found.inseparable)
        for name in NAMES:
            try:
                figure = found.figure(name)
            except KeyError:
                assert {"b": "viscous", "L": "inductance", "M_c": "dry"}[name] in named, (seed, name)
                continue
            inside.append(figure.low <= one[name] <= figure.high)
            widths.append((figure.high - figure.low) / 2.0 / one[name] if name in ("R", "k_e", "J") else 0.0)
    return inside, widths


def test_random_drives_are_within_their_bands(tmp_path: Path) -> None:
    inside, widths = met(tmp_path, range(6))
    assert np.mean(inside) >= 0.9
    assert np.max(widths) < 0.05  # bands that say something


@pytest.mark.slow
@pytest.mark.parametrize("first", [100, 200])
def test_further_random_drives_are_within_their_bands(tmp_path: Path, first: int) -> None:
    assert np.mean(met(tmp_path, range(first, first + 20))[0]) >= 0.9


def test_a_data_sheet_is_held_against_the_log_and_a_wrong_unit_gets_its_factor(tmp_path: Path) -> None:
    """Turns per second under the head rad/s: the voltage per speed is 2 pi times too large."""
    one = drawn(4)
    u = steps_of_voltage(one, 4)
    current, speed = simulated(one, u)
    log = written(tmp_path / "log.csv", one, u, current, speed / (2.0 * np.pi), 4)
    of = Reference(label="sheet", figures={"R": one["R"], "k_e": 1.03 * one["k_e"], "k_t": one["k_e"], "J": one["J"]})
    wrong = [finding for finding in identify(log, of).findings if finding.name == "units"]
    assert wrong[0].factor == pytest.approx(2.0 * np.pi)
    assert "turns per second" in wrong[0].text
    right = identify(log, of, scales={"speed": 2.0 * np.pi})
    assert not [finding for finding in right.findings if finding.name == "units"]
    assert abs(right.figure("k_e").deviation) < 2.0


@pytest.mark.parametrize(("left_out", "names"), [
    ("current", {"k_V": lambda m: m["k_e"] + m["R"] * m["b"] / m["k_e"], "k_A": lambda m: m["R"] * m["J"] / m["k_e"],
                 "k_S": lambda m: m["R"] * m["M_c"] / m["k_e"]}),
    ("voltage", {"i_A": lambda m: m["J"] / m["k_e"], "i_S": lambda m: m["M_c"] / m["k_e"],
                 "i_V": lambda m: m["b"] / m["k_e"]}),
])  # fmt: skip
def test_without_a_column_its_figures_are_named_as_not_separated(
    tmp_path: Path, left_out: str, names: dict[str, Any]
) -> None:
    inside = []
    for seed in (2, 3, 5):
        one = drawn(seed)
        u = steps_of_voltage(one, seed, 2000)
        log = written(tmp_path / "log.csv", one, u, *simulated(one, u), seed, left_out=left_out)
        found = identify(log)
        figures = [found.figure(name) for name in names if name in {one.name for one in found.figures}]
        inside += [f.low <= names[f.name](one) <= f.high for f in figures]
        assert any("constant" in tied.figures for tied in found.inseparable)
    assert np.mean(inside) >= 0.7
    assert len(inside) >= 6


@pytest.mark.parametrize(
    ("ratio", "e", "e_back", "names"), [(1.0, 0.8, 0.8, ["k_t", "e"]), (9.0, 0.8, 0.7, ["e", "e_back"])]
)
def test_a_load_lifted_and_lowered_gives_torque_constant_or_gear_losses(
    tmp_path: Path, ratio: float, e: float, e_back: float, names: list[str]
) -> None:
    """Torque at the output measured, three loads up and down: losses by direction scale as the torque constant does."""
    one, inside = drawn(6), []
    u = steps_of_voltage(one, 6, 1200)
    stall = one["k_e"] * 24.0 / one["R"]
    parts, loads = [], []
    for share, lift in zip(np.split(u, 3), (0.05, 0.12, 0.2), strict=True):
        parts.append(simulated(one, share, lift * stall, (1.0 / e, e_back)))
        loads.append(np.full(len(share), ratio * lift * stall))
    current, speed = (np.concatenate([part[k] for part in parts]) for k in (0, 1))
    log = written(tmp_path / "log.csv", one, u, current, speed, 6, more={"torque (N*m)": np.concatenate(loads)})
    text = log.read_text().splitlines()
    for k, start in enumerate((401, 801)):  # three moves with a pause between them
        text[start:] = [
            f"{float(row.split(',', 1)[0]) + 50 * (k + 1) * one['h']:.8g},{row.split(',', 1)[1]}"
            for row in text[start:]
        ]
    log.write_text("\n".join(text))
    found = identify(log, Reference(ratio=ratio))
    true = one | {"k_t": one["k_e"], "e": e, "e_back": e_back}
    for name, value in ((name, true[name]) for name in [*names, "R", "J", "k_e"]):
        figure = found.figure(name)
        inside.append(figure.low <= value <= figure.high)
        assert figure.value == pytest.approx(value, rel=0.15), name
    assert sum(inside) >= 4


def heating(time: Array, current: float, R: float) -> tuple[Array, Array]:
    """Winding and housing in small steps of Euler: 3 and 9 K/W, 20 and 400 s."""
    w, h, winding, housing = 0.0, 0.0, [], []
    dt = time[1] - time[0]
    for _ in time:
        winding.append(w)
        housing.append(h)
        loss = R * (1.0 + 0.0039 * w) * current**2
        w, h = w + dt * (loss - (w - h) / 3.0) / (20.0 / 3.0), h + dt * ((w - h) / 3.0 - h / 9.0) / (400.0 / 9.0)
    return np.array(winding) + 25.0, np.array(housing) + 25.0


def test_a_stall_gives_the_winding_s_heat_and_any_head_may_be_named(tmp_path: Path) -> None:
    time = np.arange(0.0, 150.0, 0.1)
    current = np.where(time % 50.0 < 30.0, 4.0, 0.0)
    winding, housing, w, h = [], [], 0.0, 0.0
    for i in current.tolist():
        winding.append(w)
        housing.append(h)
        loss = 1.5 * (1.0 + 0.0039 * w) * i**2
        w, h = w + 0.1 * (loss - (w - h) / 3.0) * 3.0 / 20.0, h + 0.1 * ((w - h) / 3.0 - h / 9.0) * 9.0 / 400.0
    table = np.column_stack([time, current, np.array(winding) + 25.0, np.array(housing) + 25.0])
    path = tmp_path / "stall.csv"
    np.savetxt(path, table, delimiter=",", header="time [s],q amps [A],motor temp [C],housing temp [C]", comments="")
    found = identify(path, Reference(figures={"R": 1.5}), named={"current": "q amps [A]"})
    assert found.figure("R_th1").value == pytest.approx(3.0, rel=0.03)
    assert found.figure("tau_w").value == pytest.approx(20.0, rel=0.03)
    assert found.figure("R_th2").low <= 9.0


@pytest.mark.parametrize("lasts", [1600.0, 120.0])
def test_two_time_constants_of_the_housing_are_needed_for_heat(tmp_path: Path, lasts: float) -> None:
    time, random = np.arange(0.0, lasts, 0.2), np.random.default_rng(1)
    R, k, current = 1.5, 0.05, np.full(len(np.arange(0.0, lasts, 0.2)), 3.0)
    winding, housing = heating(time, 3.0, R)
    speed = 100.0 * (1.0 - np.exp(-time / 2.0)) + 20.0 * np.sin(time / 3.0)
    voltage = R * (1.0 + 0.0039 * (winding - 25.0)) * current + k * speed
    winding, housing = (x + 0.2 * random.standard_normal(len(time)) for x in (winding, housing))
    rows = zip(time, voltage, current, speed, winding, housing, strict=True)
    head = "time (s);motor voltage (V);current (A);speed (rad/s);winding temperature (degC);housing temperature (degC)"
    path = tmp_path / "log.csv"
    path.write_text("\n".join([head, *(";".join(f"{x:.6g}" for x in row) for row in rows)]))
    found = identify(path, Reference(figures={"R": R}))
    for name, value in {"R_th1": 3.0, "tau_w": 20.0}.items():
        assert found.figure(name).value == pytest.approx(value, rel=0.1), name
    if lasts > 1000.0:
        for name, value in {"R_th2": 9.0, "tau_h": 400.0}.items():
            assert found.figure(name).low < value < found.figure(name).high, name
    else:
        assert found.figure("R_th2").high == np.inf
        assert "two time constants" in found.inseparable[-1].needs


def test_steady_points_give_torque_constant_and_friction_and_of_a_voltage_the_resistance(tmp_path: Path) -> None:
    """A dynamometer's map: k_t i = M + M_f + b w, u = R i + k_e w; noise of a per cent."""
    random = np.random.default_rng(5)
    w, M = (x.ravel() for x in np.meshgrid(np.linspace(20.0, 400.0, 12), np.linspace(0.1, 1.2, 9)))
    i = (M + 0.02 + 1e-4 * w) / 0.03
    u = 0.05 * i + 0.031 * w
    rows = np.column_stack([u, i, w * 30.0 / np.pi, M * (1.0 + 0.01 * random.standard_normal(len(M)))])
    path = tmp_path / "map.csv"
    np.savetxt(path, rows, delimiter=",", header="voltage (V),current (A),speed (rpm),torque (N*m)", comments="")
    found = identify(path, Reference(label="sheet", figures={"k_t": 0.033, "R": 0.05}))
    for name, true in {"k_t": 0.03, "M_c": 0.02, "b": 1e-4, "R": 0.05, "k_e": 0.031}.items():
        figure = found.figure(name)
        assert figure.low <= true * (1.0 + 1e-9) and true * (1.0 - 1e-9) <= figure.high, name
    assert found.figure("k_t").high < 0.031
    assert found.figure("k_t").deviation == pytest.approx(-0.003 / 0.0033, abs=0.05)  # the sheet's 10 %
    assert "inertia" in found.inseparable[0].figures


# -- Files of other programs.


def test_an_odrive_configuration_has_figures_of_each_axis(tmp_path: Path) -> None:
    """Firmware 0.5 nests, 0.6 has one flat list; a phase's figures are half of those from terminal to terminal."""
    flat = {"axis0.config.motor.pole_pairs": 4, "axis0.config.motor.phase_resistance": 0.0354,
            "axis0.config.motor.phase_inductance": 6.25e-5, "axis0.config.motor.torque_constant": 0.48}  # fmt: skip
    nested: dict[str, Any] = {"axis0": {"motor": {"config": {"phase_resistance": 0.0707, "phase_inductance": 4.01e-4}}},
                              "axis1": {"motor": {"config": {"phase_resistance": 0.1, "phase_inductance": 6e-3,
                                                             "torque_constant": 0.1}}}}  # fmt: skip
    files = {"flat.json": flat, "nested.json": nested}
    for name, data in files.items():
        (tmp_path / name).write_text(json.dumps(data))
    one, two = (identify(tmp_path / name) for name in files)
    assert [one.figure(name).value for name in ("R", "L", "k_t")] == pytest.approx([0.0708, 1.25e-4, 0.48])
    assert [two.figure(f"axis{k}.R").value for k in (0, 1)] == pytest.approx([0.1414, 0.2])
    assert not one.findings and [finding.text.split(":")[0] for finding in two.findings] == ["axis1"]


def test_sysid_and_its_binary_log_say_the_same(tmp_path: Path) -> None:
    """Quasistatic ramps and steps of WPILib's SysId, in rotations, as JSON; the same moments as a data log."""
    one = drawn(8)
    h, count = one["h"], 400
    ramp, step = np.linspace(0.0, 8.0, count), np.where(np.arange(count) > 40, 7.0, 0.0)
    tests = {}
    body = bytearray(b"WPILOG\x00\x01\x00\x00\x00\x00")

    def record(entry: int, moment: float, payload: bytes) -> None:
        at = round(1e6 * moment).to_bytes(8, "little")
        body.extend(bytes([0x70, entry, len(payload)]) + at + payload)

    def text(words: str) -> bytes:
        return struct.pack("<I", len(words)) + words.encode()

    for entry, name in ((1, "/test/voltage"), (2, "/test/velocity")):
        record(0, 0.0, bytes([0]) + struct.pack("<I", entry) + text(name) + text("double") + text(""))
    for k, (name, u) in enumerate(
        {"slow-forward": ramp, "slow-backward": -ramp, "fast-forward": step, "fast-backward": -step}.items()
    ):
        speed = simulated(one, u)[1] / (2.0 * np.pi)
        time = h * np.arange(count) + k * 100.0
        tests[name] = [[t, v, 0.0, w] for t, v, w in zip(time.tolist(), u.tolist(), speed.tolist(), strict=True)]
        for t, v, _, w in tests[name]:
            record(1, t, struct.pack("<d", v))
            record(2, t, struct.pack("<d", w))
    (tmp_path / "sysid.json").write_text(json.dumps({"sysid": True, "test": "Simple", "units": "Rotations", **tests}))
    (tmp_path / "log.wpilog").write_bytes(bytes(body))
    for path in (tmp_path / "sysid.json", tmp_path / "log.wpilog"):
        found = identify(path)
        assert found.figure("k_V").value == pytest.approx(one["k_e"] + one["R"] * one["b"] / one["k_e"], rel=0.02)
        assert found.figure("k_S").value == pytest.approx(one["R"] * one["M_c"] / one["k_e"], rel=0.1)
        assert found.figure("k_A").value == pytest.approx(one["R"] * one["J"] / one["k_e"], rel=0.1)


# mjbots/moteus, lib/python/moteus/test/testdata/ld_hoverboard.json and ld_be8108.json (Apache-2.0): two currents of
# each sweep [A: (rad/s, V) ...], R, poles, V/Hz, the maker's fit of the flux linkage; what they are held against was
# computed from them by numpy apart
HOVERBOARD = {
    "raw": {"0.0": [(133.398, 2.38581), (166.720, 3.00396), (202.134, 3.61964), (235.454, 4.22932), (276.239, 4.82198)],
            "-5.94": [(115.751, 1.61465), (160.23, 2.2260), (204.83, 2.8726), (248.585, 3.4758), (292.44, 4.1134)]},
    "params": {"R": 0.230118, "poles": 30, "v_per_hz": 1.038526}, "fit": {"lambda_m": 0.0171791},
}  # fmt: skip
BE8108 = {
    "raw": {"0.0": [(783.206, 1.64352), (999.624, 2.06535), (1221.96, 2.48377), (1445.47, 2.90079), (1670.66, 3.31924)],
            "-10.1": [(1163.45, 1.62043), (1458.5, 2.0326), (1754.68, 2.44735), (1757.4, 2.4351), (1757.6, 2.4391)]},
    "params": {"R": 0.0790378, "poles": 42, "v_per_hz": 0.251484}, "fit": {"lambda_m": 0.00189636},
}  # fmt: skip


SPINDLE = {  # ld_spindle.json
    "raw": {"0.0": [(218.112, 2.16518), (275.612, 2.72857), (332.877, 3.27236), (394.354, 3.8276), (454.26, 4.37562)],
            "-9.0": [(215.318, 1.66223), (291.173, 2.22509), (363.039, 2.79384), (437.95, 3.3551), (513.54, 3.9192)]},
    "params": {"R": 0.100249, "poles": 4, "v_per_hz": 0.0661883}, "fit": {"lambda_m": 0.00946613},
}  # fmt: skip


@pytest.mark.parametrize(
    ("file", "linkage", "contradicts"), [(HOVERBOARD, 0.0178, True), (SPINDLE, 0.0097, True), (BE8108, 0.002, False)]
)
def test_a_calibration_that_contradicts_itself_is_caught(
    tmp_path: Path, file: dict[str, Any], linkage: float, contradicts: bool
) -> None:
    raw = {d: [{"omega": w, "y": y} for w, y in points] for d, points in file["raw"].items()}
    (tmp_path / "ld.json").write_text(json.dumps(file | {"raw": raw}))
    found = identify(tmp_path / "ld.json")
    flux = found.figure("flux_linkage")
    assert flux.value == pytest.approx(linkage, rel=0.03)
    assert flux.low <= file["fit"]["lambda_m"] <= flux.high  # with the maker's term for saturation
    assert any(one.name == "contradiction" for one in found.findings) is contradicts
