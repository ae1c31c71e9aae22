r"""One step in time: linearly implicit, of order 2, its length by an embedded error.

.. math:: (M - γ h J) k_1 = Q(y), \quad (M - γ h J) k_2 = Q(y + h k_1) - 2 M k_1, \quad
          y' = y + \tfrac h2 (3 k_1 + k_2)

is of order 2 whatever J is and, with γ = 1 - 1/√2, L-stable [1]_: stiff tyres do not shorten the step. J has the
slopes of grip and resistance; wheels couple with the platform only, so the equations have arrow form and reduce to
three. Posture and energies take the same step with J = 0, which is Heun's. Arrays as in ``kernel_layout``.

.. [1] J. G. Verwer, E. J. Spee, J. G. Blom, W. Hundsdorfer, "A second-order Rosenbrock method applied to photochemical
   dispersion problems", SIAM Journal on Scientific Computing 20 (1999) 1456-1480.
"""

from __future__ import annotations

import math

import drivesizer.control.path_following.kernel_layout as at
from drivesizer.control.path_following.kernel_forces import forces
from drivesizer.control.path_following.kernel_layout import Array

__all__: list[str] = []  # compiled into ``kernel``


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


def subtract_inertia(W: Array, M: Array, k: Array, f: Array) -> None:
    """Subtract 2 M k from forces."""
    for r in range(3):
        f[r] -= 2.0 * (M[r, 0] * k[0] + M[r, 1] * k[1] + M[r, 2] * k[2])
    for i in range(W.shape[0]):
        f[3 + i] -= 2.0 * W[i, at.J] * k[3 + i]


def posture_rate(y: Array, rate: Array) -> None:
    """Rate of the posture at a state."""
    c, s = math.cos(y[2]), math.sin(y[2])
    rate[0], rate[1] = c * y[at.POSE] - s * y[at.POSE + 1], s * y[at.POSE] + c * y[at.POSE + 1]
    rate[2] = y[at.POSE + 2]


def embedded_error(W: Array, k1: Array, k2: Array, h: float, lever: float) -> float:
    """The embedded error, of first order: largest of all speeds [m/s]."""
    worst = 0.0
    for r in range(3 + W.shape[0]):
        size = 1.0 if r < 2 else lever if r == 2 else W[r - 3, at.R]
        found = 0.5 * h * abs(k1[r] + k2[r]) * size
        if not found <= worst:
            worst = found
    return worst


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
    subtract_inertia(W, M, k1, k2)
    solve(W, w, A, k2)
    for r in range(3):
        z[r] = y[r] + 0.5 * h * (m1[r] + m2[r])
    for r in range(n):
        z[3 + r] = y[3 + r] + h * (1.5 * k1[r] + 0.5 * k2[r])
    for r in range(at.TALLIES):
        z[3 + n + r] = y[3 + n + r] + 0.5 * h * (p1[r] + p2[r])
    return embedded_error(W, k1, k2, h, lever)


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
