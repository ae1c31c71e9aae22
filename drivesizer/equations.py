"""The paper's equations (1)-(20), each once.

C. Prados Sesmero, L. R. Buonocore, M. Di Castro, *Omnidirectional Robotic Platform for Surveillance of Particle
Accelerator Environments with Limited Space Areas*, Appl. Sci. 2021, 11, 6631, doi:10.3390/app11146631.

Every function takes SI floats or arrays and gives SI back; called with pint quantities it checks dimensions.
Three factors that the paper all calls η have three names here: ``eta_speed`` in (1), ``eta_robot`` in (10) and
``eta_gear`` in (17), (18). What the paper uses without a number follows its place, declared with number None.
Rotary speeds are rad/s: the factors 60/π and π/30 of the printed forms only convert to and from rpm.
"""

from __future__ import annotations

import numpy as np

from drivesizer.physics.equation import Value, equation


@equation(1, "n_nom", "rotary_speed", "rpm")
def nominal_speed(V_nom: Value, d: Value, eta_speed: Value) -> Value:
    """Wheel speed at nominal velocity.

    Parameters
    ----------
    V_nom: nominal velocity of the vehicle [m/s]
    d: wheel diameter [m]
    eta_speed: speed reserve, the friction factor η of (1), 0 to 1 [1]

    Returns
    -------
    n_nom: wheel speed with its reserve [rad/s]

    Printed
    -------
    60 * V_nom / (pi * d * eta_speed)

    Notes
    -----
    Numerical-value equation: 60/π converts to rpm. Computed in rad/s, shown in rpm.
    """
    return 2 * V_nom / (d * eta_speed)


@equation(2, "M_nom", "torque", "N*m")
def nominal_torque(d: Value, F_nom: Value, delta: Value) -> Value:
    """Nominal torque, whole vehicle.

    Parameters
    ----------
    d: wheel diameter [m]
    F_nom: nominal force [N]
    delta: bearing factor, 0 to 1 [1]

    Returns
    -------
    M_nom: torque at the wheels that keeps the nominal velocity [N*m]

    Printed
    -------
    d / 2 * F_nom / delta
    """
    return d / 2 * F_nom / delta


@equation(3, "F_nom", "force", "N")
def nominal_force(C_rr: Value, m_R: Value, g: Value, theta: Value = 0.0) -> Value:
    """Nominal force.

    Parameters
    ----------
    C_rr: rolling-resistance coefficient [1]
    m_R: mass of the vehicle [kg]
    g: gravity [m/s^2]
    theta: slope, uphill positive [rad]

    Returns
    -------
    F_nom: force that keeps the nominal velocity [N]

    Printed
    -------
    C_rr * m_R * g

    Notes
    -----
    The paper's case is level ground. On a slope F_N = m_R g cos θ, and m_R g sin θ is added: a generalisation of ours
    that leaves the level case as printed.
    """
    return C_rr * m_R * g * np.cos(theta) + m_R * g * np.sin(theta)


@equation(4, "C_rr", "dimensionless", "1")
def rolling_resistance_coefficient(z: Value, d: Value) -> Value:
    """Rolling-resistance coefficient.

    Parameters
    ----------
    z: sinking depth [m]
    d: wheel diameter [m]

    Returns
    -------
    C_rr: rolling-resistance coefficient [1]

    Printed
    -------
    sqrt(z / d)

    Notes
    -----
    The radical is lost in some copies of the text; this is the standard form for a rigid wheel on an elastic surface. A
    spec gives C_rr or z, never both.
    """
    return np.sqrt(z / d)


@equation(5, "M_nom/m", "torque", "N*m")
def nominal_torque_per_motor(M_nom: Value, N: Value) -> Value:
    """Nominal torque per drive.

    Parameters
    ----------
    M_nom: nominal torque, whole vehicle [N*m]
    N: driven wheels [1]

    Returns
    -------
    M_nom_m: nominal torque at one wheel [N*m]

    Printed
    -------
    M_nom / N
    """
    return M_nom / N


