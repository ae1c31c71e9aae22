"""A platform under its controllers, period by period: forces on its wheels, steps in time, poses, torques, motion."""

from __future__ import annotations

import math

import drivesizer.control.path_following.kernel_layout as at
from drivesizer.control.path_following.kernel_layout import Array
from drivesizer.control.path_following.slip import grip, grip_slope

__all__ = ["follow_one"]


# -- Forces on a platform that moves while its wheels turn and slip; slip s of a wheel and speed ρ of its roller are
#
# .. math:: s = a η - r \cos γ\, \dot ϕ, \quad ρ = b η + r \sin γ\, \dot ϕ,
#
# a along the roller's axis, b across it. A force F along a row acts as -F times that row on platform and wheel
# alike, so that the loss is exactly F s. Arrays as in ``kernel_layout``. All forces are in proportion to the load,
# and the loads follow from the forces: with the height h of the centre of mass N = N_0 - h (S · ΣF), two linear
# equations.


def roller_forces(W: Array, B: Array, w: Array, i: int, most: float, x: float) -> None:
    """A wheel with rollers: grip along their axis, their resistance across; forces over the load."""
    c = W[i, at.CR]
    along = math.sqrt(most * most - c * c)  # of the friction circle
    reach = B[at.SLIP_SPEED] + B[at.CREEP] * x
    turning = math.tanh(w[i, at.RHO] / B[at.TURNROUND]) if c > 0.0 else 0.0
    share = grip(w[i, at.SLIP] / reach)
    w[i, at.FA], w[i, at.FB] = -along * share, -c * turning
    w[i, at.DAA], w[i, at.DAB] = along * grip_slope(share) / reach, 0.0
    w[i, at.DBB] = c * (1.0 - turning * turning) / B[at.TURNROUND]


def tyre_forces(B: Array, w: Array, i: int, most: float, x: float) -> None:
    """A wheel without rollers: one friction circle for both directions."""
    reach = B[at.SLIP_SPEED] + B[at.CREEP] * x
    a, b = w[i, at.SLIP], w[i, at.RHO]
    size = math.sqrt(a * a + b * b)
    held = grip(size / reach)
    slope = most * grip_slope(held) / reach
    share = most * held / size if size > 1e-9 * reach else slope
    a, b = (a / size, b / size) if size > 0.0 else (1.0, 0.0)
    w[i, at.FA], w[i, at.FB] = -share * w[i, at.SLIP], -share * w[i, at.RHO]
    w[i, at.DAA], w[i, at.DAB] = share + (slope - share) * a * a, (slope - share) * a * b
    w[i, at.DBB] = share + (slope - share) * b * b


def contact_forces(W: Array, B: Array, y: Array, w: Array) -> None:
    """Forces of each wheel over its load, at a state."""
    u, v, turn = y[at.POSE], y[at.POSE + 1], y[at.POSE + 2]
    for i in range(W.shape[0]):
        speed = y[at.POSE + 3 + i]
        w[i, at.SLIP] = W[i, at.AX] * u + W[i, at.AY] * v + W[i, at.AT] * turn - W[i, at.RA] * speed
        w[i, at.RHO] = W[i, at.BX] * u + W[i, at.BY] * v + W[i, at.BT] * turn + W[i, at.RB] * speed
        x = abs(W[i, at.R] * speed)
        if W[i, at.HELD] != 0.0:
            tyre_forces(B, w, i, B[at.FRICTION], x)
        else:
            roller_forces(W, B, w, i, B[at.FRICTION], x)


def caster_forces(K: Array, B: Array, y: Array) -> None:
    """Resistance of each caster over its load."""
    for j in range(K.shape[0]):
        u = y[at.POSE] - K[j, at.CASTER_Y] * y[at.POSE + 2]
        v = y[at.POSE + 1] + K[j, at.CASTER_X] * y[at.POSE + 2]
        size = math.sqrt(u * u + v * v)
        turnround = B[at.TURNROUND]
        k = math.tanh(size / turnround) / size if size > 1e-9 * turnround else 1.0 / turnround
        k *= K[j, at.CASTER_RR]
        K[j, at.CASTER_FX], K[j, at.CASTER_FY], K[j, at.CASTER_K] = -k * u, -k * v, k


