r"""A platform under its controllers, period by period: forces on its wheels, steps in time, poses, torques, motion.

``W`` has a row per wheel, ``K`` one per caster, ``B`` platform and floor; ``M`` and ``C`` are inertia and Coriolis
matrix without the wheels. ``y`` is the state (posture, velocity, wheel speeds, work and losses), ``w`` the figures of
each wheel at a state, ``f`` generalised forces, ``power`` powers and losses. ``G`` holds gains and limit of each
wheel's controller, ``E`` maps the platform's velocity to wheel speeds, ``P`` are the figures of the pose loop. ``A``
and ``s`` are the platform's matrix and the stages of a step, ``z`` pose errors, their integrals, the velocity command
and torques.

Traction grows in proportion to slip speed s and runs smoothly into the friction coefficient,

.. math:: F = -μ N \tanh\frac{|s|}{s_0 + c\,|v|} \frac{s}{|s|},

the hyperbolic tangent of [1]_ for dry friction. A wheel with rollers grips along the roller's axis only, as in [2]_,
who model an omnidirectional robot with slip; one without rollers grips along and across, within one friction circle.
:math:`s_0` is where the straight line through 0 would meet μN. c is that of a tyre that rolls at v: its slip at a
force is then a share of the travelled distance, not of the time, and μN/c is its slip stiffness [3]_.
There is no stiction: a platform at rest on a slope creeps by force over stiffness.

.. [1] S. Andersson, A. Söderberg, S. Björklund, "Friction models for sliding dry, boundary and mixed lubricated
   contacts", Tribology International 40 (2007) 580-587.
.. [2] R. L. Williams II, B. E. Carter, P. Gallina, G. Rosati, "Dynamic model with slip for wheeled omnidirectional
   robots", IEEE Transactions on Robotics and Automation 18 (2002) 285-293.
.. [3] H. B. Pacejka, *Tire and Vehicle Dynamics*, 3rd ed., Butterworth-Heinemann 2012.
"""

from __future__ import annotations

import math
import sys

from drivesizer.files.machine_code import Kernel, defined_in
from drivesizer.platform.equations import Array

GAMMA = 1.0 - 0.5**0.5  # of the Rosenbrock step: order 2 and L-stable
FASTEST = 1e6  # m/s and rad/s: faster diverges

# a wheel: rows of slip (AX, AY, AT | -RA) and of the roller, or sideways, (BX, BY, BT | RB) over velocity | wheel
# speed; resistances; kind (0 motor, 1 free, 2 blocked); load N0 - height * (SX, SY) . floor's force; torque over
# torque command
AX, AY, AT, BX, BY, BT, RA, RB, R, J, CW, CR, FW, HELD, KIND, N0, SX, SY, STRENGTH = range(19)
COLUMNS = 19

# a wheel at a state: forces along and across and their slopes, over the load; slip and roller speed; load;
# slope of its resistance to turning; its column of the linear equations
FA, FB, DAA, DAB, DBB, SLIP, RHO, LOAD, DW, BOTTOM, SIDE = range(11)
WORK = SIDE + 3

# a caster, and its force and slope over the load
CASTER_X, CASTER_Y, CASTER_RR, CASTER_N0, CASTER_SX, CASTER_SY, CASTER_FX, CASTER_FY, CASTER_K = range(9)
CASTER_COLUMNS = 9

# platform and floor
PX, PY, WEIGHT, PULL, UPHILL, HEIGHT, FRICTION, SLIP_SPEED, CREEP, TURNROUND = range(10)

POSE = 3  # entries of the state before the velocities: x, y, heading
# after them: work of motors and weight; losses
INPUT, LOST_SLIP, LOST_WHEEL, LOST_ROLLER, LOST_CASTER = range(5)
TALLIES = 5

# pose feedback: law (0 none, 1 of three freedoms, 2 of a unicycle), periods between poses, gains
LAW, PERIODS, K_P, K_I, K_X, K_Y, APERIODIC = range(7)


def grip(x: float) -> float:
    """Share of μN over slip, x = 1 where the straight line meets it."""
    return math.tanh(x)


