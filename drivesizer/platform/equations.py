"""The platform's equations (21)-(59), each once, how they are declared, and their form as text.

As in ``equation`` the decorator reads names, meanings, bracketed units and the paper's own form from the docstring; the
computed form is the function's own return expression. A vector's unit lists its entries, ``[m/s, m/s, rad/s]``, or is
the one unit of all. A matrix takes one vector to another, so its unit is ``[rad/s per m/s, m/s, rad/s]``: the entry in
row i and column j has the i-th unit over the j-th.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.equation import Declared, Notation, of_docstring

Array = NDArray[np.float64]

_GREEK = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "eta": "η", "theta": "θ", "xi": "ξ", "phi": "φ",
    "varphi": "ϕ", "psi": "ψ", "tau": "τ",
}  # fmt: skip
_WHOLE = {"p_dot": "d/dt(∂T/∂ψ̇)", "T_psi": "∂T/∂ψ", "T_xi": "[T]_ξ", "T_phi": "[T]_ϕ", "R_T_dot": "Ṙᵀ"}
_ACCENTS = {"dot": "\u0307", "ddot": "\u0308", "bar": "\u0304", "plus": "⁺"}


@dataclass(frozen=True, slots=True, eq=False)
class MatrixEquation(Declared):
    """A declared equation of the platform; call it like the function that it holds."""

    number: int
    printed_symbol: str  # where the paper has another left side

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Compute, in SI."""
        return self.formula(*args, **kwargs)


PLATFORM: dict[int, MatrixEquation] = {}  # by the paper's number


def matrix_equation(
    number: int, symbol: str, *, printed_symbol: str = ""
) -> Callable[[Callable[..., Any]], MatrixEquation]:
    """Declare the function below as an equation of the platform.

    Parameters
    ----------
    number
        The paper's number.
    symbol
        What stands on the left, as text.
    printed_symbol
        The paper's own left side, where it is another.

    Returns
    -------
    callable
        The decorator, which makes a ``MatrixEquation`` of the function.
    """

    def declared(formula: Callable[..., Any]) -> MatrixEquation:
        PLATFORM[number] = MatrixEquation(number, symbol, formula, *of_docstring(formula), printed_symbol)
        return PLATFORM[number]

    return declared


def symbol(name: str) -> str:
    """A name as a symbol.

    >>> [symbol(n) for n in ("m_R", "theta", "K_plus", "tau_1")]
    ['m_R', 'θ', 'K⁺', 'τ_1']
    """
    if name in _WHOLE:
        return _WHOLE[name]
    head, *marks = name.split("_")
    accents = "".join(_ACCENTS[m] for m in marks if m in _ACCENTS)
    index = "".join(f"_{m.replace('phi', 'ϕ')}" for m in marks if m not in _ACCENTS)
    return _GREEK.get(head, head) + accents + index


def text(expression: str) -> str:
    """An expression on one line; rows of a matrix end with a semicolon.

    >>> text("-inv(J_2) @ J_1")
    '-J_2⁻¹ J_1'
    >>> text("theta_dot * array([[0, -m_R], [m_R, 0]])") == symbol("theta_dot") + " [0, -m_R; m_R, 0]"
    True
    """
    return Notation(symbol).of(expression)


# -- The platform's kinematics, equations (21)-(33) and (53)-(56), each once.
#
# C. Prados Sesmero, L. R. Buonocore, M. Di Castro, *Omnidirectional Robotic Platform for Surveillance of Particle
# Accelerator Environments with Limited Space Areas*, Appl. Sci. 2021, 11, 6631, doi:10.3390/app11146631.
#
# Symbols are local to this chapter: η is the velocity in the robot's frame, R takes the world's axes to the robot's,
# φ is an angle of a wheel's rollers and ϕ the angle that a wheel has turned. A figure may be an array over samples,
# or over wheels where it belongs to a wheel; the first axis of a result counts its entries. Units: see ``notation``.


@matrix_equation(21, "ξ")
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

    Printed
    -------
    array([x, y, theta])
    """
    return np.array([x, y, theta])


@matrix_equation(22, "η")
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

    Printed
    -------
    R @ xi_dot
    """
    return np.array(
        [np.cos(theta) * x_dot + np.sin(theta) * y_dot, -np.sin(theta) * x_dot + np.cos(theta) * y_dot, theta_dot]
    )


