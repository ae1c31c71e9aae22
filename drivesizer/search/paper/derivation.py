"""The paper's method: equations (1)-(20) for a spec.

One derivation serves everything: with one rotor inertia it gives the figures of one drive, with a column of them
the figures of all candidates at once. Every step keeps its equation and the numbers put in.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from drivesizer import equations as eq
from drivesizer.loads.wheeled_vehicle import Cylinder, WheeledVehicle
from drivesizer.physics.equation import Equation
from drivesizer.physics.figures import Figures
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.requirement import Requirement
from drivesizer.spec.motions import Trapezoid
from drivesizer.spec.robot import RobotSpec

__all__ = ["BRAKING", "Derivation", "drive_requirements", "motor_requirements", "vehicle"]

BRAKING = eq.braking_torque_per_motor.name


class Derivation:
    """Requirements in the order in which they were derived, by name."""

    def __init__(self) -> None:
        self.steps: dict[str, Requirement] = {}

    def step(self, declared: Equation, *, name: str = "", symbol: str = "", title: str = "", **inputs: Any) -> Any:
        """Compute a declared equation, keep the step, and give its value."""
        value, called = declared(**inputs), name or declared.name
        self.steps[called] = Requirement(
            name=called,
            title=title or declared.title,
            symbol=symbol or declared.symbol,
            value=value,
            kind=declared.kind,
            unit=declared.shown,
            declared=declared,
            inputs=inputs,
            note=declared.note,
        )
        return value

    def given(self, like: Equation, value: Any, *, name: str = "", symbol: str = "", title: str = "") -> Any:
        """Keep a figure that the spec gives in place of an equation."""
        self.steps[name or like.name] = Requirement(
            name=name or like.name,
            title=title or like.title,
            symbol=symbol or like.symbol,
            value=value,
            kind=like.kind,
            unit=like.shown,
            note="given in the spec",
        )
        return value


def vehicle(spec: RobotSpec, rotor_inertia: Any) -> Derivation:
    """Requirements (1)-(16) of a wheeled vehicle."""
    d, load, motion, factors = Derivation(), spec.load, spec.motion, spec.paper_factors
    assert isinstance(load, WheeledVehicle) and isinstance(motion, Trapezoid)  # nothing else: RobotSpec.paper_applies
    g, N, wheel, m_R = spec.environment.gravity, load.driven_wheels, load.wheel_diameter, load.mass
    t_acc, t_nom, t_rest = motion.acceleration_time, motion.cruise_time, motion.rest_time
    PF, V_nom = factors.oversize, motion.speed

    n_nom = d.step(eq.nominal_speed, V_nom=V_nom, d=wheel, eta_speed=factors.speed_reserve)
    C_rr = _rolling_resistance(d, load)
    F_nom = d.step(eq.nominal_force, C_rr=C_rr, m_R=m_R, g=g, theta=load.slope)
    M_nom = d.step(eq.nominal_torque, d=wheel, F_nom=F_nom, delta=factors.bearing)
    d.step(eq.nominal_torque_per_motor, M_nom=M_nom, N=N)
    a = d.step(eq.acceleration, V_nom=V_nom, t_acc=t_acc)
    kappa = factors.confidence
    d.step(eq.nominal_power_per_motor, PF=PF, m_R=m_R, V_nom=V_nom, a=a, g=g, theta=load.slope, kappa=kappa, N=N)
    d.step(eq.mechanical_power_per_motor, PF=PF, F_nom=F_nom, m_R=m_R, a=a, V_nom=V_nom, kappa=kappa, N=N)
    J_w, J_s = _turning_parts(d, load)
    M_acc = d.step(
        eq.acceleration_torque,
        N=N, J_w=J_w, J_m=rotor_inertia, J_s=J_s, m_R=m_R, eta_robot=factors.robot_efficiency, d=wheel, a=a, PF=PF,
    )  # fmt: skip
    M_max = d.step(eq.maximum_torque, M_nom=M_nom, M_acc=M_acc)
    M_max_m = d.step(eq.maximum_torque_per_motor, M_max=M_max, N=N)
    M_dec = d.step(eq.deceleration_torque, M_nom=M_nom, M_acc=M_acc)
    if M_nom < 0.0:  # downhill
        d.step(eq.braking_torque_per_motor, M_dec=M_dec, N=N)
    times: dict[str, Any] = {"t_acc": t_acc, "t_nom": t_nom, "t_dec": t_acc, "t_rest": t_rest}
    M_rest = d.step(eq.rest_torque, m_R=m_R, g=g, theta=load.slope, d=wheel) if load.slope else 0.0
    M_rms = d.step(eq.rms_torque, M_max=M_max, M_nom=M_nom, M_dec=M_dec, M_rest=M_rest, **times)
    M_rms_m = d.step(eq.rms_torque_per_motor, M_rms=M_rms, N=N)
    d.step(eq.maximum_power_per_motor, M_max_m=M_max_m, n_nom=n_nom)
    n_rms = d.step(eq.rms_speed, n_nom=n_nom, **times)
    d.step(eq.rms_power_per_motor, M_rms_m=M_rms_m, n_rms=n_rms)
    return d


def _rolling_resistance(d: Derivation, load: WheeledVehicle) -> Any:
    if load.sinkage is not None:
        return d.step(eq.rolling_resistance_coefficient, z=load.sinkage, d=load.wheel_diameter)
    return d.given(eq.rolling_resistance_coefficient, load.rolling_resistance)


def _turning_parts(d: Derivation, load: WheeledVehicle) -> tuple[Any, Any]:
    """J_w and J_s: from the cylinders by (8) and (9), or given as one inertia."""
    if load.cylinders is None:
        J_w = d.given(eq.cylinder_inertia, load.inertia, name="wheel_inertia", symbol="J_w", title="Inertia of a wheel")
        return J_w, 0.0
    J_w = _cylinder(d, "wheel", "w", load.cylinders.wheel)
    J_s = _cylinder(d, "shaft", "s", load.cylinders.shaft) if load.cylinders.shaft else 0.0
    return J_w, J_s


def _cylinder(d: Derivation, what: str, index: str, cylinder: Cylinder) -> Any:
    radii = {"r_a": cylinder.outer_diameter / 2, "r_i": cylinder.inner_diameter / 2}
    m_i = d.step(
        eq.cylinder_mass, name=f"{what}_mass", symbol=f"m_{index}", title=f"Mass of a {what}",
        rho=cylinder.density, h=cylinder.width, **radii,
    )  # fmt: skip
    return d.step(
        eq.cylinder_inertia, name=f"{what}_inertia", symbol=f"J_{index}", title=f"Inertia of a {what}", m_i=m_i, **radii
    )


def motor_requirements(
    spec: RobotSpec, wheel: Mapping[str, Requirement], motor: Figures, gearhead: Figures, belt: Any
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
        _as_printed(d, eq.rms_torque_at_motor, M_rms_m=M_rms_m, **geared)
        _as_printed(d, eq.maximum_torque_at_motor, M_max_m=M_max_m, **geared)
    return d


def drive_requirements(spec: RobotSpec, drive: DriveSet | None) -> dict[str, Requirement]:
    """Requirements (1)-(20) of a wheeled vehicle with a drive; without one (1)-(16), with no rotor inertia."""
    if drive is None:
        return vehicle(spec, 0.0).steps
    wheel = vehicle(spec, drive.motor.rotor_inertia).steps
    return wheel | motor_requirements(spec, wheel, drive.motor, drive.gearhead, drive.belt_ratio).steps


def _as_printed(d: Derivation, declared: Equation, **inputs: Any) -> None:
    d.step(
        declared, name=f"{declared.name}_as_printed", title=f"{declared.title}, as printed (no belt)", **inputs
    )  # fmt: skip
