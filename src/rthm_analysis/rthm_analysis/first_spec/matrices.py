"""Mass, damping and stiffness of a motion by linear least squares: ``M a + C v + K x = F``.

Masses are lumped at the dofs, C and K symmetric. So what is known of the force on one dof also scales the
equations of dofs on which no force acts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.identification.estimate import covariance
from rthm_core.spec.sections import MATRICES

if TYPE_CHECKING:
    from rthm_core.compiled import Floats

NOTHING = 3.0
"""Standard deviations below which a link between two dofs is none."""

ROUNDS = 3
"""Fits, each with the equations of every dof weighed by what the last one left of them."""

Unknown = tuple[str, int, int]
"""Matrix and place of a number: ``("mass", i, i)``, and others with i <= j."""


@dataclass(frozen=True)
class Matrices:
    """Matrices of n dofs, and how well each number is known.

    Attributes
    ----------
    value, std : dict of (n, n) arrays
        By ``mass``, ``damping`` and ``stiffness``: kg, N s/m, N/m. What was given or left out has a standard
        deviation of 0.
    left : (n,) array
        Rms of the force that they leave on each dof, N.
    needed : (n,) array
        Rms of the largest of the forces that they say act on each dof, N.
    """

    value: dict[str, Floats]
    std: dict[str, Floats]
    left: Floats
    needed: Floats


def fitted_matrices(
    motion: tuple[Floats, Floats, Floats], force: Floats, masses: Sequence[float | None]
) -> Matrices:
    """Fit the matrices of a motion.

    Parameters
    ----------
    motion : three (p, n) arrays
        Acceleration, velocity and position, without their means, as smooth as each other and as the force.
    force : (p, n) array
        Known forces on the dofs, without their means, N.
    masses : sequence of float or None
        Masses that are known, kg; None: to be found.

    Examples
    --------
    >>> t = np.linspace(0.0, 20.0, 400)[:, None]
    >>> x, v, a = np.sin(t) + np.sin(2 * t), np.cos(t) + 2 * np.cos(2 * t), -np.sin(t) - 4 * np.sin(2 * t)
    >>> found = fitted_matrices((a, v, x), 2.0 * a + 0.1 * v + 8.0 * x, [None])
    >>> [round(float(found.value[name][0, 0]), 6) for name in ("mass", "damping", "stiffness")]
    [2.0, 0.1, 8.0]
    """
    n = force.shape[1]
    unknown: list[Unknown] = [("mass", i, i) for i in range(n) if masses[i] is None]
    unknown += [(name, i, j) for name in ("damping", "stiffness") for i in range(n) for j in range(i, n)]
    found = _fitted(motion, force, masses, unknown)
    kept = [one for one in unknown if one[1] == one[2] or _is_something(found, one)]
    return found if kept == unknown else _fitted(motion, force, masses, kept)


def _is_something(found: Matrices, one: Unknown) -> bool:
    name, i, j = one
    return bool(abs(found.value[name][i, j]) > NOTHING * found.std[name][i, j])


def _fitted(
    motion: tuple[Floats, Floats, Floats],
    force: Floats,
    masses: Sequence[float | None],
    unknown: list[Unknown],
) -> Matrices:
    points, n = force.shape
    columns = dict(zip(MATRICES, motion, strict=True))
    known = np.array([0.0 if mass is None else mass for mass in masses])
    wanted = force - known * motion[0]
    regressors = np.zeros((points, n, len(unknown)))
    for k, (name, i, j) in enumerate(unknown):
        regressors[:, i, k] = columns[name][:, j]
        regressors[:, j, k] = columns[name][:, i]
    sizes = np.sqrt(np.mean(np.square(regressors), axis=(0, 1)))
    sizes[sizes == 0.0] = 1.0
    weight = np.ones(n)
    for _ in range(ROUNDS):
        rows = (regressors / sizes * weight[:, None]).reshape(points * n, -1)
        goal = (wanted * weight).ravel()
        solved = np.linalg.lstsq(rows, goal, rcond=None)[0]
        left = goal - rows @ solved
        rest = np.sqrt(np.mean(np.square(left.reshape(points, n) / weight), axis=0))
        weight = 1.0 / np.maximum(rest, 1e-9 * np.sqrt(np.mean(np.square(wanted))) + 1e-300)
    spread = np.sqrt(np.diag(covariance(rows, rows, left))) / sizes
    return _gathered(n, known, unknown, solved / sizes, spread, rest, columns)


def _gathered(
    n: int,
    known: Floats,
    unknown: list[Unknown],
    solved: Floats,
    spread: Floats,
    rest: Floats,
    columns: dict[str, Floats],
) -> Matrices:
    value = {"mass": np.diag(known), "damping": np.zeros((n, n)), "stiffness": np.zeros((n, n))}
    std = {name: np.zeros((n, n)) for name in value}
    for (name, i, j), size, wide in zip(unknown, solved, spread, strict=True):
        value[name][i, j] = value[name][j, i] = size
        std[name][i, j] = std[name][j, i] = wide
    forces = [np.sqrt(np.mean(np.square(columns[name] @ value[name]), axis=0)) for name in value]
    return Matrices(value, std, rest, np.max(forces, axis=0))
