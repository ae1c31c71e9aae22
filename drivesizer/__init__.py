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
    "MachineSizing",
    "RobotSpec",
    "SizingResult",
    "explain",
    "load_catalog",
    "load_machine",
    "load_spec",
    "size",
    "size_machine",
    "validate",
]

if TYPE_CHECKING:
    from typing import Any

    from drivesizer.catalog import load as load_catalog
    from drivesizer.errors import CatalogError, DrivesizerError, InputError
    from drivesizer.multi_axis.sizing import size_machine
    from drivesizer.results.machine import MachineSizing
    from drivesizer.results.sizing import SizingResult
    from drivesizer.simulate import validate
    from drivesizer.sizing import explain, size
    from drivesizer.spec.machine import load_machine
    from drivesizer.spec.robot import RobotSpec, load_spec

_HOME = {
    "CatalogError": "errors",
    "DrivesizerError": "errors",
    "InputError": "errors",
    "MachineSizing": "results.machine",
    "RobotSpec": "spec.robot",
    "SizingResult": "results.sizing",
    "explain": "sizing",
    "load_catalog": "catalog:load",
    "load_machine": "spec.machine",
    "load_spec": "spec.robot",
    "size": "sizing",
    "size_machine": "multi_axis.sizing",
    "validate": "simulate",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'drivesizer' has no attribute {name!r}")
    from importlib import import_module

    module, _, attribute = _HOME[name].partition(":")
    return getattr(import_module(f"drivesizer.{module}"), attribute or name)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