def grip_slope(share: float) -> float:
    """Rate of change of ``grip`` where it has a value."""
    return 1.0 - share * share


# -- Forces on a platform that moves while its wheels turn and slip; slip s of a wheel and speed ρ of its roller are
#
# .. math:: s = a η - r \cos γ\, \dot ϕ, \quad ρ = b η + r \sin γ\, \dot ϕ,
#
# a along the roller's axis, b across it. A force F along a row acts as -F times that row on platform and wheel
# alike, so that the loss is exactly F s. All forces are in proportion to the load,
# and the loads follow from the forces: with the height h of the centre of mass N = N_0 - h (S · ΣF), two linear
# equations.


def roller_forces(W: Array, B: Array, w: Array, i: int, most: float, x: float) -> None:
    """A wheel with rollers: grip along their axis, their resistance across; forces over the load."""
    c = W[i, CR]
    along = math.sqrt(most * most - c * c)  # of the friction circle
    reach = B[SLIP_SPEED] + B[CREEP] * x
    turning = math.tanh(w[i, RHO] / B[TURNROUND]) if c > 0.0 else 0.0
    share = grip(w[i, SLIP] / reach)
    w[i, FA], w[i, FB] = -along * share, -c * turning
    w[i, DAA], w[i, DAB] = along * grip_slope(share) / reach, 0.0
    w[i, DBB] = c * (1.0 - turning * turning) / B[TURNROUND]


def tyre_forces(B: Array, w: Array, i: int, most: float, x: float) -> None:
    """A wheel without rollers: one friction circle for both directions."""
    reach = B[SLIP_SPEED] + B[CREEP] * x
    a, b = w[i, SLIP], w[i, RHO]
    size = math.sqrt(a * a + b * b)
    fraction = grip(size / reach)
    slope = most * grip_slope(fraction) / reach
    share = most * fraction / size if size > 1e-9 * reach else slope
    a, b = (a / size, b / size) if size > 0.0 else (1.0, 0.0)
    w[i, FA], w[i, FB] = -share * w[i, SLIP], -share * w[i, RHO]
    w[i, DAA], w[i, DAB] = share + (slope - share) * a * a, (slope - share) * a * b
    w[i, DBB] = share + (slope - share) * b * b


def contact_forces(W: Array, B: Array, y: Array, w: Array) -> None:
    """Forces of each wheel over its load, at a state."""
    u, v, turn = y[POSE], y[POSE + 1], y[POSE + 2]
    for i in range(W.shape[0]):
        speed = y[POSE + 3 + i]
        w[i, SLIP] = W[i, AX] * u + W[i, AY] * v + W[i, AT] * turn - W[i, RA] * speed
        w[i, RHO] = W[i, BX] * u + W[i, BY] * v + W[i, BT] * turn + W[i, RB] * speed
        x = abs(W[i, R] * speed)
        if W[i, HELD] != 0.0:
            tyre_forces(B, w, i, B[FRICTION], x)
        else:
            roller_forces(W, B, w, i, B[FRICTION], x)


def caster_forces(K: Array, B: Array, y: Array) -> None:
    """Resistance of each caster over its load."""
    for j in range(K.shape[0]):
        u = y[POSE] - K[j, CASTER_Y] * y[POSE + 2]
        v = y[POSE + 1] + K[j, CASTER_X] * y[POSE + 2]
        size = math.sqrt(u * u + v * v)
        turnround = B[TURNROUND]
        k = math.tanh(size / turnround) / size if size > 1e-9 * turnround else 1.0 / turnround
        k *= K[j, CASTER_RR]
        K[j, CASTER_FX], K[j, CASTER_FY], K[j, CASTER_K] = -k * u, -k * v, k


