"""The paper's method: equations (1)-(20) for a spec, and its selection rule (section 3.1.3) as checks on columns."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from drivesizer import equations as eq
from drivesizer.catalog import Catalog
from drivesizer.loads.motions import Trapezoid
from drivesizer.loads.wheeled_vehicle import Cylinder, WheeledVehicle
from drivesizer.physics.equation import Equation
from drivesizer.physics.figures import Alike, Array, Figures, Mask, Whole
from drivesizer.results.check_columns import CheckColumn, at_least, at_most
from drivesizer.results.drive_set import DriveSet, Requirement
from drivesizer.spec.robot import RobotSpec

# -- The paper's method: equations (1)-(20) for a spec.
#
# One derivation serves everything: with one rotor inertia it gives the figures of one drive, with a column of them
# the figures of all candidates at once. Every step keeps its equation and the numbers put in.


BRAKING = eq.braking_torque_per_motor.name


class Derivation:
    """Requirements in the order in which they were derived, by name."""

    def __init__(self) -> None:
        self.steps: dict[str, Requirement] = {}

    def step(self, declared: Equation, *, name: str = "", symbol: str = "", title: str = "", **inputs: Alike) -> Alike:
        """Compute a declared equation, keep the step, and give its value."""
        value = declared(**inputs)
        self._keep(declared, value, (name, symbol, title), declared.note, inputs, declared)
        return value

    def from_spec(self, like: Equation, value: Alike, *, name: str = "", symbol: str = "", title: str = "") -> Alike:
        """Keep a figure that the spec gives in place of an equation."""
        self._keep(like, value, (name, symbol, title), "given in the spec", {})
        return value

    def _keep(
        self, like: Equation, value: Alike, words: tuple[str, str, str], note: str, inputs: dict[str, Alike],
        declared: Equation | None = None,
    ) -> None:  # fmt: skip
        name, symbol, title = words
        called = name or like.name
        self.steps[called] = Requirement(
            name=called, title=title or like.title, symbol=symbol or like.symbol, value=value, kind=like.kind,
            unit=like.display_unit, declared=declared, inputs=inputs, note=note,
        )  # fmt: skip


def vehicle(spec: RobotSpec, rotor_inertia: Alike) -> Derivation:
    """Requirements (1)-(16) of a wheeled vehicle."""
    d, load, motion, factors = Derivation(), spec.load, spec.motion, spec.paper_factors
    assert isinstance(load, WheeledVehicle) and isinstance(motion, Trapezoid)  # nothing else: RobotSpec.paper_applies
    g, N, wheel, m_R = spec.environment.gravity, load.driven_wheels, load.wheel_diameter, load.mass
    t_acc, t_nom, _, V_nom = motion.phases
    PF, t_rest = factors.oversize, motion.rest_time

    n_nom = d.step(eq.nominal_speed, V_nom=V_nom, d=wheel, eta_speed=factors.speed_reserve)
    if load.sinkage is not None:
        C_rr = d.step(eq.rolling_resistance_coefficient, z=load.sinkage, d=wheel)
    else:
        C_rr = d.from_spec(eq.rolling_resistance_coefficient, load.rolling_resistance)
    F_nom = d.step(eq.nominal_force, C_rr=C_rr, m_R=m_R, g=g, theta=load.slope)
    M_nom = d.step(eq.nominal_torque, d=wheel, F_nom=F_nom, delta=factors.bearing)
    d.step(eq.nominal_torque_per_motor, M_nom=M_nom, N=N)
    a = d.step(eq.acceleration, V_nom=V_nom, t_acc=t_acc)
    kappa = factors.confidence
    d.step(eq.nominal_power_per_motor, PF=PF, m_R=m_R, V_nom=V_nom, a=a, g=g, theta=load.slope, kappa=kappa, N=N)
    d.step(eq.mechanical_power_per_motor, PF=PF, F_nom=F_nom, m_R=m_R, a=a, V_nom=V_nom, kappa=kappa, N=N)
    J_s = 0.0
    if load.cylinders is None:
        J_w = d.from_spec(
            eq.cylinder_inertia, load.inertia, name="wheel_inertia", symbol="J_w", title="Inertia of a wheel"
        )
    else:
        J_w = _cylinder(d, "wheel", "w", load.cylinders.wheel)
        J_s = _cylinder(d, "shaft", "s", load.cylinders.shaft) if load.cylinders.shaft else 0.0
    M_acc = d.step(
        eq.acceleration_torque,
        N=N, J_w=J_w, J_m=rotor_inertia, J_s=J_s, m_R=m_R, eta_robot=factors.robot_efficiency, d=wheel, a=a, PF=PF,
    )  # fmt: skip
    M_max = d.step(eq.maximum_torque, M_nom=M_nom, M_acc=M_acc)
    M_max_m = d.step(eq.maximum_torque_per_motor, M_max=M_max, N=N)
    M_dec = d.step(eq.deceleration_torque, M_nom=M_nom, M_acc=M_acc)
    if M_nom < 0.0:  # downhill
        d.step(eq.braking_torque_per_motor, M_dec=M_dec, N=N)
    times: dict[str, Alike] = {"t_acc": t_acc, "t_nom": t_nom, "t_dec": t_acc, "t_rest": t_rest}
    M_rest = d.step(eq.rest_torque, m_R=m_R, g=g, theta=load.slope, d=wheel) if load.slope else 0.0
    M_rms = d.step(eq.rms_torque, M_max=M_max, M_nom=M_nom, M_dec=M_dec, M_rest=M_rest, **times)
    M_rms_m = d.step(eq.rms_torque_per_motor, M_rms=M_rms, N=N)
    d.step(eq.maximum_power_per_motor, M_max_m=M_max_m, n_nom=n_nom)
    n_rms = d.step(eq.rms_speed, n_nom=n_nom, **times)
    d.step(eq.rms_power_per_motor, M_rms_m=M_rms_m, n_rms=n_rms)
    return d


def _cylinder(d: Derivation, what: str, index: str, cylinder: Cylinder) -> Alike:
    radii = {"r_a": cylinder.outer_diameter / 2, "r_i": cylinder.inner_diameter / 2}
    m_i = d.step(
        eq.cylinder_mass, name=f"{what}_mass", symbol=f"m_{index}", title=f"Mass of a {what}",
        rho=cylinder.density, h=cylinder.width, **radii,
    )  # fmt: skip
    return d.step(
        eq.cylinder_inertia, name=f"{what}_inertia", symbol=f"J_{index}", title=f"Inertia of a {what}", m_i=m_i, **radii
    )


def motor_requirements(
    spec: RobotSpec, wheel: Mapping[str, Requirement], motor: Figures, gearhead: Figures, belt: Alike
) -> Derivation:
    """Requirements (17)-(20) of candidates."""
    d = Derivation()
    geared = {"K_g": gearhead["ratio"], "eta_gear": gearhead["efficiency"]}
    chain = geared | {"i_b": belt, "eta_b": spec.belt_efficiency}
    K, M_rms_m = gearhead["ratio"] * belt, wheel["rms_torque_per_motor"].value
    M_max_m = wheel["maximum_torque_per_motor"].value
    d.step(eq.rms_torque_at_motor, M_rms_m=M_rms_m, **chain)
    M_max_m0 = d.step(eq.maximum_torque_at_motor, M_max_m=M_max_m, **chain)
    if BRAKING in wheel:
        d.step(
            eq.maximum_torque_at_motor, name=f"{BRAKING}_at_motor", symbol="M_brake/m0",
            title="Largest torque at the motor downhill, while it brakes", M_max_m=wheel[BRAKING].value, **chain,
        )  # fmt: skip
    V_0 = d.step(
        eq.no_load_speed, n_nom=wheel["nominal_speed"].value, K=K, tau=motor["speed_torque_gradient"], M_max_m0=M_max_m0
    )
    d.step(eq.speed_constant, V_0=V_0, U=motor["nominal_voltage"])
    d.step(eq.rotor_inertia_at_wheel, J_m=motor["rotor_inertia"], K=K)
    if spec.belt:
        for declared, torque in (
            (eq.rms_torque_at_motor, {"M_rms_m": M_rms_m}), (eq.maximum_torque_at_motor, {"M_max_m": M_max_m}),
        ):  # fmt: skip
            title = f"{declared.title}, as printed (no belt)"
            d.step(declared, name=f"{declared.name}_as_printed", title=title, **torque, **geared)
    return d


def drive_requirements(spec: RobotSpec, drive: DriveSet | None) -> dict[str, Requirement]:
    """Requirements (1)-(20) of a wheeled vehicle with a drive; without one (1)-(16), with no rotor inertia."""
    if drive is None:
        return vehicle(spec, 0.0).steps
    wheel = vehicle(spec, drive.motor.rotor_inertia).steps
    return wheel | motor_requirements(spec, wheel, drive.motor, drive.gearhead, drive.belt_ratio).steps


# -- The paper's selection rule (section 3.1.3): its conditions on gearhead and motor as checks on columns.


FEW = 4096  # candidates that are kept: variants of a spec have them in common, and more of them take room


def largest_torque_at_motor(shaft: Mapping[str, Requirement]) -> Alike:
    """The largest torque at the motor by magnitude: (18), or downhill that of braking [N*m]."""
    return shaft.get(f"{BRAKING}_at_motor", shaft["maximum_torque_at_motor"]).value


def _speed_constant(shaft: Mapping[str, Requirement], motor: Figures) -> Alike:
    """Least speed constant by (19) and (20): at the end of acceleration or where braking begins.

    Uphill and on level ground it is the first, as printed.
    """
    printed, first = shaft["speed_constant"].value, shaft["no_load_speed"].inputs
    if f"{BRAKING}_at_motor" not in shaft:
        return printed
    braked = eq.no_load_speed(**first | {"M_max_m0": -largest_torque_at_motor(shaft)})
    return np.maximum(np.abs(printed), np.abs(eq.speed_constant(braked, motor["nominal_voltage"])))


def rule(
    spec: RobotSpec,
    wheel: Mapping[str, Requirement],
    shaft: Mapping[str, Requirement],
    motor: Figures,
    gearhead: Figures,
    belt: Alike,
) -> list[CheckColumn]:
    """The paper's conditions on gearhead and motor (section 3.1.3), as columns over the candidates."""
    at_gearhead = belt * spec.belt_efficiency
    n_motor = wheel["nominal_speed"].value * gearhead["ratio"] * belt
    largest = wheel.get(BRAKING, wheel["maximum_torque_per_motor"]).value  # by magnitude
    torque = wheel["rms_torque_per_motor"].value / at_gearhead, largest / at_gearhead
    rms, peak = shaft["rms_torque_at_motor"].value, largest_torque_at_motor(shaft)
    checks = [
        at_most("gearhead_continuous_torque", torque[0], gearhead["continuous_torque"]),
        at_most("gearhead_intermittent_torque", torque[1], gearhead["intermittent_torque"]),
        at_most("gearhead_input_speed", n_motor, gearhead["continuous_input_speed"]),
        at_least("motor_speed", n_motor, motor["no_load_speed"]),
        at_most("motor_continuous_torque", rms, motor["nominal_torque"]),
        at_most("motor_maximum_torque", peak, motor["stall_torque"]),
        _power(wheel, motor),
        at_least("speed_constant", _speed_constant(shaft, motor), motor["speed_constant"]),
    ]
    if spec.needs.backlash_at_load is not None:
        lost = gearhead["backlash"] / belt
        checks.append(at_most("backlash_at_load", lost, spec.needs.backlash_at_load))
    return checks