def wheel_loads(W: Array, K: Array, B: Array, w: Array) -> None:
    """Loads of wheels and casters under those forces; a caster's figures are multiplied by its load."""
    n, h = W.shape[0], B[at.HEIGHT]
    xx, xy, yx, yy, x, y = 1.0, 0.0, 0.0, 1.0, 0.0, 0.0
    for i in range(n + K.shape[0]):
        if i < n:
            fx = W[i, at.AX] * w[i, at.FA] + W[i, at.BX] * w[i, at.FB]
            fy = W[i, at.AY] * w[i, at.FA] + W[i, at.BY] * w[i, at.FB]
            n0, sx, sy = W[i, at.N0], W[i, at.SX], W[i, at.SY]
        else:
            fx, fy = K[i - n, at.CASTER_FX], K[i - n, at.CASTER_FY]
            n0, sx, sy = K[i - n, at.CASTER_N0], K[i - n, at.CASTER_SX], K[i - n, at.CASTER_SY]
        x, y = x + n0 * fx, y + n0 * fy
        xx, xy, yx, yy = xx + h * sx * fx, xy + h * sy * fx, yx + h * sx * fy, yy + h * sy * fy
    whole = xx * yy - xy * yx
    x, y = (yy * x - xy * y) / whole, (xx * y - yx * x) / whole  # the floor's whole force
    for i in range(n):
        w[i, at.LOAD] = max(W[i, at.N0] - h * (W[i, at.SX] * x + W[i, at.SY] * y), 0.0)
    for j in range(K.shape[0]):
        carried = max(K[j, at.CASTER_N0] - h * (K[j, at.CASTER_SX] * x + K[j, at.CASTER_SY] * y), 0.0)
        for k in range(at.CASTER_FX, at.CASTER_K + 1):
            K[j, k] *= carried


def wheel_forces(W: Array, B: Array, y: Array, w: Array, torque: Array, f: Array, power: Array) -> None:
    """Add the wheels' forces on the platform, the first three of f, and on themselves; powers and losses."""
    for i in range(W.shape[0]):
        load, speed = w[i, at.LOAD], y[at.POSE + 3 + i]
        a, b = load * w[i, at.FA], load * w[i, at.FB]
        f[0] += a * W[i, at.AX] + b * W[i, at.BX]
        f[1] += a * W[i, at.AY] + b * W[i, at.BY]
        f[2] += a * W[i, at.AT] + b * W[i, at.BT]
        most = W[i, at.CW] * W[i, at.R] * load + W[i, at.FW]
        per = W[i, at.R] / B[at.TURNROUND]
        turning = math.tanh(speed * per)
        w[i, at.DW] = most * (1.0 - turning * turning) * per
        drive = W[i, at.STRENGTH] * torque[i] if W[i, at.KIND] == 0.0 else 0.0
        f[3 + i] = drive - W[i, at.RA] * a + W[i, at.RB] * b - most * turning if W[i, at.KIND] != 2.0 else 0.0
        power[at.INPUT] += drive * speed
        power[at.LOST_WHEEL] += most * turning * speed
        power[at.LOST_SLIP] -= a * w[i, at.SLIP]
        power[at.LOST_SLIP if W[i, at.HELD] != 0.0 else at.LOST_ROLLER] -= b * w[i, at.RHO]


def forces(W: Array, K: Array, B: Array, C: Array, y: Array, torque: Array, w: Array, f: Array, power: Array) -> None:
    """Generalised forces f on velocity and wheel speeds at a state; powers of motors and weight, losses [W]."""
    contact_forces(W, B, y, w)
    caster_forces(K, B, y)
    wheel_loads(W, K, B, w)
    for k in range(at.TALLIES):
        power[k] = 0.0
    u, v, turn = y[at.POSE], y[at.POSE + 1], y[at.POSE + 2]
    downhill = B[at.UPHILL] - y[2]
    x, z = -B[at.PULL] * math.cos(downhill), -B[at.PULL] * math.sin(downhill)
    moment = B[at.PX] * z - B[at.PY] * x
    power[at.INPUT] = x * u + z * v + moment * turn
    f[0] = x - turn * (C[0, 0] * u + C[0, 1] * v + C[0, 2] * turn)
    f[1] = z - turn * (C[1, 0] * u + C[1, 1] * v + C[1, 2] * turn)
    f[2] = moment - turn * (C[2, 0] * u + C[2, 1] * v + C[2, 2] * turn)
    wheel_forces(W, B, y, w, torque, f, power)
    for j in range(K.shape[0]):
        fx, fy = K[j, at.CASTER_FX], K[j, at.CASTER_FY]
        moment = K[j, at.CASTER_X] * fy - K[j, at.CASTER_Y] * fx
        f[0], f[1], f[2] = f[0] + fx, f[1] + fy, f[2] + moment
        power[at.LOST_CASTER] -= fx * u + fy * v + moment * turn


