"""Simulations of a spec's platform and its drives along its path, with each robot model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import inf, isfinite
from typing import NamedTuple

from drivesizer.control.path_following.following import (
    Contact,
    Followed,
    Model,
    follow,
    is_unicycle,
    pose_loop,
    speed_loop,
)
from drivesizer.errors import InputError
from drivesizer.load_cases.platform import Driving, dynamics_of, ground_of
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.platform.stability import least_margin
from drivesizer.platform.wheels import EXACT, Misjudged
from drivesizer.results.drive_set import DriveSet
from drivesizer.spec.platform import Following, Platform
from drivesizer.units import show


class FollowingRun(NamedTuple):
    """Robot model and controllers of one simulation."""

    model: Model
    integral: bool  # speed loops PI, or plain P
    poses: bool  # fed back
    exact: bool  # the model knows the platform

    @property
    def words(self) -> tuple[str, str, str, str]:
        """Robot model, speed loops, poses, and knowledge of the model."""
        loop, poses = "PI" if self.integral else "P", "fed back" if self.poses else "open loop"
        return self.model, loop, poses, "all" if self.exact else "not all"


_MODELS: tuple[Model, ...] = ("kinematic", "dynamic")
_COMPARED = (
    *(FollowingRun(model, integral, False, exact) for exact in (True, False) for integral in (True, False)
      for model in _MODELS),
    *(FollowingRun(model, True, True, False) for model in _MODELS),
)  # fmt: skip


def follow_runs(found: Driving, chosen: DriveSet | None) -> dict[str, Followed]:
    """The runs by name: kinematic and dynamic model, open-loop, and the dynamic one with pose feedback where possible.

    Where the spec compares, also both models with P and PI loops, with and without misjudged figures. A path on which
    the platform tips over is refused: contact is simulated for wheels on the floor.
    """
    d, section = dynamics_of(found.spec), _section(found)
    if section.height_known:
        least = least_margin(d.platform, found.trajectory, ground_of(found.spec))
        if least.value < 0.0:
            raise InputError(
                f"{found.spec.where(('platform', 'centre_of_mass'))}: the platform tips over at "
                f"{show(least.time, 's', 'time')} of its path, {show(-least.value, 'mm', 'length')} beyond its wheels; "
                "expected one that can be followed: a lower centre of mass, or smaller platform.limits"
            )
    given, k = section.following, d.kinematics
    steered, integral = k.mobility == 3 or is_unicycle(k), given.speed_loop == "PI"
    if given.compare:
        cases = {", ".join(case.words): case for case in _COMPARED if steered or not case.poses}
    else:
        cases = {f"{model} model": FollowingRun(model, integral, False, False) for model in _MODELS}
        if steered:
            cases["poses fed back"] = FollowingRun("dynamic", integral, True, False)
    return {name: follow_case(found, chosen, case) for name, case in cases.items()}


def follow_case(
    found: Driving, chosen: DriveSet | None, case: FollowingRun, misjudged: Misjudged | None = None
) -> Followed:
    """Simulate one run; its speed loops are designed, with the gains that the spec gives."""
    section, load = _section(found), found.spec.load
    assert isinstance(load, WheeledVehicle)
    given, wheel = section.following, wheel_drive(section.following, chosen)
    d = dynamics_of(found.spec, wheel.inertia)
    speeds = speed_loop(d, period=given.period, limit=wheel.torque, integral=case.integral)
    if given.speed_gain is not None:
        speeds = replace(speeds, proportional=(given.speed_gain,) * len(speeds.proportional))
    if given.speed_integral is not None and case.integral:
        speeds = replace(speeds, integral=(given.speed_integral,) * len(speeds.integral))
    x, y, _ = found.trajectory.velocity
    fastest = float((x**2 + y**2).max() ** 0.5)
    floor = Contact(slip_speed=given.slip_speed, creep=given.creep)
    if load.friction_coefficient is not None:
        floor = replace(floor, friction=load.friction_coefficient)
    return follow(
        found.trajectory,
        d.platform,
        model=case.model,
        misjudged=EXACT if case.exact else misjudged or section.misjudged.record,
        contact=floor,
        speeds=speeds,
        poses=pose_loop(d, speeds, period=given.pose_period, speed=fastest) if case.poses else None,
        ground=ground_of(found.spec),
    )


def drawn(runs: Mapping[str, Followed]) -> dict[str, Followed]:
    """The runs that one figure shows: of several loops both models with plain ones, poses not fed back."""
    shown = {(case.model, case.exact): ", ".join(case.words) for case in _COMPARED if not (case.integral or case.poses)}
    if not set(shown.values()) <= set(runs):
        return dict(runs)
    return {f"{model}, knows {'all' if exact else 'not all'}": runs[name] for (model, exact), name in shown.items()}


def _section(found: Driving) -> Platform:
    section = found.spec.platform
    assert section is not None
    return section


class AtWheel(NamedTuple):
    """A drive as its wheel has it."""

    inertia: float  # kg*m^2, of its rotor
    torque: float  # N*m, the largest; infinite: none is known


def wheel_drive(given: Following, chosen: DriveSet | None) -> AtWheel:
    """Inertia and largest torque of a drive at its wheel: as the spec gives them, else of the drive as far as known."""
    inertia, torque = 0.0, inf
    if chosen is not None:
        inertia = chosen.rotors_at_load
        peak = chosen.controller.peak_current if chosen.controller else inf
        by_motor = peak * chosen.motor.torque_constant * chosen.gearhead.ratio * chosen.gearhead.efficiency
        limits = [limit for limit in (by_motor, chosen.gearhead.intermittent_torque) if limit == limit]
        torque = min(limits, default=inf) * chosen.belt_ratio * chosen.belt_efficiency
    return AtWheel(
        inertia if given.rotor_inertia is None else given.rotor_inertia,
        torque if given.torque_limit is None else given.torque_limit,
    )


def assumed(found: Driving, chosen: DriveSet | None) -> tuple[str, ...]:
    """Assumptions of the runs, as sentences."""
    given = _section(found).following
    wheel = wheel_drive(given, chosen)
    inertia, torque = show(wheel.inertia, "kg*cm^2", "inertia", 3), show(wheel.torque, "N*m", "torque", 3)
    period, poses = (show(value, "ms", "time") for value in (given.period, given.pose_period))
    slip = show(given.slip_speed, "mm/s", "speed") + (
        f" and {given.creep:g} of the rolling speed" * (given.creep > 0.0)
    )
    return (
        "slip, resistances and the controllers of the wheels are simulated; stiction, roller gaps, noise of encoders "
        "and poses, the voltage limit and the lag of the current loops are not",
        f"speed loops of {period} by the symmetrical optimum where no gain is given, poses every {poses}; slip meets "
        f"the grip at {slip}",
        f"at a wheel a rotor has {inertia}" + f" and a drive gives {torque} at most" * isfinite(wheel.torque),
        "the platform differs from its model as platform.misjudged says, and by slip",
    )