@equation(6, "a", "acceleration", "m/s^2")
def acceleration(V_nom: Value, t_acc: Value) -> Value:
    """Acceleration.

    Parameters
    ----------
    V_nom: nominal velocity of the vehicle [m/s]
    t_acc: time to reach it; the deceleration takes as long [s]

    Returns
    -------
    a: acceleration [m/s^2]

    Printed
    -------
    V_nom / t_acc
    """
    return V_nom / t_acc


@equation(7, "P_nom/m", "power", "W")
def nominal_power_per_motor(
    PF: Value, m_R: Value, V_nom: Value, a: Value, g: Value, theta: Value, kappa: Value, N: Value
) -> Value:
    """Nominal power per drive.

    Parameters
    ----------
    PF: power factor (oversize) [1]
    m_R: mass of the vehicle [kg]
    V_nom: nominal velocity of the vehicle [m/s]
    a: acceleration [m/s^2]
    g: gravity [m/s^2]
    theta: slope [rad]
    kappa: confidence factor, 0 to 1 [1]
    N: driven wheels [1]

    Returns
    -------
    P_nom_m: nominal power of one drive [W]

    Printed
    -------
    PF * m_R * V_nom * (a + g * sin(theta)) / (2 * pi * kappa * N)

    Notes
    -----
    The units agree, the physics does not: 2π has no place in force times velocity, and rolling resistance is missing.
    Computed as printed; the mechanical power at the end of the acceleration is shown beside it. On a steep slope
    downhill it is below 0: no power that a motor could be chosen by.
    """
    return PF * m_R * V_nom * (a + g * np.sin(theta)) / (2 * np.pi * kappa * N)


@equation(None, "P_mech/m", "power", "W")
def mechanical_power_per_motor(
    PF: Value, F_nom: Value, m_R: Value, a: Value, V_nom: Value, kappa: Value, N: Value
) -> Value:
    """Mechanical power per drive at the end of the acceleration.

    Parameters
    ----------
    PF: power factor (oversize) [1]
    F_nom: nominal force, the slope's share included [N]
    m_R: mass of the vehicle [kg]
    a: acceleration [m/s^2]
    V_nom: nominal velocity of the vehicle [m/s]
    kappa: confidence factor, 0 to 1 [1]
    N: driven wheels [1]

    Returns
    -------
    P_mech_m: force times velocity at one wheel, with the factors of (7) [W]

    Notes
    -----
    Not in the paper; shown beside (7).
    """
    return PF * (F_nom + m_R * a) * V_nom / (kappa * N)


@equation(8, "m_i", "mass", "kg")
def cylinder_mass(rho: Value, r_a: Value, r_i: Value, h: Value) -> Value:
    """Mass of a hollow cylinder.

    Parameters
    ----------
    rho: density [kg/m^3]
    r_a: outer radius [m]
    r_i: inner radius, 0 when solid [m]
    h: width [m]

    Returns
    -------
    m_i: mass of the wheel or shaft [kg]

    Printed
    -------
    rho * pi * (r_a**2 - r_i**2) * h
    """
    return rho * np.pi * (r_a**2 - r_i**2) * h


@equation(9, "J", "inertia", "kg*m^2")
def cylinder_inertia(m_i: Value, r_a: Value, r_i: Value) -> Value:
    """Moment of inertia of a hollow cylinder.

    Parameters
    ----------
    m_i: mass [kg]
    r_a: outer radius [m]
    r_i: inner radius, 0 when solid [m]

    Returns
    -------
    J: moment of inertia about the axis [kg*m^2]

    Printed
    -------
    1 / 2 * m_i * (r_a**2 + r_i**2)
    """
    return m_i * (r_a**2 + r_i**2) / 2


