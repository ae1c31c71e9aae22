"""An FMU for co-simulation (FMI 2.0): the set with its load, driven by a voltage.

Made by PythonFMU, whose loader runs ``fmu_motor`` and the kernel's equations of heat in the Python of the simulator's
computer: a Python 3 must be there, nothing else; the loader is built for Linux and Windows on x86-64. All figures are
parameters of the FMU. Dates are fixed and the GUID is that of the content, so that the same set gives the same bytes.

All FMUs of a process share one Python, which keeps modules by their names: a second FMU would run with the code and
figures of the first that has the same. So model and modules are named by a digest of what they hold.
"""

from __future__ import annotations

import hashlib
import io
import sys
import tempfile
import time
import uuid
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from math import isnan
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, fromstring, tostring

from drivesizer.errors import InputError
from drivesizer.files.text import listed
from drivesizer.kernel import heat
from drivesizer.output.export import fmu_motor
from drivesizer.output.export.common import Export, document, text
from drivesizer.output.export.machine import MachineExport

_1980 = 315_619_200.0  # s since 1970, the second day of that year in every time zone
_DATE = (1980, 1, 1, 0, 0, 0)  # the earliest that a zip file can hold
_DIGITS = 16  # of the digest in a name: 64 bits
_SPACE = uuid.UUID("9c4b7d1e-1a44-5d0e-8a1b-2f0f3a6f5b10")  # of GUIDs of this program
_UNITS = {unit: dict(power.split() for power in base) for _, (unit, *base) in listed(__package__, "fmi_units.txt")}


def parameters(of: Export) -> dict[str, float]:
    """The figures of ``fmu_motor`` for a set, SI; 0 switches off what is unknown."""
    train, two = of.train, of.heat
    thermal = (two.R_th1, two.R_th2, two.capacity_w, two.capacity_h) if two else (0.0,) * 4
    names = ("winding_to_housing", "housing_to_ambient", "winding_capacity", "housing_capacity")
    figures = {name: getattr(train, name, 0.0) for name in fmu_motor.FIGURES} | {
        "inductance": train.inductance if of.inductance_known else 0.0,
        "commutation": train.commutation if of.inductance_known else 0.0,
        "motor_friction": train.friction, "motor_viscous": train.viscous, "ambient": of.ambient,
        "lever_torque": of.moment, "lever_angle": of.lever.start if of.lever else 0.0,
        "housing_loss": of.rotor_loss[0], "housing_loss_viscous": of.rotor_loss[1],
        "most_current": of.peak_current if of.peak_current == of.peak_current else 0.0,
    }  # fmt: skip
    return figures | {name: float(x) for name, x in zip(names, thermal, strict=True)}


def render(machine: MachineExport) -> bytes:
    """The file of an axis."""
    ((_, of),) = machine.exports
    if of.stepper:
        raise InputError(
            f"{of.label}: a stepper has no winding that a voltage drives in an FMU; expected --format mjcf, urdf, sdf, "
            "ros2_control or json"
        )
    if isnan(of.train.motor_inertia):
        raise InputError(
            f"{of.label}: the rotor's inertia is not in the catalogue, and an FMU moves by it; expected --format urdf, "
            "sdf or json, which do without"
        )
    try:
        from pythonfmu.builder import FmuBuilder  # type: ignore[import-untyped, unused-ignore]
    except ImportError:
        raise InputError("--format: fmu needs PythonFMU; pip install 'drivesizer[fmu]'") from None
    if time.time() < _1980:
        raise InputError("--format: an FMU is a ZIP archive, which has no dates before 1980; set this machine's clock")
    code = {
        name: Path(str(module.__file__)).read_text("utf-8") for name, module in (("motor", fmu_motor), ("heat", heat))
    }
    figures, title = repr(parameters(of)), repr(text(f"{of.name}: {of.label}; {of.program}"))
    digest = hashlib.sha256("\0".join((_SLAVE, figures, title, *code.values())).encode()).hexdigest()[:_DIGITS]
    with tempfile.TemporaryDirectory(prefix="drivesizer-") as folder:
        script, packed = Path(folder) / f"drive_{digest}.py", []
        script.write_bytes(_SLAVE.format(figures=figures, said=title, digest=digest).encode())
        for name, source in code.items():
            packed.append(Path(folder) / f"drive_{digest}_{name}.py")
            packed[-1].write_bytes(source.replace(heat.__name__, f"drive_{digest}_heat").encode())
        with _tidy():
            archive = FmuBuilder.build_FMU(script, dest=folder, project_files=packed)
        return _settled(archive.read_bytes(), of)


