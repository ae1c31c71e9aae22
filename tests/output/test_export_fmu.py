"""The FMU: by FMPy's own checks, and its motion against SciPy's integration of the motor's equations.

SciPy integrates the equations as they are in a textbook, nothing of ``fmu_motor`` in it.
"""

from __future__ import annotations

import builtins
import io
import json
import math
import re
import subprocess
import sys
import zipfile
from dataclasses import replace

import fmpy
import numpy as np
import pint
import pytest
from exports import rendered
from fmpy.validation import validate_fmu
from scipy.integrate import solve_ivp
from specs import poorer

from drivesizer.errors import InputError
from drivesizer.output.export import export_of
from drivesizer.output.export.fmu import _UNITS, parameters
from drivesizer.output.export.fmu_motor import FIGURES, INPUTS, OUTPUTS, Drive
from drivesizer.sizing import explain, size

pytestmark = pytest.mark.usefixtures("no_further_searches")

K_T, R, L = 23.4e-3, 2.32, 0.238e-3  # RE 25 118752
K, E = 3249 / 121 * 1.1, 0.76
FRICTION, ROTOR = K_T * 36.9e-3, 1.134e-6  # of no load at 9560 rpm, of which 65 % are dry
DRY, VISCOUS = 0.65 * FRICTION, 0.35 * FRICTION / (9560 * math.pi / 30)


@pytest.fixture(scope="module")
def found(spec, catalog):
    return size(spec, catalog=poorer(catalog), top=1).sets[0]


@pytest.fixture(scope="module")
def export(spec, found):
    return export_of(spec, found)


@pytest.fixture(scope="module")
def fmu(export, tmp_path_factory):
    path = tmp_path_factory.mktemp("fmu") / "drive.fmu"
    path.write_bytes(rendered(export, "fmu"))
    return path


def ran(fmu, volts, seconds, start=None, every=1e-3, load=0.0):
    given = np.array([(0.0, volts, load)], dtype=[("time", float), ("voltage", float), ("load_torque", float)])
    return fmpy.simulate_fmu(
        str(fmu), stop_time=seconds, output_interval=every, input=given, start_values=start or {}, validate=True
    )


def textbook(volts, seconds, load_inertia, load, start=(0.0, 0.0), driving=True, dry=DRY):
    """Current and speed of the motor under a voltage, moving forward: SciPy's LSODA."""
    share = (1 / E if driving else E) / K
    J, drag = ROTOR + share * load_inertia / K, dry + share * load

    def slopes(_, x):
        i, w = x
        return (volts - R * i - K_T * w) / L, (K_T * i - VISCOUS * w - drag) / J

    return solve_ivp(slopes, (0.0, seconds), start, method="LSODA", rtol=1e-10, atol=1e-12, dense_output=True).sol


def test_fmpy_finds_nothing(fmu):
    assert validate_fmu(str(fmu)) == []


def test_the_answer_to_a_step_of_voltage(fmu, export):
    """12 V from standstill, in calls of 1 ms: peak and run-up, with friction to overcome first."""
    out = ran(fmu, 12.0, 0.6)
    train = export.train
    rolling = 0.02 * 45.0 / 4 * 9.80665 * 0.0762
    holds = (DRY + rolling / (K * E)) / K_T  # A, until which it stands
    frees = -L / R * math.log(1.0 - holds * R / 12.0)  # s
    exact = textbook(12.0, 0.6, train.load_inertia, rolling, start=(holds, 0.0))
    time = out["time"][out["time"] > frees]
    i, w = exact(time - frees)
    assert out["current"].max() > 4.5 and w[-1] > 330.0
    assert np.abs(out["current"][-len(time) :] - i).max() < 2e-3  # A of 4.7: when within a step it lets go
    assert np.abs(out["motor_speed"][-len(time) :] - w).max() < 0.02  # rad/s of 338
    assert out["shaft_speed"] == pytest.approx(out["motor_speed"] / K)
    assert out["load_speed"] == pytest.approx(out["shaft_speed"] * 0.0762)
    turned = np.concatenate([[0.0], np.cumsum((out["shaft_speed"][1:] + out["shaft_speed"][:-1]) / 2 * 1e-3)])
    assert np.abs(out["shaft_angle"] - turned).max() < 1e-4  # rad