def wheel_loads(W: Array, K: Array, B: Array, w: Array) -> None:
    """Loads of wheels and casters under those forces; a caster's figures are multiplied by its load."""
    n, h = W.shape[0], B[HEIGHT]
    xx, xy, yx, yy, x, y = 1.0, 0.0, 0.0, 1.0, 0.0, 0.0
    for i in range(n + K.shape[0]):
        if i < n:
            fx = W[i, AX] * w[i, FA] + W[i, BX] * w[i, FB]
            fy = W[i, AY] * w[i, FA] + W[i, BY] * w[i, FB]
            n0, sx, sy = W[i, N0], W[i, SX], W[i, SY]
        else:
            fx, fy = K[i - n, CASTER_FX], K[i - n, CASTER_FY]
            n0, sx, sy = K[i - n, CASTER_N0], K[i - n, CASTER_SX], K[i - n, CASTER_SY]
        x, y = x + n0 * fx, y + n0 * fy
        xx, xy, yx, yy = xx + h * sx * fx, xy + h * sy * fx, yx + h * sx * fy, yy + h * sy * fy
    whole = xx * yy - xy * yx
    x, y = (yy * x - xy * y) / whole, (xx * y - yx * x) / whole  # the floor's whole force
    for i in range(n):
        w[i, LOAD] = max(W[i, N0] - h * (W[i, SX] * x + W[i, SY] * y), 0.0)
    for j in range(K.shape[0]):
        carried = max(K[j, CASTER_N0] - h * (K[j, CASTER_SX] * x + K[j, CASTER_SY] * y), 0.0)
        for k in range(CASTER_FX, CASTER_K + 1):
            K[j, k] *= carried


def wheel_forces(W: Array, B: Array, y: Array, w: Array, torque: Array, f: Array, power: Array) -> None:
    """Add the wheels' forces on the platform, the first three of f, and on themselves; powers and losses."""
    for i in range(W.shape[0]):
        load, speed = w[i, LOAD], y[POSE + 3 + i]
        a, b = load * w[i, FA], load * w[i, FB]
        f[0] += a * W[i, AX] + b * W[i, BX]
        f[1] += a * W[i, AY] + b * W[i, BY]
        f[2] += a * W[i, AT] + b * W[i, BT]
        most = W[i, CW] * W[i, R] * load + W[i, FW]
        per = W[i, R] / B[TURNROUND]
        turning = math.tanh(speed * per)
        w[i, DW] = most * (1.0 - turning * turning) * per
        drive = W[i, STRENGTH] * torque[i] if W[i, KIND] == 0.0 else 0.0
        f[3 + i] = drive - W[i, RA] * a + W[i, RB] * b - most * turning if W[i, KIND] != 2.0 else 0.0
        power[INPUT] += drive * speed
        power[LOST_WHEEL] += most * turning * speed
        power[LOST_SLIP] -= a * w[i, SLIP]
        power[LOST_SLIP if W[i, HELD] != 0.0 else LOST_ROLLER] -= b * w[i, RHO]


def forces(W: Array, K: Array, B: Array, C: Array, y: Array, torque: Array, w: Array, f: Array, power: Array) -> None:
    """Generalised forces f on velocity and wheel speeds at a state; powers of motors and weight, losses [W]."""
    contact_forces(W, B, y, w)
    caster_forces(K, B, y)
    wheel_loads(W, K, B, w)
    for k in range(TALLIES):
        power[k] = 0.0
    u, v, turn = y[POSE], y[POSE + 1], y[POSE + 2]
    downhill = B[UPHILL] - y[2]
    x, z = -B[PULL] * math.cos(downhill), -B[PULL] * math.sin(downhill)
    moment = B[PX] * z - B[PY] * x
    power[INPUT] = x * u + z * v + moment * turn
    f[0] = x - turn * (C[0, 0] * u + C[0, 1] * v + C[0, 2] * turn)
    f[1] = z - turn * (C[1, 0] * u + C[1, 1] * v + C[1, 2] * turn)
    f[2] = moment - turn * (C[2, 0] * u + C[2, 1] * v + C[2, 2] * turn)
    wheel_forces(W, B, y, w, torque, f, power)
    for j in range(K.shape[0]):
        fx, fy = K[j, CASTER_FX], K[j, CASTER_FY]
        moment = K[j, CASTER_X] * fy - K[j, CASTER_Y] * fx
        f[0], f[1], f[2] = f[0] + fx, f[1] + fy, f[2] + moment
        power[LOST_CASTER] -= fx * u + fy * v + moment * turn