@matrix_equation(23, "Ȯ_Ri")
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

    Printed
    -------
    array([x_R_dot - L * sin(alpha) * theta_dot, y_R_dot - L * cos(alpha) * theta_dot])

    Notes
    -----
    Printed with a minus in the second entry. A platform that turns to the left moves its front to the left: + it must
    be, and + is what (26) has.
    """
    return np.array([x_R_dot - L * np.sin(alpha) * theta_dot, y_R_dot + L * np.cos(alpha) * theta_dot])


@matrix_equation(24, "Ȯ_ri")
def roller_frame_velocity(phi: Array, O_Ri_dot: Array) -> Array:
    """The same velocity in the axes of the roller on the floor.

    Parameters
    ----------
    phi: α + β + γ [rad]
    O_Ri_dot: velocity of the contact point, in the robot's axes [m/s]

    Returns
    -------
    O_ri_dot: along the roller's axis, and across it [m/s]

    Printed
    -------
    array([[sin(phi), -cos(phi)], [cos(phi), sin(phi)]]) @ O_Ri_dot
    """
    return np.array([[np.sin(phi), -np.cos(phi)], [np.cos(phi), np.sin(phi)]]) @ O_Ri_dot


@matrix_equation(25, "[r ϕ̇ cos γ; r_r ϕ̇_r − r ϕ̇ sin γ] / η", printed_symbol="[r ϕ̇ cos γ; r_r ϕ̇_r + r ϕ̇ sin γ] / η")
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

    Printed
    -------
    array([[sin(phi), -cos(phi), L * cos(delta)], [cos(phi), sin(phi), L * cos(delta)]])

    Notes
    -----
    Printed with L cos δ in both third entries; from (23) and (24) they are −L cos δ and L sin δ, and the first is what
    (26) has. On the left the paper has + r ϕ̇ sin γ; then the rollers would turn on a straight path, where they stand
    still: − it must be. Third row, 0 = 0, left out.
    """
    return np.array([[np.sin(phi), -np.cos(phi), -L * np.cos(delta)], [np.cos(phi), np.sin(phi), L * np.sin(delta)]])


@matrix_equation(26, "0")
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

    Printed
    -------
    array([-sin(phi), cos(phi), L * cos(delta)]) @ R @ xi_dot + r * varphi_i_dot * cos(gamma)
    """
    return np.array([-np.sin(phi), np.cos(phi), L * np.cos(delta)]) @ eta + r * varphi_i_dot * np.cos(gamma)


@matrix_equation(27, "0")
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

    Printed
    -------
    J_1 @ R @ xi_dot + J_2 @ varphi_dot
    """
    return J_1 @ eta + J_2 @ varphi_dot


@matrix_equation(28, "J_1")
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

    Printed
    -------
    array([-sin(phi_i), cos(phi_i), L_i * cos(delta_i)]).T

    Notes
    -----
    A row for each wheel, as many as there are.
    """
    return np.array([-np.sin(phi_i), np.cos(phi_i), L_i * np.cos(delta_i)]).T


@matrix_equation(29, "J_2")
def wheel_matrix(r_i: Array, gamma_i: Array) -> Array:
    """Matrix of the wheels' rolling along the rollers' axes.

    Parameters
    ----------
    r_i: radius of each wheel [m]
    gamma_i: angle of its rollers [rad]

    Returns
    -------
    J_2: diagonal [m/s per rad/s]

    Printed
    -------
    diag(r_i * cos(gamma_i))
    """
    return np.diag(r_i * np.cos(gamma_i))


@matrix_equation(30, "q̇")
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

    Printed
    -------
    concatenate([R.T @ eta, E @ eta])

    Notes
    -----
    q has the posture and the wheels' angles.
    """
    return np.concatenate([R.T @ eta, E @ eta])