TOGETHER = """
import json, sys
import fmpy
from fmpy.fmi2 import FMU2Slave

class Running:
    def __init__(self, path):
        told = fmpy.read_model_description(path)
        self.at = {v.name: v.valueReference for v in told.modelVariables}
        self.fmu = FMU2Slave(guid=told.guid, unzipDirectory=fmpy.extract(path),
                             modelIdentifier=told.coSimulation.modelIdentifier, instanceName=told.modelName)
        self.fmu.instantiate()
        self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        free = {"voltage": 12.0, "load_inertia": 0.0, "forward_torque": 0.0, "backward_torque": 0.0}
        self.fmu.setReal([self.at[name] for name in free], list(free.values()))
        self.fmu.exitInitializationMode()

both = [Running(path) for path in sys.argv[1:]]
for n in range(100):
    for one in both:
        one.fmu.doStep(n * 2e-3, 2e-3)
print(json.dumps([one.fmu.getReal([one.at["motor_speed"]])[0] for one in both]))
"""


def test_two_sets_in_one_process(spec, fmu, tmp_path):
    """RE 25 118752 and RE 30 310009 side by side, unloaded at 12 V, by each data sheet.

    Of k_t I = M + b w and U = R I + k_t w: w = (U - R s I_0) / (k_t + R (1 - s) I_0 / w_0), with the dry share s.
    """
    other = tmp_path / "drive.fmu"
    (heavy, *_) = explain(spec, "310009", "166936")
    other.write_bytes(rendered(export_of(spec, heavy), "fmu"))
    sheets = {fmu: (2.32, 0.0369, 23.4e-3, 9560), other: (2.45, 0.0786, 53.8e-3, 8490)}  # ohm, A, N*m/A, rpm
    free = {
        path: (12.0 - 0.65 * R * I) / (k_t + 0.35 * R * I / (rpm * math.pi / 30))
        for path, (R, I, k_t, rpm) in sheets.items()
    }  # rad/s: 509.8, 220.4
    for order in ((fmu, other), (other, fmu)):
        ran = subprocess.run([sys.executable, "-c", TOGETHER, *order], capture_output=True, text=True, check=True)
        assert json.loads(ran.stdout) == pytest.approx([free[path] for path in order], rel=2e-3)
    names = [set(zipfile.ZipFile(path).namelist()) for path in (fmu, other)]
    shared = {name for name in names[0] & names[1] if not name.startswith("resources/pythonfmu/")}
    assert shared == {"modelDescription.xml", "resources/slavemodule.txt"}
    told = [fmpy.read_model_description(str(path)) for path in (fmu, other)]
    for of_each in ("guid", "modelName"):
        assert len({getattr(one, of_each) for one in told}) == 2


def test_parameters_are_the_fmu_s_own(fmu):
    """Another motor and load by its parameters alone: nothing is left in the code."""
    start = {
        "motor_friction": 0.0,
        "forward_torque": 0.0,
        "backward_torque": 0.0,
        "load_inertia": 0.02,
        "efficiency": E,
    }
    out = ran(fmu, 5.0, 0.3, start)
    i, w = textbook(5.0, 0.3, 0.02, 0.0, dry=0.0)(out["time"])
    assert np.abs(out["current"] - i).max() < 5e-5  # A of 2.1
    assert np.abs(out["motor_speed"] - w).max() < 5e-3  # it sets off a step late


