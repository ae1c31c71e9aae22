r"""Linear systems of a few states, sampled: in series, beside each other, fed back; their poles and responses.

As python-control has them, which tests hold beside these: importing it takes longer than all that a report computes.

Symbols: A, B, C, D the matrices of :math:`x_{k+1} = A x_k + B u_k`, :math:`y_k = C x_k + D u_k`.

.. [1] K. J. Åström, B. Wittenmark, *Computer-Controlled Systems*, 3rd ed., Prentice Hall 1997, ch. 2: sampled systems.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.linear_modes import exponential_less_one

__all__ = [
    "Response", "System", "beside", "delayed", "fed_back", "first_order", "frequency_response", "gain", "in_series",
    "poles", "sampled", "step_response", "value_at",
]  # fmt: skip

Array = NDArray[np.float64]
Response = Callable[[Array], NDArray[np.complex128]]  # of angular frequencies [rad/s]


class System(NamedTuple):
    """State space of a linear system; ``control.ss(*system)`` is the same one."""

    A: Array
    B: Array
    C: Array
    D: Array
    dt: float  # s; 0 of one in continuous time

    @property
    def states(self) -> int:
        """Number of its states."""
        return len(self.A)

    def output(self, *rows: int) -> System:
        """The same system with some of its outputs, in that order."""
        return self._replace(C=self.C[[*rows]], D=self.D[[*rows]])


def gain(value: float, period: float) -> System:
    """A factor between one input and one output.

    Parameters
    ----------
    value
        The factor.
    period
        Of the system [s].

    Returns
    -------
    System
    """
    return System(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), np.array([[value]]), period)


def first_order(b0: float, b1: float, pole: float, period: float) -> System:
    """The transfer function (b0 z + b1) / (z - pole).

    Parameters
    ----------
    b0, b1, pole
        Its coefficients.
    period
        Of the system [s].

    Returns
    -------
    System
    """
    return System(np.array([[pole]]), np.eye(1), np.array([[b1 + pole * b0]]), np.array([[b0]]), period)


def delayed(periods: int, period: float) -> System:
    """A delay by some periods.

    Parameters
    ----------
    periods
        How many.
    period
        Of the system [s].

    Returns
    -------
    System
    """
    n, last = periods, np.eye(1, periods, periods - 1)
    return System(np.eye(n, k=-1), np.eye(n, 1), last, np.zeros((1, 1)), period) if n else gain(1.0, period)


def in_series(second: System, first: System) -> System:
    """Two systems one after the other.

    Parameters
    ----------
    second, first
        The outputs of the first are the inputs of the second.

    Returns
    -------
    System
        States of the first, then of the second.
    """
    return System(
        np.block([[first.A, np.zeros((first.states, second.states))], [second.B @ first.C, second.A]]),
        np.vstack([first.B, second.B @ first.D]),
        np.hstack([second.D @ first.C, second.C]),
        second.D @ first.D,
        first.dt,
    )


def beside(one: System, other: System) -> System:
    """The sum of what two systems make of the same input.

    Parameters
    ----------
    one, other
        With as many inputs and outputs.

    Returns
    -------
    System
    """
    blocks = [[one.A, np.zeros((one.states, other.states))], [np.zeros((other.states, one.states)), other.A]]
    B, C = np.vstack([one.B, other.B]), np.hstack([one.C, other.C])
    return System(np.block(blocks), B, C, one.D + other.D, one.dt)


def fed_back(forward: System, row: Sequence[float]) -> System:
    """The loop closed around a system that answers one period later.

    Parameters
    ----------
    forward
        From the error to the outputs, with nothing that goes through at once (D = 0).
    row
        Weights of the outputs in what is fed back.

    Returns
    -------
    System
        From the reference to the same outputs.
    """
    return forward._replace(A=forward.A - forward.B @ np.array([row], float) @ forward.C)


def sampled(system: System, period: float) -> System:
    r"""A system in continuous time whose input is held over each period (zero-order hold), [1] eq. (2.4).

    .. math:: \exp\begin{pmatrix} A h & B h \\ 0 & 0 \end{pmatrix} = \begin{pmatrix} \Phi & \Gamma \\ 0 & 1\end{pmatrix}

    Parameters
    ----------
    system
        In continuous time.
    period
        h [s].

    Returns
    -------
    System
    """
    n, held = system.states, system.B.shape[1]
    whole = np.block([[system.A, system.B], [np.zeros((held, n + held))]]) * period
    grown = exponential_less_one(whole)
    return System(np.eye(n) + grown[:n, :n], grown[:n, n:], system.C, system.D, period)


def poles(system: System) -> NDArray[np.complex128]:
    """Eigenvalues of the states' matrix."""
    return np.linalg.eigvals(system.A).astype(complex)


