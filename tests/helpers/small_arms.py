"""Arms of three joints with a catalogue of few motors and gearheads, and every combination of their drives."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from random import Random
from string import Template
from typing import Any

import numpy as np
from bought_parts import together

from drivesizer.catalog import Catalog
from drivesizer.machine.problem import problem
from drivesizer.search.columns.candidates import candidates
from drivesizer.search.columns.evaluation import evaluate
from drivesizer.search.set_record import drive_parts
from drivesizer.search.shortlist import load_parts
from drivesizer.spec.machine import MachineSpec, carrying, load_machine

JOINTS = ("shoulder", "elbow", "wrist")
_CATALOG = Template(Path(__file__).with_suffix(".yaml").read_text(encoding="utf-8"))


def catalogue(random: Random) -> str:
    """Text of a catalogue of three motors and two gearheads: larger ones are heavier, dear or cheap."""
    motors, gears = [], []
    for n in range(3):
        size = 3.0**n
        kt, mass, price = 36.6, 60 * size * random.uniform(0.7, 1.4), random.uniform(40, 300)
        motors.append(
            f"      - [m{n}, {kt}, {2.4 / size:.4f}, {20 * size**1.5:.2f}, {1.2 * size:.2f}, {mass:.1f}, {price:.0f}]"
        )
    for n, ratio in enumerate((43, 111)):
        mass, price = 150 * (n + 1) * random.uniform(0.7, 1.4), random.uniform(60, 250)
        gears.append(f"      - [g{n}, {ratio}, 80, {15 * (n + 1)}, {25 * (n + 1)}, {mass:.1f}, {price:.0f}]")
    return _CATALOG.substitute(motors="\n".join(motors), gears="\n".join(gears))


def arm(random: Random, folder: Path, objective: str) -> MachineSpec:
    """A random arm whose motors sit at its joints."""
    file = folder / "parts.yaml"
    file.write_text(catalogue(random), encoding="utf-8")
    lengths = [random.uniform(0.15, 0.35) for _ in JOINTS]
    masses = [random.uniform(0.3, 1.2) for _ in JOINTS]
    speed, rest = random.uniform(20, 40), random.uniform(0.2, 2.0)
    motion = {
        "profile": "trapezoid", "speed": f"{speed:.3f} deg/s", "acceleration_time": "0.3 s", "cruise_time": "0.6 s",
        "rest_time": f"{rest:.3f} s", "there_and_back": True,
    }  # fmt: skip
    axes: dict[str, Any] = {}
    for n, joint in enumerate(JOINTS):
        mass = sum(masses[n:])
        places = np.cumsum([0.0, *lengths[n:]])
        centres = [places[k] + length / 2 for k, length in enumerate(lengths[n:])]
        centre = sum(m * c for m, c in zip(masses[n:], centres, strict=True)) / mass
        inertia = sum(m * c * c for m, c in zip(masses[n:], centres, strict=True)) * 1.1
        axes[joint] = {
            "load": {
                "kind": "arm",
                "mass": f"{mass:.9f} kg",
                "length": f"{centre:.9f} m",
                "inertia": f"{inertia:.9f} kg*m^2",
            },
            "motion": motion,
            "carries": {other: {"at": f"{places[k]:.6f} m"} for k, other in enumerate(JOINTS[n + 1 :], 1)},
        }
    return load_machine({
        "name": "arm", "supply": {"nominal": "24 V", "accepts": "all"}, "axes": axes,
        "select": {"catalogs": [str(file)], "objective": objective, "estimates": "off"},
    })  # fmt: skip


def least_of_all(machine: MachineSpec, objective: str) -> float:
    """Least sum of the objective of all combinations of drives that hold, each examined with all others on it."""
    return min((total for total, _ in every_combination(machine, objective)), default=math.inf)


def every_combination(machine: MachineSpec, objective: str) -> Iterator[tuple[float, int]]:
    """Sum of the objective, and number of kinds of drives, of all combinations that hold with all others on them."""
    catalog: Catalog = load_parts(machine.axes[0].spec)

    @cache
    def holding(joint: str, on_it: tuple[float, ...]) -> tuple[tuple[float, float, tuple[str, str]], ...]:
        """Objective, mass and parts of the drives that pass with these masses on the joint."""
        spec, places = machine.axis(joint).spec, machine.carried(joint).values()
        load = carrying(spec.load, zip(on_it, places, strict=True))
        of_all = problem(spec.model_copy(update={"load": load}), catalog)
        found = evaluate(of_all, candidates(of_all))
        parts = [drive_parts(found, row) for row in np.flatnonzero(~found.failed).tolist()]
        return tuple(
            (
                together(one, objective, estimates=False),
                one.motor.mass + one.gearhead.mass,
                (one.motor.part, one.gearhead.part),
            )
            for one in parts
        )

    for wrist in holding("wrist", ()):
        for elbow in holding("elbow", (wrist[1],)):
            for shoulder in holding("shoulder", (elbow[1], wrist[1])):
                yield wrist[0] + elbow[0] + shoulder[0], len({wrist[2], elbow[2], shoulder[2]})


def two_joints(folder: Path, **robot: Any) -> dict[str, Any]:
    """A level arm of two thin links with point masses at their ends: 1 kg at 0.4 m and 0.5 kg at 0.7 m."""
    link = '<link name="{}"><inertial><origin xyz="{} 0 0"/><mass value="{}"/>'
    link += '<inertia ixx="1e-9" iyy="1e-9" izz="1e-9"/></inertial></link>'
    joint = '<joint name="{}" type="revolute"><parent link="{}"/><child link="{}"/><origin xyz="{} 0 0"/>'
    joint += '<axis xyz="0 1 0"/><limit lower="-3" upper="3" velocity="5" effort="99"/></joint>'
    parts = [link.format("upper", 0.4, 1.0), link.format("fore", 0.3, 0.5)]
    parts += [joint.format("shoulder", "base", "upper", 0), joint.format("elbow", "upper", "fore", 0.4)]
    (folder / "arm.urdf").write_text(f'<robot name="arm"><link name="base"/>{"".join(parts)}</robot>', encoding="utf-8")
    poses = [{"positions": {"shoulder": "0 deg", "elbow": "0 deg"}, "pause": "1 s"},
             {"positions": {"shoulder": "-40 deg", "elbow": "-30 deg"}}]  # fmt: skip
    section = {
        "description": str(folder / "arm.urdf"),
        "waypoints": poses,
        "limits": {"all": {"acceleration": "4 rad/s^2"}},
    }
    return {"name": "arm", "supply": {"nominal": "48 V"}, "robot": {**section, **robot}}