def test_a_load_drives_the_motor_with_its_loss(fmu, export):
    """Shorted, and pulled: the gears' efficiency counts the other way round, and friction holds against either."""
    pull = -1.5  # N*m, forward
    out = ran(fmu, 0.0, 2.5, load=pull)
    train = export.train
    torque = pull + train.forward_torque
    steady = (
        R * (-torque * E / K - DRY) / (K_T**2 + R * VISCOUS)
    )  # rad/s, where the short brakes as much as the load pulls
    assert out["motor_speed"][-1] == pytest.approx(steady, rel=1e-3)
    assert out["current"][-1] == pytest.approx(-K_T * steady / R, rel=1e-3)
    exact = textbook(0.0, 2.5, train.load_inertia, torque, driving=False)(out["time"])
    assert np.abs(out["motor_speed"] - exact[1]).max() < 0.02
    assert not ran(fmu, 0.0, 0.1, load=-0.1)["motor_speed"].any()


def test_it_runs_out_and_stays(export):
    """Without voltage from some speed: friction stops it and holds; no creeping, no going back."""
    drive = Drive(parameters(export))
    drive.motor_speed, speeds = 50.0, []
    for _ in range(600):
        drive.advance(1e-3)
        speeds.append(drive.motor_speed)
    assert min(speeds) == 0.0 == speeds[-1]
    assert (np.diff(speeds) <= 0.0).all() and 0.1 < np.argmin(speeds) * 1e-3 < 0.4


def test_a_lever_swings_as_its_angle_says(export):
    """Shorted and let go level: SciPy's motion of a weight M cos(angle) that falls through gears, which it drives."""
    moment = 3.0  # N*m
    figures = {"lever_torque": moment, "lever_angle": 0.4, "inductance": 0.0, "load_inertia": 0.05}
    figures |= {"forward_torque": moment * math.cos(0.4), "backward_torque": moment * math.cos(0.4)}
    drive = Drive(parameters(export) | figures)
    drive.advance(0.3)
    inertia = ROTOR + 0.05 * E / K**2

    def slopes(_, x):
        angle, w = x
        falls = moment * math.cos(0.4 + angle) * E / K
        return w / K, (-(K_T * K_T / R + VISCOUS) * w + DRY - falls) / inertia

    exact = solve_ivp(slopes, (0.0, 0.3), (0.0, 0.0), rtol=1e-10, atol=1e-12).y[:, -1]
    assert -1.9 < exact[0] < -0.5 and exact[1] < 0.0  # rad: still falling
    assert [drive.shaft_angle, drive.motor_speed] == pytest.approx(exact, rel=1e-4)


def test_a_motor_without_inductance(export):
    """Where it is unknown the current is what the voltage makes: the limit of a small one."""
    bare, small = (Drive(parameters(export) | {"inductance": x}) for x in (0.0, 1e-6))
    for drive in (bare, small):
        drive.voltage = 6.0
        drive.advance(0.05)
    assert bare.motor_speed == pytest.approx(small.motor_speed, rel=1e-3)
    assert bare.current == pytest.approx((6.0 - K_T * bare.motor_speed) / R)


def test_commutation_takes_of_the_voltage_while_the_motor_drives(export):
    """In the long run u = R i + k_e w + X w i with k_t i = M_f + b w + T/(K e); a motor that is driven keeps it all."""
    X, motor = 3.0 / (2.0 * math.pi) * 14 * L, {"forward_torque": 2.0, "backward_torque": 2.0, "load_inertia": 1e-3}
    drive = Drive(parameters(export) | motor | {"commutation": X})
    drive.voltage = 20.0
    drive.advance(3.0)
    i, w = drive.current, drive.motor_speed
    assert K_T * i == pytest.approx(DRY + VISCOUS * w + 2.0 / (K * E), rel=1e-4)
    assert R * i + K_T * w + X * w * i == pytest.approx(20.0, rel=1e-4) and X * w * i > 1.0
    plain, braked = (Drive(parameters(export) | motor | {"commutation": x}) for x in (0.0, X))
    for one in (plain, braked):
        one.motor_speed = 500.0
        one.advance(1e-3)
    assert braked.current == pytest.approx(plain.current, rel=1e-5) and plain.current < 0.0  # other steps


