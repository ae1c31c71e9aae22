r"""Forces on a platform that moves while its wheels turn and slip; slip s of a wheel and speed ρ of its roller are

.. math:: s = a η - r \cos γ\, \dot ϕ, \quad ρ = b η + r \sin γ\, \dot ϕ,

a along the roller's axis, b across it. A force F along a row acts as -F times that row on platform and wheel alike,
so that the loss is exactly F s. Arrays as in ``kernel_layout``. All forces are in proportion to the load, and the loads
follow from the forces: with the height h of the centre of mass N = N_0 - h (S · ΣF), two linear equations.
"""

from __future__ import annotations

import math

import drivesizer.control.path_following.kernel_layout as at
from drivesizer.control.path_following.kernel_layout import Array
from drivesizer.control.path_following.slip import grip, grip_slope

__all__: list[str] = []  # compiled into ``kernel``


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
