"""The platform's kinematics, equations (21)-(33) and (53)-(56), each once.

C. Prados Sesmero, L. R. Buonocore, M. Di Castro, *Omnidirectional Robotic Platform for Surveillance of Particle
Accelerator Environments with Limited Space Areas*, Appl. Sci. 2021, 11, 6631, doi:10.3390/app11146631.

Symbols are local to this chapter: η is the velocity in the robot's frame, R takes the world's axes to the robot's, φ is
an angle of a wheel's rollers and ϕ the angle that a wheel has turned. A figure may be an array over samples, or over
wheels where it belongs to a wheel; the first axis of a result counts its entries. Units: see ``notation``.
"""

from __future__ import annotations

import numpy as np

from drivesizer.platform.matrix_equation import Array, matrix_equation

__all__ = [
    "configuration_velocity", "contact_velocity", "paper_velocity_map", "paper_wheel_map", "platform_constraint",
    "posture", "robot_velocity", "roller_frame_rows", "roller_frame_velocity", "rolling_constraint", "rolling_rows",
    "turning_speed", "velocity", "wheel_map", "wheel_matrix", "wheel_speeds", "world_velocity",
]  # fmt: skip


@matrix_equation(21, "ξ", printed="array([x, y, theta])")
def posture(x: Array, y: Array, theta: Array) -> Array:
    """Posture of the platform in the world.

    Parameters
    ----------
    x: place of the reference point [m]
    y: place of the reference point [m]
    theta: heading of the platform [rad]

    Returns
    -------
    xi: posture [m, m, rad]
    """
    return np.array([x, y, theta])


@matrix_equation(22, "η", printed="R @ xi_dot")
def robot_velocity(theta: Array, x_dot: Array, y_dot: Array, theta_dot: Array) -> Array:
    """Velocity in the robot's frame, from the world's.

    Parameters
    ----------
    theta: heading of the platform [rad]
    x_dot: velocity in the world [m/s]
    y_dot: velocity in the world [m/s]
    theta_dot: turning speed [rad/s]

    Returns
    -------
    eta: velocity in the robot's frame [m/s, m/s, rad/s]
    """
    return np.array(
        [np.cos(theta) * x_dot + np.sin(theta) * y_dot, -np.sin(theta) * x_dot + np.cos(theta) * y_dot, theta_dot]
    )


@matrix_equation(
    23, "Ȯ_Ri",
    printed="array([x_R_dot - L * sin(alpha) * theta_dot, y_R_dot - L * cos(alpha) * theta_dot])",
    note="Printed with a minus in the second entry. A platform that turns to the left moves its front to the left: + "
    "it must be, and + is what (26) has.",
)  # fmt: skip
def contact_velocity(x_R_dot: Array, y_R_dot: Array, theta_dot: Array, L: Array, alpha: Array) -> Array:
    """Velocity of a wheel's contact point, in the robot's axes.

    Parameters
    ----------
    x_R_dot: velocity of the reference point, forwards [m/s]
    y_R_dot: velocity of the reference point, to the left [m/s]
    theta_dot: turning speed [rad/s]
    L: distance of the contact point [m]
    alpha: direction of the contact point [rad]

    Returns
    -------
    O_Ri_dot: velocity of the contact point [m/s]
    """
    return np.array([x_R_dot - L * np.sin(alpha) * theta_dot, y_R_dot + L * np.cos(alpha) * theta_dot])


@matrix_equation(24, "Ȯ_ri", printed="array([[sin(phi), -cos(phi)], [cos(phi), sin(phi)]]) @ O_Ri_dot")
def roller_frame_velocity(phi: Array, O_Ri_dot: Array) -> Array:
    """The same velocity in the axes of the roller on the floor.

    Parameters
    ----------
    phi: α + β + γ [rad]
    O_Ri_dot: velocity of the contact point, in the robot's axes [m/s]

    Returns
    -------
    O_ri_dot: along the roller's axis, and across it [m/s]
    """
    return np.array([[np.sin(phi), -np.cos(phi)], [np.cos(phi), np.sin(phi)]]) @ O_Ri_dot


@matrix_equation(
    25, "[r ϕ̇ cos γ; r_r ϕ̇_r − r ϕ̇ sin γ] / η", printed_symbol="[r ϕ̇ cos γ; r_r ϕ̇_r + r ϕ̇ sin γ] / η",
    printed="array([[sin(phi), -cos(phi), L * cos(delta)], [cos(phi), sin(phi), L * cos(delta)]])",
    note="Printed with L cos δ in both third entries; from (23) and (24) they are −L cos δ and L sin δ, and the first "
    "is what (26) has. On the left the paper has + r ϕ̇ sin γ; then the rollers would turn on a straight path, where "
    "they stand still: − it must be. Third row, 0 = 0, left out.",
)  # fmt: skip
def roller_frame_rows(phi: Array, delta: Array, L: Array) -> Array:
    """Wheel and roller speed from the platform's velocity.

    Parameters
    ----------
    phi: α + β + γ [rad]
    delta: β + γ [rad]
    L: distance of the contact point [m]

    Returns
    -------
    rows: what the velocity is multiplied with [m/s per m/s, m/s, rad/s]
    """
    return np.array([[np.sin(phi), -np.cos(phi), -L * np.cos(delta)], [np.cos(phi), np.sin(phi), L * np.sin(delta)]])