# -- One step in time: linearly implicit, of order 2, its length by an embedded error.
#
# .. math:: (M - γ h J) k_1 = Q(y), \quad (M - γ h J) k_2 = Q(y + h k_1) - 2 M k_1, \quad
#           y' = y + \tfrac h2 (3 k_1 + k_2)
#
# is of order 2 whatever J is and, with γ = 1 - 1/√2, L-stable [1]_: stiff tyres do not shorten the step. J has the
# slopes of grip and resistance; wheels couple with the platform only, so the equations have arrow form and reduce to
# three. Posture and energies take the same step with J = 0, which is Heun's.
#
# .. [1] J. G. Verwer, E. J. Spee, J. G. Blom, W. Hundsdorfer, "A second-order Rosenbrock method applied to
# photochemical dispersion problems", SIAM Journal on Scientific Computing 20 (1999) 1456-1480.


def assemble(W: Array, K: Array, M: Array, w: Array, A: Array, h: float) -> None:
    """M - γ h J of the platform in A; of each wheel its column and its place on the diagonal in w."""
    g = GAMMA * h
    for r in range(3):
        for c in range(3):
            A[r, c] = M[r, c]
    for i in range(W.shape[0]):
        n = g * w[i, LOAD]
        aa, ab, bb = n * w[i, DAA], n * w[i, DAB], n * w[i, DBB]
        ra, rb = W[i, RA], W[i, RB]
        for r in range(3):
            p, q = W[i, AX + r], W[i, BX + r]
            for c in range(3):
                s, t = W[i, AX + c], W[i, BX + c]
                A[r, c] += aa * p * s + ab * (p * t + q * s) + bb * q * t
            w[i, SIDE + r] = -ra * (aa * p + ab * q) + rb * (ab * p + bb * q)
        w[i, BOTTOM] = W[i, J] + g * w[i, DW] + aa * ra * ra - 2.0 * ab * ra * rb + bb * rb * rb
        if W[i, KIND] == 2.0:
            w[i, SIDE], w[i, SIDE + 1], w[i, SIDE + 2] = 0.0, 0.0, 0.0
    for j in range(K.shape[0]):
        k, x, y = g * K[j, CASTER_K], K[j, CASTER_X], K[j, CASTER_Y]
        A[0, 0], A[1, 1], A[2, 2] = A[0, 0] + k, A[1, 1] + k, A[2, 2] + k * (x * x + y * y)
        A[0, 2], A[2, 0], A[1, 2], A[2, 1] = A[0, 2] - k * y, A[2, 0] - k * y, A[1, 2] + k * x, A[2, 1] + k * x


def factorise(W: Array, w: Array, A: Array) -> None:
    """Eliminate the wheels from the platform's equations, and factorise the rest: A = L Lᵀ, L in its lower half."""
    for i in range(W.shape[0]):
        for r in range(3):
            for c in range(3):
                A[r, c] -= w[i, SIDE + r] * w[i, SIDE + c] / w[i, BOTTOM]
    for c in range(3):
        for k in range(c):
            A[c, c] -= A[c, k] * A[c, k]
        A[c, c] = math.sqrt(A[c, c])
        for r in range(c + 1, 3):
            for k in range(c):
                A[r, c] -= A[r, k] * A[c, k]
            A[r, c] /= A[c, c]


def solve(W: Array, w: Array, A: Array, f: Array) -> None:
    """Rates of velocity and wheel speeds, in place of forces."""
    for i in range(W.shape[0]):
        for r in range(3):
            f[r] -= w[i, SIDE + r] * f[3 + i] / w[i, BOTTOM]
    for r in range(3):
        for k in range(r):
            f[r] -= A[r, k] * f[k]
        f[r] /= A[r, r]
    for r in range(2, -1, -1):
        for k in range(r + 1, 3):
            f[r] -= A[k, r] * f[k]
        f[r] /= A[r, r]
    for i in range(W.shape[0]):
        side = w[i, SIDE] * f[0] + w[i, SIDE + 1] * f[1] + w[i, SIDE + 2] * f[2]
        f[3 + i] = (f[3 + i] - side) / w[i, BOTTOM]