@equation(10, "M_acc", "torque", "N*m")
def acceleration_torque(
    N: Value, J_w: Value, J_m: Value, J_s: Value, m_R: Value, eta_robot: Value, d: Value, a: Value, PF: Value
) -> Value:
    """Acceleration torque, whole vehicle.

    Parameters
    ----------
    N: driven wheels [1]
    J_w: inertia of a wheel [kg*m^2]
    J_m: inertia of a rotor, at the motor shaft [kg*m^2]
    J_s: inertia of a wheel's shaft [kg*m^2]
    m_R: mass of the vehicle [kg]
    eta_robot: robot efficiency, the η of (10), 0 to 1 [1]
    d: wheel diameter [m]
    a: acceleration [m/s^2]
    PF: power factor (oversize) [1]

    Returns
    -------
    M_acc: torque at the wheels that accelerates the vehicle [N*m]

    Printed
    -------
    (N * (J_w + J_m + J_s) + m_R / eta_robot * d**2 / 4) * a * PF

    Notes
    -----
    Printed with a, kg·m² · m/s² is no torque; the angular acceleration α = 2a/d in its place makes it one. Also, J_m is
    the rotor's inertia at the motor shaft: seen from the wheel it counts K² times. The paper omits K², and so does this
    method; the term is shown beside it.
    """
    return (N * (J_w + J_m + J_s) + m_R / eta_robot * d**2 / 4) * (2 * a / d) * PF


@equation(None, "J_m K²", "inertia", "kg*m^2")
def rotor_inertia_at_wheel(J_m: Value, K: Value) -> Value:
    """Rotor inertia seen from the wheel.

    Parameters
    ----------
    J_m: inertia of a rotor, at the motor shaft [kg*m^2]
    K: total ratio, motor to wheel [1]

    Returns
    -------
    J_mK2: inertia of the rotor at the wheel, from equal kinetic energy [kg*m^2]

    Notes
    -----
    Not in the paper; what (10) leaves out.
    """
    return J_m * K**2


@equation(None, "M_max", "torque", "N*m")
def maximum_torque(M_nom: Value, M_acc: Value) -> Value:
    """Maximum torque, whole vehicle.

    Parameters
    ----------
    M_nom: nominal torque, whole vehicle [N*m]
    M_acc: acceleration torque, whole vehicle [N*m]

    Returns
    -------
    M_max: torque at the wheels at the end of the acceleration [N*m]

    Printed
    -------
    M_nom + M_acc

    Notes
    -----
    The numerator of (11).
    """
    return M_nom + M_acc


@equation(11, "M_max/m", "torque", "N*m")
def maximum_torque_per_motor(M_max: Value, N: Value) -> Value:
    """Maximum torque per drive.

    Parameters
    ----------
    M_max: maximum torque, whole vehicle: M_nom + M_acc [N*m]
    N: driven wheels [1]

    Returns
    -------
    M_max_m: maximum torque at one wheel [N*m]

    Printed
    -------
    (M_nom + M_acc) / N

    Notes
    -----
    The largest torque on level ground and uphill. Downhill, where M_nom is below 0, it is not: M_dec of (12) is larger
    by magnitude and is what gearhead, motor and controller are compared with.
    """
    return M_max / N


@equation(12, "M_dec", "torque", "N*m")
def deceleration_torque(M_nom: Value, M_acc: Value) -> Value:
    """Deceleration torque, whole vehicle.

    Parameters
    ----------
    M_nom: nominal torque, whole vehicle [N*m]
    M_acc: acceleration torque, whole vehicle [N*m]

    Returns
    -------
    M_dec: torque at the wheels while the vehicle slows down [N*m]

    Printed
    -------
    M_nom - M_acc

    Notes
    -----
    Usually negative: the drive brakes.
    """
    return M_nom - M_acc


@equation(None, "M_brake/m", "torque", "N*m")
def braking_torque_per_motor(M_dec: Value, N: Value) -> Value:
    """Largest torque per drive downhill, while it brakes.

    Parameters
    ----------
    M_dec: deceleration torque, whole vehicle [N*m]
    N: driven wheels [1]

    Returns
    -------
    M_brake_m: torque against the motion at one wheel [N*m]

    Notes
    -----
    Not in the paper; downhill in place of M_max/m of (11), which is less by magnitude there.
    """
    return -M_dec / N