@matrix_equation(31, "ξ̇")
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

    Printed
    -------
    R.T @ eta
    """
    return np.array(
        [
            np.cos(theta) * x_R_dot - np.sin(theta) * y_R_dot,
            np.sin(theta) * x_R_dot + np.cos(theta) * y_R_dot,
            theta_dot,
        ]
    )


@matrix_equation(32, "E")
def wheel_map(J_1: Array, J_2: Array) -> Array:
    """Wheel speeds over velocity.

    Parameters
    ----------
    J_1: rows of (26) [m/s per m/s, m/s, rad/s]
    J_2: how far the wheels roll [m/s per rad/s]

    Returns
    -------
    E: wheel speeds over velocity [rad/s per m/s, m/s, rad/s]

    Printed
    -------
    -inv(J_2) @ J_1

    Notes
    -----
    ϕ̇ = E η.
    """
    return -np.linalg.inv(J_2) @ J_1


@matrix_equation(33, "E")
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

    Printed
    -------
    array([[1, 1, l_1 + l_2], [1, -1, -(l_1 + l_2)], [1, 1, -(l_1 + l_2)], [1, -1, l_1 + l_2]]) / r

    Notes
    -----
    The lower part of S(q), for the four wheels of Table 1. The program works from (26) for any set of wheels; that they
    give this is a test.
    """
    return np.array([[1, 1, l_1 + l_2], [1, -1, -(l_1 + l_2)], [1, 1, -(l_1 + l_2)], [1, -1, l_1 + l_2]]) / r


@matrix_equation(53, "q̇")
def wheel_speeds(K: Array, eta: Array) -> Array:
    """Wheel speeds, from the platform's velocity.

    Parameters
    ----------
    K: wheel speeds over velocity [rad/s per m/s, m/s, rad/s]
    eta: velocity in the robot's frame [m/s, m/s, rad/s]

    Returns
    -------
    varphi_dot: speeds of the wheels [rad/s]

    Printed
    -------
    K @ eta

    Notes
    -----
    q has the wheels' angles alone here, and K is E of (32), (33).
    """
    return K @ eta


@matrix_equation(54, "η")
def velocity(K_plus: Array, varphi_dot: Array) -> Array:
    """The platform's velocity, from the wheel speeds.

    Parameters
    ----------
    K_plus: Moore-Penrose inverse of K [m/s, m/s, rad/s per rad/s]
    varphi_dot: speeds of the wheels [rad/s]

    Returns
    -------
    eta: velocity in the robot's frame [m/s, m/s, rad/s]

    Printed
    -------
    K_plus @ varphi_dot

    Notes
    -----
    K⁺ is the Moore-Penrose inverse: of more wheels than freedoms it takes the velocity that fits their speeds best by
    least squares.
    """
    return K_plus @ varphi_dot


@matrix_equation(55, "K⁺")
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

    Printed
    -------
    r / 4 * array([[1, 1, 1, 1], [1, -1, 1, -1], [1 / (l_1 + l_2), -1 / (l_1 + l_2), -1 / (l_1 + l_2), 1 / (l_1 +
    l_2)]])

    Notes
    -----
    For the four wheels of Table 1; a test, as (33) is.
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


@matrix_equation(56, "θ̇")
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

    Printed
    -------
    r / (4 * (l_1 + l_2)) * (varphi_1_dot - varphi_2_dot - varphi_3_dot + varphi_4_dot)
    """
    return r / (4 * (l_1 + l_2)) * (varphi_1_dot - varphi_2_dot - varphi_3_dot + varphi_4_dot)


# -- The platform's dynamics, equations (34)-(52) and (57)-(59), each once.
#
# Source and symbols: see ``equations``. In (34)-(51) forces are those on the platform, two forces and a moment in
# the robot's axes; in (52)-(59) they are torques of the wheels.


@matrix_equation(34, "Eᵀ τ")
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

    Printed
    -------
    R @ T_xi + E.T @ T_phi
    """
    return R @ T_xi + E.T @ T_phi


@matrix_equation(35, "[T]_ψ")
def lagrange_operator(p_dot: Array, T_psi: Array) -> Array:
    """Lagrange's operator.

    Parameters
    ----------
    p_dot: rate of change of the momentum [N, N, N*m]
    T_psi: slope of the kinetic energy over the posture [N, N, N*m]

    Returns
    -------
    T_xi: force and moment [N, N, N*m]

    Printed
    -------
    p_dot - T_psi

    Notes
    -----
    T is the kinetic energy, ψ the posture or a wheel's angle.
    """
    return p_dot - T_psi


