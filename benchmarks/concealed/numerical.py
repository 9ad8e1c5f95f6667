"""The numerical substructure and the interface.

M2 a2 = -c3 v2 - k3 x2 - F_c(z1 held, z2) + w2 and F_c(z1, z2) = -c2 (v1 - v2) - k2 (x1 - x2).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from benchmarks.concealed.states import V2, X2
from numba import njit


class Numerical(NamedTuple):
    """Parameters that the numerical side computes with."""

    mass: float
    damping: float
    stiffness: float
    interface_stiffness: float
    interface_damping: float


@njit
def interface_force(x1: float, v1: float, y: np.ndarray, numerical: Numerical) -> float:
    """F_c, in N."""
    return -numerical.interface_damping * (v1 - y[V2]) - numerical.interface_stiffness * (x1 - y[X2])


@njit
def rates(x1: float, v1: float, w2: float, y: np.ndarray, numerical: Numerical, dy: np.ndarray) -> None:
    """Motion under the held state of the plant (x1, v1)."""
    F_c = interface_force(x1, v1, y, numerical)
    dy[X2] = y[V2]
    dy[V2] = (-numerical.damping * y[V2] - numerical.stiffness * y[X2] - F_c + w2) / numerical.mass