@equation(None, "M_rest", "torque", "N*m")
def rest_torque(m_R: Value, g: Value, theta: Value, d: Value) -> Value:
    """Torque that holds the vehicle at rest on a slope.

    Parameters
    ----------
    m_R: mass of the vehicle [kg]
    g: gravity [m/s^2]
    theta: slope, uphill positive [rad]
    d: wheel diameter [m]

    Returns
    -------
    M_rest: torque at the wheels while at rest, whole vehicle [N*m]

    Notes
    -----
    The paper has M_rest = 0, on level ground. On a slope the motors hold the vehicle, without help of friction.
    """
    return m_R * g * np.sin(theta) * d / 2


@equation(13, "M_rms", "torque", "N*m")
def rms_torque(
    t_acc: Value, M_max: Value, t_nom: Value, M_nom: Value, t_dec: Value, M_dec: Value, t_rest: Value, M_rest: Value
) -> Value:
    """RMS torque, whole vehicle.

    Parameters
    ----------
    t_acc: time of acceleration [s]
    M_max: torque while accelerating [N*m]
    t_nom: time at nominal velocity [s]
    M_nom: torque at nominal velocity [N*m]
    t_dec: time of deceleration [s]
    M_dec: torque while decelerating [N*m]
    t_rest: time at rest [s]
    M_rest: torque at rest [N*m]

    Returns
    -------
    M_rms: root mean square of the torque at the wheels [N*m]

    Printed
    -------
    ((t_acc * M_max**2 + t_nom * M_nom**2 + t_dec * M_dec**2 + t_rest * M_rest**2) / (t_acc + t_nom + t_dec + t_rest))
    ** (1 / 2)

    Notes
    -----
    t_total is the sum of the four times; the paper has t_rest = 0 and M_rest = 0. At rest on a slope M_rest holds the
    vehicle.
    """
    return np.sqrt(
        (t_acc * M_max**2 + t_nom * M_nom**2 + t_dec * M_dec**2 + t_rest * M_rest**2) / (t_acc + t_nom + t_dec + t_rest)
    )


@equation(14, "M_rms/m", "torque", "N*m")
def rms_torque_per_motor(M_rms: Value, N: Value) -> Value:
    """RMS torque per drive.

    Parameters
    ----------
    M_rms: RMS torque, whole vehicle [N*m]
    N: driven wheels [1]

    Returns
    -------
    M_rms_m: RMS torque at one wheel [N*m]

    Printed
    -------
    M_rms / N
    """
    return M_rms / N


@equation(15, "P_max/m", "power", "W")
def maximum_power_per_motor(M_max_m: Value, n_nom: Value) -> Value:
    """Maximum power per drive.

    Parameters
    ----------
    M_max_m: maximum torque at one wheel [N*m]
    n_nom: wheel speed [rad/s]

    Returns
    -------
    P_max_m: maximum power of one drive [W]

    Printed
    -------
    M_max_m * n_nom * pi / 30

    Notes
    -----
    Numerical-value equation: π/30 converts from rpm. Downhill it follows the sign of M_max, and is compared with
    nothing.
    """
    return M_max_m * n_nom


@equation(None, "n_rms", "rotary_speed", "rpm")
def rms_speed(n_nom: Value, t_acc: Value, t_nom: Value, t_dec: Value, t_rest: Value) -> Value:
    """RMS of the wheel speed over the trapezoid.

    Parameters
    ----------
    n_nom: wheel speed at nominal velocity [rad/s]
    t_acc: time of acceleration [s]
    t_nom: time at nominal velocity [s]
    t_dec: time of deceleration [s]
    t_rest: time at rest [s]

    Returns
    -------
    n_rms: root mean square of the wheel speed [rad/s]

    Notes
    -----
    Used in (16) and never defined in the paper: the RMS of the profile's speed, √(∫n² dt / T).
    """
    return n_nom * np.sqrt((t_acc / 3 + t_nom + t_dec / 3) / (t_acc + t_nom + t_dec + t_rest))