@matrix_equation(36, "τ_ϕ")
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

    Printed
    -------
    array([tau_1, tau_2, tau_3, tau_4])

    Notes
    -----
    As many as there are motors.
    """
    return np.array([tau_1, tau_2, tau_3, tau_4])


@matrix_equation(37, "T")
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

    Printed
    -------
    xi_dot.T @ R @ M @ R @ xi_dot + varphi_dot.T @ I_phi @ varphi_dot

    Notes
    -----
    Printed with R twice; with it a platform that moves sideways would have other energy than one that moves ahead. The
    velocity in the robot's frame is R ξ̇, so the first R is transposed.
    """
    return xi_dot.T @ R.T @ M @ R @ xi_dot + varphi_dot.T @ I_phi @ varphi_dot


@matrix_equation(38, "M")
def half_mass_matrix(m_R: float, I_Rz: float) -> Array:
    """Half the mass matrix of the platform.

    Parameters
    ----------
    m_R: mass, wheels included [kg]
    I_Rz: moment of inertia about the vertical [kg*m^2]

    Returns
    -------
    M: diagonal [N, N, N*m per m/s^2, m/s^2, rad/s^2]

    Printed
    -------
    1 / 2 * diag([m_R, m_R, I_Rz])
    """
    return 1 / 2 * np.diag([m_R, m_R, I_Rz])


@matrix_equation(39, "I_ϕ")
def half_wheel_inertias(I_phiy: Array) -> Array:
    """Half the wheels' inertias.

    Parameters
    ----------
    I_phiy: moment of inertia of each wheel about its axle [kg*m^2]

    Returns
    -------
    I_phi: diagonal [kg*m^2]

    Printed
    -------
    1 / 2 * diag(I_phiy)
    """
    return 1 / 2 * np.diag(I_phiy)


@matrix_equation(40, "ϕ̇")
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

    Printed
    -------
    array([varphi_1_dot, varphi_2_dot, varphi_3_dot, varphi_4_dot])
    """
    return np.array([varphi_1_dot, varphi_2_dot, varphi_3_dot, varphi_4_dot])


@matrix_equation(41, "T")
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

    Printed
    -------
    m_R / 2 * (x_dot**2 + y_dot**2) + I_Rz / 2 * theta_dot**2 + sum(I_phiy * varphi_dot**2 / 2)

    Notes
    -----
    The paper's wheels are alike and its I_ϕy stands before the sum.
    """
    return (
        m_R / 2 * (x_dot**2 + y_dot**2)
        + I_Rz / 2 * theta_dot**2
        + np.sum(I_phiy * varphi_dot**2 / 2, axis=0)
    )  # fmt: skip


@matrix_equation(42, "[T]_ξ")
def platform_inertia_force(M_R: Array, xi_ddot: Array) -> Array:
    """Force that accelerates the platform, in the world.

    Parameters
    ----------
    M_R: mass matrix [N, N, N*m per m/s^2, m/s^2, rad/s^2]
    xi_ddot: acceleration in the world [m/s^2, m/s^2, rad/s^2]

    Returns
    -------
    T_xi: force and moment [N, N, N*m]

    Printed
    -------
    M_R @ xi_ddot
    """
    return M_R @ xi_ddot


@matrix_equation(43, "M_R")
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

    Printed
    -------
    diag([m_R, m_R, I_Rz])

    Notes
    -----
    The paper's centre of mass is the reference point. With one that lies off it, mass times distance couples turning
    and moving: a generalisation of ours that leaves the paper's case as printed.
    """
    return np.array([[m_R, 0, -m_R * y_C], [0, m_R, m_R * x_C], [-m_R * y_C, m_R * x_C, I_Rz]])


@matrix_equation(44, "[T]_ϕ")
def wheel_inertia_torque(M_phi: Array, varphi_ddot: Array) -> Array:
    """Torques that accelerate the wheels.

    Parameters
    ----------
    M_phi: inertias of the wheels, (45) [kg*m^2]
    varphi_ddot: accelerations of the wheels [rad/s^2]

    Returns
    -------
    T_phi: torques [N*m]

    Printed
    -------
    M_phi @ varphi_ddot
    """
    return M_phi @ varphi_ddot


@matrix_equation(45, "M_ϕ")
def wheel_inertias(I_phiy: Array) -> Array:
    """Inertias of the wheels.

    Parameters
    ----------
    I_phiy: moment of inertia of each wheel about its axle [kg*m^2]

    Returns
    -------
    M_phi: diagonal [kg*m^2]

    Printed
    -------
    diag(I_phiy)
    """
    return np.diag(I_phiy)


@matrix_equation(46, "Eᵀ τ")
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

    Printed
    -------
    R @ M_R @ xi_ddot + E.T @ M_phi @ varphi_ddot
    """
    return R @ M_R @ xi_ddot + E.T @ M_phi @ varphi_ddot