@contextmanager
def _tidy() -> Iterator[None]:
    """PythonFMU imports what it packs, from where it lies; here nothing of that stays."""
    path, modules = list(sys.path), set(sys.modules)
    try:
        yield
    finally:
        sys.path[:] = path
        for name in set(sys.modules) - modules:
            if name.startswith("drive_"):
                del sys.modules[name]


def _settled(archive: bytes, of: Export) -> bytes:
    """The archive with units, fixed dates, names in order, and a GUID that is that of its content."""
    with zipfile.ZipFile(io.BytesIO(archive)) as packed:
        files = {name: packed.read(name) for name in sorted(packed.namelist()) if "__pycache__" not in name}
    name = "modelDescription.xml"
    described = fromstring(files.pop(name))  # noqa: S314 - made a moment ago
    described.attrib.pop("generationDateAndTime")
    described.set("guid", "")
    units = Element("UnitDefinitions")  # which PythonFMU does not write
    for unit, base in _UNITS.items():
        SubElement(SubElement(units, "Unit", name=unit), "BaseUnit", base)
    described.insert(1, units)  # behind CoSimulation, the first
    named = fmu_motor.FIGURES | fmu_motor.INPUTS | fmu_motor.OUTPUTS
    for variable in described.iter("ScalarVariable"):
        real = variable.find("Real")
        if real is not None:
            turns = variable.get("name") == "load_speed" and of.turns
            real.set("unit", "rad/s" if turns else named[variable.get("name", "")][0])
    structure = described.find("ModelStructure")
    assert structure is not None
    outputs = [unknown.attrib for unknown in structure.iter("Unknown")]
    initial = SubElement(structure, "InitialUnknowns")  # what is computed before the first step, which must be listed
    for attributes in outputs:
        SubElement(initial, "Unknown", attributes)
    content = hashlib.sha256(b"".join(files.values()) + tostring(described)).hexdigest()
    described.set("guid", f"{{{uuid.uuid5(_SPACE, content)}}}")
    files[name] = document(described)
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archived:
        for path, written in sorted(files.items()):
            entry = zipfile.ZipInfo(path, _DATE)
            entry.external_attr = 0o644 << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archived.writestr(entry, written)
    return out.getvalue()


_SLAVE = '''"""The FMU's side of the drive: its variables by name."""
from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

from drive_{digest}_motor import FIGURES, INPUTS, OUTPUTS, Drive

SET = {figures}


class Drive_(Drive, Fmi2Slave):
    description = {said}

    def __init__(self, **kwargs):
        Fmi2Slave.__init__(self, **kwargs)
        Drive.__init__(self, SET)
        self.modelName = "Drive_{digest}"
        for name, (_, said) in FIGURES.items():
            kind = {{"causality": Fmi2Causality.parameter, "variability": Fmi2Variability.tunable}}
            self.register_variable(Real(name, description=said, **kind))
        for name, (_, said) in INPUTS.items():
            self.register_variable(Real(name, causality=Fmi2Causality.input, description=said))
        for name, (_, said) in OUTPUTS.items():
            if SET["winding_to_housing"] > 0.0 or not name.endswith("_temperature"):
                self.register_variable(Real(name, causality=Fmi2Causality.output, description=said))

    def exit_initialization_mode(self):
        self.winding_temperature = self.housing_temperature = self.ambient

    def do_step(self, current_time, step_size):
        self.advance(step_size)
        return True
'''