@matrix_equation(
    26, "0",
    printed="array([-sin(phi), cos(phi), L * cos(delta)]) @ R @ xi_dot + r * varphi_i_dot * cos(gamma)",
)  # fmt: skip
def rolling_constraint(
    phi: Array, delta: Array, L: Array, eta: Array, r: Array, varphi_i_dot: Array, gamma: Array
) -> Array:
    """Rolling of one wheel.

    Parameters
    ----------
    phi: α + β + γ [rad]
    delta: β + γ [rad]
    L: distance of the contact point [m]
    eta: velocity in the robot's frame [m/s, m/s, rad/s]
    r: radius of the wheel [m]
    varphi_i_dot: speed of the wheel [rad/s]
    gamma: angle of the rollers [rad]

    Returns
    -------
    slip: along the roller's axis, 0 where the wheel rolls [m/s]
    """
    return np.array([-np.sin(phi), np.cos(phi), L * np.cos(delta)]) @ eta + r * varphi_i_dot * np.cos(gamma)


@matrix_equation(27, "0", printed="J_1 @ R @ xi_dot + J_2 @ varphi_dot")
def platform_constraint(J_1: Array, eta: Array, J_2: Array, varphi_dot: Array) -> Array:
    """Rolling of all wheels.

    Parameters
    ----------
    J_1: rows of (26) [m/s per m/s, m/s, rad/s]
    eta: velocity in the robot's frame [m/s, m/s, rad/s]
    J_2: how far the wheels roll [m/s per rad/s]
    varphi_dot: speeds of the wheels [rad/s]

    Returns
    -------
    slip: of each wheel along its roller's axis, 0 where it rolls [m/s]
    """
    return J_1 @ eta + J_2 @ varphi_dot


@matrix_equation(
    28, "J_1", printed="array([-sin(phi_i), cos(phi_i), L_i * cos(delta_i)]).T",
    note="A row for each wheel, as many as there are.",
)  # fmt: skip
def rolling_rows(phi_i: Array, delta_i: Array, L_i: Array) -> Array:
    """Rows of the rolling constraints.

    Parameters
    ----------
    phi_i: α + β + γ of each wheel [rad]
    delta_i: β + γ of each wheel [rad]
    L_i: distance of each contact point [m]

    Returns
    -------
    J_1: a row for each wheel [m/s per m/s, m/s, rad/s]
    """
    return np.array([-np.sin(phi_i), np.cos(phi_i), L_i * np.cos(delta_i)]).T


@matrix_equation(29, "J_2", printed="diag(r_i * cos(gamma_i))")
def wheel_matrix(r_i: Array, gamma_i: Array) -> Array:
    """Matrix of the wheels' rolling along the rollers' axes.

    Parameters
    ----------
    r_i: radius of each wheel [m]
    gamma_i: angle of its rollers [rad]

    Returns
    -------
    J_2: diagonal [m/s per rad/s]
    """
    return np.diag(r_i * np.cos(gamma_i))


@matrix_equation(30, "q̇", printed="concatenate([R.T @ eta, E @ eta])", note="q has the posture and the wheels' angles.")
def configuration_velocity(R: Array, eta: Array, E: Array) -> Array:
    """Velocity of posture and wheels.

    Parameters
    ----------
    R: rotation of (22) [1]
    eta: velocity in the robot's frame [m/s, m/s, rad/s]
    E: wheel speeds over velocity [rad/s per m/s, m/s, rad/s]

    Returns
    -------
    rates: posture in the world, then wheels [m/s, m/s, rad/s, rad/s, rad/s, rad/s, rad/s]
    """
    return np.concatenate([R.T @ eta, E @ eta])


@matrix_equation(31, "ξ̇", printed="R.T @ eta")
def world_velocity(theta: Array, x_R_dot: Array, y_R_dot: Array, theta_dot: Array) -> Array:
    """Velocity in the world, from the robot's frame.

    Parameters
    ----------
    theta: heading of the platform [rad]
    x_R_dot: velocity forwards [m/s]
    y_R_dot: velocity to the left [m/s]
    theta_dot: turning speed [rad/s]

    Returns
    -------
    xi_dot: velocity in the world [m/s, m/s, rad/s]
    """
    return np.array(
        [
            np.cos(theta) * x_R_dot - np.sin(theta) * y_R_dot,
            np.sin(theta) * x_R_dot + np.cos(theta) * y_R_dot,
            theta_dot,
        ]
    )


