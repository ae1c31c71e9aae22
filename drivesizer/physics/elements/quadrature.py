"""Gauss and Legendre's rules, as ``np.polynomial.legendre.leggauss`` has them: loading that takes milliseconds.

Nodes lie between -1 and 1; the weights are of an interval of length 2.
"""

from __future__ import annotations

import numpy as np

__all__ = ["FIVE", "SIX"]

FIVE = (
    np.array([-0.906179845938664, -0.5384693101056831, 0.0, 0.5384693101056831, 0.906179845938664]),
    np.array([0.23692688505618928, 0.4786286704993663, 0.5688888888888887, 0.4786286704993663, 0.23692688505618928]),
)
SIX = (
    np.array([-0.9324695142031519, -0.6612093864662645, -0.2386191860831969,
              0.2386191860831969, 0.6612093864662645, 0.9324695142031519]),
    np.array([0.17132449237917027, 0.3607615730481387, 0.46791393457269104,
              0.46791393457269104, 0.3607615730481387, 0.17132449237917027]),
)  # fmt: skip