def posture_rate(y: Array, rate: Array) -> None:
    """Rate of the posture at a state."""
    c, s = math.cos(y[2]), math.sin(y[2])
    rate[0], rate[1] = c * y[POSE] - s * y[POSE + 1], s * y[POSE] + c * y[POSE + 1]
    rate[2] = y[POSE + 2]


def try_step(W: Array, K: Array, B: Array, C: Array, M: Array, y: Array, torque: Array, h: float, lever: float,
             w: Array, A: Array, s: Array) -> float:  # fmt: skip
    """Try a step of length h; the state after it in the last row of s, and its error [m/s]."""
    n = 3 + W.shape[0]
    k1, k2, p1, p2, m1, m2, z = s[0], s[1], s[2], s[3], s[4], s[5], s[6]
    forces(W, K, B, C, y, torque, w, k1, p1)
    posture_rate(y, m1)
    assemble(W, K, M, w, A, h)
    factorise(W, w, A)
    solve(W, w, A, k1)
    for r in range(3):
        z[r] = y[r] + h * m1[r]
    for r in range(n):
        z[3 + r] = y[3 + r] + h * k1[r]
    forces(W, K, B, C, z, torque, w, k2, p2)
    posture_rate(z, m2)
    for r in range(3):  # less 2 M k_1
        k2[r] -= 2.0 * (M[r, 0] * k1[0] + M[r, 1] * k1[1] + M[r, 2] * k1[2])
    for i in range(W.shape[0]):
        k2[3 + i] -= 2.0 * W[i, J] * k1[3 + i]
    solve(W, w, A, k2)
    for r in range(3):
        z[r] = y[r] + 0.5 * h * (m1[r] + m2[r])
    for r in range(n):
        z[3 + r] = y[3 + r] + h * (1.5 * k1[r] + 0.5 * k2[r])
    for r in range(TALLIES):
        z[3 + n + r] = y[3 + n + r] + 0.5 * h * (p1[r] + p2[r])
    worst = 0.0  # the embedded error, of first order: largest of all speeds
    for r in range(n):
        size = 1.0 if r < 2 else lever if r == 2 else W[r - 3, R]
        error = 0.5 * h * abs(k1[r] + k2[r]) * size
        if not error <= worst:
            worst = error
    return worst


def advance(W: Array, K: Array, B: Array, C: Array, M: Array, y: Array, torque: Array, period: float, reach: float,
            lever: float, tolerance: float, w: Array, A: Array, s: Array) -> float:  # fmt: skip
    """Advance one period under held torques; the step to try next [s], 0 where speeds diverge."""
    left, h = period, min(reach, period)
    while left > 0.0:
        last = h >= left * (1.0 - 1e-9)
        step = left if last else h
        error = try_step(W, K, B, C, M, y, torque, step, lever, w, A, s)
        if not error < 1e9:
            if step < 1e-9 * period:
                return 0.0
            h = 0.1 * step
            continue
        scale = min(max(0.9 * math.sqrt(tolerance / max(error, 1e-30)), 0.2), 5.0)
        if error > tolerance and step > 1e-6 * period:
            h = scale * step
            continue
        for r in range(y.shape[0]):
            y[r] = s[6, r]
        if not last or scale < 1.0:
            h = scale * step
        left = 0.0 if last else left - step
    for r in range(POSE, POSE + 3 + W.shape[0]):
        if not abs(y[r]) < FASTEST:
            return 0.0
    return max(h, 1e-6 * period)


# -- A platform under its controllers, period by period: poses, wheel speeds, torques and motion.
#
# A torque responds to the sample of one period before, and is held for a period.