@matrix_equation(32, "E", printed="-inv(J_2) @ J_1", note="ϕ̇ = E η.")
def wheel_map(J_1: Array, J_2: Array) -> Array:
    """Wheel speeds over velocity.

    Parameters
    ----------
    J_1: rows of (26) [m/s per m/s, m/s, rad/s]
    J_2: how far the wheels roll [m/s per rad/s]

    Returns
    -------
    E: wheel speeds over velocity [rad/s per m/s, m/s, rad/s]
    """
    return -np.linalg.inv(J_2) @ J_1


@matrix_equation(
    33, "E",
    printed="array([[1, 1, l_1 + l_2], [1, -1, -(l_1 + l_2)], [1, 1, -(l_1 + l_2)], [1, -1, l_1 + l_2]]) / r",
    note="The lower part of S(q), for the four wheels of Table 1. The program works from (26) for any set of wheels; "
    "that they give this is a test.",
)  # fmt: skip
def paper_wheel_map(l_1: float, l_2: float, r: float) -> Array:
    """Wheel speeds over velocity, the paper's robot.

    Parameters
    ----------
    l_1: L cos α, from the middle to an axle [m]
    l_2: L sin α, from the middle to a wheel [m]
    r: radius of the wheels [m]

    Returns
    -------
    E: wheel speeds over velocity [rad/s per m/s, m/s, rad/s]
    """
    return np.array([[1, 1, l_1 + l_2], [1, -1, -(l_1 + l_2)], [1, 1, -(l_1 + l_2)], [1, -1, l_1 + l_2]]) / r


@matrix_equation(53, "q̇", printed="K @ eta", note="q has the wheels' angles alone here, and K is E of (32), (33).")
def wheel_speeds(K: Array, eta: Array) -> Array:
    """Wheel speeds, from the platform's velocity.

    Parameters
    ----------
    K: wheel speeds over velocity [rad/s per m/s, m/s, rad/s]
    eta: velocity in the robot's frame [m/s, m/s, rad/s]

    Returns
    -------
    varphi_dot: speeds of the wheels [rad/s]
    """
    return K @ eta


@matrix_equation(
    54, "η", printed="K_plus @ varphi_dot",
    note="K⁺ is the Moore-Penrose inverse: of more wheels than freedoms it takes the velocity that fits their speeds "
    "best by least squares.",
)  # fmt: skip
def velocity(K_plus: Array, varphi_dot: Array) -> Array:
    """The platform's velocity, from the wheel speeds.

    Parameters
    ----------
    K_plus: Moore-Penrose inverse of K [m/s, m/s, rad/s per rad/s]
    varphi_dot: speeds of the wheels [rad/s]

    Returns
    -------
    eta: velocity in the robot's frame [m/s, m/s, rad/s]
    """
    return K_plus @ varphi_dot


@matrix_equation(
    55, "K⁺",
    printed="r / 4 * array([[1, 1, 1, 1], [1, -1, 1, -1], "
    "[1 / (l_1 + l_2), -1 / (l_1 + l_2), -1 / (l_1 + l_2), 1 / (l_1 + l_2)]])",
    note="For the four wheels of Table 1; a test, as (33) is.",
)  # fmt: skip
def paper_velocity_map(r: float, l_1: float, l_2: float) -> Array:
    """Velocity over wheel speeds, the paper's robot.

    Parameters
    ----------
    r: radius of the wheels [m]
    l_1: L cos α, from the middle to an axle [m]
    l_2: L sin α, from the middle to a wheel [m]

    Returns
    -------
    K_plus: velocity over wheel speeds [m/s, m/s, rad/s per rad/s]
    """
    return (
        r
        / 4
        * np.array(
            [
                [1, 1, 1, 1],
                [1, -1, 1, -1],
                [1 / (l_1 + l_2), -1 / (l_1 + l_2), -1 / (l_1 + l_2), 1 / (l_1 + l_2)],
            ]
        )
    )


@matrix_equation(
    56, "θ̇",
    printed="r / (4 * (l_1 + l_2)) * (varphi_1_dot - varphi_2_dot - varphi_3_dot + varphi_4_dot)",
)  # fmt: skip
def turning_speed(
    r: float, l_1: float, l_2: float, varphi_1_dot: Array, varphi_2_dot: Array, varphi_3_dot: Array, varphi_4_dot: Array
) -> Array:
    """Turning speed from the wheel speeds, the paper's robot.

    Parameters
    ----------
    r: radius of the wheels [m]
    l_1: L cos α, from the middle to an axle [m]
    l_2: L sin α, from the middle to a wheel [m]
    varphi_1_dot: speed of the wheel at the front on the right [rad/s]
    varphi_2_dot: at the front on the left [rad/s]
    varphi_3_dot: at the rear on the left [rad/s]
    varphi_4_dot: at the rear on the right [rad/s]

    Returns
    -------
    theta_dot: turning speed [rad/s]
    """
    return r / (4 * (l_1 + l_2)) * (varphi_1_dot - varphi_2_dot - varphi_3_dot + varphi_4_dot)
