"""drivesizer: size electric drives from one YAML file.

The command line is ``drivesizer``; from Python::

    from drivesizer import load_spec, size

    result = size(load_spec("robot.yaml"))
    print(result.sets[0].motor.part, result.sets[0].gearhead.part)

Names are loaded on first use, so that importing the package costs nothing.
"""

from __future__ import annotations

from drivesizer.version import __version__ as __version__

TYPE_CHECKING = False  # as of typing, whose import is not waited for here


__all__ = [
    "CatalogError",
    "DrivesizerError",
    "InputError",
    "LoadCycle",
    "MachineSizing",
    "Prediction",
    "RobotSpec",
    "SizingResult",
    "Validation",
    "catalog",
    "design",
    "equations",
    "explain",
    "load_catalog",
    "load_machine",
    "load_spec",
    "predict",
    "size",
    "size_machine",
    "size_variants",
    "tables",
    "units",
    "validate",
]

if TYPE_CHECKING:
    from typing import Any

    from drivesizer import catalog, equations, units
    from drivesizer.catalog import load as load_catalog
    from drivesizer.codesign.answer import design
    from drivesizer.control.validation import Validation
    from drivesizer.errors import CatalogError, DrivesizerError, InputError
    from drivesizer.multi_axis import size_machine
    from drivesizer.output.report.csv import tables
    from drivesizer.physics.load_cycle import LoadCycle
    from drivesizer.prediction.bench import predict_set as predict
    from drivesizer.results.machine import MachineSizing
    from drivesizer.results.prediction import Prediction
    from drivesizer.results.sizing import SizingResult
    from drivesizer.simulate import validate
    from drivesizer.sizing import explain, size
    from drivesizer.spec.machine import load_machine
    from drivesizer.spec.robot import RobotSpec, load_spec
    from drivesizer.study.run import size_variants

_HOME = {  # module, and the name in it where that is another; modules themselves have none
    "CatalogError": "errors",
    "DrivesizerError": "errors",
    "InputError": "errors",
    "LoadCycle": "physics.load_cycle",
    "MachineSizing": "results.machine",
    "Prediction": "results.prediction",
    "RobotSpec": "spec.robot",
    "SizingResult": "results.sizing",
    "Validation": "control.validation",
    "design": "codesign.answer",
    "explain": "sizing",
    "load_catalog": "catalog:load",
    "load_machine": "spec.machine",
    "load_spec": "spec.robot",
    "predict": "prediction.bench:predict_set",
    "size": "sizing",
    "size_machine": "multi_axis",
    "size_variants": "study.run",
    "tables": "output.report.csv",
    "validate": "simulate",
}


def __getattr__(name: str) -> Any:
    from importlib import import_module

    if name in ("catalog", "equations", "units"):
        return import_module(f"drivesizer.{name}")
    if name not in _HOME:
        raise AttributeError(f"module 'drivesizer' has no attribute {name!r}")
    module, _, attribute = _HOME[name].partition(":")
    return getattr(import_module(f"drivesizer.{module}"), attribute or name)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