def command(P: Array, y: Array, planned: Array, eta: Array, z: Array, new_pose: bool, period: float) -> None:
    """Velocity command of the wheels, z[6:9]: the planned velocity and the correction by the last pose.

    Where a pose is taken its errors in the robot's frame are z[0:3], and their integrals z[3:6].
    """
    if new_pose:
        x, v, turned = planned[0] - y[0], planned[1] - y[1], planned[2] - y[2]
        c, s = math.cos(y[2]), math.sin(y[2])
        z[0], z[1], z[2] = c * x + s * v, c * v - s * x, math.atan2(math.sin(turned), math.cos(turned))
        for r in range(3):
            z[3 + r] += P[K_I] * z[r] * period
    z[6], z[7], z[8] = eta[0], eta[1], eta[2]
    if P[LAW] == 1.0:
        a, b = math.cos(z[2]), math.sin(z[2])
        z[6] = a * eta[0] - b * eta[1] + P[K_P] * z[0] + z[3]
        z[7] = b * eta[0] + a * eta[1] + P[K_P] * z[1] + z[4]
        z[8] = eta[2] + P[K_P] * z[2] + z[5]
    elif P[LAW] == 2.0:
        z[6] = eta[0] * math.cos(z[2]) + P[K_X] * z[0] + z[3]
        z[8] = eta[2] + eta[0] * (P[K_Y] * z[1] + P[APERIODIC] * math.sin(z[2]))


def torque_command(G: Array, E: Array, c: Array, fed: Array, y: Array, i: int, sums: Array, period: float) -> float:
    """Torque command of a wheel's controller; its integral is frozen while the torque is at its limit."""
    error = E[i, 0] * c[0] + E[i, 1] * c[1] + E[i, 2] * c[2] - y[POSE + 3 + i]
    torque: float = fed[i] + G[i, 0] * error + sums[i]
    over = abs(torque) > G[i, 2]
    if not over or torque * error < 0.0:
        sums[i] += G[i, 1] * error * period
    return math.copysign(G[i, 2], torque) if over else torque


def record_state(W: Array, y: Array, torque: Array, w: Array, row: Array, floor: Array, applied: Array) -> None:
    """Record a state, its torques, and slip, load and traction of its wheels."""
    for r in range(y.shape[0]):
        row[r] = y[r]
    for i in range(W.shape[0]):
        across = w[i, RHO] if W[i, HELD] != 0.0 else 0.0
        floor[0, i] = math.sqrt(w[i, SLIP] * w[i, SLIP] + across * across)
        floor[1, i] = w[i, LOAD]
        floor[2, i] = w[i, LOAD] * math.sqrt(w[i, FA] * w[i, FA] + w[i, FB] * w[i, FB])
        applied[i] = W[i, STRENGTH] * torque[i] if W[i, KIND] == 0.0 else 0.0


def follow_one(W: Array, K: Array, B: Array, C: Array, M: Array, G: Array, E: Array, P: Array, planned: Array,
               eta: Array, fed: Array, y: Array, torque: Array, period: float, lever: float, tolerance: float,
               w: Array, A: Array, s: Array, z: Array, rows: Array, floor: Array, applied: Array,
               limited: Array) -> int:  # fmt: skip
    """Simulate all samples."""
    n, reach = W.shape[0], period
    for k in range(planned.shape[0]):
        forces(W, K, B, C, y, torque, w, s[0], s[2])
        record_state(W, y, torque, w, rows[k], floor[k], applied[k])
        if k == planned.shape[0] - 1:
            break
        command(P, y, planned[k], eta[k], z, P[LAW] != 0.0 and k % int(P[PERIODS]) == 0, period * P[PERIODS])
        for i in range(n):
            z[9 + n + i] = 0.0
            if W[i, KIND] == 0.0:
                z[9 + n + i] = torque_command(G, E, z[6:9], fed[k], y, i, z[9 : 9 + n], period)
                limited[i] += 1.0 if abs(z[9 + n + i]) >= G[i, 2] else 0.0
        reach = advance(W, K, B, C, M, y, torque, period, reach, lever, tolerance, w, A, s)
        if reach == 0.0:
            return k
        for i in range(n):
            torque[i] = z[9 + n + i]
    return int(planned.shape[0])


_THIS = sys.modules[__name__]
KERNEL = Kernel(
    functions=defined_in((_THIS,)),
    modules=(_THIS,),
    inline=False,
    slow="the simulation of a platform runs some hundred times slower",
    arguments="d2 d2 d1 d2 d2 d2 d2 d1 d2 d2 d2 d1 d1 d0 d0 d0 d2 d2 d2 d1 d2 d3 d2 d1",
)