@equation(16, "P_rms/m", "power", "W")
def rms_power_per_motor(M_rms_m: Value, n_rms: Value) -> Value:
    """RMS power per drive.

    Parameters
    ----------
    M_rms_m: RMS torque at one wheel [N*m]
    n_rms: RMS of the wheel speed [rad/s]

    Returns
    -------
    P_rms_m: product of the RMS values of torque and speed [W]

    Printed
    -------
    M_rms_m * n_rms * pi / 30

    Notes
    -----
    Numerical-value equation. The product of two RMS values bounds the mean power; it is not the RMS of power.
    """
    return M_rms_m * n_rms


@equation(17, "M_rms/m0", "torque", "mN*m")
def rms_torque_at_motor(M_rms_m: Value, K_g: Value, eta_gear: Value, i_b: Value = 1.0, eta_b: Value = 1.0) -> Value:
    """RMS torque at the motor.

    Parameters
    ----------
    M_rms_m: RMS torque at one wheel [N*m]
    K_g: reduction of the gearhead [1]
    eta_gear: efficiency of the gearhead, the η of (17) and (18), 0 to 1 [1]
    i_b: reduction of the belt [1]
    eta_b: efficiency of the belt, 0 to 1 [1]

    Returns
    -------
    M_rms_m0: RMS torque at the motor shaft [N*m]

    Printed
    -------
    M_rms_m / (K_g * eta_gear)

    Notes
    -----
    The printed form omits the belt; with one, its ratio and efficiency divide too.
    """
    return M_rms_m / (K_g * eta_gear * i_b * eta_b)


@equation(18, "M_max/m0", "torque", "mN*m")
def maximum_torque_at_motor(M_max_m: Value, K_g: Value, eta_gear: Value, i_b: Value = 1.0, eta_b: Value = 1.0) -> Value:
    """Maximum torque at the motor.

    Parameters
    ----------
    M_max_m: maximum torque at one wheel [N*m]
    K_g: reduction of the gearhead [1]
    eta_gear: efficiency of the gearhead, the η of (17) and (18), 0 to 1 [1]
    i_b: reduction of the belt [1]
    eta_b: efficiency of the belt, 0 to 1 [1]

    Returns
    -------
    M_max_m0: maximum torque at the motor shaft [N*m]

    Printed
    -------
    M_max_m / (K_g * eta_gear)

    Notes
    -----
    The printed form omits the belt; with one, its ratio and efficiency divide too.
    """
    return M_max_m / (K_g * eta_gear * i_b * eta_b)


@equation(19, "C_v", "speed_constant", "rpm/V")
def speed_constant(V_0: Value, U: Value) -> Value:
    """Required speed constant.

    Parameters
    ----------
    V_0: required no-load speed [rad/s]
    U: motor voltage, its nominal one [V]

    Returns
    -------
    C_v: speed constant that the motor needs at least [rad/s/V]

    Printed
    -------
    V_0 / U

    Notes
    -----
    The paper writes υ for the motor voltage.
    """
    return V_0 / U


@equation(20, "V_0", "rotary_speed", "rpm")
def no_load_speed(n_nom: Value, K: Value, tau: Value, M_max_m0: Value) -> Value:
    """Required no-load speed.

    Parameters
    ----------
    n_nom: wheel speed at nominal velocity [rad/s]
    K: total ratio, motor to wheel [1]
    tau: speed/torque gradient of the motor [rad/s/(N*m)]
    M_max_m0: maximum torque at the motor shaft [N*m]

    Returns
    -------
    V_0: no-load speed that the motor needs at least [rad/s]

    Printed
    -------
    V_nom + tau * M_max_m0
    V_nom: nominal velocity of the vehicle [m/s]

    Notes
    -----
    Printed with V_nom, a velocity is added to a rotary speed. The term is the motor's speed at nominal velocity: n_nom
    times the total ratio. Downhill a braking torque in place of M_max lowers it; the larger magnitude is compared.
    """
    return n_nom * K + tau * M_max_m0