def _power(wheel: Mapping[str, Requirement], motor: Figures) -> CheckColumn:
    return at_most("motor_power", wheel["rms_power_per_motor"].value, motor["assigned_power"])


def hopeless(spec: RobotSpec, catalog: Catalog, motor: Whole, gearhead: Whole, belt: Array) -> Mask:
    """Candidates that the rule rejects by figures of one part: no motor for this machine, or a gearhead too fast.

    Without them the others pass and fail as with them: the reductions of a family are compared for each motor, and one
    that turns too fast is none that is allowed.
    """
    wheel, gears = vehicle(spec, catalog.motors["rotor_inertia"]).steps, catalog.gearheads
    fails: Mask = _power(wheel, catalog.motors).failed[motor]
    left = np.flatnonzero(~fails)
    row = gearhead[left]
    n_motor = wheel["nominal_speed"].value * gears["ratio"][row] * belt[left]
    fails[left] = n_motor > gears["continuous_input_speed"][row]
    return fails


def _groups(catalog: Catalog, motor: Whole, gearhead: Whole) -> Whole:
    """Number of each candidate's motor and gearhead family among those that there are, from 0."""
    families = catalog.once("families", lambda: np.unique(catalog.gearheads["family"], return_inverse=True)[1])
    group = motor.astype(np.int64) * (families.max(initial=0) + 1) + families[gearhead]
    return np.unique(group, return_inverse=True)[1]


def largest_allowed(
    catalog: Catalog, motor: Whole, gearhead: Whole, total: Array, gear: list[CheckColumn]
) -> CheckColumn:
    """The rule that one reduction remains per motor and gearhead family: the largest that is allowed."""
    allowed = np.logical_and.reduce([check.passed for check in gear])
    possible = ~np.logical_or.reduce([check.failed for check in gear])
    key, of = "families of candidates", (motor, gearhead)
    group = catalog.once(key, lambda: _groups(catalog, *of), of) if len(motor) <= FEW else _groups(catalog, *of)
    largest = np.full(group.max(initial=-1) + 1, -np.inf)
    np.maximum.at(largest, group[allowed], total[allowed])
    doubtful = possible & ~np.isfinite(largest[group])
    np.maximum.at(largest, group[doubtful], total[doubtful])
    required = np.where(np.isfinite(largest[group]), largest[group], total)
    return at_least("largest_reduction", required, total, by_choice=True)