@matrix_equation(47, "ξ̈")
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

    Printed
    -------
    R.T @ eta_dot + R_T_dot @ eta
    """
    return R.T @ eta_dot + R_T_dot @ eta


@matrix_equation(48, "ϕ̈")
def wheel_acceleration(E: Array, eta_dot: Array) -> Array:
    """Accelerations of the wheels.

    Parameters
    ----------
    E: wheel speeds over velocity [rad/s per m/s, m/s, rad/s]
    eta_dot: rate of change of the velocity in the robot's frame [m/s^2, m/s^2, rad/s^2]

    Returns
    -------
    varphi_ddot: accelerations of the wheels [rad/s^2]

    Printed
    -------
    E @ eta_dot
    """
    return E @ eta_dot


@matrix_equation(49, "Eᵀ τ")
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

    Printed
    -------
    M_bar @ eta_dot + C_bar @ eta
    """
    return M_bar @ eta_dot + C_bar @ eta


@matrix_equation(50, "M̄")
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

    Printed
    -------
    R @ M_R @ R.T + E.T @ M_phi @ E

    Notes
    -----
    The mass matrix is taken in the robot's axes; the paper's diagonal one is the same in all.
    """
    return M_R + E.T @ M_phi @ E


@matrix_equation(51, "C̄")
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

    Printed
    -------
    R @ M_R @ R_T_dot

    Notes
    -----
    Multiplied out, and skew-symmetric also where the centre of mass lies off the reference point: it does no work.
    """
    return theta_dot * np.array([[0, -m_R, -m_R * x_C], [m_R, 0, -m_R * y_C], [m_R * x_C, m_R * y_C, 0]])


@matrix_equation(52, "τ")
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

    Printed
    -------
    M_q @ q_ddot + C_q @ q_dot + g_q

    Notes
    -----
    The form that robot arms have. g(q) is 0 on level ground; on a slope the weight is taken in operational space.
    """
    return M_q @ q_ddot + C_q @ q_dot + g_q


@matrix_equation(57, "τ_ϕ")
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

    Printed
    -------
    M_q @ q_ddot + C_q @ q_dot

    Notes
    -----
    M_q, C_q of (58), (59); the paper calls them M̄, C̄ too.
    """
    return M_q @ q_ddot + C_q @ q_dot


@matrix_equation(58, "M_q", printed_symbol="M̄")
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

    Printed
    -------
    inv(E.T) @ (R @ M_R @ R.T @ K_plus) + M_phi @ E @ K_plus

    Notes
    -----
    The Moore-Penrose inverse takes its place, which gives the torques with the least sum of squares; any c (1, 1, −1,
    −1) may be added to those of the paper's robot, and moves nothing. Where the wheels allow only the motions S, it is
    D = (Sᵀ Eᵀ)⁺ Sᵀ. The matrix has rank 3 at most and is never inverted.
    """
    return D @ M_bar @ K_plus


@matrix_equation(59, "C_q", printed_symbol="C̄")
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

    Printed
    -------
    inv(E.T) @ (R @ M_R @ R_T_dot @ K_plus)

    Notes
    -----
    The Moore-Penrose inverse takes its place, which gives the torques with the least sum of squares; any c (1, 1, −1,
    −1) may be added to those of the paper's robot, and moves nothing. Where the wheels allow only the motions S, it is
    D = (Sᵀ Eᵀ)⁺ Sᵀ. The matrix has rank 3 at most and is never inverted.
    """
    return D @ C_bar @ K_plus
