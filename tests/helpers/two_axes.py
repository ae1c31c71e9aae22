"""A small machine: a belt axis that carries the stepper of a table."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import stepper_catalog
import yaml
from forty_motors import catalogue

from drivesizer.spec.machine import load_machine

__all__ = ["STEPPER", "two_axes"]

STEPPER = 0.39  # kg, of the stepper as its catalogue has it
_RAMP = {"acceleration_time": "0.15 s", "cruise_time": "0.1 s", "rest_time": "0.1 s"}


def two_axes(folder: Path) -> Any:
    """The machine, with its catalogues in a folder.

    Parameters
    ----------
    folder
        Where its file and catalogues are written.

    Returns
    -------
    MachineSpec
    """
    shelf = folder / "shelf.yaml"
    shelf.write_text(catalogue(lambda n: 0.6 - 0.01 * n, "0.1 K/W"), encoding="utf-8")
    axes = {
        "x": {"load": {"kind": "belt_axis", "mass": "2 kg", "pulley_diameter": "40 mm"}, "carries": ["table"],
              "motion": {"speed": "1 m/s", "there_and_back": True, **_RAMP}, "select": {"catalogs": [str(shelf)]}},
        "table": {"load": {"kind": "flywheel", "inertia": "4e-4 kg*m^2"}, "motion": {"speed": "300 rpm", **_RAMP},
                  "transmission": [{"kind": "direct"}],
                  "select": {"catalogs": [str(stepper_catalog.written(folder))],
                             "motor": {"kind": "stepper", "part": "A2"}}},
    }  # fmt: skip
    supply = {"nominal": "24 V", "accepts": "all"}
    spec = {"name": "two", "supply": supply, "select": {"estimates": "off"}, "axes": axes}
    path = folder / "two.yaml"
    path.write_text(yaml.safe_dump(spec, sort_keys=False), encoding="utf-8")
    return load_machine(path)
