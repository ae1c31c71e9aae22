"""The platform's dynamics, equations (34)-(52) and (57)-(59), each once.

Source and symbols: see ``equations``. In (34)-(51) forces are those on the platform, two forces and a moment in the
robot's axes; in (52)-(59) they are torques of the wheels.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from drivesizer.platform.matrix_equation import Array, matrix_equation

__all__ = [
    "coriolis_matrix", "generalised_force", "half_mass_matrix", "half_wheel_inertias", "inertia_matrix", "joint_form",
    "kinetic_energy", "kinetic_energy_form", "lagrange_operator", "mass_matrix", "motor_torques", "operational_force",
    "platform_force", "platform_inertia_force", "wheel_acceleration", "wheel_inertia_torque", "wheel_inertias",
    "wheel_space_coriolis", "wheel_space_inertia", "wheel_space_torque", "wheel_velocities", "world_acceleration",
]  # fmt: skip


@matrix_equation(34, "Eᵀ τ", printed="R @ T_xi + E.T @ T_phi")
def generalised_force(R: Array, T_xi: Array, E: Array, T_phi: Array) -> Array:
    """Lagrange's equation of the platform.

    Parameters
    ----------
    R: rotation of (22) [1]
    T_xi: operator (35) on the posture [N, N, N*m]
    E: wheel speeds over velocity [rad/s per m/s, m/s, rad/s]
    T_phi: operator (35) on the wheels' angles [N*m]

    Returns
    -------
    F: force and moment that the wheels' torques make [N, N, N*m]
    """
    return R @ T_xi + E.T @ T_phi


@matrix_equation(
    35, "[T]_ψ", printed="p_dot - T_psi", note="T is the kinetic energy, ψ the posture or a wheel's angle."
)
def lagrange_operator(p_dot: Array, T_psi: Array) -> Array:
    """Lagrange's operator.

    Parameters
    ----------
    p_dot: rate of change of the momentum [N, N, N*m]
    T_psi: slope of the kinetic energy over the posture [N, N, N*m]

    Returns
    -------
    T_xi: force and moment [N, N, N*m]
    """
    return p_dot - T_psi


@matrix_equation(36, "τ_ϕ", printed="array([tau_1, tau_2, tau_3, tau_4])", note="As many as there are motors.")
def motor_torques(tau_1: Array, tau_2: Array, tau_3: Array, tau_4: Array) -> Array:
    """Torques at the wheels.

    Parameters
    ----------
    tau_1: of the first wheel [N*m]
    tau_2: of the second wheel [N*m]
    tau_3: of the third wheel [N*m]
    tau_4: of the fourth wheel [N*m]

    Returns
    -------
    tau: torques [N*m]
    """
    return np.array([tau_1, tau_2, tau_3, tau_4])


@matrix_equation(
    37, "T", printed="xi_dot.T @ R @ M @ R @ xi_dot + varphi_dot.T @ I_phi @ varphi_dot",
    note="Printed with R twice; with it a platform that moves sideways would have other energy than one that moves "
    "ahead. The velocity in the robot's frame is R ξ̇, so the first R is transposed.",
)  # fmt: skip
def kinetic_energy_form(xi_dot: Array, R: Array, M: Array, varphi_dot: Array, I_phi: Array) -> Array:
    """Kinetic energy, as a quadratic form.

    Parameters
    ----------
    xi_dot: velocity in the world [m/s, m/s, rad/s]
    R: rotation of (22) [1]
    M: half the mass matrix, (38) [N, N, N*m per m/s^2, m/s^2, rad/s^2]
    varphi_dot: speeds of the wheels [rad/s]
    I_phi: half the wheels' inertias, (39) [kg*m^2]

    Returns
    -------
    T: kinetic energy [J]
    """
    return xi_dot.T @ R.T @ M @ R @ xi_dot + varphi_dot.T @ I_phi @ varphi_dot


@matrix_equation(38, "M", printed="1 / 2 * diag([m_R, m_R, I_Rz])")
def half_mass_matrix(m_R: float, I_Rz: float) -> Array:
    """Half the mass matrix of the platform.

    Parameters
    ----------
    m_R: mass, wheels included [kg]
    I_Rz: moment of inertia about the vertical [kg*m^2]

    Returns
    -------
    M: diagonal [N, N, N*m per m/s^2, m/s^2, rad/s^2]
    """
    return 1 / 2 * np.diag([m_R, m_R, I_Rz])


@matrix_equation(39, "I_ϕ", printed="1 / 2 * diag(I_phiy)")
def half_wheel_inertias(I_phiy: Array) -> Array:
    """Half the wheels' inertias.

    Parameters
    ----------
    I_phiy: moment of inertia of each wheel about its axle [kg*m^2]

    Returns
    -------
    I_phi: diagonal [kg*m^2]
    """
    return 1 / 2 * np.diag(I_phiy)


@matrix_equation(40, "ϕ̇", printed="array([varphi_1_dot, varphi_2_dot, varphi_3_dot, varphi_4_dot])")
def wheel_velocities(varphi_1_dot: Array, varphi_2_dot: Array, varphi_3_dot: Array, varphi_4_dot: Array) -> Array:
    """Speeds of the wheels.

    Parameters
    ----------
    varphi_1_dot: of the first wheel [rad/s]
    varphi_2_dot: of the second wheel [rad/s]
    varphi_3_dot: of the third wheel [rad/s]
    varphi_4_dot: of the fourth wheel [rad/s]

    Returns
    -------
    varphi_dot: speeds [rad/s]
    """
    return np.array([varphi_1_dot, varphi_2_dot, varphi_3_dot, varphi_4_dot])


@matrix_equation(
    41, "T",
    printed="m_R / 2 * (x_dot**2 + y_dot**2) + I_Rz / 2 * theta_dot**2 + sum(I_phiy * varphi_dot**2 / 2)",
    note="The paper's wheels are alike and its I_ϕy stands before the sum.",
)  # fmt: skip
def kinetic_energy(
    m_R: float, x_dot: Array, y_dot: Array, I_Rz: float, theta_dot: Array, I_phiy: Array, varphi_dot: Array
) -> Any:
    """Kinetic energy.

    Parameters
    ----------
    m_R: mass, wheels included [kg]
    x_dot: velocity in the world, of the centre of mass [m/s]
    y_dot: velocity in the world, of the centre of mass [m/s]
    I_Rz: moment of inertia about the vertical through it [kg*m^2]
    theta_dot: turning speed [rad/s]
    I_phiy: moment of inertia of each wheel about its axle [kg*m^2]
    varphi_dot: speeds of the wheels [rad/s]

    Returns
    -------
    T: kinetic energy [J]
    """
    return (
        m_R / 2 * (x_dot**2 + y_dot**2)
        + I_Rz / 2 * theta_dot**2
        + np.sum(I_phiy * varphi_dot**2 / 2, axis=0)
    )  # fmt: skip


@matrix_equation(42, "[T]_ξ", printed="M_R @ xi_ddot")
def platform_inertia_force(M_R: Array, xi_ddot: Array) -> Array:
    """Force that accelerates the platform, in the world.

    Parameters
    ----------
    M_R: mass matrix [N, N, N*m per m/s^2, m/s^2, rad/s^2]
    xi_ddot: acceleration in the world [m/s^2, m/s^2, rad/s^2]

    Returns
    -------
    T_xi: force and moment [N, N, N*m]
    """
    return M_R @ xi_ddot


@matrix_equation(
    43, "M_R", printed="diag([m_R, m_R, I_Rz])",
    note="The paper's centre of mass is the reference point. With one that lies off it, mass times distance couples "
    "turning and moving: a generalisation of ours that leaves the paper's case as printed.",
)  # fmt: skip
def mass_matrix(m_R: float, I_Rz: float, x_C: float = 0.0, y_C: float = 0.0) -> Array:
    """Mass matrix of the platform, in the robot's axes.

    Parameters
    ----------
    m_R: mass, wheels included [kg]
    I_Rz: moment of inertia about the vertical through the reference point [kg*m^2]
    x_C: centre of mass, before the reference point [m]
    y_C: centre of mass, to the left of it [m]

    Returns
    -------
    M_R: mass matrix [N, N, N*m per m/s^2, m/s^2, rad/s^2]
    """
    return np.array([[m_R, 0, -m_R * y_C], [0, m_R, m_R * x_C], [-m_R * y_C, m_R * x_C, I_Rz]])


@matrix_equation(44, "[T]_ϕ", printed="M_phi @ varphi_ddot")
def wheel_inertia_torque(M_phi: Array, varphi_ddot: Array) -> Array:
    """Torques that accelerate the wheels.

    Parameters
    ----------
    M_phi: inertias of the wheels, (45) [kg*m^2]
    varphi_ddot: accelerations of the wheels [rad/s^2]

    Returns
    -------
    T_phi: torques [N*m]
    """
    return M_phi @ varphi_ddot


@matrix_equation(45, "M_ϕ", printed="diag(I_phiy)")
def wheel_inertias(I_phiy: Array) -> Array:
    """Inertias of the wheels.

    Parameters
    ----------
    I_phiy: moment of inertia of each wheel about its axle [kg*m^2]

    Returns
    -------
    M_phi: diagonal [kg*m^2]
    """
    return np.diag(I_phiy)


@matrix_equation(46, "Eᵀ τ", printed="R @ M_R @ xi_ddot + E.T @ M_phi @ varphi_ddot")
def platform_force(R: Array, M_R: Array, xi_ddot: Array, E: Array, M_phi: Array, varphi_ddot: Array) -> Array:
    """Force that the wheels' torques make, from the world's accelerations.

    Parameters
    ----------
    R: rotation of (22) [1]
    M_R: mass matrix [N, N, N*m per m/s^2, m/s^2, rad/s^2]
    xi_ddot: acceleration in the world [m/s^2, m/s^2, rad/s^2]
    E: wheel speeds over velocity [rad/s per m/s, m/s, rad/s]
    M_phi: inertias of the wheels [kg*m^2]
    varphi_ddot: accelerations of the wheels [rad/s^2]

    Returns
    -------
    F: force and moment in the robot's axes [N, N, N*m]
    """
    return R @ M_R @ xi_ddot + E.T @ M_phi @ varphi_ddot


@matrix_equation(47, "ξ̈", printed="R.T @ eta_dot + R_T_dot @ eta")
def world_acceleration(R: Array, eta_dot: Array, R_T_dot: Array, eta: Array) -> Array:
    """Acceleration in the world, from the robot's frame.

    Parameters
    ----------
    R: rotation of (22) [1]
    eta_dot: rate of change of the velocity in the robot's frame [m/s^2, m/s^2, rad/s^2]
    R_T_dot: rate of change of the transposed rotation [1/s]
    eta: velocity in the robot's frame [m/s, m/s, rad/s]

    Returns
    -------
    xi_ddot: acceleration in the world [m/s^2, m/s^2, rad/s^2]
    """
    return R.T @ eta_dot + R_T_dot @ eta


@matrix_equation(48, "ϕ̈", printed="E @ eta_dot")
def wheel_acceleration(E: Array, eta_dot: Array) -> Array:
    """Accelerations of the wheels.

    Parameters
    ----------
    E: wheel speeds over velocity [rad/s per m/s, m/s, rad/s]
    eta_dot: rate of change of the velocity in the robot's frame [m/s^2, m/s^2, rad/s^2]

    Returns
    -------
    varphi_ddot: accelerations of the wheels [rad/s^2]
    """
    return E @ eta_dot


@matrix_equation(49, "Eᵀ τ", printed="M_bar @ eta_dot + C_bar @ eta")
def operational_force(M_bar: Array, eta_dot: Array, C_bar: Array, eta: Array) -> Array:
    """Dynamics in operational space.

    Parameters
    ----------
    M_bar: inertia of platform and wheels, (50) [N, N, N*m per m/s^2, m/s^2, rad/s^2]
    eta_dot: rate of change of the velocity in the robot's frame [m/s^2, m/s^2, rad/s^2]
    C_bar: Coriolis matrix, (51) [N, N, N*m per m/s, m/s, rad/s]
    eta: velocity in the robot's frame [m/s, m/s, rad/s]

    Returns
    -------
    F: force and moment that the wheels' torques make [N, N, N*m]
    """
    return M_bar @ eta_dot + C_bar @ eta


@matrix_equation(
    50, "M̄", printed="R @ M_R @ R.T + E.T @ M_phi @ E",
    note="The mass matrix is taken in the robot's axes; the paper's diagonal one is the same in all.",
)  # fmt: skip
def inertia_matrix(M_R: Array, E: Array, M_phi: Array) -> Array:
    """Inertia of platform and wheels.

    Parameters
    ----------
    M_R: mass matrix in the robot's axes [N, N, N*m per m/s^2, m/s^2, rad/s^2]
    E: wheel speeds over velocity [rad/s per m/s, m/s, rad/s]
    M_phi: inertias of the wheels [kg*m^2]

    Returns
    -------
    M_bar: symmetric, positive definite [N, N, N*m per m/s^2, m/s^2, rad/s^2]
    """
    return M_R + E.T @ M_phi @ E


@matrix_equation(
    51, "C̄", printed="R @ M_R @ R_T_dot",
    note="Multiplied out, and skew-symmetric also where the centre of mass lies off the reference point: it does no "
    "work.",
)  # fmt: skip
def coriolis_matrix(theta_dot: float, m_R: float, x_C: float = 0.0, y_C: float = 0.0) -> Array:
    """Coriolis matrix.

    Parameters
    ----------
    theta_dot: turning speed [rad/s]
    m_R: mass, wheels included [kg]
    x_C: centre of mass, before the reference point [m]
    y_C: centre of mass, to the left of it [m]

    Returns
    -------
    C_bar: Coriolis matrix [N, N, N*m per m/s, m/s, rad/s]
    """
    return theta_dot * np.array([[0, -m_R, -m_R * x_C], [m_R, 0, -m_R * y_C], [m_R * x_C, m_R * y_C, 0]])


@matrix_equation(
    52, "τ", printed="M_q @ q_ddot + C_q @ q_dot + g_q",
    note="The form that robot arms have. g(q) is 0 on level ground; on a slope the weight is taken in operational "
    "space.",
)  # fmt: skip
def joint_form(M_q: Array, q_ddot: Array, C_q: Array, q_dot: Array, g_q: Array) -> Array:
    """Dynamics in the compact form.

    Parameters
    ----------
    M_q: inertia at the wheels [kg*m^2]
    q_ddot: accelerations of the wheels [rad/s^2]
    C_q: Coriolis matrix at the wheels [kg*m^2/s]
    q_dot: speeds of the wheels [rad/s]
    g_q: torques against the weight [N*m]

    Returns
    -------
    tau: torques of the motors [N*m]
    """
    return M_q @ q_ddot + C_q @ q_dot + g_q


@matrix_equation(
    57, "τ_ϕ", printed="M_q @ q_ddot + C_q @ q_dot", note="M_q, C_q of (58), (59); the paper calls them M̄, C̄ too."
)
def wheel_space_torque(M_q: Array, q_ddot: Array, C_q: Array, q_dot: Array) -> Array:
    """Dynamics in the space of the wheels.

    Parameters
    ----------
    M_q: inertia at the wheels, (58) [kg*m^2]
    q_ddot: accelerations of the wheels [rad/s^2]
    C_q: Coriolis matrix at the wheels, (59) [kg*m^2/s]
    q_dot: speeds of the wheels [rad/s]

    Returns
    -------
    tau: torques of the motors [N*m]
    """
    return M_q @ q_ddot + C_q @ q_dot


_NO_INVERSE = (
    "The Moore-Penrose inverse takes its place, which gives the torques with the least sum of squares; any "
    "c (1, 1, −1, −1) may be added to those of the paper's robot, and moves nothing. Where the wheels allow only the "
    "motions S, it is D = (Sᵀ Eᵀ)⁺ Sᵀ. The matrix has rank 3 at most and is never inverted."
)


@matrix_equation(
    58, "M_q", printed_symbol="M̄", printed="inv(E.T) @ (R @ M_R @ R.T @ K_plus) + M_phi @ E @ K_plus", note=_NO_INVERSE
)
def wheel_space_inertia(D: Array, M_bar: Array, K_plus: Array) -> Array:
    """Inertia in the space of the wheels.

    Parameters
    ----------
    D: Moore-Penrose inverse of Eᵀ [N*m per N, N, N*m]
    M_bar: inertia of platform and wheels, (50) [N, N, N*m per m/s^2, m/s^2, rad/s^2]
    K_plus: velocity over wheel speeds [m/s, m/s, rad/s per rad/s]

    Returns
    -------
    M_q: inertia at the wheels [kg*m^2]
    """
    return D @ M_bar @ K_plus


@matrix_equation(59, "C_q", printed_symbol="C̄", printed="inv(E.T) @ (R @ M_R @ R_T_dot @ K_plus)", note=_NO_INVERSE)
def wheel_space_coriolis(D: Array, C_bar: Array, K_plus: Array) -> Array:
    """Coriolis matrix in the space of the wheels.

    Parameters
    ----------
    D: Moore-Penrose inverse of Eᵀ [N*m per N, N, N*m]
    C_bar: Coriolis matrix, (51) [N, N, N*m per m/s, m/s, rad/s]
    K_plus: velocity over wheel speeds [m/s, m/s, rad/s per rad/s]

    Returns
    -------
    C_q: Coriolis matrix at the wheels [kg*m^2/s]
    """
    return D @ C_bar @ K_plus