# -- One step in time: linearly implicit, of order 2, its length by an embedded error.
#
# .. math:: (M - γ h J) k_1 = Q(y), \quad (M - γ h J) k_2 = Q(y + h k_1) - 2 M k_1, \quad
#           y' = y + \tfrac h2 (3 k_1 + k_2)
#
# is of order 2 whatever J is and, with γ = 1 - 1/√2, L-stable [1]_: stiff tyres do not shorten the step. J has the
# slopes of grip and resistance; wheels couple with the platform only, so the equations have arrow form and reduce to
# three. Posture and energies take the same step with J = 0, which is Heun's. Arrays as in ``kernel_layout``.
#
# .. [1] J. G. Verwer, E. J. Spee, J. G. Blom, W. Hundsdorfer, "A second-order Rosenbrock method applied to
# photochemical dispersion problems", SIAM Journal on Scientific Computing 20 (1999) 1456-1480.


def assemble(W: Array, K: Array, M: Array, w: Array, A: Array, h: float) -> None:
    """M - γ h J of the platform in A; of each wheel its column and its place on the diagonal in w."""
    g = at.GAMMA * h
    for r in range(3):
        for c in range(3):
            A[r, c] = M[r, c]
    for i in range(W.shape[0]):
        n = g * w[i, at.LOAD]
        aa, ab, bb = n * w[i, at.DAA], n * w[i, at.DAB], n * w[i, at.DBB]
        ra, rb = W[i, at.RA], W[i, at.RB]
        for r in range(3):
            p, q = W[i, at.AX + r], W[i, at.BX + r]
            for c in range(3):
                s, t = W[i, at.AX + c], W[i, at.BX + c]
                A[r, c] += aa * p * s + ab * (p * t + q * s) + bb * q * t
            w[i, at.SIDE + r] = -ra * (aa * p + ab * q) + rb * (ab * p + bb * q)
        w[i, at.BOTTOM] = W[i, at.J] + g * w[i, at.DW] + aa * ra * ra - 2.0 * ab * ra * rb + bb * rb * rb
        if W[i, at.KIND] == 2.0:
            w[i, at.SIDE], w[i, at.SIDE + 1], w[i, at.SIDE + 2] = 0.0, 0.0, 0.0
    for j in range(K.shape[0]):
        k, x, y = g * K[j, at.CASTER_K], K[j, at.CASTER_X], K[j, at.CASTER_Y]
        A[0, 0], A[1, 1], A[2, 2] = A[0, 0] + k, A[1, 1] + k, A[2, 2] + k * (x * x + y * y)
        A[0, 2], A[2, 0], A[1, 2], A[2, 1] = A[0, 2] - k * y, A[2, 0] - k * y, A[1, 2] + k * x, A[2, 1] + k * x


def factorise(W: Array, w: Array, A: Array) -> None:
    """Eliminate the wheels from the platform's equations, and factorise the rest: A = L Lᵀ, L in its lower half."""
    for i in range(W.shape[0]):
        for r in range(3):
            for c in range(3):
                A[r, c] -= w[i, at.SIDE + r] * w[i, at.SIDE + c] / w[i, at.BOTTOM]
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
            f[r] -= w[i, at.SIDE + r] * f[3 + i] / w[i, at.BOTTOM]
    for r in range(3):
        for k in range(r):
            f[r] -= A[r, k] * f[k]
        f[r] /= A[r, r]
    for r in range(2, -1, -1):
        for k in range(r + 1, 3):
            f[r] -= A[k, r] * f[k]
        f[r] /= A[r, r]
    for i in range(W.shape[0]):
        side = w[i, at.SIDE] * f[0] + w[i, at.SIDE + 1] * f[1] + w[i, at.SIDE + 2] * f[2]
        f[3 + i] = (f[3 + i] - side) / w[i, at.BOTTOM]


def posture_rate(y: Array, rate: Array) -> None:
    """Rate of the posture at a state."""
    c, s = math.cos(y[2]), math.sin(y[2])
    rate[0], rate[1] = c * y[at.POSE] - s * y[at.POSE + 1], s * y[at.POSE] + c * y[at.POSE + 1]
    rate[2] = y[at.POSE + 2]


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
        k2[3 + i] -= 2.0 * W[i, at.J] * k1[3 + i]
    solve(W, w, A, k2)
    for r in range(3):
        z[r] = y[r] + 0.5 * h * (m1[r] + m2[r])
    for r in range(n):
        z[3 + r] = y[3 + r] + h * (1.5 * k1[r] + 0.5 * k2[r])
    for r in range(at.TALLIES):
        z[3 + n + r] = y[3 + n + r] + 0.5 * h * (p1[r] + p2[r])
    worst = 0.0  # the embedded error, of first order: largest of all speeds
    for r in range(n):
        size = 1.0 if r < 2 else lever if r == 2 else W[r - 3, at.R]
        found = 0.5 * h * abs(k1[r] + k2[r]) * size
        if not found <= worst:
            worst = found
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
    for r in range(at.POSE, at.POSE + 3 + W.shape[0]):
        if not abs(y[r]) < at.FASTEST:
            return 0.0
    return max(h, 1e-6 * period)