def value_at(system: System, z: complex) -> complex:
    """The transfer function from the first input to the first output at one place; NaN at a pole.

    Parameters
    ----------
    system
        A sampled system.
    z
        The place.

    Returns
    -------
    complex
    """
    try:
        x = np.linalg.solve(z * np.eye(system.states) - system.A, system.B[:, 0].astype(complex))
    except np.linalg.LinAlgError:
        return complex(np.nan, np.nan)
    return complex(system.C[0] @ x + system.D[0, 0])


def step_response(system: System, samples: int) -> Array:
    """The first output of a stable system after a step of its first input.

    Parameters
    ----------
    system
        At rest before.
    samples
        How many of the output.

    Returns
    -------
    NDArray
        Shape (samples,).
    """
    grown, power = system.B[:, :1], system.A  # A^k B for k = 0, 1, ...: as many again with each power
    while grown.shape[1] < samples - 1:
        grown, power = np.hstack([grown, power @ grown]), power @ power
    answers = np.cumsum(system.C[0] @ grown[:, : samples - 1])
    return np.asarray(system.D[0, 0] + np.concatenate([[0.0], answers]))


def frequency_response(system: System) -> Response:
    """The transfer function from the first input to the first output on the unit circle; NaN at a pole.

    A state that only repeats another one a period later, as most of a delay do, is that one times 1/z: what is left to
    solve for each frequency is as large as the plant and its controller, however long the delay.

    Parameters
    ----------
    system
        A sampled system.

    Returns
    -------
    callable
        Values at angular frequencies [rad/s], shape (frequencies,).
    """
    repeated = _repeated(system.A, system.B)
    own = [n for n in range(system.states) if n not in repeated]
    place = {n: k for k, n in enumerate(own)}
    late = [(n, place[root], periods) for n, (root, periods) in repeated.items()]
    A, b, c = system.A[own], system.B[own, 0], system.C[0]
    late = [(n, root, periods) for n, root, periods in late if A[:, n].any() or c[n]]

    def response(w: Array) -> NDArray[np.complex128]:
        z = np.exp(1j * w * system.dt)
        M = z[:, None, None] * np.eye(len(own)) - A[:, own]
        outputs = np.tile(c[own].astype(complex), (len(z), 1))
        for n, root, periods in late:
            later = z**-periods
            M[:, :, root] -= later[:, None] * A[:, n]
            outputs[:, root] += later * c[n]
        return np.asarray((outputs * _solved(M, b.astype(complex))).sum(axis=1) + complex(system.D[0, 0]))

    return response


def _repeated(A: Array, B: Array) -> dict[int, tuple[int, int]]:
    """States that only repeat another one some periods later: which, and how many periods."""
    alone = (np.count_nonzero(A, axis=1) == 1) & (A.sum(axis=1) == 1.0) & ~B.any(axis=1)
    before = {int(n): int(np.flatnonzero(A[n])[0]) for n in np.flatnonzero(alone)}
    found = {}
    for n in before:
        root, periods = n, 0
        while root in before and periods <= len(before):
            root, periods = before[root], periods + 1
        if root not in before:  # else they go round
            found[n] = (root, periods)
    return found


def _solved(M: NDArray[np.complex128], b: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """States x of M x = b, shape (frequencies, states); NaN where M is singular."""
    try:
        return np.asarray(np.linalg.solve(M, b[:, None])[..., 0])
    except np.linalg.LinAlgError:
        singular = np.linalg.det(M) == 0.0
        kept = np.where(singular[:, None, None], np.eye(len(b)), M)
        return np.where(singular[:, None], np.nan, np.linalg.solve(kept, b[:, None])[..., 0])