def test_the_current_s_limit(export):
    drive = Drive(parameters(export) | {"most_current": 2.0})
    drive.voltage = 18.0
    drive.advance(0.1)
    rate = (K_T * 2.0 - DRY - export.train.forward_torque / (K * E)) / (ROTOR + export.train.load_inertia / (K * K * E))
    assert drive.current == 2.0
    assert drive.motor_speed == pytest.approx(0.1 * rate, rel=5e-3)


def test_the_winding_warms_to_where_heat_is_carried_off(spec, found):
    """A stalled motor in the long run, by hand: (R_1 + R_2) R_25 i^2 / (1 - alpha ...); then the outputs are there."""
    figures = {"winding_time_constant": 12.4, "motor_time_constant": 50.0}
    warm = export_of(spec, replace(found, motor=replace(found.motor, **figures)))
    drive = Drive(parameters(warm) | {"inductance": 0.0, "forward_torque": 99.0, "backward_torque": -99.0})
    drive.voltage = 1.0
    for _ in range(6000):
        drive.advance(0.2)
    rise = 17.1 * R * drive.current**2  # the resistance at 25 degC
    assert drive.winding_temperature - 298.15 == pytest.approx(rise / (1.0 - 0.0039 * rise), rel=1e-3)
    assert drive.current == pytest.approx(1.0 / (R * (1.0 + 0.0039 * (drive.winding_temperature - 298.15))), rel=1e-6)
    described = zipfile.ZipFile(io.BytesIO(rendered(warm, "fmu"))).read("modelDescription.xml").decode()
    assert 'name="winding_temperature"' in described and 'unit="K"' in described


def test_what_is_in_the_archive(fmu, export):
    with zipfile.ZipFile(fmu) as archive:
        assert {entry.date_time for entry in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        assert archive.namelist() == sorted(archive.namelist())
        code = [archive.read(name).decode() for name in archive.namelist() if name.startswith("resources/drive_")]
    needed = {name.split("_")[0] for one in code for name in re.findall(r"^from (\w+) import|^import (\w+)", one, re.M)
              for name in name if name}  # fmt: skip
    assert len(code) == 3 and needed == {"", "math", "typing", "pythonfmu", "drive"}
    described = fmpy.read_model_description(str(fmu))
    names = {variable.name: variable for variable in described.modelVariables}
    assert set(names) == set(FIGURES) | set(INPUTS) | {n for n in OUTPUTS if not n.endswith("temperature")}
    for name, value in parameters(export).items():
        assert float(names[name].start) == pytest.approx(value, rel=1e-15) and names[name].causality == "parameter"
        assert names[name].unit == FIGURES[name][0]
    assert "generationDateAndTime" not in fmu.read_bytes().decode("latin-1")


def test_every_unit_is_defined_with_its_own_dimensions():
    """Against pint: the base units that FMI wants, out of the unit's name."""
    ureg = pint.UnitRegistry()
    used = {unit for table in (FIGURES, INPUTS, OUTPUTS) for unit, _ in table.values()}
    assert used == set(_UNITS)
    for unit in used - {"1"}:
        spelt = unit.replace("kg.m2", "kg*m^2").replace(".", "*")
        base = ureg.Quantity(1.0, spelt).to_base_units()
        powers = {"kg": "kilogram", "m": "meter", "s": "second", "A": "ampere", "K": "kelvin"}
        found = {
            name: int(p) for name, p in ((n, dict(base.units._units).get(long, 0)) for n, long in powers.items()) if p
        }
        assert base.magnitude == pytest.approx(1.0)
        assert found == {name: int(p) for name, p in _UNITS[unit].items() if name != "rad"}, unit


def test_without_pythonfmu_it_is_one_line(export, monkeypatch):
    there = builtins.__import__

    def without(name, *more, **named):
        if name.startswith("pythonfmu"):
            raise ImportError(name)
        return there(name, *more, **named)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(InputError, match=r"pip install 'drivesizer\[fmu\]'"):
        rendered(export, "fmu")
