"""What the forces have to accelerate beside the plant's own mass: ``M(q) a = F``."""

from __future__ import annotations

import numpy as np

from rthm_core.compiled import copy_into, inlined
from rthm_core.physical.laws import (
    CODE,
    OTHER,
    PLACE,
    STATE,
    STATES,
    plant_coupling,
    plant_coupling_by_x,
    plant_coupling_by_y,
    plant_inertia,
)
from rthm_core.physical.switching import motion_of


@inlined
def carry(laws, heavy, coupled, n, modes, y, t, dy, force):  # type: ignore[no-untyped-def]
    """Let the forces accelerate what moves with the dofs, too: `dy` is that of the plant's mass alone, and
    ``heavy.inverse`` becomes the inverse of all mass. Where that is not positive definite, nothing is a
    number. `coupled` is ``heavy.coupled``, handed over by itself as well; `force` is scratch.

    All mass is put together before it is inverted: the matrix of a part of the laws need not be positive
    definite where that of all is.
    """
    whole = heavy.inverse
    for i in range(n):
        copy_into(whole[i], heavy.plant[i])
        force[i] = 0.0
        for j in range(n):
            force[i] += heavy.plant[i, j] * dy[n + j]
    for row in heavy.rows:
        _add_inertia(laws, row, n, modes[row], y, t, whole)
    if coupled is not None:
        for row in coupled:
            _add_coupling(laws, row, n, y, whole, force)
    invert(whole)
    for i in range(n):
        dy[n + i] = 0.0
        for j in range(n):
            dy[n + i] += whole[i, j] * force[j]


@inlined
def _add_inertia(laws, row, n, mode, y, t, whole):  # type: ignore[no-untyped-def]
    """Add the mass of a law to that of its dof, or to that of the motion between two."""
    dof, other = laws.numbers[row, PLACE], laws.numbers[row, OTHER]
    begin, end = laws.numbers[row, STATE], laws.numbers[row, STATE] + laws.numbers[row, STATES]
    x, v = motion_of(laws, n, row, y)
    mass = plant_inertia(laws.numbers[row, CODE], x, v, y[begin:end], t, laws.parameters[row], mode)
    whole[dof, dof] += mass
    if other >= 0:
        whole[other, other] += mass
        whole[dof, other] -= mass
        whole[other, dof] -= mass


@inlined
def _add_coupling(laws, row, n, y, whole, force):  # type: ignore[no-untyped-def]
    """Add the mass that couples two dofs, and the forces that its change along the way makes."""
    dof, other = laws.numbers[row, PLACE], laws.numbers[row, OTHER]
    code, p = laws.numbers[row, CODE], laws.parameters[row]
    mass = plant_coupling(code, y[dof], y[other], p)
    whole[dof, other] += mass
    whole[other, dof] += mass
    force[dof] -= plant_coupling_by_y(code, y[dof], y[other], p) * y[n + other] ** 2
    force[other] -= plant_coupling_by_x(code, y[dof], y[other], p) * y[n + dof] ** 2


@inlined
def invert(matrix):  # type: ignore[no-untyped-def]
    """Invert a positive definite matrix (n, n) in place (Gauss and Jordan); any other becomes no number.

    What remains of the diagonal is above zero at each step if and only if the matrix is positive definite,
    and then needs no exchange of rows.
    """
    n = matrix.shape[0]
    for k in range(n):
        share = 1.0 / matrix[k, k] if matrix[k, k] > 0.0 else np.nan
        matrix[k, k] = 1.0
        for j in range(n):
            matrix[k, j] *= share
        for i in range(n):
            if i != k:
                factor = matrix[i, k]
                matrix[i, k] = 0.0
                for j in range(n):
                    matrix[i, j] -= factor * matrix[k, j]