# -- A platform under its controllers, period by period: poses, wheel speeds, torques and motion.
#
# A torque responds to the sample of one period before, and is held for a period. Arrays as in ``kernel_layout``.


def command(P: Array, y: Array, wanted: Array, eta: Array, z: Array, taken: bool, period: float) -> None:
    """Velocity command of the wheels, z[6:9]: the planned velocity and the correction by the last pose.

    Where a pose is taken its errors in the robot's frame are z[0:3], and their integrals z[3:6].
    """
    if taken:
        x, v, turned = wanted[0] - y[0], wanted[1] - y[1], wanted[2] - y[2]
        c, s = math.cos(y[2]), math.sin(y[2])
        z[0], z[1], z[2] = c * x + s * v, c * v - s * x, math.atan2(math.sin(turned), math.cos(turned))
        for r in range(3):
            z[3 + r] += P[at.K_I] * z[r] * period
    z[6], z[7], z[8] = eta[0], eta[1], eta[2]
    if P[at.LAW] == 1.0:
        a, b = math.cos(z[2]), math.sin(z[2])
        z[6] = a * eta[0] - b * eta[1] + P[at.K_P] * z[0] + z[3]
        z[7] = b * eta[0] + a * eta[1] + P[at.K_P] * z[1] + z[4]
        z[8] = eta[2] + P[at.K_P] * z[2] + z[5]
    elif P[at.LAW] == 2.0:
        z[6] = eta[0] * math.cos(z[2]) + P[at.K_X] * z[0] + z[3]
        z[8] = eta[2] + eta[0] * (P[at.K_Y] * z[1] + P[at.APERIODIC] * math.sin(z[2]))


def torque_command(G: Array, E: Array, c: Array, fed: Array, y: Array, i: int, sums: Array, period: float) -> float:
    """Torque command of a wheel's controller; its integral is frozen while the torque is at its limit."""
    error = E[i, 0] * c[0] + E[i, 1] * c[1] + E[i, 2] * c[2] - y[at.POSE + 3 + i]
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
        across = w[i, at.RHO] if W[i, at.HELD] != 0.0 else 0.0
        floor[0, i] = math.sqrt(w[i, at.SLIP] * w[i, at.SLIP] + across * across)
        floor[1, i] = w[i, at.LOAD]
        floor[2, i] = w[i, at.LOAD] * math.sqrt(w[i, at.FA] * w[i, at.FA] + w[i, at.FB] * w[i, at.FB])
        applied[i] = W[i, at.STRENGTH] * torque[i] if W[i, at.KIND] == 0.0 else 0.0


def follow_one(W: Array, K: Array, B: Array, C: Array, M: Array, G: Array, E: Array, P: Array, wanted: Array,
               eta: Array, fed: Array, y: Array, torque: Array, period: float, lever: float, tolerance: float,
               w: Array, A: Array, s: Array, z: Array, rows: Array, floor: Array, applied: Array,
               limited: Array) -> int:  # fmt: skip
    """Simulate all samples."""
    n, reach = W.shape[0], period
    for k in range(wanted.shape[0]):
        forces(W, K, B, C, y, torque, w, s[0], s[2])
        record_state(W, y, torque, w, rows[k], floor[k], applied[k])
        if k == wanted.shape[0] - 1:
            break
        command(P, y, wanted[k], eta[k], z, P[at.LAW] != 0.0 and k % int(P[at.EVERY]) == 0, period * P[at.EVERY])
        for i in range(n):
            z[9 + n + i] = 0.0
            if W[i, at.KIND] == 0.0:
                z[9 + n + i] = torque_command(G, E, z[6:9], fed[k], y, i, z[9 : 9 + n], period)
                limited[i] += 1.0 if abs(z[9 + n + i]) >= G[i, 2] else 0.0
        reach = advance(W, K, B, C, M, y, torque, period, reach, lever, tolerance, w, A, s)
        if reach == 0.0:
            return k
        for i in range(n):
            torque[i] = z[9 + n + i]
    return int(wanted.shape[0])
