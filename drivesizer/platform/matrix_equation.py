"""Declaration of an equation between vectors and matrices, and its form as text.

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

from drivesizer.physics.equation import Declared, of_docstring
from drivesizer.physics.notation import Notation

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
